"""Outlines: one row per part with label, joint, axis, origin, range and box, and the hints derived from them.

An outline holds what a voxel field states about its parts, without their shapes. The latent flow and the
decoder take the outline of the object that they draw (`artigen.voxels.fields.tabulate_parts`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor
from torch.nn import functional

from artigen.models.batch import TensorBatch
from artigen.voxels.fields import ROW

BLUR = 0.25 / 64
"""Standard deviation of the noise on boxes in training, in unit-cube lengths."""
FACES = 6
"""Numbers in a hint that are distances to the faces of a box."""
DEPTH = 4
"""Number of candidate parts per cell: the smallest that reach into it."""
HINT_CHANNELS = DEPTH * (ROW.box.stop + FACES + 1)
"""Channels of a hint (`draw_hint`)."""
MARGIN = 0.5 / 64
"""Unit-cube lengths that a part may reach beyond its box, because boxes are slightly inexact."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidates:
    """The parts that the cells of a grid may belong to: rows of the outlines, smallest box first."""

    chosen: Int[Tensor, "B D V"]
    """Row of each candidate; 0 where there is none."""
    found: Bool[Tensor, "B D V"]
    """Whether the candidate exists."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OutlineBatch(TensorBatch):
    """Outlines side by side: the channels after occupancy, a row per part; rows not ``given`` are padding."""

    rows: Float[Tensor, "B N C"]
    given: Bool[Tensor, "B N"]


def sort_rows(table: Float[np.ndarray, "N C"]) -> Float[np.ndarray, "N C"]:
    """Rows in reading order: by label, then from top to bottom, left to right, front to back."""
    label = table[:, ROW.label].argmax(axis=1)
    box = table[:, ROW.box]
    center = np.round(box[:, :3] * 32)  # rounded to half a cell, so that nearly level parts compare as level
    return table[np.lexsort((center[:, 0], -center[:, 1], -center[:, 2], label))]


def gather_outlines(tables: Sequence[Float[np.ndarray, "N C"]]) -> OutlineBatch:
    """Outlines of several objects, rows in reading order, padded to the longest."""
    longest = max(len(table) for table in tables)
    rows = np.zeros((len(tables), longest, tables[0].shape[1]), dtype=np.float32)
    given = np.zeros((len(tables), longest), dtype=bool)
    for number, table in enumerate(tables):
        rows[number, : len(table)] = sort_rows(table)
        given[number, : len(table)] = True
    return OutlineBatch(rows=torch.from_numpy(rows), given=torch.from_numpy(given))


def blur_outlines(outlines: OutlineBatch, share: float, generator: torch.Generator) -> OutlineBatch:
    """Outlines with noise on their boxes; a ``share`` of them, chosen at random, is emptied.

    A network that is trained with exact boxes alone relies on their last digit.
    """
    rows = outlines.rows.clone()
    noise = torch.randn(rows[..., ROW.box].shape, generator=generator, device=generator.device)
    rows[..., ROW.box] += BLUR * noise
    kept = torch.rand(len(rows), generator=generator, device=generator.device) >= share
    return OutlineBatch(rows=rows, given=outlines.given & kept[:, None])


def find_candidates(outlines: OutlineBatch, edge: int) -> Candidates:
    """The `DEPTH` smallest parts that reach into each cell of a grid of ``edge`` over the unit cube."""
    low, high = _faces(outlines)
    inside = touched_cells(outlines, edge).flatten(2)
    volume = (high - low).clamp(min=1e-4).prod(dim=-1)
    rank = torch.where(inside, volume[..., None], torch.inf)
    rank = functional.pad(rank, (0, 0, 0, max(DEPTH - rank.shape[1], 0)), value=torch.inf)
    size, chosen = rank.topk(DEPTH, dim=1, largest=False)
    return Candidates(chosen=torch.where(size.isfinite(), chosen, 0), found=size.isfinite())


def touched_cells(outlines: OutlineBatch, edge: int) -> Bool[Tensor, "B N X Y Z"]:
    """The cells of a grid of ``edge`` over the unit cube that each part's box, grown by `MARGIN`, reaches."""
    low, high = _faces(outlines)
    line, half = _cell_line(edge, outlines.rows.device), 0.5 / edge + MARGIN
    near = [(low[..., axis, None] < line + half) & (high[..., axis, None] > line - half) for axis in range(3)]
    inside = near[0][..., :, None, None] & near[1][..., None, :, None] & near[2][..., None, None, :]
    return inside & outlines.given[..., None, None, None]


