"""Leaves on hinges, levers, latches and tubes: what a latch holds, and what sets its leaf free."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from artigen.shapes.draw import SIZE_MARGIN, ShapeError, Wish, choose_size, draw_shape
from artigen.shapes.fittings.hardware import GAP, Space
from artigen.shapes.fittings.hinges import hang_leaves
from artigen.shapes.fittings.latches import RELEASED, THROW, TURN, Latch, build_tongue
from artigen.shapes.fittings.levers import LEVER_KINDS, LeverDesign, build_lever
from artigen.shapes.fittings.tubes import lay_pipe, lean_rod
from artigen.shapes.poses import pose_parts
from artigen.shapes.primitives import SEGMENTS, box, contains, place_vertices
from artigen.shapes.shape import Need, Shape
from artigen.sketch.faults import find_faults
from artigen.transforms import transform_points
from sim_export.checks.suite import run_checks
from sim_export.files.write import write_package
from sim_export.physics.inertia import subtree_inertial
from sim_export.reference import build_reference, find_latched

DOORS = ("panelled", "flush", "glazed", "double")


def with_need(shape: Shape, part: str, needs: tuple[Need, ...]) -> Shape:
    """The shape with other needs of one part."""
    parts = tuple(replace(own, needs=needs) if own.name == part else own for own in shape.parts)
    return replace(shape, parts=parts)


@pytest.mark.parametrize("style", DOORS)
def test_a_leaf_runs_into_its_keep_unless_its_lever_is_pressed_first(style: str):
    door = draw_shape("Door", 4, Wish(style=style))
    assert find_faults(door) == ()
    for needs in ((), (Need(part="lever", fraction=0.3),)):
        faults = find_faults(with_need(door, "leaf", needs))
        assert {fault.id for fault in faults} == {"blocked"}
        assert all({fault.part, fault.other} <= {"leaf", "lever", "frame", "leaf_1"} for fault in faults)


def test_the_second_leaf_of_a_double_door_is_held_by_its_bolt_and_by_the_first_leaf():
    door = draw_shape("Door", 4, Wish(style="double"))
    for kept in ("bolt", "leaf"):
        faults = find_faults(with_need(door, "leaf_1", (Need(part=kept, fraction=RELEASED),)))
        assert {fault.id for fault in faults} == {"blocked"}


def test_what_a_latch_holds_turns_freely_and_what_none_holds_resists():
    door = draw_shape("Door", 4, Wish(style="flush"))
    assert find_latched(door) == {"leaf"}
    free = with_need(door, "leaf", ())
    assert find_latched(free) == frozenset()
    latched, loose = (
        {joint.child: joint for joint in build_reference(shape).joints} for shape in (door, free)
    )
    assert latched["link_0"].friction == pytest.approx(0.3)
    assert loose["link_0"].friction > 3.0
    assert 2.0 <= latched["link_1"].friction / loose["link_1"].friction < 2.2


def test_a_need_of_a_part_that_something_else_carries_is_no_latch():
    assert find_latched(draw_shape("Oven", 0)) == frozenset()


@pytest.mark.parametrize("lift", [1, -1])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("backset", "upper"), [(0.03, np.pi / 2), (0.055, TURN)])
def test_a_tongue_lies_in_its_keep_and_turns_within_its_pocket(lift, side, backset, upper):
    latch = Latch(x=(0.0, 0.04), edge=0.2, side=side, level=1.0, lift=lift, backset=backset)
    tongue = build_tongue(latch)[0]
    corners = place_vertices(tongue)
    assert (side * (corners[:, 1] - latch.edge)).max() == pytest.approx(THROW)
    y, z = latch.axis
    for turn in np.linspace(0.0, upper, 46):
        angle = side * lift * turn
        ahead, up = corners[:, 1] - y, corners[:, 2] - z
        turned = np.column_stack(
            [y + np.cos(angle) * ahead - np.sin(angle) * up, z + np.sin(angle) * ahead + np.cos(angle) * up]
        )
        out = side * (turned[:, 0] - latch.edge)
        hollow = [latch.pocket if beyond <= 0 else latch.keep for beyond in out]
        assert all(
            space.z[0] < height < space.z[1] for space, height in zip(hollow, turned[:, 1], strict=True)
        )
        if turn >= RELEASED * upper:
            assert out.max() < 0.0


def test_leaves_fill_their_frame_but_for_the_gaps_they_need():
    inner = Space(x=(0.0, 0.1), y=(-0.6, 0.6), z=(0.0, 2.0))
    (single,) = hang_leaves(inner, 0.04, count=1, hand=1, sill=0.007)
    assert single.hung == pytest.approx(-0.6, abs=0.004)
    assert (single.hung, single.edge) == single.y
    right, left = hang_leaves(inner, 0.04, count=2, hand=1, sill=0.007)
    assert 0.003 < left.edge - right.edge < 0.012
    assert right.y[1] - right.y[0] == pytest.approx(left.y[1] - left.y[0])
    hung, between, lock = left.stiles(0.1)
    assert (hung[0], lock[1]) == (between[1], between[0])


@pytest.mark.parametrize("kind", LEVER_KINDS)
@pytest.mark.parametrize("out", [-1.0, 1.0])
def test_a_lever_reaches_as_far_as_its_design_says(kind, out):
    design = LeverDesign(kind=kind, length=0.13, reach=0.06)
    corners = np.concatenate(
        [place_vertices(piece) for piece in build_lever(design, (0.0, 0.0, 1.0), out=out)]
    )
    assert (out * corners[:, 0]).max() == pytest.approx(0.06, abs=2e-4)  # the prism within a rod
    assert corners[:, 1].min() == pytest.approx(-0.13, abs=0.004)


PATH = [(0.0, 0.0, 0.0), (0.0, 0.0, 0.2), (0.0, 0.15, 0.2), (0.1, 0.15, 0.2)]


@pytest.mark.parametrize("path", [PATH, PATH[::-1]])
def test_a_bent_tube_is_whole_and_as_thick_as_it_says(path):
    pieces = lay_pipe(path, 0.01, 0.03, "steel", pieces=4)
    assert [piece.kind for piece in pieces].count("cylinder") == 3
    around = [np.array(path[k + 1]) for k in range(2)]
    ways = [np.sign(np.array(path[k + 1]) - path[k]) for k in range(3)]
    turns = np.linspace(0.02, np.pi / 2 - 0.02, 40)[:, None]
    for corner, way, after in zip(around, ways, ways[1:], strict=False):
        center = corner + 0.03 * (after - way)
        middle = center + 0.03 * (np.cos(turns) * way - np.sin(turns) * after)
        assert np.any([contains(piece, middle) for piece in pieces], axis=0).all()
        for bend, inside in ((0.0385, True), (0.0405, False), (0.0215, True), (0.0195, False)):
            spots = center + bend / 0.03 * (middle - center)
            assert np.any([contains(piece, spots) for piece in pieces], axis=0).all() == inside
    legs = np.concatenate([np.linspace(a, b, 50)[1:-1] for a, b in ((path[0], path[1]), (path[2], path[3]))])
    straight = [leg for leg in legs if min(np.linalg.norm(leg - corner) for corner in around) > 0.031]
    assert np.any([contains(piece, np.array(straight)) for piece in pieces], axis=0).all()


def test_a_leaning_rod_runs_from_point_to_point_and_meets_what_it_is_laid_to():
    start, end = np.array([0.1, 0.0, 0.2]), np.array([0.4, 0.05, 0.3])
    rod = lean_rod(tuple(start), tuple(end), (0.01, 0.02), "steel")
    points = place_vertices(rod)
    for center, radius in ((start, 0.01), (end, 0.02)):
        ring = points[np.abs(points[:, 0] - center[0]) < 1e-9]
        assert np.linalg.norm(ring - center, axis=1) == pytest.approx([radius] * SEGMENTS)
    assert lean_rod((0.0, 0.0, 0.0), (0.0, 0.0, 0.1), 0.01, "steel").kind == "cylinder"


@pytest.mark.parametrize(("share", "kept"), [(0.999, False), (1.001, True)])
def test_sizes_may_be_wished_a_little_beyond_what_is_usual(share: float, kept: bool):  # noqa: FBT001
    usual = ((1.0, 2.0), (0.5, 0.6), (3.0, 4.0))
    wished = share * (1.0 - SIZE_MARGIN) * 1.0
    if kept:
        assert choose_size(np.random.default_rng(0), "Sofa", Wish(width=wished), usual)[0] == wished
    else:
        with pytest.raises(ShapeError, match=r"Sofa: width .* expected from 0\.8 to 2\.4 m"):
            choose_size(np.random.default_rng(0), "Sofa", Wish(width=wished), usual)


def test_sizes_take_the_same_numbers_from_the_stream_wished_or_not():
    usual = ((1.0, 2.0), (0.5, 0.6), (3.0, 4.0))
    free, wished = np.random.default_rng(0), np.random.default_rng(0)
    sizes = choose_size(free, "Sofa", Wish(), usual)
    assert choose_size(wished, "Sofa", Wish(depth=0.55), usual) == (sizes[0], 0.55, sizes[2])
    assert free.random() == wished.random()


def judge_opening(shape: Shape, folder: Path, **changes: object) -> dict[str, str]:
    """Verdicts of the checks of motion on a shape's package, by id."""
    write_package(replace(build_reference(shape), **changes), folder)
    return {result.id: result.verdict for result in run_checks(folder, ("L2",))}


