"""A mended source passes the check that it failed, and a sound one is left as it is."""

from dataclasses import replace

import numpy as np
import pytest
from triangle_box import box

from artigen.types import Asset, Joint, Part
from sim_export.checks.config import CheckConfig
from sim_export.checks.handles import check_handles
from sim_export.checks.opening import door_panel, hinge_offset
from sim_export.checks.subject import Subject
from sim_export.files.write import write_package
from sim_export.geometry.islands import visual_islands
from sim_export.mend.apart import pull_apart
from sim_export.mend.mends import mend_source
from sim_export.mend.source import open_source, source_package
from sim_export.source_faults import overlaps_at_rest, overlaps_on_the_way, show_links

CFG = CheckConfig()
FIXED = Joint(type="fixed", axis=np.array([0, 0, 1.0]), origin=np.zeros(3))


def part_of(triangles, name, label, parent, joint):
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    return Part(
        name=name, label=label, parent=parent, joint=joint, box=np.stack([(low + high) / 2, high - low])
    )


def cabinet(door, hinge):
    """A block with a door of 20 mm in front of it (-x); the object is 1 m high, so units are metres."""
    body = box((-0.2, -0.25, -0.5), (0.3, 0.25, 0.5))
    joint = Joint(
        type="revolute", axis=np.array([0, 0, 1.0]), origin=np.array(hinge, dtype=float), upper=1.5
    )  # fmt: skip
    parts = (part_of(body, "base", "base", -1, FIXED), part_of(door, "door_0", "door", 0, joint))
    return open_source(
        Asset(name="cabinet", category="StorageFurniture", scale=1.0, parts=parts), (body, door)
    )


DOOR = box((-0.222, -0.25, -0.5), (-0.202, 0.25, 0.5))
CHEST = box((-0.2, -0.25, -0.5), (0.3, 0.25, 0.5))


def chest(drawer, upper=0.3, axis=(-1.0, 0, 0)):
    """The same block with something that slides."""
    joint = Joint(type="prismatic", axis=np.array(axis), origin=np.zeros(3), upper=upper)
    parts = (part_of(CHEST, "base", "base", -1, FIXED), part_of(drawer, "drawer_0", "drawer", 0, joint))
    return open_source(
        Asset(name="chest", category="StorageFurniture", scale=1.0, parts=parts), (CHEST, drawer)
    )


def hinge_ratio(source, tmp_path):
    package = source_package(source)
    subject = Subject(write_package(package, tmp_path / package.name, "replace"))
    panel = door_panel(subject, subject.driven[0])
    assert panel is not None
    off, allowed = hinge_offset(panel, CFG)
    return off / allowed


def test_a_hinge_inside_its_door_moves_to_the_edge_and_nowhere_else(tmp_path):
    source = cabinet(DOOR, (-0.222, -0.2, 0.1))
    assert hinge_ratio(source, tmp_path) > 1.0
    mended = mend_source(source)
    assert hinge_ratio(mended, tmp_path) < 1e-6
    assert mended.asset.parts[1].joint.origin == pytest.approx([-0.222, -0.25, 0.1])
    assert [record.split(":")[0] for record in mended.records] == ["mend hinge (V203)"]


@pytest.mark.parametrize(
    "source",
    [cabinet(DOOR, (-0.222, -0.25, 0.0)), chest(box((-0.25, -0.2, -0.1), (-0.205, 0.2, 0.1)))],
    ids=["door", "drawer"],
)
def test_a_sound_source_is_returned_as_it_is(source):
    assert mend_source(source) is source


def test_a_part_inside_its_neighbour_moves_out_by_a_short_way():
    source = chest(box((-0.25, -0.2, -0.1), (-0.192, 0.2, 0.1)))  # 8 mm in the block
    before = max(overlaps_at_rest(show_links(source.links)))[0]
    mended = mend_source(source)
    after = max(overlaps_at_rest(show_links(mended.links)))[0]
    assert before > CFG.max_rest_overlap_parent >= after
    assert 0.007 < np.linalg.norm(mended.shifts[1]) < 0.012
    assert mended.shifts[1][0] < 0.0  # out of the block
    assert np.allclose(mended.asset.parts[1].box[0] - source.asset.parts[1].box[0], mended.shifts[1])
    assert (mended.shifts[0] == 0.0).all()


@pytest.mark.parametrize(("depth", "eighths"), [(0.0043, 2), (0.0072, 2), (0.0252, 8), (0.0265, 0)])
def test_a_part_moves_by_eighths_of_two_percent_of_the_diagonal_until_it_is_a_millimetre_deep(depth, eighths):
    """3.1 mm to 25 mm; beyond that it stays, and is not said to be mended."""
    source = chest(box((-0.25, -0.2, -0.1), (-0.2 + depth, 0.2, 0.1)))
    moved = np.linalg.norm(mend_source(source).shifts[1])
    assert moved == pytest.approx(eighths / 8 * 0.02 * np.linalg.norm([0.55, 0.5, 1.0]), rel=1e-3)


def test_a_range_that_runs_into_the_body_ends_before_it():
    """A slide beside the block that has 0.2 m to go, and says 0.3."""
    source = chest(box((-0.5, -0.2, -0.1), (-0.4, 0.2, 0.1)), upper=0.3, axis=(1.0, 0, 0))
    mended = mend_source(source)
    upper = mended.asset.parts[1].joint.upper
    assert 0.15 < upper <= 0.202
    found = max(overlaps_on_the_way(source_package(mended), show_links(mended.links)))[0]
    assert (
        found
        <= CFG.max_penetration
        < max(overlaps_on_the_way(source_package(source), show_links(source.links)))[0]
    )


