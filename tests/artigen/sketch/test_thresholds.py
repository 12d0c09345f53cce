"""Both sides of the limits of sketches, and what the shipped network would lose if its codes changed."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest
import torch

from artigen.datasets.mesh_raster import project_points
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import box, place_vertices
from artigen.shapes.shape import Need, Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.sketch import alignment, draw, growth, model, picture_colors
from artigen.sketch.alignment import Fit, View, find_hull, place_camera
from artigen.sketch.batch import make_batch
from artigen.sketch.decoder import Decoder, PlaneScores
from artigen.sketch.draft import begin_draft
from artigen.sketch.model import load_sketch_network
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.overlay import SIDES, find_lines, find_visible, list_faces, measure_evenness, read_target
from artigen.sketch.picture_colors import Spots, find_brightness, read_colors
from artigen.sketch.piece import NUMBERS, Piece, PieceKind, UnknownSolid
from artigen.sketch.pieces import build_piece, fit_pieces
from artigen.sketch.planes import COARSE, FINE, OFFSET
from artigen.sketch.request import SketchRequest, empty_request
from artigen.sketch.rows import REACH, ROW_KINDS, sketch_to_rows
from artigen.sketch.rules import Writer
from artigen.sketch.sketch import SketchError, write_sketch
from artigen.splats.colors import linear_from_srgb
from artigen.weights import SHIPPED

KNOWN = ("Safe", "StorageFurniture", "Refrigerator")


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


def test_for_a_picture_the_first_continuations_are_drawn_at_a_tenth(monkeypatch):
    found: list[model.SketchConfig] = []

    def stop(_network: object, _request: object, _seed: int, cfg: model.SketchConfig, _: object) -> None:
        found.append(cfg)
        raise SketchError("stop")

    monkeypatch.setattr(model, "draw_object", stop)
    with pytest.raises(SketchError, match="stop"):
        model.draw_pictured(MagicMock(), SketchRequest(), 0, np.zeros((4, 8, 8), dtype=np.float32))
    assert found[0].coolest == pytest.approx(0.1)
    assert found[0].header.temperature == pytest.approx(0.5)


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


def finish(level: float = 0.5, opacity: float = 1.0) -> Finish:
    color = (level, level, level)
    return Finish(kind="lacquer", color=color, accent=color, gloss=0.0, opacity=opacity)


def blocks(*steps: float, finishes: tuple[Finish, ...] = (finish(),)) -> Shape:
    """A row of boxes side by side whose fronts are this far (m) before the first one's."""
    solids = [box((-step, k, 0.0), (0.5, k + 1.0, 1.0), "body") for k, step in enumerate((0.0, *steps))]
    names = ("body", "front", "top")
    return Shape(
        category="Test",
        seed=0,
        style="",
        parts=(ShapePart(name="body", label="base", parent=None, primitives=tuple(solids)),),
        finishes=tuple(zip(names, finishes, strict=False)),
    )


def seen_from_front(shape: Shape, size: int = 64):
    """Its faces, the camera before it, and which face each pixel shows."""
    faces = list_faces(shape)
    blank = np.zeros((4, size, size), dtype=np.float32)
    blank[3, 8:-8, 4:-4] = 1.0
    camera = place_camera(
        View(yaw=0.0, pitch=0.0, closeness=0.1), find_hull(faces.vertices), read_target(blank, size)
    )
    return faces, camera, find_visible(faces, camera)


def test_a_view_without_zoom_or_shift_fills_the_box_of_the_picture():
    blank = np.zeros((4, 64, 64), dtype=np.float32)
    blank[3, 10:40, 20:60] = 1.0
    target = read_target(blank, 64)
    points = np.concatenate([place_vertices(p) for p in blocks(0.3).parts[0].primitives])
    plane, _ = project_points(points, place_camera(View(yaw=0.4, pitch=0.2, closeness=0.2), points, target))
    low, high = plane.min(axis=0), plane.max(axis=0)
    np.testing.assert_allclose((low + high) / 2, [40.0, 25.0], atol=1e-9)
    assert np.prod(high - low) == pytest.approx(30.0 * 40.0)


