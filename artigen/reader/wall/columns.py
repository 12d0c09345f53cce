"""`make_stacks`: the fronts of a wall that are above each other, cut into columns."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import torch
from jaxtyping import Float

from artigen.models.precision import native_autocast
from artigen.reader.labels import KINDS
from artigen.reader.layout.plane import Plane
from artigen.reader.model import Reader
from artigen.reader.read import KIND_EDGE
from artigen.reader.reading import ReadPart
from artigen.reader.wall.face import list_corners

if TYPE_CHECKING:
    from PIL import Image

CHAINED = 0.7
"""Gap between fronts of one column, as a share of the lower of the two."""
OVER = 0.5
"""Share of the narrower front that is above or below the other one in a column."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Column:
    """Fronts above each other, on the plane of the wall."""

    parts: tuple[ReadPart, ...]
    bounds: Float[np.ndarray, "4"]
    """Left, top, right and bottom, y down."""
    shares: dict[str, float]
    """Probabilities of the kinds."""


def make_stacks(
    fronts: Sequence[ReadPart], plane: Plane, image: "Image.Image", reader: Reader
) -> list[list[list[Column]]]:
    """Fronts above each other: for each stack of them, ways to cut it into columns."""
    bounds = plane.bound(list_corners(fronts))
    groups: list[list[int]] = []

    def chain(one: int, other: int) -> bool:
        a, b = bounds[one], bounds[other]
        shared = min(a[2], b[2]) - max(a[0], b[0])
        gap = max(a[1], b[1]) - min(a[3], b[3])
        return shared > OVER * min(a[2] - a[0], b[2] - b[0]) and gap < CHAINED * min(a[3] - a[1], b[3] - b[1])

    for index in range(len(fronts)):
        above = [group for group in groups if any(chain(index, other) for other in group)]
        groups = [group for group in groups if not any(group is one for one in above)]
        groups.append([index, *(other for group in above for other in group)])
    stacks = []
    for group in groups:
        ways = [[group], *_cut(group, bounds)]
        stacks.append([[_make_column(own, fronts, bounds, image, reader) for own in way] for way in ways])
    return stacks


def _cut(group: Sequence[int], bounds: Float[np.ndarray, "N 4"]) -> list[list[list[int]]]:
    """Fronts above each other in two, at each height where none goes on."""
    ways = []
    for end in sorted({float(bounds[index, 3]) for index in group})[:-1]:
        upper = [index for index in group if bounds[index, 3] <= end]
        lower = [index for index in group if bounds[index, 3] > end]
        if (bounds[lower, 1] > end).all():
            ways.append([upper, lower])
    return ways


def _make_column(
    group: Sequence[int],
    fronts: Sequence[ReadPart],
    bounds: Float[np.ndarray, "N 4"],
    image: "Image.Image",
    reader: Reader,
) -> Column:
    parts, held = tuple(fronts[index] for index in group), bounds[list(group)]
    boxes = np.stack([part.box for part in parts])
    return Column(
        parts=parts,
        bounds=np.concatenate([held[:, :2].min(axis=0), held[:, 2:].max(axis=0)]),
        shares=_name_kinds(
            image, np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)]), reader
        ),
    )


@torch.no_grad()
def _name_kinds(image: "Image.Image", box: Float[np.ndarray, "4"], reader: Reader) -> dict[str, float]:
    """Probabilities of the kinds of what is in a box."""
    extent = np.array(image.size)
    middle, side = (box[:2] + box[2:]) / 2 * extent, 1.2 * float(((box[2:] - box[:2]) * extent).max())
    low, high = np.round(middle - side / 2).astype(int), np.round(middle + side / 2).astype(int)
    crop = image.crop((*low.tolist(), *high.tolist())).resize((KIND_EDGE, KIND_EDGE))
    white = np.asarray(crop, dtype=np.uint8)
    alpha = white[..., 3:] / 255.0
    pixels = torch.from_numpy(np.round(alpha * white[..., :3] + 255 * (1 - alpha)).astype(np.uint8))
    with native_autocast(pixels.device):
        shares = reader.kinds(pixels.permute(2, 0, 1)[None]).float()[0, : len(KINDS)].softmax(dim=0)
    return dict(zip(KINDS, shares.tolist(), strict=True))
