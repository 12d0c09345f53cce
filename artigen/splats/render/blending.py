"""Blends footprints front to back, tile by tile; the backward pass repeats the traversal.

Along a pixel's list ``w_i = alpha_i (1 - alpha_1) ... (1 - alpha_{i-1})`` and the picture is the sum of
``w_i f_i``. With ``g`` the gradient at the pixel,

    dL/dalpha_i = w_i / alpha_i (f_i . g) - sum_{j > i} w_j (f_j . g) / (1 - alpha_i),

which needs the sum over the splats behind: the total, known from the picture, less the sum so far. Only the
picture is kept for the gradients, so memory does not grow with the lengths of the lists.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.splats.render.config import RasterConfig
from artigen.splats.render.tiles import Grid, TileLists, find_boxes, iterate_lists

STRIDE = 32
"""List entries per tile in a round while all of its tiles are active."""
NOWHERE = -1e4
"""Logarithm of the opacity of the filler splat that pads short lists."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Round:
    """The next list entries of some tiles."""

    tiles: Int[Tensor, "A"]
    entries: Int[Tensor, "A K"]
    offsets: Float[Tensor, "A K 2"]
    """From the splat to the middle of the tile (pixels)."""
    alpha: Float[Tensor, "A K P"]
    before: Float[Tensor, "A K P"]
    """Transmittance before each entry."""
    weights: Float[Tensor, "A K P"]


def blend(
    ellipses: Float[Tensor, "V 6"],
    features: Float[Tensor, "V F"],
    reach: Float[Tensor, "V 2"],
    grid: Grid,
    cfg: RasterConfig,
) -> Float[Tensor, "H W F"]:
    """Sums of features, weighted by the visibility of each splat.

    Args:
        ellipses: As in `Footprints`, nearest first.
        reach: As in `Footprints`.
    """
    image = _Blend.apply(ellipses, features, reach, grid, cfg)
    assert isinstance(image, Tensor)
    return _picture_of(image, grid)


class _Blend(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx, ellipses: Tensor, features: Tensor, reach: Tensor, grid: Grid, cfg: RasterConfig
    ) -> Tensor:
        table, features = _with_filler(ellipses, features)
        image = features.new_zeros(grid.rows * grid.columns, grid.tile**2, features.shape[1])
        for part in _rounds(table, reach, grid, cfg):
            seen = features[part.entries].transpose(1, 2) @ part.weights  # A F P
            image.index_add_(0, part.tiles, seen.transpose(1, 2))
        ctx.save_for_backward(table, features, reach, image)
        ctx.grid, ctx.cfg = grid, cfg
        return image

    @staticmethod
    def backward(ctx, *grads: Tensor) -> tuple[Tensor, Tensor, None, None, None]:
        with torch.autocast(grads[0].device.type, enabled=False):
            to_table, to_features = _gradients(ctx.saved_tensors, grads[0], ctx.grid, ctx.cfg)
        return to_table[:-1], to_features[:-1], None, None, None


def _gradients(
    kept: tuple[Tensor, Tensor, Tensor, Tensor], grad: Float[Tensor, "T P F"], grid: Grid, cfg: RasterConfig
) -> tuple[Tensor, Tensor]:
    """Gradients with respect to both tables from that of the picture."""
    table, features, reach, image = kept
    basis = _basis(grid, table)
    to_table, to_features = torch.zeros_like(table), torch.zeros_like(features)
    behind = (image * grad).sum(2)  # tiles P
    for part in _rounds(table, reach, grid, cfg):
        here = grad.index_select(0, part.tiles)  # A P F
        entries = part.entries.flatten()
        to_features.index_add_(0, entries, (part.weights @ here).flatten(0, 1))
        worth = features[part.entries] @ here.transpose(1, 2)  # A K P
        hidden = (part.weights * worth).cumsum_(1)
        left = behind.index_select(0, part.tiles)
        behind.index_copy_(0, part.tiles, left - hidden[:, -1])
        slope = hidden.sub_(left[:, None]).div_(1.0 - part.alpha)
        slope = slope.addcmul_(part.before, worth).mul_(part.alpha)
        slope.masked_fill_(part.alpha >= cfg.max_alpha, 0.0)
        terms = slope.flatten(0, 1) @ basis.T
        to_table.index_add_(0, entries, _chain(table[entries], part.offsets.flatten(0, 1), terms))
    return to_table, to_features


