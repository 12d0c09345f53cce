"""Antipodal pairs of contacts: two places of a link's hulls that face away from each other."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from sim_export.geometry.hulls import face_planes, hull_triangles, inside_hulls
from sim_export.geometry.rays import plane_axes
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import area_normals
from sim_export.package import Hull

FRICTION = 0.6
"""Coefficient of friction between pads and part: rubber on painted wood, plastic or metal."""
SAMPLES = 400
"""Points on the surface in question; more find smaller places and cost time."""
MOST = 56
"""Pairs kept, the first of every neighbourhood."""
PLATES = 8
"""Directions in half a turn in which parallel plates close."""
EVEN = 1e-5
SKIN = 2e-4
"""Depth (m) below which another hull must not cover a contact."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Pairs:
    """Contacts ``first`` and ``second`` with their outward unit normals, object frame at rest, metres."""

    first: Float[np.ndarray, "P 3"]
    second: Float[np.ndarray, "P 3"]
    normal_first: Float[np.ndarray, "P 3"]
    normal_second: Float[np.ndarray, "P 3"]

    def __len__(self) -> int:
        return len(self.first)

    @property
    def width(self) -> Float[np.ndarray, "P"]:
        """Distance of the contacts."""
        return np.linalg.norm(self.second - self.first, axis=1)

    @property
    def middle(self) -> Float[np.ndarray, "P 3"]:
        """Points halfway between them."""
        return (self.first + self.second) / 2.0

    @property
    def axis(self) -> Float[np.ndarray, "P 3"]:
        """Unit direction from the first to the second."""
        return (self.second - self.first) / self.width[:, None]

    @property
    def angle(self) -> Float[np.ndarray, "P"]:
        """The larger angle (rad) between a normal and the axis through the contacts."""
        cosines = np.stack([-self.normal_first, self.normal_second]) * self.axis
        return np.arccos(np.clip(cosines.sum(axis=2), -1.0, 1.0)).max(axis=0)

    def some(self, chosen: Bool[np.ndarray, "P"] | np.ndarray) -> "Pairs":
        """The chosen pairs."""
        return Pairs(
            first=self.first[chosen],
            second=self.second[chosen],
            normal_first=self.normal_first[chosen],
            normal_second=self.normal_second[chosen],
        )


def find_pairs(
    hulls: Sequence[Hull],
    region: Float[np.ndarray, "8 3"] | None = None,
    normal: Float[np.ndarray, "3"] | None = None,
    fine: int = 1,
) -> Pairs:
    """Pairs of contacts on the surface of a union of hulls, within the cone of `FRICTION`.

    Args:
        hulls: Hulls of one link.
        region: Corners of the box in which the first contact lies; everywhere without.
        normal: Direction about which `calipers` are turned; none without.
        fine: Times as many pairs, and directions of calipers.
    """
    found = _face_pairs(hulls, region)
    if normal is not None:
        rims = calipers(held_hulls(hulls, region), normal, fine * PLATES)
        found = Pairs(
            **{name: np.concatenate([value, vars(found)[name]]) for name, value in vars(rims).items()}
        )
    return _spread(found.some(found.angle <= np.arctan(FRICTION)), fine * MOST)


def calipers(held: Sequence[Hull], normal: Float[np.ndarray, "3"], plates: int) -> Pairs:
    """Pairs at which two parallel plates about ``normal`` touch each hull, from ``plates`` directions.

    They touch a face, an edge or a corner in its middle, where their own normal counts. The foremost hull
    comes first.
    """
    first, second = plane_axes(normal)
    pairs = []
    for hull in sorted(held, key=lambda hull: -float((hull.vertices @ normal).max())):
        for angle in np.linspace(0.0, np.pi, plates, endpoint=False):
            across = np.cos(angle) * first + np.sin(angle) * second
            along = hull.vertices @ across
            ends = along < along.min() + SKIN, along > along.max() - SKIN
            middles = [np.mean(np.stack([v.min(axis=0), v.max(axis=0)]), axis=0)
                       for v in (hull.vertices[end] for end in ends)]  # fmt: skip
            pairs.append((*middles, -across, across))
    columns = [np.array(column) for column in zip(*pairs, strict=True)]
    return Pairs(first=columns[0], second=columns[1], normal_first=columns[2], normal_second=columns[3])


