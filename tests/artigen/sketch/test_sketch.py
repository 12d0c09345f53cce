"""Sketches: exact inverses of shapes, rules that never stumble, chances that add up."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from artigen.errors import SourceError
from artigen.kind import kinds
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import Primitive, box, cylinder, move, place_vertices, polytope
from artigen.shapes.shape import Shape
from artigen.sketch import draw, growth, model
from artigen.sketch.batch import make_batch, sample_request
from artigen.sketch.decoder import Decoder
from artigen.sketch.draft import Draft, begin_draft
from artigen.sketch.draw import DrawConfig, continue_draft
from artigen.sketch.model import (
    SketchConfig,
    draw_header,
    draw_object,
    load_sketch_network,
    read_object_picture,
    save_sketch_network,
)
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.picture import MAX_COUNT, PictureConfig, PicturePrediction
from artigen.sketch.piece import UnknownSolid
from artigen.sketch.pieces import build_piece, fit_pieces
from artigen.sketch.planes import COARSE
from artigen.sketch.request import FinishRequest, RequestRows, SketchRequest, empty_request, encode_request
from artigen.sketch.rows import COUNTED, FIELDS, ROW_KINDS, column, rows_to_sketch, sketch_to_rows
from artigen.sketch.rules import Writer
from artigen.sketch.sketch import STEP, SketchError, read_sketch, write_sketch
from artigen.sketch.slots import slots
from artigen.sketch.words import CATEGORIES, STYLES
from artigen.types import PART_LABELS

TINY = SketchNetworkConfig(width=32, layers=2, heads=2, pointer=8, picture=None)
PICTURE = PictureConfig(edge=32, widths=(8, 16, 24), blocks=(1, 1, 1), stem=8)
DRAWN = [(category, seed) for category in CATEGORIES for seed in (1, 14)]


@cache
def _table(category: str, seed: int) -> np.ndarray:
    return sketch_to_rows(write_sketch(draw_shape(category, seed)))


@cache
def _network() -> SketchNetwork:
    torch.manual_seed(2)
    return SketchNetwork(TINY).eval()


@cache
def _seeing_network() -> SketchNetwork:
    """One that makes something of pictures, as if it had been trained."""
    torch.manual_seed(0)
    network = SketchNetwork(replace(TINY, picture=PICTURE)).eval()
    for name, weight in network.named_parameters():
        if ".look.out." in name:
            torch.nn.init.normal_(weight, std=0.3)
    return network


def _pictures() -> torch.Tensor:
    return torch.rand(2, 4, PICTURE.edge, PICTURE.edge, generator=torch.Generator().manual_seed(0))


def _corners(shape: Shape) -> list[np.ndarray]:
    return [place_vertices(primitive) for part in shape.parts for primitive in part.primitives]


@pytest.mark.parametrize(("category", "seed"), DRAWN)
def test_a_sketch_is_its_shape_to_half_a_step_and_writing_it_again_changes_nothing(category: str, seed: int):
    shape = draw_shape(category, seed)
    sketch = write_sketch(shape)
    again = read_sketch(sketch, seed)
    assert write_sketch(again) == sketch
    assert rows_to_sketch(sketch_to_rows(sketch)) == sketch
    shift = again.bounds()[0] - shape.bounds()[0]
    for have, want in zip(_corners(again), _corners(shape), strict=True):
        apart = np.abs(have[:, None] - (want + shift)[None]).max(axis=2).min(axis=1)
        assert apart.max() < 2.5 * STEP  # half a step of a corner, and of what it is measured from
    assert [part.needs and [need.fraction for need in part.needs] for part in again.parts] == [
        part.needs and [need.fraction for need in part.needs] for part in shape.parts
    ]
    for have, want in zip(again.parts, shape.parts, strict=True):
        assert (have.joint is None) == (want.joint is None)
        if have.joint and want.joint:
            assert have.joint.axis == pytest.approx(want.joint.axis)
            assert have.joint.stays == want.joint.stays
            assert have.joint.upper == pytest.approx(want.joint.upper, abs=0.005)
            assert have.joint.pitch == pytest.approx(want.joint.pitch, abs=1e-3)


@pytest.mark.parametrize("category", CATEGORIES)
def test_pieces_make_the_primitives_they_were_found_in(category: str):
    for part in draw_shape(category, 5).parts:
        made = [solid for piece in fit_pieces(part.primitives) for solid in build_piece(piece)]
        for have, want in zip(made, part.primitives, strict=True):
            one, other = place_vertices(have), place_vertices(want)
            assert np.abs(one[:, None] - other[None]).max(axis=2).min(axis=1).max() < 1e-6
            assert (have.finish, have.lining) == (want.finish, want.lining)


@pytest.mark.parametrize(
    "solid",
    [
        cylinder((0.0, 0.0, 0.0), (0.1, 0.1, 0.0), 0.02, "body"),
        move(box((0.0, 0.0, 0.0), (0.1, 0.2, 0.3), "body"), turn=0.3, about=(1.0, 1.0, 0.0)),
        polytope(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float), "body"),
    ],
)
def test_solids_without_a_word_are_named(solid: Primitive):
    with pytest.raises(UnknownSolid, match="expected"):
        fit_pieces([solid])


@pytest.mark.parametrize(("category", "seed"), DRAWN)
def test_the_rules_allow_what_the_grammar_says(category: str, seed: int):
    writer = Writer(request=empty_request())
    for row in _table(category, seed).tolist():
        while not writer.complete():
            value = row[len(writer.row)]
            follows = writer.follows() if writer.row else None
            slot = slots().of_cell[writer.row[0], len(writer.row)] if writer.row else 0
            if follows is not None:
                assert follows == value, (writer.kind, writer.name)
            elif slots().size[slot]:
                assert writer.allowed(int(slots().size[slot]))[value], (writer.row, writer.name)
            else:
                low, high = writer.span()
                assert low <= value <= high, (writer.row, writer.name)
            writer.put(value)
        writer.close()
    assert writer.done


@pytest.mark.parametrize("category", CATEGORIES)
def test_the_rules_allow_the_styles_of_the_category_and_no_others(category: str):
    writer = Writer(request=encode_request(SketchRequest(category=category)))
    writer.put(ROW_KINDS.index("object"))
    writer.put(CATEGORIES.index(category))
    assert writer.name == "style"
    known = {style if style in STYLES else "other" for style in kinds()[category].styles}
    assert {STYLES[index] for index in writer.allowed(len(STYLES)).nonzero()[0]} == known


class _Reciter(draw._Sampler):
    """Writes known tables, and adds up what each costs."""

    def recite(self, table: np.ndarray) -> float:
        self.truth, self.cost = table, 0.0
        while self.writers:
            self.write_row(lambda _: True)
            self.remove_finished(lambda writer: writer.done)
        return self.cost

    def _true(self) -> int:
        (writer,) = self.writers
        return int(self.truth[len(writer.rows)][len(writer.row)])

    def _draw_symbols(self, which: list[int], x: np.ndarray, slot: np.ndarray) -> list[int]:
        logits = self.decoder.score_symbols(x, slot, int(slots().size[slot[0]]))[0]
        self.cost -= float(logits[self._true()] - np.logaddexp.reduce(logits))
        return [self._true() for _ in which]

    def _draw_numbers(self, which: list[int], x: np.ndarray, slot: np.ndarray) -> list[int]:
        (low, _), true = self.writers[0].span(), self._true()
        super()._draw_numbers(which, x, slot)
        self.cost -= np.log(float(self.chances[0, true - low]))
        return [true for _ in which]

    def _find_certain(self, *_: object) -> None:
        return None

    def _draw(self, which: list[int], chances: np.ndarray) -> np.ndarray:
        self.chances = chances
        return np.zeros(len(which), dtype=int)


def _recite(draft: Draft, decoder: Decoder, reciter: type[_Reciter] = _Reciter) -> _Reciter:
    return reciter(decoder, draft, [np.random.default_rng(0)], [1.0], 1.0)


@torch.no_grad()
@pytest.mark.parametrize("reads", ["words", "pictures"])
@pytest.mark.parametrize(
    ("category", "seed"), [("StorageFurniture", 1), ("Refrigerator", 2), ("DeskLamp", 3)]
)
def test_a_table_costs_as_much_row_by_row_as_at_once(
    reads: str, category: str, seed: int, monkeypatch: pytest.MonkeyPatch
):
    """The decoder and the network that is trained agree."""
    monkeypatch.setattr(draw, "DIGITS", COARSE)
    monkeypatch.setattr(draw, "PLANES", 10_000)
    network = _seeing_network() if reads == "pictures" else _network()
    table = _table(category, seed)
    request = sample_request(table, np.random.default_rng(seed))
    memory = network.encode_pictures(_pictures()[:1])[1] if reads == "pictures" else None
    decoder = Decoder(network)
    sampler = _recite(begin_draft(decoder, request, memory), decoder)
    cost = sampler.recite(table)
    (draft,) = sampler.finished
    assert draft is not None
    assert np.array_equal(draft.writer.table, table)
    symbols, numbers = network(make_batch([table], [request]), memory)
    assert cost == pytest.approx(float(symbols.sum() + numbers.sum()), rel=1e-4)


@torch.no_grad()
def test_an_untrained_look_changes_nothing_and_a_trained_one_sees_which_picture_it_is():
    batch = make_batch([_table("Safe", 1)], [empty_request()])
    network = SketchNetwork(replace(TINY, picture=PICTURE)).eval()
    blind = network(batch)[0].sum()
    seen = [network(batch, network.encode_pictures(picture[None])[1])[0].sum() for picture in _pictures()]
    assert float(seen[0]) == pytest.approx(float(blind)) == pytest.approx(float(seen[1]))
    network = _seeing_network()
    seen = [network(batch, network.encode_pictures(picture[None])[1])[0].sum() for picture in _pictures()]
    assert abs(float(seen[0] - seen[1])) > 1e-3


@torch.no_grad()
def test_pictures_are_read_one_by_one_as_side_by_side():
    network = _seeing_network()
    together = network.encode_pictures(_pictures())[0]
    for index, picture in enumerate(_pictures()):
        alone = network.encode_pictures(picture[None])[0]
        torch.testing.assert_close(alone.tokens[0], together.tokens[index], atol=1e-4, rtol=1e-3)
        torch.testing.assert_close(alone.view[0], together.view[index], atol=1e-4, rtol=1e-3)
    assert together.tokens.shape[1] == (PICTURE.edge // 16) ** 2 + 2
    large = torch.nn.functional.interpolate(_pictures(), scale_factor=3.0)  # scaled down again
    assert network.encode_pictures(large)[0].tokens.shape == together.tokens.shape


def test_a_network_that_reads_no_pictures_says_so(tmp_path: Path):
    with pytest.raises(SourceError, match="reads no pictures"):
        read_object_picture(_network(), tmp_path / "photo.png")
    with pytest.raises(ValueError, match="reads no pictures"):
        _network().encode_pictures(_pictures())


@torch.no_grad()
def test_padding_beside_a_longer_object_changes_nothing():
    tables = [_table("Safe", 1), _table("Oven", 2)]
    requests = [empty_request(), empty_request()]
    together = _network()(make_batch(tables, requests))
    apart = [_network()(make_batch([table], [empty_request()])) for table in tables]
    for side in (0, 1):
        assert float(together[side].sum()) == pytest.approx(
            sum(float(one[side].sum()) for one in apart), rel=1e-4
        )


@torch.no_grad()
def test_chances_of_all_values_of_a_number_add_up_to_one(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(draw, "DIGITS", COARSE)
    monkeypatch.setattr(draw, "PLANES", 10_000)
    sums: list[float] = []

    class Adder(_Reciter):
        def _draw_numbers(self, which: list[int], x: np.ndarray, slot: np.ndarray) -> list[int]:
            (writer,) = self.writers
            span = writer.span
            writer.span = lambda: (-8192, 8191)  # type: ignore[method-assign]
            draw._Sampler._draw_numbers(self, which, x, slot)
            writer.span = span  # type: ignore[method-assign]
            sums.extend(self.chances.sum(axis=-1).tolist())
            return [self._true() for _ in which]

    decoder = Decoder(_network())
    _recite(begin_draft(decoder, empty_request()), decoder, Adder).recite(_table("Safe", 1))
    assert len(sums) > 50
    assert sums == pytest.approx([1.0] * len(sums), abs=1e-3)


@pytest.fixture
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Networks that know nothing hardly ever end: tables are given up early."""
    monkeypatch.setattr("artigen.sketch.rules.MAX_ROWS", 50)


