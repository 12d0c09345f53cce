"""Pictures as conditions: every kind of file, and what an object in it must come out as."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from artigen.conditioning.image import read_picture
from artigen.errors import SourceError

SIZE = 32
RED = (200, 30, 30)


def drawn(background: tuple[int, int, int] = (250, 250, 250)) -> np.ndarray:
    """A red rectangle, twice as wide as high, off the middle."""
    image = np.full((90, 120, 3), background, dtype=np.uint8)
    image[10:40, 20:80] = RED
    return image


def saved(folder: Path, image: Image.Image, name: str = "picture.png") -> Path:
    image.save(folder / name)
    return folder / name


def check_rectangle(rgba: np.ndarray) -> None:
    rows, columns = np.flatnonzero(rgba[3].any(axis=1)), np.flatnonzero(rgba[3].any(axis=0))
    assert abs(len(columns) - 28) <= 1
    assert abs(len(rows) - 14) <= 1
    assert abs(rows[0] + rows[-1] - (SIZE - 1)) <= 1
    middle = rgba[:, SIZE // 2, SIZE // 2]
    np.testing.assert_allclose(middle, [*(np.array(RED) / 255), 1.0], atol=0.06)


@pytest.mark.parametrize("mode", ["RGB", "RGBA", "P", "CMYK"])
def test_every_mode_gives_the_same_object(tmp_path: Path, mode: str):
    image = Image.fromarray(drawn())
    if mode == "RGBA":
        alpha = (drawn() == RED).all(axis=2).astype(np.uint8) * 255
        image.putalpha(Image.fromarray(alpha))
    path = saved(tmp_path, image.convert(mode), "picture.tif" if mode == "CMYK" else "picture.png")
    picture = read_picture(path, SIZE)
    check_rectangle(picture.rgba)
    assert (picture.rgba[:3] <= picture.rgba[3:] + 1e-6).all()


def test_sixteen_bit_grey_is_scaled(tmp_path: Path):
    grey = np.full((64, 64), 60000, dtype=np.uint16)
    grey[16:48, 16:48] = 20000
    picture = read_picture(saved(tmp_path, Image.fromarray(grey)), SIZE)
    assert picture.rgba[0, SIZE // 2, SIZE // 2] == pytest.approx(20000 / 65535, abs=0.01)


def test_moving_the_object_does_not_change_the_result(tmp_path: Path):
    image = drawn()
    moved = np.roll(image, (30, 25), axis=(0, 1))
    one, two = (
        read_picture(saved(tmp_path, Image.fromarray(values), name), SIZE).rgba
        for values, name in ((image, "a.png"), (moved, "b.png"))
    )
    np.testing.assert_allclose(one, two, atol=1e-6)


def test_a_busy_background_is_kept_and_said(tmp_path: Path):
    noise = np.random.default_rng(0).integers(0, 255, (64, 64, 3), dtype=np.uint8)
    picture = read_picture(saved(tmp_path, Image.fromarray(noise)), SIZE)
    assert "not plain" in picture.notes[0]
    assert picture.rgba[3].mean() > 0.7


def test_what_is_no_picture_is_refused(tmp_path: Path):
    text = tmp_path / "text.png"
    text.write_text("hello")
    broken = saved(
        tmp_path, Image.fromarray(np.random.default_rng(0).integers(0, 255, (64, 64, 3), np.uint8))
    )
    broken.write_bytes(broken.read_bytes()[:2000])
    clear = saved(tmp_path, Image.new("RGBA", (64, 64)), "clear.png")
    dot = saved(tmp_path, Image.new("RGB", (1, 1)), "dot.png")
    huge = saved(tmp_path, Image.new("1", (20000, 6000)), "huge.png")  # Pillow warns of it
    bomb = saved(tmp_path, Image.new("1", (20000, 20000)), "bomb.png")  # and does not open this
    for path, match in (
        (tmp_path / "nothing.png", "no such picture"),
        (text, "no picture that can be read"),
        (broken, "damaged"),
        (clear, "transparent everywhere"),
        (dot, "1 x 1 pixels"),
        (huge, "20000 x 6000 pixels"),
        (bomb, "far too large"),
        (tmp_path, "is a folder"),
    ):
        with pytest.raises(SourceError, match=match):
            read_picture(path, SIZE)


def test_a_large_picture_is_scaled_down_and_gives_the_same_object(tmp_path: Path):
    small = Image.fromarray(drawn())
    large = small.resize((3000, 2250), Image.Resampling.NEAREST)
    one, two = (
        read_picture(saved(tmp_path, image, name), SIZE)
        for image, name in ((small, "small.png"), (large, "large.png"))
    )
    assert one.notes == two.notes[1:]
    assert "3000 x 2250 pixels were scaled down" in two.notes[0]
    assert np.abs(one.rgba - two.rgba).mean() < 0.02


def test_a_strip_of_many_pixels_is_read(tmp_path: Path):
    strip = np.full((64, 20000, 3), 250, dtype=np.uint8)
    strip[16:48, 100:19900] = RED
    picture = read_picture(saved(tmp_path, Image.fromarray(strip)), SIZE)
    assert picture.rgba[3].any()