def _face_pairs(hulls: Sequence[Hull], region: Float[np.ndarray, "8 3"] | None) -> Pairs:
    """Pairs on faces, from evenly spread points of them."""
    triangles = hull_triangles(held_hulls(hulls, region))
    points, owner = sample_triangles(triangles, SAMPLES)
    normals = area_normals(triangles)[owner]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)
    bare = ~inside_hulls(points + SKIN * normals, hulls)
    if region is not None:
        bare &= within(points, region)
    points, normals = points[bare], normals[bare]
    across = -normals
    for _ in range(2):  # straight in, then halfway between the normals, as between the sides of a wedge
        depth, out = leave(points, across, hulls)
        inwards = out - normals
        across = inwards / np.maximum(np.linalg.norm(inwards, axis=1, keepdims=True), 1e-9)
    depth, out = leave(points, across, hulls)
    pairs = Pairs(
        first=points, second=points + depth[:, None] * across, normal_first=normals, normal_second=out
    )
    return pairs.some(depth > SKIN)


def held_hulls(hulls: Sequence[Hull], region: Float[np.ndarray, "8 3"] | None) -> tuple[Hull, ...]:
    """The hulls with their middle in a region; all of them without one, or if there is none in it."""
    held = [hull for hull in hulls if region is None or within(hull.vertices.mean(axis=0)[None], region)[0]]
    return tuple(held or hulls)


def within(points: Float[np.ndarray, "N 3"], corners: Float[np.ndarray, "8 3"]) -> Bool[np.ndarray, "N"]:
    """Whether points lie in a box, or at most a millimetre beside it.

    Args:
        points: Points.
        corners: Its corners, of which the last index of the second, third and fifth differs from the first in
            one direction each, as in `HandleAnnotation`.
    """
    edges = corners[[4, 2, 1]] - corners[0]
    length = np.linalg.norm(edges, axis=1)
    along = (points - corners[0]) @ (edges / np.maximum(length, 1e-12)[:, None]).T
    return np.asarray(((along > -1e-3) & (along < length + 1e-3)).all(axis=1))


def leave(
    points: Float[np.ndarray, "N 3"], directions: Float[np.ndarray, "N 3"], hulls: Sequence[Hull]
) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
    """Distance at which each ray leaves the union of hulls that it starts in, and the normal there."""
    enters, leaves, normals = [], [], []
    for hull in hulls:
        planes = face_planes(hull)
        gap = planes[:, 3] - points @ planes[:, :3].T  # N F
        speed = directions @ planes[:, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            at = gap / speed
        enter = np.where(speed < -1e-9, at, -np.inf).max(axis=1)
        ahead = np.where(speed > 1e-9, at, np.inf)
        beside = ((np.abs(speed) <= 1e-9) & (gap < -EVEN)).any(axis=1)
        leaves.append(np.where(beside, -np.inf, ahead.min(axis=1)))
        enters.append(np.where(beside, np.inf, enter))
        normals.append(planes[ahead.argmin(axis=1), :3])
    begin, end, facing = np.stack(enters), np.stack(leaves), np.stack(normals)  # H N ...
    reach, last = np.zeros(len(points)), np.full(len(points), -1)
    for _ in hulls:
        open_to = np.where((begin <= reach + EVEN) & (end >= begin), end, -np.inf)
        best = open_to.argmax(axis=0)
        further = open_to[best, np.arange(len(points))] > reach + EVEN
        if not further.any():
            break
        reach = np.where(further, open_to[best, np.arange(len(points))], reach)
        last = np.where(further, best, last)
    return np.where(last >= 0, reach, 0.0), facing[last, np.arange(len(points))]


def _spread(pairs: Pairs, most: int) -> Pairs:
    """The first pair of every neighbourhood, in neighbourhoods so large that at most ``most`` are left."""
    spacing, chosen = 0.004, np.arange(len(pairs))
    largest = np.abs(pairs.axis).round(3).argmax(axis=1)[:, None]
    axes = 4.0 * pairs.axis * np.sign(np.take_along_axis(pairs.axis, largest, axis=1))  # of no sense
    while True:
        cells = np.rint(np.c_[pairs.middle[chosen] / spacing, min(1.0, 0.02 / spacing) * axes[chosen]])
        chosen = chosen[np.sort(np.unique(cells, axis=0, return_index=True)[1])]
        if len(chosen) <= most:
            return pairs.some(chosen)
        spacing *= 1.3
