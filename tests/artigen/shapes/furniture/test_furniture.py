"""Laws of procedural furniture: what hangs together, what moves freely, what meets the wish."""

from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from typing import get_args

import numpy as np
import pytest
from shape_sweeps import OVERLAP, find_overlaps, links_of, make_hulls

from artigen.shapes.draw import ShapeError, Wish, draw_shape
from artigen.shapes.fittings.feet import make_toe_kick
from artigen.shapes.fittings.fronts import FRONT_STYLES, FrontDesign, make_door, make_front
from artigen.shapes.fittings.handles import HANDLE_KINDS, HandleTrim, design_handle
from artigen.shapes.fittings.hardware import Panel, Space, hinge, sweep_gap
from artigen.shapes.fittings.legs import LEG_KINDS, make_legs, place_legs
from artigen.shapes.fittings.mouldings import build_moulding
from artigen.shapes.furniture.cabinet import list_cells, make_cabinet
from artigen.shapes.furniture.carcass import FRAME_DEPTH, RAIL, CarcassDesign, count_hulls, fits_engines
from artigen.shapes.furniture.furniture_kinds import FORMS, STYLES
from artigen.shapes.furniture.looks import draw_looks
from artigen.shapes.furniture.splits import (
    Cell,
    Fill,
    Inside,
    Node,
    Room,
    Split,
    Taste,
    draw_node,
    lay_out,
    mirror,
    stack_drawers,
)
from artigen.shapes.furniture.table_frames import (
    STRETCHER_KINDS,
    StretcherKind,
    TopKind,
    inset_of_ellipse,
    inset_of_oval,
    make_arch,
    make_panels,
    make_stretchers,
    make_top,
    most_radius,
)
from artigen.shapes.poses import pose_parts
from artigen.shapes.primitives import Primitive, box, contains, place_vertices
from artigen.shapes.shape import Shape, make_base
from artigen.shapes.solids import primitive_bounds
from artigen.shapes.surfaces.palette import draw_palette
from artigen.sketch.faults import find_faults
from artigen.transforms import transform_points
from sim_export.geometry.contacts import signed_distances

CATEGORIES = ("StorageFurniture", "Table", "Cart", "Safe")
SEEDS = (*range(12), 16, 40)  # table 16 has a door, table 40 a screw
TOUCH = 1e-3
PANEL = Panel(x=-0.3, thickness=0.018, y=(-0.2, 0.25), z=(0.3, 0.9))


@pytest.fixture(scope="module", params=CATEGORIES)
def shapes(request: pytest.FixtureRequest) -> list[Shape]:
    return [draw_shape(request.param, seed) for seed in SEEDS]


def test_nothing_is_in_the_way_of_a_joint(shapes: list[Shape]) -> None:
    for shape in shapes:
        assert find_overlaps(shape, poses=7) == [], shape.name


def test_parts_stand_on_the_floor_and_are_in_one_piece(shapes: list[Shape]) -> None:
    for shape in shapes:
        assert shape.bounds()[0, 2] == pytest.approx(0.0, abs=1e-6), shape.name
        for index, part in enumerate(shape.parts):
            if len(part.primitives) == 1:
                continue
            body = make_hulls(shape, [index])
            near = signed_distances(body, body, np.eye(4), np.eye(4), TOUCH)
            reached = {0}
            for _ in part.primitives:
                reached |= {int(b) for a, b in zip(near.first, near.second, strict=True) if int(a) in reached}
            assert len(reached) == len(part.primitives), f"{shape.name}: {part.name} is in pieces"


def test_moving_parts_are_close_to_what_carries_them_and_clear_of_it(shapes: list[Shape]) -> None:
    for shape in shapes:
        names, owners = [part.name for part in shape.parts], links_of(shape)
        for index, part in enumerate(shape.parts):
            if part.parent is None:
                continue
            carrier = owners[names.index(part.parent)]
            around = [k for k, owner in enumerate(owners) if owner == carrier]
            if part.joint is None:
                around = [names.index(part.parent)]
            pair = make_hulls(shape, [index]), make_hulls(shape, around)
            gap = float(signed_distances(*pair, np.eye(4), np.eye(4), 4e-3).distance.min())
            if part.joint is None:
                assert -OVERLAP <= gap <= TOUCH, f"{shape.name}: {part.name} is {gap} m from {part.parent}"
            else:
                assert 0.9e-3 <= gap <= 4e-3, f"{shape.name}: {part.name} is {gap} m from {part.parent}"


