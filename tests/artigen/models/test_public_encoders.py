"""DINOv2 and CLIP as conditions: tokens as these give them, training and drawing with and without."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from encoder_files import CLIP, DINO, write_clip, write_dinov2
from torch.nn import functional

from artigen.errors import ArtigenError, SourceError
from artigen.latent.presets import PRESETS, StructurePreset
from artigen.latent.structure_dit import StructureDit, StructureDitConfig
from artigen.models.conditions import (
    FIELDS,
    ConditionConfig,
    ConditionEncoder,
    StructureCondition,
    drop_conditions,
    gather_conditions,
    isolate_pictures,
)
from artigen.models.public_encoders import (
    CLIP_FOLDER,
    DINO_FOLDER,
    attach_encoders,
    find_encoders,
    load_clip,
    load_dinov2,
)
from artigen.train.everything import train_everything
from artigen.train.presets import TRAINING
from artigen.train.run import RunConfig, run_conditions
from artigen.types import PART_LABELS

KNOWN = ConditionConfig(width=48, image_size=16, dino=DINO, clip=CLIP)
FLOW = StructureDitConfig(
    resolution=8, model_channels=48, cond_channels=48, num_blocks=1, num_heads=2, patch_size=2
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Both encoders, small, with random weights."""
    path = tmp_path_factory.mktemp("encoders")
    write_dinov2(path / "dinov2-with-registers-large")
    write_clip(path / "clip-vit-large-patch14")
    return path


@pytest.fixture
def encoder(folder: Path) -> ConditionEncoder:
    torch.manual_seed(1)
    encoder = ConditionEncoder(KNOWN)
    attach_encoders(encoder, folder)
    return encoder


def picture() -> np.ndarray:
    return np.random.default_rng(0).random((4, 16, 16), dtype=np.float32)


def test_tokens_are_what_the_public_networks_give(folder: Path, encoder: ConditionEncoder):
    asked = [
        StructureCondition(image=picture()),
        StructureCondition(category="Oven", text="an oven with one door"),
        StructureCondition(),
    ]
    batch = gather_conditions(asked, KNOWN)
    tokens = encoder(batch)
    assert tokens.shape == (3, FIELDS + DINO.length + CLIP.length, KNOWN.width)
    seen = load_dinov2(folder / DINO_FOLDER, DINO).tokens(batch.image[:1, :3])
    shown, told = tokens[:, FIELDS : FIELDS + DINO.length], tokens[:, FIELDS + DINO.length :]
    torch.testing.assert_close(shown[:1], functional.layer_norm(seen, (48,)))
    assert not shown[1:].any()
    read = load_clip(folder / CLIP_FOLDER, CLIP)(["an oven with one door"])
    assert encoder.text is not None
    torch.testing.assert_close(told[1:2], encoder.text.out_layer(read))
    torch.testing.assert_close(told[0], encoder.text.missing.expand(CLIP.length, -1))


def test_public_weights_are_no_part_of_the_models(encoder: ConditionEncoder):
    assert set(encoder.state_dict()) == set(ConditionEncoder(KNOWN).state_dict())


def test_what_cannot_be_read_is_said_and_the_rest_is_answered(tmp_path: Path, folder: Path):
    alone = ConditionEncoder(KNOWN)
    assert alone(gather_conditions([StructureCondition(category="Oven")], KNOWN)).isfinite().all()
    with pytest.raises(
        SourceError, match="DINOv2, which was not given: download dinov2-with-registers-large"
    ):
        alone(gather_conditions([StructureCondition(image=picture())], KNOWN))
    with pytest.raises(SourceError, match="CLIP, which was not given: download clip-vit-large-patch14"):
        alone(gather_conditions([StructureCondition(text="an oven")], KNOWN))
    with pytest.raises(SourceError, match="holds neither DINOv2"):
        attach_encoders(alone, tmp_path)
    write_clip(tmp_path / "clip-vit-large-patch14")
    assert find_encoders(tmp_path) == ("text",)
    assert find_encoders(folder) == ("image", "text")
    with pytest.raises(ValueError, match="tokens of width 48, expected 64"):
        ConditionConfig(width=64, dino=DINO)


