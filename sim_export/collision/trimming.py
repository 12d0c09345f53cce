"""What is shown of a link although it lies inside of another one, and no hull can stand for it.

Where parts of the source overlap, the hulls of one give way; its mesh would still show what is not felt.
Such surface is left out of the mesh, too, so that both tell the same story.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np

from sim_export.collision.lost_surface import cut_out, find_lost, group_points
from sim_export.geometry.sampling import triangle_areas
from sim_export.geometry.solids import as_solid, solid_arrays
from sim_export.package import Hull, Link, Mesh

_LEAST_SAMPLES = 200


@dataclass(frozen=True, kw_only=True)
class TrimmingConfig:
    """What is left out of meshes; distances are shares of the object's diagonal."""

    missed: float = 0.02
    """Surface farther than this from that of all hulls is lost."""
    most: float = 0.026
    """Nothing is left out of a link whose surface is nowhere lost by more than this."""
    pad: float = 0.002
    """How far beyond the lost points a mesh is cut."""
    inside: float = 0.5
    """Least share of what is left out that lies in hulls of other links, at rest."""
    max_removed: float = 0.2
    """Greatest share of a part's volume that is left out."""
    samples: int = 20_000
    """Points on the surfaces of all links together."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Trimmed:
    """The meshes of all parts by name, those that changed, and one sentence for each of these."""

    meshes: Mapping[str, Mesh]
    changed: tuple[str, ...] = ()
    records: tuple[str, ...] = ()


def trim_meshes(
    links: Sequence[Link], meshes: Mapping[str, Mesh], cfg: TrimmingConfig | None = None
) -> Trimmed:
    """Leaves out of the meshes what no hull stands for because another link is there.

    Args:
        links: Links with hulls, object frame at rest.
        meshes: Closed mesh of every part, by name; metres, object frame.
        cfg: What is left out.
    """
    cfg = cfg or TrimmingConfig()
    out = dict(meshes)
    corners = [meshes[part].vertices for link in links for part in link.parts]
    if not corners:
        return Trimmed(meshes=out)
    diagonal = float(np.linalg.norm(np.ptp(np.concatenate(corners), axis=0)))
    total = sum(float(triangle_areas(mesh.vertices[mesh.faces]).sum()) for mesh in meshes.values())
    records, changed = [], []
    for link in links:
        if not link.hulls or not link.parts:
            continue
        triangles = np.concatenate([meshes[part].vertices[meshes[part].faces] for part in link.parts])
        samples = int(cfg.samples * triangle_areas(triangles).sum() / total) + _LEAST_SAMPLES
        points, distances = find_lost(triangles, link.hulls, samples, cfg.missed * diagonal)
        if distances.max(initial=0.0) <= cfg.most * diagonal:
            continue
        others = [hull for other in links if other is not link for hull in other.hulls]
        groups = group_points(points, distances, 1.5 * cfg.missed * diagonal)
        for part in link.parts:
            solid = as_solid(meshes[part])
            rest = _leave_out(solid, groups, link.hulls, others, (cfg, diagonal))
            share = 1.0 - rest.volume() / solid.volume()
            if not 0.0 < share <= cfg.max_removed:
                continue
            vertices, faces = solid_arrays(rest)
            out[part] = Mesh(vertices=vertices, faces=faces, color=meshes[part].color)
            changed.append(part)
            records.append(f"{part}: {share:.1%} of its mesh, which lay inside of other links, is left out")
    return Trimmed(meshes=out, changed=tuple(changed), records=tuple(records))


def _leave_out(
    solid: manifold3d.Manifold,
    groups: Sequence[np.ndarray],
    own: Sequence[Hull],
    others: Sequence[Hull],
    scale: tuple[TrimmingConfig, float],
) -> manifold3d.Manifold:
    """A solid without the lost pieces of it that lie in other links; what its own hulls hold stays."""
    cfg, diagonal = scale
    rest = solid
    for points in groups:
        for piece in cut_out(points, solid, cfg.pad * diagonal):
            lost = piece - _union(own, piece)
            if lost.volume() <= 0.0:
                continue
            shared = (lost ^ _union(others, lost)).volume()
            if shared >= cfg.inside * lost.volume():
                rest = rest - lost
    return rest


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
