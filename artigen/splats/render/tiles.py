"""Depth-sorted lists of the splats of each tile."""

from collections.abc import Iterator
from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor


@dataclass(frozen=True, kw_only=True)
class Grid:
    """The tiles that cover a picture, row by row; the last ones may stand over."""

    width: int
    height: int
    tile: int

    @property
    def columns(self) -> int:
        """Number of tiles side by side."""
        return -(-self.width // self.tile)

    @property
    def rows(self) -> int:
        """Number of tiles on top of each other."""
        return -(-self.height // self.tile)


@dataclass(frozen=True, kw_only=True, eq=False)
class TileLists:
    """Splats of some tiles: those of tile ``k`` are ``splats[starts[k] : starts[k] + counts[k]]``."""

    tiles: Int[Tensor, "A"]
    starts: Int[Tensor, "A"]
    counts: Int[Tensor, "A"]
    splats: Int[Tensor, "M"]


def find_boxes(
    centers: Float[Tensor, "V 2"], reach: Float[Tensor, "V 2"], grid: Grid
) -> tuple[Int[Tensor, "V 2"], Int[Tensor, "V 2"]]:
    """First and last tile (column, row) with a pixel whose middle is within ``reach``; empty boxes end early.

    A splat that reaches no pixel of the picture has a last tile before its first.
    """
    sizes = torch.tensor([grid.width, grid.height], device=centers.device)
    # Bounded as floats: what lies far outside would not fit an integer.
    first = torch.ceil(centers - reach - 0.5).clamp(min=0).minimum(sizes).int()
    last = torch.floor(centers + reach - 0.5).clamp(min=-1).minimum(sizes - 1).int()
    first_tile = torch.div(first, grid.tile, rounding_mode="floor")
    last_tile = torch.div(last, grid.tile, rounding_mode="floor")
    empty = (last < first).any(dim=1, keepdim=True)
    return first_tile, torch.where(empty, first_tile - 1, last_tile)


def iterate_lists(
    first: Int[Tensor, "V 2"], last: Int[Tensor, "V 2"], grid: Grid, most: int
) -> Iterator[TileLists]:
    """Lists of all tiles that have any, in bands of rows of tiles with at most ``most`` entries each.

    A single row of tiles may have more. Splats keep their order; the longest lists of a band come first.
    """
    for top, bottom in _split_rows(first, last, grid, most):
        lists = _list_band(first, last, grid, top, bottom)
        if len(lists.tiles):
            yield lists


def _split_rows(
    first: Int[Tensor, "V 2"], last: Int[Tensor, "V 2"], grid: Grid, most: int
) -> list[tuple[int, int]]:
    """First and last rows of the bands."""
    width = (last - first + 1)[:, 0].long()
    change = torch.zeros(grid.rows + 2, dtype=torch.int64, device=first.device)
    change.index_add_(0, first[:, 1].clamp(max=grid.rows).long(), width)
    change.index_add_(0, last[:, 1].long() + 1, -width)
    bands: list[tuple[int, int]] = []
    total = 0
    for row, entries in enumerate(change.cumsum(0)[: grid.rows].tolist()):
        total += entries
        if bands and total <= most:
            bands[-1] = (bands[-1][0], row)
        else:
            bands.append((row, row))
            total = entries
    return bands


def _list_band(
    first: Int[Tensor, "V 2"], last: Int[Tensor, "V 2"], grid: Grid, top: int, bottom: int
) -> TileLists:
    above = first[:, 1].clamp(min=top)
    width = last[:, 0] - first[:, 0] + 1
    entries = width * (last[:, 1].clamp(max=bottom) - above + 1).clamp(min=0)
    splats = torch.repeat_interleave(entries)
    before = (entries.cumsum(0) - entries).int()
    local = torch.arange(len(splats), dtype=torch.int32, device=first.device) - before.index_select(0, splats)
    across = width.index_select(0, splats)
    row = torch.div(local, across, rounding_mode="floor")
    column = local - row * across + first[:, 0].index_select(0, splats)
    tile = (row + above.index_select(0, splats) - top) * grid.columns + column
    count = (bottom - top + 1) * grid.columns
    # Small integers sort several times faster on CPUs.
    order = torch.sort(tile.short() if count <= 1 << 15 else tile, stable=True).indices
    counts = torch.bincount(tile, minlength=count)
    starts = counts.cumsum(0) - counts
    longest = torch.sort(counts, descending=True, stable=True).indices[: int((counts > 0).sum())]
    return TileLists(
        tiles=longest + top * grid.columns,
        starts=starts.index_select(0, longest),
        counts=counts.index_select(0, longest),
        splats=splats.index_select(0, order),
    )
