"""Targets and what is decoded from them: inverse to each other, and mirrored alike."""

import numpy as np
import pytest
import torch
from reader_samples import SIZE, kitchen, make_picture, to_maps

from artigen.reader.decode import AROUND, Found, find_things, mirror_maps
from artigen.reader.labels import FRONT, HINGES, OBJECT, PULL, THINGS
from artigen.reader.network import STRIDE, Maps
from artigen.reader.targets import Picture, make_batch, make_mark

HALF = 0.51
"""Half a pixel: a thing's sides are at least this far from the middle of its cell."""


def sort_boxes(found: Found) -> np.ndarray:
    return found.box[np.lexsort(found.box.T)]


def test_decoding_inverts_targets():
    picture = kitchen()
    things = find_things(to_maps(make_batch([picture])))[0]
    for thing in (FRONT, PULL, OBJECT):
        true = picture.marks[picture.marks["thing"] == thing]["box"]
        np.testing.assert_allclose(sort_boxes(things[thing]), true[np.lexsort(true.T)], atol=HALF)
    fronts = things[FRONT]
    left = int(np.argmin(np.abs(fronts.box - [20, 50, 60, 110]).sum(axis=1)))
    np.testing.assert_allclose(fronts.corners[left], picture.marks[0]["corners"], atol=0.02)
    assert HINGES[int(fronts.attributes["hinge"][left].argmax())] == "left"
    assert fronts.attributes["pane"][left, 0] > 0 > fronts.attributes["open"][left, 0]
    assert int(things[OBJECT].attributes["kind"][0].argmax()) == 7


@pytest.mark.parametrize(("reach", "counted"), [(5.2, True), (4.8, False)])
def test_a_box_is_the_mean_of_those_around_its_peak(reach: float, *, counted: bool):
    """A cell five away from the peak counts from a box whose twentieth reaches it."""
    picture = make_picture([make_mark(FRONT, np.array([10, 10, 110, 110]), door=1)])
    maps = to_maps(make_batch([picture]))
    column = int(maps.heat[0, FRONT].max(dim=0).values.argmax())
    row = int(maps.heat[0, FRONT].max(dim=1).values.argmax())
    sides = maps.attributes["box"].unflatten(1, (len(THINGS), 4))[0, FRONT]
    extent = reach * STRIDE / AROUND / 2
    for cell in range(edge_of(maps)):
        here = (cell - column) * STRIDE
        sides[0, row, cell] = np.log(max(extent + here, 0.5))
        sides[2, row, cell] = np.log(max(extent - here, 0.5))
    before = find_things(maps)[0][FRONT].box[0]
    maps.heat[0, FRONT, row, column + 5] = 5.9
    sides[2, row, column + 5] += 0.5
    after = find_things(maps)[0][FRONT].box[0]
    assert bool(after[2] > before[2] + 1.0) == counted


def edge_of(maps: Maps) -> int:
    return maps.heat.shape[-1]


def mirror(picture: Picture) -> Picture:
    marks = picture.marks.copy()
    marks["box"][:, [0, 2]] = SIZE - picture.marks["box"][:, [2, 0]]
    marks["corners"][:, :, 0] = SIZE - picture.marks["corners"][:, :, 0]
    marks["corners"] = marks["corners"][:, [1, 0, 3, 2]]
    sides = (HINGES.index("left"), HINGES.index("right"))
    marks["hinge"] = np.where(np.isin(marks["hinge"], sides), sum(sides) - marks["hinge"], marks["hinge"])
    marks["view"][:, 0] *= -1
    return Picture(pixels=picture.pixels[:, ::-1], marks=marks, weight=picture.weight[:, :, ::-1])


def test_maps_of_a_mirrored_picture_mirror_back():
    picture = kitchen()
    one = find_things(to_maps(make_batch([picture])))[0]
    other = find_things(mirror_maps(to_maps(make_batch([mirror(picture)]))))[0]
    for thing in (FRONT, PULL, OBJECT):
        order, same = (np.lexsort(np.round(f[thing].box).T) for f in (one, other))
        np.testing.assert_allclose(other[thing].box[same], one[thing].box[order], atol=HALF)
        for name in ("hinge", "door", "view"):
            np.testing.assert_allclose(
                other[thing].attributes[name][same], one[thing].attributes[name][order], atol=1e-5
            )
    glazed = [int(np.argmax(f[FRONT].attributes["pane"][:, 0])) for f in (one, other)]
    np.testing.assert_allclose(other[FRONT].corners[glazed[1]], one[FRONT].corners[glazed[0]], atol=0.02)


def test_mirroring_twice_changes_nothing():
    maps = to_maps(make_batch([kitchen()]))
    again = mirror_maps(mirror_maps(maps))
    torch.testing.assert_close(again.heat, maps.heat)
    for name, values in maps.attributes.items():
        torch.testing.assert_close(again.attributes[name], values)


def test_a_thing_of_unknown_extent_teaches_no_box():
    mark = make_mark(OBJECT, np.array([20, 20, 80, 80]), kind=2, sized=0)
    batch = make_batch([make_picture([mark])])
    assert len(batch.place) > 0
    assert torch.isnan(batch.box).all()
    assert (batch.kind == 2).all()
    assert batch.heat[0, OBJECT].max() == 1
