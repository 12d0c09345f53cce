"""Faces are painted in figures: blobs become rectangles or discs, islands go, and what is a figure stays."""

import numpy as np
import pytest

from artigen.figures import (
    LEAST,
    SHARE,
    draw_ellipse,
    draw_figures,
    find_edges,
    number_faces,
    settle_figures,
)

EDGE = 8


def be_sure(classes: np.ndarray, count: int, sure: float = 0.9) -> np.ndarray:
    """Chances of cells that are sure of their class."""
    rest = (1.0 - sure) / (count - 1)
    return np.where(np.arange(count)[:, None, None] == classes, sure, rest)


def test_edges_join_what_touches_and_is_alike():
    coords = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [3, 0, 0], [7, 7, 7], [7, 7, 6]])
    alike = np.zeros(6, dtype=int)
    assert find_edges(coords, alike, alike, EDGE).tolist() == [[0, 1], [1, 2], [5, 4]]
    assert find_edges(coords, np.array([0, 0, 1, 0, 0, 0]), alike, EDGE).tolist() == [[0, 1], [5, 4]]
    assert find_edges(coords, alike, np.array([0, 1, 1, 0, 0, 5]), EDGE).tolist() == [[1, 2]]
    faces = number_faces(6, find_edges(coords, alike, alike, EDGE))
    assert (faces[:, None] == faces).sum() == 3 * 3 + 1 + 2 * 2


def test_figures_stay_as_they_are():
    classes = np.zeros((40, 30), dtype=int)
    classes[5:20, 4:26] = 1  # a window, a display in its frame, a trim
    classes[8:12, 10:18] = 2
    classes[35:37] = 1
    drawn = draw_figures(be_sure(classes, 3), np.ones((40, 30), dtype=bool))
    np.testing.assert_array_equal(drawn, classes)


def test_a_blob_becomes_its_rectangle_and_islands_go():
    rng = np.random.default_rng(0)
    wanted = np.zeros((40, 30), dtype=int)
    wanted[6:30, 5:25] = 1
    blob = wanted.copy()
    for corner in ((6, 5), (6, 23), (28, 5), (28, 23)):
        blob[corner[0] : corner[0] + 2, corner[1] : corner[1] + 2] = 0
    blob[34:36, 3] = 1
    blob = np.where(rng.random(blob.shape) < 0.05, 1 - blob, blob)
    face = np.ones(blob.shape, dtype=bool)
    drawn = draw_figures(be_sure(blob, 2), face)
    np.testing.assert_array_equal(drawn, wanted)
    np.testing.assert_array_equal(draw_figures(be_sure(blob.T, 2), face.T), wanted.T)
    turned = draw_figures(be_sure(1 - blob, 2), face)  # the other class is the background
    assert (turned[wanted == 1] == 0).all()


def test_figures_of_a_round_face_are_discs():
    face, wanted = draw_ellipse(30, 30), np.zeros((30, 30), dtype=int)
    wanted[6:24, 6:24] = draw_ellipse(18, 18)
    ragged = wanted.copy()
    ragged[6:8, 13:15] = ragged[12:14, 14:16] = 0
    ragged[6, 12] = 1
    drawn = draw_figures(be_sure(ragged, 2), face)
    np.testing.assert_array_equal(drawn[face], wanted[face])


@pytest.mark.parametrize(("edge", "size"), [(12, 3), (12, 5), (40, 5), (40, 40)])
def test_what_is_too_small_or_too_little_of_its_face_is_no_figure(edge: int, size: int):
    classes = np.zeros((edge, edge), dtype=int)
    classes[edge // 2, :size] = 1
    drawn = draw_figures(be_sure(classes, 2, sure=1.0), np.ones(classes.shape, dtype=bool))
    stays = size >= max(LEAST, SHARE * edge**2)
    np.testing.assert_array_equal(drawn, classes if stays else 0 * classes)


@pytest.mark.parametrize(
    ("across", "up", "stays"),
    [
        ((8, 32), (4, 26), True),
        ((10, 36), (4, 26), True),
        ((24, 40), (0, 14), False),
        ((28, 38), (8, 20), False),
        ((32, 38), (20, 26), True),
        ((34, 40), (4, 28), True),
        ((2, 38), (24, 30), True),
    ],
)
def test_where_figures_are_centred_only_strips_and_small_ones_lie_aside(
    across: tuple[int, int], up: tuple[int, int], *, stays: bool
):
    classes = np.zeros((40, 30), dtype=int)
    classes[slice(*across), slice(*up)] = 1
    face = np.ones(classes.shape, dtype=bool)
    np.testing.assert_array_equal(draw_figures(be_sure(classes, 2), face), classes)
    drawn = draw_figures(be_sure(classes, 2), face, centred=True)
    np.testing.assert_array_equal(drawn, classes if stays else 0 * classes)


def test_a_bitten_corner_of_a_centred_figure_is_whole_again_and_a_frame_is_not_filled():
    face, bitten = np.ones((40, 30), dtype=bool), np.zeros((40, 30), dtype=int)
    bitten[6:34, 4:26] = 1
    whole = bitten.copy()
    bitten[6:15, 4:11] = 0
    np.testing.assert_array_equal(draw_figures(be_sure(bitten, 2), face), bitten)
    np.testing.assert_array_equal(draw_figures(be_sure(bitten, 2), face, centred=True), whole)
    frame = whole.copy()
    frame[10:30, 8:22] = 0
    np.testing.assert_array_equal(draw_figures(be_sure(frame, 2), face, centred=True), frame)


def test_every_face_is_settled_by_itself_and_along_the_axis_that_it_faces():
    y, z = (values.ravel() for values in np.meshgrid(np.arange(EDGE), np.arange(EDGE), indexing="ij"))
    window = (np.abs(y - 3.5) < 3) & (np.abs(z - 3.5) < 3)
    layers = [np.stack([np.full_like(y, x), y, z], axis=1) for x in (0, 1)]  # a board two cells thick
    other = np.stack([y, z, np.full_like(y, 7)], axis=1) + np.array(
        [20, 0, 0]
    )  # faces up, and is of the other class
    coords = np.concatenate([*layers, other])
    facings = np.repeat([0, 0, 5], len(y))
    classes = np.concatenate([window, window, np.ones_like(window)]).astype(int)
    flipped, anywhere = classes.copy(), np.zeros(len(coords), dtype=bool)
    flipped[np.flatnonzero(window)[:2]] = 0  # the layer below knows better
    faces = number_faces(len(coords), find_edges(coords, np.zeros(len(coords), dtype=int), facings, 64))
    settled = settle_figures(np.eye(2)[flipped], coords, facings, faces, anywhere)
    np.testing.assert_array_equal(settled, classes)
    order = np.random.default_rng(2).permutation(len(coords))
    np.testing.assert_array_equal(
        settle_figures(np.eye(2)[flipped[order]], coords[order], facings[order], faces[order], anywhere),
        classes[order],
    )
