"""Fields of fronts by their pixels: frames at every side, slats along one axis, slabs with any grain."""

import numpy as np
import pytest
from jaxtyping import Float
from PIL import Image

from artigen.reader.panels import (
    BAND,
    FAINT,
    FRAMED,
    LEAST_LAG,
    SLATTED,
    WEAKEST,
    look_at_panels,
    name_field,
    rate_frame,
    rate_slats,
)
from artigen.reader.reading import Field, Reading, ReadPart


def draw_slab(high: int = 96, wide: int = 60, grain: float = 0.02) -> Float[np.ndarray, "H W"]:
    """A veneered slab: upright grain."""
    return 0.6 + grain * np.random.default_rng(0).standard_normal((1, wide)) + np.zeros((high, 1))


def draw_frame(contrast: float) -> Float[np.ndarray, "H W"]:
    """A field within a frame, its edges as dark as that."""
    pixels = draw_slab(grain=0.0)
    pixels[12:84, 12:48] -= contrast
    return pixels


def draw_planks(depth: float) -> Float[np.ndarray, "H W"]:
    """Upright flutes."""
    return draw_slab(grain=0.01) + depth * np.sin(2 * np.pi * np.arange(60) / 6)


def name_doors(*fronts: Float[np.ndarray, "_ _"]) -> Field:
    return name_field(fronts, FRAMED["door"])


def test_fields():
    assert name_doors(draw_slab()) == "flat"
    assert name_doors(draw_frame(0.1)) == "framed"
    assert name_doors(draw_planks(0.1)) == "planks"
    assert name_doors(draw_planks(0.1).T) == "slats"
    woven = draw_planks(0.1) + draw_planks(0.1)[:60].T.mean(axis=1)[:1] + 0.1 * np.sin(np.arange(96))[:, None]
    assert name_doors(woven) == "flat"


@pytest.mark.parametrize("turned", [False, True])
def test_a_field_is_that_of_most_fronts_and_turns_with_them(*, turned: bool):
    fronts = [draw_frame(0.1), draw_frame(0.1), draw_slab()]
    assert name_doors(*(front.T if turned else front for front in fronts)) == "framed"


@pytest.mark.parametrize(("more", "framed"), [(0.9, False), (1.1, True)])
def test_one_side_of_a_frame_may_be_faint(more: float, *, framed: bool):
    """That of a field which darkens from its edge on, at the share of the other sides that is asked for."""
    contrast = 0.02 * FRAMED["door"] / rate_frame(draw_frame(0.02))
    pixels = draw_frame(contrast)
    pixels[12:84, 48:] -= (1.0 - more * WEAKEST) * contrast
    assert (rate_frame(pixels) >= FRAMED["door"] * (1 - 1e-9)) == framed


@pytest.mark.parametrize("label", FRAMED)
@pytest.mark.parametrize(("more", "framed"), [(0.98, False), (1.02, True)])
def test_boundary_of_frames(label: str, more: float, *, framed: bool):
    contrast = FRAMED[label] / rate_frame(draw_frame(0.02)) * 0.02  # the rating is linear in it
    assert (name_field([draw_frame(more * contrast)], FRAMED[label]) == "framed") == framed


@pytest.mark.parametrize(("lean", "seen"), [(0.1, True), (6 / BAND, False)])
def test_planks_may_lean_by_less_than_one_over_a_band(lean: float, *, seen: bool):
    columns = np.arange(60) + lean * np.arange(96)[:, None]
    assert (name_doors(0.6 + 0.1 * np.sin(2 * np.pi * columns / 6)) == "planks") == seen


def test_boundary_of_slats():
    depths = np.linspace(0.0, 0.05, 26)
    rates = [rate_slats(draw_planks(depth)) for depth in depths]
    assert rates[0] < SLATTED < rates[-1]
    for depth, rate in zip(depths, rates, strict=True):
        assert (name_doors(draw_planks(depth)) == "planks") == (rate >= SLATTED)


def test_fronts_are_looked_at_through_their_corners_and_panes_are_not():
    """A slanted front has the field of the upright one."""
    photo = Image.fromarray(np.round(255 * draw_frame(0.2)).astype(np.uint8)).resize((240, 384))
    slanted = photo.transform(photo.size, Image.Transform.AFFINE, (1, 0, 0, 0.1, 1, 0)).convert("RGBA")
    corners = np.array([(0.0, 0.0), (1.0, -0.0625), (1.0, 0.9375), (0.0, 1.0)])
    front = ReadPart(label="door", score=1.0, box=np.array([0.0, 0.0, 1.0, 1.0]), corners=corners)
    pane = ReadPart(label="drawer", score=1.0, box=np.array([0.0, 0.0, 1.0, 1.0]), pane=True)
    reading = Reading(
        kind="Dresser", kinds=(("Dresser", 1.0),), box=front.box, parts=(front, pane), size=(1.0, 0.5, 0.8),
        view=(0.0, 0.0, 0.1), stand="flat", color=(90, 90, 90), extent=(240, 384),
    )  # fmt: skip
    assert [part.field for part in look_at_panels(reading, slanted).fronts] == ["framed", None]


@pytest.mark.parametrize(("more", "seen"), [(0.9, False), (1.1, True)])
def test_boundary_of_faint_slats(more: float, *, seen: bool):
    """The power of the steps of a sine of amplitude one over a column is that of the sampled sine."""
    wave = np.sin(2 * np.pi * np.arange(96) / 8)
    steps = np.gradient(wave)[8:-8]
    depth = more * FAINT / np.sqrt(((steps - steps.mean()) ** 2).mean())
    assert (rate_slats(0.5 + depth * np.tile(wave, (40, 1))) > 0.0) == seen


@pytest.mark.parametrize("period", [LEAST_LAG - 1, 2 * LEAST_LAG])
def test_boundary_of_narrow_slats(period: int):
    """Two pixels hold light and shadow of none: what repeats so is the noise of the camera."""
    wave = np.where(np.arange(60) % period < period / 2, 0.5, 0.6)
    assert (rate_slats(np.tile(wave, (40, 1))) >= SLATTED) == (period >= LEAST_LAG)