def test_a_package_passes_while_it_says_what_the_latch_needs_and_fails_when_it_does_not(tmp_path: Path):
    door = draw_shape("Door", 4, Wish(style="flush"))
    assert judge_opening(door, tmp_path / "said")["V201"] == "pass"
    assert judge_opening(door, tmp_path / "kept", requires_open=())["V201"] == "fail"


@pytest.mark.parametrize(("style", "name"), [("sash", "lift"), ("sliding", "pull")])
def test_the_handle_of_a_door_that_slides_in_its_plane_is_judged_from_before_the_pane(style, name, tmp_path):
    window = draw_shape("Window", 2, Wish(style=style))
    assert find_faults(window) == ()
    assert judge_opening(window, tmp_path / "bow")["V204"] == "pass"
    low, high = next(part for part in window.parts if part.name == name).bounds()
    flush = box((high[0] - 0.003, *low[1:]), tuple(high), "handle")
    parts = tuple(replace(part, primitives=(flush,)) if part.name == name else part for part in window.parts)
    plate = replace(window, parts=parts)
    assert {fault.id for fault in find_faults(plate)} == {"handle"}
    assert judge_opening(plate, tmp_path / "plate")["V204"] == "fail"


@pytest.mark.parametrize("seed", range(12))
def test_both_panes_of_a_sliding_window_open_without_meeting(seed: int):
    window = draw_shape("Window", seed, Wish(style="sliding"))
    names = [part.name for part in window.parts]
    if "rear" not in names:
        assert "bolt" in names
        return
    assert find_faults(window) == ()
    T = pose_parts(window, np.array([part.joint.upper if part.joint else 0.0 for part in window.parts]))
    (front, pull) = (
        transform_points(T[k], window.parts[k].bounds())[:, 1]
        for k in (names.index("front"), names.index("rear_pull"))
    )
    apart = max(front[0] - pull[1], pull[0] - front[1])
    assert 2 * GAP - 1e-9 <= apart < 2 * GAP + 3e-4  # bars are prisms


