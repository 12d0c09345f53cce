"""Readings as files: what is written is read back, and what is edited is built so."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from artigen.errors import ArtigenError, SourceError
from artigen.reader.layout.frontal import read_shape
from artigen.reader.open_reading import open_reading, parse_reading
from artigen.reader.reading import Reading, ReadPart
from artigen.shapes.draw import draw_shape
from artigen.sketch.asked import ask, draw_asked
from artigen.sketch.network import SketchNetwork
from artigen.sketch.understand import Request


def refuse() -> SketchNetwork:
    raise AssertionError("a reading needs no sketch network")


def make_full() -> Reading:
    """A reading with every value."""
    plain = read_shape(draw_shape("StorageFurniture", 3), view=(0.2, 0.1, 0.25))
    corners = np.array([(0.1, 0.1), (0.4, 0.12), (0.4, 0.5), (0.1, 0.52)])
    door = ReadPart(
        label="door", score=0.5, box=np.array([0.1, 0.1, 0.4, 0.52]), corners=corners, hinge="left",
        open=True, field="framed", material="wood", color=(1, 20, 255),
    )  # fmt: skip
    knob = ReadPart(label="handle", score=0.2, box=np.array([0, 0, 0.2, 0.2]), form="knob", color=(9, 8, 7))
    return replace(
        plain, kinds=(("StorageFurniture", 0.75), ("Table", 0.25)), parts=(door, *plain.parts, knob),
        stand="legs", notes=("a note",),
    )  # fmt: skip


def test_what_is_written_is_read_back():
    said = json.loads(json.dumps(make_full().to_json()))
    assert parse_reading(said).to_json() == said


def test_an_edited_reading_is_built(tmp_path: Path):
    """A front that was missed is written into the file, and another one gets its right label."""
    said: dict[str, Any] = {
        "kind": "StorageFurniture", "extent": [400, 400], "box": [0, 0, 1, 1],
        "size": {"width": 0.8, "depth": 0.4, "height": 0.8},
        "fronts": [{"label": "drawer", "box": [0.02, 0.02, 0.98, 0.3]}],
    }  # fmt: skip
    path = tmp_path / "reading.json"
    path.write_text(json.dumps(said))
    asked = ask(Request(reading=path), refuse)
    assert read_shape(draw_asked(asked, 0, refuse).shape).counts["drawer"] == 1
    said["fronts"] += [{"label": "door", "box": [0.02, 0.32, 0.98, 0.98], "hinge": "right"}]
    path.write_text(json.dumps(said))
    with pytest.raises(ArtigenError, match=r"reading.json and a box: the reading is of one object already"):
        ask(Request(reading=path, box=(0.0, 0.0, 0.5, 1.0)), refuse)
    built = read_shape(
        draw_asked(ask(Request(reading=path, text="hinged on the left"), refuse), 0, refuse).shape
    )
    assert [(front.label, front.hinge) for front in built.fronts] == [("drawer", None), ("door", "left")]


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (("kind",), "Castle", "kind of the reading is 'Castle': expected one of Box, BreadBox"),
        (("kind",), None, "the reading has no kind"),
        (("extent",), [400], "extent of the reading is \\[400\\]: expected 2 numbers"),
        (("fronts",), {}, "fronts of the reading is {}: expected a list"),
        (
            ("fronts", 0, "label"),
            "handle",
            "label of fronts\\[0\\] is 'handle': expected one of door, drawer",
        ),
        (("fronts", 0, "box"), [0.5, 0, 0.4, 1], "box of fronts\\[0\\] is \\[0.5, 0.0, 0.4, 1.0\\]"),
        (("fronts", 0, "box"), [0, 0, "wide", 1], "box of fronts\\[0\\] is 'wide': expected a number"),
        (("fronts", 0, "corners"), [[0, 0]], "corners of fronts\\[0\\] are \\[\\[0, 0\\]\\]: expected four"),
        (("fronts", 0, "color"), "oak", "color of fronts\\[0\\] is 'oak': expected one such as #a0522d"),
        (("fronts", 0), 3, "fronts\\[0\\] is 3: expected an object"),
        (("size", "width"), True, "width of size is True: expected a number"),
    ],
)
def test_wrong_values_are_named(tmp_path: Path, place: tuple[str | int, ...], value: object, said: str):
    held: Any = json.loads(json.dumps(make_full().to_json()))
    at = held
    for key in place[:-1]:
        at = at[key]
    at[place[-1]] = value
    path = tmp_path / "reading.json"
    path.write_text(json.dumps(held))
    with pytest.raises(SourceError, match=said):
        open_reading(path)


def test_files_that_hold_no_reading(tmp_path: Path):
    for name, content in (("text.json", b"{"), ("bytes.json", b"\xff\xfe"), ("none.json", None)):
        if content is not None:
            (tmp_path / name).write_bytes(content)
        with pytest.raises(SourceError, match=f"{name}: no reading.*artigen read PHOTO --json"):
            open_reading(tmp_path / name)
