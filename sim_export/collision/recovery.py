"""Adds small hulls where visible surface lost its collision.

Few hulls cannot follow every ledge, and cutting for clearance takes boards off whole. Where a link's
mesh lies far from all of its hulls, the solid there becomes a hull of its own, cut back from everything
that it would meet along any sweep. So nothing that moved freely before is in the way after.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import manifold3d
import numpy as np

from artigen.transforms import inverse, transform_points
from sim_export.checks.surface import inside_hulls, surface_distances
from sim_export.collision.additions import AdditionConfig, add_hull
from sim_export.collision.contacts import HullSet, signed_distances
from sim_export.collision.hull_limits import HullLimits, hull_aspect, trim_hull
from sim_export.collision.hulls import (
    box_hull,
    clip_hull,
    convex_hull,
    hull_planes,
    hull_volume,
    hull_width,
    merge_planes,
    subtract_hull,
)
from sim_export.collision.lost_surface import cut_out, find_lost, group_points, inside_mesh, stands_out
from sim_export.collision.sweeps import Sweep, read_sweeps
from sim_export.geometry.sampling import sample_triangles, triangle_areas
from sim_export.geometry.solids import as_solid, solid_hull
from sim_export.package import Hull, Link, Mesh, PackageJoint, Requirement

_LEAST_SAMPLES = 200


@dataclass(frozen=True, kw_only=True)
class RecoveryConfig:
    """What counts as lost, and what is put back; distances are shares of the object's diagonal."""

    missed: float = 0.02
    """Surface farther than this from that of all hulls is lost; 0.03 is what checks allow."""
    notched: float = 0.024
    """A hull that stands out of what is shown by more than this gets a notch there."""
    notch_share: float = 0.1
    """Greatest share of its volume that a notch may take."""
    bulge: float = 0.02
    """How far a hull that is put back may stand out of the solid."""
    pad: float = 0.01
    """How far it reaches beyond the points that were found lost."""
    samples: int = 20_000
    """Points on the surfaces of all links together."""
    groups: int = 12
    """Most groups of lost points of a link that are looked at, the worst first."""
    rounds: int = 2
    """Most times that a link is looked over again after hulls were put back."""
    halvings: int = 3
    """Times that what does not fit one hull is divided in two."""
    joins: int = 12
    """Pairs of hulls that are tried to be joined to one where a link has as many as it may."""
    cuts: int = 8
    """Most cuts that free a hull from others."""
    margin: float = 0.0025
    """Room (m) that such a cut leaves, so that poses between the sampled ones are free too."""
    limits: HullLimits = field(default_factory=HullLimits)
    """What hulls must be like."""
    addition: AdditionConfig = field(default_factory=AdditionConfig)
    """What added hulls must keep to."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Recovery:
    """Links with what was put back, and one sentence for each link that had lost something."""

    links: tuple[Link, ...]
    records: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class _Scene:
    """What all links are measured in: current hulls, sweeps, and the object's diagonal (m).

    ``stuck`` holds the hulls of links of which no two could be joined.
    """

    sets: list[HullSet]
    sweeps: tuple[Sweep, ...]
    diagonal: float
    cfg: RecoveryConfig
    stuck: dict[int, HullSet] = field(default_factory=dict)


def recover_surface(
    links: Sequence[Link],
    joints: Sequence[PackageJoint],
    requirements: Sequence[Requirement],
    meshes: Mapping[str, Mesh],
    cfg: RecoveryConfig | None = None,
) -> Recovery:
    """Adds hulls where the meshes of a link lie far from all of its hulls.

    Args:
        links: Links with hulls, object frame at rest.
        joints: Their joints.
        requirements: Joints that must be open while another moves.
        meshes: Closed mesh of every part, by name; metres, object frame.
        cfg: What counts as lost, and what is put back.

    Returns:
        New links; those without additions are the same objects. Hulls only grow in number.
    """
    cfg = cfg or RecoveryConfig()
    shown = [[meshes[part] for part in link.parts] if link.hulls else [] for link in links]
    areas = [sum(float(triangle_areas(m.vertices[m.faces]).sum()) for m in own) for own in shown]
    corners = [mesh.vertices for own in shown for mesh in own]
    if not corners:
        return Recovery(links=tuple(links))
    scene = _Scene(
        sets=[HullSet(hulls=link.hulls) for link in links],
        sweeps=read_sweeps(links, joints, requirements, cfg.addition.sweep),
        diagonal=float(np.linalg.norm(np.ptp(np.concatenate(corners), axis=0))),
        cfg=cfg,
    )
    records = []
    for slot, own in enumerate(shown):
        if own:
            samples = int(cfg.samples * areas[slot] / sum(areas)) + _LEAST_SAMPLES
            records += _recover_link(links[slot].name, slot, own, scene, samples)
    return Recovery(
        links=tuple(
            link if hulls.hulls == link.hulls else replace(link, hulls=hulls.hulls)
            for link, hulls in zip(links, scene.sets, strict=True)
        ),
        records=tuple(records),
    )


def _recover_link(name: str, slot: int, meshes: Sequence[Mesh], scene: _Scene, samples: int) -> list[str]:
    """Puts back what one link has lost, into ``scene.sets``; returns what there is to say."""
    triangles = np.concatenate([mesh.vertices[mesh.faces] for mesh in meshes])
    solids = [manifold3d.Manifold.batch_boolean(list(map(as_solid, meshes)), manifold3d.OpType.Add)]
    least = scene.cfg.missed * scene.diagonal
    notched = _open_notches(slot, triangles, solids, samples, scene)
    records = [f"{name}: notches that {notched} of its hulls filled were cut free"] if notched else []
    before, added = 0.0, 0
    for attempt in range(scene.cfg.rounds):
        points, distances = find_lost(triangles, scene.sets[slot].hulls, samples, least)
        if not len(points):
            break
        before = before or float(distances.max())
        gained = 0
        for cluster in group_points(points, distances, 1.5 * least)[: scene.cfg.groups]:
            gained += _recover_cluster(cluster, slot, solids, scene, scene.cfg.halvings)
        added += gained
        if not gained or attempt + 1 == scene.cfg.rounds:
            break
    if not before:
        return records
    left = find_lost(triangles, scene.sets[slot].hulls, samples, least)[1].max(initial=0.0)
    rest = f"; {1000 * left:.0f} mm are left" if left else ""
    put = f"{name}: {added} hulls put back where its surface was {1000 * before:.0f} mm from any{rest}"
    return [*records, put]


def _open_notches(
    slot: int,
    triangles: np.ndarray,
    solids: Sequence[manifold3d.Manifold],
    samples: int,
    scene: _Scene,
) -> int:
    """Cuts notches into hulls of a link, in ``scene.sets``, where they fill one; returns into how many.

    Cuts only take away, so that nothing that was free is disturbed; where there are too many pieces, other
    hulls are joined.
    """
    hulls = scene.sets[slot].hulls
    owners = np.repeat(np.arange(len(hulls)), [len(hull.faces) for hull in hulls])
    points, face = sample_triangles(np.concatenate([h.vertices[h.faces] for h in hulls]), samples)
    away = surface_distances(points, triangles, 4 * samples, scene.cfg.pad * scene.diagonal) / scene.diagonal
    away[away > scene.cfg.pad] *= ~inside_mesh(points[away > scene.cfg.pad], triangles)
    notched = 0
    for index in np.unique(owners[face[away > scene.cfg.notched]]).tolist():
        before = scene.sets[slot]
        others = tuple(other for other in before.hulls if other is not hulls[index])
        if len(others) == len(before.hulls):  # joined to another one by now
            continue
        far = points[(owners[face] == index) & (away > scene.cfg.pad)]
        notch = merge_planes(hull_planes(box_hull(far.min(axis=0) - 1e-4, far.max(axis=0) + 1e-4)))
        pieces = subtract_hull(hulls[index], notch, scene.cfg.limits.min_width)
        parts = [part for piece in pieces for part in trim_hull(piece, scene.cfg.limits)]
        kept = tuple(part for part in parts if hull_width(part)[0] >= scene.cfg.limits.min_width)
        least = (1.0 - scene.cfg.notch_share) * hull_volume(hulls[index])
        most = scene.cfg.addition.max_hulls - len(kept)
        scene.sets[slot] = HullSet(hulls=others)
        while len(scene.sets[slot].hulls) > most and _make_room(slot, solids, scene):
            continue
        if len(scene.sets[slot].hulls) <= most and sum(map(hull_volume, kept)) >= least:
            scene.sets[slot] = HullSet(hulls=(*scene.sets[slot].hulls, *kept))
            notched += 1
        else:
            scene.sets[slot] = before
    return notched


def _recover_cluster(
    points: np.ndarray, slot: int, solids: Sequence[manifold3d.Manifold], scene: _Scene, halvings: int
) -> int:
    """Puts back what the solids have around some points; what cannot go back whole is divided in two.

    Returns the number of hulls that it took.
    """
    pad = scene.cfg.pad * scene.diagonal
    whole = [solid_hull(piece) for solid in solids for piece in cut_out(points, solid, pad)]
    fits = whole and all(stands_out(hull, solids) <= scene.cfg.bulge * scene.diagonal for hull in whole)
    added = sum(_put_back(hull, slot, points, solids, scene) for hull in whole) if fits else 0
    axis = int(np.ptp(points, axis=0).argmax())
    low = points[:, axis] <= (points[:, axis].min() + points[:, axis].max()) / 2
    if added or not halvings or low.all():
        return added
    return sum(
        _recover_cluster(half, slot, solids, scene, halvings - 1) for half in (points[low], points[~low])
    )


def _put_back(
    hull: Hull, slot: int, points: np.ndarray, solids: Sequence[manifold3d.Manifold], scene: _Scene
) -> int:
    """Adds a hull to ``scene.sets``, cut back as far as others need; returns how many hulls that made."""
    free = _cut_free(hull, slot, scene)
    pieces = () if free is None else trim_hull(free, scene.cfg.limits)
    added = 0
    for piece in sorted(pieces, key=lambda piece: -hull_volume(piece)):
        if hull_width(piece)[0] < scene.cfg.limits.min_width or not _gains(piece, points, scene):
            continue
        if len(scene.sets[slot].hulls) >= scene.cfg.addition.max_hulls and not _make_room(
            slot, solids, scene
        ):
            break
        hulls = add_hull(scene.sets, scene.sweeps, slot, piece, piece, scene.cfg.addition)
        if hulls is not None:
            scene.sets[slot] = hulls
            added += 1
    return added


def _make_room(slot: int, solids: Sequence[manifold3d.Manifold], scene: _Scene) -> bool:
    """Joins two hulls of a link to one, in ``scene.sets``, where that fills and disturbs next to nothing."""
    if scene.stuck.get(slot) is scene.sets[slot]:
        return False
    hulls = scene.sets[slot].hulls
    low = np.array([hull.vertices.min(axis=0) for hull in hulls])
    high = np.array([hull.vertices.max(axis=0) for hull in hulls])
    pairs = []
    for i, j in combinations(range(len(hulls)), 2):
        if (np.maximum(low[i] - high[j], low[j] - high[i]) > 2.0 * scene.cfg.bulge * scene.diagonal).any():
            continue  # what joins them would stand out half-way
        joint = convex_hull(np.concatenate([hulls[i].vertices, hulls[j].vertices]))
        pairs.append((hull_volume(joint) - hull_volume(hulls[i]) - hull_volume(hulls[j]), i, j, joint))
    for _, i, j, joint in sorted(pairs, key=lambda pair: pair[:3])[: scene.cfg.joins]:
        if hull_aspect(joint) > scene.cfg.limits.max_aspect:
            continue
        if stands_out(joint, solids) > scene.cfg.bulge * scene.diagonal:
            continue
        others = HullSet(hulls=tuple(hull for index, hull in enumerate(hulls) if index not in (i, j)))
        sets = [others if index == slot else other for index, other in enumerate(scene.sets)]
        joined = add_hull(sets, scene.sweeps, slot, joint, joint, scene.cfg.addition)
        if joined is not None:
            scene.sets[slot] = joined
            return True
    scene.stuck[slot] = scene.sets[slot]
    return False


def _gains(hull: Hull, points: np.ndarray, scene: _Scene) -> bool:
    """Whether some point is no longer lost beside a hull."""
    near = surface_distances(points, hull.vertices[hull.faces], 2000)
    return bool((near < scene.cfg.missed * scene.diagonal).any() or inside_hulls(points, (hull,)).any())


def _cut_free(hull: Hull, slot: int, scene: _Scene) -> Hull | None:
    """A hull of link ``slot`` cut back until no other link comes near along any sweep, or ``None``."""
    still = np.eye(4)
    others = [index for index, hulls in enumerate(scene.sets) if index != slot and hulls.hulls]
    poses = [(other, still[None], still[None]) for other in others]
    for sweep in scene.sweeps:
        apart = [other for other in others if (slot in sweep.moved) != (other in sweep.moved)]
        poses += [(other, sweep.T[:, slot], sweep.T[:, other]) for other in apart]
    for other, T_own, T_other in poses:
        for _ in range(scene.cfg.cuts):
            found = signed_distances(
                HullSet(hulls=(hull,)), scene.sets[other], T_own, T_other, scene.cfg.addition.gap
            )
            if not len(found.distance) or found.distance.min() >= scene.cfg.addition.gap:
                break
            at = int(found.distance.argmin())
            own, theirs = T_own[found.pose[at]], T_other[found.pose[at]]
            normal = own[:3, :3].T @ found.normal[at]
            blocking = scene.sets[other].hulls[found.second[at]]
            points = transform_points(inverse(own) @ theirs, blocking.vertices)
            cut = clip_hull(hull, normal, float((points @ normal).min()) - scene.cfg.margin)
            if cut is None or hull_width(cut)[0] < scene.cfg.limits.min_width:
                return None
            hull = cut
        else:
            return None
    return hull
