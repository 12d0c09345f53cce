"""Families of looks: every kind has a place in them, and the objects of a suite share what a suite is."""

from pathlib import Path

import numpy as np
import pytest

from artigen.api.sample import ShapeJob, ShapeSettings, choose_like, draw_wished, read_suite
from artigen.errors import ArtigenError
from artigen.kind import kinds
from artigen.shapes.draw import ShapeError, Wish, draw_shape
from artigen.shapes.families import FAMILIES, choose_suite, dress_shape, wish_suite
from artigen.shapes.fittings.handles import HANDLE_KINDS
from artigen.shapes.shape import Shape


def draw_suited(category: str, seed: int, family: str, suite: int, **lengths: float) -> Shape:
    chosen = choose_suite(family, suite)
    return dress_shape(draw_shape(category, seed, wish_suite(category, chosen, Wish(**lengths))), chosen)


@pytest.mark.parametrize("category", kinds())
def test_every_style_that_a_category_states_can_be_wished_for(category: str):
    for style in kinds()[category].styles:
        assert draw_shape(category, 1, Wish(style=style)).style == style
    with pytest.raises(ShapeError, match=f"{category}: style 'baroque' is not known, expected one of"):
        draw_shape(category, 1, Wish(style="baroque"))


@pytest.mark.parametrize("category", kinds())
def test_every_kind_is_drawn_in_every_family_and_keeps_what_one_sees_through(category: str):
    for family in FAMILIES:
        suite = choose_suite(family, 3)
        plain = draw_shape(category, 2, wish_suite(category, suite))
        dressed = dress_shape(plain, suite)
        assert [role for role, _ in dressed.finishes] == [role for role, _ in plain.finishes]
        for (_, own), (_, worn) in zip(plain.finishes, dressed.finishes, strict=True):
            assert own.opacity == worn.opacity
            assert own == worn or own.kind not in ("glass", "rubber")
        assert dressed.parts == plain.parts


def test_families_name_styles_that_exist():
    styles = {style for kind in kinds().values() for style in kind.styles}
    for family in FAMILIES.values():
        assert set(family.styles) <= styles


@pytest.mark.parametrize("family", FAMILIES)
def test_objects_of_a_suite_have_the_materials_of_one_scheme(family: str):
    made = [
        dict(draw_suited(kind, seed, family, 4).finishes)
        for seed, kind in enumerate(("StorageFurniture", "Dresser", "Table", "Wardrobe"))
    ]
    for role in ("front", "body", "top", "leg", "handle"):
        looks = {(finish[role].kind, finish[role].color, finish[role].gloss) for finish in made}
        assert len(looks) == 1
    fridge, oven = (dict(draw_suited(kind, 1, family, 4).finishes) for kind in ("Refrigerator", "Oven"))
    assert fridge["body"].color == oven["body"].color
    assert fridge["handle"].color == oven["handle"].color == made[0]["handle"].color


def handle_extents(shape: Shape) -> set[tuple[float, ...]]:
    solids = [piece.size for part in shape.parts if part.label == "handle" for piece in part.primitives]
    return {tuple(sorted(np.round(size, 5).tolist())) for size in solids}


def test_cabinets_of_a_suite_have_the_same_handles_and_worktops_and_others_do_not():
    lengths = {"width": 0.6, "depth": 0.6, "height": 0.88}
    suited = [draw_suited("StorageFurniture", seed, "industrial", 8, **lengths) for seed in range(6)]
    free = [draw_shape("StorageFurniture", seed, Wish(style="industrial", **lengths)) for seed in range(6)]
    assert len({frozenset(handle_extents(shape)) for shape in suited}) == 1
    assert len({frozenset(handle_extents(shape)) for shape in free}) > 2

    def worktops(shape: Shape) -> tuple[tuple[float, ...], ...]:
        tops = [piece.size for piece in shape.parts[0].primitives if piece.finish == "top"]
        return tuple(tuple(np.round(size, 5).tolist()) for size in tops)

    assert len({worktops(shape) for shape in suited}) == 1
    assert all(worktops(shape) for shape in suited)


def test_handles_are_the_first_wanted_that_is_offered():
    offered = HANDLE_KINDS[:3]
    assert Wish(handles=("cup", offered[1], offered[0])).choose_handles(offered) == (offered[1],) * 3
    assert Wish(handles=("cup",)).choose_handles(offered) == offered
    assert Wish().choose_handles(offered) == offered


def test_a_suite_is_the_one_asked_for_or_that_of_the_seed_and_one_for_all_that_are_built_alike():
    def job(seed: int, **settings: object) -> ShapeJob:
        return ShapeJob(category="Safe", seed=seed, out=Path(), cfg=ShapeSettings(**settings))  # type: ignore[arg-type]

    def suite(seed: int, **settings: object) -> int:
        chosen = read_suite(job(seed, **settings))
        assert chosen is not None
        return chosen.seed

    assert suite(7, family="slab") == 7
    assert suite(7, family="slab", suite=2) == 2
    assert suite(7, family="slab", like=5) == 0
    assert read_suite(job(7)) is None
    with pytest.raises(ArtigenError, match="suite 2 without a family"):
        draw_wished(job(7, suite=2))
    with pytest.raises(ShapeError, match="family 'gothic' is not known, expected one of shaker"):
        choose_suite("gothic", 0)


def test_what_is_built_alike_in_a_family_has_its_parts_and_its_style():
    cfg = choose_like("StorageFurniture", ShapeSettings(family="slab", topology=("door=1", "drawer=1")))
    for seed in (3, 4):
        made = draw_wished(ShapeJob(category="StorageFurniture", seed=seed, out=Path(), cfg=cfg))
        assert made.style == "handleless"
        counts = dict(made.condition.counts)
        assert (counts["door"], counts["drawer"]) == (1, 1)


def test_most_furniture_is_white_grey_black_or_of_a_common_wood():
    from artigen.shapes.surfaces.materials import LACQUERS, WOODS, deepen_color
    from artigen.shapes.surfaces.palette import BOUGHT_LACQUERS, BOUGHT_WOODS, draw_palette

    assert BOUGHT_LACQUERS.keys() == LACQUERS.keys()
    assert BOUGHT_WOODS.keys() == WOODS.keys()
    quiet = {LACQUERS[name] for name in ("white", "light_grey", "grey", "anthracite", "black", "cream")}
    woods = {name: {color, deepen_color(color)} for name, (color, _) in WOODS.items()}
    quiet |= set().union(*(woods[name] for name in ("oak", "white_oak", "walnut", "maple", "wenge")))
    fronts = [draw_palette(np.random.default_rng(seed), "furniture", "plain")["front"] for seed in range(600)]
    assert np.mean([front.color in quiet for front in fronts]) > 0.65
    assert len({front.color for front in fronts}) >= len(LACQUERS) + len(WOODS)
