"""Adds small hulls where visible surface lost its collision.

Few hulls cannot follow every ledge, and cutting for clearance takes boards off whole. Where a link's
mesh lies far from all of its hulls, the solid there becomes a hull of its own, cut back from everything
that it would meet along any sweep. So nothing that moved freely before is in the way after.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np
from jaxtyping import Float

from artigen.runtime.budget import Budget
from artigen.transforms import inverse, transform_points
from artigen.types import Joint
from sim_export.collision.attachment import GAP, add_hull, relative_poses
from sim_export.collision.hull_limits import MIN_WIDTH, MOST_OF_LINK, trim_hull
from sim_export.collision.relief import MARGIN, MARGIN_SHARE
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.distances import surface_distances
from sim_export.geometry.hulls import (
    clip_hull,
    hull_triangles,
    hull_volume,
    hull_width,
    inside_hulls,
    replace_hulls,
)
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.solids import as_solid, solid_hull, solid_triangles, unite
from sim_export.geometry.triangles import diagonal_of, meet_box, triangle_areas
from sim_export.motion.kinematics import Sweep, box_sides, read_sweeps
from sim_export.package import Hull, Link, Mesh, Requirement

_DENSER = 4
"""The surface measured to has this many times the samples of the points measured from."""
LEAST_SAMPLES = 200
"""Points on a link beyond its share of `SAMPLES`."""
# Lengths as shares of the object's diagonal, unless in metres.
MISSED = 0.02
"""Surface farther than this from that of all hulls is lost; 0.03 is what checks allow."""
BULGE = 0.02
"""How far a hull that is put back may stand out of the solid."""
CONVEX = 1.001
"""Volume of a hull over that of what it is the hull of, up to which it stands out nowhere."""
PAD = 0.01
"""How far it reaches beyond the points that were found lost."""
SAMPLES = 20_000
"""Points on the surfaces of all links together."""
GROUPS = 12
"""Most groups of lost points of a link that are looked at, the worst first."""
HALVINGS = 3
"""Times that what does not fit one hull is divided in two."""
CUTS = 8
"""Most cuts that free a hull from others."""


def find_lost(
    triangles: Float[np.ndarray, "F 3 3"], hulls: Sequence[Hull], samples: int, least: float
) -> tuple[Float[np.ndarray, "N 3"], Float[np.ndarray, "N"]]:
    """Points of a link's surface farther than ``least`` (m) from its hulls, and how far: seen, not felt."""
    solid = hull_triangles(hulls)
    seen, _ = sample_triangles(triangles, samples)
    seen = seen[~inside_hulls(seen, tuple(hulls))]
    away = surface_distances(seen, solid, _DENSER * samples, least)
    return seen[away > least], away[away > least]


