"""Packages of generated shapes: Gaussians lie on the exact surface of their part, voxels are exact."""

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import KDTree

from artigen.appearance.exact import (
    VOXELS,
    ShapeAppearanceModel,
    decode_gaussians,
    load_shape_appearance,
    voxelize_shape,
)
from artigen.cli.generated import Generated, make_generated_package
from artigen.errors import SourceError
from artigen.shapes.asset import frame_shape, shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.shapes.rasterize import rasterize_shape
from artigen.shapes.sampling import place_points
from artigen.shapes.shape import Shape
from artigen.splats.colors import srgb_from_linear
from artigen.types import Gaussians
from artigen.voxels.fields import CHANNELS, encode
from artigen.voxels.voxelize import drop_unresolved
from artigen.weights import SHIPPED
from envs.config import ValidateConfig
from envs.validate import validate
from sim_export.files.read import read_package
from sim_export.files.write import package_files, write_package
from sim_export.reference import build_reference


@pytest.fixture(scope="module")
def model() -> ShapeAppearanceModel:
    return load_shape_appearance(SHIPPED)


@pytest.fixture(scope="module")
def shape() -> Shape:
    """An oven, of which 64^3 voxels have the least surface."""
    return draw_shape("Oven", 0)


@pytest.fixture(scope="module")
def made(model: ShapeAppearanceModel, shape: Shape) -> Generated:
    provenance = {"generator": "a test"}
    return make_generated_package(shape, model, provenance=provenance, notes=("left open",))


def test_gaussians_lie_on_the_surface_of_their_part(made: Generated, shape: Shape):
    gaussians = made.asset.gaussians
    assert gaussians is not None
    center, scale = frame_shape(shape)
    found = place_points(shape, scale / (8 * VOXELS))
    away = np.zeros(len(gaussians.means))
    for part in np.unique(gaussians.part_ids):
        own = gaussians.part_ids == part
        points = (found.points[found.part_ids == part] - center) / scale
        away[own] = KDTree(points).query(gaussians.means[own])[0]
    assert np.quantile(away, 0.99) < 0.4 / VOXELS
    assert away.max() < 1.0 / VOXELS


def test_every_part_has_gaussians_all_over_its_surface(made: Generated, shape: Shape):
    gaussians = made.asset.gaussians
    assert gaussians is not None
    center, scale = frame_shape(shape)
    found = place_points(shape, scale / VOXELS)
    for part in range(len(shape.parts)):
        means = gaussians.means[gaussians.part_ids == part]
        points = (found.points[found.part_ids == part] - center) / scale
        away = np.asarray(KDTree(means).query(points)[0])
        assert np.quantile(away, 0.95) < 1.0 / VOXELS, shape.parts[part].name


def test_gaussians_have_the_colours_of_the_finishes(made: Generated, shape: Shape):
    """Up to the light: corners are darker."""
    gaussians = made.asset.gaussians
    assert gaussians is not None
    painted = shape_to_asset(shape, resolution=None, spacing=0.02).surface
    assert painted is not None
    for part in range(len(shape.parts)):
        own, true = gaussians.part_ids == part, painted.part_ids == part
        drawn = srgb_from_linear(gaussians.colors[own].astype(np.float64)).mean(axis=0)
        assert np.abs(drawn - painted.colors[true].mean(axis=0) / 255.0).max() < 0.2, shape.parts[part].name


def test_voxels_are_those_that_the_surface_crosses(made: Generated, shape: Shape):
    voxels = made.asset.voxels
    assert voxels is not None
    cells = np.unique(rasterize_shape(shape, VOXELS).cells, axis=0)
    np.testing.assert_array_equal(voxels.coords[np.lexsort(voxels.coords.T[::-1])], cells)
    field = encode(made.asset)
    assert field.shape == (CHANNELS, VOXELS, VOXELS, VOXELS)
    assert np.count_nonzero(field[0]) == len(cells)
    known = shape_to_asset(shape, VOXELS)
    assert known.voxels is not None
    resolved = drop_unresolved(made.asset)
    assert resolved.voxels is not None
    np.testing.assert_array_equal(resolved.voxels.part_ids, known.voxels.part_ids)
    assert [part.name for part in resolved.parts] == [part.name for part in known.parts]


def test_the_same_shape_gives_the_same_gaussians_and_a_finer_grid_more(
    made: Generated, model: ShapeAppearanceModel, shape: Shape
):
    one, two = (decode_gaussians(model, shape, zoom=1) for _ in range(2))
    assert one.gaussians is not None
    for item in fields(Gaussians):
        np.testing.assert_array_equal(getattr(one.gaussians, item.name), getattr(two.gaussians, item.name))
    assert made.asset.gaussians is not None
    assert len(one.gaussians.means) < len(made.asset.gaussians.means) < 6 * len(one.gaussians.means)


def test_packages_are_exact_and_show_gaussians_link_by_link(made: Generated, shape: Shape):
    exact = build_reference(shape, provenance={"generator": "a test"})
    files, known = package_files(made.package), package_files(exact)
    added = set(files) - set(known)
    changed = {name for name in known if files[name] != known[name]}
    assert added
    assert all(name.endswith(".ply") for name in added)
    assert not {name for name in changed if name.endswith((".obj", ".png", ".mtl"))}
    assert made.package.records[0] == "left open"
    held = [0 if link.splats is None else len(link.splats.means) for link in made.package.links]
    assert made.asset.gaussians is not None
    assert sum(held) == len(made.asset.gaussians.means)
    assert all(count for count, link in zip(held, made.package.links, strict=True) if link.parts)


def test_packages_pass_every_check(made: Generated, tmp_path: Path):
    folder = write_package(made.package, tmp_path / "oven")
    assert sum(link.splats is not None for link in read_package(folder).links) > 1
    report = validate(folder, ValidateConfig(output="none"))
    assert report.passed, [check.message for check in report.failures]


def test_without_a_decoder_packages_have_no_gaussians(shape: Shape):
    bare = make_generated_package(shape)
    assert all(link.splats is None for link in bare.package.links)
    assert bare.asset.gaussians is None
    assert bare.asset.voxels is not None


def test_parts_without_a_voxel_are_kept_and_noted():
    for seed in range(20):
        shape = draw_shape("WashingMachine", seed)
        asset = voxelize_shape(shape, 16)
        assert len(asset.parts) == len(shape.parts)
        assert asset.voxels is not None
        if len(np.unique(asset.voxels.part_ids)) < len(asset.parts):
            assert "smaller than a voxel" in asset.notes[0]
            break
    else:
        pytest.fail("no part of twenty objects is smaller than a voxel of 16^3")


def test_a_folder_without_a_decoder_is_refused(tmp_path: Path):
    (tmp_path / "model.json").write_text("{}")
    with pytest.raises(SourceError, match="holds no appearance-vae"):
        load_shape_appearance(tmp_path)
