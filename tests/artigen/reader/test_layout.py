"""Laws of building what was read: every reading of fronts gives them in the same rows and columns."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from jaxtyping import Float
from scipy.optimize import least_squares

from artigen.errors import ArtigenError
from artigen.kind import kinds
from artigen.reader.layout import fronts
from artigen.reader.layout.build import FLOOR, build_from_reading, find_foot, wear_read
from artigen.reader.layout.cells import OPEN, Seen, make_cells
from artigen.reader.layout.colours import BLACK, PALE, SAME, WARM, find_finishes, is_wooden, tint_finish
from artigen.reader.layout.contents import CLOSED, furnish_node
from artigen.reader.layout.cutting import RAGGED, SLACK, Tree, cut_rectangles, list_leaves
from artigen.reader.layout.frontal import read_shape
from artigen.reader.layout.fronts import ASIDE, FREE_COST, GUESSED, view_fronts
from artigen.reader.layout.nearest import HINGE, rate_difference
from artigen.reader.layout.plane import Plane, Sight, frame_box, map_face
from artigen.reader.reading import Reading, ReadPart
from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.furniture.cabinet import list_cells
from artigen.shapes.furniture.carcass import HULL_RATIO, fits_engines
from artigen.shapes.furniture.case import BACK_HULLS
from artigen.shapes.furniture.layouts import Layout
from artigen.shapes.furniture.splits import Cell, Node, Split
from artigen.shapes.shape import Shape
from artigen.shapes.surfaces.color_difference import convert_to_lab
from artigen.shapes.surfaces.materials import WOODS, make_wood

DRAWN = [("StorageFurniture", seed) for seed in range(4)] + [("Dresser", seed) for seed in range(3)]
DRAWN += [("Wardrobe", seed) for seed in range(2)] + [("FilingCabinet", 0)]
OTHER: dict[str | None, str | None] = {"left": "right", "right": "left"}


def make_front(label: str, box: tuple[float, ...], **known: object) -> ReadPart:
    return ReadPart(label=label, score=1.0, box=np.array(box), **known)  # type: ignore[arg-type]


def make_reading(*parts: ReadPart, kind: str = "StorageFurniture", **known: object) -> Reading:
    plain = Reading(
        kind=kind,
        kinds=((kind, 1.0),),
        box=np.array([0.0, 0.0, 1.0, 1.0]),
        parts=parts,
        size=(1.0, 0.5, 1.0),
        view=(0.0, 0.0, 1e-3),
        stand="flat",
        color=(200, 190, 170),
        extent=(800, 800),
    )
    return replace(plain, **known)  # type: ignore[arg-type]


def stack(*edges: float, left: float = 0.0, right: float = 1.0) -> list[ReadPart]:
    """Drawers between these heights."""
    return [make_front("drawer", (left, top, right, bottom)) for top, bottom in pairwise(edges)]


CUPBOARD = make_reading(
    make_front("door", (0.02, 0.02, 0.38, 0.6), hinge="left"),
    *stack(0.02, 0.2, 0.4, 0.6, left=0.39, right=0.98),
    make_front("drawer", (0.02, 0.61, 0.98, 0.97)),
)
"""A door beside three drawers, over a wide drawer."""


def describe(tree: Tree, fronts: tuple[ReadPart, ...]) -> object:
    """Labels and hinges in rows and columns."""
    if isinstance(tree, int):
        return fronts[tree].label, fronts[tree].hinge
    return tree.along, *(describe(child, fronts) for child in tree.children)


def describe_fronts(reading: Reading) -> object:
    fronts = reading.fronts
    boxes = np.stack([front.box for front in fronts])
    return describe(cut_rectangles(boxes, [front.label == "drawer" for front in fronts]).tree, fronts)


def place_fronts(shape: Shape) -> Float[np.ndarray, "N 4"]:
    """Boxes of the fronts in the order of their cuts, within the hull of all."""
    fronts = read_shape(shape).fronts
    boxes = np.stack([front.box for front in fronts])
    order = list_leaves(cut_rectangles(boxes, [front.label == "drawer" for front in fronts]).tree)
    low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    return (boxes[order] - np.tile(low, 2)) / np.tile(high - low, 2)


def mirror_part(part: ReadPart) -> ReadPart:
    left, top, right, bottom = part.box
    hinge = OTHER.get(part.hinge, part.hinge)
    return replace(part, box=np.array([1 - right, top, 1 - left, bottom]), hinge=hinge)


def mirror_reading(reading: Reading) -> Reading:
    return replace(reading, parts=tuple(mirror_part(part) for part in reading.parts))


@pytest.mark.parametrize(("kind", "seed"), DRAWN)
def test_a_shape_that_is_read_is_built_again(kind: str, seed: int):
    shape = draw_shape(kind, seed)
    reading = read_shape(shape)
    if not reading.fronts:
        pytest.skip("nothing but open cells")
    if any(front.label == "door" and front.hinge is None for front in reading.fronts):
        pytest.skip("nothing shows where a door is hinged")
    built, _ = build_from_reading(reading, seed + 1)
    again = read_shape(built)
    assert describe_fronts(again) == describe_fronts(reading)
    np.testing.assert_allclose(place_fronts(built), place_fronts(shape), atol=0.05)
    assert again.counts["handle"] == reading.counts["handle"]
    np.testing.assert_allclose(again.size[0::2], reading.size[0::2], rtol=0.02)


@pytest.mark.parametrize("width", [0.5, 1.6])
def test_a_given_width_overrules_and_keeps_proportions(width: float):
    free, _ = build_from_reading(CUPBOARD, 3)
    built, _ = build_from_reading(CUPBOARD, 3, Wish(width=width))
    depths, widths, heights = np.diff([*free.bounds(), *built.bounds()], axis=0)[::2].T
    assert widths[1] == pytest.approx(width, abs=1e-6)
    assert heights[1] / widths[1] == pytest.approx(heights[0] / widths[0])
    assert depths[1] / widths[1] == pytest.approx(depths[0] / widths[0], rel=0.05)
    assert describe_fronts(read_shape(built)) == describe_fronts(CUPBOARD)


def test_a_mirrored_reading_gives_the_mirrored_object():
    built, other = (read_shape(build_from_reading(own, 5)[0]) for own in (CUPBOARD, mirror_reading(CUPBOARD)))
    assert describe_fronts(other) == describe_fronts(mirror_reading(built))
    ends = [
        np.sort(np.stack([front.box for front in own.fronts]), axis=0)
        for own in (other, mirror_reading(built))
    ]
    np.testing.assert_allclose(ends[0], ends[1], atol=0.01)


@pytest.mark.parametrize("seed", range(6))
def test_small_errors_of_boxes_change_no_tree(seed: int):
    rng = np.random.default_rng(seed)
    moved = [replace(part, box=part.box + rng.uniform(-0.008, 0.008, 4)) for part in CUPBOARD.parts]
    built, _ = build_from_reading(replace(CUPBOARD, parts=tuple(moved)), 0)
    assert describe_fronts(read_shape(built)) == describe_fronts(CUPBOARD)


def look_from(points: Float[np.ndarray, "*N 2"], aside: float, above: float) -> Float[np.ndarray, "*N 2"]:
    """Points of a plane in the picture of a camera that sees it at a slant."""
    x, y = points[..., 0] - 0.5, points[..., 1] - 0.5
    near = 1.0 + aside * x - above * y
    return np.stack([0.5 + 0.6 * x / near, 0.5 + 0.6 * (y + 0.3 * aside * x) / near], axis=-1)


@pytest.mark.parametrize(("aside", "above"), [(0.5, 0.0), (-0.5, 0.2), (0.0, -0.3)])
def test_corners_at_a_slant_are_as_good_as_a_view_from_ahead(aside: float, above: float):
    parts = []
    for part in CUPBOARD.parts:
        left, top, right, bottom = part.box
        corners = look_from(
            np.array([(left, top), (right, top), (right, bottom), (left, bottom)]), aside, above
        )
        box = np.concatenate([corners.min(axis=0), corners.max(axis=0)])
        parts.append(replace(part, box=box, corners=corners))
    boxes = np.stack([part.box for part in parts])
    hull = np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)])
    slanted = view_fronts(replace(CUPBOARD, parts=tuple(parts), box=hull))
    straight = view_fronts(CUPBOARD)

    def place(view: object) -> Float[np.ndarray, "N 4"]:
        bounds = np.stack([front.bounds for front in view.fronts])  # type: ignore[attr-defined]
        low, high = bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)
        return (bounds - np.tile(low, 2)) / np.tile(high - low, 2)

    assert slanted.tree == straight.tree
    np.testing.assert_allclose(place(slanted), place(straight), atol=0.03)


def test_boxes_alone_tell_a_slanted_row():
    """The boxes of the fronts of a view from the side overlap in height; their edges still meet in one
    point."""
    quads = [
        look_from(np.array([(x, y), (x + 0.3, y), (x + 0.3, y + 0.3), (x, y + 0.3)]), 0.8, 0.0)
        for x in (0.02, 0.35, 0.68)
        for y in (0.02, 0.34, 0.66)
    ]
    parts = [make_front("drawer", (*quad.min(axis=0), *quad.max(axis=0))) for quad in quads]
    view = view_fronts(make_reading(*parts, box=np.array([0.0, 0.0, 1.0, 1.0])))
    heights = np.array([front.bounds[[1, 3]] for front in view.fronts]).reshape(3, 3, 2)
    assert np.ptp(heights, axis=0).max() < 0.08 * np.ptp(heights)


def test_seeds_differ_in_what_is_hidden_only():
    built = [build_from_reading(CUPBOARD, seed)[0] for seed in range(6)]
    assert len({describe_fronts(read_shape(shape)) for shape in built}) == 1
    assert len({dict(shape.condition.counts).get("shelf", 0) for shape in built}) > 1
    assert len({dict(shape.finishes)["body"].color for shape in built}) == 1
    again, _ = build_from_reading(CUPBOARD, 2)
    assert repr(again.parts) == repr(built[2].parts)


@pytest.mark.parametrize(("size", "opened"), [(OPEN - 0.01, 0), (OPEN + 0.01, 1)])
def test_what_no_front_covers_is_open_from_the_width_of_a_hand(size: float, opened: int):
    """Below it, a front fills the place; a metre is one unit of the picture."""
    reading = make_reading(*stack(0.0, 0.5), *stack(0.5 + size, 1.0))
    built = read_shape(build_from_reading(reading, 0)[0])
    upper, lower = sorted((front.box for front in built.fronts), key=lambda box: box[1])
    assert (lower[1] - upper[3] > 0.1) == bool(opened)


@pytest.mark.parametrize(
    ("below", "kinds"), [(FLOOR - 0.01, ("floor",)), (FLOOR + 0.01, ("plinth", "toe_kick"))]
)
def test_a_plinth_shows_below_the_fronts(below: float, kinds: tuple[str, ...]):
    reading = make_reading(*stack(0.0, 0.5, 1.0 - below))
    assert find_foot(reading, view_fronts(reading), reading.kind).kinds == kinds


def test_legs_are_as_high_as_read():
    reading = make_reading(*stack(0.0, 0.35, 0.7), stand="legs")
    built = read_shape(build_from_reading(reading, 1)[0])
    assert max(front.box[3] for front in built.fronts) == pytest.approx(0.7, abs=0.05)


def test_wheels_are_built():
    built, _ = build_from_reading(make_reading(*stack(0.0, 0.5, 0.9), stand="wheels"), 1)
    assert dict(built.condition.counts)["wheel"] == 4


@pytest.mark.parametrize(("aside", "hinge"), [(ASIDE + 0.02, "left"), (-ASIDE - 0.02, "right")])
def test_hinges_are_opposite_to_the_handle(aside: float, hinge: str):
    door = make_front("door", (0.0, 0.0, 1.0, 1.0))
    at = 0.5 + aside
    handle = make_front("handle", (at - 0.01, 0.4, at + 0.01, 0.6), form="bar")
    built = read_shape(build_from_reading(make_reading(door, handle, size=(0.5, 0.5, 0.8)), 0)[0])
    assert [front.hinge for front in built.fronts] == [hinge]
    assert built.counts["handle"] == 1


def test_handles_and_panes_are_where_they_were_read():
    glazed = make_front("door", (0.0, 0.0, 0.5, 1.0), hinge="left", pane=True)
    plain = make_front("door", (0.5, 0.0, 1.0, 1.0), hinge="right")
    handle = make_front("handle", (0.47, 0.45, 0.49, 0.48), form="knob")
    built = read_shape(build_from_reading(make_reading(glazed, plain, handle), 4)[0])
    assert [front.pane for front in built.fronts] == [True, False]
    assert [part.form for part in built.parts if part.label == "handle"] == ["knob"]


def test_an_open_drawer_is_closed_into_the_free_place():
    opened = make_front("drawer", (-0.1, 0.4, 0.95, 0.9), open=True)
    built, notes = build_from_reading(make_reading(*stack(0.0, 0.33), opened, *stack(0.66, 1.0)), 0)
    tops = sorted(float(front.box[1]) for front in read_shape(built).fronts)
    np.testing.assert_allclose(tops, (0.0, 0.33, 0.66), atol=0.06)
    assert any("open" in note for note in notes)


def test_fronts_that_overlap_are_parted_and_said():
    parts = [*stack(0.0, 0.6), *stack(0.4, 1.0)]
    reading = make_reading(*(replace(part, corners=frame_box(part.box)) for part in parts))
    built, notes = build_from_reading(reading, 0)
    assert read_shape(built).counts["drawer"] == 2
    assert any("overlap" in note for note in notes)


def test_a_front_that_was_read_twice_is_built_once():
    twice = [replace(part, box=part.box + 0.01, score=0.5) for part in stack(0.0, 0.5)]
    built, notes = build_from_reading(make_reading(*stack(0.0, 0.5, 1.0), *twice), 0)
    assert read_shape(built).counts["drawer"] == 2
    assert any("left out" in note for note in notes)


def test_more_fronts_than_engines_hold_are_merged_and_said():
    many = [
        part
        for column in range(4)
        for part in stack(*np.linspace(0, 1, 12), left=column / 4, right=(column + 1) / 4)
    ]
    built, notes = build_from_reading(make_reading(*many, size=(1.2, 0.4, 1.2)), 0)
    assert fits_engines(built.parts)
    assert any("can be built" in note for note in notes)


@pytest.mark.parametrize("kind", ["Oven", "Faucet"])
def test_a_kind_without_cells_has_no_layout(kind: str):
    with pytest.raises(ArtigenError, match="cannot be laid out"):
        draw_shape(kind, 0, Wish(layout=Layout(node=Cell(fill="drawer"))))


def test_a_width_out_of_bounds_is_refused():
    with pytest.raises(ArtigenError, match=r"width 0\.001 m"):
        build_from_reading(CUPBOARD, 0, Wish(width=0.001))


def test_a_desk_has_room_for_knees():
    pedestals = [
        *stack(0.1, 0.3, 0.6, 0.95, left=0.02, right=0.3),
        *stack(0.1, 0.5, 0.95, left=0.7, right=0.98),
    ]
    built, notes = build_from_reading(make_reading(*pedestals, kind="Table", size=(1.5, 0.6, 0.75)), 0)
    reading = read_shape(built)
    assert reading.counts["drawer"] == 5
    assert notes == ("no pull was read: fronts have grips in their edges",)
    lefts = sorted(float(front.box[0]) for front in reading.fronts)
    assert lefts[3] - max(float(front.box[2]) for front in reading.fronts if front.box[0] < 0.5) > 0.3


def test_other_filing_cabinets_are_built_as_cabinets():
    both = [*stack(0.0, 0.5, 1.0, right=0.5), *stack(0.0, 0.5, 1.0, left=0.5)]
    built, notes = build_from_reading(make_reading(*both, kind="FilingCabinet"), 0)
    assert built.category == "StorageFurniture"
    assert any("stack" in note for note in notes)


@pytest.mark.parametrize(("over", "crossed"), [(SLACK - 0.01, False), (SLACK + 0.01, True)])
def test_slight_overlap_is_no_overlap(over: float, *, crossed: bool):
    cutting = cut_rectangles(np.array([(0, 0, 1, 1), (0, 1 - over, 1, 2 - over)]), [True, True])
    assert bool(cutting.crossed) == crossed
    assert list_leaves(cutting.tree) == [0, 1]


def test_a_pinwheel_is_cut_all_the_same():
    wheel = [(0, 0, 2, 1), (2, 0, 3, 2), (1, 2, 3, 3), (0, 1, 1, 3), (1, 1, 2, 2)]
    cutting = cut_rectangles(np.array(wheel, dtype=float), [False] * 5)
    assert sorted(list_leaves(cutting.tree)) == [0, 1, 2, 3, 4]
    assert cutting.crossed


@pytest.mark.parametrize(("hue", "chroma", "light"), [(WARM[0], 30, 50), (WARM[1], 30, 50), (70, PALE, 50)])
@pytest.mark.parametrize("inwards", [False, True])
def test_boundaries_of_the_colours_of_woods(hue: float, chroma: float, light: float, *, inwards: bool):
    """Woods of the grammar are within them, and dark ones may be grey."""
    step = 1.5 if inwards else -1.5
    turned = hue + step * ((hue == WARM[0]) - (hue == WARM[1]))
    at = light, chroma + step * (chroma == PALE), np.radians(turned)
    found = least_squares(
        lambda color: convert_to_lab(color) - (at[0], at[1] * np.cos(at[2]), at[1] * np.sin(at[2])),
        np.full(3, 0.5),
    )
    red, green, blue = found.x.tolist()
    assert is_wooden((red, green, blue)) == inwards
    assert all(is_wooden(color) for color, _ in WOODS.values())


@pytest.mark.parametrize(("more", "wooden"), [(-1.0, True), (1.0, False)])
def test_black_may_be_wood_and_grey_is_none(more: float, *, wooden: bool):
    value = least_squares(lambda grey: convert_to_lab(np.repeat(grey, 3))[0] - BLACK - more, 0.1).x[0]
    assert is_wooden((float(value),) * 3) == wooden


def test_fronts_of_appliances_are_no_glass_and_red_ones_no_wood():
    red = make_front("drawer", (0.0, 0.0, 1.0, 1.0), color=(190, 30, 20), material="wood")
    assert find_finishes(make_reading(red), 0)["front"].kind == "lacquer"
    dark = make_front("door", (0.0, 0.0, 1.0, 1.0), color=(20, 20, 20), material="glass", pane=True)
    found = find_finishes(make_reading(dark, kind="Dishwasher"), 0)["front"]
    assert found.kind == "lacquer"
    assert max(found.color) < 0.1


@pytest.mark.parametrize(("step", "same"), [(SAME - 0.02, True), (SAME + 0.02, False)])
def test_a_body_of_nearly_the_same_colour_has_the_finish_of_its_fronts(step: float, *, same: bool):
    front = make_front("drawer", (0.0, 0.0, 1.0, 1.0), color=(150, 110, 70), material="wood")
    red, green, blue = (value + round(255 * step) for value in (150, 110, 70))
    found = find_finishes(make_reading(front, color=(red, green, blue)), 0)
    assert (found["body"] == found["front"]) == same
    assert found["front"].kind == "wood"
    np.testing.assert_allclose(found["front"].color, np.array((150, 110, 70)) / 255)


FRIDGES = {
    "single": [("door", "right", (0, 0, 1, 1))],
    "top freezer": [("door", "left", (0, 0, 1, 0.3)), ("door", "left", (0, 0.3, 1, 1))],
    "bottom freezer": [("door", "right", (0, 0, 1, 0.62)), ("door", "right", (0, 0.62, 1, 1))],
    "even": [("door", "right", (0, 0, 1, 0.5)), ("door", "right", (0, 0.5, 1, 1))],
    "side by side": [("door", "left", (0, 0, 0.4, 1)), ("door", "right", (0.4, 0, 1, 1))],
    "french": [
        ("door", "left", (0, 0, 0.5, 0.6)),
        ("door", "right", (0.5, 0, 1, 0.6)),
        ("drawer", None, (0, 0.6, 1, 0.8)),
        ("drawer", None, (0, 0.8, 1, 1)),
    ],
    "four doors": [
        ("door", "left", (0, 0, 0.5, 0.6)),
        ("door", "right", (0.5, 0, 1, 0.6)),
        ("door", "left", (0, 0.6, 0.5, 1)),
        ("door", "right", (0.5, 0.6, 1, 1)),
    ],
    "drawer": [("door", "right", (0, 0, 1, 0.7)), ("drawer", None, (0, 0.7, 1, 1))],
    "three rows": [
        ("door", "right", (0, 0, 1, 0.2)),
        ("door", "right", (0, 0.2, 1, 0.6)),
        ("drawer", None, (0, 0.6, 1, 1)),
    ],
}


@pytest.mark.parametrize("form", FRIDGES)
def test_refrigerators_have_their_fronts_where_they_were_read(form: str):
    fronts = [make_front(label, box, hinge=hinge) for label, hinge, box in FRIDGES[form]]
    reading = make_reading(*fronts, kind="Refrigerator", size=(0.8, 0.7, 1.75), extent=(800, 1750))
    built, _ = build_from_reading(reading, 1)
    assert describe_fronts(read_shape(built)) == describe_fronts(reading)
    places = np.stack([np.array(box, dtype=float) for _, _, box in FRIDGES[form]])
    np.testing.assert_allclose(place_fronts(built), places, atol=0.03)
    np.testing.assert_allclose(read_shape(built).size[::2], (0.8, 1.75), rtol=0.02)


def test_glass_doors_of_a_refrigerator_are_as_many_as_were_read():
    fronts = [make_front("door", (k / 2, 0, (k + 1) / 2, 1), hinge="left", pane=True) for k in range(2)]
    built, _ = build_from_reading(make_reading(*fronts, kind="Refrigerator", size=(1.2, 0.6, 1.9)), 0)
    assert [(part.hinge, part.pane) for part in read_shape(built).fronts] == [("left", True)] * 2


SEARCHED = [
    ("Dishwasher", 0), ("Oven", 1), ("Microwave", 0), ("Safe", 1), ("WashingMachine", 2), ("Door", 3),
    ("TrashCan", 0), ("Suitcase", 1),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "seed"), SEARCHED)
def test_kinds_without_cells_are_searched_for_the_most_alike(kind: str, seed: int):
    """The kind's own object, read at a slant, is met by fronts of the same labels, hinges and places."""
    view = (0.3, 0.2, 0.2)
    reading = read_shape(draw_shape(kind, seed), view=view)
    built, notes = build_from_reading(reading, seed + 7)
    again = read_shape(built, view=view)
    assert [again.counts[label] for label in ("door", "drawer")] == [
        reading.counts[label] for label in ("door", "drawer")
    ]
    assert rate_difference(reading, again, reading.size) < 0.3 * len(reading.fronts) + 0.3
    assert not any("nearest" in note for note in notes)


