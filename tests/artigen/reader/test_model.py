"""Stored readers: what is read back is what was written, within the steps of the numbers in files."""

from pathlib import Path

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from artigen.errors import SourceError
from artigen.reader.kind_network import KindNetwork, pack_bytes, unpack_bytes
from artigen.reader.model import Reader, load_reader, save_reader
from artigen.reader.network import ReaderConfig, ReaderNetwork
from artigen.train.reader_kinds import NOTHING, fit_kinds


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 1000), st.floats(1e-6, 1e4))
def test_bytes_are_off_by_half_a_step_at_most(seed: int, scale: float):
    generator = torch.Generator().manual_seed(seed)
    weights = {
        "filters": scale * torch.randn(5, 3, 2, 2, generator=generator),
        "bias": scale * torch.randn(5, generator=generator),
        "empty": torch.zeros(2, 3),
    }
    found = unpack_bytes(pack_bytes(weights))
    assert found.keys() == weights.keys()
    assert torch.equal(found["bias"], weights["bias"])
    assert torch.equal(found["empty"], weights["empty"])
    step = weights["filters"].flatten(1).abs().amax(dim=1) / 127
    off = (found["filters"] - weights["filters"]).flatten(1).abs().amax(dim=1)
    assert (off <= 0.501 * step).all()


def test_a_stored_reader_reads_alike(tmp_path: Path):
    torch.manual_seed(0)
    network = ReaderNetwork(ReaderConfig(variant="lite0", width=16)).eval()
    kinds = KindNetwork("lite0")
    with torch.no_grad():
        for parameter in (*network.parameters(), *kinds.parameters()):
            if parameter.dim() > 1:
                torch.nn.init.kaiming_normal_(parameter)
    counts = {"Refrigerator": {(2, 0): 0.75, (1, 0): 0.25}}
    stored = Reader(network=network, kinds=kinds, counts=counts, left_shares={"Refrigerator": 0.3})
    save_reader(stored, tmp_path, {"steps": 1})
    found = load_reader(tmp_path)
    assert (found.counts, found.left_shares) == (counts, stored.left_shares)
    assert found.network.cfg == network.cfg
    pixels = torch.randint(0, 256, (1, 3, 64, 64), generator=torch.Generator().manual_seed(2))
    with torch.no_grad():
        torch.testing.assert_close(found.network(pixels).heat, network(pixels).heat, rtol=0.02, atol=0.02)
        one, two = found.kinds.extract(pixels)[0], kinds.extract(pixels)[0]
    assert torch.nn.functional.cosine_similarity(one, two, dim=0) > 0.995


def test_a_description_of_something_else_is_refused(tmp_path: Path):
    (tmp_path / "model.json").write_text('{"sketch": {}}')
    with pytest.raises(SourceError, match="describes no reader"):
        load_reader(tmp_path)


@pytest.mark.slow
def test_kinds_that_features_tell_apart_are_learned_though_some_are_rare():
    network, generator = KindNetwork("lite0"), torch.Generator().manual_seed(0)
    centers = torch.randn(3, 1280, generator=generator)
    kinds = torch.tensor([4] * 300 + [9] * 30 + [NOTHING] * 100)
    rows = torch.tensor([0] * 300 + [1] * 30 + [2] * 100)
    features = centers[rows] + 0.5 * torch.randn(430, 1280, generator=generator)
    fit_kinds(network, features, kinds, torch.ones(430))
    fresh = centers[rows] + 0.5 * torch.randn(430, 1280, generator=generator)
    assert (network.kinds(fresh).argmax(dim=1) == kinds).float().mean() > 0.99
