"""The painter: which of its part's two colours each side of a voxel has, or which other, and how clear it is.

A mean over what a side may look like is mud, so each side chooses: one of the two colours of its part's
palette, or one that the painter says itself (the display of an oven, a worktop). A voxel is read by itself,
with what surrounds it (`artigen.surroundings`) and what a small transformer says about its part among the
others. So a step may take a few voxels of many objects instead of all of one. The paper has nothing of it:
its flow draws colours with all else (section 4.2).
"""

from dataclasses import dataclass, replace

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn

from artigen.facings import SIDES
from artigen.fields import DEFAULT_LAYOUT, after_occupancy, name_category, name_rows
from artigen.figures import find_edges, number_faces, settle_figures
from artigen.palettes import KIND, PALETTE, read_kinds
from artigen.surroundings import SURROUNDINGS, describe_surroundings
from artigen.types import PartLabel

CHOICES = 3
"""Colours that a side chooses from: two of the palette, and one that the painter says."""
TOLD = KIND + SURROUNDINGS
"""Numbers that say what voxel it is and where it lies."""
OWN_SPREAD, FREE_SPREAD = 0.04, 0.08
"""Deviations of sides from the palette's colours, and from those that the painter says."""
PANE = 0.02
"""Share of what is behind that a pane lets through, at least."""
GLAZED: tuple[PartLabel, ...] = ("door", "tray", "shelf")
"""Parts that may have panes: of 84 procedural objects no other part has one."""
CENTRED: tuple[PartLabel, ...] = ("door", "drawer")
"""Parts on whose faces figures lie in the middle (`artigen.figures`), as on all of a body but its front."""
FRONT, UP = 0, 5
"""Directions in which fronts and tops face."""
JOINED = "Table"
"""Category whose bodies are joined of many boards: but for their top, figures may be anywhere."""