def test_engines_can_hold_every_object(shapes: list[Shape]) -> None:
    for shape in shapes:
        assert fits_engines(shape.parts), shape.name
        thinnest = min(solid.size.min() for part in shape.parts for solid in part.primitives)
        assert thinnest >= 3e-3 - 1e-9, shape.name


def test_drawers_stay_held_and_doors_open_as_hardware_does(shapes: list[Shape]) -> None:
    for shape in shapes:
        for part in shape.parts:
            if part.joint is None:
                continue
            depth = float(np.ptp(part.bounds(), axis=0) @ np.abs(part.joint.axis))
            if part.joint.type == "prismatic":
                assert 0.3 * depth < part.joint.upper < 0.9 * depth, f"{shape.name}: {part.name}"
            if part.label == "door" and part.joint.type == "revolute":
                assert np.radians(70) < part.joint.upper < np.radians(171), f"{shape.name}: {part.name}"


def test_wishes_are_met(shapes: list[Shape]) -> None:
    category = shapes[0].category
    wish = Wish(width=0.62, depth=0.42, height=0.72)
    for seed in range(4):
        condition = draw_shape(category, seed, wish).condition
        assert condition.width == pytest.approx(0.62, abs=0.002)
        assert condition.depth == pytest.approx(0.42, abs=0.03)  # handles stand out more or less
        assert condition.height == pytest.approx(0.72, abs=0.002)
    style = shapes[3].style
    assert draw_shape(category, 5, Wish(style=style)).style == style
    with pytest.raises(ShapeError, match="style 'baroque' is not known"):
        draw_shape(category, 0, Wish(style="baroque"))


def test_counts_are_met() -> None:
    shape = draw_shape("StorageFurniture", 1, Wish(counts=(("drawer", 3), ("door", 2))))
    assert dict(shape.condition.counts)["drawer"] == 3
    assert dict(shape.condition.counts)["door"] == 2


def test_a_seeded_defect_is_found() -> None:
    shape = draw_shape("StorageFurniture", 29, Wish(counts=(("drawer", 1),)))
    drawer = next(index for index, part in enumerate(shape.parts) if part.label == "drawer")
    broken = list(shape.parts)
    wide = [box((-0.1, -0.5, 0.3), (0.1, 0.5, 0.4), "drawer")]
    broken[drawer] = replace(broken[drawer], primitives=(*broken[drawer].primitives, *wide))
    assert find_overlaps(shape, poses=3) == []
    assert find_overlaps(replace(shape, parts=tuple(broken)), poses=3) != []


def test_mirror_twice_is_the_same_and_lays_out_reflected() -> None:
    rng = np.random.default_rng(0)
    edges = dict.fromkeys(("left", "right", "top", "bottom"), 0.0)
    taste = Taste(rules=FORMS["sideboard"].taste.rules, fills=FORMS["sideboard"].taste.fills)
    splits = 0
    for _ in range(30):
        node = draw_node(rng, Room(width=1.6, height=0.7, bottom=0.1), taste)
        splits += isinstance(node, Split)
        assert mirror(mirror(node)) == node
        cells, _ = lay_out(node, (-0.8, 0.8), (0.1, 0.8), board=0.018, reach=edges, inset=False)
        turned, _ = lay_out(mirror(node), (-0.8, 0.8), (0.1, 0.8), board=0.018, reach=edges, inset=False)
        there = sorted((round(c.y[0], 9), round(c.y[1], 9), round(c.z[0], 9)) for c in cells)
        back = sorted((round(-c.y[1], 9), round(-c.y[0], 9), round(c.z[0], 9)) for c in turned)
        assert np.allclose(there, back)
    assert splits > 20


