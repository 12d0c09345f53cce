"""Linear prediction of voxel latents from paint and geometry, per kind of voxel.

The appearance of a painted side follows mostly from its colour, the label of its part, its direction and
whether something stands before it; the positions of its Gaussians follow from that of the surface. Each kind
of voxel therefore has a linear map from paint, places and neighbours, fitted by least squares. The flow
models the residual.
"""

from collections.abc import Iterable

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from artigen.appearance.paint import PAINT
from artigen.types import PART_LABELS
from artigen.voxels.frames import AROUND, FACINGS, SIDES
from artigen.voxels.surface import PLACES

KINDS = len(PART_LABELS) * 2**SIDES * FACINGS
"""Number of kinds: part labels, whether either side is covered, directions."""
TERMS = 2 * PAINT + AROUND + PLACES
"""Regressors: 1, two colours, transmission, transmission times colours, whether the part continues around,
places."""
FEW = 50.0
"""Ridge, in voxels, that draws the map of a kind towards that of all kinds together."""


class Expectation(nn.Module):
    """Expected latents of voxels; zero until fitted."""

    weight: Tensor

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.register_buffer("weight", torch.zeros(KINDS, TERMS, channels))

    def forward(self, attributes: Float[Tensor, "N A"]) -> Float[Tensor, "N C"]:
        """Expected latents of voxels described by `artigen.appearance.attributes.describe_voxels`."""
        kinds, terms = find_kinds(attributes), list_terms(attributes)
        out = attributes.new_empty(len(attributes), self.weight.shape[2])
        with torch.autocast(attributes.device.type, enabled=False):  # latents are relative to this
            for kind in kinds.unique():
                own = kinds == kind
                out[own] = terms[own] @ self.weight[kind].to(terms.dtype)
        return out


def find_kinds(attributes: Float[Tensor, "N A"]) -> Int[Tensor, "N"]:
    """Kind number of each voxel."""
    widths = [FACINGS, len(PART_LABELS), SIDES, AROUND + PLACES + PAINT]
    facing, label, covered, _ = attributes.split(widths, dim=1)
    outer, inner = (covered > 0.5).long().unbind(1)
    return ((label.argmax(dim=1) * 2 + outer) * 2 + inner) * FACINGS + facing.argmax(dim=1)


def list_terms(attributes: Float[Tensor, "N A"]) -> Float[Tensor, "N 24"]:
    """Regressors of the linear prior."""
    last = attributes[:, -AROUND - PLACES - PAINT :].split([AROUND + PLACES, PAINT - 1, 1], dim=1)
    geometry, colors, clear = last
    return torch.cat([torch.ones_like(clear), colors, clear, clear * colors, geometry], dim=1)


def fit_expectation(
    voxels: Iterable[tuple[Float[Tensor, "N A"], Float[Tensor, "N C"]]], blur: float
) -> Float[Tensor, "K T C"]:
    """Least-squares weights per kind, drawn towards those of all voxels where a kind has few.

    Args:
        blur: Standard deviation of the paint at generation from the true paint; it shrinks the weights of
            paint.

    Raises:
        ValueError: If there are no voxels.
    """
    squares = products = None
    for attributes, latents in voxels:
        kinds, terms, wanted = find_kinds(attributes), list_terms(attributes).double(), latents.double()
        if squares is None or products is None:
            squares = torch.zeros(KINDS, TERMS, TERMS, dtype=torch.float64)
            products = torch.zeros(KINDS, TERMS, wanted.shape[1], dtype=torch.float64)
        for kind in kinds.unique():
            own = kinds == kind
            squares[kind] += terms[own].T @ terms[own]
            products[kind] += terms[own].T @ wanted[own]
    if squares is None or products is None:
        raise ValueError("fitting the linear prior: no voxels, expected some")
    uncertain = blur**2 * torch.eye(TERMS, dtype=torch.float64)
    uncertain[0] = uncertain[-AROUND - PLACES :] = 0.0
    squares = squares + squares[:, :1, :1] * uncertain
    whole = torch.linalg.solve(squares.sum(dim=0) + torch.eye(TERMS), products.sum(dim=0))
    apart = torch.linalg.solve(squares + FEW * torch.eye(TERMS), products - squares @ whole)
    return (whole + apart).float()