@dataclass(frozen=True, kw_only=True)
class PainterConfig:
    """Sizes of the painter."""

    width: int = 96
    """Width of a part's token."""
    blocks: int = 2
    """Transformer blocks on the parts."""
    heads: int = 3
    """Attention heads."""
    hidden: int = 224
    """Width of a voxel."""
    layers: int = 3
    """Residual layers on the voxels."""
    rows: int = DEFAULT_LAYOUT.channels - 1
    """What is known of a part: the channels of a field after occupancy."""


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelBatch:
    """Some voxels of several objects, with the parts of these; parts not ``given`` are padding."""

    rows: Float[Tensor, "B P C"]
    palettes: Float[Tensor, "B P 7"]
    given: Bool[Tensor, "B P"]
    owners: Int[Tensor, "B K"]
    """Part of each voxel."""
    told: Float[Tensor, "B K T"]
    """What `describe_for_painter` says of each."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PaintGuess:
    """What the painter makes of voxels."""

    choices: Float[Tensor, "B K 2 3"]
    """Logits of the colours that a side chooses from."""
    free: Float[Tensor, "B K 2 3"]
    """The colour that the painter says."""
    pane: Float[Tensor, "B K"]
    """Logit of being clear."""
    clear: Float[Tensor, "B K"]
    """How clear, if so."""


class Painter(nn.Module):
    """Guesses the colours of the sides of voxels."""

    def __init__(self, cfg: PainterConfig) -> None:
        super().__init__()
        self.cfg = cfg
        self.parts = nn.Linear(cfg.rows + PALETTE, cfg.width)
        self.blocks = nn.ModuleList(
            nn.TransformerEncoderLayer(
                cfg.width, cfg.heads, 2 * cfg.width, dropout=0.0, batch_first=True, norm_first=True
            )
            for _ in range(cfg.blocks)
        )
        self.input_layer = nn.Linear(TOLD + PALETTE + cfg.width, cfg.hidden)
        self.layers = nn.ModuleList(
            nn.Sequential(
                nn.LayerNorm(cfg.hidden),
                nn.Linear(cfg.hidden, cfg.hidden),
                nn.GELU(),
                nn.Linear(cfg.hidden, cfg.hidden),
            )
            for _ in range(cfg.layers)
        )
        self.out_layer = nn.Linear(cfg.hidden, SIDES * (CHOICES + 3) + 2)

    def forward(self, batch: VoxelBatch) -> PaintGuess:
        """Guesses for every voxel of a batch."""
        h = self.parts(torch.cat([batch.rows, batch.palettes], dim=2))
        for block in self.blocks:
            h = block(h, src_key_padding_mask=~batch.given)
        own = torch.cat([batch.palettes, h.to(batch.palettes.dtype)], dim=2)
        owners = batch.owners[..., None].expand(-1, -1, own.shape[2])
        h = self.input_layer(torch.cat([batch.told, own.gather(1, owners)], dim=2))
        for layer in self.layers:
            h = h + layer(h)
        said = self.out_layer(h).float()
        sides, panes = said[..., :-2].unflatten(2, (SIDES, CHOICES + 3)), said[..., -2:]
        return PaintGuess(
            choices=sides[..., :CHOICES],
            free=torch.sigmoid(sides[..., CHOICES:]),
            pane=panes[..., 0],
            clear=torch.sigmoid(panes[..., 1]),
        )


def offer_colors(guess: PaintGuess, batch: VoxelBatch) -> Float[Tensor, "B K 2 3 3"]:
    """The colours that every side chooses from."""
    owners = batch.owners[..., None].expand(-1, -1, PALETTE)
    own = batch.palettes.gather(1, owners)[..., : PALETTE - 1].unflatten(2, (2, 3))
    return torch.cat([own[:, :, None].expand(-1, -1, SIDES, -1, -1), guess.free[..., None, :]], dim=3)


def paint_losses(
    guess: PaintGuess,
    offered: Float[Tensor, "B K 2 3 3"],
    colors: Float[Tensor, "B K 2 3"],
    known: Float[Tensor, "B K 2"],
    clear: Float[Tensor, "B K"],
) -> dict[str, Tensor]:
    """How unlikely the true sides are.

    Args:
        guess: of the painter.
        offered: what sides choose from (`offer_colors`), with the true palettes.
        colors: of the sides.
        known: weight of each side; 0 where it shows nothing.
        clear: share of what is behind that voxels let through.
    """
    spread = offered.new_tensor([OWN_SPREAD, OWN_SPREAD, FREE_SPREAD])
    away = ((offered - colors[..., None, :]) ** 2).sum(dim=-1)
    likely = -away / (2.0 * spread**2) - 3.0 * torch.log(spread / OWN_SPREAD)
    surprise = -torch.logsumexp(torch.log_softmax(guess.choices, dim=-1) + likely, dim=-1)
    pane = (clear > PANE).float()
    either = known.amax(dim=2)
    return {
        "colors": (known * surprise).sum() / known.sum().clamp(min=1e-6),
        "panes": (
            either * nn.functional.binary_cross_entropy_with_logits(guess.pane, pane, reduction="none")
        ).sum()
        / either.sum().clamp(min=1e-6),
        "clear": (pane * (guess.clear - clear) ** 2).sum() / pane.sum().clamp(min=1.0),
    }


def choose_colors(guess: PaintGuess, offered: Float[Tensor, "B K 2 3 3"]) -> Float[Tensor, "B K 7"]:
    """The likeliest colour of either side, and how clear voxels are."""
    chosen = guess.choices.argmax(dim=-1)[..., None, None].expand(-1, -1, -1, 1, 3)
    colors = offered.gather(3, chosen).flatten(2)
    return torch.cat([colors, torch.where(guess.pane > 0, guess.clear, 0.0)[..., None]], dim=2)


def describe_for_painter(
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    table: Float[np.ndarray, "P C"],
    resolution: int,
    rows: Int[np.ndarray, "K"] | None = None,
) -> Float[np.ndarray, "K T"]:
    """What the painter is told of voxels (float32): kinds and surroundings.

    Args:
        coords: Cells (x, y, z) of the grid.
        part_ids: Part of each.
        facings: Directions of their outer sides.
        table: Channels after occupancy of each part, in the default layout.
        resolution: Edge of the grid.
        rows: Voxels to describe, all by default.
    """
    rows = np.arange(len(coords)) if rows is None else rows
    labels = table[:, after_occupancy(DEFAULT_LAYOUT.label)].argmax(axis=1)
    told = (
        read_kinds(coords, part_ids, facings, table, resolution)[rows],
        describe_surroundings(coords, part_ids, facings, labels, resolution, rows),
    )
    return np.concatenate(told, axis=1)


@torch.no_grad()
def paint_voxels(
    painter: Painter,
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    table: Float[np.ndarray, "P C"],
    palettes: Float[np.ndarray, "P 7"],
    resolution: int,
) -> Float[np.ndarray, "N 7"]:
    """Colours of both sides of every voxel of an object, and how clear it is (float32).

    Args:
        painter: trained.
        coords: Cells (x, y, z) of the grid.
        part_ids: Part of each.
        facings: Directions of their outer sides.
        table: Channels after occupancy of each part.
        palettes: Of each part.
        resolution: Edge of the grid.
    """
    device = next(painter.parameters()).device
    told = describe_for_painter(coords, part_ids, facings, table, resolution)
    rows, colors = (torch.from_numpy(np.asarray(one)).float()[None] for one in (table, palettes))
    batch = VoxelBatch(
        rows=rows.to(device),
        palettes=colors.to(device),
        given=torch.ones(rows.shape[:2], dtype=torch.bool, device=device),
        owners=torch.from_numpy(part_ids.astype(np.int64))[None].to(device),
        told=torch.from_numpy(told)[None].to(device),
    )
    said = painter(batch)
    labels = np.array(name_rows(table))
    glazed, centred = (np.isin(labels, some)[part_ids] for some in (GLAZED, CENTRED))
    whole = facings == UP if name_category(table) == JOINED else facings != FRONT
    centred |= (labels == "base")[part_ids] & whole
    solid = torch.from_numpy(~glazed)[None].to(device)
    said = replace(said, pane=said.pane.masked_fill(solid, -torch.inf))
    edges = find_edges(coords, part_ids, facings, resolution)
    guess = settle_guess(said, coords, facings, edges, centred)
    return choose_colors(guess, offer_colors(guess, batch))[0].cpu().numpy()


def settle_guess(
    guess: PaintGuess,
    coords: Int[np.ndarray, "N 3"],
    facings: Int[np.ndarray, "N"],
    edges: Int[np.ndarray, "E 2"],
    centred: Bool[np.ndarray, "N"],
) -> PaintGuess:
    """What the painter makes of the voxels of an object once its faces are painted in figures.

    Panes are found first and are faces of their own, which have one clearness; so has one colour what the
    painter itself says of a figure (`artigen.figures`).

    Args:
        guess: of all voxels of one object.
        coords: Cells (x, y, z) of the grid.
        facings: Directions of their outer sides.
        edges: Pairs of neighbours on one face (`artigen.figures.find_edges`).
        centred: Whether figures on the faces of their parts lie in the middle.
    """
    count = len(coords)
    clear = torch.sigmoid(guess.pane[0].double()).cpu().numpy()
    panes = np.stack([1.0 - clear, clear], axis=1)
    pane = settle_figures(panes, coords, facings, number_faces(count, edges), centred)
    sure = panes[np.arange(count), pane]
    edges = edges[pane[edges[:, 0]] == pane[edges[:, 1]]]
    faces = number_faces(count, edges)
    chances = torch.softmax(guess.choices[0].double(), dim=-1).cpu().numpy() * sure[:, None, None]
    chosen, free = np.empty((count, SIDES), dtype=np.int64), guess.free[0].cpu().numpy().copy()
    for side in range(SIDES):
        own = settle_figures(chances[:, side], coords, facings, faces, centred)
        figures = number_faces(count, edges[own[edges[:, 0]] == own[edges[:, 1]]])
        chosen[:, side], free[:, side] = own, _average(free[:, side], chances[:, side, -1], figures)
    clears = _average(guess.clear[0].cpu().numpy()[:, None], clear, faces)[:, 0]
    told = guess.choices.new_tensor
    return PaintGuess(
        choices=told(np.where(np.eye(CHOICES)[chosen] > 0, 0.0, -np.inf))[None],
        free=told(free)[None],
        pane=told(2.0 * pane - 1.0)[None],
        clear=told(clears)[None],
    )


def _average(
    values: Float[np.ndarray, "N C"], weights: Float[np.ndarray, "N"], groups: Int[np.ndarray, "N"]
) -> Float[np.ndarray, "N C"]:
    """Weighted means over the groups, for each member."""
    total = np.bincount(groups, weights=weights)
    sums = np.stack([np.bincount(groups, weights=weights * one) for one in values.T], axis=1)
    return (sums / np.maximum(total, 1e-12)[:, None])[groups]