def test_cells_fill_the_opening_but_for_boards() -> None:
    drawer = Cell(fill="drawer")
    rows = Split(along="rows", shares=(1.0, 2.0), children=(drawer, drawer), board=False)
    node = Split(along="columns", shares=(1.0, 1.0), children=(rows, Cell(fill="door")))
    edges = {"left": 0.0175, "right": 0.0175, "top": 0.0175, "bottom": 0.0175}
    cells, boards = lay_out(node, (-0.5, 0.5), (0.0, 0.9), board=0.02, reach=edges, inset=False)
    areas = sum((c.y[1] - c.y[0]) * (c.z[1] - c.z[0]) for c in cells)
    wood = sum((y[1] - y[0]) * (z[1] - z[0]) for y, z in boards)
    assert areas + wood == pytest.approx(0.9)
    assert len(boards) == 1
    upper, lower = cells[0], cells[1]
    assert upper.y[1] == 0.5, "the first column is on the left"
    assert upper.z[0] > lower.z[0], "the first row is on top"
    assert (upper.z[1] - upper.z[0]) * 2 == pytest.approx(lower.z[1] - lower.z[0])
    assert upper.front_z[0] - lower.front_z[1] == pytest.approx(0.003)
    assert cells[2].shared == {"left"}


@pytest.mark.parametrize("edge", ["left", "right", "top", "bottom"])
def test_doors_open_towards_the_viewer_within_their_outline(edge: str) -> None:
    motion = hinge(PANEL, edge, np.pi / 2)
    solid = make_front(PANEL, FrontDesign(style="flat", frame=0.0, handle=None))[0]
    shape = draw_shape("Safe", 0)
    door = replace(shape.parts[1], primitives=(solid,), joint=motion)
    opened = replace(shape, parts=(shape.parts[0], door))
    for share in np.linspace(0.0, 1.0, 11):
        T = pose_parts(opened, np.array([0.0, share * np.pi / 2]))[1]
        points = transform_points(T, place_vertices(solid))
        room = sweep_gap(max(PANEL.width, PANEL.height), PANEL.thickness)
        assert points[:, 0].max() <= PANEL.back + 1e-9
        assert points[:, 1].min() >= PANEL.y[0] - room
        assert points[:, 1].max() <= PANEL.y[1] + room
        assert points[:, 2].min() >= PANEL.z[0] - room
        assert points[:, 2].max() <= PANEL.z[1] + room
    assert points[:, 0].min() < PANEL.x - 0.4


@pytest.mark.parametrize("kind", HANDLE_KINDS)
@pytest.mark.parametrize("trim", get_args(HandleTrim))
@pytest.mark.parametrize("edge", ["left", "right", "top", "bottom"])
def test_handles_sit_on_the_free_side_and_touch_the_front(kind: str, trim: str, edge: str) -> None:
    rng = np.random.default_rng(1)
    handle = design_handle(rng, kind, longest=0.9, trim=trim)
    for style in FRONT_STYLES:
        design = FrontDesign(style=style, frame=0.06, handle=handle)
        door, grip = make_door(PANEL, design, name="door", parent="body", edge=edge, upper=1.5)
        low, high = grip.bounds()
        center = (low + high)[1:] / 2 - np.array(PANEL.center)
        away = {"left": -center[0], "right": center[0], "top": -center[1], "bottom": center[1]}[edge]
        assert away > 0.1, "on the side away from the hinge"
        assert high[0] == pytest.approx(PANEL.x, abs=1e-9)
        assert PANEL.x - low[0] <= handle.reach + 0.02
        behind = np.array([[PANEL.x + 1e-4, *((low + high)[1:] / 2 - np.where(center > 0, 6e-3, -6e-3))]])
        assert kind in ("arch", "bar", "pull", "cup") or any(
            contains(solid, behind).any() for solid in door.primitives
        )


@pytest.mark.parametrize("kind", LEG_KINDS)
@pytest.mark.parametrize("height", [0.15, 0.7])
def test_legs_stand_within_their_rectangle_and_their_pieces_on_each_other(kind: str, height: float) -> None:
    x, y, width = (-0.3, 0.3), (-0.6, 0.6), 0.05
    legs = place_legs(x, y, height, kind=kind, width=width, finish="leg")
    points = np.concatenate([place_vertices(piece) for leg in legs for piece in leg])
    assert points.min(axis=0) == pytest.approx([x[0], y[0], 0.0], abs=0.06 * width)
    assert points.max(axis=0) == pytest.approx([x[1], y[1], height], abs=0.06 * width)
    assert (points.min(axis=0) >= (x[0] - 1e-9, y[0] - 1e-9, -1e-9)).all()
    for leg in legs:
        spans = [np.percentile(place_vertices(piece)[:, 2], (0, 100)) for piece in leg]
        assert all(low[1] >= high[0] - 1e-9 for low, high in pairwise(spans))


