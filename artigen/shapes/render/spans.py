"""Pixels that can see each primitive: rows and columns of the projected box of each instance.

The projection of a box is convex, so it covers one span of columns per picture row. Only the pixels of spans
are tested against the solid inside the box.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.shapes.render.cameras import Cameras, camera_axes, pixel_sizes
from artigen.shapes.render.scene import Instances

NEAR = 0.01
"""Near clipping distance (m)."""
SLACK = 0.01
"""Margin of spans around the projection (pixels), so that rounding opens no cracks."""
EDGES = tuple((a, b) for a in range(8) for b in range(a + 1, 8) if bin(a ^ b).count("1") == 1)
"""Pairs of box corners that an edge connects."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Spans:
    """Runs of pixels: of instance ``instance``, in row ``row``, ``count`` pixels from ``column``."""

    instance: Int[Tensor, "L"]
    row: Int[Tensor, "L"]
    column: Int[Tensor, "L"]
    count: Int[Tensor, "L"]


def view_points(
    cameras: Cameras, image: Int[Tensor, "I"], points: Float[Tensor, "I K 3"]
) -> Float[Tensor, "I K 3"]:
    """Right, down and forward coordinates (m) in the camera of each image."""
    axes = camera_axes(cameras)[image]
    return (points - cameras.position.double()[image][:, None]) @ axes.mT


def find_spans(cameras: Cameras, instances: Instances) -> Spans:
    """All runs of pixels that may see an instance."""
    local = view_points(cameras, instances.image, instances.corners)
    depth = local[:, :, 2]
    hidden = depth.amax(dim=1) < NEAR
    around = (depth.amin(dim=1) < NEAR) & ~hidden  # extends behind the camera: may be visible anywhere
    pixel = pixel_sizes(cameras)[instances.image]
    plane = (local[:, :, :2] / depth.clamp(min=NEAR)[..., None] / pixel[:, None, None]).float()
    x, y = plane[:, :, 0] + cameras.width / 2, plane[:, :, 1] + cameras.height / 2
    top = torch.where(around, 0.0, y.amin(dim=1))
    bottom = torch.where(around, float(cameras.height), y.amax(dim=1))
    top = torch.where(hidden, float(cameras.height + 1), top)
    first = _first_pixel(top, cameras.height)
    rows = (_last_pixel(bottom, cameras.height) - first + 1).clamp(min=0)
    instance = torch.repeat_interleave(rows)
    row = count_up(rows) + first[instance]
    at = torch.minimum(torch.maximum(row + 0.5, top[instance]), bottom[instance])
    left, right = _cross_edges(x[instance], y[instance], at)
    left = torch.where(around[instance], 0.0, left)
    right = torch.where(around[instance], float(cameras.width), right)
    column = _first_pixel(left, cameras.width)
    count = (_last_pixel(right, cameras.width) - column + 1).clamp(min=0)
    kept = count > 0
    return Spans(instance=instance[kept], row=row[kept], column=column[kept], count=count[kept])


def _cross_edges(
    x: Float[Tensor, "L 8"], y: Float[Tensor, "L 8"], at: Float[Tensor, "L"]
) -> tuple[Tensor, Tensor]:
    """Smallest and largest column at which the edges of each projected box cross a height."""
    start, end = (torch.tensor(side, device=x.device) for side in zip(*EDGES, strict=True))
    xa, xb, ya, yb = x[:, start], x[:, end], y[:, start], y[:, end]
    at = at[:, None]
    rise = yb - ya
    share = ((at - ya) / torch.where(rise.abs() < 1e-6, 1e-6, rise)).clamp(0.0, 1.0)
    column = xa + share * (xb - xa)
    crosses = (ya - at) * (yb - at) <= 0
    left = torch.where(crosses, column, torch.inf).amin(dim=1)
    return left, torch.where(crosses, column, -torch.inf).amax(dim=1)


def _first_pixel(low: Tensor, size: int) -> Tensor:
    return torch.ceil(low - 0.5 - SLACK).clamp(0, size).long()


def _last_pixel(high: Tensor, size: int) -> Tensor:
    return torch.floor(high - 0.5 + SLACK).clamp(-1, size - 1).long()


def count_up(counts: Int[Tensor, "N"]) -> Int[Tensor, "M"]:
    """Concatenates the ranges 0 to ``counts[k] - 1``."""
    ends = counts.cumsum(0)
    total = int(ends[-1]) if len(counts) else 0
    return torch.arange(total, device=counts.device) - torch.repeat_interleave(ends - counts, counts)


def pick(values: Float[Tensor, "N S"], index: Int[Tensor, "M"]) -> Float[Tensor, "S M"]:
    """``values[index]``, transposed: several times faster than indexing, and in the memory order of the
    loops."""
    return values.T.contiguous().index_select(1, index)
