"""Joints sweep freely after clearance, little is cut for it, and what cannot be cut is said."""

from dataclasses import replace

import numpy as np
import pytest
from hull_link import box, link, make_joint
from sample_cabinet import SAMPLE_PARTS, SamplePart, sample_box_arrays

from artigen.kinematics import displacements, movable_parts
from artigen.types import Joint
from sim_export.collision.clearance import Clearance, clear_joints
from sim_export.collision.cut_hulls import CutHulls
from sim_export.collision.hull_limits import MAX_ASPECT, hull_aspect
from sim_export.collision.relief import MARGIN
from sim_export.errors import InvalidKinematics
from sim_export.geometry.contacts import HullSet, penetration_depths, signed_distances
from sim_export.geometry.hulls import convex_hull, hull_volume
from sim_export.motion.kinematics import (
    driven_joints,
    link_displacements,
    moved_links,
    required_openings,
    sample_sweep,
    sweep_coordinates,
)
from sim_export.motion.requirements import find_requirements
from sim_export.package import Hull, Link, Requirement

BY_NAME = {part.name: part for part in SAMPLE_PARTS}


def owner_of(part: SamplePart) -> str:
    while part.joint == "fixed" and part.parent is not None:
        part = BY_NAME[part.parent]
    return part.name


def sample_package(grow: float = 0.0) -> tuple[list[Link], list[Joint]]:
    """The sample cabinet's exact boxes as links; ``grow`` (m) swells everything that moves."""
    links, joints = [link("base")], []
    for part in SAMPLE_PARTS:
        if owner_of(part) != part.name:
            continue
        hulls = []
        for other in SAMPLE_PARTS:
            if owner_of(other) == part.name:
                swell = 0.0 if part.name == "body" else grow
                hulls += [box(low - swell, high + swell) for low, high in sample_box_arrays(other)]
        links.append(link(part.name, *hulls))
        parent = "base" if part.parent is None else owner_of(BY_NAME[part.parent])
        joints.append(make_joint(part.name, part.joint, part.axis, part.origin, part.upper, parent))
    return links, joints


def deepest(links, joints, requirements, poses: int = 21) -> dict[str, float]:
    """Deepest penetration along every joint's sweep, measured anew."""
    sets = [HullSet(hulls=link.hulls) for link in links]
    out = {}
    for joint in driven_joints(joints):
        qpos = required_openings(joint, joints, requirements)
        T = link_displacements(links, joints, {**qpos, joint.name: sweep_coordinates(joint, poses)})
        moving = moved_links(links, joints, joint)
        out[joint.name] = max(
            float(penetration_depths(sets[a], sets[b], T[:, a], T[:, b]).max())
            for a in moving
            for b in range(len(links))
            if b not in moving
        )
    return out


def total_volume(links) -> float:
    return sum(hull_volume(hull) for link in links for hull in link.hulls)


@pytest.fixture(scope="module")
def swollen() -> tuple[list[Link], list[Joint], tuple[Requirement, ...], Clearance]:
    links, joints = sample_package(grow=0.004)
    requirements = find_requirements(links, joints)
    return links, joints, requirements, clear_joints(links, joints, requirements)


def test_links_move_as_parts_do(cabinet):
    links, joints = sample_package()
    rng = np.random.default_rng(0)
    qpos = rng.uniform(0, 0.3, size=(5, len(movable_parts(cabinet))))
    names = [cabinet.parts[index].name for index in movable_parts(cabinet)]
    expected = displacements(cabinet, qpos)
    per_unit = {name: cabinet.scale if BY_NAME[name].joint == "prismatic" else 1.0 for name in names}
    found = link_displacements(
        links, joints, {f"joint_{name}": per_unit[name] * qpos[:, k] for k, name in enumerate(names)}
    )
    for slot, moving in enumerate(links[1:], start=1):
        part = next(index for index, other in enumerate(cabinet.parts) if other.name == moving.name)
        np.testing.assert_allclose(found[:, slot, :3, :3], expected[:, part, :3, :3], atol=1e-12)
    # Translations differ by the origin of the frame and the scale, so that distances agree.
    tray = [link.name for link in links].index("tray")
    np.testing.assert_allclose(found[:, tray, 0, 3], -per_unit["tray"] * qpos[:, names.index("tray")])


