"""Footprint of a package for planning: box, swept space, standing places, top."""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

from artigen.errors import ArtigenError
from artigen.transforms import transform_points
from sim_export.files.read import read_package
from sim_export.geometry.contacts import HullSet
from sim_export.package import SimPackage

from ..folder_stamp import kept_until_written
from .sweeps import Sweep, find_sweeps

CHUNKS = 8
"""Number of boxes along the sweep of a door; more follow the arc more closely."""
SLABS = 6
"""Number of slabs of a door across its width."""
LEVEL = 0.004
"""Distance (m) below its highest point that still belongs to an object's top."""
BROAD = 0.25
"""Share of the area of the largest hull of a link, seen from the front, from which on a hull is no handle."""
COVERS = 0.3
"""Least share of an object's area that its deck covers; what is above that, such as a tap, covers less."""
FOOT = 0.03
"""Height (m) above a deck within which what stands on it needs a hole in a worktop on the deck."""
FRONT_LABELS = ("door", "drawer", None)
"""Parts that a robot opens from in front of the object; trays and shelves are behind a door."""


class FootprintError(ArtigenError):
    """A package has no collision shape and cannot be placed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Deck:
    """Level top of a package: height (m), bounds (x, y) of the hole of what is open in its middle or stands
    up from it, and bounds of what stands up from it; both None if nothing does."""

    height: float
    hole: Float[np.ndarray, "2 2"] | None = None
    above: Float[np.ndarray, "2 3"] | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Footprint:
    """A package in its own frame, metres.

    ``body`` is the box of all hulls at rest, ``solid`` are boxes that together contain them: one for
    everything behind the front up to the deck, one for what stands on that, and one for every protruding
    handle. ``sweeps`` are boxes around everything
    that opens, ``fronts`` are rows (x, y): the extent of an open door or drawer, and the middle of its width.
    ``tops`` are convex polygons, counter-clockwise, level with the highest point; ``face`` is x of the front
    without handles.
    """

    body: Float[np.ndarray, "2 3"]
    solid: Float[np.ndarray, "N 2 3"]
    sweeps: Float[np.ndarray, "K 2 3"]
    fronts: Float[np.ndarray, "F 2"]
    tops: tuple[Float[np.ndarray, "V 2"], ...]
    face: float
    deck: Deck

    @property
    def size(self) -> Float[np.ndarray, "3"]:
        """Depth, width and height."""
        return self.body[1] - self.body[0]


@kept_until_written(512)
def cached_package(folder: Path) -> SimPackage:
    """A package on disk without its appearance, cached until its files change."""
    return read_package(folder, appearance=False)


@kept_until_written(512)
def read_footprint(folder: Path) -> Footprint:
    """The footprint of a package on disk, cached until its files change.

    Raises:
        FootprintError: If it has no collision shape.
    """
    return measure_footprint(cached_package(folder))


def measure_footprint(package: SimPackage) -> Footprint:
    """The footprint of a package."""
    if not any(link.hulls for link in package.links):
        raise FootprintError(f"package {package.name!r} has no collision shape; it cannot be placed")
    body = bounds_of(_hull_boxes(package))
    sweeps, fronts = [np.zeros((0, 2, 3))], []
    for sweep in find_sweeps(package):
        boxes = swept_slabs(package, sweep)
        if not len(boxes):
            continue
        sweeps.append(boxes)
        if sweep.label in FRONT_LABELS:
            rest = [hull.vertices for index in sweep.links for hull in package.links[index].hulls]
            sides = np.concatenate(rest)[:, 1]
            fronts.append((float(boxes[:, 0, 0].min()), float(sides.min() + sides.max()) / 2.0))
    face, deck = _face(package), _find_deck(_hull_boxes(package))
    return Footprint(
        body=body,
        solid=_solid_boxes(package, body, face, deck),
        sweeps=np.concatenate(sweeps),
        fronts=np.array(fronts, dtype=np.float64).reshape(-1, 2),
        tops=_level_tops(package, float(body[1, 2])),
        face=face,
        deck=deck,
    )


def _find_deck(boxes: Float[np.ndarray, "H 2 3"]) -> Deck:
    """The highest level on which hulls cover `COVERS` of the area of all; the top if there is none."""
    around = bounds_of(boxes)
    area = float(np.prod((around[1] - around[0])[:2]))
    for top in np.unique(boxes[:, 1, 2])[::-1]:
        level = boxes[np.abs(boxes[:, 1, 2] - top) < LEVEL]
        if float((level[:, 1] - level[:, 0])[:, :2].prod(axis=1).sum()) >= COVERS * area:
            break
    else:
        return Deck(height=float(around[1, 2]))
    height = float(level[:, 1, 2].max())
    above = boxes[boxes[:, 1, 2] > height + 1e-6]
    if not len(above):
        return Deck(height=height)
    middle = (around[0] + around[1])[:2] / 2.0
    low, high = around[0, :2].copy(), around[1, :2].copy()
    for axis in (0, 1):
        before, behind = level[level[:, 1, axis] <= middle[axis]], level[level[:, 0, axis] >= middle[axis]]
        low[axis] = before[:, 1, axis].max(initial=low[axis])
        high[axis] = behind[:, 0, axis].min(initial=high[axis])
    standing = above[above[:, 0, 2] < height + FOOT]
    foot = bounds_of(standing if len(standing) else above)  # a lid touches nothing
    hole = np.array([np.minimum(low, foot[0, :2]), np.maximum(high, foot[1, :2])])
    return Deck(height=height, hole=hole, above=bounds_of(above))


def _solid_boxes(
    package: SimPackage, body: Float[np.ndarray, "2 3"], face: float, deck: Deck
) -> Float[np.ndarray, "N 2 3"]:
    """The body behind ``face``, what stands on its deck, and protrusions in front of it, hull by hull."""
    boxes = _hull_boxes(package)
    behind = body.copy()
    behind[0, 0], behind[1, 2] = face, deck.height
    out = boxes[boxes[:, 0, 0] < face - 1e-3]
    out[:, 1, 0] = np.minimum(out[:, 1, 0], face)
    standing = np.zeros((0, 2, 3)) if deck.above is None else deck.above[None]
    return np.concatenate([behind[None], standing, out])


def _hull_boxes(package: SimPackage) -> Float[np.ndarray, "H 2 3"]:
    """Boxes around the hulls of all links at rest."""
    return HullSet(hulls=tuple(hull for link in package.links for hull in link.hulls)).rest_bounds


def _face(package: SimPackage) -> float:
    """x of the foremost hull that is not small, seen from the front, beside the largest of its link: a panel
    or its frame, not its handle."""
    faces = []
    solid = [link for link in package.links if link.hulls]
    for link in [link for link in solid if link.label not in ("handle", "knob", "wheel")] or solid:
        areas = [float(np.ptp(hull.vertices[:, 1:], axis=0).prod()) for hull in link.hulls]
        broad = (hull for hull, area in zip(link.hulls, areas, strict=True) if area >= BROAD * max(areas))
        faces += [float(hull.vertices[:, 0].min()) for hull in broad]
    return min(faces)


def swept_slabs(package: SimPackage, sweep: Sweep) -> Float[np.ndarray, "K 2 3"]:
    """Boxes around the space that a sweep passes. The moving geometry is cut into slabs across its width and
    the sweep into steps, so that the part of a door near its hinge takes little room."""
    rest = {index: HullSet(hulls=package.links[index].hulls) for index in sweep.links}
    own = {index: hulls.rest_bounds for index, hulls in rest.items() if hulls.hulls}  # H 2 3 each
    if not own:
        return np.zeros((0, 2, 3))
    around = bounds_of(np.concatenate(list(own.values())))
    turns = sweep.joint.type != "prismatic"  # slabs along the axis of a door would all sweep the same
    axis = int(np.argmax((around[1] - around[0]) * (1.0 - turns * np.abs(sweep.joint.axis))))
    edges = np.linspace(around[0, axis], around[1, axis], SLABS + 1)
    pieces = np.array_split(np.arange(len(sweep.T) - 1), min(CHUNKS, len(sweep.T) - 1))
    out = []
    for low, high in pairwise(edges.tolist()):
        steps = [_moved_slab(boxes, sweep.T[:, index], axis, (low, high)) for index, boxes in own.items()]
        bounds = np.concatenate(steps, axis=1)  # P N 2 3
        if not bounds.shape[1]:
            continue
        span = np.stack([bounds[:, :, 0].min(axis=1), bounds[:, :, 1].max(axis=1)], axis=1)  # P 2 3
        for piece in pieces:
            box = bounds_of(span[piece[0] : piece[-1] + 2])
            out.append(box + np.array([[-sweep.slack], [sweep.slack]]))
    return np.array(out).reshape(-1, 2, 3)


def _moved_slab(
    boxes: Float[np.ndarray, "H 2 3"],
    T: Float[np.ndarray, "P 4 4"],
    axis: int,
    span: tuple[float, float],
) -> Float[np.ndarray, "P N 2 3"]:
    """Boxes of hulls, cut to a slab and moved, with new bounds at every pose."""
    cut = boxes.copy()
    cut[:, 0, axis] = np.maximum(cut[:, 0, axis], span[0])
    cut[:, 1, axis] = np.minimum(cut[:, 1, axis], span[1])
    cut = cut[cut[:, 0, axis] < cut[:, 1, axis]]
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    points = np.where(corners[None] == 0, cut[:, :1], cut[:, 1:])  # N 8 3
    moved = transform_points(T, points.reshape(-1, 3)).reshape(len(T), len(cut), 8, 3)
    return np.stack([moved.min(axis=2), moved.max(axis=2)], axis=2)


def bounds_of(boxes: Float[np.ndarray, "N 2 3"]) -> Float[np.ndarray, "2 3"]:
    """The box around boxes."""
    return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def _level_tops(package: SimPackage, height: float) -> tuple[Float[np.ndarray, "V 2"], ...]:
    """Outlines of the level faces at ``height`` of links that do not move."""
    moved = {index for sweep in find_sweeps(package) for index in sweep.links}
    tops = []
    for index, link in enumerate(package.links):
        if index in moved:
            continue
        for hull in link.hulls:
            points = hull.vertices[hull.vertices[:, 2] > height - LEVEL, :2]
            outline = outline_of(points)
            if len(outline) >= 3:
                tops.append(outline)
    return tuple(tops)


@kept_until_written(512)
def is_level(folder: Path, end: Literal["bottom", "top"]) -> bool:
    """Whether at least half of an object's underside is level (it has no legs), or of its top (no rails for a
    worktop that is laid on later)."""
    boxes = _hull_boxes(cached_package(folder))
    around, at = bounds_of(boxes), int(end == "top")
    outer = boxes[np.abs(boxes[:, at, 2] - around[at, 2]) < LEVEL]
    level = (outer[:, 1] - outer[:, 0])[:, :2].prod(axis=1).sum()
    return bool(level >= 0.5 * (around[1] - around[0])[:2].prod())


def outline_of(points: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, "V 2"]:
    """Corners of the convex outline, counter-clockwise; empty if the points have no area."""
    from scipy.spatial import ConvexHull

    if len(points) < 3 or np.linalg.matrix_rank(points - points[0], tol=1e-4) < 2:
        return np.zeros((0, 2))
    return points[ConvexHull(points).vertices]


def carries(
    tops: tuple[Float[np.ndarray, "V 2"], ...], points: Float[np.ndarray, "N 2"]
) -> Bool[np.ndarray, "N"]:
    """Whether points lie on one of the level faces."""
    carried = np.zeros(len(points), dtype=bool)
    for outline in tops:
        edges = np.roll(outline, -1, axis=0) - outline
        arms = points[:, None] - outline  # N V 2
        inside = edges[:, 0] * arms[..., 1] - edges[:, 1] * arms[..., 0] >= -1e-9
        carried |= inside.all(axis=1)
    return carried


def standing_places(
    footprint: Footprint, radius: float, front: float | None = None
) -> Float[np.ndarray, "F 2"]:
    """Centres (object frame) of discs in front of the open parts; empty for radius 0.

    Args:
        radius: Radius of the disc, metres.
        front: x of the front of the object's support, if that protrudes farther.
    """
    if radius <= 0.0:
        return np.zeros((0, 2))
    places = footprint.fronts.copy()
    nearest = footprint.body[0, 0] if front is None else min(front, float(footprint.body[0, 0]))
    places[:, 0] = np.minimum(places[:, 0], nearest) - radius - 1e-3
    return np.unique(np.round(places, 4), axis=0)
