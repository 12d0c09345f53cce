"""What marked photographs lend to rendered views: backgrounds without fronts, and fronts with their pulls."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from artigen.examples.marked_photos import MarkedPhoto, read_pixels
from artigen.examples.photometry import smooth_noise
from artigen.reader.labels import HINGES, UNKNOWN

BACKGROUND = 320
"""Pixels of a background's edge."""
LEAST_CUTOUT = 48
"""Least extent (pixels) of a front that is cut out of a photograph."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CutOut:
    """A front of a photograph, with the pulls on it as shares of its box."""

    pixels: UInt8[np.ndarray, "h w 3"]
    door: bool
    hinge: int
    pulls: Float[np.ndarray, "N 4"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Stock:
    """What marked photographs lend to rendered views."""

    backgrounds: UInt8[np.ndarray, "N S S 3"]
    sets: tuple[tuple[CutOut, ...], ...]
    """Fronts of one photograph each."""


def gather_stock(photos: Sequence[MarkedPhoto]) -> Stock:
    """Backgrounds without fronts, and fronts, of the photographs that are marked completely.

    Without photographs, backgrounds are noise and no fronts are cut out.
    """
    rng = np.random.default_rng(0)
    backgrounds, sets = [], []
    for photo in photos:
        if not photo.complete:
            continue
        image = read_pixels(photo.path)
        backgrounds += _cut_backgrounds(photo, image, rng)
        cutouts = tuple(_cut_fronts(photo, image))
        if cutouts:
            sets.append(cutouts)
    if not backgrounds:
        patches = [smooth_noise(rng, BACKGROUND, int(cells), 3) for cells in rng.integers(2, 40, 64)]
        backgrounds = [(np.clip(patch, 0, 1) * 255).astype(np.uint8) for patch in patches]
    return Stock(backgrounds=np.stack(backgrounds), sets=tuple(sets))


def _cut_backgrounds(photo: MarkedPhoto, image: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
    height, width = image.shape[:2]
    boxes = [np.array(front["box"]) for front in photo.fronts] + list(photo.pulls) + list(photo.room_doors)
    taken = np.array(boxes).reshape(-1, 4) * [width, height, width, height]
    out = []
    for _ in range(40):
        side = int(min(width, height) * rng.uniform(0.25, 0.9))
        x, y = rng.integers(0, width - side + 1), rng.integers(0, height - side + 1)
        clear = (taken[:, 0] > x + side) | (taken[:, 2] < x) | (taken[:, 1] > y + side) | (taken[:, 3] < y)
        if clear.all() and side >= 96:
            part = image[y : y + side, x : x + side]
            out.append(cv2.resize(part, (BACKGROUND, BACKGROUND), interpolation=cv2.INTER_AREA))
            if len(out) == 2:
                break
    return out


def _cut_fronts(photo: MarkedPhoto, image: np.ndarray) -> list[CutOut]:
    height, width = image.shape[:2]
    out = []
    for front in photo.fronts:
        if front["label"] not in ("door", "drawer") or front.get("open"):
            continue
        x0, y0, x1, y1 = np.array(front["box"]) * [width, height, width, height]
        if min(x1 - x0, y1 - y0) < LEAST_CUTOUT:
            continue
        left, top = round(x0), round(y0)
        size = np.array([x1 - x0, y1 - y0] * 2)
        pulls = (photo.pulls * [width, height, width, height] - [x0, y0, x0, y0]) / size
        middles = (pulls[:, :2] + pulls[:, 2:]) / 2
        out.append(
            CutOut(
                pixels=image[top : round(y1), left : round(x1)].copy(),
                door=front["label"] == "door",
                hinge=UNKNOWN if front.get("hinge") is None else HINGES.index(front["hinge"]),
                pulls=np.clip(pulls[((middles > 0) & (middles < 1)).all(axis=1)], 0, 1),
            )
        )
    return out
