"""Photos as conditions: converts an image file to a premultiplied RGBA square filled by the object."""

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float

from artigen.errors import SourceError

if TYPE_CHECKING:
    from PIL import Image

MIN_EDGE = 16
MARGIN = 0.06
"""Free border on each side of the object, as a share of the edge."""
MAX_PIXELS = 64_000_000
MAX_EDGE = 2048
"""Longest edge (pixels); larger pictures are scaled down first to limit the memory of background removal."""
BACKGROUND_TOLERANCE = 0.12
"""Largest distance (RGB, 0 to 1) of a background colour from the colour of the border."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    """RGB and alpha in [0, 1], premultiplied on black; ``notes`` lists the processing steps."""

    rgba: Float[np.ndarray, "4 S S"]
    notes: tuple[str, ...]


def read_picture(path: Path, size: int, *, margin: float = MARGIN) -> Picture:
    """Reads a picture, cuts out its object and scales it into a square.

    An alpha channel defines the object. Without one, the object is what differs from a plain background along
    the border. A picture without a plain background is used whole, and a note says so.

    Args:
        path: PNG, JPEG or any format that Pillow reads, including grey, palette, 16 bit and CMYK images.
        size: Edge of the result in pixels.
        margin: Free border on each side, as a share of the edge.

    Raises:
        SourceError: If the file is missing, not an image, truncated, too small or too large, or its object is
            empty.
    """
    from PIL import Image

    image = open_picture(path)
    notes: list[str] = []
    if max(image.size) > MAX_EDGE:
        notes.append(f"{image.width} x {image.height} pixels were scaled down to {MAX_EDGE} at most")
        image.thumbnail((MAX_EDGE, MAX_EDGE), Image.Resampling.BOX)
    values = np.asarray(image, dtype=np.float32) / 255.0
    object_mask = values[..., 3] > 0.5
    if object_mask.all():
        object_mask, said = find_object(values[..., :3])
        notes.append(said)
    if not object_mask.any():
        raise SourceError(f"{path}: is transparent everywhere, expected an object")
    square = _fit(values, object_mask, size, margin)
    return Picture(rgba=square, notes=tuple(notes))


def open_picture(path: Path) -> "Image.Image":
    """Opens a picture as 8-bit RGBA, upright as its camera noted; of an animation, the first frame.

    HEIC files are read where Pillow's plug-in ``pillow_heif`` is installed.

    Raises:
        SourceError: If the file is missing, not an image, truncated, too small or too large.
    """
    from PIL import Image, ImageOps, UnidentifiedImageError

    _register_plugins()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # refused below
            opened = Image.open(path)
        with opened:
            _check_extent(path, opened.size)
            return _to_rgba(ImageOps.exif_transpose(opened))
    except FileNotFoundError as error:
        raise SourceError(f"{path}: no such picture") from error
    except IsADirectoryError as error:
        raise SourceError(f"{path}: is a folder, expected a picture") from error
    except Image.DecompressionBombError as error:
        raise SourceError(
            f"{path}: is far too large ({error}), expected at most {MAX_PIXELS // 10**6} million pixels; "
            "scale it down"
        ) from error
    except UnidentifiedImageError as error:
        hint = "; install pillow-heif to read it" if path.suffix.lower() in (".heic", ".heif") else ""
        raise SourceError(f"{path}: is no picture that can be read ({error}){hint}") from error
    except (OSError, SyntaxError, ValueError) as error:
        raise SourceError(f"{path}: is damaged ({error})") from error


def is_cut_out(image: "Image.Image") -> bool:
    """Whether an RGBA picture is transparent somewhere."""
    lowest, _ = image.getchannel("A").getextrema()
    return int(lowest) < 255  # type: ignore[arg-type]


def _register_plugins() -> None:
    """Lets Pillow read HEIC if its plug-in is installed; AVIF is built in."""
    try:
        import pillow_heif  # type: ignore[import-not-found]
    except ImportError:
        return
    pillow_heif.register_heif_opener()


def resize_picture(rgba: Float[np.ndarray, "4 S S"], size: int) -> Float[np.ndarray, "4 s s"]:
    """A picture of ``size`` pixels by area averaging."""
    if rgba.shape[1] == size:
        return rgba
    return np.stack([_resize(channel, (size, size)) for channel in rgba])


def find_object(rgb: Float[np.ndarray, "H W 3"]) -> tuple[Bool[np.ndarray, "H W"], str]:
    """Mask of the object in front of a plain background, with a note; the whole picture if none is found."""
    border = np.concatenate([rgb[0], rgb[-1], rgb[:, 0], rgb[:, -1]])
    background = np.median(border, axis=0)
    plain = np.abs(border - background).max(axis=1) < BACKGROUND_TOLERANCE
    if plain.mean() < 0.75:
        return np.ones(rgb.shape[:2], dtype=bool), "the background is not plain; the whole picture is used"
    differs = np.abs(rgb - background).max(axis=2) >= BACKGROUND_TOLERANCE
    if not differs.any():
        return np.ones(rgb.shape[:2], dtype=bool), "nothing differs from the background; all of it is used"
    from scipy.ndimage import binary_fill_holes, label

    filled = np.asarray(binary_fill_holes(differs))
    pieces, count = label(filled)  # type: ignore[misc]
    largest = np.bincount(pieces.ravel())[1:].argmax() + 1 if count else 0
    return pieces == largest, "the object was separated from its plain background"


def _check_extent(path: Path, extent: tuple[int, int]) -> None:
    width, height = extent
    if min(extent) < MIN_EDGE:
        raise SourceError(f"{path}: is {width} x {height} pixels, expected at least {MIN_EDGE} each way")
    if width * height > MAX_PIXELS:
        raise SourceError(
            f"{path}: is {width} x {height} pixels, expected at most {MAX_PIXELS // 10**6} million; "
            "scale it down"
        )


def _to_rgba(image: "Image.Image") -> "Image.Image":
    """Converts any mode to 8-bit RGBA; 16-bit grey is scaled, not clipped."""
    if image.mode.startswith("I") or image.mode == "F":
        from PIL import Image as PillowImage

        values = np.asarray(image, dtype=np.float64)
        top = 65535.0 if image.mode.startswith("I") else max(values.max(), 1e-9)
        scaled = np.clip(255.0 * values / top, 0, 255).astype(np.uint8)
        return PillowImage.fromarray(scaled).convert("RGBA")
    return image.convert("RGB" if image.mode == "CMYK" else "RGBA").convert("RGBA")


def _fit(
    values: Float[np.ndarray, "H W 4"], mask: Bool[np.ndarray, "H W"], size: int, margin: float
) -> Float[np.ndarray, "4 S S"]:
    """Centres the mask's box in a square on black."""

    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    box = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
    alpha = values[..., 3] * mask
    cut = np.concatenate([values[..., :3] * alpha[..., None], alpha[..., None]], axis=2)[box]
    inner = max(1, round(size * (1.0 - 2.0 * margin)))
    scale = inner / max(cut.shape[:2])
    height, width = (max(1, round(edge * scale)) for edge in cut.shape[:2])
    small = [_resize(cut[..., channel], (width, height)) for channel in range(4)]
    square = np.zeros((4, size, size), dtype=np.float32)
    top, left = (size - height) // 2, (size - width) // 2
    square[:, top : top + height, left : left + width] = np.stack(small)
    return np.clip(square, 0.0, 1.0)


def _resize(channel: Float[np.ndarray, "H W"], size: tuple[int, int]) -> Float[np.ndarray, "h w"]:
    from PIL import Image

    return np.asarray(Image.fromarray(channel).resize(size, Image.Resampling.BOX))