def test_differences_are_nothing_for_equal_readings_and_one_for_a_missing_front():
    reading = read_shape(draw_shape("Refrigerator", 4), view=(0.2, 0.1, 0.2))
    assert rate_difference(reading, reading, reading.size) == pytest.approx(0.0, abs=1e-9)
    fewer = replace(reading, parts=tuple(part for part in reading.parts if part is not reading.fronts[0]))
    assert rate_difference(reading, fewer, reading.size) == pytest.approx(1.0)
    other = OTHER[reading.fronts[0].hinge]
    turned = tuple(
        replace(part, hinge=other) if part is reading.fronts[0] else part for part in reading.parts
    )  # type: ignore[arg-type]
    assert rate_difference(reading, replace(reading, parts=turned), reading.size) == pytest.approx(HINGE)


def test_a_measured_view_overrules_bad_corners():
    """Corners that lean as those of a steep view, which the outline has told from this one."""
    shape = draw_shape("Dresser", 3)
    reading = replace(read_shape(shape, view=(0.0, 0.0, 0.25)), measured=True, view=(0.0, 0.0, 0.25))
    lean = np.array([(-0.06, 0.0), (0.06, 0.0), (-0.06, 0.0), (0.06, 0.0)])
    bad = tuple(
        replace(part, corners=frame_box(part.box) + lean) if part.label == "drawer" else part
        for part in reading.parts
    )
    for seen in (reading, replace(reading, parts=bad)):
        built = read_shape(build_from_reading(seen, 0)[0], view=(0.0, 0.0, 0.25))
        boxes = [np.stack([front.box for front in one.fronts]) for one in (reading, built)]
        np.testing.assert_allclose(boxes[1], boxes[0], atol=0.04)