def test_a_moulded_top_covers_what_is_below_its_flare() -> None:
    board, flare = build_moulding((-0.2, 0.2), (-0.5, 0.5), (0.7, 0.74), 0.02, "top")
    low, high = (
        np.array([place_vertices(one).min(axis=0), place_vertices(one).max(axis=0)]) for one in (flare, board)
    )
    assert low[1, 2] == pytest.approx(high[0, 2])
    np.testing.assert_allclose(low[:, :2], high[:, :2], atol=1e-9)
    foot = place_vertices(flare)[np.isclose(place_vertices(flare)[:, 2], 0.7)]
    np.testing.assert_allclose([foot.min(axis=0)[:2], foot.max(axis=0)[:2]], [(-0.18, -0.48), (0.2, 0.48)])


def test_an_arched_panel_stays_within_the_frame_of_its_door() -> None:
    plain = FrontDesign(style="raised", frame=0.06, handle=None)
    square, arched = (make_front(PANEL, replace(plain, arched=one))[-1] for one in (False, True))
    np.testing.assert_allclose(primitive_bounds(arched), primitive_bounds(square), atol=1e-9)
    assert len(arched.vertices) > len(square.vertices)


def test_every_fill_and_inside_occurs() -> None:
    rng = np.random.default_rng(3)
    cells = []
    for kind in FORMS.values():
        for _ in range(60):
            width, height = (float(rng.uniform(*span)) for span in kind.spans[::2])
            room = Room(width=width, height=0.9 * height, bottom=0.1)
            cells += list_cells(draw_node(rng, room, kind.taste))
    assert {cell.fill for cell in cells} == set(get_args(Fill))
    assert {cell.inside for cell in cells} == set(get_args(Inside))


def test_every_joint_type_occurs(shapes: list[Shape]) -> None:
    joints = {part.joint.type for shape in shapes for part in shape.parts if part.joint}
    assert (
        joints
        >= {
            "StorageFurniture": {"revolute", "prismatic"},
            "Table": {"revolute", "prismatic", "screw"},
            "Cart": {"prismatic", "continuous"},
            "Safe": {"revolute", "continuous"},
        }[shapes[0].category]
    )


def test_oblong_boards_count_as_several_hulls() -> None:
    assert count_hulls([box((0, 0, 0), (0.01, 0.59, 0.3), "body")]) == 1
    assert count_hulls([box((0, 0, 0), (0.01, 0.6, 1.19), "body")]) == 2 * 3


def test_locks_of_safes_stay_clear_of_the_body_when_the_door_folds_back():
    folded = 0
    for seed in (*range(30), 1032):  # that one has a wide lever on a narrow door
        shape = draw_shape("Safe", seed)
        names = [part.name for part in shape.parts]
        body, door = shape.parts[names.index("body")], shape.parts[names.index("door")]
        if door.joint.upper < np.radians(100.0):
            continue
        walls = np.concatenate([place_vertices(solid) for solid in body.primitives])
        low, high = walls.min(axis=0), walls.max(axis=0)
        q = np.zeros(len(shape.parts))
        q[names.index("door")] = door.joint.upper
        T = pose_parts(shape, q)
        for index, part in enumerate(shape.parts):
            if part.parent != "door":
                continue
            points = np.concatenate([place_vertices(solid) for solid in part.primitives])
            points = transform_points(T[index], points)
            behind = points[points[:, 0] > low[0]]
            folded += len(behind)
            assert (np.maximum(low[1] - behind[:, 1], behind[:, 1] - high[1]) > 0.002).all()
    assert folded


OUTER = Space(x=(-0.3, 0.3), y=(-0.5, 0.5), z=(0.1, 0.9))
LAYOUTS: tuple[Node, ...] = (
    Cell(fill="double", inside="shelves", count=2),
    Split(along="columns", shares=(1.0, 1.0), children=(Cell(fill="door"), stack_drawers((1.0, 2.0)))),
    Split(
        along="rows",
        shares=(1.0, 3.0),
        children=(Cell(fill="blank"), Cell(fill="door", inside="trays", count=2)),
    ),
)


