"""`SketchNetwork`: a transformer that reads rows and predicts the next one, field by field.

The sequence has one position per row. The state of a row and the fields of the next row predicted so far give
the following field: a symbol of its slot's vocabulary, or a number. A coordinate has three encodings, whose
probabilities add up: a plane that an earlier row named, such a plane with an offset of at most `OFFSET`
steps, or two digits. Flush boards are therefore exactly flush, and the thickness of a board is one symbol.

With a picture of the object, every second block also attends to the tokens of `PictureEncoder`.
"""

from dataclasses import dataclass, field

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn
from torch.nn import functional

from artigen.sketch.batch import PARTS, PLACES, RowBatch
from artigen.sketch.blocks import Block, Feed, PictureMemory, find_turns
from artigen.sketch.part_counts import PartCounts
from artigen.sketch.picture import PictureConfig, PictureEncoder, PicturePrediction
from artigen.sketch.planes import (
    COARSE,
    FAR,
    FINE,
    OFFSET,
    OWN,
    SIDES,
    NumberParts,
    find_places,
    gather_numbers,
    list_planes,
    name_sides,
)
from artigen.sketch.rows import REACH
from artigen.sketch.slots import slots
from artigen.sketch.words import CATEGORIES

FREQUENCIES = 15
"""Frequencies of the sinusoidal embedding of numbers: periods from 2 to 2**15 steps."""


@dataclass(frozen=True, kw_only=True)
class SketchNetworkConfig:
    """Layer sizes."""

    width: int = 256
    layers: int = 10
    heads: int = 8
    pointer: int = 64
    """Width of the keys and queries of planes."""
    picture: PictureConfig | None = field(default_factory=PictureConfig)
    """Picture encoder; None for a network without pictures."""


