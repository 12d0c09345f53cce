"""What a loss must ignore, and where it must vanish."""

import numpy as np
import torch
from reader_samples import kitchen, make_picture, to_maps
from torch import nn

from artigen.reader.labels import FRONT
from artigen.reader.network import Maps
from artigen.reader.targets import make_batch, make_mark
from artigen.train.reader_losses import reader_losses


class Fixed(nn.Module):
    """A network that says the same of every picture."""

    def __init__(self, maps: Maps) -> None:
        super().__init__()
        self.heat = nn.Parameter(maps.heat)
        self.attributes = nn.ParameterDict(maps.attributes)

    def forward(self, pixels: torch.Tensor) -> Maps:
        return Maps(heat=self.heat, attributes=dict(self.attributes.items()))


def detach(terms: dict[str, torch.Tensor]) -> dict[str, float]:
    return {name: float(term.detach()) for name, term in terms.items()}


def test_a_network_that_knows_the_targets_loses_nothing():
    batch = make_batch([kitchen()])
    generator = torch.Generator()
    known = detach(reader_losses(Fixed(to_maps(batch)), batch, generator))
    blank = Maps(
        heat=torch.zeros_like(batch.heat),
        attributes={name: torch.zeros_like(v) for name, v in to_maps(batch).attributes.items()},
    )
    ignorant = detach(reader_losses(Fixed(blank), batch, generator))
    for name in ("box", "door", "hinge", "open", "pane", "kind", "corners", "view"):
        assert known[name] < 0.01 + 0.02 * ignorant[name], name
    assert known["heat"] < 0.1 * ignorant["heat"]


def test_unknown_attributes_and_silenced_cells_have_no_gradient():
    mark = make_mark(FRONT, np.array([30.0, 30.0, 90.0, 90.0]))
    picture = make_picture([mark])
    picture.weight[:, :, 20:] = 0.0
    batch = make_batch([picture])
    network = Fixed(to_maps(batch))
    with torch.no_grad():
        network.heat[0, FRONT, 2, 28] = 5.0  # a false alarm where nothing is known
    torch.stack(list(reader_losses(network, batch, torch.Generator()).values())).sum().backward()
    assert network.heat.grad is not None
    assert network.heat.grad[0, FRONT, 2, 28] == 0
    assert network.heat.grad[0, FRONT, 2, 2] != 0
    for name in ("door", "hinge", "open", "pane", "material", "kind", "corners"):
        gradient = network.attributes[name].grad
        assert gradient is None or not gradient.any(), name