def test_mimicking_joints_follow_and_unknown_names_are_refused():
    links = [link("base"), link("body"), link("carrier"), link("screw")]
    joints = [
        make_joint("body", "fixed", (0, 0, 1), (0, 0, 0), 0.0, parent="base"),
        make_joint("carrier", "revolute", (0, 0, 1), (0.1, 0, 0), 3.0),
        replace(
            make_joint("screw", "prismatic", (0, 0, 1), (0.1, 0, 0), 0.3, parent="carrier"),
            follows="joint_carrier", ratio=0.1,
        ),
    ]  # fmt: skip
    T = link_displacements(links, joints, {"joint_carrier": np.array([0.0, 2.0])})
    np.testing.assert_allclose(T[1, 3] @ [0.2, 0, 0, 1], [0.1 + 0.1 * np.cos(2), 0.1 * np.sin(2), 0.2, 1])
    assert [joint.name for joint in driven_joints(joints)] == ["joint_carrier"]
    assert moved_links(links, joints, joints[1]) == (2, 3)
    with pytest.raises(ValueError, match="joint_screw"):
        link_displacements(links, joints, {"joint_screw": 0.1})
    with pytest.raises(InvalidKinematics, match="cycle"):
        link_displacements(links, [replace(joints[0], parent="screw"), *joints[1:]], {})
    with pytest.raises(InvalidKinematics, match="ghost"):
        link_displacements(links, [*joints[:-1], replace(joints[2], child="ghost")], {})


def test_the_tray_requires_the_door_and_nothing_else_anything():
    links, joints = sample_package()
    found = find_requirements(links, joints)
    assert [(item.joint, item.needs) for item in found] == [("joint_tray", "joint_door")]
    assert found[0].fraction in (0.25, 0.5, 0.75, 1.0)
    depths = deepest(links, joints, found)
    assert max(depths.values()) < 1e-6
    assert deepest(links, joints, ())["joint_tray"] > 0.05


def test_least_sufficient_opening_is_required():
    # A lid slides aside from over a lift that is as wide as a quarter of its way.
    links = [
        link("base"), link("body", box((0, 0, -0.1), (0.4, 0.4, 0))),
        link("lid", box((0, 0, 0.2), (0.4, 0.4, 0.22))),
        link("lift", box((0.01, 0.1, 0.01), (0.18, 0.3, 0.19))),
    ]  # fmt: skip
    joints = [
        make_joint("body", "fixed", (0, 0, 1), (0, 0, 0), 0.0, parent="base"),
        make_joint("lid", "prismatic", (1, 0, 0), (0, 0, 0), 0.4),
        make_joint("lift", "prismatic", (0, 0, 1), (0, 0, 0), 0.3),
    ]
    (found,) = find_requirements(links, joints)
    assert (found.joint, found.needs, found.fraction) == ("joint_lift", "joint_lid", 0.5)
    assert required_openings(joints[2], joints, [found]) == {"joint_lid": pytest.approx(0.2)}


def test_doors_that_block_each_other_give_no_cycle():
    # Both doors reach 2 cm into the other's way, so that neither can go first.
    links = [
        link("base"), link("body", box((0, -0.4, -0.1), (0.3, 0.4, -0.05))),
        link("left", box((0, 0.0, 0), (0.02, 0.4, 1)), box((-0.02, -0.05, 0), (0, 0.4, 0.5))),
        link("right", box((0, -0.4, 0), (0.02, 0.0, 1)), box((-0.02, -0.4, 0.5), (0, 0.05, 1))),
    ]  # fmt: skip
    joints = [
        make_joint("body", "fixed", (0, 0, 1), (0, 0, 0), 0.0, parent="base"),
        make_joint("left", "revolute", (0, 0, -1), (-0.02, 0.4, 0), 1.5),
        make_joint("right", "revolute", (0, 0, 1), (-0.02, -0.4, 0), 1.5),
    ]
    found = find_requirements(links, joints)
    needs = {(item.joint, item.needs) for item in found}
    assert all((b, a) not in needs for a, b in needs)
    for joint in driven_joints(joints):
        assert joint.name not in required_openings(joint, joints, found)


