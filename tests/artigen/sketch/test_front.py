"""Fronts that are closed all over have no holes."""

import pytest
from sketch_changes import remove_parts

from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import box
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.sketch.front import find_front_faults, measure_open_front
from artigen.sketch.model import _judge
from artigen.sketch.request import SketchRequest
from artigen.sketch.rows import sketch_to_rows
from artigen.sketch.sketch import write_sketch

GREY = (0.5, 0.5, 0.5)


def niche(category: str, share: float, depth: float = 0.9) -> Shape:
    """A cube of 1 m whose front is open from the top down over a share of its height, so deep."""
    solids = (
        box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0 - share), "body"),
        box((depth, 0.0, 0.0), (1.0, 1.0, 1.0), "body"),
    )
    return Shape(
        category=category,
        seed=0,
        style="",
        parts=(ShapePart(name="body", label="base", parent=None, primitives=solids),),
        finishes=(("body", Finish(kind="lacquer", color=GREY, accent=GREY, gloss=0.0)),),
    )


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_what_is_open_is_measured_as_a_share_of_the_front(share: float):
    assert measure_open_front(niche("Dresser", share)) == pytest.approx(share, abs=0.02)


@pytest.mark.parametrize(("depth", "share"), [(0.34, 0.0), (0.37, 0.5)])
def test_a_niche_is_open_from_a_good_third_of_the_depth_on(depth: float, share: float):
    assert measure_open_front(niche("Dresser", 0.5, depth)) == pytest.approx(share, abs=0.02)


@pytest.mark.parametrize(
    ("category", "most"),
    [
        ("ChestFreezer", 0.03), ("Dishwasher", 0.04), ("Dresser", 0.065), ("Dryer", 0.03),
        ("FilingCabinet", 0.05), ("Microwave", 0.03), ("Refrigerator", 0.03), ("Safe", 0.08),
        ("Wardrobe", 0.065),
    ],
)  # fmt: skip
def test_a_few_percent_of_a_closed_front_may_be_open(category: str, most: float):
    assert not find_front_faults(niche(category, most - 0.012))
    (fault,) = find_front_faults(niche(category, most + 0.012))
    assert fault.text.startswith(f"{100 * fault.value:.3g} % of the front of body is open")


@pytest.mark.parametrize("category", ["StorageFurniture", "Table", "Cart", "Oven"])
def test_kinds_with_open_compartments_may_have_more(category: str):
    assert not find_front_faults(niche(category, 0.5))


@pytest.mark.parametrize("category", ["Dresser", "Wardrobe", "Refrigerator", "Safe"])
def test_objects_of_the_grammar_have_closed_fronts(category: str):
    assert not any(find_front_faults(draw_shape(category, seed)) for seed in range(6))


@pytest.mark.parametrize("category", ["Dresser", "FilingCabinet"])
def test_a_drawer_that_is_missing_is_found_unless_a_picture_shows_it(category: str):
    shape = draw_shape(category, 3)
    largest = max(
        (part for part in shape.parts if part.label == "drawer"),
        key=lambda part: max(
            float(solid.vertices[:, 2].max() - solid.vertices[:, 2].min()) for solid in part.primitives
        ),
    )
    table = sketch_to_rows(write_sketch(remove_parts(shape, {largest.name})))
    found = [
        [fault.id for fault in _judge(table, 3, SketchRequest(), pictured=pictured)[1]]
        for pictured in (False, True)
    ]
    assert "open" in found[0]
    assert "open" not in found[1]