@pytest.mark.parametrize(("free", "upper"), [(0.155, 0.15), (0.145, 0.3)])
def test_a_range_of_which_less_than_half_is_free_is_left_alone(free, upper):
    source = chest(box((-0.3 - free, -0.2, -0.1), (-0.2 - free, 0.2, 0.1)), upper=0.3, axis=(1.0, 0, 0))
    assert mend_source(source).asset.parts[1].joint.upper == pytest.approx(upper)


def with_handle(depth):
    """The cabinet with a bar of 10 mm on its door, ``depth`` (m) behind the door's front."""
    plain = cabinet(DOOR, (-0.222, -0.25, 0.0))
    bar = box((-0.232 + depth, 0.15, -0.1), (-0.222 + depth, 0.17, 0.1))
    parts = (*plain.asset.parts, part_of(bar, "handle_0", "handle", 1, FIXED))
    return open_source(replace(plain.asset, parts=parts), (*plain.surfaces, bar))


@pytest.mark.parametrize(("depth", "moves"), [(0.0, False), (0.006, True), (0.014, True)])
def test_a_handle_in_its_door_moves_out_until_it_can_be_grasped(depth, moves, tmp_path):
    def grasped(source):
        package = source_package(source)
        subject = Subject(write_package(package, tmp_path / package.name, "replace"))
        return check_handles(subject, CFG).passed

    source = with_handle(depth)
    mended = mend_source(source)
    assert grasped(source) is not moves
    assert grasped(mended)
    shift = mended.shifts[2]
    assert bool(shift[0] < 0.0) is moves  # towards the front
    assert np.linalg.norm(shift) <= depth + 0.0025
    assert (mended.shifts[:2] == 0.0).all()


@pytest.mark.parametrize("cell", [0.0, 0.004, 0.0151])
def test_a_handle_keeps_room_for_the_cells_that_it_is_rebuilt_from(cell):
    """Too wide for a gripper, it moves until fingers fit behind it and a cell more."""
    plain, gap = cabinet(DOOR, (-0.222, -0.25, 0.0)), 0.01
    plate = box((-0.232 - gap, 0.05, -0.05), (-0.222 - gap, 0.15, 0.05))
    parts = (*plain.asset.parts, part_of(plate, "handle_0", "handle", 1, FIXED))
    source = open_source(replace(plain.asset, parts=parts), (*plain.surfaces, plate))
    wanted = CFG.min_clearance + cell
    mended = mend_source(source, replace(CFG, min_clearance=wanted))
    free = gap - mended.shifts[2, 0]
    assert wanted - 3e-4 <= free <= wanted + 0.0026


@pytest.mark.parametrize(("gap", "held"), [(0.004, False), (0.006, True), (0.0999, True), (0.101, False)])
def test_a_piece_that_floats_within_reach_is_held_by_a_post(gap, held):
    sound = cabinet(DOOR, (-0.222, -0.25, 0.0))
    knob = box((-0.242 - gap, 0.15, -0.02), (-0.222 - gap, 0.19, 0.02))
    parts = (*sound.asset.parts, part_of(knob, "knob_0", "knob", 1, FIXED))
    source = open_source(replace(sound.asset, parts=parts), (*sound.surfaces, knob))
    mended = mend_source(source)
    left = [len(visual_islands(shown, CFG.max_island)) for shown in mended.links.values()]
    assert (len(mended.posts) == 1) is held
    assert any(left) is (gap > 0.1)
    if held:
        part, post = mended.posts[0]
        assert part == 1  # the door, whose link holds both
        assert np.ptp(post.reshape(-1, 3), axis=0).max() == pytest.approx(gap + 0.012)


def nested(depth: float, axis=(0.0, 1.0, 0.0)):
    """A lid whose barrel lies in a groove at the edge of its base, inside both walls by a depth (m)."""
    groove = 0.06
    base = np.concatenate(
        [
            box((-0.2, -0.25, -0.5), (0.3, 0.25, 0.4)),
            box((-0.2, -0.25, 0.4), (0.3 - groove, 0.25, 0.5)),
        ]
    )
    barrel = box((0.3 - groove - depth, -0.2, 0.4 - depth), (0.3 - depth, 0.2, 0.45 - depth))
    joint = Joint(
        type="revolute", axis=np.array(axis, dtype=float), origin=np.array([0.27, 0.0, 0.42]), upper=0.1
    )
    parts = (part_of(base, "base", "base", -1, FIXED), part_of(barrel, "door_0", "door", 0, joint))
    return open_source(Asset(name="laptop", category="Laptop", scale=1.0, parts=parts), (base, barrel))


@pytest.mark.parametrize(
    ("depth", "axis", "moves"),
    [(0.012, (0, 1, 0), True), (0.021, (0, 1, 0), False), (0.012, (1, 0, 0), False)],
)
def test_a_barrel_in_two_walls_moves_across_its_hinge(depth, axis, moves):
    """No way along one axis is short enough. All but 1 mm of the depth is left in both directions at once, by
    eighths of 25 mm, as long as that is no longer than 25 mm altogether."""
    shift = pull_apart(nested(depth, axis), CFG).shifts[1]
    assert bool(shift.any()) == moves
    if moves:
        least = depth - 0.5 * CFG.max_rest_overlap_parent
        assert least <= shift[0] <= least + 0.02 * np.linalg.norm([0.5, 0.5, 1.0]) / 8
        assert shift[1] == 0.0
        assert least <= shift[2] <= least + 0.02 * np.linalg.norm([0.5, 0.5, 1.0]) / 8
