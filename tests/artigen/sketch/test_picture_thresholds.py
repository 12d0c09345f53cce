"""Both sides of the limits of what pictures say about cameras and colours."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.camera import project_points
from artigen.shapes.primitives import box, place_vertices
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.sketch import alignment, picture_colors
from artigen.sketch.alignment import Fit, View, find_hull, place_camera
from artigen.sketch.handle_color import read_handle
from artigen.sketch.overlay import SIDES, find_lines, find_visible, list_faces, measure_evenness, read_target
from artigen.sketch.picture_colors import Spots, find_brightness, find_spots, read_colors
from artigen.splats.colors import linear_from_srgb
from artigen.types import PART_LABELS


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
    camera = place_camera(View(yaw=0.4, pitch=0.2, closeness=0.2), points, target)
    plane = project_points(camera, points)[:, :2]
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
    shape = blocks()
    _, camera, seen = seen_from_front(shape)
    picture = np.where(seen >= 0, opaque, 0.0)[None].repeat(4, axis=0)
    assert (len(find_spots(shape, picture, camera).roles) > 0) == counts


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
    shape = blocks(finishes=(finish(), finish(), finish()))
    grip = ShapePart(
        name="grip", label="handle", parent="body", primitives=(box((-0.05, 0, 0), (0, 0.1, 0.1), "handle"),)
    )
    shape = replace(shape, parts=(*shape.parts, grip), finishes=(("body", finish()), ("handle", finish())))
    shown = spots({(0, 0): 100, (0, 1): 100, (0, 2): 100})
    show_evenly(monkeypatch, replace(shown, bright=np.where(shown.sides == 1, 0.5, 1.0)))
    _, camera, _ = seen_from_front(shape)
    fit = Fit(view=View(yaw=0, pitch=0, closeness=0.1), camera=camera, overlap=1)
    picture, chances = bar()
    found = dict(read_colors(shape, picture, fit, labels=chances).finishes)["handle"]
    half = linear_from_srgb(np.array(found.color)) / linear_from_srgb(np.array([0.7, 0.1, 0.3]))
    assert half[1:] == pytest.approx(2.0)  # red would be more than there is
