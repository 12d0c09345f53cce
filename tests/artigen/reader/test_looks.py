"""What pixels around an object tell: legs where the room shows below it, and colours of the object itself."""

import numpy as np
import pytest
from PIL import Image

from artigen.reader.looks import LOW, SAME, look_closer
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
