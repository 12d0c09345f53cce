"""Legs in rooms by the columns below the fronts; outlines on plain ground."""

import numpy as np
import pytest
from PIL import Image

from artigen.reader.ground import BORDER, EVEN, SHADOW, bound_outline, find_outline
from artigen.reader.legs import ALIKE, LEAST, find_legs
from artigen.reader.looks import COVERED, look_closer
from artigen.reader.reading import Reading, ReadPart

WOOD, FLOOR, WALL = (150, 90, 50), (120, 125, 130), (210, 220, 225)


def photograph(
    high: float = 0.25, middle: float = 0.0, wide: float = 0.08, *, ground: tuple[int, int, int] = FLOOR
) -> tuple[Reading, Image.Image]:
    """A chest on two legs, and a third one in the middle; all as shares of its front, 200 pixels each way.

    The box that was read ends above the legs."""
    pixels = np.full((400, 400, 3), WALL, np.uint8)
    pixels[240:] = ground
    pixels[100:300, 100:300] = WOOD
    for left, length in ((100, high), (300 - round(200 * wide), high), (190, middle)):
        pixels[300 : 300 + round(200 * length), left : left + round(200 * wide)] = WOOD
    front = ReadPart(label="drawer", score=1.0, box=np.array([0.25, 0.25, 0.75, 0.75]), color=WOOD)
    reading = Reading(
        kind="Dresser", kinds=(("Dresser", 1.0),), box=np.array([0.24, 0.24, 0.76, 0.75]), parts=(front,),
        size=(1.0, 0.5, 0.8), view=(0.0, 0.0, 0.1), stand="flat", color=WOOD, extent=(400, 400),
    )  # fmt: skip
    return reading, Image.fromarray(pixels).convert("RGBA")


def test_legs_end_where_they_stand():
    end = find_legs(*photograph())
    assert end == pytest.approx(0.75 + 0.5 * 0.25, abs=0.01)
    looked = look_closer(*photograph())
    assert looked.stand == "legs"
    assert looked.box[3] == pytest.approx(end)


@pytest.mark.parametrize("change", [{"high": 0.0}, {"wide": 0.3}, {"middle": 0.25}, {"ground": WOOD}])
def test_what_is_no_leg(change: dict[str, float]):
    assert find_legs(*photograph(**change)) is None  # type: ignore[arg-type]


@pytest.mark.parametrize(("more", "found"), [(-0.015, False), (0.015, True)])
def test_legs_have_a_least_height(more: float, *, found: bool):
    assert (find_legs(*photograph(LEAST + 0.01 + more)) is not None) == found


@pytest.mark.parametrize(("more", "found"), [(-0.02, True), (0.03, False)])
def test_legs_are_higher_than_what_is_between(more: float, *, found: bool):
    assert (find_legs(*photograph(0.3, ALIKE * 0.3 + more)) is not None) == found


def cut_out(*, alpha: bool, darker: float = 0.0) -> tuple[Reading, Image.Image]:
    """The chest before white, with a shadow beside it, or transparent ground."""
    reading, image = photograph()
    pixels = np.array(image)
    ground = (pixels[..., :3] != WOOD).any(axis=-1)
    pixels[ground, :3] = 255
    if darker:
        fade = np.linspace(0, darker, 60).round().astype(int)
        pixels[310:380, 310:370, :3] = (255 - np.minimum(fade, fade[::-1]) * 2)[None, :, None]
    if alpha:
        pixels[ground] = 0
    return reading, Image.fromarray(pixels)


@pytest.mark.parametrize("alpha", [False, True])
def test_an_object_before_plain_ground_ends_with_its_outline(*, alpha: bool):
    reading, image = cut_out(alpha=alpha)
    looked = look_closer(reading, image)
    np.testing.assert_allclose(looked.box, (0.25, 0.25, 0.75, 0.875), atol=0.005)
    assert looked.stand == "legs"


@pytest.mark.parametrize(("darker", "same"), [(0.7 * 255 * SHADOW, True), (1.6 * 255 * SHADOW, False)])
def test_soft_shadows_are_ground(darker: float, *, same: bool):
    outline = find_outline(cut_out(alpha=False, darker=darker)[1])
    assert outline is not None
    assert (bound_outline(outline)[2] == pytest.approx(0.75, abs=0.005)) == same


@pytest.mark.parametrize(("more", "plain"), [(0.03, True), (-0.03, False)])
def test_boundary_of_plain_ground(more: float, *, plain: bool):
    """A share of the border's pixels has another colour."""
    _, image = cut_out(alpha=False)
    pixels = np.array(image)
    rows = round(400 * (1 - (EVEN + more)))
    pixels[:rows, :8] = pixels[-rows:, -8:] = pixels[:8, :rows] = pixels[-8:, -rows:] = (20, 60, 160, 255)
    assert (find_outline(Image.fromarray(pixels)) is not None) == plain


@pytest.mark.parametrize(("near", "plain"), [(1.5, True), (0.4, False)])
def test_boundary_of_the_border(near: float, *, plain: bool):
    """An object that comes so near to all sides, as a share of the border's width."""
    pixels = np.full((400, 400, 4), 255, np.uint8)
    edge = round(400 * BORDER * near)
    pixels[edge:-edge, edge:-edge, :3] = WOOD
    assert (find_outline(Image.fromarray(pixels)) is not None) == plain


@pytest.mark.parametrize(("more", "stand"), [(-0.05, "legs"), (0.05, "flat")])
def test_boundary_of_what_legs_cover(more: float, stand: str):
    reading, image = cut_out(alpha=False)
    pixels = np.array(image)
    pixels[300:350, 100 : 100 + round(200 * (COVERED + more)) - 16] = (*WOOD, 255)
    assert look_closer(reading, Image.fromarray(pixels)).stand == stand