def test_after_clearance_everything_sweeps_freely(swollen):
    links, joints, requirements, cleared = swollen
    before = deepest(links, joints, requirements)
    assert max(before.values()) > 0.003
    after = deepest(cleared.links, cleared.joints, requirements)
    assert max(after.values()) <= 0.0005
    assert cleared.residuals == ()
    assert cleared.limits == ()
    # Also between the sampled poses, a margin is left.
    assert max(deepest(cleared.links, cleared.joints, requirements, poses=101).values()) <= 0.001


def test_clearance_takes_little_and_says_how_much(swollen):
    links, _, _, cleared = swollen
    assert total_volume(cleared.links) >= 0.95 * total_volume(links)
    before = {link.name: total_volume([link]) for link in links}
    removed = sum(item.removed_share * before[item.link] for item in cleared.reliefs)
    assert removed == pytest.approx(total_volume(links) - total_volume(cleared.links), rel=0.01)
    assert removed > 0
    for item in cleared.reliefs:
        assert item.cuts > 0
        assert 0 < item.largest_depth <= 0.03
    changed = {item.link for item in cleared.reliefs}
    for old, new in zip(links, cleared.links, strict=True):
        assert (old is new) == (old.name not in changed)
        for hull in new.hulls:
            assert hull_aspect(hull) <= MAX_ASPECT * 1.001 or hull in old.hulls
    assert len(cleared.records) == len(cleared.reliefs)


def test_a_free_package_is_left_alone():
    links, joints = sample_package(grow=-0.001)
    cleared = clear_joints(links, joints, find_requirements(links, joints))
    assert all(old is new for old, new in zip(links, cleared.links, strict=True))
    assert cleared.records == ()


def hinge(corner: float) -> tuple[list[Link], list[Joint]]:
    """A door between two posts, hinged at the middle of its edge: its corners sweep into the post."""
    links = [
        link("base"),
        link("body", box((0, 0.401, 0), (0.1, 0.45, 1)), box((0, -0.45, 0), (0.1, -0.401, 1))),
        link("door", box((0, -0.4, 0), (0.02, 0.4, 1))),
    ]
    joints = [
        make_joint("body", "fixed", (0, 0, 1), (0, 0, 0), 0.0, parent="base"),
        make_joint("door", "revolute", (0, 0, -1), (0.01, 0.4 - corner, 0), np.pi / 2),
    ]
    return links, joints


def test_a_hinge_edge_gets_a_chamfer():
    links, joints = hinge(0.003)
    assert deepest(links, joints, ())["joint_door"] > 0.003
    cleared = clear_joints(links, joints)
    assert deepest(cleared.links, cleared.joints, ())["joint_door"] <= 0.0005
    assert total_volume(cleared.links) > 0.98 * total_volume(links)
    # Still closed: the door fills its opening but for a little at the hinge.
    assert max(hull.vertices[:, 1].max() for hull in cleared.links[2].hulls) > 0.39


