"""Brings visual meshes into line with hulls: fills and trims them.

A slot between two bars or the gap between four low feet can be one voxel wide. It takes a hull a bar to
leave it open, and a link has few. Where hulls fill such gaps by more than a little of a link's volume,
its mesh fills them, too: nothing wider than the representation's own error changes.

Where parts of the source overlap, at rest or on their way, the hulls of one give way, and the mesh is
trimmed as far: a door that meets its neighbour gets the rebate that a joiner would give it. So is fine
detail for which a link has no hull left.
"""

from collections.abc import Mapping, Sequence

import manifold3d
import numpy as np

from artigen.types import Joint
from sim_export.collision.attachment import is_free
from sim_export.collision.recovery import LEAST_SAMPLES, SAMPLES, cut_out, find_lost, group_points
from sim_export.geometry.contacts import HullSet
from sim_export.geometry.distances import SampledSurface, distances_to, sample_surface_tree
from sim_export.geometry.solids import as_solid, inside_grid, solid_arrays, solid_hull, solid_triangles, unite
from sim_export.geometry.tidy import tidy_mesh
from sim_export.geometry.triangles import diagonal_of, triangle_areas
from sim_export.motion.kinematics import read_sweeps
from sim_export.package import Hull, Link, Mesh, Requirement

FILLED_DEPTH = 1.6
"""Voxels; a hull that stands out of the mesh by more anywhere is not taken in."""
FILLED_SHARE = 0.05
"""Share of a link's volume that its hulls may fill without any change to meshes."""
LEAST_FILLED = 0.001
"""Share of a link's volume below which what one hull fills is left alone."""
GRID = 24
"""Cells along each axis with which the depth of what a hull fills is measured."""
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


def fill_meshes(
    links: Sequence[Link], meshes: Mapping[str, Mesh], voxel: float
) -> tuple[dict[str, Mesh], tuple[str, ...]]:
    """Adds to the meshes of each link what its hulls hold besides, as far as that is thin.

    Args:
        links: Links with hulls, object frame at rest.
        meshes: Closed mesh of every part, by name; metres, object frame.
        voxel: Edge of a voxel (m).

    Returns:
        The meshes of all parts by name, and one sentence for each that changed.
    """
    out, records = dict(meshes), []
    for link in links:
        if not link.hulls or not link.parts:
            continue
        solids = {part: as_solid(meshes[part]) for part in link.parts}
        whole = unite(solids.values())
        volume = whole.volume()
        felt = unite(map(as_solid, link.hulls))
        excess = (felt - whole).volume() - FILLED_SHARE * volume
        if excess <= 0.0:
            continue
        taken: dict[str, int] = {}
        surface = _sample(whole)
        for hull, rest in _fillers(link.hulls, whole, LEAST_FILLED * volume):
            if excess <= 0.0:
                break
            if _depth(rest, surface) > FILLED_DEPTH * voxel:
                continue
            part = link.parts[0]
            if len(solids) > 1:
                part = max(solids, key=lambda name: (solids[name] ^ hull).volume())
            solids[part] = solids[part] + hull
            taken[part] = taken.get(part, 0) + 1
            before, whole = whole.volume(), whole + hull
            excess -= whole.volume() - before
            surface = _sample(whole)
        for part, count in taken.items():
            mesh = tidy_mesh(solids[part], meshes[part])
            if mesh is None:
                continue
            grown = as_solid(mesh).volume() / as_solid(meshes[part]).volume() - 1.0
            out[part] = mesh
            records.append(
                f"{part}: its mesh fills gaps up to {1000 * FILLED_DEPTH * voxel:.0f} mm deep, as {count} of "
                f"its hulls do: {grown:.1%} of its volume"
            )
    return out, tuple(records)


def _fillers(
    hulls: Sequence[Hull], whole: manifold3d.Manifold, least: float
) -> list[tuple[manifold3d.Manifold, manifold3d.Manifold]]:
    """Hulls that fill more than ``least`` (m^3) outside of a solid, and what, the most first."""
    found = []
    for hull in map(as_solid, hulls):
        rest = hull - whole
        if rest.volume() > least:
            found.append((hull, rest))
    return sorted(found, key=lambda pair: -pair[1].volume())


def _sample(whole: manifold3d.Manifold) -> SampledSurface:
    """The surface of a solid, to measure distances to."""
    return sample_surface_tree(solid_triangles(whole), SAMPLES)


def _depth(rest: manifold3d.Manifold, surface: SampledSurface) -> float:
    """How far (m) from the surface of a solid something outside of it reaches, to a cell of a grid."""
    vertices, faces = solid_arrays(rest)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    steps = (np.arange(GRID) + 0.4871) / GRID
    x, y, z = (low[axis] + (high - low)[axis] * steps for axis in range(3))
    inside = np.argwhere(inside_grid(vertices, faces, (x, y, z)))
    points = np.concatenate([np.stack([x, y, z], axis=1)[inside, [0, 1, 2]], vertices])
    return float(distances_to(points, surface).max())


def trim_meshes(
    links: Sequence[Link],
    joints: Sequence[Joint],
    requirements: Sequence[Requirement],
    meshes: Mapping[str, Mesh],
) -> tuple[dict[str, Mesh], tuple[str, ...]]:
    """Leaves out of the meshes what no hull stands for, where another link is or passes, or it is fine.

    Args:
        links: Links with hulls, object frame at rest.
        meshes: Closed mesh of every part, by name; metres, object frame.

    Returns:
        The meshes of all parts by name, and one sentence for each that changed.
    """
    out = dict(meshes)
    corners = [meshes[part].vertices for link in links for part in link.parts]
    if not corners:
        return out, ()
    diagonal = diagonal_of(np.concatenate(corners))
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
    return out, tuple(records)


def _find_lost(
    link: Link, meshes: Mapping[str, Mesh], total: float, diagonal: float
) -> tuple[np.ndarray, np.ndarray]:
    """Points of a link's meshes that are lost and their distances; as many as its share of the area."""
    if not link.hulls or not link.parts:
        return np.zeros((0, 3)), np.zeros(0)
    triangles = np.concatenate([meshes[part].vertices[meshes[part].faces] for part in link.parts])
    samples = int(SAMPLES * triangle_areas(triangles).sum() / total) + LEAST_SAMPLES
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
    rest = solid - piece
    bodies = sorted(rest.decompose(), key=lambda body: -body.volume())
    loose = bodies[sum(body.volume() > _SPECK for body in solid.decompose()) :]
    if any(body.volume() > _SPECK and _is_felt(body, own) for body in loose):
        return solid
    # A void inside is a body of negative volume.
    kept = [body for body in bodies if body not in loose or body.volume() < -_SPECK]
    return rest if len(kept) == len(bodies) else manifold3d.Manifold.compose(kept)


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
    return unite(meeting) if meeting else manifold3d.Manifold()