def _rounds(table: Tensor, reach: Tensor, grid: Grid, cfg: RasterConfig) -> Iterator[_Round]:
    """Walks all lists from the front, some tiles at a time, until each list or its light is exhausted."""
    first, last = find_boxes(table[:-1, :2], reach, grid)
    basis = _basis(grid, table)
    together = max(1, cfg.fragments // (STRIDE * grid.tile**2))
    for lists in iterate_lists(first, last, grid, cfg.pairs):
        for start in range(0, len(lists.tiles), together):
            yield from _walk(table, lists, slice(start, start + together), basis, grid, cfg)


def _walk(
    table: Tensor, lists: TileLists, which: slice, basis: Tensor, grid: Grid, cfg: RasterConfig
) -> Iterator[_Round]:
    tiles, starts, counts = lists.tiles[which], lists.starts[which], lists.counts[which]
    left = table.new_ones(len(tiles), grid.tile**2)
    at, longest = 0, int(counts[0])
    while len(tiles):
        stride = min(longest - at, max(1, cfg.fragments // left.numel()))
        place = torch.arange(at, at + stride, device=table.device)
        entries = (starts[:, None] + place).clamp_(max=len(lists.splats) - 1)
        entries = torch.where(place < counts[:, None], lists.splats[entries], len(table) - 1)
        offsets = _middles(tiles, grid, table)[:, None] - table[entries, :2]
        alpha = torch.mm(_terms(table[entries], offsets).flatten(0, 1), basis).exp_()
        alpha = torch.threshold_(alpha.clamp_(max=cfg.max_alpha), cfg.min_alpha, 0.0)
        alpha = alpha.view(len(tiles), stride, -1)
        light = torch.cat([left[:, None], 1.0 - alpha], dim=1).cumprod(1)
        before, left = light[:, :-1], light[:, -1]
        yield _Round(
            tiles=tiles, entries=entries, offsets=offsets,
            alpha=alpha, before=before, weights=alpha * before,
        )  # fmt: skip
        at += stride
        on = ((counts > at) & (left.amax(1) > cfg.min_transmittance)).nonzero()[:, 0]
        tiles, starts, counts, left = (value.index_select(0, on) for value in (tiles, starts, counts, left))
        longest = int(counts[0]) if len(counts) else at


def _with_filler(ellipses: Tensor, features: Tensor) -> tuple[Tensor, Tensor]:
    """Both tables with an invisible filler splat appended."""
    filler = ellipses.new_tensor([[0.0, 0.0, 0.0, 0.0, 0.0, NOWHERE]])
    return torch.cat([ellipses, filler]), torch.cat([features, torch.zeros_like(features[:1])])


def _basis(grid: Grid, like: Tensor) -> Float[Tensor, "6 P"]:
    """1, x, y, x^2, x y, y^2 of the pixels of a tile, measured from its middle."""
    steps = torch.arange(grid.tile, dtype=like.dtype, device=like.device) - (grid.tile - 1) / 2.0
    y, x = torch.meshgrid(steps, steps, indexing="ij")
    return torch.stack([torch.ones_like(x), x, y, x * x, x * y, y * y]).flatten(1)


def _middles(tiles: Tensor, grid: Grid, like: Tensor) -> Float[Tensor, "A 2"]:
    column, row = tiles % grid.columns, torch.div(tiles, grid.columns, rounding_mode="floor")
    return (torch.stack([column, row], dim=1).to(like.dtype) + 0.5) * grid.tile


def _terms(ellipses: Tensor, offsets: Tensor) -> Float[Tensor, "A K 6"]:
    """Coefficients of log alpha in the basis of the tile."""
    (x, y), (a, b, c, height) = offsets.unbind(2), ellipses[:, :, 2:].unbind(2)
    along_x, along_y = a * x + b * y, b * x + c * y
    constant = height - 0.5 * (along_x * x + along_y * y)
    return torch.stack([constant, -along_x, -along_y, -0.5 * a, -b, -0.5 * c], dim=2)


def _chain(ellipses: Tensor, offsets: Tensor, terms: Tensor) -> Float[Tensor, "L 6"]:
    """Gradients with respect to the ellipses from those of their `_terms`."""
    (x, y), (a, b, c) = offsets.unbind(1), ellipses[:, 2:5].unbind(1)
    one, to_x, to_y, to_xx, to_xy, to_yy = terms.unbind(1)
    return torch.stack(
        [
            (a * x + b * y) * one + a * to_x + b * to_y,
            (b * x + c * y) * one + b * to_x + c * to_y,
            -0.5 * x * x * one - x * to_x - 0.5 * to_xx,
            -x * y * one - y * to_x - x * to_y - to_xy,
            -0.5 * y * y * one - y * to_y - 0.5 * to_yy,
            one,
        ],
        dim=1,
    )


def _picture_of(image: Float[Tensor, "T P F"], grid: Grid) -> Float[Tensor, "H W F"]:
    tiles = image.view(grid.rows, grid.columns, grid.tile, grid.tile, -1)
    whole = tiles.transpose(1, 2).reshape(grid.rows * grid.tile, grid.columns * grid.tile, -1)
    return whole[: grid.height, : grid.width]
