"""Appearance drawn for a structure: same seed same bytes, parts follow voxels, one file per link."""

import json
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
import torch

from artigen.appearance.draw import (
    AppearanceModel,
    generate_appearance,
    has_appearance,
    load_appearance_model,
)
from artigen.appearance.paint import PaintedSurface
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.vae import APPEARANCE_FLOW, APPEARANCE_VAE, AppearanceVae
from artigen.errors import SourceError
from artigen.io import read_asset, write_asset
from artigen.latent.draw import build_structure_model
from artigen.latent.presets import PRESETS
from artigen.models.conditions import StructureCondition
from artigen.models.rectified_flow import SamplerConfig
from artigen.models.store import save_model
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.splats.ply import read_ply
from artigen.types import Asset, Gaussians, VoxelGrid
from artigen.voxels.layout import lay_out
from artigen.voxels.voxelize import voxelize_again
from sim_export.export import export_asset
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.geometry.surface import sample_surface
from sim_export.package import Link
from sim_export.physics.links import link_owners

FEW = SamplerConfig(steps=2)
ASKED = StructureCondition(category="StorageFurniture")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model that knows nothing, in both halves."""
    torch.manual_seed(0)
    preset, look = PRESETS["tiny"], APPEARANCE_PRESETS["tiny"]
    path = tmp_path_factory.mktemp("model")
    structure = build_structure_model(preset)
    for name in ("vae", "flow"):
        save_model(getattr(structure, name), path, {"preset": "tiny"}, name)
    assert not has_appearance(path)
    # The encoder depends on the feature extractor, which generating does not need.
    vae = AppearanceVae(replace(look.encoder, in_channels=19), look.decoder)
    flow = SlatFlow(look.flow, look.conditions)
    for layer in (vae.decoder.out_layer, flow.network.out_layer):  # zero in untrained networks
        torch.nn.init.normal_(layer.weight, std=0.1)
    with torch.no_grad():  # the last channels are the opacities: Gaussians that hide something
        vae.decoder.out_layer.bias[-look.decoder.gaussians.count :] = 4.0
    save_model(vae, path, {"preset": "tiny"}, APPEARANCE_VAE)
    save_model(flow, path, {"preset": "tiny"}, APPEARANCE_FLOW)
    return path


@pytest.fixture(scope="module")
def structure() -> Asset:
    """What a structure model of 32 cells would give: no surface, no Gaussians."""
    return shape_to_asset(draw_shape("Safe", 0), resolution=32)


def paint(model: AppearanceModel, structure: Asset, seed: int) -> Asset:
    return generate_appearance(model, structure, ASKED, seed, surface=sample_painted(structure), sampler=FEW)


def sample_painted(structure: Asset) -> PaintedSurface:
    """The surface of an asset's meshes, every part in a colour of its own."""
    samples = sample_surface(structure)
    colors = np.random.default_rng(0).integers(0, 256, (len(structure.parts), 3), dtype=np.uint8)
    return PaintedSurface(
        samples=replace(samples, colors=colors[samples.part_ids]), clear=np.zeros(len(samples.points))
    )


def covered_voxels(structure: Asset) -> VoxelGrid:
    """The voxels that the surface of an asset's meshes passes through."""
    samples = sample_surface(structure)
    return lay_out(samples, voxelize_again(samples, structure.voxels))[0]


def test_the_same_seed_gives_the_same_gaussians_and_another_seed_others(folder: Path, structure: Asset):
    model = load_appearance_model(folder)
    one, two, other = (paint(model, structure, seed) for seed in (5, 5, 6))
    for item in fields(Gaussians):
        np.testing.assert_array_equal(getattr(one.gaussians, item.name), getattr(two.gaussians, item.name))
    assert np.abs(one.gaussians.colors - other.gaussians.colors).max() > 0.01


