"""What the network's maps say, as things with boxes."""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional

from artigen.reader.labels import THINGS
from artigen.reader.network import ATTRIBUTES, STRIDE, Maps

LEAST_SCORE = 0.05
"""Score below which a peak is nothing."""
MOST = 60
"""Largest number of things of one sort."""
SAME = 0.45
"""Overlap (intersection over union) from which two boxes of one sort are one thing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """Things of one sort in one picture, by falling score."""

    score: Float[np.ndarray, "N"]
    box: Float[np.ndarray, "N 4"]
    """Left, top, right, bottom (pixels)."""
    corners: Float[np.ndarray, "N 4 2"]
    """From the upper left clockwise (pixels)."""
    attributes: dict[str, Float[np.ndarray, "N C"]]
    """As in `artigen.reader.network.ATTRIBUTES`, boxes and corners aside: logits, and numbers."""

    def __len__(self) -> int:
        return len(self.score)


def mirror_maps(maps: Maps) -> Maps:
    """Maps of mirrored pictures as those of the pictures."""
    out = {}
    for name, values in maps.attributes.items():
        values = values.flip(3)
        if name == "box":
            values = values.unflatten(1, (len(THINGS), 4))[:, :, [2, 1, 0, 3]].flatten(1, 2)
        elif name == "corners":  # shares of the box: x becomes 1 - x, left and right corners change places
            points = values.unflatten(1, (4, 2))[:, [1, 0, 3, 2]]
            values = torch.stack([1 - points[:, :, 0], points[:, :, 1]], dim=2).flatten(1, 2)
        elif name == "hinge":
            values = values[:, [1, 0, 2, 3]]
        elif name == "view":
            values = values * values.new_tensor([-1.0, 1.0, 1.0])[:, None, None]
        out[name] = values
    return Maps(heat=maps.heat.flip(3), attributes=out)


def average_maps(one: Maps, other: Maps) -> Maps:
    """The mean of two readings of the same pictures."""
    return Maps(
        heat=(one.heat + other.heat) / 2,
        attributes={name: (values + other.attributes[name]) / 2 for name, values in one.attributes.items()},
    )


def find_things(maps: Maps, least: float = LEAST_SCORE) -> list[list[Found]]:
    """Things of every picture, by `THINGS`."""
    score = maps.heat.sigmoid()
    peaks = score * (functional.max_pool2d(score, 3, 1, 1) == score)
    return [
        [_find_sort(maps, peaks, picture, thing, least) for thing in range(len(THINGS))]
        for picture in range(len(score))
    ]


def _find_sort(maps: Maps, peaks: Tensor, picture: int, thing: int, least: float) -> Found:
    width = peaks.shape[3]
    score, place = peaks[picture, thing].flatten().topk(min(MOST, peaks[0, 0].numel()))
    place, score = place[score > least], score[score > least]
    at = {name: values[picture].flatten(1)[:, place].T for name, values in maps.attributes.items()}
    middle = torch.stack([place % width, place // width], dim=1) * STRIDE + STRIDE / 2
    reach = at.pop("box").unflatten(1, (len(THINGS), 4))[:, thing].clamp(-1, 7).exp()
    box = torch.cat([middle - reach[:, :2], middle + reach[:, 2:]], dim=1)
    corners = at.pop("corners").unflatten(1, (4, 2)) * (box[:, 2:] - box[:, :2])[:, None] + box[:, None, :2]
    kept = _keep_apart(box.numpy())
    return Found(
        score=score.numpy()[kept],
        box=box.numpy()[kept],
        corners=corners.numpy()[kept],
        attributes={name: values.numpy()[kept] for name, values in at.items() if name in ATTRIBUTES},
    )


def _keep_apart(boxes: Float[np.ndarray, "N 4"]) -> list[int]:
    """Indices of boxes that overlap no earlier one much."""
    kept: list[int] = []
    for index, box in enumerate(boxes):
        if not kept or overlaps(boxes[kept], box).max() < SAME:
            kept.append(index)
    return kept


def overlaps(boxes: Float[np.ndarray, "N 4"], box: Float[np.ndarray, "4"]) -> Float[np.ndarray, "N"]:
    """Intersection over union of boxes with one box."""
    sides = np.clip(np.minimum(boxes[:, 2:], box[2:]) - np.maximum(boxes[:, :2], box[:2]), 0, None)
    shared = sides.prod(axis=1)
    union = (boxes[:, 2:] - boxes[:, :2]).prod(axis=1) + float((box[2:] - box[:2]).prod()) - shared
    return shared / np.maximum(union, 1e-9)