@pytest.mark.parametrize(("overlap", "refined"), [(0.961, 3), (0.959, 4)])
def test_a_fit_that_overlaps_by_less_than_96_percent_is_refined_once_more(monkeypatch, overlap, refined):
    counts: list[int] = []

    def refine(_score: object, start: View, count: int, _tries: int) -> View:
        counts.append(count)
        return start

    monkeypatch.setattr(alignment, "measure_overlap", lambda *_: overlap)
    monkeypatch.setattr(alignment, "refine", refine)
    picture = np.zeros((4, 64, 64), dtype=np.float32)
    picture[:, 10:40, 20:60] = 1.0
    alignment.fit_camera(blocks(0.1), picture)
    assert len(counts) == refined


def test_faces_three_millimetres_apart_show_an_edge():
    """To the nearest step of three: 1.4 mm is none, 1.6 mm is one."""
    found = {}
    for step in (1.4e-3, 1.6e-3):
        faces, _, seen = seen_from_front(blocks(step))
        found[step] = bool(find_lines(faces, seen)[20:44, 20:44].any())
    assert found == {1.4e-3: False, 1.6e-3: True}


def test_colours_explain_a_picture_up_to_a_noise_of_two_hundredths():
    """The upper half, of a finish of its own, is brighter: nothing but the noise is left."""
    upper = ShapePart(
        name="top", label="door", parent="body", primitives=(box((-0.01, 0, 0.5), (0.5, 2, 1), "front"),)
    )
    one = blocks(0.0)
    shape = replace(one, parts=(*one.parts, upper), finishes=(("body", finish()), ("front", finish())))
    faces, _, seen = seen_from_front(shape)
    apart, picture = 0.05, np.zeros((4, 64, 64), dtype=np.float32)
    picture[3] = seen >= 0
    picture[:3] = np.where(np.arange(64) < 32, 0.5 + apart, 0.5 - apart)[:, None] * picture[3]
    explained = measure_evenness(faces, seen, read_target(picture, 64))
    assert explained == pytest.approx(1.0 - 0.02**2 / (3 * apart**2 + 0.02**2), abs=0.01)


def spots(counts: dict[tuple[int, int], int], light: float = 0.2) -> Spots:
    """So many pixels of each finish on each side, all clear and without a light of their own."""
    roles = np.concatenate([np.full(count, role) for (role, _), count in counts.items()])
    sides = np.concatenate([np.full(count, side) for (_, side), count in counts.items()])
    count = len(roles)
    return Spots(
        light=np.full((count, 3), light),
        roles=roles,
        sides=sides,
        clear=np.ones(count, dtype=bool),
        bright=np.ones(count),
        mirrored=np.zeros(count),
        pattern=np.ones((count, 3)),
    )


def test_sides_are_as_bright_as_in_the_room_by_a_tenth_of_the_pixels():
    """One finish, half on each of two sides, one of which has e times the light: least squares by hand."""
    light = np.full((200, 3), 0.1)
    light[100:] *= np.e
    found = find_brightness(replace(spots({(0, 0): 100, (0, 2): 100}), light=light), 1)
    assert found[[0, 2]] == pytest.approx([-0.5 / 1.2, 0.5 / 1.2])


@pytest.mark.parametrize(("pixels", "counts"), [(21, True), (19, False)])
def test_a_finish_on_two_percent_of_the_pixels_says_how_bright_its_side_is(pixels, counts):
    """A second finish is on both sides, and much brighter on the second."""
    there = spots({(0, 0): 500, (1, 0): 500 - pixels, (1, 2): pixels})
    light = np.where(there.sides == 2, 0.4, 0.1)[:, None].repeat(3, axis=1)
    assert (find_brightness(replace(there, light=light), 2)[2] > 0.05) == counts


def test_a_sixth_of_a_pixel_is_its_own_at_least():
    """However much the room is said to mirror: 15 %."""
    there = replace(spots({(0, 0): 1}, light=0.4), mirrored=np.array([0.39]))
    assert picture_colors._undo_light(there)[0] == pytest.approx([0.15 * 0.4] * 3)


