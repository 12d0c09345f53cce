"""Generation: one seed, one object, within the boxes of an exact one; parts are told or voted for."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import torch

import artigen.latent.draw
from artigen.conditioning.delivery import asset_size, part_counts
from artigen.errors import SegmentationError, SourceError
from artigen.latent.draw import (
    GenerateConfig,
    StructureModel,
    build_structure_model,
    generate_structure,
    load_structure_model,
)
from artigen.latent.outline import OutlineBatch, sort_rows
from artigen.latent.presets import PRESETS
from artigen.models.conditions import StructureCondition
from artigen.models.store import save_model
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.types import Asset
from artigen.voxels.fields import VoxelFields, decode, encode, tabulate_parts
from artigen.voxels.segmentation.segment import SegmentConfig

OPEN = StructureCondition()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model that knows nothing."""
    torch.manual_seed(0)
    preset, path = PRESETS["tiny"], tmp_path_factory.mktemp("model")
    model = build_structure_model(preset)
    for name in ("vae", "flow"):
        save_model(getattr(model, name), path, {"preset": "tiny"}, name)
    return path


@pytest.fixture(scope="module")
def model(folder: Path) -> StructureModel:
    return load_structure_model(folder)


@pytest.fixture(scope="module")
def shape() -> Shape:
    return draw_shape("StorageFurniture", 6)


@pytest.fixture(scope="module")
def exact(shape: Shape) -> Asset:
    return shape_to_asset(shape, 32)


@dataclass(frozen=True, kw_only=True, eq=False)
class Decoded:
    """What a decoder was asked."""

    latent: torch.Tensor
    outlines: OutlineBatch


def say(monkeypatch: pytest.MonkeyPatch, fields: VoxelFields) -> list[Decoded]:
    """Lets latents be decoded to given fields, and collects what is decoded."""
    seen: list[Decoded] = []

    def from_memory(vae, latent, outlines, steady):
        seen.append(Decoded(latent=latent, outlines=outlines))
        certain = np.full((1, *(fields.resolution,) * 3), -9.0, dtype=np.float32)
        certain[(0, *fields.coords.T)] = 9.0
        return [fields], torch.from_numpy(certain)

    monkeypatch.setattr(artigen.latent.draw, "decode_cells", from_memory)
    return seen


@pytest.mark.parametrize("cfg", [GenerateConfig(), GenerateConfig(segment=SegmentConfig())])
def test_an_object_has_the_parts_and_the_size_of_its_boxes(
    model: StructureModel, shape: Shape, exact: Asset, cfg: GenerateConfig, monkeypatch: pytest.MonkeyPatch
):
    say(monkeypatch, decode(encode(exact)))
    drawn = generate_structure(model, OPEN, 7, cfg, boxes=shape)
    assert (drawn.name, drawn.category, drawn.scale) == ("StorageFurniture_7", exact.category, exact.scale)
    assert (part_counts(drawn) == part_counts(exact)).all()
    np.testing.assert_allclose(asset_size(drawn), asset_size(exact), rtol=1e-4)
    assert drawn.voxels is not None
    assert exact.voxels is not None
    both = drawn.voxels.occupied() & exact.voxels.occupied()
    assert both.sum() > 0.9 * (drawn.voxels.occupied() | exact.voxels.occupied()).sum()
    if cfg.segment is None:
        assert [part.name for part in drawn.parts] == [part.name for part in exact.parts]
        assert [part.parent for part in drawn.parts] == [part.parent for part in exact.parts]


def test_one_latent_is_drawn_and_follows_from_the_seed(
    model: StructureModel, exact: Asset, monkeypatch: pytest.MonkeyPatch
):
    seen = say(monkeypatch, decode(encode(exact)))
    for seed in (1, 1, 2):
        generate_structure(model, OPEN, seed, boxes=exact)
    assert len(seen) == 3
    assert torch.equal(seen[0].latent, seen[1].latent)
    assert not torch.equal(seen[0].latent, seen[2].latent)


def test_boxes_are_told_and_what_is_asked_gives_way_to_them(
    model: StructureModel, exact: Asset, monkeypatch: pytest.MonkeyPatch
):
    seen = say(monkeypatch, decode(encode(exact)))
    generate_structure(model, OPEN, 1, boxes=exact)
    generate_structure(model, StructureCondition(category="Oven", counts=(("door", 9),)), 1, boxes=exact)
    assert torch.equal(seen[0].latent, seen[1].latent)
    assert torch.equal(seen[0].outlines.rows[0], torch.from_numpy(sort_rows(tabulate_parts(exact))))
    first, second, *others = exact.parts
    second = replace(second, box=second.box * [[1.0], [0.98]])
    generate_structure(model, OPEN, 1, boxes=replace(exact, parts=(first, second, *others)))
    assert not torch.equal(seen[0].outlines.rows, seen[2].outlines.rows)


def test_a_part_without_a_cell_is_refused_by_name(
    model: StructureModel, exact: Asset, monkeypatch: pytest.MonkeyPatch
):
    assert exact.voxels is not None
    lost = exact.parts[-1].name
    fewer = exact.voxels.part_ids != len(exact.parts) - 1
    grid = replace(exact.voxels, coords=exact.voxels.coords[fewer], part_ids=exact.voxels.part_ids[fewer])
    say(monkeypatch, decode(encode(replace(exact, voxels=grid))))
    with pytest.raises(SegmentationError, match=f"no voxel was drawn for {lost} of {len(exact.parts)} parts"):
        generate_structure(model, OPEN, 1, boxes=exact)


def test_votes_that_make_no_object_are_refused(
    model: StructureModel, exact: Asset, monkeypatch: pytest.MonkeyPatch
):
    assert exact.voxels is not None
    base = exact.voxels.part_ids == exact.root
    grid = replace(exact.voxels, coords=exact.voxels.coords[~base], part_ids=exact.voxels.part_ids[~base])
    say(monkeypatch, decode(encode(replace(exact, voxels=grid))))
    with pytest.raises(SegmentationError, match="is labelled base"):
        generate_structure(model, OPEN, 1, GenerateConfig(segment=SegmentConfig()), boxes=exact)


def test_a_category_that_the_model_does_not_know_is_named(model: StructureModel):
    with pytest.raises(ValueError, match="category 'Safe' is not one of"):
        generate_structure(model, OPEN, 0, boxes=draw_shape("Safe", 0))


def test_a_folder_without_a_model_says_so(folder: Path, tmp_path: Path):
    with pytest.raises(SourceError, match="there is no such model"):
        load_structure_model(tmp_path)
    (tmp_path / "model.json").write_text('{"flow": {"preset": "huge"}}')
    with pytest.raises(SourceError, match="preset 'huge'"):
        load_structure_model(tmp_path)
