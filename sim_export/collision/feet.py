"""Adds hulls for feet that the collision geometry lacks.

Feet are few, low and small, so hulls of a whole body may end above them, and the object would hover
when it stands. Where the mesh reaches further down than every hull, what of it is lowest becomes feet.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_export.collision.additions import add_hull
from sim_export.collision.contacts import HullSet, signed_distances
from sim_export.collision.hull_limits import trim_hull
from sim_export.collision.hulls import clip_hull, convex_hull, hull_volume, hull_width
from sim_export.collision.surface_hulls import split_components
from sim_export.collision.surface_pieces import cut_triangles
from sim_export.collision.sweeps import read_sweeps
from sim_export.errors import DegeneratePart
from sim_export.package import Hull, Link, Mesh, PackageJoint, Requirement

# Lengths in metres.
NEAR = 0.0045
"""Hulls that end this little above the lowest visible point are left alone."""
FAR = 0.06
"""Hulls that end further up lack more than feet; they are left alone too."""
ROOT = 1e-3
"""How far a foot reaches up beyond the lowest hull."""
SHORT = 0.004
"""How far a foot stays below the lowest hull where something that moves passes close above it."""
LEAST_FILL = 0.6
"""Share of its convex hull that a foot fills; frames fill less and stand on their corners instead."""
CORNER = 0.2
"""Size of such a corner over the frame's."""
LEAST_WIDTH = 0.0011
"""Feet thinner than this are left out."""
MOST = 8
"""Most feet of a link; the largest stay."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Standing:
    """Links with feet, and one sentence for each link that got some, or should have."""

    links: tuple[Link, ...]
    records: tuple[str, ...] = ()


def add_feet(
    links: Sequence[Link],
    joints: Sequence[PackageJoint],
    requirements: Sequence[Requirement],
    meshes: Mapping[str, Mesh],
    find: Callable[[Sequence[Mesh], float, float], list[Hull]] | None = None,
) -> Standing:
    """Adds hulls where the meshes reach further down than all hulls, at rest.

    Args:
        links: Links with hulls, object frame at rest.
        joints: Their joints.
        requirements: Joints that must be open while another moves.
        meshes: Mesh of every part, by name; metres, object frame.
        find: Makes feet of meshes between two heights; by default of closed meshes. `find_tips` takes any.

    Returns:
        New links; those without feet are the same objects. Hulls only grow.
    """
    sets = [HullSet(hulls=link.hulls) for link in links]
    felt = min(float(hulls.vertices[:, 2].min()) for hulls in sets if hulls.hulls)
    seen = [
        min((float(meshes[p].vertices[:, 2].min()) for p in link.parts if p in meshes), default=felt)
        for link in links
    ]
    if not NEAR < felt - min(seen) <= FAR:
        return Standing(links=tuple(links))
    sweeps = read_sweeps(links, joints, requirements)
    records = []
    for slot, link in enumerate(links):
        if felt - seen[slot] <= NEAR or not link.hulls:
            continue
        own = [meshes[part] for part in link.parts if part in meshes]
        feet = (find or _find_feet)(own, seen[slot], felt + ROOT)
        added = 0
        for foot in feet:
            hulls = None
            for choice in (foot, clip_hull(foot, np.array([0.0, 0.0, 1.0]), felt - SHORT)):
                if hulls is None and choice is not None:
                    nearest = _nearest_hull(choice, sets[slot])
                    hulls = add_hull(sets, sweeps, slot, choice, nearest)
            added += hulls is not None
            sets[slot] = hulls or sets[slot]
        records.append(
            f"{link.name}: its hulls ended {1000 * (felt - seen[slot]):.1f} mm above its lowest point; "
            f"{added} of {len(feet)} feet added"
        )
    return Standing(
        links=tuple(
            link if hulls.hulls == link.hulls else replace(link, hulls=hulls.hulls)
            for link, hulls in zip(links, sets, strict=True)
        ),
        records=tuple(records),
    )


def _find_feet(meshes: Sequence[Mesh], low: float, high: float) -> list[Hull]:
    """Convex feet from ``low`` to ``high``, largest first: what the meshes have in the lower half of that."""
    import manifold3d

    middle = (low + high) / 2
    found = []
    for mesh in meshes:
        if float(mesh.vertices[:, 2].min()) >= middle:
            continue
        solid = manifold3d.Manifold(
            manifold3d.Mesh64(
                vert_properties=np.array(mesh.vertices, dtype=np.float64),
                tri_verts=np.array(mesh.faces, dtype=np.uint64),
            )
        )
        for piece in solid.trim_by_plane((0.0, 0.0, -1.0), -middle).decompose():
            points = np.array(piece.to_mesh64().vert_properties)[:, :3]
            fill = piece.volume() / max(piece.hull().volume(), 1e-12)
            for pad in [points] if fill >= LEAST_FILL else _corners(points, CORNER):
                found.append(np.concatenate([pad, pad * [1, 1, 0] + [0, 0, high]]))
    return _as_feet(found)


def find_tips(meshes: Sequence[Mesh], low: float, high: float) -> list[Hull]:
    """Convex feet from ``low`` to ``high`` under what any meshes, open ones too, have in the lower half of
    that: the ends of legs and handles."""
    middle, found = (low + high) / 2, []
    for mesh in meshes:
        below = cut_triangles(mesh.vertices[mesh.faces], np.array([0.0, 0.0, 1.0]), middle)[0]
        for tip in split_components(below) if len(below) else []:
            points = tip.reshape(-1, 3)
            found.append(np.concatenate([points, points * [1, 1, 0] + [0, 0, high]]))
    return _as_feet(found)


def _as_feet(found: Sequence[np.ndarray]) -> list[Hull]:
    """The hulls of points within the limits of physics engines, largest first; no more than `MOST`."""
    feet = []
    for points in found:
        try:
            feet += trim_hull(convex_hull(points))
        except DegeneratePart:  # a flat sliver carries nothing
            continue
    feet = [foot for foot in feet if hull_width(foot)[0] >= LEAST_WIDTH]
    return sorted(feet, key=lambda foot: -hull_volume(foot))[:MOST]


def _corners(points: np.ndarray, share: float) -> list[np.ndarray]:
    """The points in the four corners of their box seen from above."""
    low, high = points.min(axis=0)[:2], points.max(axis=0)[:2]
    size = share * (high - low)
    out = []
    for corner in ((low[0], low[1]), (low[0], high[1]), (high[0], low[1]), (high[0], high[1])):
        near = (np.abs(points[:, :2] - corner) <= size).all(axis=1)
        if near.any():
            out.append(points[near])
    return out


def _nearest_hull(foot: Hull, hulls: HullSet) -> Hull:
    """The hull of a link that a foot is nearest to, or deepest in."""
    still = np.eye(4)
    found = signed_distances(HullSet(hulls=(foot,)), hulls, still, still, max_distance=np.inf)
    return hulls.hulls[int(found.second[found.distance.argmin()])]
