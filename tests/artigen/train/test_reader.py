"""Training of the reader: resumable to the same curve, from stated beginnings."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from artigen.errors import ArtigenError, SourceError
from artigen.examples.reader_views import take_views
from artigen.examples.view_shards import pack_views
from artigen.reader.network import ReaderConfig, ReaderNetwork
from artigen.reader.trunk import Trunk
from artigen.train import reader as reader_training
from artigen.train.loop import LoopConfig, finished_steps, train
from artigen.train.reader import ReaderRunConfig, draw_batches, find_trunk, load_pretrained
from artigen.train.reader_losses import reader_losses

SIZE = 64


@pytest.fixture(scope="module")
def shards(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("views")
    np.savez(folder / "shard_00000.npz", **pack_views(take_views(11, 2)))
    return [folder / "shard_00000.npz"]


def run(folder: Path, shards: list[Path], steps: int) -> ReaderNetwork:
    torch.manual_seed(0)
    network = ReaderNetwork(ReaderConfig(variant="lite0", width=16)).train()
    cfg = ReaderRunConfig(folder=folder, size=SIZE, batch=2, workers=0)
    batches = draw_batches(cfg, shards, finished_steps(folder))
    loop = LoopConfig(steps=steps, learning_rate=1e-3, warmup=1, decay=0.01, report_every=1)
    train(network, reader_losses, batches, folder, loop, factors={"trunk.": 0.1})
    return network


def read_losses(folder: Path) -> list[float]:
    return [json.loads(line)["loss"] for line in (folder / "metrics.jsonl").read_text().splitlines()]


@pytest.mark.slow
def test_an_interrupted_run_follows_the_same_curve(tmp_path: Path, shards: list[Path]):
    run(tmp_path / "whole", shards, 4)
    run(tmp_path / "halves", shards, 2)
    run(tmp_path / "halves", shards, 4)
    np.testing.assert_allclose(read_losses(tmp_path / "halves"), read_losses(tmp_path / "whole"), rtol=1e-3)


def test_frozen_blocks_and_depthwise_filters_stay_as_they_are(tmp_path: Path, shards: list[Path]):
    torch.manual_seed(0)
    before = ReaderNetwork(ReaderConfig(variant="lite0", width=16))
    after = run(tmp_path / "run", shards, 2)
    changed = {
        name
        for (name, one), two in zip(before.named_parameters(), after.parameters(), strict=True)
        if not torch.allclose(one, two, rtol=1e-4, atol=1e-6)
    }
    frozen = {f"trunk.blocks.{index}." for index in range(before.first_tuned)} | {"trunk.stem."}
    tuned = {name for name in changed if name.startswith("trunk.blocks.")}
    assert not {name for name in changed if name.startswith(tuple(frozen))}
    assert not {name for name in tuned if name.endswith("depth.weight")}
    assert tuned
    assert "heat.weight" in changed


def test_ranks_share_the_batches_of_one_process(tmp_path: Path, shards: list[Path]):
    cfg = ReaderRunConfig(folder=tmp_path, size=SIZE, batch=2, workers=0)

    def take(first: int, count: int, ranks: int = 1, rank: int = 0) -> list[bytes]:
        batches = draw_batches(cfg, shards, first, ranks, rank)
        return [next(batches).pixels.numpy().tobytes() for _ in range(count)]

    alone = take(0, 4)
    assert take(0, 2, 2, 0) == alone[0::2]
    assert take(0, 2, 2, 1) == alone[1::2]
    assert take(3, 1) == alone[3:]


def test_a_run_says_what_it_lacks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(ArtigenError, match="no such file"):
        find_trunk(ReaderRunConfig(folder=tmp_path, trunk=tmp_path / "none.pth"))

    def refuse(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(reader_training, "import_module", refuse)
    with pytest.raises(ArtigenError, match="install artigen"):
        find_trunk(ReaderRunConfig(folder=tmp_path))
    torch.save({"weight": torch.zeros(1)}, tmp_path / "other.pth")
    with pytest.raises(SourceError, match="EfficientNet-Lite"):
        load_pretrained(Trunk("lite0"), tmp_path / "other.pth")
    with pytest.raises(ArtigenError, match="multiple of 32"):
        reader_training.train_reader(ReaderRunConfig(folder=tmp_path / "run", size=100))


def test_a_trunk_without_its_classifier_has_the_weights_of_one_with(tmp_path: Path):
    whole, bare = Trunk("lite0", pooled=True).state_dict(), Trunk("lite0").state_dict()
    assert whole.keys() - bare.keys() == {"head.weight", "head.bias"}
