"""Smooths occupancy logits along the three axes.

Furniture is made of panels and bars. A hole in a panel has neighbours in line along two axes, the ragged
rim of one has them along its edge, a bar along itself; what is drawn wrongly has them nowhere. The decoder
is not asked again: its logits are weighed against their means along the three axes.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float
from torch import Tensor
from torch.nn import functional

from artigen.latent.outline import OutlineBatch, part_labels, touched_cells
from artigen.types import PART_LABELS, PartLabel


@dataclass(frozen=True, kw_only=True)
class SteadyConfig:
    """How much cells listen to those in line with them."""

    reach: int = 4
    """Cells to each side along an axis."""
    certain: float = 4.0
    """Logits beyond this count as this."""
    second: float = 1.5
    """Weight of the second highest of the three means: holes and rims."""
    doubt: float = 1.0
    """The second highest mean counts as no lower than minus this: bars have ends."""
    highest: float = 1.0
    """Weight of the highest where it says occupied: bars."""
    passes: int = 2
    """How often."""
    exempt: tuple[PartLabel, ...] = ("handle", "knob")
    """Labels of parts too small to have lines."""


def steady_occupancy(
    logits: Float[Tensor, "B X Y Z"], outlines: OutlineBatch, cfg: SteadyConfig | None = None
) -> Float[Tensor, "B X Y Z"]:
    """Logits of occupancy, weighed against their means along x, y and z.

    Args:
        logits: of the cells of the unit cube.
        outlines: the parts of each object; cells in the boxes of exempt ones keep their logits.
        cfg: weights.
    """
    cfg = cfg or SteadyConfig()
    steadied = logits
    for _ in range(cfg.passes):
        bounded = steadied.clamp(-cfg.certain, cfg.certain)
        means = torch.stack([_line_means(bounded, axis, cfg.reach) for axis in (1, 2, 3)])
        _, second, highest = means.sort(dim=0).values
        steadied = bounded + cfg.second * second.clamp(min=-cfg.doubt) + cfg.highest * highest.clamp(min=0.0)
    return torch.where(_exempt(outlines, logits.shape[1], cfg), logits, steadied)


def _line_means(x: Float[Tensor, "B X Y Z"], axis: int, reach: int) -> Float[Tensor, "B X Y Z"]:
    """Means over ``2 reach + 1`` cells along an axis; the cube goes on as it ends."""
    lines = x.movedim(axis, -1)
    padded = functional.pad(lines.flatten(0, 2)[:, None], (reach, reach), mode="replicate")
    return functional.avg_pool1d(padded, 2 * reach + 1, stride=1).reshape(lines.shape).movedim(-1, axis)


def _exempt(outlines: OutlineBatch, edge: int, cfg: SteadyConfig) -> Bool[Tensor, "B X Y Z"]:
    """Cells in the box of a part of an exempt label."""
    labels = part_labels(outlines.rows)
    exempt = torch.tensor([PART_LABELS.index(name) for name in cfg.exempt], device=labels.device)
    return (touched_cells(outlines, edge) & torch.isin(labels, exempt)[..., None, None, None]).any(dim=1)