def reach_cells(
    outlines: OutlineBatch, candidates: Candidates, edge: int, patch: int
) -> tuple[Float[Tensor, "N D C"], Bool[Tensor, "N K D"]]:
    """Rows of the candidates of every cell of a grid, and which of its finer cells reach their boxes.

    Boxes are grown by half of `MARGIN`.

    Args:
        candidates: Candidates of the cells of the grid.
        edge: Cells of the grid along an edge.
        patch: Finer cells in one of them, along an edge.
    """
    batch = torch.arange(len(outlines.rows), device=outlines.rows.device)[:, None, None]
    rows = outlines.rows[batch, candidates.chosen]  # B D cells C
    low, high = (face[batch, candidates.chosen] for face in _faces(outlines))
    fine, half = _cell_line(edge * patch, rows.device).reshape(edge, patch), 0.5 / (edge * patch) + MARGIN / 2
    inside = candidates.found[..., None, None, None]
    places = torch.stack(torch.meshgrid(*[torch.arange(edge, device=rows.device)] * 3, indexing="ij"), dim=-1)
    for axis, place in enumerate(places.reshape(-1, 3).T):
        line = fine[place]  # cells patch
        near = (low[..., axis, None] < line + half) & (high[..., axis, None] > line - half)
        shape = [1, 1, 1]
        shape[axis] = patch
        inside = inside & near.reshape(*near.shape[:3], *shape)
    return rows.movedim(1, 2).flatten(0, 1), inside.flatten(3).movedim(1, 3).flatten(0, 1)


def draw_hint(outlines: OutlineBatch, candidates: Candidates, edge: int) -> Float[Tensor, "B H X Y Z"]:
    """Hints for the cells of a grid: the parts that they may belong to, in order.

    Each part is described by its attributes (positions relative to the cell), the distances from the cell's
    centre to the six faces of its box in cells, clipped to [-2, 2], and a one. All are zero where there is no
    such part.
    """
    line = _cell_line(edge, outlines.rows.device)
    center = torch.stack(torch.meshgrid(line, line, line, indexing="ij"), dim=-1).reshape(-1, 3)
    batch = torch.arange(len(outlines.rows), device=line.device)[:, None, None]
    attributes = outlines.rows[batch, candidates.chosen][..., : ROW.box.stop].clone()
    attributes[..., ROW.origin] -= center
    attributes[..., ROW.box][..., :3] -= center
    low, high = (face[batch, candidates.chosen] for face in _faces(outlines))
    faces = torch.cat([center - low, high - center], dim=-1)
    hint = torch.cat([attributes, (faces * edge).clamp(-2.0, 2.0), torch.ones_like(faces[..., :1])], dim=-1)
    hint = hint * candidates.found[..., None]
    return hint.permute(0, 1, 3, 2).reshape(len(hint), -1, edge, edge, edge)


def _faces(outlines: OutlineBatch) -> tuple[Float[Tensor, "B N 3"], ...]:
    """Lowest and highest corners of the boxes."""
    box = outlines.rows[..., ROW.box]
    return box[..., :3] - box[..., 3:] / 2, box[..., :3] + box[..., 3:] / 2


def _cell_line(edge: int, device: torch.device) -> Float[Tensor, "E"]:
    """Centres of cells along an edge."""
    return (torch.arange(edge, device=device) + 0.5) / edge - 0.5