def _cabinet(node: Node, carcass: CarcassDesign, *, inset: bool = False) -> Shape:
    """A cabinet in `OUTER` with flat fronts and the given boards."""
    rng = np.random.default_rng(0)
    looks = draw_looks(rng, STYLES["flat"], 1.0, Wish())
    looks = replace(looks, carcass=carcass, inset=inset, doors=replace(looks.doors, handle=None), lock=False)
    looks = replace(looks, drawers=replace(looks.drawers, handle=None))
    built = make_cabinet(node, OUTER, looks)
    body = make_base(built.pieces)
    finishes = tuple(sorted(draw_palette(rng, "furniture", "flat").items()))
    return Shape(
        category="StorageFurniture", seed=0, style="flat", parts=(body, *built.parts), finishes=finishes
    )


@pytest.mark.parametrize("node", LAYOUTS)
@pytest.mark.parametrize("place", ["before", "within"])
def test_what_is_behind_a_face_frame_passes_through_it_and_is_held(node: Node, place: str) -> None:
    shape = _cabinet(node, CarcassDesign(frame=0.04, recess=0.015), inset=place == "within")
    assert not find_faults(shape)
    low, high = shape.bounds()
    assert (low[1:], high[1:]) == (pytest.approx([-0.5, 0.1]), pytest.approx([0.5, 0.9]))


def test_fronts_leave_a_face_frame_in_sight_on_all_sides() -> None:
    for node in LAYOUTS:
        shape = _cabinet(node, CarcassDesign(frame=0.04))
        fronts = [part.bounds() for part in shape.parts if part.label in ("door", "drawer")]
        assert all(
            (front[0, 1:] > (-0.48, 0.12)).all() and (front[1, 1:] < (0.48, 0.88)).all() for front in fronts
        )


def test_a_top_of_rails_is_open_in_the_middle_and_closed_in_front_and_behind() -> None:
    body = _cabinet(LAYOUTS[0], CarcassDesign(rails=True)).parts[0]
    probes = np.array([(x, 0.0, 0.89) for x in np.linspace(-0.27, 0.28, 56)])
    filled = np.any([contains(solid, probes) for solid in body.primitives], axis=0)
    assert filled[[0, -1]].all()
    assert not filled[20:36].any()


@pytest.mark.parametrize("notch", [0.0, 0.07])
def test_a_toe_kick_leaves_room_between_its_sides_or_all_along(notch: float) -> None:
    solids = make_toe_kick((-0.3, 0.3), (-0.4, 0.4), 0.1, notch)
    toes = np.array([(-0.27, y, 0.05) for y in (-0.395, -0.2, 0.0, 0.2, 0.395)])
    filled = np.any([contains(solid, toes) for solid in solids], axis=0)
    assert filled.tolist() == [not notch, False, False, False, not notch]
    corners = np.concatenate([place_vertices(solid) for solid in solids])
    assert corners.min(axis=0)[1:] == pytest.approx((-0.4, 0.0))
    assert corners.max(axis=0) == pytest.approx((0.3, 0.4, 0.1))


def test_frames_open_tops_and_blank_boards_occur() -> None:
    seen: set[str] = set()
    for seed in range(60):
        body = draw_shape("StorageFurniture", seed).parts[0]
        depths = [round(float(solid.size[0]), 6) for solid in body.primitives]
        seen |= {"frame"} if depths[:4] == [FRAME_DEPTH] * 4 else set()
        seen |= {"rails"} if depths.count(RAIL) == 2 else set()
        seen |= {"blank"} if any(solid.finish == "front" for solid in body.primitives) else set()
    assert seen == {"frame", "rails", "blank"}


LEGS = make_legs((-0.3, 0.3), (-0.6, 0.6), 0.7, kind="tapered", width=0.05, finish="leg")


def _filled(solids: Iterable[Primitive], points: np.ndarray) -> np.ndarray:
    return np.any([contains(solid, points) for solid in solids], axis=0)


