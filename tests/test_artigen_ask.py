"""What is asked for becomes one whole condition, or a sentence that says why not."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from artigen.ask import Request, read_request
from artigen.errors import ArtigenError
from artigen.shapes.draw import Wish, draw_shape
from artigen.types import PART_LABELS


def test_what_is_open_is_drawn_and_what_is_asked_for_stays():
    request = Request(category="Microwave", wish=Wish(counts=(("knob", 1),)))
    one, again, other = (read_request(request, seed, 0).condition for seed in (3, 3, 4))
    assert one == again
    assert one != other
    assert dict(one.counts)["knob"] == 1
    assert dict(one.counts)["base"] == 1
    assert one.size is not None
    assert min(one.size) > 0.1
    sized = read_request(Request(category="Microwave", wish=Wish(height=0.3)), 3, 0).condition
    assert sized.size is not None
    assert sized.size[2] == pytest.approx(0.3, abs=0.01)


def test_words_ask_for_the_same_as_flags():
    words = Request(text="a table with three drawers, 1.4 m wide")
    flags = Request(category="Table", wish=Wish(width=1.4, counts=(("drawer", 3),)))
    said, flagged = (read_request(request, 5, 0).condition for request in (words, flags))
    assert said == replace(flagged, text=words.text)


def test_a_tall_one_is_taller_than_the_same_draw_without_that_word():
    plain, tall = (
        read_request(Request(text=text), 2, 0).condition.size for text in ("a cabinet", "a tall cabinet")
    )
    assert plain is not None
    assert tall is not None
    assert tall[2] > 1.1 * plain[2]
    assert tall[:2] == plain[:2]


def test_a_picture_is_taken_as_it_is(tmp_path: Path):
    picture = np.full((64, 48, 3), 250, dtype=np.uint8)
    picture[16:48, 12:36] = (120, 60, 20)
    Image.fromarray(picture).save(tmp_path / "oven.png")
    asked = read_request(Request(image=tmp_path / "oven.png", category="Oven"), 0, 32)
    assert asked.condition.image is not None
    assert asked.condition.image.shape == (4, 32, 32)
    assert asked.condition.size is None
    assert asked.condition.counts == ()
    with pytest.raises(ArtigenError, match="takes no pictures"):
        read_request(Request(image=tmp_path / "oven.png"), 0, 0)


def test_words_that_mean_nothing_are_named():
    assert "zebra" in read_request(Request(text="a zebra cabinet"), 0, 0).notes[0]


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (Request(), "no category"),
        (Request(category="Spaceship"), "expected one of"),
        (Request(category="Oven", text="a table"), "both Oven and Table"),
        (Request(text="a table 1 m wide", wish=Wish(width=2.0)), "both 2.0 and 1.0"),
        (Request(text="a cabinet with two doors", wish=Wish(counts=(("door", 3),))), "number of doors"),
    ],
)
def test_what_cannot_be_is_said(request_: Request, message: str):
    with pytest.raises(ArtigenError, match=message):
        read_request(request_, 0, 0)


def test_the_drawn_condition_is_that_of_the_grammar():
    drawn = draw_shape("Oven", 7).condition
    asked = read_request(Request(category="Oven"), 7, 0).condition
    assert dict(asked.counts) == dict.fromkeys(PART_LABELS, 0) | dict(drawn.counts)
    assert asked.size == (drawn.depth, drawn.width, drawn.height)
