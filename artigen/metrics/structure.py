"""Reconstruction of articulated voxel fields: the rows of the paper's Tables 3 and 4, and further scores.

Attributes are compared on cells that are occupied in truth and reconstruction, occupancy on all cells.
"""

from collections.abc import Iterator, Sequence

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.examples.batches import outline_batch, patch_batch
from artigen.examples.structure import StructureExample
from artigen.latent.patches import PatchBatch
from artigen.latent.structure_vae import StructureVae
from artigen.types import FULL_TURN, JOINT_TYPES, PART_LABELS
from artigen.voxels.fields import ROW

BATCH = 16
"""Examples that are reconstructed at once."""


def score_reconstruction(vae: StructureVae, examples: Sequence[StructureExample]) -> dict[str, float]:
    """Encodes (posterior mean) and decodes examples; shares in [0, 1], degrees, unit lengths.

    ``occupancy_recall`` is the share of occupied cells found, ``label`` and ``joint_type`` the share of
    common cells with the right class (``small_label``: those of handles and knobs), ``axis`` the mean angle
    on cells of moving parts, ``origin`` the mean distance of the stated origins on rotating ones and ``line``
    that of the stated origin from the true axis line (along which it is arbitrary), ``rotation`` (degrees)
    and ``travel`` the mean errors of the ranges, ``box_center`` and ``box_size`` mean distances (Table 3),
    ``box`` the mean error of a component of the box.
    """
    sums: dict[str, list[float]] = {}
    for patches, logits, values in _reconstruct(vae, examples):
        occupancy = patches.occupancy().flatten(0, 1) > 0
        found = logits > 0
        _count(sums, "occupancy_recall", found[occupancy])
        _count(sums, "occupancy_precision", occupancy[found])
        _count(sums, "occupancy_iou", occupancy[found | occupancy] & found[found | occupancy])
        common = patches.occupied() & found[patches.index]
        _compare(sums, values[common], patches.attributes()[common])
    return {name: total / max(count, 1) for name, (total, count) in sums.items()}


def score_spread(vae: StructureVae, examples: Sequence[StructureExample]) -> dict[str, tuple[float, ...]]:
    """Standard deviations of attributes over the cells of a part, averaged over parts: the rows of Table 4.

    Over the cells that are occupied in truth and reconstruction: ``box_center`` and ``box_size`` of all
    parts, ``axis`` of moving ones, ``origin`` of rotating ones (x, y, z; unit lengths), ``rotation``
    (degrees) of rotating and ``travel`` (unit lengths) of sliding ones. A row that applies to no part is
    empty.
    """
    spreads, kinds = [], []
    for patches, logits, values in _reconstruct(vae, examples):
        common = patches.occupied() & (logits[patches.index] > 0)
        ids, spread = part_deviations(
            values[common].float().cpu().numpy(), patches.rows[common].cpu().numpy()
        )
        spreads.append(spread)
        kinds.append(patches.table[torch.from_numpy(ids).to(logits.device)][:, ROW.joint_type].argmax(1))
    spread, kind = np.concatenate(spreads), torch.cat(kinds).cpu().numpy()
    still, sliding = (JOINT_TYPES.index(name) for name in ("fixed", "prismatic"))
    everywhere, moving = np.ones(len(kind), dtype=bool), kind != still
    rotation, travel = (ROW.range.start + offset for offset in (0, 1))
    degrees = float(np.degrees(FULL_TURN))
    rows = {
        "box_center": (slice(ROW.box.start, ROW.box.start + 3), everywhere, 1.0),
        "box_size": (slice(ROW.box.start + 3, ROW.box.stop), everywhere, 1.0),
        "axis": (ROW.axis, moving, 1.0),
        "origin": (ROW.origin, moving & (kind != sliding), 1.0),
        "rotation": (slice(rotation, rotation + 1), moving & (kind != sliding), degrees),
        "travel": (slice(travel, travel + 1), kind == sliding, 1.0),
    }
    return {
        name: tuple((unit * spread[chosen][:, channels].mean(axis=0)).tolist()) if chosen.any() else ()
        for name, (channels, chosen, unit) in rows.items()
    }


def part_deviations(
    values: Float[np.ndarray, "N C"], part_ids: Int[np.ndarray, "N"]
) -> tuple[Int[np.ndarray, "P"], Float[np.ndarray, "P C"]]:
    """Population standard deviation of every channel over the cells of each part.

    Returns:
        The parts that own a cell, and their deviations; zero where all cells agree, or there is only one.
    """
    ids, at = np.unique(part_ids, return_inverse=True)
    counts = np.bincount(at)[:, None]

    def sums(columns: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(at, weights=column) for column in columns.T.astype(np.float64)], axis=1)

    means = sums(values) / counts
    return ids, np.sqrt(sums((values - means[at]) ** 2) / counts)


def _reconstruct(
    vae: StructureVae, examples: Sequence[StructureExample]
) -> Iterator[tuple[PatchBatch, Float[Tensor, "N K"], Float[Tensor, "P K C"]]]:
    """Examples in batches, with the logits of all cells and the channels of the occupied patches."""
    device = next(vae.parameters()).device
    for start in range(0, len(examples), BATCH):
        some = examples[start : start + BATCH]
        patches, outlines = patch_batch(some).to(device), outline_batch(some).to(device)
        with torch.no_grad():
            logits, values, _ = vae.decode(vae.encode(patches)[0], patches.index, outlines)
        yield patches, logits, values


def _compare(sums: dict[str, list[float]], found: Tensor, truth: Tensor) -> None:
    def at(channels: slice) -> tuple[Tensor, Tensor]:
        return found[:, channels], truth[:, channels]

    label, right = (values.argmax(dim=1) for values in at(ROW.label))
    _count(sums, "label", label == right)
    small = torch.isin(
        right, torch.tensor([PART_LABELS.index("handle"), PART_LABELS.index("knob")]).to(right)
    )
    _count(sums, "small_label", (label == right)[small])
    joint, kind = (values.argmax(dim=1) for values in at(ROW.joint_type))
    _count(sums, "joint_type", joint == kind)
    moving = kind != JOINT_TYPES.index("fixed")
    _count(sums, "moving_joint_type", (joint == kind)[moving])
    axis, true_axis = at(ROW.axis)
    cosine = torch.nn.functional.cosine_similarity(axis, true_axis, dim=1)[moving].clamp(-1.0, 1.0)
    _count(sums, "axis", torch.rad2deg(torch.arccos(cosine)))
    turning = moving & (kind != JOINT_TYPES.index("prismatic"))
    origin, true_origin = at(ROW.origin)
    offset = origin - true_origin
    _count(sums, "origin", offset.norm(dim=1)[turning])
    _count(sums, "line", torch.linalg.cross(offset, true_axis, dim=1).norm(dim=1)[turning])
    ranges, true_ranges = at(ROW.range)
    error = (ranges - true_ranges).abs()
    _count(sums, "rotation", np.degrees(FULL_TURN) * error[turning, 0])
    _count(sums, "travel", error[kind == JOINT_TYPES.index("prismatic"), 1])
    box, true_box = at(ROW.box)
    _count(sums, "box_center", (box - true_box)[:, :3].norm(dim=1))
    _count(sums, "box_size", (box - true_box)[:, 3:].norm(dim=1))
    _count(sums, "box", (box - true_box).abs().flatten())


def _count(sums: dict[str, list[float]], name: str, values: Tensor) -> None:
    total = sums.setdefault(name, [0.0, 0.0])
    total[0] += float(values.float().sum())
    total[1] += values.numel()
