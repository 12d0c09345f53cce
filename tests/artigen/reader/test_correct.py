"""What people say overrules what was read, and changes nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.errors import ArtigenError
from artigen.reader.correct import correct_reading, divide_front
from artigen.reader.layout.build import build_from_reading
from artigen.reader.layout.frontal import read_shape
from artigen.reader.reading import Reading, ReadPart
from artigen.shapes.draw import draw_shape


def read_cabinet() -> Reading:
    """Two doors below three drawers side by side."""
    shape = draw_shape("Dresser", 0)
    parts = [
        *(
            ReadPart(label="drawer", score=0.9 - 0.1 * k, box=np.array([k / 3, 0, (k + 1) / 3, 0.3]))
            for k in range(3)
        ),
        ReadPart(label="door", score=0.6, box=np.array([0, 0.3, 0.5, 1]), hinge="left"),
        ReadPart(label="door", score=0.8, box=np.array([0.5, 0.3, 1, 1]), hinge="right"),
        ReadPart(label="handle", score=0.8, box=np.array([0.45, 0.6, 0.48, 0.7]), form="bar"),
    ]
    return replace(read_shape(shape), kind="StorageFurniture", parts=tuple(parts), extent=(900, 900))


def list_boxes(reading: Reading, label: str) -> list[list[float]]:
    return sorted(part.box.round(3).tolist() for part in reading.fronts if part.label == label)


def test_nothing_said_changes_nothing():
    reading = read_cabinet()
    same = correct_reading(reading, counts={"door": 2, "drawer": 3}, kind=reading.kind, stand=reading.stand)
    assert same.to_json()["fronts"] == reading.to_json()["fronts"]
    assert same.counts == reading.counts


@pytest.mark.parametrize("doors", [0, 1, 2, 3, 4, 7])
@pytest.mark.parametrize("drawers", [0, 1, 3, 4, 6])
def test_counts_are_met_and_the_fronts_stay_where_all_were(doors: int, drawers: int):
    corrected = correct_reading(read_cabinet(), counts={"door": doors, "drawer": drawers})
    assert (corrected.counts["door"], corrected.counts["drawer"]) == (doors, drawers)
    area = sum(float((part.box[2:] - part.box[:2]).prod()) for part in corrected.fronts)
    assert area <= 1.0 + 1e-9
    if doors + drawers >= 5:
        assert area == pytest.approx(1.0)


def test_one_label_said_keeps_the_other():
    reading = read_cabinet()
    more = correct_reading(reading, counts={"drawer": 4})
    assert list_boxes(more, "door") == list_boxes(reading, "door")
    assert more.counts["drawer"] == 4


def test_the_least_sure_front_goes_and_its_neighbour_takes_its_place():
    fewer = correct_reading(read_cabinet(), counts={"drawer": 2})
    np.testing.assert_allclose(
        list_boxes(fewer, "drawer"), [[0, 0, 0.333, 0.3], [0.333, 0, 1, 0.3]], atol=1e-3
    )


def test_a_missing_label_is_taken_from_the_flattest():
    """Drawers that were read as doors."""
    doors = [replace(part, label="door") for part in read_cabinet().fronts]
    corrected = correct_reading(replace(read_cabinet(), parts=tuple(doors)), counts={"drawer": 3})
    assert list_boxes(corrected, "drawer") == list_boxes(read_cabinet(), "drawer")


def test_halves_make_the_whole():
    corners = np.array([(0.1, 0.2), (0.8, 0.1), (0.9, 0.9), (0.0, 0.8)])
    front = ReadPart(label="door", score=1.0, box=np.array([0, 0.1, 0.9, 0.9]), corners=corners)
    for along in ("rows", "columns"):
        first, last = divide_front(front, along)
        assert first.corners is not None
        assert last.corners is not None
        low, high = (0, 2) if along == "columns" else (1, 3)
        assert first.box[high] == last.box[low]
        kept = [0, 3] if along == "columns" else [0, 1]
        np.testing.assert_allclose(first.corners[kept], corners[kept])
    left, right = divide_front(front, "columns")
    assert (left.hinge, right.hinge) == ("left", "right")


def test_hinges_panes_stand_and_bare_fronts():
    said = correct_reading(read_cabinet(), hinge="left", pane=True, stand="wheels", counts={"handle": 0})
    assert {(part.hinge, part.pane) for part in said.fronts if part.label == "door"} == {("left", True)}
    assert said.stand == "wheels"
    assert said.counts["handle"] == 0
    built = read_shape(build_from_reading(said, 1)[0])
    assert [part.hinge for part in built.fronts if part.label == "door"] == ["left", "left"]
    assert built.counts["handle"] == 0


def test_counts_of_an_object_without_fronts_divide_all_of_it():
    bare = replace(read_cabinet(), parts=())
    made = correct_reading(bare, counts={"drawer": 3})
    assert made.counts["drawer"] == 3
    np.testing.assert_allclose(np.stack([part.box for part in made.fronts])[:, [0, 2]], [[0, 1]] * 3)


def test_what_cannot_be_is_refused():
    with pytest.raises(ArtigenError, match="kind 'Sofa'"):
        correct_reading(read_cabinet(), kind="Sofa")
    with pytest.raises(ArtigenError, match="41 parts called drawer"):
        correct_reading(read_cabinet(), counts={"drawer": 41})