REQUEST = SketchRequest(
    category="StorageFurniture",
    counts=(("drawer", 1), ("door", 1), ("handle", 0), ("knob", 0), ("tray", 0), ("shelf", 0), ("wheel", 0)),
    depth=0.4,
    width=0.8,
    height=1.2,
    finishes=(FinishRequest(role="front", color=(0.2, 0.4, 0.6), material="lacquer"),),
)


def _draw_tables(requests: list[RequestRows], seed: int, top_p: float = 0.98) -> list[np.ndarray | None]:
    """Whole tables, nothing rejected; None where one grew too long."""
    cfg, rngs = DrawConfig(temperature=0.8, top_p=top_p), np.random.default_rng(seed).spawn(len(requests))
    decoder = Decoder(_network())
    drafts = [
        continue_draft(decoder, begin_draft(decoder, request), lambda writer: writer.done, [rng], cfg)[0]
        for request, rng in zip(requests, rngs, strict=True)
    ]
    return [None if draft is None else np.array(draft.writer.rows) for draft in drafts]


@pytest.mark.slow
def test_what_is_asked_is_delivered_even_by_a_network_that_knows_nothing():
    tables = _draw_tables([encode_request(REQUEST)] * 6, 3, top_p=1.0)
    finished = [table for table in tables if table is not None]
    assert finished
    for table in finished:
        sketch = rows_to_sketch(table)
        assert sketch.category == "StorageFurniture"
        assert sketch.counts == {"base": 1, "drawer": 1, "door": 1}
        assert sketch.extents == (800, 1600, 2400)
        front = next(finish for finish in sketch.finishes if finish.role == "front")
        assert front.kind == "lacquer"
        assert front.color == (13, 25, 38)
        assert front.accent == (12, 24, 36)  # a shade darker, as lacquers are
        roles = {finish.role for finish in sketch.finishes}
        for index, part in enumerate(sketch.parts):
            assert part.parent < index
            for piece in part.pieces:
                assert {piece.finish, piece.lining} - {None} <= roles