def test_sentences_are_left_open_as_other_fields_are():
    asked = [StructureCondition(text=f"{number} doors", image=picture()) for number in range(200)]
    batch = gather_conditions(asked, KNOWN)
    kept = drop_conditions(batch, 0.3, torch.Generator().manual_seed(0)).texts
    assert 0.4 < np.mean([text is not None for text in kept]) < 0.58  # 0.7 squared
    assert all(text in (None, one.text) for text, one in zip(kept, asked, strict=True))
    alone = isolate_pictures(batch, 0.5, torch.Generator().manual_seed(0)).texts
    assert 0.4 < np.mean([text is None for text in alone]) < 0.6
    assert gather_conditions(asked, replace(KNOWN, clip=None)).texts == (None,) * 200


@pytest.fixture
def paper(monkeypatch: pytest.MonkeyPatch) -> StructurePreset:
    """The preset of the paper, small enough for a test."""
    tiny = PRESETS["tiny"]
    preset = replace(tiny, flow=FLOW, conditions=KNOWN)
    stages = replace(TRAINING["tiny"], decoder=None)
    monkeypatch.setitem(PRESETS, "paper", preset)
    monkeypatch.setitem(TRAINING, "paper", stages)
    return preset


@pytest.mark.slow
def test_a_flow_is_trained_from_a_public_checkpoint_with_public_encoders(
    paper: StructurePreset, folder: Path, tmp_path: Path
):
    torch.manual_seed(2)
    network = StructureDit(FLOW)
    checkpoint = tmp_path / "ss_flow"
    write_checkpoint(checkpoint, network)
    cfg = RunConfig(
        folder=tmp_path / "run",
        preset="paper",
        minutes=1e-6,  # one step of each network
        shards=1,
        held_out=1,
        objects=2,
        workers=1,
        trellis=checkpoint,
        encoders=folder,
    )
    assert run_conditions(cfg) == KNOWN
    assert run_conditions(replace(cfg, encoders=None)) == replace(KNOWN, image_size=0, clip=None)
    assert train_everything(cfg)
    stored = torch.load(cfg.folder / "flow" / "checkpoint.pt", weights_only=True)["network"]
    moved = max(
        float((stored[f"network.{name}"] - value).abs().max()) for name, value in network.state_dict().items()
    )
    assert 0 < moved < 0.01  # one step away from where it began
    said = json.loads((cfg.folder / "config.json").read_text())
    assert (said["encoders"], said["trellis"]) == ("image and text", "ss_flow")
    with pytest.raises(ArtigenError, match="has another flow than TRELLIS"):
        train_everything(replace(cfg, folder=tmp_path / "other", preset="tiny", encoders=None))
    with pytest.raises(ArtigenError, match="cannot start from both"):
        train_everything(replace(cfg, start=tmp_path))


def write_checkpoint(path: Path, network: StructureDit) -> None:
    """A network as TRELLIS stores its structure flow."""
    from safetensors.torch import save_file

    save_file(network.state_dict(), path.with_name(path.name + ".safetensors"))
    arguments = {
        "resolution": FLOW.resolution,
        "in_channels": FLOW.in_channels,
        "out_channels": FLOW.in_channels,
        "model_channels": FLOW.model_channels,
        "cond_channels": FLOW.cond_channels,
        "num_blocks": FLOW.num_blocks,
        "num_heads": FLOW.num_heads,
        "mlp_ratio": FLOW.mlp_ratio,
        "patch_size": FLOW.patch_size,
        "pe_mode": "ape",
        "qk_rms_norm": FLOW.qk_rms_norm,
    }
    path.with_name(path.name + ".json").write_text(
        json.dumps({"name": "SparseStructureFlowModel", "args": arguments})
    )


def test_the_preset_of_the_paper_reads_pictures_and_sentences():
    known = PRESETS["paper"].conditions
    assert known.dino is not None
    assert known.image_size == known.dino.edge * known.dino.patch == 518
    assert known.clip is not None
    counts = tuple((label, 1) for label in PART_LABELS)
    batch = gather_conditions([StructureCondition(counts=counts, text="a desk")], known)
    assert batch.texts == ("a desk",)
