"""Cameras and colours by a picture: a shape's own pictures give back what they were made of."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import torch
from jaxtyping import Float

from artigen.camera import Camera
from artigen.examples.photographs import draw_camera, photograph_shape
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import box, move, place_vertices
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.sketch import picture_colors
from artigen.sketch.alignment import Fit, View, find_hull, fit_camera, place_camera
from artigen.sketch.overlay import (
    SIDES,
    Faces,
    PictureError,
    find_visible,
    list_faces,
    measure_edges,
    read_target,
)
from artigen.sketch.picture_colors import SMALL, read_colors

SIZE = 128
CABINET, FRIDGE = ("StorageFurniture", 4), ("Refrigerator", 1)


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(threads)


def photograph(shape: Shape, seed: int) -> Float[np.ndarray, "4 S S"]:
    return photograph_shape(shape, seed, SIZE).transpose(2, 0, 1).astype(np.float32) / 255.0


def true_yaw(shape: Shape, seed: int) -> float:
    """Turn of the camera of a photograph, as it is seen from the middle of the object."""
    points = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
    way = draw_camera(points, seed, SIZE).position - shape.bounds().mean(axis=0)
    return float(np.arctan2(way[1], -way[0]))


def dye(faces: Faces, seen: np.ndarray, colors: np.ndarray) -> Float[np.ndarray, "4 S S"]:
    """A picture without light: each pixel has the colour of its finish."""
    mask = (seen >= 0).astype(np.float32)
    rgb = colors[faces.roles[seen]] * mask[..., None]
    return np.concatenate([rgb, mask[..., None]], axis=2).transpose(2, 0, 1).astype(np.float32)


def stand(shape: Shape, view: View) -> tuple[Faces, Camera]:
    """The camera of a view that fills a picture."""
    blank = np.zeros((4, SIZE, SIZE), dtype=np.float32)
    blank[3, 12:116, 24:104] = 1.0
    faces = list_faces(shape)
    return faces, place_camera(view, find_hull(faces.vertices), read_target(blank, SIZE))


def flatten(shape: Shape) -> Shape:
    """The shape with finishes that have no pattern and differ from each other."""
    rng = np.random.default_rng(0)
    finishes = []
    for role, finish in shape.finishes:
        r, g, b = rng.uniform(0.2, 0.9, 3).tolist()
        finishes.append((role, Finish(kind="glass", color=(r, g, b), accent=(r, g, b), gloss=finish.gloss)))
    return replace(shape, finishes=tuple(finishes))


def hide_colors(shape: Shape) -> Shape:
    """The shape with bluish finishes, each a little different."""
    finishes = []
    for index, (role, finish) in enumerate(shape.finishes):
        color = (0.2 + 0.03 * index, 0.4, 0.6)
        finishes.append((role, replace(finish, color=color, accent=color) if finish.opacity == 1 else finish))
    return replace(shape, finishes=tuple(finishes))


def odd_object(mirrored: bool = False) -> Shape:  # noqa: FBT001, FBT002 - the two objects there are
    """A block with a tower on its left, and a red drawer on the right."""
    side = -1.0 if mirrored else 1.0

    def part(name: str, y: tuple[float, float], z: tuple[float, float], finish: str) -> ShapePart:
        low, high = sorted((side * y[0], side * y[1]))
        front = -0.22 if finish == "front" else -0.2
        solid = box((front, low, z[0]), (-0.2 if finish == "front" else 0.2, high, z[1]), finish)
        return ShapePart(
            name=name,
            label="drawer" if finish == "front" else "base",
            parent=None if name == "body" else "body",
            primitives=(solid,),
        )

    return Shape(
        category="Test",
        seed=0,
        style="",
        parts=(
            part("body", (-0.4, 0.4), (0.0, 0.4), "body"),
            part("tower", (0.1, 0.4), (0.4, 0.9), "body"),
            part("front", (-0.35, -0.05), (0.05, 0.35), "front"),
        ),
        finishes=(
            ("body", plain((0.8, 0.8, 0.75))),
            ("front", plain((0.7, 0.2, 0.15))),
            ("top", plain((0.8, 0.8, 0.75))),
            ("inside", plain((0.3, 0.6, 0.3))),
        ),
    )


def plain(color: Color) -> Finish:
    return Finish(kind="lacquer", color=color, accent=(color[0] / 2, color[1] / 2, color[2] / 2), period=0.4)


@pytest.mark.parametrize(("category", "seed"), [CABINET, FRIDGE, ("Oven", 2), ("Table", 2)])
def test_own_picture_gives_back_silhouette_and_yaw(category: str, seed: int):
    shape = draw_shape(category, seed)
    fit = fit_camera(shape, photograph(shape, seed + 3))
    assert fit.overlap > 0.95
    assert abs(fit.view.yaw - true_yaw(shape, seed + 3)) < np.radians(4.0)


@pytest.mark.parametrize("yaw", [-50.0, 0.0, 35.0])
def test_wide_turns_are_found(yaw: float):
    shape = flatten(draw_shape(*FRIDGE))
    view = View(yaw=float(np.radians(yaw)), pitch=float(np.radians(30.0)), closeness=0.3)
    faces, camera = stand(shape, view)
    colors = np.array([finish.color for _, finish in shape.finishes])
    fit = fit_camera(shape, dye(faces, find_visible(faces, camera), colors))
    assert fit.overlap > 0.94
    assert abs(fit.view.yaw - view.yaw) < np.radians(3.0)
    assert abs(fit.view.pitch - view.pitch) < np.radians(6.0)


def test_place_in_the_picture_does_not_matter():
    shape = draw_shape(*CABINET)
    picture = photograph(shape, 1)
    wide = np.zeros((4, 2 * SIZE, 2 * SIZE), dtype=np.float32)
    wide[:, 100 : 100 + SIZE, 20 : 20 + SIZE] = picture
    here, there = fit_camera(shape, picture), fit_camera(shape, wide)
    assert there.overlap > 0.95
    assert abs(here.view.yaw - there.view.yaw) < np.radians(4.0)


def test_a_view_that_is_about_right_is_made_exact():
    shape, view = draw_shape(*CABINET), View(yaw=0.5, pitch=0.3, closeness=0.22)
    faces, camera = stand(shape, view)
    colors = np.array([finish.color for _, finish in shape.finishes])
    picture = dye(faces, find_visible(faces, camera), colors)
    fit = fit_camera(shape, picture, replace(view, yaw=0.42, pitch=0.25, closeness=0.28))
    assert fit.overlap > 0.97
    assert abs(fit.view.yaw - view.yaw) < np.radians(2.0)
    assert abs(fit.view.pitch - view.pitch) < np.radians(2.0)


def test_a_picture_that_shows_nothing_is_refused_with_advice():
    with pytest.raises(PictureError, match="cut the object out"):
        fit_camera(odd_object(), np.zeros((4, SIZE, SIZE), dtype=np.float32))


def test_edges_tell_fronts_apart_where_silhouettes_do_not():
    shape = odd_object()
    body, tower, front = shape.parts
    lifted = replace(front, primitives=(move(front.primitives[0], (0.0, 0.3, 0.0)),))
    other = replace(shape, parts=(body, tower, lifted))
    picture = photograph(shape, 4)
    own, wrong = fit_camera(shape, picture), fit_camera(other, picture)
    assert abs(own.overlap - wrong.overlap) < 0.05
    target = read_target(picture, SIZE)
    edges = [
        measure_edges(list_faces(drawn), find_visible(list_faces(drawn), fit.camera), target)
        for drawn, fit in ((shape, own), (other, wrong))
    ]
    assert edges[0] > edges[1] + 0.1


@pytest.mark.parametrize(("category", "seed"), [CABINET, FRIDGE, ("Table", 2)])
def test_colours_without_light_are_read_exactly(category: str, seed: int, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(
        picture_colors, "_light", lambda _, points, __: (np.ones(len(points)), np.zeros(len(points)))
    )
    monkeypatch.setattr(picture_colors, "find_brightness", lambda *_: np.zeros(SIDES))
    shape = flatten(draw_shape(category, seed))
    view = View(yaw=0.5, pitch=0.3, closeness=0.22)
    faces, camera = stand(shape, view)
    truth = np.array([finish.color for _, finish in shape.finishes])
    seen = find_visible(faces, camera)
    shown = np.bincount(faces.roles[seen[seen >= 0]], minlength=len(truth)) > 100
    thin = np.array([role in SMALL for role, _ in shape.finishes])
    fit = Fit(view=view, camera=camera, overlap=1.0)
    hidden = hide_colors(shape)
    read = read_colors(hidden, dye(faces, seen, truth), fit)
    found = np.array([finish.color for _, finish in read.finishes])
    assert (shown & ~thin).any()
    np.testing.assert_allclose(found[shown & ~thin], truth[shown & ~thin], atol=1e-3)
    np.testing.assert_array_equal(found[thin], [finish.color for r, finish in hidden.finishes if r in SMALL])


def test_colours_that_are_asked_for_are_kept():
    shape = draw_shape(*CABINET)
    picture = photograph(shape, 2)
    read = read_colors(hide_colors(shape), picture, fit_camera(shape, picture), keep=("front",))
    assert dict(read.finishes)["front"] == dict(hide_colors(shape).finishes)["front"]
    assert dict(read.finishes)["body"] != dict(hide_colors(shape).finishes)["body"]


def test_colours_of_a_photograph_are_read_through_light_and_shadow():
    shape = draw_shape(*CABINET)
    picture = photograph(shape, 2)
    finishes = dict(shape.finishes)
    hidden = hide_colors(shape)
    read = dict(read_colors(hidden, picture, fit_camera(hidden, picture)).finishes)
    for role in ("front", "body"):
        assert np.abs(np.array(read[role].color) - finishes[role].color).mean() < 0.04


def test_what_is_not_seen_keeps_its_colour_or_follows_its_equal():
    shape = odd_object()
    picture = photograph(replace(shape, finishes=(("body", plain((0.2, 0.3, 0.5))), *shape.finishes[1:])), 1)
    drawn = dict(shape.finishes)
    read = dict(read_colors(shape, picture, fit_camera(shape, picture)).finishes)
    assert read["inside"] == drawn["inside"]
    assert read["top"].color == read["body"].color != drawn["body"].color
    np.testing.assert_allclose(np.array(read["body"].accent) / read["body"].color, 0.5, atol=1e-6)


def test_the_same_picture_gives_the_same_colours():
    shape = draw_shape(*FRIDGE)
    picture = photograph(shape, 1)
    first, again = (read_colors(shape, picture, fit_camera(shape, picture)) for _ in range(2))
    assert first.finishes == again.finishes


def test_a_picture_beside_the_shape_changes_no_colour():
    shape = odd_object()
    view = View(yaw=0.2, pitch=0.1, closeness=0.22)
    _, camera = stand(shape, view)
    picture = np.zeros((4, SIZE, SIZE), dtype=np.float32)
    picture[:, :4, :4] = 1.0
    read = read_colors(shape, picture, Fit(view=view, camera=camera, overlap=0.0))
    assert read.finishes == shape.finishes
