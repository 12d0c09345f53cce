"""Shared textures: the same finishes give the same bytes, and lengths on them are metres."""

import io

import numpy as np
import pytest
from PIL import Image

from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.surfaces.materials import WOODS
from sim_export.appearance.shared_textures import COLORS, LENGTH, WIDTH, Look, even_color, make_sheet
from sim_export.files.obj import png_bytes
from sim_export.files.write import package_files
from sim_export.package import Mesh
from sim_export.reference import ReferenceConfig, build_reference

OAK = Look(pattern=1, color=WOODS["oak"][0], accent=WOODS["oak"][1], period=0.045)
WHITE = Look(pattern=4, color=(0.9, 0.9, 0.9), accent=(0.8, 0.8, 0.8), period=0.4)


def build(category: str, seed: int, wish: Wish | None = None):
    return build_reference(draw_shape(category, seed, wish), ReferenceConfig(textures="shared"))


def images(package) -> set[bytes]:
    return {data for path, data in package_files(package).items() if path.endswith(".png")}


def test_different_objects_of_the_same_finishes_share_their_images():
    wide, narrow = (build("StorageFurniture", 0, Wish(width=width)) for width in (1.2, 0.9))
    assert images(wide) & images(narrow)
    own = [build_reference(draw_shape("StorageFurniture", 0, Wish(width=width))) for width in (1.2, 0.9)]
    assert not images(own[0]) & images(own[1])


def test_a_part_of_one_plain_finish_has_its_colour_and_no_image():
    package = build("StorageFurniture", 4)
    plain = [one.mesh for link in package.links for one in link.visuals if one.mesh.texture is None]
    assert plain
    assert {mesh.color for mesh in plain} != {(0.7, 0.7, 0.7)}


@pytest.mark.parametrize(("category", "seed"), [("StorageFurniture", 0), ("Table", 0), ("Oven", 2)])
def test_coordinates_lie_inside_of_the_image_and_texels_are_nowhere_finer_than_they_say(category, seed):
    package = build(category, seed)
    for mesh in (one.mesh for link in package.links for one in link.visuals):
        assert isinstance(mesh, Mesh)
        if mesh.uv is None:
            continue
        assert mesh.uv.min() >= 0.0
        assert mesh.uv.max() <= 1.0
        corners = mesh.vertices[mesh.faces]
        along = np.abs(mesh.uv[:, 1:, 0] - mesh.uv[:, :1, 0]) * LENGTH
        length = np.linalg.norm(corners[:, 1:] - corners[:, :1], axis=2)
        assert (along <= length + 1e-6).all()


def test_a_board_within_its_band_is_laid_flat_without_distortion():
    package = build("StorageFurniture", 3)
    exact = 0
    for mesh in (one.mesh for link in package.links for one in link.visuals):
        if mesh.uv is None:
            continue
        height = mesh.texture.shape[0]
        if height != 320:  # one wood alone: 320 rows of 4 mm
            continue
        corners = mesh.vertices[mesh.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        flat = np.abs(normals).max(axis=1) > 0.999 * np.linalg.norm(normals, axis=1)
        metres = mesh.uv * (LENGTH, height * 0.004)
        laid = np.linalg.norm(metres - np.roll(metres, 1, axis=1), axis=2)
        real = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        exact += np.isclose(laid, real, atol=1e-5).all(axis=1)[flat].sum()
        assert (laid[flat] <= real[flat] + 1e-5).all()
    assert exact > 50


def test_a_sheet_shows_its_finishes_in_few_colours():
    sheet = make_sheet((OAK, WHITE))
    assert sheet.image.shape[1] == WIDTH
    assert len(np.unique(sheet.image.reshape(-1, 3), axis=0)) <= COLORS
    bands = np.split(sheet.image, sheet.starts[1:])
    means = [band.reshape(-1, 3).mean(axis=0) / 255 for band in bands]
    low, high = (np.minimum(*WOODS["oak"]), np.maximum(*WOODS["oak"]))
    assert ((means[0] > low - 0.03) & (means[0] < high + 0.03)).all()
    np.testing.assert_allclose(means[1], even_color(WHITE), atol=0.01)
    assert bands[0].std(axis=(0, 1)).min() > 2.0
    again = make_sheet.__wrapped__((OAK, WHITE))
    np.testing.assert_array_equal(sheet.image, again.image)


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