@pytest.mark.parametrize("kind", get_args(TopKind))
def test_a_top_is_as_wide_and_deep_as_asked_symmetric_and_covers_the_legs_below(kind: TopKind) -> None:
    ahead, aside = 0.04, 0.03
    if kind == "oval":
        aside = inset_of_oval(0.8, ahead)
    if kind == "ellipse":
        ahead = 0.1
        aside = inset_of_ellipse(1.6, 0.8, ahead)
    top = make_top(1.6, 0.8, (0.7, 0.73), kind, most_radius(ahead, aside))
    corners = np.concatenate([primitive_bounds(solid) for solid in top])
    assert corners.min(axis=0) == pytest.approx((-0.4, -0.8, 0.7))
    assert corners.max(axis=0) == pytest.approx((0.4, 0.8, 0.73))
    grid = np.stack(np.meshgrid(np.linspace(-0.41, 0.41, 83), np.linspace(-0.81, 0.81, 83)), axis=-1).reshape(
        -1, 2
    )
    points = np.column_stack([grid, np.full(len(grid), 0.715)])
    filled = _filled(top, points)
    assert (filled == _filled(top, points * (-1, 1, 1))).all()
    assert (filled == _filled(top, points * (1, -1, 1))).all()
    feet = np.array(
        [(a * (0.4 - ahead - 1e-4), b * (0.8 - aside - 1e-4), 0.715) for a in (-1, 1) for b in (-1, 1)]
    )
    assert _filled(top, feet).all()
    assert _filled(top, np.array([(0.396, 0.796, 0.715)])).all() == (kind == "plain")


@pytest.mark.parametrize("kind", STRETCHER_KINDS)
def test_stretchers_run_from_leg_to_leg_without_an_end_in_sight(kind: StretcherKind) -> None:
    bars = make_stretchers(LEGS, 0.1, 0.02, kind)
    x, y = (0.2749, 0.5749)  # the axes of the legs
    ends = np.array([(a * x, b * y, 0.11) for a in (-1, 1) for b in (-1, 1)])
    assert _filled(bars, ends).all()
    assert _filled(LEGS, ends).all()
    assert _filled(bars, np.array([(0.0, y, 0.11), (0.0, -y, 0.11)])).all()
    across = np.array([(at, 0.0, 0.11) for at in (-x, 0.0, x)])
    expected = {"h": [False, True, False], "ring": [True, False, True], "rear": [False, False, True]}
    assert _filled(bars, across).tolist() == expected[kind]


def test_an_arch_hangs_down_at_its_ends_alone_and_is_symmetric() -> None:
    arch = make_arch((0.0, 0.02), (-0.5, 0.5), (0.6, 0.63), 0.05)
    corners = np.concatenate([place_vertices(solid) for solid in arch])
    assert corners.min(axis=0) == pytest.approx((0.0, -0.5, 0.55))
    assert corners.max(axis=0) == pytest.approx((0.02, 0.5, 0.63))
    across = np.linspace(-0.499, 0.499, 101)
    below = {z: _filled(arch, np.array([(0.01, y, z) for y in across])) for z in (0.56, 0.59, 0.599, 0.615)}
    assert all((row == row[::-1]).all() for row in below.values())
    shares = [row.mean() for row in below.values()]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert not below[0.599][45:56].any()
    assert below[0.56][0]


def test_closed_sides_are_between_the_legs_and_leave_the_front_open() -> None:
    panels = make_panels(LEGS, (0.3, 0.7))
    assert _filled(panels, np.array([(0.0, 0.575, 0.5), (0.0, -0.575, 0.5), (0.275, 0.0, 0.5)])).all()
    assert not _filled(panels, np.array([(-0.275, 0.0, 0.5)])).any()
    corners = np.concatenate([place_vertices(solid) for solid in panels])
    assert (np.abs(corners[:, :2]).max(axis=0) <= (0.3, 0.6)).all()


@pytest.mark.slow
def test_tables_have_tops_of_all_kinds_and_bars() -> None:
    seen: set[str] = set()
    for seed in range(160):
        body = draw_shape("Table", seed).parts[0]
        tops = [solid for solid in body.primitives if solid.finish == "top"]
        single = "ellipse" if max((len(solid.vertices) for solid in tops), default=0) == 64 else "plain"
        seen |= {1: {single}, 2: {"moulded"}, 3: {"oval"}, 7: {"rounded"}}.get(len(tops), set())
        legs = [solid.size for solid in body.primitives if solid.finish == "leg"]
        seen |= {"bars"} if any(max(size[:2]) > 6 * size[2] for size in legs) else set()
    assert seen == {"plain", "oval", "rounded", "ellipse", "moulded", "bars"}
