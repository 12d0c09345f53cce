"""`Decoder`: the sketch network in numpy, for the few rows that sampling reads at a time.

The weights are those of a `SketchNetwork`, which trains with PyTorch. For a handful of rows, numpy takes half
of PyTorch's time: calls cost less, and so do products with matrices stored by columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32, Int
from scipy.special import erf
from torch import Tensor, nn

from artigen.sketch.blocks import Block, CrossAttention, Feed, PictureMemory
from artigen.sketch.network import SketchNetwork
from artigen.sketch.planes import FAR, OFFSET, OWN, SIDES
from artigen.sketch.slots import slots

EPSILON = np.finfo(np.float32).eps
"""Added to mean squares, as `torch.nn.RMSNorm` does."""
Pair = tuple[np.ndarray, np.ndarray]
"""Keys and values, [..., T, E], or cosines and sines."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Memory:
    """Keys and values for every block: of the rows of a draft, and of the picture where there is one."""

    rows: tuple[Pair, ...]
    picture: tuple[Pair, ...] = ()
    """For the blocks that attend to the picture."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaneScores:
    """Log probabilities of the three encodings of a number, and of planes for the first two."""

    ways: Float[np.ndarray, "N 3"]
    same: Float[np.ndarray, "N C"]
    near: Float[np.ndarray, "N C"]


class Decoder:
    """The weights of a network, and its layers as functions of arrays."""

    def __init__(self, network: SketchNetwork) -> None:
        self.heads = network.cfg.heads
        self.symbols, self.biases = _values(network.symbols.weight), _values(network.biases.weight)[:, 0]
        self.unknown, self.gates = _values(network.unknown.weight), _values(network.gates.weight)
        self.numbers, self.turns = _columns(network.numbers), _values(network.turns)
        self.slots, self.asked = _values(network.slots.weight), _values(network.asked.weight)
        self.part, self.piece = _values(network.part.weight), _values(network.piece.weight)
        self.unlearned = network.unlearned.numpy()
        self.part_counts = network.part_counts
        self.enter = _Feed(network.enter)
        self.blocks = [_Block(block) for block in network.blocks if isinstance(block, Block)]
        self.leave, self.state = _values(network.leave.weight), _columns(network.state)
        self.inner = [_Feed(feed) for feed in network.inner if isinstance(feed, Feed)]
        self.inner_norm = _values(network.inner_norm.weight)
        self.keys, self.own_keys = _columns(network.keys), _values(network.own_keys)
        # One product gives the queries of planes and the encoding of a number, another its digits.
        self.refer, self.refer_bias = _join_columns(network.queries, network.ways)
        self.digits, self.digits_bias = _join_columns(network.offset, network.coarse)
        norm, _, last = network.fine
        assert isinstance(norm, nn.RMSNorm)
        assert isinstance(last, nn.Linear)
        self.coarse_in, self.fine_norm = _values(network.coarse_in.weight), _values(norm.weight)
        self.fine, self.fine_bias = _columns(last), _values(last.bias)

    def begin(self, memory: PictureMemory | None = None) -> Memory:
        """What there is to attend to before the first row: the picture of one object, if any."""
        width = self.leave.shape[0]
        nothing = np.zeros((self.heads, 0, width // self.heads), dtype=np.float32)
        picture = () if memory is None else zip(memory.keys, memory.values, strict=True)
        return Memory(
            rows=((nothing, nothing),) * len(self.blocks),
            picture=tuple((_values(keys[0]), _values(values[0])) for keys, values in picture),
        )

    def embed_symbols(
        self, slot: Int[np.ndarray, "N"], value: Int[np.ndarray, "N"]
    ) -> Float[np.ndarray, "N D"]:
        """Embeddings of known symbols."""
        return self.symbols[slots().base[slot] + value]

    def embed_numbers(
        self, slot: Int[np.ndarray, "N"], value: Int[np.ndarray, "N"]
    ) -> Float[np.ndarray, "N D"]:
        """Embeddings of known numbers: sines and cosines, gated by their slot."""
        angle = value[:, None] * self.turns
        return np.concatenate([np.sin(angle), np.cos(angle)], axis=1) @ self.numbers * self.gates[slot]

    def read(
        self,
        cells: Float[np.ndarray, "N D"],
        part: Int[np.ndarray, "N"],
        piece: Int[np.ndarray, "N"],
        memory: Memory,
        own: Sequence[Pair],
        *,
        requested: bool = False,
    ) -> tuple[Float[np.ndarray, "N D"], list[Pair]]:
        """States after one further row of every table, and the keys and values of its own rows with it.

        Args:
            cells: Sums of the embedded cells of the rows.
            part: Indices of the parts, as `artigen.sketch.batch.number_rows` gives them.
            piece: Positions within the parts.
            memory: Of the rows that the tables share.
            own: Keys and values of the rows of each table that follow those, by block, [N, H, S, E].
            requested: Whether the rows are those of a request.
        """
        x = self.enter(cells + self.part[part] + self.piece[piece] + self.asked[int(requested)])
        position = memory.rows[0][0].shape[1] + own[0][0].shape[2]
        turn = _find_turn(position, x.shape[1] // self.heads)
        pictures, extended = iter(memory.picture), []
        for block, shared, mine in zip(self.blocks, memory.rows, own, strict=True):
            x, pair = block(x, turn, self.heads, shared, mine)
            extended.append(pair)
            if block.look is not None and memory.picture:
                x = block.look(x, self.heads, next(pictures))
        return _normalise(x, self.leave), extended

    def hidden(
        self, states: Float[np.ndarray, "N D"], before: Float[np.ndarray, "N D"], slot: Int[np.ndarray, "N"]
    ) -> Float[np.ndarray, "N D"]:
        """Vectors that predict a slot, from the projected state (`project`) before the row and the row's
        cells so far."""
        x = states + before + self.slots[slot]
        for feed in self.inner:
            x = feed(x)
        return _normalise(x, self.inner_norm)

    def project(self, states: Float[np.ndarray, "N D"]) -> Float[np.ndarray, "N D"]:
        """States after a row as `hidden` takes them."""
        return states @ self.state

    def score_symbols(
        self, x: Float[np.ndarray, "N D"], slot: Int[np.ndarray, "N"], size: int
    ) -> Float[np.ndarray, "N V"]:
        """Logits of ``size`` symbols from the first of the slot on; a smaller slot is followed by other
        symbols.

        `FAR` for symbols that were not learned.
        """
        at = np.minimum(slots().base[slot][:, None] + np.arange(size), len(self.symbols) - 1)
        logits = (self.symbols[at] @ x[:, :, None])[..., 0] + self.biases[at]
        return np.where(self.unlearned[at], FAR, logits)

    def name_planes(self, states: Float[np.ndarray, "N D"]) -> Float[np.ndarray, "N S P"]:
        """Keys of the planes that rows name, from the states after them."""
        return (states @ self.keys).reshape(len(states), SIDES, -1)

    def score_planes(
        self, x: Float[np.ndarray, "N D"], keys: Float[np.ndarray, "N T P"], free: Bool[np.ndarray, "N C"]
    ) -> PlaneScores:
        """Log probabilities of the encodings of a number and of the planes that it may refer to.

        Args:
            x: Vectors of `hidden`.
            keys: Keys of the planes of all rows (`name_planes`).
            free: Planes that may be referenced, the last `OWN` those of the row itself; without any, a
                number is coded as digits.
        """
        found = x @ self.refer + self.refer_bias
        queries, ways = found[:, :-3].reshape(len(x), 2, -1).swapaxes(1, 2), found[:, -3:]
        own = np.broadcast_to(self.own_keys @ queries, (len(x), OWN, 2))
        scores = np.concatenate([keys @ queries, own], axis=1) * np.float32(queries.shape[1] ** -0.5)
        same, near = _log_softmax(np.where(free[..., None], scores, np.float32(FAR)).transpose(2, 0, 1))
        ways[~free.any(axis=1), :2] = FAR
        return PlaneScores(ways=_log_softmax(ways), same=same, near=near)

    def score_digits(
        self, x: Float[np.ndarray, "N D"]
    ) -> tuple[Float[np.ndarray, "N O"], Float[np.ndarray, "N K"]]:
        """Log probabilities of the offsets from a plane and of the coarse digits of a number."""
        found = x @ self.digits + self.digits_bias
        return _log_softmax(found[:, : 2 * OFFSET + 1]), _log_softmax(found[:, 2 * OFFSET + 1 :])

    def score_fine(
        self, x: Float[np.ndarray, "N D"], coarse: Int[np.ndarray, "N K"]
    ) -> Float[np.ndarray, "N K F"]:
        """Log probabilities of the fine digit after each of some coarse ones."""
        after = _gelu(_normalise(x[:, None] + self.coarse_in[coarse], self.fine_norm))
        return _log_softmax(after @ self.fine + self.fine_bias)


class _Feed:
    """`artigen.sketch.blocks.Feed`."""

    def __init__(self, feed: Feed) -> None:
        self.norm, self.up, self.down = _values(feed.norm.weight), _columns(feed.up), _columns(feed.down)

    def __call__(self, x: Float[np.ndarray, "N D"]) -> Float[np.ndarray, "N D"]:
        return x + _gelu(_normalise(x, self.norm) @ self.up) @ self.down


class _Block:
    """`artigen.sketch.blocks.Block`, for one further row of every table."""

    def __init__(self, block: Block) -> None:
        self.norm, self.qkv, self.out = _values(block.norm.weight), _columns(block.qkv), _columns(block.out)
        self.feed = _Feed(block.feed)
        self.look = None if block.look is None else _Look(block.look)

    def __call__(
        self, x: Float[np.ndarray, "N D"], turn: Pair, heads: int, shared: Pair, own: Pair
    ) -> tuple[Float[np.ndarray, "N D"], Pair]:
        qkv = (_normalise(x, self.norm) @ self.qkv).reshape(len(x), 3, heads, 1, -1).swapaxes(0, 1)
        q, k = _turn(qkv[:2], turn)
        own = np.concatenate([own[0], k], axis=2), np.concatenate([own[1], qkv[2]], axis=2)
        q *= np.float32(q.shape[-1] ** -0.5)
        along = q[:, :, 0].swapaxes(0, 1)  # [H, N, E]
        scores = np.concatenate(
            [(along @ shared[0].swapaxes(1, 2)).swapaxes(0, 1), (q @ own[0].swapaxes(2, 3))[:, :, 0]], axis=2
        )
        chances = _softmax(scores)
        first = shared[0].shape[1]
        mixed = (chances[:, :, :first].swapaxes(0, 1) @ shared[1]).swapaxes(0, 1)
        mixed += (chances[:, :, None, first:] @ own[1])[:, :, 0]
        return self.feed(x + mixed.reshape(len(x), -1) @ self.out), own


class _Look:
    """`artigen.sketch.blocks.CrossAttention`, to one picture."""

    def __init__(self, look: CrossAttention) -> None:
        self.norm, self.query, self.out = _values(look.norm.weight), _columns(look.query), _columns(look.out)

    def __call__(self, x: Float[np.ndarray, "N D"], heads: int, memory: Pair) -> Float[np.ndarray, "N D"]:
        query = (_normalise(x, self.norm) @ self.query).reshape(len(x), heads, -1).swapaxes(0, 1)
        chances = _softmax(query @ memory[0].swapaxes(1, 2) * np.float32(query.shape[-1] ** -0.5))
        return x + (chances @ memory[1]).swapaxes(0, 1).reshape(len(x), -1) @ self.out


def _values(tensor: Tensor) -> Float32[np.ndarray, "..."]:
    return tensor.detach().to("cpu", torch.float32).contiguous().numpy()


def _columns(linear: nn.Linear) -> Float32[np.ndarray, "I O"]:
    """Weights of a linear layer, transposed: products of few rows with these are faster."""
    return np.ascontiguousarray(_values(linear.weight).T)


def _join_columns(*layers: nn.Linear) -> tuple[Float32[np.ndarray, "I O"], Float32[np.ndarray, "O"]]:
    """Weights (`_columns`) and biases of layers side by side."""
    weights = np.concatenate([_columns(layer) for layer in layers], axis=1)
    return weights, np.concatenate([_values(layer.bias) for layer in layers])


def _normalise(x: Float[np.ndarray, "... D"], weight: Float[np.ndarray, "D"]) -> Float[np.ndarray, "... D"]:
    """`torch.nn.RMSNorm`."""
    square = np.vecdot(x, x)[..., None]
    return x * (weight / np.sqrt(square * np.float32(1.0 / x.shape[-1]) + EPSILON))


def _gelu(x: Float[np.ndarray, "... D"]) -> Float[np.ndarray, "... D"]:
    half = erf(x * np.float32(0.5**0.5))
    half += np.float32(1.0)
    half *= x
    half *= np.float32(0.5)
    return half


def _softmax(x: Float[np.ndarray, "... T"]) -> Float[np.ndarray, "... T"]:
    chances = np.exp(x - x.max(axis=-1, keepdims=True))
    chances /= chances.sum(axis=-1, keepdims=True)
    return chances


def _log_softmax(x: Float[np.ndarray, "... T"]) -> Float[np.ndarray, "... T"]:
    x = x - x.max(axis=-1, keepdims=True)
    return x - np.log(np.exp(x).sum(axis=-1, keepdims=True))


def _find_turn(position: int, width: int) -> Pair:
    """Cosines and sines of `artigen.sketch.blocks.find_turns` at one position."""
    half = width // 2
    angle = position * np.exp(np.arange(half) * (-np.log(10000.0) / half))
    return np.cos(angle).astype(np.float32), np.sin(angle).astype(np.float32)


def _turn(x: Float[np.ndarray, "... E"], turn: Pair) -> Float[np.ndarray, "... E"]:
    cos, sin = turn
    half = len(cos)
    a, b = x[..., :half], x[..., half:]
    turned = np.empty_like(x)
    turned[..., :half], turned[..., half:] = a * cos - b * sin, a * sin + b * cos
    return turned