def group_points(
    points: Float[np.ndarray, "N 3"], distances: Float[np.ndarray, "N"], reach: float
) -> list[Float[np.ndarray, "K 3"]]:
    """Points that are linked by steps of at most ``reach`` (m), the group with the farthest first."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    one, other = KDTree(points).query_pairs(reach, output_type="ndarray").T
    near = coo_array((np.ones(len(one), bool), (one, other)), shape=(len(points),) * 2)
    groups = connected_components(near, directed=False)[1]
    order = sorted(range(int(groups.max()) + 1), key=lambda group: -distances[groups == group].max())
    return [points[groups == group] for group in order]


def cut_out(
    points: Float[np.ndarray, "N 3"], solid: manifold3d.Manifold, pad: float
) -> list[manifold3d.Manifold]:
    """The connected pieces that a solid has around some points, up to ``pad`` (m) from their box."""
    low, high = points.min(axis=0) - pad, points.max(axis=0) + pad
    box = manifold3d.Manifold.cube(tuple(high - low)).translate(tuple(low))
    pieces = [piece for piece in (solid ^ box).decompose() if piece.volume() > 0.0]
    return [piece for piece in pieces if _holds(piece, points, 0.1 * pad)]


def _holds(piece: manifold3d.Manifold, points: np.ndarray, slack: float) -> bool:
    """Whether any of the points is in the box of a piece, or nearly."""
    box = np.array(piece.bounding_box())
    return bool(((points >= box[:3] - slack) & (points <= box[3:] + slack)).all(axis=1).any())


def stands_out(hull: Hull, solids: Sequence[manifold3d.Manifold]) -> float:
    """How far (m) a hull stands out of the solids, at most."""
    rest = as_solid(hull)
    for solid in solids:
        rest = rest - solid
    if rest.is_empty():
        return 0.0
    surface, reach = solid_triangles(unite(solids)), diagonal_of(hull.vertices)
    low, high = hull.vertices.min(axis=0) - reach, hull.vertices.max(axis=0) + reach
    points = sample_triangles(solid_triangles(rest), 2000)[0]
    return float(surface_distances(points, surface[meet_box(surface, low, high)], 5000).max())


@dataclass(frozen=True, kw_only=True, eq=False)
class _Scene:
    """What all links are measured in: current hulls, sweeps, the object's diagonal, the gap (m) that a cut
    leaves, and the time there is."""

    sets: list[HullSet]
    sweeps: tuple[Sweep, ...]
    diagonal: float
    margin: float
    budget: Budget


def recover_surface(
    links: Sequence[Link],
    joints: Sequence[Joint],
    requirements: Sequence[Requirement],
    meshes: Mapping[str, Mesh],
) -> tuple[tuple[Link, ...], tuple[str, ...]]:
    """Adds hulls where the meshes of a link lie far from all of its hulls.

    Args:
        links: Links with hulls, object frame at rest.
        meshes: Closed mesh of every part, by name; metres, object frame.

    Returns:
        New links, and one sentence for each that had lost something. Links without additions are the same
        objects; hulls only grow in number.
    """
    shown = [[meshes[part] for part in link.parts] if link.hulls else [] for link in links]
    return _recover(
        links, joints, requirements, [[unite(map(as_solid, own))] if own else [] for own in shown]
    )


def recover_hulls(
    before: Sequence[Link],
    links: Sequence[Link],
    joints: Sequence[Joint],
    requirements: Sequence[Requirement],
    budget: Budget | None = None,
) -> tuple[tuple[Link, ...], tuple[str, ...]]:
    """Adds hulls where links lie far from those that they had ``before`` some were cut, as `recover_surface`
    does, the worst places of each link first, until the budget ends."""
    cut = []
    for old, new in zip(before, links, strict=True):
        kept = set(map(id, new.hulls))
        cut.append([as_solid(hull) for hull in old.hulls if id(hull) not in kept] if new.hulls else [])
    return _recover(links, joints, requirements, cut, budget)


def _recover(
    links: Sequence[Link],
    joints: Sequence[Joint],
    requirements: Sequence[Requirement],
    solids: Sequence[Sequence[manifold3d.Manifold]],
    budget: Budget | None = None,
) -> tuple[tuple[Link, ...], tuple[str, ...]]:
    """Adds hulls where the solids of each link lie far from all of its hulls."""
    shown = [[solid_triangles(solid) for solid in own] for own in solids]
    areas = [sum(float(triangle_areas(triangles).sum()) for triangles in own) for own in shown]
    if not any(areas):
        return tuple(links), ()
    corners = [hull.vertices for link in links for hull in link.hulls]
    scene = _Scene(
        sets=[HullSet(hulls=link.hulls) for link in links],
        sweeps=read_sweeps(links, joints, requirements),
        budget=budget or Budget(),
        diagonal=diagonal_of(np.concatenate([*corners, *(t.reshape(-1, 3) for own in shown for t in own)])),
        margin=min(MARGIN, MARGIN_SHARE * float(box_sides(links).max())),
    )
    records = []
    for slot, own in enumerate(shown):
        if own:
            samples = int(SAMPLES * areas[slot] / sum(areas)) + LEAST_SAMPLES
            records += _recover_link(
                links[slot].name, slot, np.concatenate(own), solids[slot], scene, samples
            )
    return replace_hulls(links, [hulls.hulls for hulls in scene.sets]), tuple(records)


def _recover_link(
    name: str,
    slot: int,
    triangles: Float[np.ndarray, "F 3 3"],
    solids: Sequence[manifold3d.Manifold],
    scene: _Scene,
    samples: int,
) -> list[str]:
    """Puts back what one link has lost, into ``scene.sets``; returns what there is to say."""
    least = MISSED * scene.diagonal
    points, distances = find_lost(triangles, scene.sets[slot].hulls, samples, least)
    if not len(points):
        return []
    groups = group_points(points, distances, 1.5 * least)[:GROUPS]
    added = sum(
        _recover_cluster(group, slot, solids, scene, HALVINGS)
        for group in groups
        if not scene.budget.is_over()
    )
    left = find_lost(triangles, scene.sets[slot].hulls, samples, least)[1].max(initial=0.0)
    rest = f"; {1000 * left:.0f} mm are left" if left else ""
    return [
        f"{name}: {added} hulls put back where its surface was {1000 * distances.max():.0f} mm from any{rest}"
    ]


def _recover_cluster(
    points: np.ndarray, slot: int, solids: Sequence[manifold3d.Manifold], scene: _Scene, halvings: int
) -> int:
    """Puts back what the solids have around some points; what cannot go back whole is divided in two.

    Returns the number of hulls that it took.
    """
    pad = PAD * scene.diagonal
    pieces = [piece for solid in solids for piece in cut_out(points, solid, pad)]
    whole = [solid_hull(piece) for piece in pieces]
    fits = whole and all(
        hull_volume(hull) <= CONVEX * piece.volume() or stands_out(hull, solids) <= BULGE * scene.diagonal
        for hull, piece in zip(whole, pieces, strict=True)
    )
    added = sum(_put_back(hull, slot, points, scene) for hull in whole) if fits else 0
    axis = int(np.ptp(points, axis=0).argmax())
    low = points[:, axis] <= (points[:, axis].min() + points[:, axis].max()) / 2
    if added or not halvings or low.all():
        return added
    return sum(
        _recover_cluster(half, slot, solids, scene, halvings - 1) for half in (points[low], points[~low])
    )


def _put_back(hull: Hull, slot: int, points: np.ndarray, scene: _Scene) -> int:
    """Adds a hull to ``scene.sets``, cut back as far as others need; returns how many hulls that made."""
    free = _cut_free(hull, slot, scene)
    pieces = () if free is None else trim_hull(free)
    added = 0
    for piece in sorted(pieces, key=lambda piece: -hull_volume(piece)):
        if hull_width(piece)[0] < MIN_WIDTH or not _gains(piece, points, scene):
            continue
        if len(scene.sets[slot].hulls) >= MOST_OF_LINK:
            break
        hulls = add_hull(scene.sets, scene.sweeps, slot, piece, piece)
        if hulls is not None:
            scene.sets[slot] = hulls
            added += 1
    return added


def _gains(hull: Hull, points: np.ndarray, scene: _Scene) -> bool:
    """Whether some point is no longer lost beside a hull."""
    near = surface_distances(points, hull.vertices[hull.faces], 2000)
    return bool((near < MISSED * scene.diagonal).any() or inside_hulls(points, (hull,)).any())


def _cut_free(hull: Hull, slot: int, scene: _Scene) -> Hull | None:
    """A hull of link ``slot`` cut back until no other link comes near along any sweep, or ``None``."""
    for other, T_own, T_other in relative_poses(slot, scene.sets, scene.sweeps):
        for _ in range(CUTS):
            found = signed_distances(HullSet(hulls=(hull,)), scene.sets[other], T_own, T_other, GAP)
            if not len(found.distance) or found.distance.min() >= GAP:
                break
            at = int(found.distance.argmin())
            own, theirs = T_own[found.pose[at]], T_other[found.pose[at]]
            normal = own[:3, :3].T @ found.normal[at]
            blocking = scene.sets[other].hulls[found.second[at]]
            points = transform_points(inverse(own) @ theirs, blocking.vertices)
            cut = clip_hull(hull, normal, float((points @ normal).min()) - scene.margin)
            if cut is None or hull_width(cut)[0] < MIN_WIDTH:
                return None
            hull = cut
        else:
            return None
    return hull