def test_gaussians_belong_to_the_parts_of_their_voxels(folder: Path, structure: Asset):
    model = load_appearance_model(folder)
    asset = paint(model, structure, 5)
    count = model.preset.decoder.gaussians.count
    voxels = covered_voxels(structure)
    assert len(asset.gaussians.means) == count * len(voxels.coords)
    np.testing.assert_array_equal(asset.gaussians.part_ids, np.repeat(voxels.part_ids, count))
    # They are where their voxels are.
    away = np.abs(asset.gaussians.means - np.repeat(voxels.centers(), count, axis=0))
    assert away.max() <= 0.75 / 32 + 1e-6
    assert asset.voxels is structure.voxels


def test_assets_keep_their_gaussians(folder: Path, structure: Asset, tmp_path: Path):
    asset = paint(load_appearance_model(folder), structure, 5)
    write_asset(asset, tmp_path / "asset")
    back = read_asset(tmp_path / "asset")
    for item in fields(Gaussians):
        np.testing.assert_array_equal(getattr(back.gaussians, item.name), getattr(asset.gaussians, item.name))


@pytest.mark.slow
def test_packages_have_one_file_of_gaussians_per_link_and_textures_made_of_them(
    folder: Path, structure: Asset, tmp_path: Path
):
    def export() -> None:
        write_package(
            export_asset(paint(load_appearance_model(folder), structure, 9)).package, place, "replace"
        )

    place = tmp_path / "painted"
    export()
    package = read_package(place)
    files = sorted(path.stem for path in (place / "splats").iterdir())
    shown = sorted(link.name for link in package.links if link.visuals)
    assert files == shown
    assert len(files) == len(set(link_owners(structure)))
    counts = {name: len(read_ply(place / "splats" / f"{name}.ply").means) for name in files}
    voxels = covered_voxels(structure)
    assert sum(counts.values()) == 4 * len(voxels.coords)
    for index, link in enumerate(package.links):
        if link.splats is None:
            assert not link.visuals
            continue
        assert len(link.splats.means) == counts[link.name]
        assert (link.splats.part_ids == index).all()
        assert_near(link)
    textures = [visual.mesh.texture for link in package.links for visual in link.visuals]
    assert all(texture is not None and texture.min() > 0 for texture in textures)
    assert any(record.startswith("textures: Gaussians of the own part cover") for record in package.records)
    before = {path.name: path.read_bytes() for path in place.rglob("*") if path.is_file()}
    export()
    assert before == {path.name: path.read_bytes() for path in place.rglob("*") if path.is_file()}


def assert_near(link: Link) -> None:
    """Gaussians are in the object frame, where the link's meshes are."""
    corners = np.concatenate([visual.mesh.vertices for visual in link.visuals])
    low, high = corners.min(axis=0) - 0.1, corners.max(axis=0) + 0.1
    assert ((link.splats.means > low) & (link.splats.means < high)).all()


def test_what_does_not_fit_is_said(folder: Path, structure: Asset, tmp_path: Path):
    model = load_appearance_model(folder)
    with pytest.raises(ValueError, match="voxels are none"):
        generate_appearance(model, replace(structure, voxels=None), ASKED, 0)
    finer = replace(structure.voxels, resolution=64)
    with pytest.raises(ValueError, match=r"of 64\^3, this model needs some of 32\^3"):
        generate_appearance(model, replace(structure, voxels=finer), ASKED, 0)
    with pytest.raises(ValueError, match="has no painted samples of its surface"):
        generate_appearance(model, structure, ASKED, 0)
    with pytest.raises(SourceError, match="there is no such model"):
        load_appearance_model(tmp_path)
    (tmp_path / "model.json").write_text(json.dumps({"flow": {"preset": "tiny"}}))
    with pytest.raises(SourceError, match="describes flow, expected appearance-vae"):
        load_appearance_model(tmp_path)
    named = {APPEARANCE_VAE: {"preset": "tiny"}, APPEARANCE_FLOW: {"preset": "compact"}}
    (tmp_path / "model.json").write_text(json.dumps(named))
    with pytest.raises(SourceError, match="for both"):
        load_appearance_model(tmp_path)
