"""What words say of hinges, stands, handles and places is so in the object, or is said not to be."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.conditioning.sentence import Placing
from artigen.kind import kinds
from artigen.reader.layout.frontal import read_shape
from artigen.reader.reading import ReadPart
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import place_vertices, prism
from artigen.shapes.shape import Shape
from artigen.sketch.arrange import arrange_fronts
from artigen.sketch.asked import ask, draw_asked
from artigen.sketch.described import find_outline, list_undescribed, read_front
from artigen.sketch.network import SketchNetwork
from artigen.sketch.told import find_stand, list_unworn
from artigen.sketch.understand import Request, understand


def refuse() -> SketchNetwork:
    raise AssertionError("what the grammar draws needs no sketch network")


def draw(text: str, seed: int = 3) -> tuple[Shape, tuple[str, ...]]:
    drawn = draw_asked(ask(Request(text=text), refuse, seed), seed, refuse)
    return drawn.shape, drawn.notes


def fronts(shape: Shape, label: str) -> list[ReadPart]:
    return [front for front in read_front(shape).fronts if front.label == label]


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize(
    ("text", "first", "last", "axis"),
    [
        ("a buffet with three drawers above two doors", ("drawer", 3), ("door", 2), 1),
        ("a wardrobe with two doors and two drawers at the bottom", ("door", 2), ("drawer", 2), 1),
        (
            "a sideboard with two doors on the left and three drawers on the right",
            ("door", 2),
            ("drawer", 3),
            0,
        ),
        ("a kitchen cabinet, 60 cm, one drawer over one door", ("drawer", 1), ("door", 1), 1),
    ],
)
def test_parts_lie_where_words_put_them(
    text: str, first: tuple[str, int], last: tuple[str, int], axis: int, seed: int
):
    shape, notes = draw(text, seed)
    before, after = (fronts(shape, label) for label, _ in (first, last))
    assert (len(before), len(after)) == (first[1], last[1])
    assert max(front.box[axis + 2] for front in before) <= min(front.box[axis] for front in after) + 0.01
    assert notes == ()


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("noun", ["cabinet with two doors", "safe", "washing machine", "fridge"])
def test_doors_are_hinged_where_words_say(noun: str, side: str):
    shape, notes = draw(f"a {noun}, hinged on the {side}")
    assert {door.hinge for door in fronts(shape, "door")} == {side}
    assert notes == ()


def test_a_desk_has_its_drawers_at_the_side_that_is_said_and_room_for_knees():
    shape, _ = draw("a desk, 140 x 70 cm, with three drawers on the right")
    drawers = fronts(shape, "drawer")
    assert len(drawers) == 3
    assert min(front.box[0] for front in drawers) > 0.5
    width, depth, _ = read_shape(shape).size
    assert width == pytest.approx(1.4, abs=0.01)
    assert depth == pytest.approx(0.7, abs=0.05)


def test_rows_and_columns_are_as_many_as_are_said():
    shape, _ = draw("a dresser with two columns of three drawers")
    drawers = fronts(shape, "drawer")
    assert len({round(float(front.box[0]), 2) for front in drawers}) == 2
    assert len({round(float(front.box[1]), 2) for front in drawers}) == 3


def test_two_small_drawers_above_three_wide_ones_lie_beside_each_other():
    drawers = fronts(draw("a dresser with two small drawers above three wide drawers")[0], "drawer")
    tops = sorted(round(float(front.box[1]), 2) for front in drawers)
    assert len(set(tops)) == 4
    assert tops[0] == tops[1]


@pytest.mark.parametrize("seed", range(3))
def test_panes_are_in_the_doors_of_which_they_are_said(seed: int):
    shape, notes = draw("a cabinet with two glass doors above and two solid doors below", seed)
    doors = sorted(fronts(shape, "door"), key=lambda door: float(door.box[1]))
    assert [door.pane for door in doors] == [True, True, False, False]
    assert notes == ()


@pytest.mark.parametrize("seed", range(3))
def test_doors_have_room_beside_each_other_in_what_is_usually_narrow(seed: int):
    shape, notes = draw("a pantry with three drawers below two doors", seed)
    assert dict(shape.condition.counts)["door"] == 2
    assert notes == ()


def test_a_bookcase_has_its_shelves_above_what_is_at_the_bottom():
    shape, notes = draw("a bookcase with four shelves and two doors at the bottom")
    assert dict(shape.condition.counts)["shelf"] == 4
    ends = [part.bounds()[:, 2] for part in shape.parts if part.label == "shelf"]
    doors = [part.bounds()[:, 2] for part in shape.parts if part.label == "door"]
    assert min(low for low, _ in ends) > max(high for _, high in doors) - 0.02
    assert notes == ()


@pytest.mark.parametrize(("noun", "low", "high"), [("double oven", 1.1, 1.4), ("hob", 0.06, 0.13)])
def test_a_noun_that_says_a_form_has_its_sizes(noun: str, low: float, high: float):
    understood = understand(Request(text=f"a {noun}"))
    assert dict(understood.usual)["height"] == (low, high)
    assert understood.said == f"understood: Oven ({noun})"


@pytest.mark.parametrize("noun", ["table", "dresser", "sideboard"])
@pytest.mark.parametrize("kind", ["tapered", "square"])
def test_legs_are_of_the_kind_that_is_said(noun: str, kind: str):
    shape, notes = draw(f"a {noun} with {kind} legs")
    floor = shape.bounds()[0, 2]
    legs = [
        place_vertices(solid) for part in shape.parts for solid in part.primitives if solid.finish == "leg"
    ]
    legs = [corners for corners in legs if corners[:, 2].min() < floor + 0.005]
    assert len(legs) >= 4
    for corners in legs:
        ends = [corners[np.isclose(corners[:, 2], z), :2] for z in (corners[:, 2].min(), corners[:, 2].max())]
        share = np.ptp(ends[0], axis=0).max() / np.ptp(ends[1], axis=0).max()
        assert share < 0.9 if kind == "tapered" else share == pytest.approx(1.0)
    assert notes == ()


def test_a_finish_of_a_piece_that_an_object_lacks_is_said():
    request = understand(Request(text="a white dresser with an oak top")).request
    held = []
    for seed in range(8):
        shape = draw_shape("Dresser", seed)
        has = any(solid.finish == "top" for part in shape.parts for solid in part.primitives)
        assert list_unworn(shape, request) == ([] if has else ["top of its own"])
        held.append(has)
    assert any(held)
    assert not all(held)


def test_an_article_counts_the_fronts_of_furniture_and_is_at_least_one_elsewhere():
    assert dict(draw("a nightstand with a drawer on legs")[0].condition.counts)["drawer"] == 1
    shape, _ = draw("a tumble dryer with a round door, hinged on the left")  # its filter has a flap as well
    assert dict(shape.condition.counts)["door"] >= 1


@pytest.mark.parametrize(
    ("words", "stand"), [("on legs", "legs"), ("on castors", "wheels"), ("without legs", "flat")]
)
def test_an_object_stands_on_what_is_said(words: str, stand: str):
    shape, notes = draw(f"a nightstand with two drawers {words}")
    assert find_stand(shape) == stand
    assert notes == ()


def test_the_freezer_is_where_it_is_said_to_be():
    for where, first in (("top", True), ("bottom", False)):
        shape, notes = draw(f"a fridge with the freezer at the {where}")
        low, *_, high = sorted(read_front(shape).fronts, key=lambda front: -front.box[1])
        assert (high.box[3] - high.box[1] < low.box[3] - low.box[1]) == first
        assert notes == ()


def test_a_bedside_table_is_smaller_than_a_sideboard():
    small, large = (draw(f"a {noun} with two drawers on legs")[0] for noun in ("bedside table", "sideboard"))
    assert read_shape(small).size[0] <= 0.62 < 1.0 <= read_shape(large).size[0] + 0.02


@pytest.mark.parametrize("word", ["round", "oval", "square"])
def test_a_top_has_the_outline_that_is_said(word: str):
    shape, notes = draw(f"a {word} side table")
    sides = np.diff(shape.bounds()[:, :2], axis=0)[0]
    assert find_outline(shape) == word
    assert (abs(sides[0] - sides[1]) < 0.03 * max(sides)) == (word != "oval")
    assert notes == ()


@pytest.mark.parametrize(
    ("share", "depth", "outline"),
    [
        (0.98, 1.0, "square"), (0.96, 1.0, "oval"), (0.84, 1.0, "oval"), (0.82, 1.0, "round"),
        (0.98, 0.96, "rectangle"), (0.82, 0.96, "oval"), (0.82, 0.98, "round"),
    ],
)  # fmt: skip
def test_an_outline_is_what_its_corners_leave_of_its_rectangle(share: float, depth: float, outline: str):
    cut = float(np.sqrt((1.0 - share) / 2))
    across = np.array([0.5, 0.5, 0.5 - cut, cut - 0.5, -0.5, -0.5, cut - 0.5, 0.5 - cut])
    corners = np.column_stack([depth * np.roll(across, 2), across])
    top = prism(corners, (0, 0, 0.70), (0, 0, 0.73), "top")
    shape = draw_shape("Table", 0)
    parts = [replace(part, primitives=tuple(one for one in part.primitives if one.finish != "top"))
             for part in shape.parts]  # fmt: skip
    parts[0] = replace(parts[0], primitives=(*parts[0].primitives, top))
    assert find_outline(replace(shape, parts=tuple(parts))) == outline


def test_two_doors_hinge_at_their_outer_sides_if_that_is_said():
    shape, notes = draw("a cabinet whose left door is hinged left and whose right door is hinged right")
    assert [door.hinge for door in sorted(fronts(shape, "door"), key=lambda door: door.box[0])] == [
        "left",
        "right",
    ]
    assert notes == ()


def test_an_open_compartment_in_the_middle_has_the_fronts_on_its_sides():
    shape, notes = draw("a TV bench with two flap doors and an open compartment in the middle")
    left, right = sorted(fronts(shape, "door"), key=lambda door: float(door.box[0]))
    assert left.box[2] + 0.1 < right.box[0]
    assert {door.hinge for door in (left, right)} == {"bottom"}
    assert notes == ()


def test_a_second_kind_of_handles_is_said_not_to_be():
    _, notes = draw("a cabinet with cup pulls and bar handles and three drawers")
    assert "handle type bar" in notes[0]


def test_what_no_object_has_is_said():
    shape, notes = draw("a dishwasher, hinged on the left")
    assert shape.category == "Dishwasher"
    assert notes == ("understood, but no Dishwasher was found with: door hinged left",)
    assert list_undescribed(shape, (("door", "hinged", "left"),), ()) == ["door hinged left"]


def test_arranging_keeps_the_number_of_fronts_and_their_outline():
    reading = read_shape(draw_shape("StorageFurniture", 3))
    placed = arrange_fronts(reading, (Placing(label="drawer", count=None, at="bottom"),), ())
    assert placed.counts == {**reading.counts, "handle": len(placed.fronts)}
    for old, new in ((0, 0), (1, 1)):
        ends = [
            (min(f.box[old] for f in one.fronts), max(f.box[old + 2] for f in one.fronts))
            for one in (reading, placed)
        ]
        assert ends[0][new == 1] == pytest.approx(ends[1][new == 1], abs=0.1)


def test_an_object_as_drawn_is_as_described_by_itself():
    """A front that stands above all others is at the top, and not at the bottom."""
    for kind in (name for name, kind in kinds().items() if kind.laid_out):
        for seed in range(6):
            shape = draw_shape(kind, seed)
            drawers, doors = fronts(shape, "drawer"), fronts(shape, "door")
            if not drawers or not doors:
                continue
            above = max(f.box[3] for f in drawers) <= min(f.box[1] for f in doors)
            lost = list_undescribed(shape, (), (Placing(label="drawer", count=None, at="top"),))
            assert (lost == []) == above
