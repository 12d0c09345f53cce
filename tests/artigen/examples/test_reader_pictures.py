"""Training pictures made of views: marks follow every change of the picture."""

import numpy as np
import pytest

from artigen.examples import reader_pictures
from artigen.examples.picture_stock import BACKGROUND, CutOut, Stock, gather_stock
from artigen.examples.reader_pictures import make_picture
from artigen.examples.reader_views import BODY, NOTHING, PART, View
from artigen.reader.labels import FRONT, HINGES, OBJECT, PULL, UNKNOWN

EDGE, SIZE = 128, 160
BLUE, GREY, RED = (20, 20, 230), (120, 120, 120), (230, 20, 20)


def cabinet(*, hinge: str = "left") -> View:
    """A grey body with one blue door and a red handle on its right side."""
    ids = np.full((EDGE, EDGE), NOTHING, np.uint16)
    ids[20:110, 30:100] = 0
    ids[26:104, 36:94] = 1
    ids[55:75, 82:88] = 2
    rgba = np.zeros((EDGE, EDGE, 4), np.uint8)
    for number, color in enumerate((GREY, BLUE, RED)):
        rgba[ids == number] = (*color, 255)
    parts = np.zeros(3, PART)
    parts["thing"] = (UNKNOWN, FRONT, PULL)
    parts["material"] = parts["hinge"] = UNKNOWN
    parts["door"], parts["hinge"][1] = (UNKNOWN, 1, UNKNOWN), HINGES.index(hinge)
    parts["corners"][1] = [[36, 26], [94, 26], [94, 104], [36, 104]]
    bodies = np.array([(0, 0, (0.1, 0.2, 0.4), (0.6, 0.4, 0.8))], BODY)
    return View(rgba=rgba, ids=ids, parts=parts, bodies=bodies)


def stock(*sets: tuple[CutOut, ...]) -> Stock:
    return Stock(backgrounds=np.full((1, BACKGROUND, BACKGROUND, 3), 250, np.uint8), sets=sets)


@pytest.fixture(autouse=True)
def _even_light(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(reader_pictures, "vary_photometry", lambda pixels, rng: pixels)
    monkeypatch.setattr(reader_pictures, "CLUTTERED", 0.0)


def near(pixels: np.ndarray, box: np.ndarray, color: tuple[int, int, int]) -> float:
    x0, y0, x1, y1 = np.clip(np.round(box), 0, SIZE).astype(int)
    return float((np.abs(pixels[y0:y1, x0:x1].astype(int) - color).max(axis=2) < 70).mean())


def test_marks_lie_on_their_parts(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(reader_pictures, "DRESSED", 0.0)
    checked = 0
    for seed in range(20):
        picture = make_picture(cabinet(), stock(), SIZE, np.random.default_rng(seed))
        for mark in picture.marks:
            if mark["thing"] == FRONT:
                assert near(picture.pixels, mark["box"], BLUE) > 0.75
                corners = mark["corners"]
                if np.isfinite(corners).all():
                    hull = [*corners.min(axis=0), *corners.max(axis=0)]
                    np.testing.assert_allclose(hull, mark["box"], atol=0.1 * SIZE)
                    checked += 1
            elif mark["thing"] == PULL:
                assert near(picture.pixels, mark["box"], RED) > 0.5
    assert checked > 10


def test_a_picture_is_a_function_of_its_stream():
    one, two = (make_picture(cabinet(), stock(), SIZE, np.random.default_rng(5)) for _ in range(2))
    np.testing.assert_array_equal(one.pixels, two.pixels)
    assert one.marks.tobytes() == two.marks.tobytes()


@pytest.mark.parametrize("shown", ["left", "right"])
def test_pasted_fronts_bring_their_pulls_and_keep_the_hinge(monkeypatch: pytest.MonkeyPatch, shown: str):
    """A green door of a photograph covers the blue one; it is mirrored where its hinges are on the other
    side."""
    monkeypatch.setattr(reader_pictures, "CUT_OUT", 1.0)
    pixels = np.full((80, 60, 3), (30, 200, 30), np.uint8)
    x = (6, 14) if shown == "right" else (46, 54)
    pixels[30:50, x[0] : x[1]] = (230, 230, 20)
    cutout = CutOut(
        pixels=pixels,
        door=True,
        hinge=HINGES.index(shown),
        pulls=np.array([[x[0] / 60, 30 / 80, x[1] / 60, 50 / 80]]),
    )
    checked = 0
    for seed in range(20):
        picture = make_picture(cabinet(hinge="left"), stock((cutout,)), SIZE, np.random.default_rng(seed))
        doors = picture.marks[picture.marks["thing"] == FRONT]
        pulls = picture.marks[picture.marks["thing"] == PULL]
        if len(doors) != 1 or len(pulls) != 1:
            continue
        assert HINGES[doors["hinge"][0]] == "left"
        assert pulls["box"][0, [0, 2]].mean() > doors["box"][0, [0, 2]].mean()
        red = np.abs(picture.pixels.astype(int) - RED).max(axis=2) < 40
        assert red.mean() < 0.002  # the old handle is gone
        checked += 1
    assert checked > 5


def test_a_part_that_is_cut_off_is_neither_taught_as_there_nor_as_absent():
    view = cabinet()
    wide = View(rgba=view.rgba, ids=view.ids, parts=view.parts, bodies=view.bodies)
    for seed in range(40):
        picture = make_picture(wide, stock(), SIZE, np.random.default_rng(seed))
        fronts = (picture.marks["thing"] == FRONT).sum()
        objects = (picture.marks["thing"] == OBJECT).sum()
        assert fronts == 1 or picture.weight[FRONT].min() == 0 or objects == 0


def test_without_photographs_there_are_backgrounds_and_no_fronts():
    empty = gather_stock([])
    assert len(empty.backgrounds) > 0
    assert empty.sets == ()
    make_picture(cabinet(), empty, SIZE, np.random.default_rng(0))
