"""Readings do not depend on how a file stores a picture, and are mirrored with it."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from artigen.camera import Camera, frame_points
from artigen.errors import ArtigenError, SourceError
from artigen.examples.photographs import find_direction
from artigen.examples.reader_views import project_front
from artigen.reader.boxes import overlap_boxes
from artigen.reader.drawing import draw_reading
from artigen.reader.model import load_reader
from artigen.reader.read import EDGE as SHEET
from artigen.reader.read import read_image, read_photo
from artigen.reader.reading import Reading
from artigen.shapes.draw import draw_shape
from artigen.shapes.poses import place_posed
from artigen.shapes.render import batch_cameras, build_scene, render
from artigen.shapes.shape import Shape
from artigen.weights import READER

EDGE = 320


def camera_of(shape: Shape) -> Camera:
    """A camera near the front."""
    points = place_posed(shape, np.zeros(len(shape.parts)))
    return frame_points(points, find_direction(0.3, 0.15), fov=35.0, margin=0.12, width=EDGE, height=EDGE)


def picture_of(kind: str, seed: int) -> Image.Image:
    """A plain picture of a closed object."""
    shape = draw_shape(kind, seed)
    seen = render(build_scene([shape]), batch_cameras([camera_of(shape)]), [np.zeros(len(shape.parts))])
    return Image.fromarray((seen.rgb[0].numpy() * 255).astype(np.uint8))


@pytest.fixture(scope="module")
def cabinet() -> Image.Image:
    return picture_of("Dresser", 4)


@pytest.fixture(scope="module")
def reading(cabinet: Image.Image) -> Reading:
    return read_image(cabinet.convert("RGBA"), load_reader(READER), "cabinet")


def saved(image: Image.Image, path: Path, **options: object) -> Path:
    image.save(path, **options)  # type: ignore[arg-type]
    return path


def check_same(one: Reading, other: Reading, near: float = 0.02) -> None:
    assert one.kind == other.kind
    assert one.counts == other.counts
    for part, same in zip(one.fronts, other.fronts, strict=True):
        np.testing.assert_allclose(part.box, same.box, atol=near)


@pytest.mark.parametrize("seed", [4, 6])
def test_fronts_of_a_dresser_are_where_they_are_drawn(seed: int):
    """Fronts of seeds that are never trained on, against those of the shape through the same camera."""
    shape = draw_shape("Dresser", seed)
    found = read_image(picture_of("Dresser", seed).convert("RGBA"), load_reader(READER), "dresser")
    drawn = [part for part in shape.parts if part.label in ("door", "drawer")]
    assert len(found.fronts) == len(drawn)
    for part in drawn:
        corners, _ = project_front(part, np.eye(4), camera_of(shape))
        box = np.concatenate([corners.min(axis=0), corners.max(axis=0)]) / EDGE
        same = np.array([front.box for front in found.fronts if front.label == part.label])
        assert overlap_boxes(same, box[None]).max() > 0.5


@pytest.mark.parametrize(
    ("name", "mode"), [("a.png", "RGB"), ("a.webp", "RGB"), ("a.tif", "CMYK"), ("a.png", "P")]
)
def test_file_formats_do_not_change_what_is_read(tmp_path: Path, cabinet: Image.Image, name: str, mode: str):
    options = {"lossless": True} if name.endswith("webp") else {}
    stored = cabinet.quantize(256) if mode == "P" else cabinet.convert(mode)
    same = read_image(stored.convert("RGB").convert("RGBA"), load_reader(READER), "same pixels")
    check_same(read_photo(saved(stored, tmp_path / name, **options)), same)


def test_a_turned_photograph_is_read_upright(tmp_path: Path, cabinet: Image.Image, reading: Reading):
    exif = Image.Exif()
    exif[0x0112] = 6  # the camera was turned by a quarter
    path = saved(cabinet.transpose(Image.Transpose.ROTATE_90), tmp_path / "turned.png", exif=exif)
    check_same(read_photo(path), reading)


def test_transparency_is_white(tmp_path: Path, cabinet: Image.Image):
    white = Image.new("RGB", (400, 320), (255, 255, 255))
    white.paste(cabinet, (40, 0))
    clear = Image.new("RGBA", (400, 320), (0, 90, 200, 0))
    clear.paste(cabinet.convert("RGBA"), (40, 0))
    one, two = (read_photo(saved(image, tmp_path / f"{k}.png")) for k, image in enumerate((white, clear)))
    check_same(one, two, near=1e-6)


def test_a_mirrored_picture_is_read_mirrored(cabinet: Image.Image, reading: Reading):
    mirrored = cabinet.transpose(Image.Transpose.FLIP_LEFT_RIGHT).convert("RGBA")
    other = read_image(mirrored, load_reader(READER), "mirrored")
    assert other.counts == reading.counts
    boxes = np.array([part.box for part in other.fronts])
    back = (1 - boxes)[:, [2, 1, 0, 3]]
    back[:, [1, 3]] = boxes[:, [1, 3]]
    for part in reading.fronts:
        assert np.abs(back - part.box).max(axis=1).min() < 1.01 / SHEET  # sides move to edges of pixels


def test_a_box_chooses_the_object(cabinet: Image.Image):
    wide = Image.new("RGBA", (640, 320), (255, 255, 255, 255))
    wide.paste(cabinet, (0, 0))
    wide.paste(picture_of("Refrigerator", 3), (320, 0))
    left, right = (
        read_image(wide, load_reader(READER), "pair", box=box)
        for box in ((0.02, 0.05, 0.48, 0.95), (0.55, 0.02, 0.95, 0.98))
    )
    assert left.box[[0, 2]].mean() < 0.5 < right.box[[0, 2]].mean()


def test_shares_lie_in_the_picture_and_probabilities_add_up(reading: Reading):
    said = reading.to_json()
    assert sum(share for _, share in reading.kinds) == pytest.approx(1.0)
    assert said["counts"] == reading.counts
    for part in reading.parts:
        assert (part.box >= 0).all()
        assert (part.box <= 1).all()
        assert (part.box[:2] < part.box[2:]).all()


def test_a_drawing_has_the_pictures_shape(cabinet: Image.Image, reading: Reading):
    drawn = draw_reading(cabinet.resize((200, 100)).convert("RGBA"), reading)
    assert drawn.size == (200, 100)
    assert (np.asarray(drawn) != np.asarray(cabinet.resize((200, 100)))).any()


def test_a_picture_without_an_object_is_refused_in_a_sentence(tmp_path: Path):
    path = saved(Image.new("RGB", (300, 200), (190, 190, 190)), tmp_path / "wall.png")
    with pytest.raises(SourceError, match=r"wall\.png: no object of a known kind was found") as caught:
        read_photo(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("box", [(0.5, 0.1, 0.2, 0.9), (0.0, 0.0, 1.5, 1.0), (0.1, 0.1, 0.1, 0.5)])
def test_a_box_that_is_none_is_refused(cabinet: Image.Image, box: tuple[float, float, float, float]):
    with pytest.raises(ArtigenError, match="expected left, top, right and bottom"):
        read_image(cabinet.convert("RGBA"), load_reader(READER), "cabinet", box=box)


def test_files_that_are_no_pictures_are_refused(tmp_path: Path, cabinet: Image.Image):
    whole = saved(cabinet, tmp_path / "whole.jpg")
    (tmp_path / "cut.jpg").write_bytes(whole.read_bytes()[:2000])
    (tmp_path / "text.png").write_text("no picture")
    for name, said in (("none.png", "no such"), ("cut.jpg", "damaged"), ("text.png", "no picture that")):
        with pytest.raises(SourceError, match=said):
            read_photo(tmp_path / name)
    with pytest.raises(SourceError, match=r"no such model"):
        read_photo(whole, folder=tmp_path)
