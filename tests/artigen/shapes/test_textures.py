"""Textures: functions of position, the same in numpy and torch, coordinated palettes."""

import numpy as np
import pytest
import torch

from artigen.shapes.primitives import box, cylinder, line
from artigen.shapes.shape import Shape, ShapePart, make_base
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import (
    LACQUERS,
    WOODS,
    deepen_color,
    make_glass,
    make_lacquer,
    make_metal,
    make_stone,
    make_wood,
)
from artigen.shapes.surfaces.noise import hash_unit, lattice_noise
from artigen.shapes.surfaces.palette import PALETTE_ROLES, draw_palette
from artigen.shapes.surfaces.textures import make_paint, paint, paint_primitives
from artigen.types import PartLabel

FINISHES = {
    "wood": make_wood("oak", 3),
    "lacquer": make_lacquer(LACQUERS["sage"]),
    "steel": make_metal("steel", 2),
    "plastic": Finish(kind="plastic", color=(0.8, 0.8, 0.8), accent=(0.7, 0.7, 0.7)),
    "glass": make_glass((0.1, 0.1, 0.1), opacity=0.4),
    "rubber": Finish(kind="rubber", color=(0.1, 0.1, 0.1), accent=(0.2, 0.2, 0.2)),
    "stone": make_stone("terrazzo", 4),
}


def some_points(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(count, 3))
    return rng.uniform(-1.0, 1.0, (count, 3)), normals / np.linalg.norm(normals, axis=1, keepdims=True)


def sideboard() -> Shape:
    """A lined board, a rod and a plain board on top of each other."""
    boards = (
        line(box((0, 0, 0), (0.4, 0.02, 1.0), "body"), "inside", (0.0, 1.0, 0.0)),
        cylinder((0.2, 0.5, 0.0), (0.2, 0.5, 1.0), 0.03, "steel"),
        box((0, 0, 1.0), (0.4, 1.2, 1.02), "body"),
        box((0, 0, 1.02), (0.4, 1.2, 1.04), "body"),
    )
    palette = draw_palette(np.random.default_rng(0), "furniture", "oak")
    finishes = palette | {"inside": make_lacquer(LACQUERS["white"])}
    part = make_base(boards)
    return Shape(category="Sideboard", seed=0, style="oak", parts=(part,), finishes=tuple(finishes.items()))


@pytest.mark.parametrize("kind", FINISHES)
@pytest.mark.parametrize("footprint", [0.0, 0.002])
def test_numpy_and_torch_paint_alike(kind: str, footprint: float):
    points, normals = some_points(20_000)
    colors = paint(FINISHES[kind], points, normals, footprint=footprint)
    same = paint(FINISHES[kind], torch.tensor(points), torch.tensor(normals), footprint=footprint)
    assert colors.dtype == np.float32
    assert colors.min() >= 0.0
    assert colors.max() <= 1.0
    assert np.abs(colors - same.numpy()).max() < 1e-4


@pytest.mark.parametrize("kind", FINISHES)
def test_colour_depends_on_the_point_alone(kind: str):
    points, normals = some_points(2_000)
    order = np.random.default_rng(1).permutation(len(points))
    whole = paint(FINISHES[kind], points, normals)
    assert np.array_equal(whole[order], paint(FINISHES[kind], points[order], normals[order]))
    assert np.array_equal(whole[:7], paint(FINISHES[kind], points[:7], normals[:7]))


@pytest.mark.parametrize("kind", FINISHES)
def test_mean_colour_lies_between_the_two_of_the_finish(kind: str):
    points, normals = some_points(20_000)
    mean = paint(FINISHES[kind], points, normals).mean(axis=0)
    pair = np.array([FINISHES[kind].color, FINISHES[kind].accent])
    assert (mean > pair.min(axis=0) - 0.03).all()
    assert (mean < pair.max(axis=0) + 0.03).all()


def test_grain_runs_along_its_direction():
    wood = make_wood("walnut", 1)
    start, normals = some_points(5_000)
    normals[:] = (-1.0, 0.0, 0.0)
    changes = [
        np.abs(paint(wood, start + np.eye(3)[axis] * 0.002, normals) - paint(wood, start, normals)).mean()
        for axis in (1, 2)
    ]
    assert changes[0] > 5 * changes[1]


