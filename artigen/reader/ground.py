"""`find_outline`: the pixels of an object that stands on plain ground, or is cut out."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

if TYPE_CHECKING:
    from PIL import Image

BORDER = 0.02
"""Width of the border of a picture by which its ground is judged, as a share of the picture."""
EVEN = 0.9
"""Share of the border's pixels that have the colour of the ground where that is plain."""
ALIKE = 0.06
"""Difference of a channel (sRGB in [0, 1]) up to which a pixel has the colour of the ground."""
SHADOW = 0.3
"""How much darker than the ground a pixel of its colour may be, as a shadow on it is."""
TINT = 0.035
"""Difference of the shares of the channels up to which a darker pixel has the colour of the ground."""
SOLID = 0.5
"""Opacity from which a pixel of a cut-out belongs to its object."""
SMALL = 0.02
"""Size of what is no part of the object, as a share of the largest piece."""
EDGE = 512
"""Longest edge of an outline (pixels)."""


def find_outline(image: "Image.Image") -> Bool[np.ndarray, "H W"] | None:
    """The pixels of the object before plain ground; None where the ground is not plain.

    Ground is what is joined to the border of the picture and has its colour, or is a shadow on it.

    Args:
        image: RGBA; the longest edge of the answer is at most `EDGE` pixels.
    """
    small = image.convert("RGBA")
    small.thumbnail((EDGE, EDGE))
    values = np.asarray(small, dtype=np.float64) / 255.0
    opaque = values[..., 3] >= SOLID
    if not opaque.all():
        return _keep_large(opaque)
    rgb = values[..., :3]
    wide = max(1, round(BORDER * min(rgb.shape[:2])))
    border = np.ones(rgb.shape[:2], bool)
    border[wide:-wide, wide:-wide] = False
    ground = np.median(rgb[border], axis=0)
    if (np.abs(rgb[border] - ground).max(axis=1) <= ALIKE).mean() < EVEN:
        return None
    pieces, _ = ndimage.label(_is_ground(rgb, ground))  # type: ignore[misc]
    outside = np.isin(pieces, np.unique(pieces[border & (pieces > 0)]))
    return _keep_large(~outside)


def bound_outline(outline: Bool[np.ndarray, "H W"]) -> Float[np.ndarray, "4"]:
    """Left, top, right and bottom of an outline, as shares of the picture."""
    rows, columns = np.flatnonzero(outline.any(axis=1)), np.flatnonzero(outline.any(axis=0))
    ends = np.array([columns[0], rows[0], columns[-1] + 1, rows[-1] + 1], dtype=np.float64)
    return ends / np.tile(outline.shape[::-1], 2)


def _is_ground(rgb: Float[np.ndarray, "H W 3"], ground: Float[np.ndarray, "3"]) -> Bool[np.ndarray, "H W"]:
    total, whole = rgb.sum(axis=-1, keepdims=True), float(ground.sum())
    tint = np.abs(rgb / np.maximum(total, 1e-6) - ground / max(whole, 1e-6)).max(axis=-1)
    darker = (whole - total[..., 0]) / 3
    return (np.abs(rgb - ground).max(axis=-1) <= ALIKE) | (
        (darker > 0) & (darker <= SHADOW) & (tint <= TINT) & _is_smooth(rgb)
    )


def _is_smooth(rgb: Float[np.ndarray, "H W 3"]) -> Bool[np.ndarray, "H W"]:
    """Whether the luminance changes as slowly as in a soft shadow."""
    light = rgb.mean(axis=-1)
    return ndimage.maximum_filter(light, 3) - ndimage.minimum_filter(light, 3) <= ALIKE


def _keep_large(mask: Bool[np.ndarray, "H W"]) -> Bool[np.ndarray, "H W"] | None:
    """The mask without specks; None for an empty one."""
    pieces, count = ndimage.label(mask)  # type: ignore[misc]
    if count == 0:
        return None
    sizes = np.bincount(pieces.ravel())[1:]
    kept = np.flatnonzero(sizes >= SMALL * sizes.max()) + 1
    return np.isin(pieces, kept)
