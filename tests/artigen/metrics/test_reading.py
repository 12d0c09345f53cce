"""Laws of the scores of reading pictures, with a network whose headers are known."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from artigen.metrics import reading
from artigen.metrics.reading import is_same_category, score_reading
from artigen.sketch.request import SketchRequest
from artigen.types import PART_LABELS, PartLabel

TRUE: dict[PartLabel, int] = {"door": 2, "handle": 2, "shelf": 3}


def score(
    monkeypatch, read: SketchRequest, guess: dict[PartLabel, int], size=(0.4, 0.8, 1.6)
) -> dict[str, float]:
    """Scores of one wardrobe that is read as ``read``, and for which ``guess`` is drawn by request."""
    asked = []

    def draw(network, request, seed, *, encoded):
        if request == SketchRequest():
            return read
        asked.append(request)
        return SketchRequest(category=request.category, counts=(*request.counts, *guess.items()))

    counts = np.array([1, *(TRUE.get(label, 0) for label in PART_LABELS[1:])], dtype=np.uint8)
    picture = np.zeros((8, 8, 4), dtype=np.uint8)
    example = SimpleNamespace(category="StorageFurniture", counts=counts, size=np.array(size), image=picture)
    monkeypatch.setattr(reading, "draw_header", draw)
    monkeypatch.setattr(reading, "encode_picture", lambda *_: None)
    subject: Any = SimpleNamespace(asset=None, example=example)
    network: Any = None
    scores = score_reading(network, [subject])
    told: dict[PartLabel, int] = {
        label: TRUE.get(label, 0) for label in PART_LABELS[1:] if label not in ("shelf", "tray")
    }
    assert asked == [SketchRequest(category="StorageFurniture", counts=tuple(told.items()))]
    return scores


def header(changes: dict[PartLabel, int] | None = None, size=(0.2, 0.4, 0.8)) -> SketchRequest:
    counts: dict[PartLabel, int] = dict.fromkeys(PART_LABELS[1:], 0) | TRUE | (changes or {})
    depth, width, height = size
    return SketchRequest(
        category="StorageFurniture", counts=tuple(counts.items()), depth=depth, width=width, height=height
    )


def test_a_picture_read_without_error_scores_one_in_all(monkeypatch):
    scores = score(monkeypatch, header(), {"shelf": 3, "tray": 0})
    assert scores.pop("extents") == pytest.approx(0.0)
    assert set(scores.values()) == {1.0}


def test_hidden_parts_count_among_all_but_not_in_view(monkeypatch):
    scores = score(monkeypatch, header({"shelf": 2}), {"shelf": 3, "tray": 0})
    assert (scores["counts"], scores["counts in view"], scores["counts of shelf"]) == (0.0, 1.0, 0.0)
    scores = score(monkeypatch, header({"door": 1}), {"shelf": 3, "tray": 0})
    assert (scores["counts"], scores["counts in view"], scores["counts of door"]) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("shelf", "tray", "right"), [(3, 0, 1.0), (2, 0, 0.0), (3, 1, 0.0)])
def test_hidden_parts_are_guessed_when_all_others_are_told(monkeypatch, shelf, tray, right):
    scores = score(monkeypatch, header({"door": 9}), {"shelf": shelf, "tray": tray})
    assert scores["hidden, given the rest"] == right


def test_proportions_count_and_size_does_not(monkeypatch):
    twice_as_deep = header(size=(0.4, 0.4, 0.8))
    error = score(monkeypatch, twice_as_deep, {"shelf": 3, "tray": 0})["extents"]
    assert error == pytest.approx(np.log(2.0) / 3)


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("Dresser", "StorageFurniture", True),
        ("Wardrobe", "FilingCabinet", True),
        ("Table", "StorageFurniture", False),
        (None, "Table", False),
    ],
)
def test_kinds_of_storage_furniture_are_one_category(one, other, same):
    assert is_same_category(one, other) == same
