"""Lengths keep the ranges and ratios of words, and stay usual otherwise."""

import pytest

from artigen.errors import ArtigenError
from artigen.kind import kinds
from artigen.sketch.extents import Range, Ratio, settle_extents
from artigen.sketch.request import SketchRequest


def settle(
    kind: str, *, given: SketchRequest | None = None, ranges: tuple[Range, ...] = (),
    ratios: tuple[Ratio, ...] = (), factors: dict[str, float] | None = None, seed: int = 0,
) -> SketchRequest:  # fmt: skip
    request = given or SketchRequest(category=kind)
    return settle_extents(request, request, ranges, ratios, factors or {}, seed)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["Dresser", "Toaster", "Refrigerator"])
def test_ranges_and_ratios_hold(kind: str, seed: int):
    (low, high), _, (least, most) = kinds()[kind].sizes
    middle = (low * high) ** 0.5
    for lowest, highest in ((0.0, middle), (middle, 9.0), (middle, 1.1 * middle)):
        found = settle(kind, ranges=(("width", lowest, highest),), seed=seed)
        assert found.width is not None
        assert lowest <= found.width <= highest
        assert found.height is None
    found = settle(kind, ratios=(("depth", 0.9, "width"), ("height", 1.1, "width")), seed=seed)
    assert found.width is not None
    assert found.depth == pytest.approx(0.9 * found.width)
    assert found.height is not None
    assert found.height == pytest.approx(1.1 * found.width)
    assert least <= found.height <= most


def test_what_is_given_stays_and_gives_the_other():
    given = SketchRequest(category="Table", width=1.2)
    found = settle("Table", given=given, ratios=(("depth", 0.5, "width"),))
    assert (found.width, found.depth) == (1.2, 0.6)


def test_a_range_holds_what_is_usual_times_what_adjectives_say():
    plain, tall = (
        settle("Wardrobe", ranges=(("height", 0.0, 9.0),), factors=factors).height
        for factors in ({}, {"height": 1.1})
    )
    assert plain is not None
    assert tall == pytest.approx(1.1 * plain)


def test_a_ratio_of_no_object_is_refused():
    with pytest.raises(ArtigenError, match="whose width is 20 times its height: no height of it from"):
        settle("Toaster", ratios=(("width", 20.0, "height"),))
