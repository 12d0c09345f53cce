"""Sizes that objects are drawn in, against the ranges that standards and catalogues have."""

from dataclasses import dataclass

import numpy as np
import pytest

from artigen.datasets.sizes import estimate_size
from artigen.kind import kinds
from artigen.kinds import foreign
from artigen.shapes.draw import draw_shape
from artigen.shapes.furniture.furniture_kinds import FORMS
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape
from sim_export.checks.config import CheckConfig

SEEDS = range(12)
Range = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Standard:
    """What a standard, or where there is none a trade, allows: ranges of lengths of an object (m)."""

    name: str
    category: str
    width: Range = (0.0, np.inf)
    depth: Range = (0.0, np.inf)
    height: Range = (0.0, np.inf)
    styles: tuple[str, ...] = ()
    """Those that it is about; all when empty."""


STANDARDS = (
    # Niches of 450 and 600 mm and free-standing machines up to 600 mm; dishwashers on worktops are smaller.
    Standard(name="EN 1116 dishwashers", category="Dishwasher", width=(0.43, 0.66), height=(0.43, 0.90)),
    Standard(name="EN 1116 dryers", category="Dryer", width=(0.57, 0.72), styles=("white", "steel", "black")),
    # 240 l and 120 l of EN 840-1: 480 to 580 mm wide, 550 to 740 mm deep, at most 1,100 mm high.
    Standard(name="EN 840-1", category="TrashCan", width=(0.44, 0.60), depth=(0.52, 0.76),
             height=(0.92, 1.10), styles=("wheeled",)),
    # Leaves of 610 to 985 mm by 1,985 or 2,110 mm in frames with casings of 62 mm; two leaves up to 1,985 mm.
    Standard(name="DIN 18101", category="Door", width=(0.61, 1.14), height=(1.985, 2.21),
             styles=("panelled", "flush", "glazed")),
    # No standard of their size: floor-standing toilets with cisterns.
    Standard(name="catalogues of toilets", category="Toilet", width=(0.34, 0.42), height=(0.70, 0.90),
             styles=("close_coupled", "skirted")),
    # Suspension files of A4 and foolscap hang in cabinets of 380 to 500 mm.
    Standard(name="suspension files", category="FilingCabinet", width=(0.36, 0.55),
             styles=("vertical", "pedestal")),
    # Boxes are 71 mm apart (DIN 49073), plates 80 mm.
    Standard(name="DIN 49073", category="Switch", width=(0.08, 0.30)),
    # Cabin baggage of most airlines: 55 x 40 x 23 cm with wheels and handle, to the half centimetre.
    Standard(name="cabin baggage", category="Suitcase", width=(0.30, 0.405), depth=(0.15, 0.24),
             height=(0.45, 0.57), styles=("cabin",)),
)  # fmt: skip


def extents(shape: Shape) -> tuple[float, float, float]:
    depth, width, height = np.ptp(shape.bounds(), axis=0).tolist()
    return width, depth, height


@pytest.mark.parametrize("standard", STANDARDS, ids=lambda standard: standard.name)
def test_objects_have_sizes_that_their_standard_allows(standard: Standard):
    known = kinds()[standard.category].styles
    assert set(standard.styles) <= set(known)
    seen = 0
    for seed in SEEDS:
        shape = draw_shape(standard.category, seed)
        if standard.styles and shape.style not in standard.styles:
            continue
        seen += 1
        allowed = (standard.width, standard.depth, standard.height)
        for length, (low, high) in zip(extents(shape), allowed, strict=True):
            assert low <= length <= high
    assert seen


def test_cabinets_of_kitchens_have_the_depths_and_heights_of_en_1116():
    """Base units: 560 to 600 mm and the worktop's overhang deep, 780 to 940 mm high; wall units to 420 mm."""
    width, depth, height = FORMS["base_cabinet"].spans
    assert 0.56 <= depth[0] <= depth[1] <= 0.66
    assert 0.76 <= height[0] <= height[1] <= 0.96
    assert FORMS["wall_cabinet"].spans[1][1] <= 0.42
    assert width[0] >= 0.15
    assert width[1] <= 1.25


@pytest.mark.parametrize("category", sorted(kinds()))
def test_what_fingers_press_and_turn_is_as_wide_as_a_fingertip(category: str):
    for seed in SEEDS:
        for part in draw_shape(category, seed).parts:
            if part.label == "knob":
                extents = np.ptp(np.concatenate([place_vertices(p) for p in part.primitives]), axis=0)
                assert sorted(extents)[1] >= 0.0085, (seed, part.name)


def test_wardrobes_are_deep_enough_for_hangers():
    """DIN 68890: clothes on hangers need 500 mm."""
    for seed in range(4):
        assert extents(draw_shape("Wardrobe", seed))[1] >= 0.5 - 1e-6


@pytest.mark.parametrize("category", foreign.CATEGORIES, ids=lambda category: category.name)
def test_plausible_sizes_hold_what_sources_without_units_are_made_to(category):
    """Objects of equal sides, and twice as high as wide."""
    low, high = category.diagonal or CheckConfig().diagonal_range
    for extents in ((1.0, 1.0, 1.0), (0.5, 0.5, 1.0)):
        size, known = estimate_size(category.name, np.array(extents))
        assert known
        assert low <= size * np.linalg.norm(extents) <= high


@pytest.mark.parametrize("category", sorted(kinds()))
def test_plausible_sizes_hold_what_the_grammar_draws(category: str):
    """V009 tells units apart; it must not refuse what the grammar draws."""
    kind = kinds()[category]
    low, high = kind.diagonal or CheckConfig().diagonal_range
    for seed in range(8):
        size = draw_shape(category, seed).condition
        extents = (size.width, size.depth, size.height)
        assert low <= np.linalg.norm(extents) <= high
        assert all(least <= extent <= most for extent, (least, most) in zip(extents, kind.sizes, strict=True))