def test_a_header_has_at_least_one_part_of_labels_that_are_asked_for():
    hot = DrawConfig(temperature=5.0, top_p=1.0)
    for some in ((), ("wheel",)):
        request = SketchRequest(category="Safe", some=some)
        counts = [dict(draw_header(_network(), request, seed, hot).counts)["wheel"] for seed in range(100)]
        assert (0 in counts) == (not some)


@pytest.mark.slow
@pytest.mark.usefixtures("_short")
def test_the_same_seed_draws_the_same_and_another_something_else():
    one, again, other = (_draw_tables([encode_request(REQUEST)] * 6, seed) for seed in (5, 5, 6))
    assert any(table is not None for table in one)
    assert all(np.array_equal(a, b) for a, b in zip(one, again, strict=True))
    assert not all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def test_a_header_says_what_is_asked_and_all_that_is_not():
    header = draw_header(_network(), replace(REQUEST, height=None), 0)
    assert header.width == pytest.approx(0.8)
    assert header.height is not None
    assert 0.02 <= header.height < 4.1
    assert (header.category, header.counts) == (REQUEST.category, REQUEST.counts)
    assert encode_request(header).known[0, : 1 + len(FIELDS["object"])].all()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"category": "Spaceship"}, "Spaceship"),
        ({"style": "baroque"}, "baroque"),
        ({"counts": (("door", 99),)}, "99 parts called door"),
        ({"width": 9.0}, "width 9 m"),
        ({"depth": 0.0099}, "depth 0.0099 m"),
        ({"finishes": (FinishRequest(role="soul"),)}, "soul"),
    ],
)
def test_what_cannot_be_asked_is_refused_with_what_can(wrong: dict[str, object], said: str):
    with pytest.raises(SketchError, match=said):
        encode_request(replace(REQUEST, **wrong))  # type: ignore[arg-type]


