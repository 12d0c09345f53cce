"""Both sides of the limits of sketches, and what the shipped network would lose if its codes changed."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest
import torch

from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Need, Shape
from artigen.sketch import draw, growth, model
from artigen.sketch.batch import make_batch
from artigen.sketch.decoder import Decoder, PlaneScores
from artigen.sketch.draft import begin_draft
from artigen.sketch.model import load_sketch_network
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.piece import NUMBERS, Piece, PieceKind, UnknownSolid
from artigen.sketch.pieces import build_piece, fit_pieces
from artigen.sketch.planes import COARSE, FINE, OFFSET
from artigen.sketch.request import SketchRequest, empty_request
from artigen.sketch.rows import REACH, ROW_KINDS, sketch_to_rows
from artigen.sketch.rules import Writer
from artigen.sketch.sketch import SketchError, write_sketch
from artigen.sketch.snap import snap_piece
from artigen.weights import SHIPPED

KNOWN = ("Safe", "Laptop", "Printer")


@torch.no_grad()
def test_the_shipped_network_expects_what_the_grammar_draws():
    """About three nats a row; codes of numbers, words or planes that changed would cost many times that."""
    network = load_sketch_network(SHIPPED).eval()
    assert network.cfg == SketchNetworkConfig()  # the preset that `artigen train sketch` starts from
    assert not network.unlearned.any()
    tables = [sketch_to_rows(write_sketch(draw_shape(category, 1))) for category in KNOWN]
    symbols, numbers = network(make_batch(tables, [empty_request()] * len(tables)))
    assert float(symbols.sum() + numbers.sum()) / sum(map(len, tables)) < 3.5


@pytest.mark.parametrize("coolest", [np.inf, 0.1])
def test_an_object_is_given_up_after_240_batches_of_one_and_seven(monkeypatch, coolest):
    """And once more, to finish it, here where tables always grow too long. Where the first continuation is
    cooler than the others, dead ends make it warmer, until all are as warm."""
    start = SimpleNamespace(writer=SimpleNamespace(moving=[], delivered=False))
    counts: list[int] = []
    warmth: list[float] = []

    def draw(*_: object, temperatures: list[float], fits: object) -> list[None]:
        counts.append(len(temperatures))
        warmth.extend(temperatures)
        return [None] * len(temperatures)

    monkeypatch.setattr(model, "Decoder", MagicMock())
    monkeypatch.setattr(model, "begin_draft", lambda *_: start)
    monkeypatch.setattr(model, "_draw_header", lambda *_: start)
    monkeypatch.setattr(growth, "continue_draft", draw)
    with pytest.raises(SketchError, match="none of 8 continuations"):
        model.draw_object(MagicMock(), SketchRequest(), 0, model.SketchConfig(coolest=coolest))
    assert counts == [1, 7] * 241
    batches = np.array(warmth).reshape(-1, 8)
    assert batches[:, 0] == pytest.approx(np.minimum(coolest * np.arange(1, 242), 0.6))
    assert batches[:, -1] == pytest.approx(0.6)
    assert batches[0, 1:-1] == pytest.approx(np.linspace(batches[0, 0], 0.6, 8)[1:-1])


def test_an_object_that_is_given_up_is_finished_from_the_most_parts_it_had(monkeypatch):
    """Three parts, then a dead end that cuts back to the header, then two parts and nothing more."""
    parts = iter([1, 2, 3, None, 1, 2])
    finished: list[int] = []

    def draft(count: int) -> SimpleNamespace:
        return SimpleNamespace(writer=SimpleNamespace(moving=[True] * count, delivered=False, table=None))

    def grow(grower: growth.Grower, _: object) -> tuple[SimpleNamespace | None, int]:
        grower.batches += 1
        count = next(parts, None)
        return None if count is None else draft(count), 0

    def finish(_: growth.Grower, begun: SimpleNamespace) -> SimpleNamespace:
        finished.append(len(begun.writer.moving))
        return begun

    monkeypatch.setattr(model, "Decoder", MagicMock())
    monkeypatch.setattr(model, "begin_draft", lambda *_: draft(0))
    monkeypatch.setattr(model, "_draw_header", lambda *_: draft(0))
    monkeypatch.setattr(model, "_judge", lambda *_, **__: (MagicMock(), ()))
    monkeypatch.setattr(growth.Grower, "grow", grow)
    monkeypatch.setattr(growth.Grower, "finish", finish)
    model.draw_object(MagicMock(), SketchRequest(), 0)
    assert finished == [3]


def writer_of(rows: int, pieces: int = 0) -> Writer:
    """A table of so many rows, or a part of so many boxes."""
    table = sketch_to_rows(write_sketch(draw_shape("Safe", 1))).tolist()
    head = next(at for at, row in enumerate(table) if ROW_KINDS[row[0]] == "part")
    start = table[: head + 1] + [table[head + 1]] * pieces
    return Writer(request=empty_request(), rows=start + [table[0]] * (rows - len(start)), labels=[0])


def may_go_on(pieces: int) -> bool:
    """Whether a part of so many pieces may have another."""
    return bool(writer_of(0, pieces).allowed(len(ROW_KINDS))[ROW_KINDS.index("box")])


def extents() -> tuple[int, int]:
    writer = Writer(request=empty_request())
    writer.put(ROW_KINDS.index("object"))
    while writer.name != "depth":
        writer.put(0)
    return writer.span()


def test_objects_measure_a_centimetre_to_four_metres():
    """In steps of half a millimetre."""
    assert extents() == (20, 8191)


def is_kind(kind: PieceKind, sides: int, *more: float, axis: int = 2, noise: float = 0.0) -> bool:
    """Whether what a piece makes is that piece again, with one corner a bit off."""
    bounds = (0.0, 0.0, 0.0, 0.4, 0.4, 0.1) if axis == 2 else (0.0, 0.0, 0.0, 0.1, 0.4, 0.4)
    piece = Piece(
        kind=kind,
        finish="body",
        numbers=(*bounds, *more),
        axis=axis,
        sides=sides,
        corners=int(kind == "slab"),
    )
    assert len(piece.numbers) == len(NUMBERS[kind])
    solids = list(build_piece(piece))
    moved = solids[0].vertices.copy()
    moved[0, 0] += noise
    solids[0] = replace(solids[0], vertices=moved)
    try:
        found = fit_pieces(solids)
    except UnknownSolid:
        return False
    return [one.kind for one in found] == [kind]


def needing(count: int) -> Shape:
    """A drawer that needs so many others."""
    shape = draw_shape("StorageFurniture", 2)
    moving = [part.name for part in shape.parts if part.joint is not None]
    last = shape.parts[-1]
    assert len(moving) > count
    needs = tuple(Need(part=name) for name in moving[:count] if name != last.name)
    at = next(k for k, part in enumerate(shape.parts) if part.name == moving[-1])
    parts = list(shape.parts)
    parts[at] = replace(parts[at], needs=needs)
    return replace(shape, parts=tuple(parts))


def can_be_written(shape: Shape) -> bool:
    try:
        write_sketch(shape)
    except SketchError:
        return False
    return True


LIMITS: dict[str, tuple[Callable[[float], bool], float, float]] = {
    "rows": (lambda x: not writer_of(int(x)).stuck, 219, 220),
    "pieces of a part": (lambda x: may_go_on(int(x)), 31, 32),
    "needs": (lambda x: can_be_written(needing(int(x))), 2, 3),
    "wedges of a ring": (lambda x: is_kind("ring", int(x), 0.1, 0.1, 0.2), 8, 7),
    "segments of a slab": (lambda x: is_kind("slab", int(x), 0.1, 0.1), 8, 9),
    "walls of a shell": (lambda x: is_kind("shell", int(x), 0.05, 0.05, 0.0, 0.02), 1, 9),
    "corner of a slab": (lambda x: is_kind("slab", 2, 0.1, 0.1, noise=x), 0.8e-6, 1.3e-6),
}  # fmt: skip


@pytest.mark.parametrize("name", LIMITS)
def test_what_is_within_is_one_and_what_is_beyond_is_none(name):
    holds, within, beyond = LIMITS[name]
    assert holds(within)
    assert not holds(beyond)


@pytest.mark.parametrize(("rank", "possible"), [(24, True), (25, False)])
def test_a_number_is_coded_by_one_of_the_24_likeliest_coarse_digits(rank: int, possible: bool):  # noqa: FBT001
    """Of 30 coarse digits, each half as likely as the one before."""
    decoder = Decoder(
        SketchNetwork(SketchNetworkConfig(width=32, layers=1, heads=2, pointer=8, picture=None))
    )
    sampler = draw._Sampler(
        decoder, begin_draft(decoder, empty_request()), [np.random.default_rng(0)], [1], 1
    )
    coarse, x = np.full((1, COARSE), -60.0), np.zeros((1, 32), dtype=np.float32)
    coarse[0, :30] = -np.arange(30) * np.log(2.0)
    scores = PlaneScores(ways=np.zeros((1, 3)), same=np.zeros((1, 1)), near=np.zeros((1, 1)))
    values, _ = sampler._digit_chances(scores, coarse, x, np.array([[1 - REACH, REACH - 1]]))
    assert ((rank - 1) * FINE - REACH in values) == possible


@pytest.mark.parametrize(("rank", "possible"), [(48, True), (49, False)])
def test_an_offset_is_one_from_one_of_the_48_likeliest_planes(rank: int, possible: bool):  # noqa: FBT001
    """Of 60 planes that are so far apart that no offset reaches another."""
    planes, near = np.arange(60)[None] * 1000, -np.arange(60.0)[None]
    scores = PlaneScores(ways=np.zeros((1, 3)), same=near, near=near)
    values, chances = draw._offset_chances(scores, np.zeros((1, 2 * OFFSET + 1)), planes)
    assert ((rank - 1) * 1000 + OFFSET in values) == possible
    assert chances.shape == values.shape


@pytest.mark.parametrize(("cut", "kinds"), [(0.09, {"shell"}), (0.1, {"box", "frustum", "prism"})])
def test_walls_around_a_hollow_are_a_shell_if_there_are_eight(cut: float, kinds: set[str]):
    """Of a tube of 0.2 m, cuts of half of it meet in a corner, which leaves seven walls."""
    numbers = (0.0, 0.0, 0.0, 0.4, 0.2, 0.1, cut, 0.05, 0.0, 0.02)
    walls = build_piece(Piece(kind="shell", finish="body", numbers=numbers, axis=2, sides=1))
    assert len(walls) == (8 if kinds == {"shell"} else 7)
    assert {piece.kind for piece in fit_pieces(walls)} <= kinds


@pytest.mark.parametrize(("short", "steps"), [(0.9e-6, 201), (1.1e-6, 200)])
def test_arcs_that_meet_within_a_micrometre_go_on_meeting(short: float, steps: int):
    """Half of 200.3 mm, which are 401 steps of half a millimetre, are 200 steps by themselves."""
    bounds = (0.0, 0.0, 0.0, 0.2003, 0.2003, 0.1)
    arch = Piece(
        kind="slab", finish="body", numbers=(*bounds, 0.10015 - short, 0.1), axis=2, sides=3, corners=3
    )
    assert snap_piece(arch).numbers[6] == steps
    oval = Piece(
        kind="shell", finish="body", numbers=(*bounds, 0.10015, 0.10015 - short, 0.0, 0.02), axis=2, sides=3
    )
    assert sum(snap_piece(oval).numbers[6:8]) == 200 + steps
