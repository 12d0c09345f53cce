"""Free space for an object: inside an open drawer, or on a floor of the compartment behind an open door.

Found in the collision hulls, column by column, so that it agrees with the physics engine.
"""

import functools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from artigen.transforms import transform_points
from sim_export.geometry.hulls import hull_planes
from sim_export.package import Hull

from .hulls import hulls_at, open_above_ground
from .objects import TaskObject, TaskPart
from .placement import outward, part_motion

CELL = 0.01
LEVEL = 0.004
"""Largest height variation of a floor, metres."""
DEPTH_OF_REACH = 0.30
"""Depth behind the front to which a compartment's floor is used, metres."""
HEADROOM = 0.16
"""Free height that a gripper needs above a compartment's floor, metres."""
LEAST_OPEN = 0.7
"""Smallest share of the requested opening that a part must reach before it meets the ground."""
RIM = 0.025
"""Smallest depth of a drawer's tray, metres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Container:
    """Space in which a cube may come to rest.

    ``region`` is a box [low, high] in the object frame at rest, its lower face the floor; it moves with
    ``link``. ``aim`` is the middle of the reachable part of the floor with the part open, in the same frame;
    ``inwards`` is the horizontal direction into the space, and ``down`` is true if a hand enters from above,
    into a drawer.
    """

    link: str
    region: Float[np.ndarray, "2 3"]
    aim: Float[np.ndarray, "3"]
    inwards: Float[np.ndarray, "3"]
    down: bool


@functools.lru_cache(maxsize=1024)
def find_container(entry: TaskObject, part: TaskPart, opened: float, size: float) -> Container | None:
    """Space in a drawer, or behind a door, for a cube of edge ``size`` (m) with some clearance.

    Args:
        opened: Fraction of its range at which the part stands.

    Returns:
        ``None`` if there is no such space: a drawer front without a tray, a compartment full of shelves.
    """
    if part.joint.type == "prismatic" and part.kind == "drawer":
        return _in_drawer(entry, part, opened, size)
    return _behind_door(entry, part, size)


def room_when_open(entry: TaskObject, part: TaskPart, wanted: float, size: float) -> Container | None:
    """Space with the part open to ``wanted``, or as far as it opens before it meets the ground; None if that
    is much less."""
    opened = open_above_ground(entry, part, wanted)
    return None if opened < LEAST_OPEN * wanted else find_container(entry, part, opened, size)


def column_spans(
    hulls: tuple[Hull, ...], xy: Float[np.ndarray, "M 2"]
) -> tuple[Float[np.ndarray, "H M"], Float[np.ndarray, "H M"]]:
    """Lowest and highest z of vertical lines in each hull; +inf and -inf for a miss."""
    low, high = np.full((len(hulls), len(xy)), np.inf), np.full((len(hulls), len(xy)), -np.inf)
    for index, hull in enumerate(hulls):
        planes = hull_planes(hull)
        normals = planes[:, :3]
        rest = planes[:, 3:] - normals[:, :2] @ xy.T  # n_z z <= rest
        up, down = normals[:, 2] > 1e-6, normals[:, 2] < -1e-6
        inside = (rest[~up & ~down] >= -1e-9).all(axis=0)
        top = (rest[up] / normals[up, 2, None]).min(axis=0, initial=np.inf)
        bottom = (rest[down] / normals[down, 2, None]).max(axis=0, initial=-np.inf)
        hit = inside & (bottom <= top) & np.isfinite(top) & np.isfinite(bottom)
        low[index, hit], high[index, hit] = bottom[hit], top[hit]
    return low, high


def largest_rectangle(mask: Bool[np.ndarray, "X Y"]) -> tuple[int, int, int, int]:
    """The largest all-true rectangle as (x0, x1, y0, y1), ends excluded; zeros if there is none."""
    best, found = 0, (0, 0, 0, 0)
    heights = np.zeros(mask.shape[1], dtype=int)
    for x, row in enumerate(mask):
        heights = np.where(row, heights + 1, 0)
        for y0 in range(mask.shape[1]):
            height = heights[y0]
            for y1 in range(y0, mask.shape[1]):
                height = min(height, heights[y1])
                if height == 0:
                    break
                if height * (y1 - y0 + 1) > best:
                    best, found = height * (y1 - y0 + 1), (x - height + 1, x + 1, y0, y1 + 1)
    return found


def _in_drawer(entry: TaskObject, part: TaskPart, opened: float, size: float) -> Container | None:
    hulls, others = hulls_at(entry, part, {})
    xs, ys, xy = _grid(part.moved.min(axis=0), part.moved.max(axis=0))
    tops = column_spans(hulls, xy)[1].max(axis=0, initial=-np.inf)
    solid = np.isfinite(tops)
    # The rim is that of the tray, not of the front: half of the walls reach it.
    levels = np.round(tops[solid] / LEVEL).astype(int)
    if not len(levels):
        return None
    values, counts = np.unique(levels, return_counts=True)
    floor = float(values[counts.argmax()] * LEVEL)
    flat = solid & (np.abs(tops - floor) <= LEVEL)
    walls = tops[solid & (tops > floor + LEVEL)]
    if not len(walls) or np.median(walls) < floor + RIM:
        return None
    shift = transform_points(part_motion(part, np.array([opened]))[0], np.c_[xy, np.full(len(xy), floor)])
    roof = column_spans(others, shift[:, :2])[1].max(axis=0, initial=-np.inf)
    reachable = flat & (roof < floor)
    top, inwards = float(np.median(walls)), -part.joint.axis
    return _fit(part.joint.child, xs, ys, flat, reachable, floor, top, size, inwards, down=True)


def _behind_door(entry: TaskObject, part: TaskPart, size: float) -> Container | None:
    _, others = hulls_at(entry, part, {})
    inwards = -outward(entry, part)
    if abs(inwards[0]) < 0.9:
        return None
    low, high = part.moved.min(axis=0), part.moved.max(axis=0)
    front = low[0] if inwards[0] > 0 else high[0]
    ends = np.sort([front + inwards[0] * 0.03, front + inwards[0] * DEPTH_OF_REACH])
    xs, ys, xy = _grid(np.array([ends[0], low[1] + 0.03, 0.0]), np.array([ends[1], high[1] - 0.03, 0.0]))
    bottoms, tops = column_spans(others, xy)
    found: list[Container] = []
    for floor in np.unique(np.round(tops[np.isfinite(tops)] / LEVEL)) * LEVEL:
        if not low[2] - 0.05 <= floor <= high[2] - HEADROOM:
            continue
        flat = (np.abs(tops - floor) <= LEVEL).any(axis=0)
        roof = np.where(tops > floor + LEVEL, bottoms, np.inf).min(axis=0, initial=np.inf)
        free = flat & (roof > floor + HEADROOM)
        top = float(min(floor + HEADROOM, high[2]))
        space = _fit(part.joint.parent, xs, ys, free, free, float(floor), top, size, inwards, down=False)
        found += [] if space is None else [space]
    return max(found, key=lambda space: np.prod(np.ptp(space.region, axis=0)[:2]), default=None)


def _fit(
    link: str, xs: np.ndarray, ys: np.ndarray, flat: np.ndarray, reachable: np.ndarray, floor: float,
    top: float, size: float, inwards: np.ndarray, *, down: bool,
) -> Container | None:  # fmt: skip
    """The largest flat rectangle as a region, and the middle of its reachable part."""
    shape = (len(xs), len(ys))
    x0, x1, y0, y1 = largest_rectangle(flat.reshape(shape))
    a0, a1, b0, b1 = largest_rectangle(reachable.reshape(shape))
    need = int(np.ceil(1.5 * size / CELL))
    if min(x1 - x0, y1 - y0, a1 - a0, b1 - b0) < need:
        return None
    aim = np.array([(xs[a0] + xs[a1 - 1]) / 2.0, (ys[b0] + ys[b1 - 1]) / 2.0, floor])
    low = np.array([min(xs[x0], xs[a0]), min(ys[y0], ys[b0]), floor])
    high = np.array([max(xs[x1 - 1], xs[a1 - 1]), max(ys[y1 - 1], ys[b1 - 1]), top])
    level = np.array([inwards[0], inwards[1], 0.0])
    level /= np.linalg.norm(level)
    return Container(link=link, region=np.stack([low, high]), aim=aim, inwards=level, down=down)


def _grid(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cell centres along x and y, and all of them as points."""
    xs = np.arange(low[0] + CELL / 2.0, high[0], CELL)
    ys = np.arange(low[1] + CELL / 2.0, high[1], CELL)
    return xs, ys, np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1).reshape(-1, 2)
