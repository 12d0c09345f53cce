"""`SketchNetwork`: a transformer that reads rows and predicts the next one, field by field.

There is one position per row. Its state and the fields of the next row said so far give the following field:
a symbol of its slot's vocabulary, or a number. A coordinate has three ways to be said, whose probabilities
add up: a plane that an earlier row named, such a plane with an offset of at most `OFFSET` steps, or two
digits. So boards that are flush are exactly flush, and the thickness of a board is one symbol.

Where the object's picture is given, every second block also attends to what `PictureEncoder` sees in it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from math import log

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn
from torch.nn import functional

from artigen.sketch.picture import PictureConfig, PictureEncoder, Seen
from artigen.sketch.rows import CATEGORIES, FIELDS, LENGTH, REACH, ROW_KINDS, WIDTH, column

OFFSET = 96
"""Steps from a known plane within which a coordinate may be said by its distance."""
FINE = 32
"""Steps in the finer of the two digits of a number."""
COARSE = 2 * REACH // FINE
FREQUENCIES = 15
"""Sines and cosines that a number is read by: periods from 2 to 2**15 steps."""
SIDES = 8
"""Planes that a row names on each axis.

In this order: its low side; its high side; both mirrored at the middle plane of the object; the own low side
plus its size; its middle; one step further than from the row before it to this row; and its low side moved
from its part into the part that is being written.
"""
OWN = 2
"""Planes that the row in question has named itself: its low and its high side."""
PARTS, PLACES = 64, 32
"""Numbers of parts, and of places within a part, that are told apart; the last stands for all beyond."""
_FAR = -1e9
MIRROR_AXIS = 1


@dataclass(frozen=True, kw_only=True)
class SketchNetworkConfig:
    """Sizes."""

    width: int = 256
    layers: int = 6
    heads: int = 8
    pointer: int = 64
    """Width of keys and queries of planes."""
    picture: PictureConfig | None = field(default_factory=PictureConfig)
    """How pictures are read; None for a network that sees none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Slots:
    """One slot for every field of every kind of row; slot 0 is the kind itself."""

    of_cell: Int[np.ndarray, "K W"]
    """Slot of each column by kind of row, -1 for none."""
    base: Int[np.ndarray, "S"]
    """Where the symbols of a slot begin in the vocabulary; -1 for numbers."""
    size: Int[np.ndarray, "S"]
    total: int
    """Symbols in all."""


@cache
def slots() -> Slots:
    """The slots of the vocabulary of rows."""
    of_cell = np.full((len(ROW_KINDS), WIDTH), -1)
    of_cell[:, 0] = 0
    base, size, total = [0], [len(ROW_KINDS)], len(ROW_KINDS)
    for index, kind in enumerate(ROW_KINDS):
        for at, told in enumerate(FIELDS[kind], start=1):
            of_cell[index, at] = len(base)
            base.append(total if told.size else -1)
            size.append(told.size)
            total += told.size
    return Slots(of_cell=of_cell, base=np.array(base), size=np.array(size), total=total)


@dataclass(frozen=True, kw_only=True, eq=False)
class RowBatch:
    """Rows of several objects, padded on the right; those of the request come first.

    ``known`` says which cells are given (unknown ones only in requests), ``said`` which the network must
    say. ``axes`` are those of `artigen.sketch.rows.number_axis`; ``part`` and ``piece`` number the parts,
    and the rows within a part, up to each row.
    """

    rows: Int[Tensor, "B T W"]
    known: Bool[Tensor, "B T W"]
    said: Bool[Tensor, "B T W"]
    axes: Int[Tensor, "B T W"]
    asked: Bool[Tensor, "B T"]
    part: Int[Tensor, "B T"]
    piece: Int[Tensor, "B T"]
    low: Int[Tensor, "B T 4"]
    """Lowest corner of what a row describes; last the range of a joint, which later joints may repeat."""
    high: Int[Tensor, "B T 4"]
    named: Bool[Tensor, "B T"]
    """Whether a row names planes."""
    ranged: Bool[Tensor, "B T"]
    """Whether it names the range of a joint."""
    anchor: Int[Tensor, "B T 4"]
    """Lowest corner of the first piece of the row's part."""
    anchored: Bool[Tensor, "B T"]
    """Whether that piece comes before the row."""

    def to(self, device: torch.device | str) -> "RowBatch":
        """The batch on another device."""
        return RowBatch(**{name: value.to(device) for name, value in vars(self).items()})


