"""Free boxes inside furniture for loose things: on the floor of a drawer, and on a floor behind a door.

They are found on the bounds of collision hulls, which are exact for boxes and otherwise larger: at rest, and
throughout the sweep of every door and drawer.
"""

import heapq
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.kind import find_kind
from artigen.transforms import inverse
from sim_export.geometry.contacts import HullSet
from sim_export.package import Link, SimPackage

from ..folder_stamp import kept_until_written
from .footprints import bounds_of, cached_package
from .sweeps import find_sweeps, sweep_boxes

CupboardKind = Literal["drawer", "shelf"]
CLEARANCE = 0.005
"""Distance (m) from walls, and from everything above."""
HEIGHT = {"drawer": 0.035, "shelf": 0.09}
"""Smallest height (m) of a compartment."""
SIDE = 0.1
"""Smallest side (m) of a compartment's floor."""
RIM = 0.025
"""Smallest height (m) of the walls around the floor of a drawer."""
LEVEL = 1e-4
"""Height variation (m) of a floor."""
PER_FLOOR = 3
"""Largest number of compartments on a floor."""


@dataclass(frozen=True, kw_only=True)
class Compartment:
    """A free box (m) over a floor of a link, in the object frame at rest; it moves with the link."""

    link: str
    kind: CupboardKind
    open: bool = False
    """Whether it is a shelf without a door before it."""
    low: tuple[float, float, float]
    high: tuple[float, float, float]


@kept_until_written(512)
def cached_compartments(folder: Path) -> tuple[Compartment, ...]:
    """The compartments of a package on disk, cached until its files change."""
    return find_compartments(cached_package(folder))


def find_compartments(package: SimPackage) -> tuple[Compartment, ...]:
    """All compartments, in the order of links and floors."""
    moved = {index for sweep in find_sweeps(package) for index in sweep.links}
    sliding = {
        joint.child for joint in package.joints if joint.type == "prismatic" and abs(joint.axis[2]) < 0.1
    }
    doors = [link for link in package.links if link.label == "door" and link.hulls]
    fronts = [bounds_of(_bounds(link)) for link in doors]
    kind = find_kind(package.category)
    cupboard = kind is not None and kind.holds is not None  # else only drawers are compartments
    found: list[Compartment] = []
    for index, link in enumerate(package.links):
        if not link.hulls:
            continue
        if link.name in sliding and (link.label == "drawer" or (link.label == "tray" and cupboard)):
            found += _on_floors(package, index, "drawer", [])
        elif index not in moved and cupboard and fronts:
            found += _on_floors(package, index, "shelf", fronts)
        if index not in moved and cupboard:
            found += _on_floors(package, index, "shelf", fronts, bare=True)
    return tuple(found)


def _on_floors(
    package: SimPackage,
    index: int,
    kind: CupboardKind,
    fronts: list[Float[np.ndarray, "2 3"]],
    *,
    bare: bool = False,
) -> Iterator[Compartment]:
    """Compartments on the floors of a link: those of a drawer, behind doors, or ``bare`` of any."""
    link, solid = package.links[index], _obstacles(package, index)
    still = np.concatenate([_bounds(other) for other in package.links if other.hulls])
    for level, floor in _floors(link):
        starts, behind = [floor], []
        if kind == "shelf":
            behind = [front for front in fronts if front[0, 2] - 0.05 < level < front[1, 2] - HEIGHT[kind]]
            starts = [floor] if bare else [_within(floor, front) for front in behind]
        above = solid[solid[:, 1, 2] > level + LEVEL]
        wide = above[:, :, :2] + np.array([[-CLEARANCE], [CLEARANCE]])
        taken = wide[above[:, 0, 2] < level + HEIGHT[kind] + CLEARANCE]
        if bare:
            hidden = [_within(np.array([[-9.0, -9.0], [9.0, 9.0]]), front) for front in behind]
            taken = np.concatenate([taken, *(area[None] for area in hidden)])
        for start in starts:
            for _ in range(PER_FLOOR):
                free = largest_free(start, taken)
                if free is None:
                    break
                taken = np.concatenate([taken, free[None]])
                over = (np.minimum(wide[:, 1], free[1]) > np.maximum(wide[:, 0], free[0])).all(axis=1)
                roof = float(above[over, 0, 2].min(initial=np.inf))
                if _roofed(still, free, level) and (kind == "shelf" or _walled(_bounds(link), free, level)):
                    low, high = ((float(x), float(y)) for x, y in free)
                    yield Compartment(
                        link=link.name,
                        kind=kind,
                        open=bare,
                        low=(*low, level),
                        high=(*high, roof - CLEARANCE),
                    )


