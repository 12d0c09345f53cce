"""What pixels around an object tell: legs where the room shows below it, and colours of the object itself."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from artigen.reader.looks import ALIKE, LOW, SAME, STRIP, look_closer
from artigen.reader.reading import Reading, ReadPart

BODY, WALL = (150, 90, 50), (210, 220, 225)


def photograph(
    below: tuple[int, int, int], high: float = 0.2, body: tuple[int, int, int] = BODY
) -> tuple[Reading, Image.Image]:
    """A chest before a wall, and what is below its drawer."""
    pixels = np.full((200, 200, 3), WALL, np.uint8)
    pixels[40:160, 40:160] = BODY
    pixels[round(160 - 120 * high) : 160, 46:154] = below
    front = ReadPart(label="drawer", score=1.0, box=np.array([0.2, 0.2, 0.8, 0.8 - 0.6 * high]), color=BODY)
    reading = Reading(
        kind="Dresser", kinds=(("Dresser", 1.0),), box=np.array([0.2, 0.2, 0.8, 0.8]), parts=(front,),
        size=(1.0, 0.5, 0.8), view=(0.0, 0.0, 0.1), stand="legs", color=body, extent=(200, 200),
    )  # fmt: skip
    return reading, Image.fromarray(pixels)


@pytest.mark.parametrize(("below", "stand"), [(WALL, "legs"), (BODY, "flat")])
def test_legs_are_where_the_room_shows(below: tuple[int, int, int], stand: str):
    assert look_closer(*photograph(below)).stand == stand


@pytest.mark.parametrize(("more", "stand"), [(-0.01, "flat"), (0.01, "legs")])
def test_legs_need_room(more: float, stand: str):
    assert look_closer(*photograph(WALL, LOW + more)).stand == stand


@pytest.mark.parametrize(("off", "same"), [(SAME - 0.01, True), (SAME + 0.01, False)])
def test_a_body_in_the_colour_of_the_wall_has_that_of_its_fronts(off: float, *, same: bool):
    red, green, blue = (round(value - 255 * off) for value in WALL)
    color = (red, green, blue)
    assert look_closer(*photograph(BODY, body=color)).color == (BODY if same else color)


@pytest.mark.parametrize(("off", "closed"), [(ALIKE - 0.03, True), (ALIKE + 0.03, False)])
def test_a_surface_is_closed_where_it_has_the_colour_of_the_nearest_front(off: float, *, closed: bool):
    """The upper right quarter is darker than its front, which is at the upper left; another is below."""
    pixels = np.full((128, 128, 3), BODY, np.uint8)
    pixels[64:] = WALL
    pixels[:64, 64:] -= np.uint8(round(255 * off))
    reading, _ = photograph(BODY)
    front = reading.parts[0]
    parts = (
        replace(front, box=np.array([0.0, 0.0, 0.5, 0.5])),
        replace(front, box=np.array([0.0, 0.5, 0.5, 1.0]), color=WALL),
    )
    surface = look_closer(replace(reading, parts=parts), Image.fromarray(pixels).convert("RGBA")).surface
    assert surface is not None
    high, wide = (size // 2 for size in surface.shape)
    assert surface[:high, :wide].all()
    assert surface[high:].all()
    assert surface[: high - 2, wide + 2 :].mean() == closed


@pytest.mark.parametrize(("share", "beside"), [(0.4, False), (0.6, True)])
def test_what_is_beside_an_object_is_most_of_a_strip(share: float, *, beside: bool):
    """A band in the colour that was read as the body's, between object and wall."""
    other = (90, 160, 80)
    pixels = np.full((700, 700, 3), WALL, np.uint8)
    wide = round(420 * (1 + 2 * share * STRIP))
    pixels[140:560, 350 - wide // 2 : 350 + wide // 2] = other
    pixels[140:560, 140:560] = BODY
    reading, _ = photograph(BODY)
    looked = look_closer(
        replace(reading, color=other, extent=(700, 700)), Image.fromarray(pixels).convert("RGBA")
    )
    assert (looked.color == BODY) == beside
