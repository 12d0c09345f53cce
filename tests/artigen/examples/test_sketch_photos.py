"""Pictures for training: they show what they say they show, are kept whole, and vary without lying."""

from dataclasses import replace

import numpy as np
import pytest
import torch

import artigen.examples.sketch_photos
from artigen.examples.sketch_photos import (
    EDGE,
    NOTHING,
    Photo,
    PhotoBatch,
    gather_photos,
    pack_photos,
    take_photos,
    unpack_photos,
    vary_photos,
)
from artigen.shapes.draw import draw_shape
from artigen.sketch.overlay import View, find_visible, list_faces, place_camera
from artigen.sketch.picture import CELL
from artigen.types import PART_LABELS

SHAPE = draw_shape("StorageFurniture", 3)


@pytest.fixture(scope="module")
def photos() -> list[Photo]:
    return [take_photos([SHAPE], np.random.default_rng(seed))[0] for seed in range(4)]


@pytest.fixture(scope="module")
def batch(photos: list[Photo]) -> PhotoBatch:
    return gather_photos(unpack_photos(pack_photos(photos)))


def test_what_is_written_is_read_again(photos: list[Photo], batch: PhotoBatch):
    for index, photo in enumerate(photos):
        image = batch.image[index].permute(1, 2, 0).numpy()
        np.testing.assert_array_equal(np.round(255 * image).astype(np.uint8), photo.rgba)
        np.testing.assert_array_equal(batch.labels[index].numpy(), photo.labels)
        spots = batch.given[index].sum()
        assert int(spots) == len(photo.spots)
        np.testing.assert_allclose(batch.centers[index, :spots].numpy(), photo.spots[:, 1:], atol=1e-6)
        np.testing.assert_allclose(batch.view[index].numpy(), photo.view, atol=1e-6)


def test_labels_are_where_the_picture_is_and_spots_on_their_labels(photos: list[Photo]):
    for photo in photos:
        middles = photo.rgba[CELL // 2 :: CELL, CELL // 2 :: CELL, 3] > 0
        np.testing.assert_array_equal(photo.labels != NOTHING, middles)
        assert (np.abs(photo.spots[:, 1:]) < 1.0).all()
        counted = np.bincount(photo.spots[:, 0].astype(int), minlength=NOTHING)
        for label, count in dict(SHAPE.condition.counts).items():
            assert counted[PART_LABELS.index(label)] <= count


def test_the_view_is_that_of_the_camera(monkeypatch: pytest.MonkeyPatch):
    """From the view alone, the closed object covers the picture again."""
    monkeypatch.setattr(artigen.examples.sketch_photos, "OPEN", 0.0)
    faces = list_faces(SHAPE)
    for seed in range(4):
        (photo,) = take_photos([SHAPE], np.random.default_rng(seed))
        alpha = photo.rgba[..., 3] / 255.0
        camera = place_camera(View(*photo.view.tolist()), faces.vertices, alpha)
        shown, seen = (alpha > 0.5).ravel(), np.zeros(EDGE * EDGE, dtype=bool)
        seen[find_visible(faces, camera).pixel] = True
        assert (seen & shown).sum() > 0.97 * (seen | shown).sum()


def test_pictures_vary_and_what_they_show_moves_along(batch: PhotoBatch):
    """A bright spot stays where its part is said to be; whatever is beyond the edge is nothing."""
    marked = torch.zeros_like(batch.image)
    marked[:, 3] = 1.0
    for index in range(len(marked)):
        x, y = ((batch.centers[index, 0] + 1.0) * EDGE / 2).long().tolist()
        marked[index, :3, max(y - 3, 0) : y + 4, max(x - 3, 0) : x + 4] = 1.0
    varied = vary_photos(replace(batch, image=marked), torch.Generator().manual_seed(0))
    again = vary_photos(replace(batch, image=marked), torch.Generator().manual_seed(0))
    other = vary_photos(replace(batch, image=marked), torch.Generator().manual_seed(1))
    assert torch.equal(varied.image, again.image)
    assert not torch.equal(varied.image, other.image)
    assert (varied.image >= 0).all()
    assert (varied.image <= 1).all()
    for index in range(len(marked)):
        x, y = ((varied.centers[index, 0] + 1.0) * EDGE / 2).long().tolist()
        if 4 <= x < EDGE - 4 and 4 <= y < EDGE - 4:
            here = varied.image[index, :3, y - 2 : y + 3, x - 2 : x + 3].mean()
            assert float(here) > float(varied.image[index, :3].mean()) + 0.2
    assert int(varied.labels.min()) >= 0
    assert int(varied.labels.max()) <= NOTHING


def test_photos_taken_together_each_show_their_own_object():
    shapes = [draw_shape(category, 5) for category in ("Laptop", "StorageFurniture", "Safe")]
    for shape, photo in zip(shapes, take_photos(shapes, np.random.default_rng(2)), strict=True):
        own = {PART_LABELS.index(part.label) for part in shape.parts}
        assert set(photo.spots[:, 0].astype(int)) <= own
        assert set(np.unique(photo.labels)) - {NOTHING} <= own
        assert (photo.rgba[..., 3] > 0).any()
