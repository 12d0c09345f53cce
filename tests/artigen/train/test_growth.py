"""Growth of a sketch network: nothing changes until it is trained, and everything is trained."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from artigen.errors import ArtigenError
from artigen.shapes.draw import draw_shape
from artigen.sketch.batch import make_batch, sample_request
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.picture import PictureConfig
from artigen.sketch.rows import sketch_to_rows
from artigen.sketch.sketch import write_sketch
from artigen.train.growth import grow_network

SMALL = SketchNetworkConfig(
    width=32,
    layers=2,
    heads=4,
    pointer=8,
    picture=PictureConfig(edge=64, widths=(8, 16, 16), stem=8, whole=16, layers=1, heads=4),
)


def _losses(network: SketchNetwork) -> torch.Tensor:
    table = sketch_to_rows(write_sketch(draw_shape("Microwave", 0)))
    image = torch.rand(1, 4, 64, 64, generator=torch.Generator().manual_seed(0))
    memory = network.encode_pictures(image)[1]
    batch = make_batch([table], [sample_request(table, np.random.default_rng(0))])
    return torch.cat([losses.flatten() for losses in network(batch, memory)])


def test_grown_network_predicts_what_the_small_one_does_and_learns_in_every_block() -> None:
    torch.manual_seed(0)
    small = SketchNetwork(SMALL)
    with torch.no_grad():
        for name, value in small.named_parameters():
            if name.endswith("look.out.weight"):  # a fresh network ignores pictures
                value.normal_(std=0.1)
    assert SMALL.picture is not None
    grown = grow_network(small, replace(SMALL, layers=6, picture=replace(SMALL.picture, layers=3)))
    losses = _losses(grown)
    torch.testing.assert_close(losses, _losses(small))
    losses.sum().backward()
    last = [value for name, value in grown.named_parameters() if name.endswith(("out.weight", "down.weight"))]
    assert len(last) > 12
    assert all(value.grad is not None and bool((value.grad != 0).any()) for value in last)


@pytest.mark.parametrize("change", [{"layers": 5}, {"width": 64}, {"pointer": 16}])
def test_other_differences_are_refused(change: dict[str, int]) -> None:
    with pytest.raises(ArtigenError, match="grow"):
        grow_network(SketchNetwork(SMALL), replace(SMALL, **change))