def show_evenly(monkeypatch: pytest.MonkeyPatch, shown: Spots) -> None:
    """Lets pictures show the given spots, all sides equally bright."""
    monkeypatch.setattr(picture_colors, "find_spots", lambda *_: shown)
    monkeypatch.setattr(picture_colors, "find_brightness", lambda *_: np.zeros(SIDES))


@pytest.mark.parametrize(
    ("clear", "others", "opacity", "read"),
    [
        (12, 0, 1.0, True),
        (11, 0, 1.0, False),
        (40, 1960, 1.0, True),  # 2 % of the object
        (39, 1961, 1.0, False),
        (12, 0, 0.991, True),
        (12, 0, 0.989, False),
    ],
)
def test_the_colour_of_an_opaque_finish_on_two_percent_of_the_object_is_read(
    monkeypatch, clear, others, opacity, read
):
    """Away from edges, and from twelve pixels at least."""
    shape = blocks(finishes=(finish(opacity=opacity),))
    shown = spots({(0, 0): clear + others}, light=1.0)
    shown = replace(shown, clear=np.arange(clear + others) < clear)
    show_evenly(monkeypatch, shown)
    _, camera, _ = seen_from_front(shape)
    fit = Fit(view=View(yaw=0, pitch=0, closeness=0.1), camera=camera, overlap=1)
    found = read_colors(shape, np.zeros((4, 8, 8), dtype=np.float32), fit)
    assert (found.finishes != shape.finishes) == read


def test_lightness_is_that_of_greys_and_chroma_that_of_what_is_not_grey():
    """L* of sRGB grey 0.5 is 53.4, and of primary blue (32.3, 79.2, -107.9) by CIE 15."""
    assert picture_colors._lab(np.full(3, 0.5)) == pytest.approx([53.4, 0.0, 0.0], abs=0.05)
    assert picture_colors._lab(np.array([0.0, 0.0, 1.0])) == pytest.approx([32.3, 79.2, -107.9], abs=0.1)


@pytest.mark.parametrize("trust", [True, False])
@pytest.mark.parametrize(
    ("read", "agrees"),
    [
        ((0.921, 0.921, 0.921), True),  # 39.6 lighter
        ((0.929, 0.929, 0.929), False),  # 40.4 lighter
        ((0.137, 0.137, 0.137), True),
        ((0.128, 0.128, 0.128), False),
        ((0.5, 0.5, 0.552), True),  # chroma 7.6
        ((0.5, 0.5, 0.557), False),  # chroma 8.4
    ],
)
def test_a_drawn_colour_of_nearly_the_pictures_hue_and_lightness_is_kept(monkeypatch, trust, read, agrees):
    shape = blocks(finishes=(finish(0.5),))
    shown = replace(spots({(0, 0): 12}), light=np.tile(linear_from_srgb(np.array(read)), (12, 1)))
    show_evenly(monkeypatch, shown)
    _, camera, _ = seen_from_front(shape)
    fit = Fit(view=View(yaw=0, pitch=0, closeness=0.1), camera=camera, overlap=1)
    found = read_colors(shape, np.zeros((4, 8, 8), dtype=np.float32), fit, trust=trust)
    wanted = (0.5,) * 3 if trust and agrees else read
    assert found.finishes[0][1].color == pytest.approx(wanted)


@pytest.mark.parametrize(("apart", "equal"), [(0.019, True), (0.021, False)])
def test_finishes_within_a_fiftieth_are_of_one_colour(apart, equal):
    assert picture_colors._equal(finish(0.5), finish(0.5 + apart)) == equal


@pytest.mark.parametrize(("step", "shaded"), [(5.9e-3, False), (6.1e-3, True)])
def test_what_stands_out_by_six_millimetres_shades_what_is_beside_it(step, shaded):
    faces, camera, seen = seen_from_front(blocks(step, finishes=(finish(), finish())))
    clear = np.zeros(seen.shape, dtype=bool)
    assert (~picture_colors._find_open(faces, seen, clear, camera)[seen >= 0]).any() == shaded


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
    shape = draw_shape("StorageFurniture", 1)
    moving = [part.name for part in shape.parts if part.motion is not None]
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