def test_leaves_of_service_doors_open_by_their_pulls_alone(tmp_path: Path):
    counts = set()
    for seed in range(6):
        door = draw_shape("Door", seed, Wish(style="service"))
        leaves = {part.name for part in door.parts if part.label == "door"}
        counts.add(len(leaves))
        assert {part.parent for part in door.parts if part.label == "handle"} == leaves
        assert not any(part.needs for part in door.parts)
        assert find_faults(door) == ()
    assert counts == {1, 2}
    assert judge_opening(door, tmp_path / "door")["V204"] == "pass"


@pytest.mark.parametrize("seed", range(8))
def test_keypads_of_safes_have_twelve_keys_and_perhaps_one_to_enter(seed: int):
    safe = draw_shape("Safe", seed, Wish(style="keypad"))
    keys = [part for part in safe.parts if part.name.startswith("key_")]
    assert len(keys) in (12, 13)
    lower = [*(part.bounds()[0, 2] for part in keys)]
    assert len({round(z, 6) for z in lower}) == len(keys) - 8  # rows
    door = next(part for part in safe.parts if part.name == "door").bounds()
    plates = np.stack([part.bounds()[:, 1:] for part in keys])
    assert (plates[:, 0].min(axis=0) > door[0, 1:]).all()
    assert (plates[:, 1].max(axis=0) < door[1, 1:]).all()


@pytest.mark.parametrize("seed", range(3))
def test_the_arms_of_a_lamp_stay_wherever_they_are_put(seed: int):
    package = build_reference(draw_shape("DeskLamp", seed))
    for joint in package.joints[:3]:
        moved = subtree_inertial(package.links, package.joints, joint.child)
        arm = np.asarray(moved.com) - joint.origin
        assert joint.friction > 9.81 * moved.mass * np.hypot(arm[0], arm[2])
