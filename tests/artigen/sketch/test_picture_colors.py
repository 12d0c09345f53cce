"""Colours by a picture: a shape's own pictures give back what they were made of, and both sides of limits."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import torch
from jaxtyping import Float

from artigen.camera import project_points
from artigen.examples.photographs import draw_camera, photograph_shape
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import box, place_vertices
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.sketch import picture_colors
from artigen.sketch.handle_color import read_handle
from artigen.sketch.overlay import Faces, PictureError, View, find_visible, list_faces, place_camera
from artigen.sketch.picture_colors import SMALL, Spots, find_spots, read_colors
from artigen.splats.colors import linear_from_srgb
from artigen.types import PART_LABELS

SIZE = 128
CABINET, FRIDGE = ("StorageFurniture", 4), ("Refrigerator", 1)
AHEAD = View(0.0, 0.0, 0.1)
"""From the front."""


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(threads)


def photograph(shape: Shape, seed: int) -> tuple[Float[np.ndarray, "4 S S"], View]:
    """A photograph and its view."""
    picture = photograph_shape(shape, seed, SIZE).transpose(2, 0, 1).astype(np.float32) / 255.0
    points = list_faces(shape).vertices
    low, high = points.min(axis=0), points.max(axis=0)
    way = draw_camera(points, seed, SIZE).position - (low + high) / 2
    far = float(np.linalg.norm(way))
    yaw, pitch = float(np.arctan2(way[1], -way[0])), float(np.arcsin(way[2] / far))
    return picture, View(yaw, pitch, float(np.linalg.norm(high - low)) / 2 / far)


def frame() -> Float[np.ndarray, "S S"]:
    """Alpha that is 1 in a box."""
    alpha = np.zeros((SIZE, SIZE), dtype=np.float32)
    alpha[12:116, 24:104] = 1.0
    return alpha


def dye(faces: Faces, view: View, colors: np.ndarray) -> Float[np.ndarray, "4 S S"]:
    """A picture without light: each pixel has the colour of its finish."""
    seen = find_visible(faces, place_camera(view, faces.vertices, frame()))
    picture = np.zeros((4, SIZE * SIZE), dtype=np.float32)
    picture[:3, seen.pixel] = colors[faces.roles[seen.face]].T
    picture[3, seen.pixel] = 1.0
    return picture.reshape(4, SIZE, SIZE)


def finish(level: float = 0.5, opacity: float = 1.0) -> Finish:
    color = (level, level, level)
    return Finish(kind="lacquer", color=color, accent=color, gloss=0.0, opacity=opacity)


def block(*finishes: Finish) -> Shape:
    solid = box((0.0, 0.0, 0.0), (0.5, 1.0, 1.0), "body")
    return Shape(
        category="Test",
        seed=0,
        style="",
        parts=(ShapePart(name="body", label="base", parent=None, primitives=(solid,)),),
        finishes=tuple(zip(("body", "front", "top"), finishes or (finish(),), strict=False)),
    )


def flatten(shape: Shape) -> Shape:
    """The shape with finishes that have no pattern and differ from each other."""
    rng = np.random.default_rng(0)
    finishes = []
    for role, one in shape.finishes:
        r, g, b = rng.uniform(0.2, 0.9, 3).tolist()
        finishes.append((role, Finish(kind="glass", color=(r, g, b), accent=(r, g, b), gloss=one.gloss)))
    return replace(shape, finishes=tuple(finishes))


def hide_colors(shape: Shape) -> Shape:
    """The shape with bluish finishes, each a little different."""
    finishes = []
    for index, (role, one) in enumerate(shape.finishes):
        color = (0.2 + 0.03 * index, 0.4, 0.6)
        finishes.append((role, replace(one, color=color, accent=color) if one.opacity == 1 else one))
    return replace(shape, finishes=tuple(finishes))


@pytest.mark.parametrize("closeness", [0.2, 0.0, 5.0])
def test_a_view_fills_the_box_of_the_picture(closeness: float):
    """However near it is said to be: from 0.04 to 0.55."""
    alpha = np.zeros((64, 64))
    alpha[10:40, 20:60] = 1.0
    points = place_vertices(block().parts[0].primitives[0])
    camera = place_camera(View(0.4, 0.2, closeness), points, alpha)
    plane = project_points(camera, points)[:, :2]
    low, high = plane.min(axis=0), plane.max(axis=0)
    np.testing.assert_allclose((low + high) / 2, [40.0, 25.0], atol=1e-9)
    assert np.prod(high - low) == pytest.approx(30.0 * 40.0)
    far = np.linalg.norm(camera.position - points.mean(axis=0))
    assert far == pytest.approx(0.75 / np.clip(closeness, 0.04, 0.55))


@pytest.mark.parametrize(("category", "seed"), [CABINET, FRIDGE, ("Oven", 2), ("Table", 2)])
def test_a_shape_lies_over_its_own_picture(category: str, seed: int):
    shape = draw_shape(category, seed)
    picture, view = photograph(shape, seed + 3)
    faces = list_faces(shape)
    mask = np.zeros(SIZE * SIZE, dtype=bool)
    mask[find_visible(faces, place_camera(view, faces.vertices, picture[3])).pixel] = True
    truth = (picture[3] > 0.5).ravel()
    assert (mask & truth).sum() / (mask | truth).sum() > 0.95


def test_a_picture_that_shows_nothing_is_refused_with_advice():
    with pytest.raises(PictureError, match="cut the object out"):
        read_colors(block(), np.zeros((4, SIZE, SIZE), dtype=np.float32), AHEAD)


@pytest.mark.parametrize(("category", "seed"), [CABINET, FRIDGE, ("Table", 2)])
def test_colours_without_light_are_read_exactly(category: str, seed: int, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(
        picture_colors, "_light", lambda _, points, __: (np.ones(len(points)), np.zeros(len(points)))
    )
    shape = flatten(draw_shape(category, seed))
    view, faces = View(0.5, 0.3, 0.22), list_faces(shape)
    truth = np.array([one.color for _, one in shape.finishes])
    seen = find_visible(faces, place_camera(view, faces.vertices, frame()))
    shown = np.bincount(faces.roles[seen.face], minlength=len(truth)) > 0.04 * len(seen.face)
    thin = np.array([role in SMALL for role, _ in shape.finishes])
    hidden = hide_colors(shape)
    read = read_colors(hidden, dye(faces, view, truth), view)
    found = np.array([one.color for _, one in read.finishes])
    assert (shown & ~thin).any()
    np.testing.assert_allclose(found[shown & ~thin], truth[shown & ~thin], atol=1e-3)
    np.testing.assert_array_equal(found[thin], [one.color for role, one in hidden.finishes if role in SMALL])


def test_colours_that_are_asked_for_are_kept():
    shape = draw_shape(*CABINET)
    hidden = hide_colors(shape)
    read = read_colors(hidden, *photograph(shape, 2), keep=("front",))
    assert dict(read.finishes)["front"] == dict(hidden.finishes)["front"]
    assert dict(read.finishes)["body"] != dict(hidden.finishes)["body"]


def test_colours_of_a_photograph_are_read_through_light_and_shadow():
    shape = draw_shape(*CABINET)
    finishes = dict(shape.finishes)
    read = dict(read_colors(hide_colors(shape), *photograph(shape, 2)).finishes)
    for role in ("front", "body"):
        assert np.abs(np.array(read[role].color) - finishes[role].color).mean() < 0.04


def test_what_is_not_seen_keeps_its_colour_or_follows_its_equal():
    """Blue finishes equal to that of the body become red with it; the green one inside stays."""
    blue, green = (0.2, 0.3, 0.5), (0.3, 0.6, 0.3)
    equal = replace(finish(), color=blue, accent=(0.1, 0.15, 0.25))
    drawn = block(equal, replace(finish(), color=green), equal)
    picture = dye(list_faces(drawn), AHEAD, np.array([[0.7, 0.2, 0.15]] * 3))
    read = dict(read_colors(drawn, picture, AHEAD).finishes)
    assert read["front"].color == green
    assert read["top"].color == read["body"].color != blue
    np.testing.assert_allclose(np.array(read["body"].accent) / read["body"].color, 0.5, atol=1e-6)


def test_the_same_picture_gives_the_same_colours():
    shape = draw_shape(*FRIDGE)
    picture, view = photograph(shape, 1)
    first, again = (read_colors(hide_colors(shape), picture, view) for _ in range(2))
    assert first.finishes == again.finishes


def test_a_picture_of_a_speck_changes_no_colour():
    shape = draw_shape(*CABINET)
    picture = np.zeros((4, SIZE, SIZE), dtype=np.float32)
    picture[:, :3, :3] = 1.0
    assert read_colors(shape, picture, AHEAD).finishes == shape.finishes


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


def read_shown(
    shape: Shape, shown: Spots, monkeypatch: pytest.MonkeyPatch, labels: np.ndarray | None = None
) -> Shape:
    """Reads colours of a picture that shows the given spots."""
    monkeypatch.setattr(picture_colors, "find_spots", lambda *_: shown)
    picture = bar()[0] if labels is not None else np.zeros((4, 8, 8))
    return read_colors(shape, picture, AHEAD, labels=labels)


def test_a_sixth_of_a_pixel_is_its_own_at_least():
    """However much the room is said to mirror: 15 %."""
    there = replace(spots({(0, 0): 1}, light=0.4), mirrored=np.array([0.39]))
    assert picture_colors._undo_light(there)[0] == pytest.approx([0.15 * 0.4] * 3)


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
    shape = block(finish(opacity=opacity))
    shown = spots({(0, 0): clear + others}, light=1.0)
    shown = replace(shown, clear=np.arange(clear + others) < clear)
    assert (read_shown(shape, shown, monkeypatch).finishes != shape.finishes) == read


def test_lightness_is_that_of_greys_and_chroma_that_of_what_is_not_grey():
    """L* of sRGB grey 0.5 is 53.4, and of primary blue (32.3, 79.2, -107.9) by CIE 15."""
    assert picture_colors._lab(np.full(3, 0.5)) == pytest.approx([53.4, 0.0, 0.0], abs=0.05)
    assert picture_colors._lab(np.array([0.0, 0.0, 1.0])) == pytest.approx([32.3, 79.2, -107.9], abs=0.1)


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
def test_a_drawn_colour_of_nearly_the_pictures_hue_and_lightness_is_kept(monkeypatch, read, agrees):
    shown = replace(spots({(0, 0): 12}), light=np.tile(linear_from_srgb(np.array(read)), (12, 1)))
    found = read_shown(block(finish(0.5)), shown, monkeypatch)
    assert found.finishes[0][1].color == pytest.approx((0.5,) * 3 if agrees else read)


@pytest.mark.parametrize(("apart", "equal"), [(0.019, True), (0.021, False)])
def test_finishes_within_a_fiftieth_are_of_one_colour(apart, equal):
    assert picture_colors._equal(finish(0.5), finish(0.5 + apart)) == equal


def bar(*, opaque: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """A red bar in five cells of a row of a grey picture, and the labels of all cells of 4 x 4 pixels."""
    picture = np.full((4, 64, 64), 0.5)
    picture[:3, 21:23, 16:36] = np.array([0.7, 0.1, 0.3])[:, None, None]
    picture[3] = 1.0
    picture[:, 20:24, 16:36] *= opaque
    chances = np.zeros((len(PART_LABELS), 16, 16))
    chances[PART_LABELS.index("handle"), 5, 4:9] = 1.0
    return picture, chances


@pytest.mark.parametrize(("opaque", "counts"), [(0.96, True), (0.94, False)])
def test_pixels_of_95_percent_opacity_show_the_object_alone(opaque: float, counts: bool):  # noqa: FBT001
    assert (read_handle(*bar(opaque=opaque)) is not None) == counts
    picture = opaque * dye(list_faces(block()), AHEAD, np.full((1, 3), 0.5))
    assert (len(find_spots(block(), picture, AHEAD).roles) > 0) == counts


@pytest.mark.parametrize(("away", "found"), [(2, True), (3, False)])
def test_the_surroundings_of_a_handle_are_two_cells_wide(away: int, found: bool):  # noqa: FBT001
    """Only one other row of cells shows anything."""
    picture, chances = bar()
    shown = np.zeros((16, 16), dtype=bool)
    shown[[5, 5 + away]] = True
    picture *= np.kron(shown, np.ones((4, 4)))
    chances[PART_LABELS.index("knob"), 5] = 0.3
    assert (read_handle(picture, chances) is not None) == found


def test_half_of_the_pixels_of_a_cell_are_taken_for_the_handle():
    """Of 16, in front of grey 0.3, they are four of grey 1, two of 0.9 and two of 0.8."""
    picture, chances = bar()
    picture[:3] = 0.3
    cell = np.repeat([1.0, 0.9, 0.8, 0.5, 0.3], [4, 2, 2, 4, 4]).reshape(4, 4)
    picture[:3, 20:24, 16:36] = np.tile(cell, 5)
    assert read_handle(picture, chances) == pytest.approx([0.95] * 3)


def test_handles_have_the_light_of_the_front(monkeypatch):
    """It has half the light of its neighbours among the sides."""
    grip = ShapePart(
        name="grip", label="handle", parent="body", primitives=(box((-0.05, 0, 0), (0, 0.1, 0.1), "handle"),)
    )
    shape = block()
    shape = replace(shape, parts=(*shape.parts, grip), finishes=(("body", finish()), ("handle", finish())))
    shown = spots({(0, 0): 100, (0, 1): 100, (0, 2): 100})
    shown = replace(shown, bright=np.where(shown.sides == 1, 0.5, 1.0))
    found = dict(read_shown(shape, shown, monkeypatch, bar()[1]).finishes)["handle"]
    half = linear_from_srgb(np.array(found.color)) / linear_from_srgb(np.array([0.7, 0.1, 0.3]))
    assert half[1:] == pytest.approx(2.0)  # red would be more than there is