def test_an_extent_of_one_centimetre_can_be_asked():
    assert encode_request(SketchRequest(depth=0.01)).rows[0, column("object", "depth")] == round(0.01 / STEP)


@pytest.mark.parametrize("reads", ["words", "pictures"])
def test_a_stored_network_says_the_same_again(reads: str, tmp_path: Path):
    network = _seeing_network() if reads == "pictures" else _network()
    save_sketch_network(network, tmp_path, {"preset": "tiny"})
    loaded = load_sketch_network(tmp_path)
    assert loaded.cfg == network.cfg
    batch = make_batch([_table("Safe", 1)], [empty_request()])
    with torch.no_grad():
        assert float(loaded(batch)[1].sum()) == pytest.approx(float(network(batch)[1].sum()), rel=0.01)
    with pytest.raises(SourceError, match="no such model"):
        load_sketch_network(tmp_path / "nowhere")


@pytest.mark.usefixtures("_short")
@pytest.mark.slow
def test_an_object_that_cannot_be_made_sound_is_finished_with_its_faults_named():
    """A network that knows nothing never draws a sound object."""
    request = replace(REQUEST, counts=(*REQUEST.counts[1:], ("drawer", 0)))
    drawn = draw_object(_network(), request, 1, SketchConfig(candidates=12, batches=2))
    assert dict(drawn.shape.condition.counts) == {"base": 1, "door": 1}
    assert drawn.faults
    assert all(fault.text for fault in drawn.faults)
    assert "batches" in drawn.notes[0]