def test_a_quadrangle_becomes_the_unit_square():
    face = np.array([(0.2, 0.1), (0.8, 0.2), (0.7, 0.9), (0.25, 0.7)])
    at = map_face(face).locate(face)
    np.testing.assert_allclose(at, frame_box(np.array([0.0, 0.0, 1.0, 1.0])), atol=1e-9)


@pytest.mark.parametrize(("factor", "worse"), [(1.5, False), (1.8, True)])
def test_a_length_that_is_far_off_costs_more_than_a_front(factor: float, *, worse: bool):
    reading = read_shape(draw_shape("Refrigerator", 4))
    fewer = replace(reading, parts=tuple(part for part in reading.parts if part is not reading.fronts[0]))
    width, depth, height = reading.size
    off = rate_difference(reading, reading, (factor * width, depth, height))
    assert (off > rate_difference(reading, fewer, reading.size)) == worse


@pytest.mark.parametrize("kind", tuple(kinds()))
def test_every_kind_can_be_seen(kind: str):
    assert read_shape(draw_shape(kind, 0)).kind == kind


def test_a_lid_has_its_hinge_at_the_top_as_seen_from_before():
    for kind in ("Toilet", "ChestFreezer"):
        assert {part.hinge for part in read_shape(draw_shape(kind, 0)).fronts} == {"top"}


