"""`look_at_panels`: whether fronts are slabs, framed, or of slats or planks, by the pixels of each."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.reader.layout.plane import frame_box
from artigen.reader.reading import Field, Reading, ReadPart

if TYPE_CHECKING:
    from PIL import Image

EDGE = 1024
"""Longest edge (pixels) at which a photograph is looked at."""
LONG = 96
"""Pixels of the longer edge of a front as it is looked at."""
STILES = (0.12, 0.3)
"""Width of stiles and rails, as shares of the shorter edge of a front."""
LOOSE = 1.35
"""Ratio by which the widths of stiles and rails of one front may differ from their mean."""
FAINT = 0.004
"""Contrast (luminance in [0, 1], by pixel) of edges that count as much as the noise beside them."""
BAND = 10
"""Rows (pixels) whose luminance is averaged: edges that slant are lost in more, faint ones in fewer."""
WEAKEST = 0.4
"""Contrast of a frame's weakest side, as a share of that of the second weakest: boxes that are read cut off a
side of many fronts."""
FRAMED = {"door": 1.1, "drawer": 2.0}
"""Contrast of a frame against its surroundings from which there is one, as the median of an object's fronts.
Of 82 photographs with doors, told by eye, 38 of 44 with frames reach it and none of 38 with slabs; of 88 with
drawers, which have edges of neighbours and pulls where a frame would be, 5 of 17 and 2 of 71."""
SLATTED = 0.55
"""Correlation of a profile with itself, shifted by a slat, from which there are slats, as the median of an
object's fronts: none of the 82 photographs reaches 0.5, a further one with louvres 0.7."""
SLATS = (4, 30)
"""Number of slats that can be told."""
LEAST_LAG = 3
"""Width (pixels) of the narrowest slat."""


def look_at_panels(reading: Reading, image: "Image.Image") -> Reading:
    """The reading with the field of every closed front that is no pane.

    Args:
        reading: What was read.
        image: The photograph, of any size.
    """
    gray = image.convert("L")
    gray.thumbnail((EDGE, EDGE))
    fields: dict[str, Field] = {}
    for label in ("door", "drawer"):
        fronts = [rectify(gray, part) for part in reading.fronts if part.label == label and _is_seen(part)]
        if fronts:
            fields[label] = name_field(fronts, FRAMED[label])
    parts = tuple(
        replace(part, field=fields[part.label]) if part.label in fields and _is_seen(part) else part
        for part in reading.parts
    )
    return replace(reading, parts=parts)


def _is_seen(part: ReadPart) -> bool:
    return not (part.open or part.pane)


def rectify(gray: "Image.Image", part: ReadPart) -> Float[np.ndarray, "H W"]:
    """A front as an upright picture whose longer edge has `LONG` pixels; luminance in [0, 1]."""
    from PIL import Image

    quad = (frame_box(part.box) if part.corners is None else np.asarray(part.corners)) * gray.size
    edges = np.linalg.norm(np.roll(quad, -1, axis=0) - quad, axis=1)
    wide, high = (edges[0] + edges[2]) / 2, (edges[1] + edges[3]) / 2
    scale = LONG / max(wide, high, 1.0)
    size = max(8, round(wide * scale)), max(8, round(high * scale))
    corners = quad[[0, 3, 2, 1]].ravel().tolist()
    fine = gray.transform(
        (3 * size[0], 3 * size[1]), Image.Transform.QUAD, corners, Image.Resampling.BILINEAR
    )
    return np.asarray(fine.resize(size, Image.Resampling.BOX), dtype=np.float64) / 255.0


def name_field(fronts: Sequence[Float[np.ndarray, "_ _"]], least: float) -> Field:
    """What most of the fronts of an object have, which are alike as a rule; ``least`` is the contrast of a
    frame."""
    across, along, framed = np.median(
        [(rate_slats(pixels.T), rate_slats(pixels), rate_frame(pixels)) for pixels in fronts], axis=0
    )
    if max(across, along) >= SLATTED and min(across, along) < SLATTED:  # not woven
        return "slats" if across > along else "planks"
    return "framed" if framed >= least else "flat"


def _profile(pixels: Float[np.ndarray, "H W"]) -> Float[np.ndarray, "B W"]:
    """Mean steps of the luminance from column to column, in each band of the middle rows."""
    rows = pixels[round(0.2 * len(pixels)) : max(round(0.8 * len(pixels)), 1)]
    bands = np.array_split(rows, max(1, round(len(rows) / BAND)))
    return np.stack([np.gradient(band.mean(axis=0)) for band in bands])


def rate_frame(pixels: Float[np.ndarray, "H W"]) -> float:
    """Contrast of the likeliest frame's second weakest side against what is beside and within it, less where
    the weakest one has hardly any."""
    short = min(pixels.shape)
    profiles = [np.median(np.abs(_profile(turned)), axis=0) for turned in (pixels, pixels.T)]
    noises = []
    for profile in profiles:
        inner = profile[round(0.3 * len(profile)) : round(0.7 * len(profile)) + 1]
        noises.append(FAINT + 1.5 * float(np.median(inner)))
    best = 0.0
    for stile in np.linspace(STILES[0] * short, STILES[1] * short, 12):
        low, high = max(2, int(stile / LOOSE)), int(np.ceil(stile * LOOSE)) + 1
        weakest, second, *_ = sorted(
            float(end[low:high].max(initial=0.0)) / noise
            for profile, noise in zip(profiles, noises, strict=True)
            for end in (profile, profile[::-1])
        )
        best = max(best, min(weakest / WEAKEST, second))
    return best


def rate_slats(pixels: Float[np.ndarray, "H W"]) -> float:
    """How periodic the columns of a front are, from 0 to 1."""
    profile = _profile(pixels)
    wide = profile.shape[1]
    inner = profile[:, round(0.08 * wide) : round(0.92 * wide)]
    inner = inner - inner.mean(axis=1, keepdims=True)
    power = float((inner**2).mean())
    if np.sqrt(power) < FAINT:
        return 0.0
    lags = {round(inner.shape[1] / count) for count in range(*SLATS)}
    return max(
        (float((inner[:, lag:] * inner[:, :-lag]).mean()) / power for lag in lags if lag >= LEAST_LAG),
        default=0.0,
    )
