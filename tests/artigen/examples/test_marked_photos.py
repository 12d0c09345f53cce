"""Crops of marked photographs: marks move with the picture, and what nobody knows is not taught."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from artigen.errors import SourceError
from artigen.examples import marked_photos
from artigen.examples.marked_photos import crop_photo, read_marked_photos
from artigen.reader.labels import DIAL, FRONT, HINGES, KINDS, OBJECT, PULL
from artigen.reader.network import STRIDE

SIZE = 160


def write_photo(folder: Path, **changes: object) -> Path:
    """A white cabinet on grey: a blue door with left hinges, a green drawer above, and a red pull on the
    door."""
    image = np.full((240, 320, 3), 128, np.uint8)
    image[60:90, 100:200] = (30, 200, 30)
    image[92:200, 100:200] = (30, 30, 220)
    image[130:160, 184:192] = (220, 20, 20)
    (folder / "images").mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(folder / "images" / "one.png"), image[:, :, ::-1])

    def shares(x0: float, y0: float, x1: float, y1: float) -> list[float]:
        return [x0 / 320, y0 / 240, x1 / 320, y1 / 240]

    entry = {
        "object": "cabinet",
        "complete": True,
        "fronts": [
            {"label": "drawer", "box": shares(100, 60, 200, 90), "hinge": None, "open": False},
            {"label": "door", "box": shares(100, 92, 200, 200), "hinge": "left", "open": False},
        ],
        "pulls": [shares(184, 130, 192, 160)],
        "room_doors": [],
    } | changes
    (folder / "labels.json").write_text(json.dumps({"one": entry}))
    return folder


@pytest.fixture(autouse=True)
def _even_light(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(marked_photos, "vary_photometry", lambda pixels, rng: pixels)


def crops(folder: Path, count: int = 30):
    photo = read_marked_photos(folder)[0]
    return [crop_photo(photo, SIZE, np.random.default_rng(seed)) for seed in range(count)]


def covered(pixels: np.ndarray, box: np.ndarray, color: tuple[int, int, int]) -> float:
    x0, y0, x1, y1 = np.clip(np.round(box), 0, SIZE).astype(int)
    near = np.abs(pixels[y0:y1, x0:x1].astype(int) - color).max(axis=2) < 60
    return float(near.mean()) if near.size else 1.0


def test_marks_lie_on_what_they_name(tmp_path: Path):
    seen = 0
    for picture in crops(write_photo(tmp_path)):
        for mark in picture.marks:
            if mark["thing"] == FRONT:
                color = (30, 30, 220) if mark["door"] == 1 else (30, 200, 30)
                assert covered(picture.pixels, mark["box"], color) > 0.85
                seen += 1
            elif mark["thing"] == PULL and np.prod(mark["box"][2:] - mark["box"][:2]) > 100:
                assert covered(picture.pixels, mark["box"], (220, 20, 20)) > 0.6
    assert seen > 20


def test_mirrored_photographs_have_mirrored_hinges(tmp_path: Path):
    """The pull of the door is on the right, its hinges are on the left; so they stay opposite."""
    sides = set()
    for picture in crops(write_photo(tmp_path)):
        doors = picture.marks[(picture.marks["thing"] == FRONT) & (picture.marks["door"] == 1)]
        pulls = picture.marks[picture.marks["thing"] == PULL]
        if len(doors) == 1 and len(pulls) == 1:
            pull_right = pulls["box"][0, [0, 2]].mean() > doors["box"][0, [0, 2]].mean()
            assert HINGES[doors["hinge"][0]] == ("left" if pull_right else "right")
            sides.add(HINGES[doors["hinge"][0]])
    assert sides == {"left", "right"}


def test_what_may_be_there_unmarked_is_not_taught_as_absent(tmp_path: Path):
    whole = crops(write_photo(tmp_path / "whole"))
    partial = crops(write_photo(tmp_path / "partial", complete=False))
    assert all((picture.weight[FRONT] == 1).any() for picture in whole)
    for picture in partial:
        assert picture.weight[FRONT].min() < 1
        assert picture.weight[DIAL].max() == 0
    fronts = [{"label": "pair", "box": [0.3, 0.4, 0.6, 0.8], "hinge": None, "open": None}]
    for picture in crops(write_photo(tmp_path / "pair", fronts=fronts)):
        assert not (picture.marks["thing"] == FRONT).any()
        rows, columns = np.nonzero(np.abs(picture.pixels.astype(int) - (30, 30, 220)).max(axis=2) < 10)
        inner = picture.weight[FRONT][rows // STRIDE, columns // STRIDE]
        assert len(inner) == 0 or np.median(inner) == 0


def test_furniture_and_appliances_become_objects(tmp_path: Path):
    for picture in crops(write_photo(tmp_path / "cabinet")):
        for mark in picture.marks[picture.marks["thing"] == OBJECT]:
            assert KINDS[mark["kind"]] == "StorageFurniture"
    fronts = [
        {"label": "door", "box": [0.3, 0.2, 0.6, 0.8], "hinge": "left", "open": False, "kind": "refrigerator"}
    ]
    found = [
        mark
        for picture in crops(write_photo(tmp_path / "fridge", fronts=fronts, object="kitchen"))
        for mark in picture.marks[picture.marks["thing"] == OBJECT]
    ]
    assert found
    assert {KINDS[mark["kind"]] for mark in found} == {"Refrigerator"}


def test_a_folder_without_marks_or_images_is_refused(tmp_path: Path):
    with pytest.raises(SourceError, match=r"no labels\.json"):
        read_marked_photos(tmp_path)
    folder = write_photo(tmp_path / "photos")
    (folder / "images" / "one.png").unlink()
    with pytest.raises(SourceError, match="names one"):
        read_marked_photos(folder)
