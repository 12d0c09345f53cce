"""A reading completes a request; what people ask for overrules it, and what cannot be drawn is said."""

import numpy as np

from artigen.reader.reading import Reading, ReadPart
from artigen.sketch.part_counts import parse_part_counts
from artigen.sketch.reading_request import follow_reading
from artigen.sketch.request import SketchRequest

KNOWN = parse_part_counts({"Dresser": ["drawer 6, handle 6", "drawer 3"], "Wardrobe": ["door 2"]})


def read(doors: int, drawers: int, kind: str = "Dresser") -> Reading:
    box = np.array([0.1, 0.1, 0.5, 0.5])
    labels = ["door"] * doors + ["drawer"] * drawers
    return Reading(
        kind=kind,
        kinds=((kind, 0.8), ("Table", 0.2)),
        box=box,
        parts=tuple(ReadPart(label=label, score=0.9, box=box) for label in labels),  # type: ignore[arg-type]
        size=(1.0, 0.5, 0.8),
        view=(0.0, 0.1, 0.4),
        stand="flat",
        color=(200, 180, 150),
        extent=(640, 480),
    )


def test_a_reading_fills_what_is_open():
    request, notes = follow_reading(SketchRequest(), read(0, 6), KNOWN)
    assert request.category == "Dresser"
    assert dict(request.counts) == {"door": 0, "drawer": 6}
    assert "0 doors and 6 drawers" in notes[0]


def test_words_overrule_a_reading():
    asked = SketchRequest(category="Dresser", counts=(("drawer", 3),))
    request, _ = follow_reading(asked, read(0, 6, kind="Wardrobe"), KNOWN)
    assert request.category == "Dresser"
    assert dict(request.counts) == {"door": 0, "drawer": 3}


def test_counts_that_no_object_has_are_left_open_and_said():
    request, notes = follow_reading(SketchRequest(), read(5, 1), KNOWN)
    assert request.category == "Dresser"
    assert request.counts == ()
    assert "cannot" in notes[-1] or "no Dresser with 5 doors and 1 drawer" in notes[-1]
    assert dict(follow_reading(SketchRequest(), read(5, 1), frozenset())[0].counts) == {
        "door": 5,
        "drawer": 1,
    }
