"""Smooths occupancy logits along the three axes.

Furniture is made of panels and bars. A hole in a panel has occupied neighbours in line along two axes, a
ragged rim along its edge, a bar along itself; a spurious cell has them along none. The decoder is not run
again: its logits are combined with their means along the three axes.
"""

import torch
from jaxtyping import Bool, Float
from torch import Tensor
from torch.nn import functional

from artigen.latent.outline import OutlineBatch, touched_cells
from artigen.types import PART_LABELS, PartLabel
from artigen.voxels.fields import ROW

REACH = 4
"""Cells to each side along an axis over which means are taken."""
CERTAIN = 4.0
"""Logits are clipped to this magnitude."""
SECOND = 1.5
"""Weight of the second highest of the three means; it closes holes and rims."""
DOUBT = 1.0
"""The second highest mean is clipped from below at minus this, so that the ends of bars survive."""
HIGHEST = 1.0
"""Weight of the highest mean where it is positive; it keeps bars."""
PASSES = 2
"""Number of passes."""
EXEMPT: tuple[PartLabel, ...] = ("handle", "knob")
"""Labels of parts too small to be smoothed."""


def steady_occupancy(logits: Float[Tensor, "B X Y Z"], outlines: OutlineBatch) -> Float[Tensor, "B X Y Z"]:
    """Occupancy logits combined with their means along x, y and z.

    Args:
        logits: Logits of the cells of the unit cube.
        outlines: Parts of each object; cells in the boxes of exempt ones keep their logits.
    """
    steadied = logits
    for _ in range(PASSES):
        bounded = steadied.clamp(-CERTAIN, CERTAIN)
        means = torch.stack([_line_means(bounded, axis, REACH) for axis in (1, 2, 3)])
        _, second, highest = means.sort(dim=0).values
        steadied = bounded + SECOND * second.clamp(min=-DOUBT) + HIGHEST * highest.clamp(min=0.0)
    return torch.where(_exempt(outlines, logits.shape[1]), logits, steadied)


def _line_means(x: Float[Tensor, "B X Y Z"], axis: int, reach: int) -> Float[Tensor, "B X Y Z"]:
    """Means over ``2 reach + 1`` cells along an axis; border cells are replicated beyond the cube."""
    lines = x.movedim(axis, -1)
    padded = functional.pad(lines.flatten(0, 2)[:, None], (reach, reach), mode="replicate")
    return functional.avg_pool1d(padded, 2 * reach + 1, stride=1).reshape(lines.shape).movedim(-1, axis)


def _exempt(outlines: OutlineBatch, edge: int) -> Bool[Tensor, "B X Y Z"]:
    """Cells in the box of a part of an exempt label."""
    labels = outlines.rows[..., ROW.label].argmax(dim=-1)
    exempt = torch.tensor([PART_LABELS.index(name) for name in EXEMPT], device=labels.device)
    return (touched_cells(outlines, edge) & torch.isin(labels, exempt)[..., None, None, None]).any(dim=1)