@pytest.mark.parametrize(("blamed", "again"), [((0, 2), 0), ((1, 2), 1), ((2,), 1)])
def test_after_a_dead_end_the_part_that_its_faults_involve_is_drawn_again(
    blamed: tuple[int, ...], again: int, monkeypatch: pytest.MonkeyPatch
):
    """Objects of three parts whose third part fails in the first batch that reaches it."""

    def stand_in(parts: int) -> SimpleNamespace:
        return SimpleNamespace(
            writer=SimpleNamespace(moving=[False] * parts, delivered=parts == 3, table=None)
        )

    begun: list[int] = []

    def batch(_grower: growth.Grower, draft: SimpleNamespace, _fits: object) -> list[SimpleNamespace]:
        begun.append(len(draft.writer.moving))
        return [stand_in(begun[-1] + 1)]

    def search(draft: SimpleNamespace) -> Iterator[growth._Found]:
        fails = len(draft.writer.moving) == 3 and begun.count(2) == 1
        return iter([growth._Found(id="overlap", parts=blamed)] if fails else [])

    monkeypatch.setattr(model, "begin_draft", lambda *_: stand_in(0))
    monkeypatch.setattr(growth, "_search_lasting", search)
    monkeypatch.setattr(growth, "_list_finished", lambda _: None)
    monkeypatch.setattr(model, "_judge", lambda *_, **__: (None, ()))
    monkeypatch.setattr(model, "_draw_header", lambda *_: stand_in(0))
    monkeypatch.setattr(growth.Grower, "_batch", batch)
    draw_object(_network(), REQUEST, 1)
    assert begun == [0, 1, 2, *range(again, 3)]


@pytest.mark.parametrize(("deeper", "fits"), [(0, True), (1, False)])
def test_a_continuation_ends_at_its_first_piece_that_overlaps_a_finished_part(
    deeper: int,
    fits: bool,  # noqa: FBT001 - a case
    monkeypatch: pytest.MonkeyPatch,
):
    """A door that touches its body, and the same door one step deeper."""
    rows = _table("Safe", 1)
    starts = np.flatnonzero(rows[:, 0] == ROW_KINDS.index("part"))
    door = rows[starts[1] + 1].copy()
    assert ROW_KINDS[door[0]] == "box"
    first = column("box", "x0")
    body = rows[starts[0] + 1 : starts[1] - 1]
    door[first], door[first + 3] = body[0][first] - 40 + deeper, body[0][first] + deeper
    door[first + 1 : first + 3], door[first + 4 : first + 6] = (
        body[0][first + 1 : first + 3],
        body[0][first + 4 : first + 6],
    )
    draft = begin_draft(Decoder(_network()), encode_request(REQUEST))
    draft.writer.rows = [*rows[: starts[1] + 1].tolist()]
    draft.writer.labels, draft.writer.moving, draft.writer.row = [0, 1], [False], door.tolist()
    found: list[bool] = []

    def stand_in(*_: object, temperatures: list[float], fits: Callable[[object], bool]) -> list[None]:
        found.append(fits(draft.writer))
        return []

    monkeypatch.setattr(growth, "continue_draft", stand_in)
    finished = replace(draft, writer=replace(draft.writer, rows=rows[: starts[1]].tolist(), row=[]))
    grower = growth.Grower(
        decoder=Decoder(_network()), rng=np.random.default_rng(0), draw=DrawConfig(), candidates=1
    )
    assert grower.grow(finished) == (None, 0)
    assert found == [fits]
    assert dict(grower.seen) == ({} if fits else {"overlap": 1})