@pytest.mark.parametrize("kind", ["wood", "steel", "stone"])
def test_a_coarse_footprint_leaves_less_contrast(kind: str):
    points, normals = some_points(5_000)
    fine, coarse = (paint(FINISHES[kind], points, normals, footprint=size).std() for size in (0.0, 0.02))
    assert coarse < fine


def test_noise_is_uniform_and_continuous():
    values = hash_unit(np, np.arange(100_000, dtype=np.int32))
    assert abs(values.mean() - 0.5) < 0.005
    assert np.allclose(np.histogram(values, bins=10, range=(0, 1))[0], 10_000, rtol=0.05)
    assert abs(np.corrcoef(values[:-1], values[1:])[0, 1]) < 0.01
    x = np.linspace(-4, 4, 80_001, dtype=np.float32)
    noise = lattice_noise(np, np.int32(3), x, 0.3 * x)
    assert np.abs(np.diff(noise)).max() < 5e-4
    assert np.ptp(noise) > 0.4


def test_lining_shows_on_the_lined_side_only():
    shape = sideboard()
    points = np.array([[0.2, 0.02, 0.5], [0.2, 0.0, 0.5], [0.0, 0.01, 0.5]])
    normals = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]])
    colors = paint_primitives(shape, np.zeros(3, dtype=np.int64), points, normals)
    assert np.allclose(colors[0], LACQUERS["white"], atol=0.03)
    assert (np.abs(colors[1:] - np.array(WOODS["oak"][0])) < 0.2).all()


def test_grain_follows_the_board_and_boards_differ():
    shape = sideboard()
    rng = np.random.default_rng(0)
    points = rng.uniform((0, 0, 1.02), (0.4, 1.2, 1.02), (4_000, 3))
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    ids = np.full(len(points), 2)
    here = paint_primitives(shape, ids, points, normals)
    moved = [
        np.abs(paint_primitives(shape, ids, points + np.eye(3)[axis] * 0.002, normals) - here).mean()
        for axis in (0, 1)
    ]
    assert moved[0] > 5 * moved[1]
    assert np.abs(paint_primitives(shape, ids + 1, points, normals) - here).mean() > 0.01


@pytest.mark.parametrize(("label", "along"), [("drawer", 1), ("door", 2)])
def test_grain_of_a_square_front_is_level_on_drawers_and_upright_on_doors(label: PartLabel, along: int):
    front = ShapePart(label, label, (box((0.0, 0.0, 0.0), (0.02, 0.4, 0.4), "wood"),), parent=None)
    shape = Shape(category="Box", style="", seed=0, parts=(front,), finishes=(("wood", FINISHES["wood"]),))
    table = make_paint(shape)
    assert np.abs(table.axes[0, 0]).argmax() == along


def test_paint_of_an_object_is_the_same_in_torch():
    shape = sideboard()
    points, normals = some_points(5_000)
    ids = np.random.default_rng(2).integers(0, 4, len(points))
    colors = paint_primitives(shape, ids, points, normals)
    same = paint_primitives(shape, torch.tensor(ids), torch.tensor(points), torch.tensor(normals))
    assert np.abs(colors - same.numpy()).max() < 1e-4


@pytest.mark.parametrize("theme", ["furniture", "appliance"])
def test_palettes_have_every_role_and_follow_the_seed(theme: str):
    looks = set()
    for seed in range(40):
        palette = draw_palette(np.random.default_rng(seed), theme, "flat")
        assert palette == draw_palette(np.random.default_rng(seed), theme, "flat")
        assert set(palette) == set(PALETTE_ROLES)
        assert palette["glass"].opacity < 1.0
        assert palette["panel"].opacity == 1.0
        looks.add(palette["front"].color)
    assert len(looks) >= 4


@pytest.mark.parametrize("style", [*WOODS, *LACQUERS])
def test_a_material_named_by_the_style_is_on_the_fronts(style: str):
    color = WOODS[style][0] if style in WOODS else LACQUERS[style]
    allowed = (color, deepen_color(color)) if style in WOODS else (color,)
    for seed in range(10):
        palette = draw_palette(np.random.default_rng(seed), "furniture", style)
        assert palette["front"].color in allowed