@pytest.mark.parametrize(("kind", "opened"), [("StorageFurniture", False), ("Table", True)])
def test_what_is_free_beside_the_fronts_is_a_board_but_under_a_desk(kind: str, *, opened: bool):
    fronts = tuple(
        Seen(part=part, bounds=part.box, handles=0, hinge=None) for part in stack(0.0, 0.5, 1.0, left=0.5)
    )
    tree = cut_rectangles(np.stack([front.bounds for front in fronts]), [True, True]).tree
    node = make_cells(tree, fronts, np.array([0.0, 0.0, 1.0, 1.0]), aside=kind == "Table")
    assert isinstance(node, Split)
    assert node.along == "columns"
    assert node.children[0] == Cell(fill="open" if opened else "blank")


@pytest.mark.parametrize(("more", "fill"), [(-0.05, "open"), (0.05, "blank")])
def test_a_place_in_the_colour_of_its_fronts_is_closed(more: float, fill: str):
    """The lower half of the object has no front; a share of it has their colour."""
    reading = make_reading(*stack(0.02, 0.25, 0.5))
    surface = np.zeros((20, 100), bool)
    surface[:, : round(100 * (CLOSED + more))] = True
    node = furnish(replace(reading, surface=surface))
    assert [cell.fill for cell in list_cells(node)] == ["drawer", "drawer", fill]
    assert [cell.fill for cell in list_cells(furnish(reading))][-1] == "open"


