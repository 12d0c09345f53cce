"""Reconstruction of articulated voxel fields: the rows of the paper's Tables 3 and 4, and then some.

Cells that are occupied in the truth and in the reconstruction are compared; occupancy is measured on all.
"""

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor

from artigen.fields import FieldLayout
from artigen.models.structure_vae import StructureVae
from artigen.train.batches import patch_batch
from artigen.train.examples import StructureExample


@torch.no_grad()
def score_reconstruction(
    vae: StructureVae, examples: Sequence[StructureExample], *, batch: int = 16
) -> dict[str, float]:
    """Encodes (posterior mean) and decodes examples; shares in [0, 1], degrees, unit lengths.

    ``occupancy_recall`` is the share of occupied cells found, ``label`` and ``joint_type`` the share of
    common cells with the right class (``small_label``: those of handles and knobs), ``axis`` the mean angle
    on cells of moving parts, ``origin`` the mean distance of the stated origins on turning ones,
    ``rotation`` and ``travel`` the mean errors of the ranges, ``box`` that of a component of the box.
    """
    device = next(vae.parameters()).device
    sums: dict[str, list[float]] = {}
    for start in range(0, len(examples), batch):
        patches = patch_batch(examples[start : start + batch]).to(device)
        logits, values, _ = vae.decode(vae.encode(patches)[0], patches.index)
        occupancy = patches.occupancy().flatten(0, 1) > 0
        found = logits > 0
        _count(sums, "occupancy_recall", found[occupancy])
        _count(sums, "occupancy_precision", occupancy[found])
        _count(sums, "occupancy_iou", occupancy[found | occupancy] & found[found | occupancy])
        common = patches.occupied() & found[patches.index]
        _compare(sums, values[common], patches.attributes()[common], vae.layout)
    return {name: total / max(count, 1) for name, (total, count) in sums.items()}


def _compare(sums: dict[str, list[float]], said: Tensor, truth: Tensor, layout: FieldLayout) -> None:
    def at(channels: slice) -> tuple[Tensor, Tensor]:
        chosen = slice(channels.start - 1, channels.stop - 1)
        return said[:, chosen], truth[:, chosen]

    label, right = (values.argmax(dim=1) for values in at(layout.label))
    _count(sums, "label", label == right)
    small = torch.isin(
        right, torch.tensor([layout.labels.index("handle"), layout.labels.index("knob")]).to(right)
    )
    _count(sums, "small_label", (label == right)[small])
    joint, kind = (values.argmax(dim=1) for values in at(layout.joint_type))
    _count(sums, "joint_type", joint == kind)
    moving = kind != layout.joint_types.index("fixed")
    _count(sums, "moving_joint_type", (joint == kind)[moving])
    axis, true_axis = at(layout.axis)
    cosine = torch.nn.functional.cosine_similarity(axis, true_axis, dim=1)[moving].clamp(-1.0, 1.0)
    _count(sums, "axis", torch.rad2deg(torch.arccos(cosine)))
    turning = moving & (kind != layout.joint_types.index("prismatic"))
    origin, true_origin = at(layout.origin)
    _count(sums, "origin", (origin - true_origin).norm(dim=1)[turning])
    ranges, true_ranges = at(layout.range)
    error = (ranges - true_ranges).abs()
    _count(sums, "rotation", np.degrees(layout.rotation_unit) * error[turning, 0])
    _count(sums, "travel", layout.length_unit * error[kind == layout.joint_types.index("prismatic"), 1])
    box, true_box = at(layout.box)
    _count(sums, "box", (box - true_box).abs().flatten())


def _count(sums: dict[str, list[float]], name: str, values: Tensor) -> None:
    total = sums.setdefault(name, [0.0, 0.0])
    total[0] += float(values.float().sum())
    total[1] += values.numel()
