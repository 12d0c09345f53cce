"""Tiles repeat without seams, lie in metres, and are shared by all objects of a finish."""

import io

import numpy as np
import pytest
from PIL import Image

from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import make_lacquer, make_metal, make_polished, make_stone, make_wood
from sim_export.appearance.dress import find_looks
from sim_export.appearance.tiles import BOARDS, LEVELS, TEXELS, TONES, find_color, find_normal_map, find_tile
from sim_export.files.obj import png_bytes
from sim_export.files.write import package_files
from sim_export.package import Mesh
from sim_export.reference import build_reference

PATTERNED = (
    make_wood("walnut", 3),
    make_stone("terrazzo", 1),
    make_stone("granite", 2),
    make_metal("brass", 4),
)


def tile(finish: Finish) -> np.ndarray:
    image = find_tile(finish)
    assert image is not None
    return image.astype(float)


@pytest.mark.parametrize("finish", PATTERNED, ids=lambda finish: finish.kind)
def test_a_tile_repeats_without_seams(finish):
    """From the last texel to the first it changes no more than elsewhere; across their grain boards meet."""
    image = tile(finish)
    for axis in (1,) if finish.kind == "wood" else (0, 1):
        steps = np.abs(np.diff(image, axis=axis, append=np.take(image, [0], axis=axis))).mean(
            axis=(1 - axis, 2)
        )
        assert steps[-1] <= 1.2 * steps.max(initial=0.0, where=np.arange(TEXELS) < TEXELS - 1)
        inner = image[96:, 96:].std()
        assert image[:96, :96].std() > 0.5 * inner  # nothing is blurred away where the ends fade


@pytest.mark.parametrize("finish", PATTERNED, ids=lambda finish: finish.kind)
def test_a_tile_has_the_colours_of_its_finish_in_few_values(finish):
    image = tile(finish)
    assert image.shape == (TEXELS, TEXELS, 3)
    assert len(np.unique(image.reshape(-1, 3), axis=0)) <= LEVELS * TONES <= 256
    low, high = 255 * np.minimum(finish.color, finish.accent), 255 * np.maximum(finish.color, finish.accent)
    mean = image.mean(axis=(0, 1))
    assert ((mean > 0.94 * low - 1) & (mean < 1.06 * high + 1)).all()
    assert image.min() >= 1
    np.testing.assert_array_equal(image, tile(finish))


@pytest.mark.parametrize("finish", [make_wood("walnut", 3), make_metal("steel", 4)], ids=lambda one: one.kind)
def test_a_normal_map_is_the_relief_of_a_torus_with_grooves_along_the_grain(finish):
    normals = find_normal_map(finish)
    assert normals is not None
    normals = normals / 127.5 - 1.0
    np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1.0, atol=0.01)
    slopes = normals[..., :2] / normals[..., 2:]
    for channel, axis in ((0, 1), (1, 0)):  # a walk around the torus ends at the height where it began
        np.testing.assert_allclose(slopes[..., channel].mean(axis=axis), 0.0, atol=0.005)
    along, across = slopes.std(axis=(0, 1))
    assert 0.01 < across < 0.1
    assert across > 3 * along


def test_light_from_above_falls_on_the_upper_side_of_a_ridge_of_wood():
    """Its early wood, in its colour, stands above the late wood, in its accent."""
    finish = make_wood("walnut", 3)
    bright, normals = tile(finish).sum(axis=2), find_normal_map(finish)
    assert normals is not None
    up = normals[..., 1].astype(float) - 127.5
    rise = np.roll(bright, -1, axis=0) - np.roll(bright, 1, axis=0)  # brighter below: it faces up
    assert np.corrcoef(up.ravel(), rise.ravel())[0, 1] > 0.9


@pytest.mark.parametrize("finish", [make_lacquer((0.9, 0.1, 0.0)), make_polished("brass", 1)])
def test_smooth_finishes_have_no_normal_map(finish):
    assert find_normal_map(finish) is None


def test_boards_of_a_tile_meet_where_it_is_divided():
    rows = tile(PATTERNED[0]).mean(axis=(1, 2))
    steps = np.abs(np.diff(rows, append=rows[:1]))
    seams = np.arange(1, BOARDS + 1) * TEXELS // BOARDS - 1
    assert steps[seams].mean() > 3 * np.median(steps)


def test_only_finishes_with_a_visible_pattern_have_an_image():
    even = make_lacquer((0.9, 0.1, 0.0))
    assert find_tile(even) is None
    np.testing.assert_allclose(find_color(even), np.array(even.color) * 0.98)


def test_finishes_that_look_alike_share_a_look_and_others_have_other_names():
    oak, again, stained = make_wood("oak", 1), make_wood("oak", 2), make_wood("oak", 3)
    stained = Finish(kind="wood", color=(0.75, 0.6, 0.42), accent=stained.accent, gloss=stained.gloss)
    looks = find_looks({"body": oak, "front": again, "top": stained})
    assert looks["body"].material.name == looks["front"].material.name == "oak_oiled"
    assert looks["top"].material.name == "oak_oiled_2"
    assert looks["body"].tile is looks["front"].tile


def test_different_objects_of_the_same_finishes_share_their_images():
    wide, narrow = (
        {data for path, data in package_files(build_reference(shape)).items() if path.endswith(".png")}
        for shape in (draw_shape("StorageFurniture", 0, Wish(width=width)) for width in (1.2, 0.9))
    )
    assert wide == narrow != set()


@pytest.mark.parametrize(("category", "seed"), [("StorageFurniture", 0), ("Oven", 2)])
def test_one_unit_of_texture_coordinates_is_a_metre_on_flat_faces(category, seed):
    flat = 0
    for mesh in (
        one.mesh for link in build_reference(draw_shape(category, seed)).links for one in link.visuals
    ):
        assert isinstance(mesh, Mesh)
        assert mesh.uv is not None
        if mesh.texture is None:
            continue
        corners = mesh.vertices[mesh.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        along = np.abs(normals).max(axis=1) > 0.9999 * np.linalg.norm(normals, axis=1)
        laid = np.linalg.norm(mesh.uv - np.roll(mesh.uv, 1, axis=1), axis=2)
        real = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        assert (laid <= real + 1e-6).all()
        same = np.isclose(laid, real, atol=1e-6).all(axis=1)
        assert same[along].mean() > 0.9  # others belong to boards that stand at an angle
        flat += same.sum()
    assert flat > 100


@pytest.mark.parametrize("colors", [1, 2, 255, 256, 257, 5000])
def test_a_png_holds_exactly_its_texels_by_palette_or_not(colors: int):
    rng = np.random.default_rng(colors)
    known = rng.permutation(256**3)[:colors]
    known = np.stack([known >> 16, known >> 8 & 255, known & 255], axis=1).astype(np.uint8)
    image = known[np.concatenate([np.arange(colors), rng.integers(colors, size=10000 - colors)])]
    image = image.reshape(100, 100, 3)
    data = png_bytes(image)
    with Image.open(io.BytesIO(data)) as read:
        assert (read.mode == "P") == (colors <= 256)
        np.testing.assert_array_equal(np.asarray(read.convert("RGB")), image)
