"""What the network's maps say, as things with boxes."""

from dataclasses import dataclass, replace

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor
from torch.nn import functional

from artigen.reader.boxes import overlap_boxes
from artigen.reader.labels import THINGS
from artigen.reader.network import ATTRIBUTES, STRIDE, Maps

LEAST_SCORE = 0.05
"""Score below which a peak is nothing."""
MOST = 60
"""Largest number of things of one sort."""
SAME = 0.45
"""Overlap (intersection over union) from which two boxes of one sort are one thing."""


AROUND = 0.05
"""Reach of the cells whose boxes are averaged, as a share of the box's sides; at least one cell."""


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

    def take(self, indices: Int[np.ndarray, "M"]) -> "Found":
        """Some of the things."""
        return Found(
            score=self.score[indices],
            box=self.box[indices],
            corners=self.corners[indices],
            attributes={name: values[indices] for name, values in self.attributes.items()},
        )

    def move(self, boxes: Float[np.ndarray, "N 4"]) -> "Found":
        """The things in other boxes, with their corners where they were in those."""
        old, new = (box.reshape(-1, 1, 2, 2) for box in (self.box, boxes))
        shares = (self.corners - old[:, :, 0]) / np.maximum(old[:, :, 1] - old[:, :, 0], 1e-6)
        corners = new[:, :, 0] + shares * (new[:, :, 1] - new[:, :, 0])
        return replace(self, box=boxes, corners=corners)


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


def find_things(maps: Maps) -> list[list[Found]]:
    """Things of every picture, by `THINGS`."""
    score = maps.heat.sigmoid()
    peaks = score * (functional.max_pool2d(score, 3, 1, 1) == score)
    return [
        [_find_sort(maps, peaks, picture, thing) for thing in range(len(THINGS))]
        for picture in range(len(score))
    ]


def _find_sort(maps: Maps, peaks: Tensor, picture: int, thing: int) -> Found:
    width = peaks.shape[3]
    score, place = peaks[picture, thing].flatten().topk(min(MOST, peaks[0, 0].numel()))
    place, score = place[score > LEAST_SCORE], score[score > LEAST_SCORE]
    at = {name: values[picture].flatten(1)[:, place].T for name, values in maps.attributes.items()}
    del at["box"]
    reach = maps.attributes["box"][picture].unflatten(0, (len(THINGS), 4))[thing]
    box = _average_boxes(
        torch.stack([place // width, place % width], dim=1).numpy(),
        reach.clamp(-1, 7).exp().permute(1, 2, 0).numpy(),
        maps.heat[picture, thing].sigmoid().numpy(),
    )
    corners = at.pop("corners").unflatten(1, (4, 2)).numpy() * (box[:, 2:] - box[:, :2])[:, None]
    kept = _keep_apart(box)
    return Found(
        score=score.numpy()[kept],
        box=box[kept],
        corners=(corners + box[:, None, :2])[kept],
        attributes={name: values.numpy()[kept] for name, values in at.items() if name in ATTRIBUTES},
    )


def _average_boxes(
    peaks: Int[np.ndarray, "N 2"], reach: Float[np.ndarray, "h w 4"], heat: Float[np.ndarray, "h w"]
) -> Float[np.ndarray, "N 4"]:
    """Boxes (pixels) of peaks (row, column): the mean, weighted by heat, of those of the cells around."""
    rows, columns = np.indices(heat.shape) * STRIDE + STRIDE / 2
    boxes = np.stack(
        [columns - reach[..., 0], rows - reach[..., 1], columns + reach[..., 2], rows + reach[..., 3]], axis=2
    )
    out = np.zeros((len(peaks), 4), np.float32)
    for number, (row, column) in enumerate(peaks):
        x0, y0, x1, y1 = boxes[row, column]
        wide, high = (max(1, int(AROUND * extent / STRIDE)) for extent in (x1 - x0, y1 - y0))
        near = (slice(max(0, row - high), row + high + 1), slice(max(0, column - wide), column + wide + 1))
        out[number] = np.average(boxes[near].reshape(-1, 4), axis=0, weights=heat[near].ravel())
    return out


def _keep_apart(boxes: Float[np.ndarray, "N 4"]) -> list[int]:
    """Indices of boxes that overlap no earlier one much."""
    kept: list[int] = []
    for index, box in enumerate(boxes):
        if not kept or overlap_boxes(boxes[kept], box[None]).max() < SAME:
            kept.append(index)
    return kept