def test_a_knob_sunk_into_a_door_is_cut_once_along_its_axis():
    hexagon = np.array([[np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3]) * 0.02
    knob = convex_hull(np.array([[x, y, z] for x in (-0.035, 0.005) for y, z in hexagon]))
    links = [
        link("base"),
        link("body", box((0, -0.4, -0.4), (0.02, 0.4, 0.4))),
        link("knob", knob),
    ]
    joints = [
        make_joint("body", "fixed", (0, 0, 1), (0, 0, 0), 0.0, parent="base"),
        make_joint("knob", "continuous", (-1, 0, 0), (0, 0, 0), 2 * np.pi),
    ]
    cleared = clear_joints(links, joints)
    assert deepest(cleared.links, cleared.joints, ())["joint_knob"] == 0.0
    (relief,) = cleared.reliefs
    assert (relief.link, relief.cuts) == ("knob", 1)
    assert relief.removed_share == pytest.approx((0.005 + MARGIN) / 0.04, abs=0.001)


def test_a_deep_overlap_is_reported_not_hidden():
    links, joints = sample_package()
    drawer = [link.name for link in links].index("drawer")
    shift = np.array([0.0, 0.05 + 0.035, 0.0])  # 5 cm into the side wall of the body, all the way
    solid = convex_hull(np.concatenate([hull.vertices for hull in links[drawer].hulls]) + shift)
    links[drawer] = replace(links[drawer], hulls=(solid,))
    cleared = clear_joints(links, joints, find_requirements(links, joints))
    assert any(item.joint == "joint_drawer" and item.links[0] == "drawer" for item in cleared.residuals)
    worst = max(item.depth for item in cleared.residuals)
    assert worst == pytest.approx(deepest(cleared.links, cleared.joints, ())["joint_drawer"], rel=0.05)
    assert worst > 0.02
    assert any("penetrates" in record for record in cleared.records)


def stopper() -> tuple[list[Link], list[Joint]]:
    """A slider that runs into a wall after 20 of 30 cm."""
    links = [
        link("base"), link("body", box((0, 0, -0.02), (1, 1, 0)), box((0.5, 0, 0), (0.9, 1, 0.5))),
        link("slider", box((0.1, 0.1, 0.001), (0.3, 0.9, 0.3))),
    ]  # fmt: skip
    joints = [
        make_joint("body", "fixed", (0, 0, 1), (0, 0, 0), 0.0, parent="base"),
        make_joint("slider", "prismatic", (1, 0, 0), (0, 0, 0), 0.3),
    ]
    return links, joints


def test_limits_are_lowered_where_most_of_the_range_is_free():
    links, joints = stopper()
    cleared = clear_joints(links, joints)
    (change,) = cleared.limits
    assert (change.joint, change.before) == ("joint_slider", 0.3)
    assert 0.185 <= change.after <= 0.2 + 0.03
    assert cleared.joints[1].upper == change.after
    assert set(change.links) == {"slider", "body"}
    assert deepest(cleared.links, cleared.joints, ())["joint_slider"] <= 0.0005


@pytest.mark.parametrize("angle", [45.0, 90.0])
def test_what_is_carried_stays_clear_however_far_it_is_open(angle):
    """A lever on a slide stands up and then meets a beam, which its corner passes at 45 degrees only."""
    links = [
        link("base"),
        link("body", box([0.3, 0.0, 0.168 if angle < 90.0 else 0.19], [0.5, 0.2, 0.4])),
        link("slide", box([0.0, 0.0, 0.0], [0.3, 0.1, 0.02])),
        link("lever", box([0.0, 0.1, 0.0], [0.15 if angle < 90.0 else 0.2, 0.12, 0.1])),
    ]
    joints = [
        make_joint("body", "fixed", [0, 0, 1], [0, 0, 0], 0.0, "base"),
        make_joint("slide", "prismatic", [1, 0, 0], [0, 0, 0], 0.4),
        make_joint("lever", "revolute", [0, -1, 0], [0.0, 0.0, 0.0], np.pi / 2, "slide"),
    ]

    def depth(links) -> float:
        qpos = {"joint_slide": sample_sweep(links, joints, joints[1]), "joint_lever": np.radians(angle)}
        T = link_displacements(links, joints, qpos)
        return penetration_depths(*(HullSet(hulls=links[i].hulls) for i in (3, 1)), T[:, 3], T[:, 1]).max()

    assert depth(links) > 5e-3
    assert depth(clear_joints(links, joints).links) == 0.0


def test_what_only_touches_gets_a_gap_and_loses_no_wedge():
    """0.6 % of the longest side, from 1.2 to 2.5 mm."""
    rng = np.random.default_rng(3)
    size = rng.uniform(0.02, 1.0, (8, 3))
    for thick, wide, tall in size:
        links = [
            link("base"),
            link("body", box((0, 0, 0), (thick, wide, tall))),
            link("door", box((-thick, 0, 0), (0, wide, tall))),
        ]
        joints = [
            make_joint("body", "fixed", (0, 0, 1), (0, 0, 0), 0.0, parent="base"),
            make_joint("door", "prismatic", (-1, 0, 0), (0, 0, 0), 0.3),
        ]
        margin = np.clip(0.006 * max(2.0 * thick, wide, tall), 0.0012, MARGIN)
        cleared = clear_joints(links, joints)
        door, body = (np.concatenate([h.vertices for h in link.hulls]) for link in cleared.links[:0:-1])
        assert body[:, 0].min() - door[:, 0].max() == pytest.approx(margin, rel=1e-6)
        lost = total_volume(links) - total_volume(cleared.links)
        assert lost == pytest.approx(margin * wide * tall, rel=1e-6)


def test_a_slot_for_what_slides_is_cut_in_one_piece():
    """A runner through a wall: the slot is as long as the way of the runner, and takes four hulls at most."""
    links = [
        link("base"),
        link("body", box((0, -0.5, 0), (0.02, 0.5, 1))),
        link("drawer", box((-0.005, -0.45, 0.5), (0.6, 0.45, 0.505))),
    ]
    joints = [
        make_joint("body", "fixed", (0, 0, 1), (0, 0, 0), 0.0, parent="base"),
        make_joint("drawer", "prismatic", (-1, 0, 0), (0, 0, 0), 0.5),
    ]
    cleared = clear_joints(links, joints)
    assert deepest(cleared.links, cleared.joints, (), poses=101)["joint_drawer"] == 0.0
    assert cleared.links[2] is links[2]
    assert len(cleared.links[1].hulls) <= 4
    (relief,) = cleared.reliefs
    assert relief.cuts == 1
    assert relief.removed_share < 0.01


def test_far_swings_are_sampled_closely():
    """A post at the tip of a wide door's way, which 21 samples would jump over."""
    links = [
        link("base"),
        link("body", box((0, -1, 0), (0.02, 0, 1)), box((-0.62, -0.79, 0), (-0.6, -0.77, 1))),
        link("door", box((-0.02, -1, 0), (-0.001, 0, 1))),
    ]
    joints = [
        make_joint("body", "fixed", (0, 0, 1), (0, 0, 0), 0.0, parent="base"),
        make_joint("door", "revolute", (0, 0, -1), (0, 0, 0), np.pi / 2),
    ]
    assert deepest(links, joints, ())["joint_door"] == 0.0
    assert deepest(links, joints, (), poses=201)["joint_door"] > 0.001
    cleared = clear_joints(links, joints)
    assert deepest(cleared.links, cleared.joints, (), poses=201)["joint_door"] <= 0.0005


def test_a_thin_leaf_keeps_its_thickness_before_a_thick_body():
    """The leaf has less volume to lose, and would lose more of it."""
    leaf = box((-0.206, -0.2, -0.2), (-0.2, 0.2, 0.2))
    body = box((-0.2005, -0.3, -0.3), (0.2, 0.3, 0.3))
    links = [link("body", body), link("door", leaf)]
    joints = [make_joint("door", "revolute", (0, 0, -1), (-0.206, 0.2, 0.0), np.pi / 2)]
    done = clear_joints(links, joints, shares=True)
    assert done.residuals == ()
    assert done.links[1].hulls == (leaf,)
    assert sum(map(hull_volume, done.links[0].hulls)) > 0.95 * hull_volume(body)
    assert clear_joints(links, joints).links[0].hulls == (body,)


@pytest.mark.parametrize(("width", "may_go"), [(0.0145, True), (0.0155, False)])
def test_a_strip_may_go_if_no_point_is_farther_from_other_hulls_than_v103_allows(width, may_go):
    """Beside a block with a diagonal of a metre."""
    block, strip = box((0.0, 0.0, 0.0), (0.8, 0.6, 0.001)), box((-width, 0.0, 0.0), (0.0, 0.6, 0.001))
    size = float(np.linalg.norm([0.8 + width, 0.6]))
    block, strip = (Hull(vertices=hull.vertices / size, faces=hull.faces) for hull in (block, strip))
    strip = Hull(vertices=strip.vertices * [size, 1.0, 1.0], faces=strip.faces)
    links = [link("body", block, strip)]
    assert CutHulls(links, sheets=True).is_skin(0, 1) == may_go
    assert not CutHulls(links).is_skin(0, 1)  # hulls of voxels stand for volume
    assert not CutHulls([link("body", strip)], sheets=True).is_skin(0, 0)


def capped(gap: float, *, screwed: bool):
    """A wall of a cap that turns by next to nothing, so far (m) from its neck."""
    links = [
        link("body", box((-0.01, -0.01, 0.0), (0.01, 0.01, 0.03))),
        link("carrier"),
        link("cap", box((0.01 + gap, -0.01, 0.0), (0.02, 0.01, 0.03))),
    ]
    turn = make_joint("carrier", "revolute", (1, 0, 0), (0, 0, 0), 1e-6)
    travel = make_joint("cap", "prismatic", (1, 0, 0), (0, 0, 0), 1e-9, parent="carrier")
    if not screwed:
        return links, [turn, replace(travel, type="fixed", upper=0.0)]
    return links, [turn, replace(travel, of_screw=True, follows=turn.name, ratio=1e-3)]


@pytest.mark.parametrize(
    ("gap", "screwed", "left"),
    [(0.9e-4, True, 2e-4), (1.1e-4, True, 1.1e-4), (1.1e-4, False, 1.2e-3), (1.1e-3, False, 1.1e-3)],
)
def test_a_cap_keeps_a_tenth_of_a_millimetre_from_its_neck_and_other_parts_one(gap, screwed, left):
    links, joints = capped(gap, screwed=screwed)
    done = clear_joints(links, joints)
    sets = [HullSet(hulls=link.hulls) for link in done.links]
    found = signed_distances(sets[0], sets[2], np.eye(4), np.eye(4), 1.0).distance
    assert found.min() == pytest.approx(left, rel=0.02)


@pytest.mark.parametrize(("hulls", "more"), [(1, 8), (2, 9), (10, 13), (59, 37), (60, 36), (96, 0)])
def test_cuts_may_add_eight_hulls_and_half_as_many_as_there_are_up_to_the_limit_of_a_link(hulls, more):
    cubes = [box((k, 0.0, 0.0), (k + 0.9, 0.9, 0.9)) for k in range(hulls)]
    assert CutHulls([link("body", *cubes)]).room(0) == more


@pytest.mark.parametrize(
    ("gap", "label", "cut"), [(0.0029, "door", True), (0.0031, "door", False), (0.0029, None, False)]
)
def test_leaves_that_turn_are_cut_where_others_come_nearer_than_three_millimetres(gap, label, cut):
    left, right = box((-0.002, gap, 0), (0, 0.4, 1)), box((-0.002, -0.4, 0), (0, 0, 1))
    links = [
        link("body", box((0.01, -0.4, 0), (0.4, 0.4, 1))),
        replace(link("left", left), label=label),
        replace(link("right", right), label=label),
    ]
    joints = [
        make_joint("left", "revolute", (0, 0, -1), (-0.002, 0.4, 0), 1e-6),
        make_joint("right", "revolute", (0, 0, 1), (-0.002, -0.4, 0), 1e-6),
    ]
    cleared = clear_joints(links, joints)
    assert bool(cleared.reliefs) == cut
    ends = [link.hulls[0].vertices[:, 1] for link in cleared.links[1:]]
    assert ends[0].min() - ends[1].max() >= (0.0036 if cut else gap) - 1e-9
    assert all(relief.cuts <= 2 for relief in cleared.reliefs)  # none that removes nothing


@pytest.mark.parametrize(("depth", "reported"), [(1.8e-5, False), (2.2e-5, True)])
def test_overlaps_that_cannot_be_cut_are_reported_from_a_fiftieth_of_a_millimetre(depth, reported):
    """Two wheels, which keep their shape."""
    links = [
        replace(link("front", box((0, 0, 0), (0.1, 0.02, 0.1))), label="wheel"),
        replace(link("rear", box((0.1 - depth, 0, 0), (0.2, 0.02, 0.1))), label="wheel"),
        link("body", box((0, 0, 0.3), (0.2, 0.02, 0.4))),
    ]
    joints = [make_joint("front", "prismatic", (0, 1, 0), (0, 0, 0), 1e-3)]
    assert bool(clear_joints(links, joints).residuals) == reported


@pytest.mark.parametrize(("share", "lowered"), [(0.48, False), (0.52, True)])
def test_a_limit_is_lowered_if_half_of_the_range_is_free(share, lowered):
    links, joints = stopper()
    cleared = clear_joints(links, [joints[0], replace(joints[1], upper=0.2 / share)])
    assert (len(cleared.limits), len(cleared.residuals)) == ((1, 0) if lowered else (0, 1))