def _seen(category: str, counts: dict[str, int]) -> PicturePrediction:
    """Predictions of a picture that are certain of a category and of some counts."""
    chances = torch.zeros(1, len(PART_LABELS), MAX_COUNT + 1)
    for label, count in counts.items():
        chances[0, PART_LABELS.index(label), count] = 5.0
    kinds = torch.zeros(1, len(CATEGORIES))
    kinds[0, CATEGORIES.index(category)] = 5.0
    empty = torch.zeros(1, 0)
    return PicturePrediction(
        tokens=empty, density=empty, labels=empty, counts=chances, category=kinds, view=empty
    )


def test_what_the_encoder_finds_likely_is_the_product_of_its_chances():
    seen = _seen("Oven", {"door": 2})
    sure = np.exp(5.0)
    rest = (MAX_COUNT + 1.0) ** (1 - len(COUNTED))
    kinds = sure + len(CATEGORIES) - 1
    counts = [2 if label == "door" else 31 for label in COUNTED]  # 31 is read as the largest count
    right = seen.rate(CATEGORIES.index("Oven"), counts)
    wrong = seen.rate(CATEGORIES.index("Safe"), [0] * len(COUNTED))
    assert right == pytest.approx(np.log(sure / (sure + MAX_COUNT) * rest * sure / kinds), abs=1e-4)
    assert wrong == pytest.approx(np.log(1.0 / (sure + MAX_COUNT) * rest / kinds), abs=1e-4)


@pytest.mark.parametrize("wheels", [0, 4, 11])
def test_of_twelve_headers_for_a_picture_the_encoder_chooses(monkeypatch: pytest.MonkeyPatch, wheels: int):
    """Headers of tables with 0, 1, 2, ... wheels."""

    def stand_in(
        _decoder: object, _draft: object, _until: object, rngs: list[object], _: object
    ) -> list[SimpleNamespace]:
        rows = [[0] * (column("object", "height") + 1) for _ in rngs]
        for count, row in enumerate(rows):
            row[column("object", "wheel")] = count
        return [SimpleNamespace(writer=SimpleNamespace(rows=[row])) for row in rows]

    monkeypatch.setattr(model, "continue_draft", stand_in)
    network = _seeing_network()
    encoded = _seen("StorageFurniture", {"wheel": wheels}), network.encode_pictures(_pictures()[:1])[1]
    assert dict(draw_header(network, REQUEST, 0, encoded=encoded).counts)["wheel"] == wheels
    assert dict(draw_header(network, REQUEST, 0).counts)["wheel"] == 0  # the only one


def test_a_draft_that_is_continued_stays_as_it_was():
    decoder = Decoder(_network())
    start = begin_draft(decoder, encode_request(REQUEST))
    header = continue_draft(decoder, start, lambda _: True, [np.random.default_rng(0)])[0]
    assert header is not None
    assert start.writer.rows == []
    assert len(header.writer.rows) == 1
    one, again = (
        continue_draft(
            decoder, header, lambda writer: len(writer.rows) > 2, np.random.default_rng(1).spawn(2)
        )
        for _ in range(2)
    )
    assert len(header.writer.rows) == 1
    for a, b in zip(one, again, strict=True):
        assert a is not None
        assert b is not None
        assert a.writer.rows == b.writer.rows
        assert a.writer.rows[0] == header.writer.rows[0]


@pytest.mark.usefixtures("_short")
def test_a_table_does_not_depend_on_those_beside_it():
    decoder = Decoder(_network())
    begun = begin_draft(decoder, encode_request(REQUEST))

    def draw_some(some: slice) -> list[list[list[int]]]:
        rngs = np.random.default_rng(3).spawn(4)[some]
        drafts = continue_draft(decoder, begun, lambda writer: len(writer.rows) > 5, rngs)
        return [draft.writer.rows for draft in drafts if draft is not None]

    assert draw_some(slice(4)) == draw_some(slice(1)) + draw_some(slice(1, 4))


