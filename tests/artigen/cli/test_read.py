"""`artigen read`: what is printed is what was read."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from artigen.cli.read import read
from artigen.errors import ArtigenError
from artigen.reader import read as reading_module
from artigen.reader.describe import describe
from artigen.reader.reading import Reading, ReadPart

BOX = np.array([0.1, 0.2, 0.5, 0.9])


def made(share: float = 0.8) -> Reading:
    door = ReadPart(
        label="door",
        score=0.9,
        box=BOX,
        hinge="left",
        open=True,
        pane=True,
        material="wood",
        color=(1, 2, 255),
    )
    return Reading(
        kind="Wardrobe",
        kinds=(("Wardrobe", share), ("Dresser", 1 - share)),
        box=BOX,
        parts=(door, ReadPart(label="handle", score=0.7, box=BOX, form="bar")),
        size=(1.2, 0.6, 2.0),
        view=(0.1, 0.2, 0.3),
        stand="legs",
        color=(10, 20, 30),
        extent=(60, 40),
        notes=("a note",),
    )


@pytest.fixture
def photo(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    Image.new("RGB", (60, 40), (90, 90, 90)).save(tmp_path / "photo.png")
    monkeypatch.setattr(reading_module, "read_photo", lambda path, box=None: made())
    return tmp_path / "photo.png"


def test_json_holds_the_reading(photo: Path, capsys: pytest.CaptureFixture[str]):
    assert read(photo, as_json=True) == 0
    said = json.loads(capsys.readouterr().out)
    assert said == json.loads(json.dumps(made().to_json()))
    assert said["kind"] == "Wardrobe"
    assert said["counts"] == {"door": 1, "drawer": 0, "handle": 1, "knob": 0}
    assert said["fronts"][0]["box"] == BOX.tolist()
    assert (said["fronts"][0]["hinge"], said["fronts"][0]["open"]) == ("left", True)
    assert said["size"] == {"width": 1.2, "depth": 0.6, "height": 2.0}


def test_text_names_all_that_was_read(photo: Path, capsys: pytest.CaptureFixture[str]):
    read(photo)
    text = capsys.readouterr().out
    for said in (
        "Wardrobe 80%",
        "1 door, 1 handle",
        "hinges left",
        "open",
        "glazed",
        "wood",
        "#0102ff",
        "1.20 m",
    ):
        assert said in text
    assert "note: a note" in text


@pytest.mark.parametrize(("share", "sure"), [(0.51, True), (0.49, False)])
def test_a_kind_that_is_not_likelier_than_all_others_is_said_to_be_unsure(share: float, sure: bool):  # noqa: FBT001
    assert describe(made(share)).startswith("not sure") != sure
    assert made(share).to_json()["sure"] == sure


def test_a_picture_of_the_boxes_is_written(photo: Path, tmp_path: Path):
    read(photo, picture=tmp_path / "new" / "boxes.png")
    with Image.open(tmp_path / "new" / "boxes.png") as drawn:
        assert drawn.size == (60, 40)
    with pytest.raises(ArtigenError, match="expected a file that ends with"):
        read(photo, picture=tmp_path / "boxes.doc")


def test_sentences_are_read_without_drawing(capsys: pytest.CaptureFixture[str]):
    assert read(text="a dresser with six drawers, 1,2 m wide", as_json=True) == 0
    said = json.loads(capsys.readouterr().out)
    assert (said["kind"], said["counts"], said["size"]) == ("Dresser", {"drawer": 6}, {"width": 1.2})
    read(text="a dresser with six drawers")
    assert "Dresser" in capsys.readouterr().out


def test_a_photograph_or_words_are_expected(photo: Path):
    for options in ({}, {"photo": photo, "text": "a table"}):
        with pytest.raises(ArtigenError, match="expected a photograph or --text"):
            read(**options)