def furnish(reading: Reading) -> Node:
    view = view_fronts(reading)
    assert view.tree is not None
    region = np.array([0.0, 0.0, view.size[0], view.size[2]])
    node = make_cells(view.tree, view.fronts, region)
    return furnish_node(np.random.default_rng(0), node, (view.size[0], view.size[2]), view, reading.kind)


def test_things_keep_what_they_are_made_of_in_the_colour_that_was_read():
    """A toilet that is read as plastic is ceramic, and as heavy."""
    shape = draw_shape("Toilet", 0)
    lid = make_front("door", (0.0, 0.0, 1.0, 1.0), color=(30, 60, 120), material="plastic")
    worn = dict(wear_read(shape, make_reading(lid, kind="Toilet", color=(30, 60, 120)), 0).finishes)
    own = dict(shape.finishes)
    for role, finish in worn.items():
        assert (finish.kind, finish.period, finish.gloss) == (
            own[role].kind,
            own[role].period,
            own[role].gloss,
        )
    np.testing.assert_allclose(worn["body"].color, np.array((30, 60, 120)) / 255)
    assert tint_finish(make_wood("oak", 0), (0.8, 0.1, 0.1)).kind == "lacquer"
    assert tint_finish(make_wood("oak", 0), (0.6, 0.45, 0.3)).kind == "wood"


