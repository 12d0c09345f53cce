"""Losses of the reader's network."""

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional

from artigen.reader.labels import FRONT, OBJECT, THINGS
from artigen.reader.network import Maps
from artigen.reader.targets import CORE, ReaderBatch

HEAT = (1.0, 0.5, 0.3, 0.2, 0.1, 0.3)
"""Weights of the maps of peaks, by thing."""
BOX = (1.0, 0.5, 0.3, 0.2, 0.1, 1.0)
"""Weights of boxes, by thing."""
NEAR = 4.0
"""Power that spares the slopes of peaks."""
LARGEST = 7.0
"""Largest logarithm of a distance (pixels)."""
WEIGHTS = {
    "door": 1.0, "hinge": 1.5, "open": 0.3, "pane": 0.2, "material": 0.1, "kind": 0.4, "stand": 0.1,
    "corners": 2.0, "view": 0.5, "size": 0.3,
}  # fmt: skip


def reader_losses(network: nn.Module, batch: ReaderBatch, generator: torch.Generator) -> dict[str, Tensor]:
    """Named, weighted terms of the loss of a batch."""
    maps: Maps = network(batch.pixels)
    picture, thing, row, column = batch.place.unbind(1)

    def at_cells(name: str) -> Float[Tensor, "N C"]:
        return maps.attributes[name][picture, :, row, column]

    weights = torch.tensor(HEAT, device=batch.heat.device)
    terms = {"heat": (weights * _focal(maps.heat, batch.heat, batch.weight)).sum()}
    distances = at_cells("box").unflatten(1, (len(THINGS), 4))
    distances = distances.gather(1, thing[:, None, None].expand(-1, 1, 4))[:, 0]
    terms["box"] = _box_loss(distances, batch.box, thing)
    front, whole = thing == FRONT, thing == OBJECT
    for name in ("door", "open", "pane"):
        terms[name] = WEIGHTS[name] * _binary(at_cells(name)[:, 0], getattr(batch, name), front)
    for name, group in (("hinge", front), ("material", front), ("kind", whole), ("stand", whole)):
        terms[name] = WEIGHTS[name] * _choice(at_cells(name), getattr(batch, name), group)
    for name, group in (("corners", front), ("view", whole), ("size", whole)):
        terms[name] = WEIGHTS[name] * _distance(at_cells(name), getattr(batch, name), group)
    return terms


def _focal(
    logits: Float[Tensor, "B T h w"], heat: Float[Tensor, "B T h w"], weight: Float[Tensor, "B T h w"]
) -> Float[Tensor, "T"]:
    """Focal loss of peaks per peak (CornerNet, Law and Deng, 2018)."""
    peak = heat == 1
    p = logits.sigmoid()
    found = -((1 - p) ** 2) * functional.logsigmoid(logits)
    spared = (
        -((1 - heat) ** NEAR) * p**2 * functional.logsigmoid(-logits) * torch.where(heat > CORE, 1.0, weight)
    )
    return torch.where(peak, found, spared).sum((0, 2, 3)) / peak.sum((0, 2, 3)).clamp(min=1)


def _box_loss(said: Float[Tensor, "N 4"], true: Float[Tensor, "N 4"], thing: Int[Tensor, "N"]) -> Tensor:
    """Error of logarithms, and what is missing of the generalised overlap, averaged per thing."""
    known = torch.isfinite(true).all(dim=1)
    said, true, thing = said[known].clamp(-1.0, LARGEST), true[known].clamp(min=0.5), thing[known]
    logarithm = (said - true.log()).abs().mean(dim=1)
    terms = logarithm + _missing_overlap(said.exp(), true)
    total = said.sum() * 0.0
    for index, weight in enumerate(BOX):
        chosen = thing == index
        total = total + weight * (terms * chosen).sum() / chosen.sum().clamp(min=1)
    return total


def _missing_overlap(said: Float[Tensor, "N 4"], true: Float[Tensor, "N 4"]) -> Float[Tensor, "N"]:
    """One minus the generalised overlap (Rezatofighi et al., 2019) of boxes around one point."""
    inner, outer = torch.minimum(said, true), torch.maximum(said, true)

    def area(d: Tensor) -> Tensor:
        return (d[:, 0] + d[:, 2]) * (d[:, 1] + d[:, 3])

    shared, hull = area(inner), area(outer)
    union = area(said) + area(true) - shared
    return 1.0 - shared / union + (hull - union) / hull


def _binary(logit: Float[Tensor, "N"], true: Int[Tensor, "N"], group: Tensor) -> Tensor:
    known = group & (true >= 0)
    if not bool(known.any()):
        return logit.sum() * 0.0
    return functional.binary_cross_entropy_with_logits(logit[known], true[known].float())


def _choice(logits: Float[Tensor, "N C"], true: Int[Tensor, "N"], group: Tensor) -> Tensor:
    known = group & (true >= 0)
    if not bool(known.any()):
        return logits.sum() * 0.0
    return functional.cross_entropy(logits[known], true[known])


def _distance(said: Float[Tensor, "N C"], true: Float[Tensor, "N C"], group: Tensor) -> Tensor:
    known = group & torch.isfinite(true).all(dim=1)
    if not bool(known.any()):
        return said.sum() * 0.0
    return functional.smooth_l1_loss(said[known], true[known], beta=0.1)
