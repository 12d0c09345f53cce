"""The colour of handles is that of the thin things in cells labelled as handles, whatever is behind them."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from artigen.camera import frame_points
from artigen.examples.sketch_photos import NOTHING
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import place_vertices
from artigen.shapes.render import RenderConfig, batch_cameras, build_scene, render
from artigen.sketch.handle_color import read_handle
from artigen.sketch.picture import CELL
from artigen.sketch.picture_colors import find_handle
from artigen.types import PART_LABELS

HANDLE, DOOR = PART_LABELS.index("handle"), PART_LABELS.index("door")
CELLS = 16
COLOR = np.array([0.7, 0.1, 0.3])


def make_picture(cells: list[tuple[int, int]], behind: np.ndarray, width: int = CELL // 2):
    """A plain front with a bar of so many rows in each of some cells, and the labels of all cells."""
    picture = np.ones((4, CELL * CELLS, CELL * CELLS), dtype=np.float32)
    picture[:3] = behind[:, None, None]
    chances = np.zeros((len(PART_LABELS), CELLS, CELLS), dtype=np.float32)
    chances[DOOR] = 1.0
    for row, column in cells:
        here = slice(CELL * row + 1, CELL * row + 1 + width), slice(CELL * column, CELL * column + CELL)
        picture[(slice(0, 3), *here)] = COLOR[:, None, None]
        chances[:, row, column] = 0.0
        chances[HANDLE, row, column] = 1.0
    return picture, chances


ROW = [(5, column) for column in range(4, 9)]


@pytest.mark.parametrize("behind", [np.array([0.9, 0.9, 0.9]), np.array([0.05, 0.2, 0.1])])
def test_a_bar_of_half_a_cell_is_read_exactly(behind: np.ndarray):
    found = read_handle(*make_picture(ROW, behind))
    assert found is not None
    np.testing.assert_allclose(found, COLOR, atol=1e-6)


def test_transparent_surroundings_are_not_the_front():
    """A premultiplied picture stores black where there is nothing."""
    picture, chances = make_picture(ROW, np.array([0.6, 0.6, 0.6]))
    picture[:, : CELL * 5] = 0.0
    found = read_handle(picture, chances)
    assert found is not None
    np.testing.assert_allclose(found, COLOR, atol=1e-6)


def test_it_takes_several_cells():
    behind = np.array([0.5, 0.5, 0.5])
    assert read_handle(*make_picture(ROW[:1], behind)) is None
    assert read_handle(*make_picture(ROW[:2], behind)) is not None


@pytest.mark.parametrize(("chance", "shown"), [(0.49, False), (0.51, True)])
def test_cells_count_from_a_probability_on(chance: float, *, shown: bool):
    picture, chances = make_picture(ROW, np.array([0.5, 0.5, 0.5]))
    chances[HANDLE] *= chance
    assert (read_handle(picture, chances) is not None) == shown


@pytest.mark.parametrize(("chance", "enough"), [(0.19, True), (0.21, False)])
def test_surroundings_are_what_is_hardly_a_handle(chance: float, *, enough: bool):
    picture, chances = make_picture(ROW, np.array([0.5, 0.5, 0.5]))
    chances[HANDLE] = np.maximum(chances[HANDLE], chance)
    assert (read_handle(picture, chances) is not None) == enough


@pytest.mark.parametrize(("pixels", "enough"), [(7, False), (8, True)])
def test_cells_need_enough_opaque_pixels(pixels: int, *, enough: bool):
    picture, chances = make_picture(ROW, np.array([0.5, 0.5, 0.5]))
    alpha = np.arange(CELL * CELL).reshape(CELL, CELL) < pixels
    for row, column in ROW:
        here = slice(CELL * row, CELL * row + CELL), slice(CELL * column, CELL * column + CELL)
        picture[(slice(None), *here)] *= alpha
    assert (read_handle(picture, chances) is not None) == enough


def test_handles_of_a_rendered_cabinet_are_red():
    shape = draw_shape("StorageFurniture", 3)
    red = {"handle": (0.8, 0.1, 0.1)}
    finishes = tuple(
        (role, replace(finish, color=red.get(role, finish.color), accent=red.get(role, finish.accent)))
        for role, finish in shape.finishes
    )
    shape = replace(shape, finishes=finishes)
    points = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
    camera = batch_cameras([frame_points(points, (-1.0, 0.3, 0.3), width=256, height=256)])
    still = [np.zeros(len(shape.parts))]
    seen = render(build_scene([shape]), camera, still, cfg=RenderConfig(shadow_rays=0, openness=False))
    mask = seen.mask[0].numpy()
    names = np.array([PART_LABELS.index(part.label) for part in shape.parts])
    labels = np.where(mask, names[seen.part_ids[0].numpy()], NOTHING)[CELL // 2 :: CELL, CELL // 2 :: CELL]
    chances = torch.nn.functional.one_hot(torch.from_numpy(labels), NOTHING + 1).permute(2, 0, 1).numpy()
    picture = np.concatenate([seen.rgb[0].permute(2, 0, 1).numpy() * mask, mask[None]]).astype(np.float32)
    found = read_handle(picture, chances.astype(np.float32))
    assert found is not None
    assert found[0] > 3 * max(found[1:])


@pytest.mark.parametrize(("role", "found"), [("handle", True), ("accent", True), ("body", False)])
def test_the_small_finish_of_most_handles_is_read(role: str, *, found: bool):
    """Whatever role the handles have, unless large surfaces have it too: those are read off the surfaces."""
    shape = draw_shape("StorageFurniture", 3)
    finish = dict(shape.finishes)["handle"]
    parts = tuple(
        replace(part, primitives=tuple(replace(one, finish=role) for one in part.primitives))
        if part.label == "handle"
        else part
        for part in shape.parts
    )
    finishes = tuple((name, one) for name, one in shape.finishes if name != role)
    own = dict(shape.finishes)["body"] if role == "body" else finish
    assert (find_handle(replace(shape, parts=parts, finishes=(*finishes, (role, own)))) == role) == found