@pytest.mark.parametrize(("more", "guessed"), [(-0.02, False), (0.02, True)])
def test_a_guessed_sight_is_taken_where_the_plain_one_leaves_more_free(
    more: float, monkeypatch: pytest.MonkeyPatch, *, guessed: bool
):
    """The plain one leaves a share of the front free and a ragged edge, the other one neither."""
    free = GUESSED / (FREE_COST + 2 * RAGGED) + more
    plane = Plane(matrix=np.eye(3))
    left = np.array([0.0, 0.0, 0.5, 1.0])
    sights = [
        Sight(plane=plane, quads=np.stack([frame_box(left), frame_box(np.array([0.5, low, 1.0, 1.0]))]))
        for low in (2 * free, 0.0)
    ]
    monkeypatch.setattr(fronts, "guess_sights", lambda *_: iter(sights))
    doors = [make_front("door", (0.0, 0.0, 0.5, 1.0)), make_front("door", (0.5, 0.0, 1.0, 1.0))]
    sight, _ = fronts._choose_sight(make_reading(*doors), doors)
    assert (sight is sights[1]) == guessed


@pytest.mark.parametrize("height", [0.9, 1.6, 2.4])
def test_backs_of_layouts_leave_hulls_for_boards(height: float):
    reading = replace(CUPBOARD, size=(0.8, 0.5, height))
    shape, _ = build_from_reading(reading, 0, Wish(width=0.8, height=height))
    backs = [
        solid for solid in shape.parts[0].primitives if solid.size[0] < 0.05 and solid.size[2] > 0.6 * height
    ]
    assert backs
    for back in backs:
        longest = float(back.size.max())
        assert np.ceil(longest / (HULL_RATIO * float(back.size[0])) - 1e-9) <= BACK_HULLS


def test_furniture_without_visible_pulls_has_grips_unless_none_are_asked_for():
    halves = (make_front("drawer", (0.0, 0.0, 1.0, 0.5)), make_front("drawer", (0.0, 0.5, 1.0, 1.0)))
    shape, notes = build_from_reading(make_reading(*halves), 0)
    assert dict(shape.condition.counts)["handle"] == 2
    assert any("grips in their edges" in note for note in notes)
    bare, _ = build_from_reading(make_reading(*halves, bare=True), 0)
    assert "handle" not in dict(bare.condition.counts)
    fridge, _ = build_from_reading(make_reading(*halves, kind="Refrigerator"), 0)
    assert "handle" not in dict(fridge.condition.counts)
