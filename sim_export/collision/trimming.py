"""Trims the mesh where no hull stands for it.

Where parts of the source overlap, at rest or on their way, the hulls of one give way; its mesh would still
show what is not felt. Such surface is left out of the mesh, too, so that both tell the same story: a door
that meets its neighbour gets the rebate that a joiner would give it. So is fine detail for which a
link has no hull left.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np

from sim_export.collision.additions import is_free
from sim_export.collision.contacts import HullSet
from sim_export.collision.lost_surface import cut_out, find_lost, group_points
from sim_export.collision.sweeps import read_sweeps
from sim_export.geometry.sampling import triangle_areas
from sim_export.geometry.solids import as_solid, solid_hull
from sim_export.geometry.tidy import tidy_mesh
from sim_export.package import Hull, Link, Mesh, PackageJoint, Requirement

_LEAST_SAMPLES = 200
_LEAST_VOLUME = 1e-9
"""Cubic metres; smaller pieces are flat."""
_SPECK = 1e-7
"""Cubic metres; bodies and voids that are smaller are left behind by cuts."""

# Lengths as shares of the object's diagonal.
MISSED = 0.013
"""Surface farther than this from that of all hulls is lost."""
MOST = 0.026
"""Nothing is left out of a link whose surface is nowhere lost by more than this, but see `SHARE`."""
SHARE = 0.008
"""Share of the surface of all links from which on all that is lost is left out, however little lost."""
REACH = 0.08
"""Lost points so near to each other are cut out together, so that an edge is cut off straight."""
PAD = 0.002
"""How far beyond the lost points a mesh is cut."""
FINE = 0.005
"""Share of a part's volume up to which what is lost in one place is left out wherever that is."""
GROWTH = 1.5
"""Such a piece may grow by no more than this where it is cut out three times as wide."""
LEAST_REMOVED = 1e-4
"""Less of a part's volume is not worth a change."""
MAX_REMOVED = 0.2
"""Greatest share of a part's volume that is left out."""
ROOM = 0.0017
"""Room (m) that a hull needs around itself; what has it is shown, though nothing is felt there."""
SAMPLES = 20_000
"""Points on the surfaces of all links together."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Trimmed:
    """The meshes of all parts by name, and one sentence for each that changed."""

    meshes: Mapping[str, Mesh]
    records: tuple[str, ...] = ()


def trim_meshes(
    links: Sequence[Link],
    joints: Sequence[PackageJoint],
    requirements: Sequence[Requirement],
    meshes: Mapping[str, Mesh],
) -> Trimmed:
    """Leaves out of the meshes what no hull stands for, where another link is or passes, or it is fine.

    Args:
        links: Links with hulls, object frame at rest.
        joints: Their joints.
        requirements: Joints that must be open while another moves.
        meshes: Closed mesh of every part, by name; metres, object frame.
    """
    out = dict(meshes)
    corners = [meshes[part].vertices for link in links for part in link.parts]
    if not corners:
        return Trimmed(meshes=out)
    diagonal = float(np.linalg.norm(np.ptp(np.concatenate(corners), axis=0)))
    total = sum(float(triangle_areas(mesh.vertices[mesh.faces]).sum()) for mesh in meshes.values())
    lost = [_find_lost(link, meshes, total, diagonal) for link in links]
    much = sum(len(points) for points, _ in lost) > SHARE * SAMPLES
    sets = [HullSet(hulls=link.hulls) for link in links]
    sweeps = read_sweeps(links, joints, requirements)
    records = []
    for slot, (link, (points, distances)) in enumerate(zip(links, lost, strict=True)):
        if not len(points) or (distances.max() <= MOST * diagonal and not much):
            continue
        groups = group_points(points, distances, REACH * diagonal)
        for part in link.parts:
            solid = as_solid(meshes[part])
            rest = solid
            for points in groups:
                pieces = _lost_pieces(solid, points, link.hulls, PAD * diagonal)
                wider = _lost_pieces(solid, points, link.hulls, 3.0 * PAD * diagonal)
                volume = sum(piece.volume() for piece in pieces)
                # The skin of something thicker goes on where a box around the lost points ends.
                whole = sum(piece.volume() for piece in wider) <= GROWTH * volume
                fine = whole and volume <= FINE * solid.volume()
                for piece in pieces:
                    if fine or not is_free(solid_hull(piece), slot, sets, sweeps, ROOM):
                        rest = _without(rest, piece, link.hulls)
            share = 1.0 - rest.volume() / solid.volume()
            if not LEAST_REMOVED < share <= MAX_REMOVED:
                continue
            mesh = tidy_mesh(rest, meshes[part])
            if mesh is None:
                continue
            out[part] = mesh
            records.append(f"{part}: {share:.1%} of its mesh, for which no hull stands, is left out")
    return Trimmed(meshes=out, records=tuple(records))


def _find_lost(
    link: Link, meshes: Mapping[str, Mesh], total: float, diagonal: float
) -> tuple[np.ndarray, np.ndarray]:
    """Points of a link's meshes that are lost and their distances; as many as its share of the area."""
    if not link.hulls or not link.parts:
        return np.zeros((0, 3)), np.zeros(0)
    triangles = np.concatenate([meshes[part].vertices[meshes[part].faces] for part in link.parts])
    samples = int(SAMPLES * triangle_areas(triangles).sum() / total) + _LEAST_SAMPLES
    return find_lost(triangles, link.hulls, samples, MISSED * diagonal)


def _lost_pieces(
    solid: manifold3d.Manifold, points: np.ndarray, own: Sequence[Hull], pad: float
) -> list[manifold3d.Manifold]:
    """What a solid has around some lost points; what the link's own hulls hold is not lost."""
    lost = [
        part for piece in cut_out(points, solid, pad) for part in (piece - _union(own, piece)).decompose()
    ]
    return [piece for piece in lost if min(piece.volume(), piece.hull().volume()) > _LEAST_VOLUME]


def _without(
    solid: manifold3d.Manifold, piece: manifold3d.Manifold, own: Sequence[Hull]
) -> manifold3d.Manifold:
    """A solid without a piece and what comes loose; as it was where a hull stands for that."""
    bodies = sorted((solid - piece).decompose(), key=lambda body: -body.volume())
    loose = bodies[sum(body.volume() > _SPECK for body in solid.decompose()) :]
    if any(body.volume() > _SPECK and _is_felt(body, own) for body in loose):
        return solid
    # A void inside is a body of negative volume.
    kept = [body for body in bodies if body not in loose or body.volume() < -_SPECK]
    return manifold3d.Manifold.compose(kept)


def _is_felt(body: manifold3d.Manifold, own: Sequence[Hull]) -> bool:
    """Whether hulls hold more than half of a body."""
    return (body ^ _union(own, body)).volume() > 0.5 * body.volume()


def _union(hulls: Sequence[Hull], near: manifold3d.Manifold) -> manifold3d.Manifold:
    """The union of those hulls whose boxes meet that of a solid."""
    box = np.array(near.bounding_box())
    meeting = [
        as_solid(hull)
        for hull in hulls
        if (hull.vertices.min(axis=0) <= box[3:]).all() and (hull.vertices.max(axis=0) >= box[:3]).all()
    ]
    return (
        manifold3d.Manifold.batch_boolean(meeting, manifold3d.OpType.Add)
        if meeting
        else manifold3d.Manifold()
    )
