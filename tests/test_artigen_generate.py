"""Generation: cleaning, completed conditions, and one seed, one object."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

import artigen.generate
from artigen.ask import Request, read_request
from artigen.errors import SegmentationError, SourceError
from artigen.fields import VoxelFields, decode, encode
from artigen.generate import (
    GenerateConfig,
    build_structure_model,
    generate_structure,
    load_structure_model,
)
from artigen.mending.clean import CleanConfig, remove_strays, select_cells
from artigen.models.conditions import StructureCondition
from artigen.models.presets import PRESETS
from artigen.models.store import save_model
from artigen.types import Asset


def cells_of(fields: VoxelFields) -> set[tuple[int, ...]]:
    return set(map(tuple, fields.coords.tolist()))


def test_strays_are_removed_and_recorded_and_nothing_else(cabinet: Asset):
    whole = decode(encode(cabinet))
    field = encode(cabinet)
    field[:, 0:3, 0, 0] = field[:, whole.coords[0][0], whole.coords[0][1], whole.coords[0][2]][:, None]
    spoilt = decode(field)
    cleaned, notes = remove_strays(spoilt)
    added = {(0, 0, 0), (1, 0, 0), (2, 0, 0)} - cells_of(whole)
    assert added
    assert cells_of(spoilt) - cells_of(cleaned) == added
    assert notes == (f"{len(added)} cells in 1 of 2 loose pieces were removed",)
    assert remove_strays(cleaned) == (cleaned, ())


def test_the_largest_piece_stays_whatever_is_asked(cabinet: Asset):
    fields = decode(encode(cabinet))
    few = select_cells(fields, np.arange(len(fields.coords)) < 4)
    assert len(remove_strays(few, CleanConfig(min_cells=1000))[0].coords) > 0
    none = select_cells(fields, np.zeros(len(fields.coords), dtype=bool))
    assert remove_strays(none) == (none, ())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model that knows nothing."""
    torch.manual_seed(0)
    preset, path = PRESETS["tiny"], tmp_path_factory.mktemp("model")
    model = build_structure_model(preset)
    for name in ("vae", "outline", "reader", "flow"):
        save_model(getattr(model, name), path, {"preset": "tiny"}, name)
    return path


def test_a_model_that_knows_nothing_is_refused_by_the_segmentation_and_not_repaired(folder: Path):
    model = load_structure_model(folder)
    asked = read_request(Request(category="Microwave"), 0, 0).condition
    said = []
    for _ in range(2):
        with pytest.raises(SegmentationError) as caught:
            generate_structure(model, asked, seed=1)
        said.append(str(caught.value))
    assert said[0] == said[1]


def test_a_folder_without_a_model_says_so(folder: Path, tmp_path: Path):
    with pytest.raises(SourceError, match="there is no such model"):
        load_structure_model(tmp_path)
    (tmp_path / "model.json").write_text('{"flow": {"preset": "huge"}}')
    with pytest.raises(SourceError, match="preset 'huge'"):
        load_structure_model(tmp_path)


def test_what_has_a_fault_or_is_rough_is_drawn_again_and_the_best_kept(
    cabinet: Asset, monkeypatch: pytest.MonkeyPatch
):
    """Draws from memory, each with its faults and its roughness."""
    script = iter(
        [None, (("falls over",), 0.1), ((), 0.3), ((), 0.2), (("overlap",), 0.1), ((), 0.1), ((), 0.1)]
    )
    judged: dict[str, tuple[tuple[str, ...], float]] = {}

    def draw(*_: object) -> tuple[Asset, tuple[str, ...]]:
        said = next(script)
        if said is None:
            raise SegmentationError("no cells")
        asset = replace(cabinet, name=f"cabinet_{len(judged)}")
        judged[asset.name] = said
        return asset, tuple(fault for fault in said[0] if fault == "overlap")  # of the outline

    def find(asset: Asset, _: object) -> tuple[str, ...]:
        return tuple(fault for fault in judged[asset.name][0] if fault != "overlap")

    monkeypatch.setattr(artigen.generate, "_draw", draw)
    monkeypatch.setattr(artigen.generate, "find_asset_faults", find)
    monkeypatch.setattr(artigen.generate, "measure_roughness", lambda _: list(judged.values())[-1][1])
    model, asked = build_structure_model(PRESETS["tiny"]), StructureCondition(category="Oven")
    kept = generate_structure(model, asked, 0, GenerateConfig(draws=4))
    assert kept.name == "cabinet_2"
    assert kept.notes[:4] == (
        "draw 1: no cells",
        "draw 2: 0.10 bends per face; falls over",
        "draw 3: 0.30 bends per face",
        "draw 4: 0.20 bends per face",
    )
    again = generate_structure(model, asked, 0, GenerateConfig(draws=4))
    assert again.name == "cabinet_4"
    assert again.notes[0] == "draw 1: 0.10 bends per face; overlap"
    assert next(script) == ((), 0.1)  # the first that is good ends the search