@dataclass(frozen=True, kw_only=True, eq=False)
class Sight:
    """What blocks attend to of pictures: keys and values of each that looks."""

    keys: tuple[Float[Tensor, "B H N E"], ...]
    values: tuple[Float[Tensor, "B H N E"], ...]

    def take(self, objects: Sequence[int]) -> "Sight":
        """That of some of the objects, in this order."""
        rows = list(objects)
        return Sight(
            keys=tuple(one[rows] for one in self.keys), values=tuple(one[rows] for one in self.values)
        )


def join_sights(sights: Sequence[Sight]) -> Sight | None:
    """Those of several objects side by side; None for none."""
    if not sights:
        return None
    keys, values = ([getattr(one, name) for one in sights] for name in ("keys", "values"))
    return Sight(
        keys=tuple(torch.cat(block) for block in zip(*keys, strict=True)),
        values=tuple(torch.cat(block) for block in zip(*values, strict=True)),
    )


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
        """Those that it draws."""
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
        self.enter = _Feed(width)
        self.picture = None if cfg.picture is None else PictureEncoder(cfg.picture, width)
        self.blocks = nn.ModuleList(
            _Block(width, cfg.heads, looks=cfg.picture is not None and layer % 2 == 0)
            for layer in range(cfg.layers)
        )
        self.leave = nn.RMSNorm(width)
        self.state = nn.Linear(width, width, bias=False)
        self.inner = nn.ModuleList(_Feed(width) for _ in range(2))
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
            assert isinstance(block, _Block)
            for last in (block.out, block.feed.down):
                nn.init.normal_(last.weight, std=0.5 / (cfg.width * 2 * cfg.layers) ** 0.5)
            if block.look is not None:  # a network that has seen none begins as if there were none
                nn.init.zeros_(block.look.out.weight)

    def embed_cells(
        self, rows: Int[Tensor, "*N W"], known: Bool[Tensor, "*N W"], axes: Int[Tensor, "*N W"]
    ) -> Float[Tensor, "*N W D"]:
        """What every cell says; nothing where a row has no such field."""
        slot = self.of_cell[rows[..., 0]]
        exists, number = slot >= 0, axes >= 0
        slot = slot.clamp(min=0)
        symbol = self.base[slot] + torch.where(number | ~known | ~exists, 0, rows)
        said = self.symbols(symbol)
        where = number & known & exists
        said = said.index_put((where,), self._embed_numbers(slot[where], rows[where]).to(said.dtype))
        unknown = exists & ~known
        said = said.index_put((unknown,), self.unknown(slot[unknown]).to(said.dtype))
        return said * exists[..., None]

    def embed_values(
        self, slot: Int[Tensor, "N"], value: Int[Tensor, "N"], number: Bool[Tensor, "N"]
    ) -> Float[Tensor, "N D"]:
        """What single cells say: as `embed_cells`, for known ones."""
        said = self.symbols(self.base[slot] + torch.where(number, 0, value))
        if not number.any():
            return said
        return torch.where(number[:, None], self._embed_numbers(slot, value), said)

    def _embed_numbers(self, slot: Int[Tensor, "N"], value: Int[Tensor, "N"]) -> Float[Tensor, "N D"]:
        """Sines and cosines of numbers, weighed by what they are."""
        angle = value[:, None] * self.turns
        return self.numbers(torch.cat([angle.sin(), angle.cos()], dim=-1)) * self.gates(slot)

    def look(self, image: Float[Tensor, "B 4 S S"]) -> tuple[Seen, Sight]:
        """What pictures show, and what the blocks attend to of it.

        Args:
            image: RGB and alpha in [0, 1], premultiplied on black; scaled to the encoder's edge.

        Raises:
            ValueError: If the network reads no pictures.
        """
        if self.picture is None:
            raise ValueError("this network reads no pictures")
        edge = self.picture.cfg.edge
        if image.shape[-1] != edge:
            image = functional.interpolate(image, (edge, edge), mode="bilinear", antialias=True)
        seen = self.picture(image)
        looks = [block.look for block in self._blocks() if block.look is not None]
        pairs = [look.remember(seen.tokens) for look in looks]
        return seen, Sight(keys=tuple(keys for keys, _ in pairs), values=tuple(values for _, values in pairs))

    def _blocks(self) -> "list[_Block]":
        return [block for block in self.blocks if isinstance(block, _Block)]

    def read_rows(
        self,
        cells: Float[Tensor, "B T W D"],
        batch: RowBatch,
        cache: "list[Cache] | None" = None,
        sight: Sight | None = None,
    ) -> Float[Tensor, "B T D"]:
        """States after each row; with a cache, rows go on from those read before."""
        x = (
            cells.sum(dim=2)
            + self.part(batch.part)
            + self.piece(batch.piece)
            + self.asked(batch.asked.long())
        )
        x = self.enter(x)
        seen = iter(()) if sight is None else zip(sight.keys, sight.values, strict=True)
        before = 0 if cache is None else cache[0].length
        turn = _turns(x, before, self.cfg.width // self.cfg.heads)
        for index, block in enumerate(self._blocks()):
            x = block(x, turn, None if cache is None else cache[index])
            if block.look is not None and sight is not None:
                x = block.look(x, *next(seen))
        return self.leave(x)

    def think(
        self,
        states: Float[Tensor, "N D"],
        before: Float[Tensor, "N D"],
        slot: Int[Tensor, "N"],
    ) -> Float[Tensor, "N D"]:
        """What to say in a slot, from the state before the row and the cells said so far."""
        x = self.state(states) + before + self.slots(slot)
        for feed in self.inner:
            x = feed(x)
        return self.inner_norm(x)

    def symbol_logits(self, x: Float[Tensor, "N D"], slot: Int[Tensor, "N"]) -> Float[Tensor, "N V"]:
        """Over the whole vocabulary; far below zero outside of the slot."""
        logits = functional.linear(x, self.symbols.weight).float() + self.biases.weight[:, 0].float()
        return logits.masked_fill(~self.inside[slot], _FAR)

    def slot_logits(self, x: Float[Tensor, "N D"], slot: Int[Tensor, "N"], size: int) -> Float[Tensor, "N V"]:
        """Over ``size`` symbols from the first of the slot on, some of which may be those of others.

        Far below zero where a symbol was not learned.
        """
        symbols = (self.base[slot][:, None] + torch.arange(size)).clamp(max=len(self.symbols.weight) - 1)
        logits = (self.symbols.weight[symbols] @ x[:, :, None])[..., 0]
        logits = logits.float() + self.biases.weight[symbols, 0].float()
        return logits.masked_fill(self.unlearned[symbols], _FAR)

    def number_parts(
        self,
        x: Float[Tensor, "B N D"],
        keys: Float[Tensor, "B C P"],
        open_planes: Bool[Tensor, "B N C"],
    ) -> "NumberParts":
        """The three ways to say a number, as logarithms of chances.

        Args:
            x: thoughts.
            keys: of the planes; the last `OWN` are the row's own.
            open_planes: which planes may be pointed at; without any, a number is said anew.
        """
        queries = self.queries(x).float().unflatten(-1, (2, -1))
        scores = torch.einsum("bnqp,bcp->qbnc", queries, keys.float()) * keys.shape[-1] ** -0.5
        scores = scores.masked_fill(~open_planes, _FAR).log_softmax(dim=-1)
        ways = self.ways(x).float()
        none = ~open_planes.any(dim=-1)
        blocked = torch.stack([none, none, torch.zeros_like(none)], dim=-1)
        ways = ways.masked_fill(blocked, _FAR).log_softmax(dim=-1)
        return NumberParts(
            ways=ways,
            same=scores[0],
            near=scores[1],
            offset=self.offset(x).float().log_softmax(dim=-1),
            coarse=self.coarse(x).float().log_softmax(dim=-1),
        )

    def fine_logits(self, x: Float[Tensor, "... D"], coarse: Int[Tensor, "..."]) -> Float[Tensor, "... F"]:
        """The finer digit, given the coarse one."""
        return self.fine(x + self.coarse_in(coarse)).float().log_softmax(dim=-1)

    def plane_keys(self, keys: Float[Tensor, "B T K"]) -> Float[Tensor, "B C P"]:
        """Keys of the planes of all rows (``keys`` of their states), then the row's own."""
        keys = keys.unflatten(-1, (SIDES, -1)).flatten(1, 2)
        own = self.own_keys.to(keys.dtype).expand(len(keys), -1, -1)
        return torch.cat([keys, own], dim=1)

    def forward(
        self, batch: RowBatch, sight: Sight | None = None
    ) -> tuple[Float[Tensor, "M"], Float[Tensor, "N"]]:
        """Negative log likelihood of every symbol and of every number that the batch says (nats)."""
        cells = self.embed_cells(batch.rows, batch.known, batch.axes)
        states = self.read_rows(cells, batch, sight=sight)
        before = cells.cumsum(dim=2) - cells
        slot = self.of_cell[batch.rows[..., 0]].clamp(min=0)
        symbols = batch.said & (batch.axes < 0)
        b, t, c = symbols.nonzero(as_tuple=True)
        x = self.think(states[b, t - 1], before[b, t, c], slot[b, t, c])
        logits = self.symbol_logits(x, slot[b, t, c])
        first = functional.cross_entropy(
            logits, self.base[slot[b, t, c]] + batch.rows[b, t, c], reduction="none"
        )
        return first, self._number_losses(batch, states, before, slot)

    def _number_losses(
        self,
        batch: RowBatch,
        states: Float[Tensor, "B T D"],
        before: Float[Tensor, "B T W D"],
        slot: Int[Tensor, "B T W"],
    ) -> Float[Tensor, "N"]:
        said = batch.said & (batch.axes >= 0)
        where, given = _gather_numbers(said)
        b = torch.arange(len(where), device=where.device)[:, None].expand(where.shape[:2])
        t, c = where[..., 0], where[..., 1]
        x = self.think(
            states[b, (t - 1).clamp(min=0)].flatten(0, 1),
            before[b, t, c].flatten(0, 1),
            slot[b, t, c].flatten(),
        ).unflatten(0, b.shape)
        earlier = torch.arange(batch.low.shape[1], device=t.device) < t[..., None]
        planes, free = list_planes(batch, find_places(batch, b, t, c), earlier)
        target = batch.rows[b, t, c]
        parts = self.number_parts(x, self.plane_keys(self.keys(states)), free)
        coarse = (target + REACH) // FINE
        fine = self.fine_logits(x, coarse).gather(-1, ((target + REACH) % FINE)[..., None])[..., 0]
        return -parts.score(target, planes, coarse, fine)[given]


@dataclass(frozen=True, kw_only=True, eq=False)
class NumberParts:
    """Log chances of the three ways, of planes for each of the first two, of offsets and coarse digits."""

    ways: Float[Tensor, "B N 3"]
    same: Float[Tensor, "B N C"]
    near: Float[Tensor, "B N C"]
    offset: Float[Tensor, "B N O"]
    coarse: Float[Tensor, "B N K"]

    def score(
        self,
        target: Int[Tensor, "B N"],
        planes: Int[Tensor, "B N C"],
        coarse: Int[Tensor, "B N"],
        fine: Float[Tensor, "B N"],
    ) -> Float[Tensor, "B N"]:
        """Log likelihood of values, over all ways to say them."""
        apart = target[..., None] - planes
        same = self.same.masked_fill(apart != 0, _FAR).logsumexp(dim=-1)
        inside = apart.abs() <= OFFSET
        offset = self.offset.gather(-1, (apart + OFFSET).clamp(0, 2 * OFFSET))
        near = (self.near + offset).masked_fill(~inside, _FAR).logsumexp(dim=-1)
        anew = self.coarse.gather(-1, coarse[..., None])[..., 0] + fine
        return (self.ways + torch.stack([same, near, anew], dim=-1)).logsumexp(dim=-1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Places:
    """Where numbers stand in their rows, and what these have named before them."""

    axis: Int[Tensor, "B N"]
    """0 to 2 for coordinates, `LENGTH` for lengths."""
    low: Int[Tensor, "B N"]
    """The low side of the row's piece on that axis."""
    high: Int[Tensor, "B N"]
    has_low: Bool[Tensor, "B N"]
    """Whether the low side is said before."""
    has_high: Bool[Tensor, "B N"]
    starts: Bool[Tensor, "B N"]
    """Whether the number is that low side."""
    ends: Bool[Tensor, "B N"]
    """Whether it is the high side."""
    ranges: Bool[Tensor, "B N"]
    """Whether it is the range of a joint."""
    anchor: Int[Tensor, "B N"]
    """Lowest side of the first piece of the row's part."""
    anchored: Bool[Tensor, "B N"]
    """Whether that piece comes before the row."""


def list_planes(
    batch: RowBatch, places: Places, earlier: Bool[Tensor, "#B #N T"]
) -> tuple[Int[Tensor, "B N C"], Bool[Tensor, "B N C"]]:
    """Coordinates of the planes that numbers may be said by, and which of them are to be had.

    Args:
        batch: the rows that may have named planes.
        places: of the numbers.
        earlier: which of the rows come before each number's own.
    """
    axis = places.axis
    low, high, anchor = (
        values.gather(2, axis[:, None, :].expand(-1, values.shape[1], -1)).transpose(1, 2)
        for values in (batch.low, batch.high, batch.anchor)
    )
    step = 2 * low - low.roll(1, dims=2)
    planes = [low, high, -low, -high, places.low[..., None] + high - low]
    planes += [(low + high).div(2, rounding_mode="floor"), step, places.anchor[..., None] + low - anchor]
    ranged = earlier & batch.ranged[:, None, :] & places.ranges[..., None]
    coordinate = (axis < LENGTH)[..., None]
    named = earlier & batch.named[:, None, :] & coordinate
    mirrored = named & (axis == MIRROR_AXIS)[..., None]
    follows = batch.named & batch.named.roll(1, dims=1) & (batch.part == batch.part.roll(1, dims=1))
    again = named & follows[:, None, :] & places.starts[..., None]
    placed = named & (batch.part > 0)[:, None, :] & places.anchored[..., None]
    free = [named | ranged, named, mirrored, mirrored, named & places.ends[..., None], named, again, placed]
    own = torch.stack([places.low, places.high], dim=-1)
    has = torch.stack([places.has_low, places.has_high], dim=-1) & coordinate
    return (
        torch.cat([torch.stack(planes, dim=-1).flatten(2), own], dim=-1),
        torch.cat([torch.stack(free, dim=-1).flatten(2), has], dim=-1),
    )


def find_places(
    batch: RowBatch, b: Int[Tensor, "B N"], t: Int[Tensor, "B N"], c: Int[Tensor, "B N"]
) -> Places:
    """Where numbers stand: of object ``b``, in row ``t`` and column ``c``.

    Six columns from the first number of a piece on hold its low and its high corner.
    """
    axes = batch.axes[b, t]
    axis = batch.axes[b, t, c].clamp(min=0)
    first = (axes >= 0).int().argmax(dim=-1)
    piece = axes.gather(-1, (first + 5).clamp(max=WIDTH - 1)[..., None])[..., 0] >= 0
    piece &= axes.gather(-1, first[..., None])[..., 0] < LENGTH
    low, high, anchor = (
        values[b, t].gather(-1, axis[..., None])[..., 0] for values in (batch.low, batch.high, batch.anchor)
    )
    return Places(
        axis=axis,
        low=low,
        high=high,
        has_low=piece & (c > first + axis),
        has_high=piece & (c > first + 3 + axis),
        starts=piece & (c == first + axis),
        ends=piece & (c == first + 3 + axis),
        ranges=(batch.rows[b, t, 0] == ROW_KINDS.index("joint")) & (c == column("joint", "upper")),
        anchor=anchor,
        anchored=batch.anchored[b, t],
    )


def _gather_numbers(said: Bool[Tensor, "B T W"]) -> tuple[Int[Tensor, "B N 2"], Bool[Tensor, "B N"]]:
    """Row and column of the numbers of each object, padded, and which are no padding."""
    counts = said.flatten(1).sum(dim=1)
    order = said.flatten(1).int().argsort(dim=1, descending=True, stable=True)[:, : int(counts.max())]
    given = torch.arange(order.shape[1], device=said.device) < counts[:, None]
    order = torch.where(given, order, 0)
    return torch.stack([order // said.shape[2], order % said.shape[2]], dim=-1), given


@dataclass(eq=False)
class Cache:
    """Keys and values of the rows read so far by one block."""

    keys: Float[Tensor, "B H T E"] | None = None
    values: Float[Tensor, "B H T E"] | None = None

    @property
    def length(self) -> int:
        """Rows that were read."""
        return 0 if self.keys is None else self.keys.shape[2]

    def extend(self, keys: Tensor, values: Tensor) -> tuple[Tensor, Tensor]:
        """Appends, and returns all."""
        if self.keys is not None and self.values is not None:
            keys, values = torch.cat([self.keys, keys], dim=2), torch.cat([self.values, values], dim=2)
        self.keys, self.values = keys, values
        return keys, values


class _Feed(nn.Module):
    """A residual feed-forward layer."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.norm = nn.RMSNorm(width)
        self.up = nn.Linear(width, 2 * width, bias=False)
        self.down = nn.Linear(2 * width, width, bias=False)

    def forward(self, x: Float[Tensor, "... D"]) -> Float[Tensor, "... D"]:
        return x + self.down(functional.gelu(self.up(self.norm(x))))


class _Block(nn.Module):
    """Causal attention with rotary positions, then a feed-forward layer."""

    def __init__(self, width: int, heads: int, *, looks: bool = False) -> None:
        super().__init__()
        self.heads = heads
        self.norm = nn.RMSNorm(width)
        self.qkv = nn.Linear(width, 3 * width, bias=False)
        self.out = nn.Linear(width, width, bias=False)
        self.feed = _Feed(width)
        self.look = _Look(width, heads) if looks else None

    def forward(
        self, x: Float[Tensor, "B T D"], turn: tuple[Tensor, Tensor], cache: Cache | None = None
    ) -> Float[Tensor, "B T D"]:
        q, k, v = self.qkv(self.norm(x)).unflatten(-1, (3, self.heads, -1)).permute(2, 0, 3, 1, 4)
        q, k = _turn(q, turn), _turn(k, turn)
        if cache is not None:
            k, v = cache.extend(k, v)
        scores = q @ k.transpose(-1, -2) * q.shape[-1] ** -0.5
        if q.shape[2] > 1:
            ahead = torch.ones(q.shape[2], k.shape[2], dtype=torch.bool, device=x.device)
            scores = scores.masked_fill(ahead.triu(k.shape[2] - q.shape[2] + 1), float("-inf"))
        mixed = scores.float().softmax(dim=-1).to(v.dtype) @ v
        x = x + self.out(mixed.transpose(1, 2).flatten(2))
        return self.feed(x)


class _Look(nn.Module):
    """Attention to a picture."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.norm = nn.RMSNorm(width)
        self.query = nn.Linear(width, width, bias=False)
        self.memory = nn.Linear(width, 2 * width, bias=False)
        self.out = nn.Linear(width, width, bias=False)

    def remember(self, tokens: Float[Tensor, "B N D"]) -> tuple[Tensor, Tensor]:
        """Keys and values of a picture's tokens."""
        keys, values = self.memory(tokens).unflatten(-1, (2, self.heads, -1)).permute(2, 0, 3, 1, 4)
        return keys, values

    def forward(
        self,
        x: Float[Tensor, "B T D"],
        keys: Float[Tensor, "B H N E"],
        values: Float[Tensor, "B H N E"],
    ) -> Float[Tensor, "B T D"]:
        query = self.query(self.norm(x)).unflatten(-1, (self.heads, -1)).transpose(1, 2)
        mixed = functional.scaled_dot_product_attention(query, keys.to(query.dtype), values.to(query.dtype))
        return x + self.out(mixed.transpose(1, 2).flatten(2))


def _turns(
    x: Float[Tensor, "B T D"], start: int, width: int
) -> tuple[Float[Tensor, "T H"], Float[Tensor, "T H"]]:
    """Cosines and sines of the turns of positions from ``start`` on, for heads of a width."""
    half = width // 2
    speed = torch.exp(torch.arange(half, device=x.device) * (-log(10000.0) / half))
    angle = torch.arange(start, start + x.shape[1], device=x.device)[:, None] * speed
    return angle.cos(), angle.sin()


def _turn(x: Float[Tensor, "B H T E"], turn: tuple[Tensor, Tensor]) -> Float[Tensor, "B H T E"]:
    cos, sin = (one.to(x.dtype) for one in turn)
    a, b = x.chunk(2, dim=-1)
    return torch.cat([a * cos - b * sin, a * sin + b * cos], dim=-1)