@pytest.mark.usefixtures("_short")
def test_a_table_with_a_row_that_does_not_fit_is_dropped_and_changes_no_other():
    decoder = Decoder(_network())
    begun = begin_draft(decoder, encode_request(REQUEST))

    def draw_those(fits: Callable[[Writer], bool]) -> list[list[list[int]] | None]:
        rngs = np.random.default_rng(3).spawn(4)
        drafts = continue_draft(decoder, begun, lambda writer: len(writer.rows) > 5, rngs, fits=fits)
        return [None if draft is None else draft.writer.rows for draft in drafts]

    every = draw_those(lambda _: True)
    assert None not in every
    unlike = [rows[0] for rows in every if rows is not None]
    chosen = [row for row in unlike if row != unlike[1]]
    some = draw_those(lambda writer: bool(writer.rows) or writer.padded() != unlike[1])
    assert some == [rows if rows is not None and rows[0] in chosen else None for rows in every]


@pytest.mark.parametrize(
    ("share", "top_p", "temperature", "certain"),
    [(0.97, 0.98, 0.6, False), (0.99, 0.98, 0.6, True), (0.99, 0.98, 1.1, False), (0.99, 0.995, 0.6, False)],
)
def test_a_plane_with_all_that_the_nucleus_keeps_is_what_would_be_drawn(
    share: float,
    top_p: float,
    temperature: float,
    certain: bool,  # noqa: FBT001 - a case
):
    """Two rows name 40, one names 10; the rest of the mass may be anywhere in the span."""
    decoder, rng = Decoder(_network()), np.random.default_rng(0)
    begun = begin_draft(decoder, empty_request())
    sampler = draw._Sampler(decoder, begun, [rng], [temperature], top_p)
    planes, chances = np.array([[40, 10, 40]]), np.array([[share / 2, 0.005, share / 2]])
    found = sampler._find_certain([0], planes, chances, np.array([[0, 99]]))
    assert found == ([40] if certain else None)
    assert sampler._find_certain([0], planes, chances, np.array([[0, 39]])) is None
    if certain:
        low, summed = draw._sum_chances(
            [(planes, chances), (np.arange(100)[None], np.full((1, 100), (0.995 - share) / 100))],
            np.array([[0, 99]]),
        )
        assert {int(sampler._draw([0], summed)[0]) + low for _ in range(200)} == {40}


@pytest.mark.parametrize(
    ("values", "cfg", "temperature", "top_p"),
    [
        (60, DrawConfig(), 0.6, 0.98),
        (9, DrawConfig(temperature=0.7, top_p=0.8), 0.7, 0.8),
        (9, DrawConfig(temperature=0.7, top_p=1.0), 0.7, 1.0),
        (300, DrawConfig(temperature=0.7, top_p=0.999), 0.7, 0.999),
    ],
)
def test_values_are_drawn_as_often_as_they_are_likely(
    values: int, cfg: DrawConfig, temperature: float, top_p: float
):
    rng, count = np.random.default_rng(0), 20_000
    chances = rng.dirichlet(np.full(values, 0.5))
    decoder = Decoder(_network())
    temperatures = [5.0, cfg.temperature]  # that of the other table does not matter
    sampler = draw._Sampler(
        decoder, begin_draft(decoder, empty_request()), [rng, rng], temperatures, cfg.top_p
    )
    drawn = sampler._draw([1] * count, np.repeat(chances[None], count, axis=0))
    sharp = chances ** (1 / temperature)
    order = np.argsort(-sharp)
    likeliest = order[: int((np.cumsum(sharp[order]) / sharp.sum() < top_p).sum()) + 1]
    expected = np.zeros(values)
    expected[likeliest] = sharp[likeliest] / sharp[likeliest].sum()
    have = np.bincount(drawn, minlength=values) / count
    assert set(np.flatnonzero(have)) <= set(likeliest)
    assert np.abs(have - expected).max() < 5 * np.sqrt(expected.max() / count)


def test_rows_out_of_order_are_refused():
    table = _table("Safe", 1)
    part = ROW_KINDS.index("part")
    with pytest.raises(SketchError, match="cannot follow"):
        rows_to_sketch(np.delete(table, np.flatnonzero(table[:, 0] == part)[1], axis=0))
    with pytest.raises(SketchError, match="expected from"):
        rows_to_sketch(table[:-1])
    assert column("object", "category") == 1
