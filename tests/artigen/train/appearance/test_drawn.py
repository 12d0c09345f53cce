"""Voxels as a model draws them, and which true ones they look like."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from drawer_chest import make_chest

import artigen.train.appearance.drawn
from artigen.appearance.paint import lay_painted
from artigen.errors import ArtigenError
from artigen.latent.draw import StructureModel, build_structure_model, load_structure_model
from artigen.latent.presets import PRESETS
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.train.appearance.drawn import NEAR, DrawnVoxels, redraw, roughen
from artigen.train.appearance.run import AppearanceRunConfig, claim_appearance_run
from artigen.types import Asset, SurfaceSamples
from artigen.voxels.fields import tabulate_parts
from artigen.voxels.frames import find_facings
from artigen.voxels.layout import lay_out
from artigen.voxels.voxelize import voxelize_again
from artigen.weights import SHIPPED
from sim_export.geometry.surface import sample_surface

MICROWAVE = draw_shape("Microwave", 3)


@pytest.fixture(scope="module")
def model() -> StructureModel:
    return load_structure_model(SHIPPED)


@pytest.fixture(scope="module")
def microwave(model: StructureModel) -> tuple[Asset, np.ndarray, DrawnVoxels]:
    """A microwave of 64^3 cells, the facings of its voxels, and the voxels as the model draws them."""
    asset, facings, _ = lay_painted(MICROWAVE, shape_to_asset(MICROWAVE, 64))
    return asset, facings, redraw(model, asset, facings, np.random.default_rng(5))


def voxelize(shape: Shape, resolution: int) -> tuple[Asset, np.ndarray]:
    asset = shape_to_asset(shape, resolution)
    assert asset.voxels is not None
    return asset, find_facings(asset.voxels.coords, asset.voxels.part_ids, resolution)


def distances(asset: Asset, drawn: DrawnVoxels) -> np.ndarray:
    """From drawn voxels to the true ones that they look like, in cells; of the same part they must be."""
    assert asset.voxels is not None
    assert (np.diff(drawn.rows) > 0).all()
    assert len(np.unique(drawn.coords, axis=0)) == len(drawn.coords)
    assert drawn.coords.min() >= 0
    assert drawn.coords.max() < asset.voxels.resolution
    assert (drawn.part_ids[drawn.rows] == asset.voxels.part_ids[drawn.like]).all()
    return np.linalg.norm(drawn.coords[drawn.rows] - asset.voxels.coords[drawn.like].astype(int), axis=1)


def test_roughened_voxels_are_a_little_off():
    asset, facings = voxelize(make_chest(), 16)
    assert asset.voxels is not None
    moved = []
    for seed in range(8):
        drawn = roughen(asset.voxels, facings, np.random.default_rng(seed))
        assert 0.5 * len(facings) < len(drawn.coords) < len(facings)
        assert (drawn.facings == facings[drawn.like]).all()
        off = distances(asset, drawn)
        assert off.max() <= 2 * np.sqrt(3)
        moved.append((off > 0).mean())
    assert 0.0 < min(moved) < 0.2  # no part is off
    assert max(moved) > 0.2  # one is


def test_redrawn_voxels_look_as_true_ones_that_face_as_they_do(microwave, model: StructureModel):
    asset, facings, drawn = microwave
    again = redraw(model, asset, facings, np.random.default_rng(5))
    for name, value in vars(drawn).items():
        np.testing.assert_array_equal(getattr(again, name), value)
    off = distances(asset, drawn)
    assert off.max() <= NEAR
    assert 0.05 < (off > 0).mean() < 0.8  # else it would be the object itself, or another one
    assert (drawn.facings[drawn.rows] == facings[drawn.like]).all()
    assert 0.8 < len(drawn.rows) / len(drawn.coords) < 1.0


@pytest.mark.slow
def test_resurfaced_voxels_are_those_that_an_object_is_generated_on(microwave, model: StructureModel):
    asset, facings, plain = microwave
    made = []

    def resurface(drawn: Asset) -> SurfaceSamples:
        made.append((drawn, sample_surface(drawn)))
        return made[-1][1]

    drawn = redraw(model, asset, facings, np.random.default_rng(5), resurface)
    ((structure, surface),) = made
    assert structure.voxels is not None
    np.testing.assert_array_equal(structure.voxels.coords, plain.coords)
    voxels, faced = lay_out(surface, voxelize_again(surface, structure.voxels))
    np.testing.assert_array_equal(drawn.coords, voxels.coords)
    np.testing.assert_array_equal(drawn.part_ids, voxels.part_ids)
    np.testing.assert_array_equal(drawn.facings, faced)
    assert distances(asset, drawn).max() <= NEAR
    assert (drawn.facings[drawn.rows] == facings[drawn.like]).all()


def test_voxels_stay_as_drawn_where_a_part_has_none(
    microwave, model: StructureModel, monkeypatch: pytest.MonkeyPatch
):
    asset, facings, plain = microwave
    more = replace(asset, parts=(*asset.parts, replace(asset.parts[-1], name="another")))
    monkeypatch.setattr(artigen.train.appearance.drawn, "tabulate_parts", lambda _: tabulate_parts(asset))
    drawn = redraw(model, more, facings, np.random.default_rng(5), sample_surface)
    np.testing.assert_array_equal(drawn.coords, plain.coords)
    np.testing.assert_array_equal(drawn.facings, plain.facings)


def test_a_model_of_another_resolution_is_refused():
    asset, facings = voxelize(make_chest(), 16)
    model = build_structure_model(PRESETS["small"])
    with pytest.raises(ValueError, match=r"voxels of 16\^3, the model draws those of 64\^3 within outlines"):
        redraw(model, asset, facings, np.random.default_rng(0))


def test_a_run_says_which_model_draws_and_refuses_one_that_cannot(tmp_path: Path):
    run = AppearanceRunConfig(folder=tmp_path / "run", preset="small", structure=SHIPPED)
    claim_appearance_run(run)
    claim_appearance_run(run)
    with pytest.raises(ArtigenError, match="structure"):
        claim_appearance_run(replace(run, structure=None))
    tiny = AppearanceRunConfig(folder=tmp_path / "tiny", preset="tiny", structure=SHIPPED)
    with pytest.raises(ArtigenError, match=r"voxels of 32\^3 within outlines need one of tiny"):
        claim_appearance_run(tiny)
    assert not tiny.home.exists()