class SketchNetwork(nn.Module):
    """The transformer; see the module's description."""

    of_cell: Tensor
    base: Tensor
    inside: Tensor
    turns: Tensor
    unlearned: Tensor

    def __init__(self, cfg: SketchNetworkConfig) -> None:
        super().__init__()
        self.cfg = cfg
        self.categories: tuple[str, ...] = CATEGORIES
        """Categories that the network draws."""
        self.part_counts: PartCounts = frozenset()
        """Counts of its training objects; empty if they are not known."""
        table, width = slots(), cfg.width
        count = len(table.base)
        self.symbols = nn.Embedding(table.total, width)
        self.unknown = nn.Embedding(count, width)
        self.numbers = nn.Linear(2 * FREQUENCIES, width, bias=False)
        self.gates = nn.Embedding(count, width)
        self.slots = nn.Embedding(count, width)
        self.part = nn.Embedding(PARTS, width)
        self.piece = nn.Embedding(PLACES, width)
        self.asked = nn.Embedding(2, width)
        self.enter = Feed(width)
        self.picture = None if cfg.picture is None else PictureEncoder(cfg.picture, width)
        self.blocks = nn.ModuleList(
            Block(width, cfg.heads, looks=cfg.picture is not None and layer % 2 == 0)
            for layer in range(cfg.layers)
        )
        self.leave = nn.RMSNorm(width)
        self.state = nn.Linear(width, width, bias=False)
        self.inner = nn.ModuleList(Feed(width) for _ in range(2))
        self.inner_norm = nn.RMSNorm(width)
        self.keys = nn.Linear(width, SIDES * cfg.pointer, bias=False)
        self.own_keys = nn.Parameter(torch.randn(OWN, cfg.pointer) * 0.1)
        self.queries = nn.Linear(width, 2 * cfg.pointer)
        self.ways = nn.Linear(width, 3)
        self.offset = nn.Linear(width, 2 * OFFSET + 1)
        self.coarse = nn.Linear(width, COARSE)
        self.coarse_in = nn.Embedding(COARSE, width)
        self.fine = nn.Sequential(nn.RMSNorm(width), nn.GELU(), nn.Linear(width, FINE))
        self.biases = nn.Embedding(table.total, 1)
        self._start(cfg)
        base = torch.from_numpy(np.maximum(table.base, 0))
        inside = torch.zeros(count, table.total, dtype=torch.bool)
        for slot, (first, size) in enumerate(zip(table.base, table.size, strict=True)):
            inside[slot, first : first + size] = bool(size > 0)
        self.register_buffer("of_cell", torch.from_numpy(table.of_cell), persistent=False)
        self.register_buffer("base", base, persistent=False)
        self.register_buffer("inside", inside, persistent=False)
        self.register_buffer("unlearned", torch.zeros(table.total, dtype=torch.bool), persistent=False)
        self.register_buffer("turns", np.pi / 2.0 ** torch.arange(FREQUENCIES), persistent=False)

    def _start(self, cfg: SketchNetworkConfig) -> None:
        for module in (
            self.symbols,
            self.unknown,
            self.slots,
            self.part,
            self.piece,
            self.asked,
            self.coarse_in,
        ):
            nn.init.normal_(module.weight, std=0.5)
        nn.init.normal_(self.gates.weight, std=1.0)
        nn.init.normal_(self.numbers.weight, std=0.2)
        nn.init.zeros_(self.biases.weight)
        for block in self.blocks:
            assert isinstance(block, Block)
            block.shrink(cfg.layers)
            if block.look is not None:  # a freshly added picture input changes nothing
                nn.init.zeros_(block.look.out.weight)

    def embed_cells(
        self, rows: Int[Tensor, "*N W"], known: Bool[Tensor, "*N W"], axes: Int[Tensor, "*N W"]
    ) -> Float[Tensor, "*N W D"]:
        """Embeds every cell; zero where a row lacks the field."""
        slot = self.of_cell[rows[..., 0]]
        exists, number = slot >= 0, axes >= 0
        slot = slot.clamp(min=0)
        symbol = self.base[slot] + torch.where(number | ~known | ~exists, 0, rows)
        cells = self.symbols(symbol)
        where = number & known & exists
        cells = cells.index_put((where,), self._embed_numbers(slot[where], rows[where]).to(cells.dtype))
        unknown = exists & ~known
        cells = cells.index_put((unknown,), self.unknown(slot[unknown]).to(cells.dtype))
        return cells * exists[..., None]

    def _embed_numbers(self, slot: Int[Tensor, "N"], value: Int[Tensor, "N"]) -> Float[Tensor, "N D"]:
        """Sinusoidal embedding of numbers, gated by their slot."""
        angle = value[:, None] * self.turns
        return self.numbers(torch.cat([angle.sin(), angle.cos()], dim=-1)) * self.gates(slot)

    def encode_pictures(self, image: Float[Tensor, "B 4 S S"]) -> tuple[PicturePrediction, PictureMemory]:
        """Encodes pictures: predictions, and the memory that blocks attend to.

        Args:
            image: RGB and alpha in [0, 1], premultiplied on black; resized to the encoder's edge.

        Raises:
            ValueError: If the network has no picture encoder.
        """
        if self.picture is None:
            raise ValueError("this network reads no pictures")
        edge = self.picture.cfg.edge
        if image.shape[-1] != edge:
            image = functional.interpolate(image, (edge, edge), mode="bilinear", antialias=True)
        seen = self.picture(image)
        looks = [block.look for block in self._blocks() if block.look is not None]
        pairs = [look.project(seen.tokens) for look in looks]
        return seen, PictureMemory(
            keys=tuple(keys for keys, _ in pairs), values=tuple(values for _, values in pairs)
        )

    def _blocks(self) -> "list[Block]":
        return [block for block in self.blocks if isinstance(block, Block)]

    def read_rows(
        self, cells: Float[Tensor, "B T W D"], batch: RowBatch, memory: PictureMemory | None = None
    ) -> Float[Tensor, "B T D"]:
        """States after each row."""
        x = (
            cells.sum(dim=2)
            + self.part(batch.part)
            + self.piece(batch.piece)
            + self.asked(batch.requested.long())
        )
        x = self.enter(x)
        memories = iter(()) if memory is None else zip(memory.keys, memory.values, strict=True)
        turn = find_turns(x, self.cfg.width // self.cfg.heads)
        for block in self._blocks():
            x = block(x, turn)
            if block.look is not None and memory is not None:
                x = block.look(x, *next(memories))
        return self.leave(x)

    def hidden(
        self, states: Float[Tensor, "N D"], before: Float[Tensor, "N D"], slot: Int[Tensor, "N"]
    ) -> Float[Tensor, "N D"]:
        """Hidden vector for predicting a slot, from the projected state (`state`) before the row and the
        row's cells so far."""
        x = states + before + self.slots(slot)
        for feed in self.inner:
            x = feed(x)
        return self.inner_norm(x)

    def symbol_logits(self, x: Float[Tensor, "N D"], slot: Int[Tensor, "N"]) -> Float[Tensor, "N V"]:
        """Logits over the whole vocabulary; `FAR` outside of the slot."""
        logits = functional.linear(x, self.symbols.weight).float() + self.biases.weight[:, 0].float()
        return logits.masked_fill(~self.inside[slot], FAR)

    def number_parts(
        self, x: Float[Tensor, "B N D"], keys: Float[Tensor, "B C P"], open_planes: Bool[Tensor, "B N C"]
    ) -> "NumberParts":
        """Log probabilities of the three encodings of a number.

        Args:
            x: Hidden vectors of `hidden`.
            keys: Keys of the planes; the last `OWN` are the row's own.
            open_planes: Planes that may be referenced; without any, a number is coded as digits.
        """
        queries = self.queries(x).float().unflatten(-1, (2, -1))
        scores = torch.einsum("bnqp,bcp->qbnc", queries, keys.float()) * keys.shape[-1] ** -0.5
        scores = scores.masked_fill(~open_planes, FAR).log_softmax(dim=-1)
        ways = self.ways(x).float()
        none = ~open_planes.any(dim=-1)
        blocked = torch.stack([none, none, torch.zeros_like(none)], dim=-1)
        ways = ways.masked_fill(blocked, FAR).log_softmax(dim=-1)
        return NumberParts(
            ways=ways,
            same=scores[0],
            near=scores[1],
            offset=self.offset(x).float().log_softmax(dim=-1),
            coarse=self.coarse(x).float().log_softmax(dim=-1),
        )

    def fine_logits(self, x: Float[Tensor, "... D"], coarse: Int[Tensor, "..."]) -> Float[Tensor, "... F"]:
        """Logits of the fine digit given the coarse one."""
        return self.fine(x + self.coarse_in(coarse)).float().log_softmax(dim=-1)

    def plane_keys(self, keys: Float[Tensor, "B T K"]) -> Float[Tensor, "B C P"]:
        """Keys of the planes of all rows (``keys`` of their states), then of the row's own."""
        keys = keys.unflatten(-1, (SIDES, -1)).flatten(1, 2)
        own = self.own_keys.to(keys.dtype).expand(len(keys), -1, -1)
        return torch.cat([keys, own], dim=1)

    def forward(
        self, batch: RowBatch, memory: PictureMemory | None = None
    ) -> tuple[Float[Tensor, "M"], Float[Tensor, "N"]]:
        """Negative log likelihood (nats) of every symbol and every number that the batch predicts."""
        cells = self.embed_cells(batch.rows, batch.known, batch.axes)
        states = self.read_rows(cells, batch, memory)
        before = cells.cumsum(dim=2) - cells
        projected = self.state(states)
        slot = self.of_cell[batch.rows[..., 0]].clamp(min=0)
        symbols = batch.predicted & (batch.axes < 0)
        b, t, c = symbols.nonzero(as_tuple=True)
        x = self.hidden(projected[b, t - 1], before[b, t, c], slot[b, t, c])
        logits = self.symbol_logits(x, slot[b, t, c])
        first = functional.cross_entropy(
            logits, self.base[slot[b, t, c]] + batch.rows[b, t, c], reduction="none"
        )
        return first, self._number_losses(batch, states, projected, before, slot)

    def _number_losses(
        self,
        batch: RowBatch,
        states: Float[Tensor, "B T D"],
        projected: Float[Tensor, "B T D"],
        before: Float[Tensor, "B T W D"],
        slot: Int[Tensor, "B T W"],
    ) -> Float[Tensor, "N"]:
        numbers = batch.predicted & (batch.axes >= 0)
        where, given = gather_numbers(numbers)
        b = torch.arange(len(where), device=where.device)[:, None].expand(where.shape[:2])
        t, c = where[..., 0], where[..., 1]
        x = self.hidden(
            projected[b, (t - 1).clamp(min=0)].flatten(0, 1),
            before[b, t, c].flatten(0, 1),
            slot[b, t, c].flatten(),
        ).unflatten(0, b.shape)
        earlier = torch.arange(batch.low.shape[1], device=t.device) < t[..., None]
        planes, free = list_planes(name_sides(batch), find_places(batch, b, t, c), earlier)
        target = batch.rows[b, t, c]
        parts = self.number_parts(x, self.plane_keys(self.keys(states)), free)
        coarse = (target + REACH) // FINE
        fine = self.fine_logits(x, coarse).gather(-1, ((target + REACH) % FINE)[..., None])[..., 0]
        return -parts.score(target, planes, coarse, fine)[given]
