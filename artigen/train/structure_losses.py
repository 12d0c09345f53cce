"""Losses of the structure VAE: the paper's terms (section 4.1), reweighted for small parts.

The paper: Dice on occupancy, cross-entropies, squared errors, all with weight 1, KL 0.001. Dice alone
converges to a solution one cell too thick, squared errors in the unit cube are small beside cross-entropies,
and handles and knobs are one cell in fifty. Therefore ``compact`` adds a binary cross-entropy, weights
regressions by ten and small parts by up to eight. docs/reports/structure.md has the ablation.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional

from artigen.latent.patches import PatchBatch
from artigen.types import JOINT_TYPES, PART_LABELS, JointType, PartLabel
from artigen.voxels.fields import ROW

LABEL_WEIGHTS: dict[PartLabel, float] = {
    "base": 1.0,
    "drawer": 2.0,
    "door": 2.0,
    "handle": 8.0,
    "knob": 8.0,
    "tray": 3.0,
    "shelf": 2.0,
    "wheel": 6.0,
}
JOINT_WEIGHTS: dict[JointType, float] = {
    "fixed": 1.0,
    "revolute": 2.0,
    "prismatic": 2.0,
    "continuous": 6.0,
    "screw": 6.0,
}
REGRESSION_CAP = 3.0
"""Largest weight of a small part in the regressions."""


@dataclass(frozen=True, kw_only=True)
class StructureLossConfig:
    """Weights of the terms; the defaults are those of ``compact``."""

    kl: float = 1e-3
    """KL to the unit Gaussian, as a mean over elements."""
    dice: float = 1.0
    """Soft Dice on occupancy."""
    cross_entropy: float = 1.0
    """Binary cross-entropy on occupancy; the paper has none."""
    classes: float = 1.0
    """Cross-entropies of label, joint type and category."""
    regression: float = 10.0
    """Squared errors of axis, origin, range and box; 1 in the paper."""
    balanced: bool = True
    """Whether small parts weigh more; they do not in the paper."""


PAPER_LOSS = StructureLossConfig(cross_entropy=0.0, regression=1.0, balanced=False)


def structure_losses(
    logits: Float[Tensor, "N K"],
    attributes: Float[Tensor, "P K C"],
    patches: PatchBatch,
    cfg: StructureLossConfig,
) -> dict[str, Tensor]:
    """The reconstruction terms, each with its weight, by name.

    Args:
        attributes: Channels after occupancy of the cells of the occupied patches, classes as logits.
    """
    weights = _row_weights(patches, cfg)
    truth = patches.table[patches.rows[patches.occupied()]]
    predicted = attributes[patches.occupied()]
    cell_weight = weights[patches.rows[patches.occupied()]]
    dense_weight = torch.ones_like(logits)
    dense_weight[patches.index] = weights[patches.rows]
    occupancy = patches.occupancy().flatten(0, 1)
    out = {
        "dice": cfg.dice * dice_loss(logits.sigmoid(), occupancy, dense_weight),
        "cross_entropy": cfg.cross_entropy
        * _mean(
            functional.binary_cross_entropy_with_logits(logits, occupancy, reduction="none"), dense_weight
        ),
    }
    joint_weight = cell_weight
    if cfg.balanced:
        per_type = torch.tensor([JOINT_WEIGHTS[name] for name in JOINT_TYPES], device=logits.device)
        joint_weight = cell_weight.clamp(max=REGRESSION_CAP) * (truth[:, ROW.joint_type] @ per_type)
    for name, channels, weight in (
        ("label", ROW.label, cell_weight),
        ("joint_type", ROW.joint_type, joint_weight),
        ("category", ROW.category, torch.ones_like(cell_weight)),
    ):
        right = truth[:, channels]
        error = functional.cross_entropy(predicted[:, channels], right, reduction="none")
        out[name] = cfg.classes * _mean(error, weight)
    capped = cell_weight.clamp(max=REGRESSION_CAP)
    movable = 1.0 - truth[:, ROW.joint_type][:, JOINT_TYPES.index("fixed")]
    for name, channels, weight in (
        ("axis", ROW.axis, capped * movable),
        ("origin", ROW.origin, capped * movable),
        ("range", ROW.range, capped * movable),
        ("box", ROW.box, capped),
    ):
        off = predicted[:, channels] - truth[:, channels]
        error = (off**2).sum(dim=1)
        out[name] = cfg.regression * _mean(error, weight)
    return out


def dice_loss(
    probabilities: Float[Tensor, "N K"], occupancy: Float[Tensor, "N K"], weight: Float[Tensor, "N K"]
) -> Float[Tensor, ""]:
    """One minus the soft Dice coefficient over the whole batch, with +1 above and below (TRELLIS)."""
    common = (weight * probabilities * occupancy).sum()
    total = (weight * (probabilities + occupancy)).sum()
    return 1.0 - (2.0 * common + 1.0) / (total + 1.0)


def _row_weights(patches: PatchBatch, cfg: StructureLossConfig) -> Float[Tensor, "T"]:
    """Weight of a cell by the part that owns it; empty cells weigh 1."""
    weights = torch.ones(len(patches.table), device=patches.table.device)
    if cfg.balanced:
        per_label = torch.tensor([LABEL_WEIGHTS[name] for name in PART_LABELS], device=weights.device)
        weights[1:] = per_label[patches.labels()[1:]]
    return weights


def _mean(error: Tensor, weight: Tensor) -> Tensor:
    return (error * weight).sum() / weight.sum().clamp(min=1e-6)