def largest_free(
    area: Float[np.ndarray, "2 2"], taken: Float[np.ndarray, "N 2 2"]
) -> Float[np.ndarray, "2 2"] | None:
    """The largest rectangle in ``area`` that meets no other one, with sides from `SIDE`; None without one.

    Best-first search: a rectangle that meets an obstacle is replaced by its parts on the four sides of it.
    """
    order = count()
    waiting = [(-_area(area), next(order), area)]
    seen = set()
    while waiting:
        _, _, now = heapq.heappop(waiting)
        if (now[1] - now[0] < SIDE).any() or now.tobytes() in seen:
            continue
        seen.add(now.tobytes())
        inside = np.minimum(taken[:, 1], now[1]) - np.maximum(taken[:, 0], now[0])
        meets = taken[(inside > 1e-9).all(axis=1)]
        if not len(meets):
            return now
        block = meets[np.abs(meets.mean(axis=1) - now.mean(axis=0)).sum(axis=1).argmin()]
        for axis in (0, 1):
            for end in (0, 1):
                part = now.copy()
                part[1 - end, axis] = block[end, axis]
                heapq.heappush(waiting, (-_area(part), next(order), part))
    return None


def _area(rectangle: Float[np.ndarray, "2 2"]) -> float:
    return float(np.prod(np.maximum(rectangle[1] - rectangle[0], 0.0)))


def _within(floor: Float[np.ndarray, "2 2"], front: Float[np.ndarray, "2 3"]) -> Float[np.ndarray, "2 2"]:
    """The part of a floor behind a door."""
    part = floor.copy()
    part[0, 1], part[1, 1] = max(part[0, 1], front[0, 1]), min(part[1, 1], front[1, 1])
    return part


def _bounds(link: Link) -> Float[np.ndarray, "H 2 3"]:
    return HullSet(hulls=link.hulls).rest_bounds


def _floors(link: Link) -> Iterator[tuple[float, Float[np.ndarray, "2 2"]]]:
    """Height and rectangle of every level, rectangular top of a hull."""
    from scipy.spatial import ConvexHull, QhullError

    for hull in link.hulls:
        level = float(hull.vertices[:, 2].max())
        top = hull.vertices[hull.vertices[:, 2] > level - LEVEL, :2]
        rectangle = np.stack([top.min(axis=0), top.max(axis=0)])
        if len(top) < 4 or (rectangle[1] - rectangle[0] < SIDE).any():
            continue
        try:
            filled = ConvexHull(top).volume
        except QhullError:
            continue
        if filled > 0.999 * _area(rectangle):
            yield level, rectangle


def _obstacles(package: SimPackage, index: int) -> Float[np.ndarray, "N 2 3"]:
    """Bounds of all hulls in the frame of a link: at rest, and while a joint moves it or them."""
    boxes = [_bounds(link) for link in package.links if link.hulls]
    for sweep in find_sweeps(package):
        rides = index in sweep.links
        others = tuple(other for other in range(len(package.links)) if (other in sweep.links) != rides)
        relative = inverse(sweep.T[:, index])[:, None] @ sweep.T
        swept, _ = sweep_boxes(package, replace(sweep, links=others, T=relative), np.eye(4))
        boxes.append(swept.reshape(-1, 2, 3))
    return np.concatenate(boxes)


def _roofed(boxes: Float[np.ndarray, "H 2 3"], free: Float[np.ndarray, "2 2"], level: float) -> bool:
    """Whether something is above every part of a rectangle: the basin of a sink is no compartment."""
    roofs = boxes[boxes[:, 0, 2] > level + LEVEL]
    shares = np.stack(np.meshgrid(*2 * [np.linspace(0.05, 0.95, 5)]), axis=-1).reshape(-1, 1, 2)
    points = free[0] + shares * (free[1] - free[0])
    covered = (points >= roofs[:, 0, :2]) & (points <= roofs[:, 1, :2])
    return bool(covered.all(axis=2).any(axis=1).all())


def _walled(boxes: Float[np.ndarray, "H 2 3"], free: Float[np.ndarray, "2 2"], level: float) -> bool:
    """Whether walls of a drawer surround a rectangle on its floor."""
    walls = boxes[(boxes[:, 0, 2] < level + RIM) & (boxes[:, 1, 2] > level + RIM)]
    for axis in (0, 1):
        along, (start, stop) = walls[:, :, 1 - axis], free[:, 1 - axis]
        across = np.minimum(along[:, 1], stop) - np.maximum(along[:, 0], start)
        for gap in (free[0, axis] - walls[:, 1, axis], walls[:, 0, axis] - free[1, axis]):
            beside = (gap > 0.0) & (gap < 0.05)
            if np.maximum(across[beside], 0.0).sum() < 0.8 * (stop - start):
                return False
    return True
