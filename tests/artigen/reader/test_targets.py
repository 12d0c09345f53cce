"""Targets and what is decoded from them: inverse to each other, and mirrored alike."""

import numpy as np
import torch
from reader_samples import SIZE, kitchen, make_picture, to_maps

from artigen.reader.decode import Found, find_things, mirror_maps
from artigen.reader.labels import FRONT, HINGES, OBJECT, PULL
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
    np.testing.assert_allclose(fronts.corners[left], picture.marks[0]["corners"], atol=1e-3)
    assert HINGES[int(fronts.attributes["hinge"][left].argmax())] == "left"
    assert fronts.attributes["pane"][left, 0] > 0 > fronts.attributes["open"][left, 0]
    assert int(things[OBJECT].attributes["kind"][0].argmax()) == 7


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
    np.testing.assert_allclose(other[FRONT].corners[glazed[1]], one[FRONT].corners[glazed[0]], atol=1e-3)


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
