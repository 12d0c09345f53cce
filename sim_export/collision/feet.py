"""Adds feet: hulls that the collision geometry lacks, and levelling feet under what would topple.

Feet are few, low and small, so hulls of a whole body may end above them, and the object would hover
when it stands. Where the mesh reaches further down than every hull, what of it is lowest becomes feet.

Sources are drawn without a floor: a front trim hangs below the body, two legs are shorter than the others,
or a leaf is the lowest of all. Where the centre of mass lies outside of what touches the floor, feet under
the corners of the body do what their maker would have done.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import manifold3d
import numpy as np
from jaxtyping import Float

from artigen.kind import find_kind
from artigen.types import Joint
from sim_export.collision.attachment import NEAR, add_hull
from sim_export.collision.cover.surface_hulls import split_components
from sim_export.collision.cover.surface_pieces import cut_triangles
from sim_export.collision.hull_limits import trim_hull
from sim_export.errors import DegeneratePart
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import (
    box_hull,
    clip_hull,
    convex_hull,
    hull_planes,
    hull_volume,
    hull_width,
    replace_hulls,
)
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.solids import make_manifold, solid_arrays
from sim_export.motion.kinematics import Sweep, read_sweeps
from sim_export.package import Hull, Link, Mesh, Requirement, Visual
from sim_export.physics.standing import center_of_mass, depth_of_mass, stable_margin

# Lengths in metres.
FAR = 0.06
"""Hulls that end further above the lowest visible point lack more than feet; they are left alone, as those
within `NEAR` are."""
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
NEIGHBOURS = 4
"""Hulls near a foot that are tried for it to grow out of, where the body has no hull left to give."""
MAX_HEIGHT = 0.2
"""Height of feet over that of the object, at most."""
WIDTH = 0.024
"""Side of a foot; over a fifteenth of the object's height, no more than that."""
INSET = 0.01
"""How far a foot stands back from the outline of the body."""
GRID = 80
"""Points along each side of the floor plan at which the body's underside is looked up."""
CLIMB = 3.0
"""What a metre of height counts against a metre away from the corner."""
MAX_STRETCH = 0.02
"""How far a foot is seen to reach above its hull, at most."""
SAMPLES = 200_000
"""Points on the body at which that is looked up."""
COLOR = (0.12, 0.12, 0.12)
"""Colour of feet: black rubber."""


def add_feet(
    links: Sequence[Link],
    joints: Sequence[Joint],
    requirements: Sequence[Requirement],
    meshes: Mapping[str, Mesh],
    find: Callable[[Sequence[Mesh], float, float], list[Hull]] | None = None,
) -> tuple[tuple[Link, ...], tuple[str, ...]]:
    """Adds hulls where the meshes reach further down than all hulls, at rest.

    Args:
        links: Links with hulls, object frame at rest.
        meshes: Mesh of every part, by name; metres, object frame.
        find: Makes feet of meshes between two heights; by default of closed meshes. `find_tips` takes any.

    Returns:
        New links, and one sentence for each that got feet, or should have. Links without feet are the same
        objects; hulls only grow.
    """
    sets = [HullSet(hulls=link.hulls) for link in links]
    felt = min(float(hulls.vertices[:, 2].min()) for hulls in sets if hulls.hulls)
    seen = [
        min((float(meshes[p].vertices[:, 2].min()) for p in link.parts if p in meshes), default=felt)
        for link in links
    ]
    if not NEAR < felt - min(seen) <= FAR:
        return tuple(links), ()
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
    return replace_hulls(links, [hulls.hulls for hulls in sets]), tuple(records)


def _find_feet(meshes: Sequence[Mesh], low: float, high: float) -> list[Hull]:
    """Convex feet from ``low`` to ``high``, largest first: what the meshes have in the lower half of that."""
    middle = (low + high) / 2
    found = []
    for mesh in meshes:
        if float(mesh.vertices[:, 2].min()) >= middle:
            continue
        solid = make_manifold(mesh.vertices, mesh.faces)
        for piece in solid.trim_by_plane((0.0, 0.0, -1.0), -middle).decompose():
            fill = piece.volume() / max(piece.hull().volume(), 1e-12)
            for pad in [piece] if fill >= LEAST_FILL else _cut_corners(piece):
                points, _ = solid_arrays(pad)
                found.append(np.concatenate([points, points * [1, 1, 0] + [0, 0, high]]))
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


def _cut_corners(piece: manifold3d.Manifold) -> list[manifold3d.Manifold]:
    """What a solid has in the four corners of its box seen from above."""
    low, high = np.array(piece.bounding_box()).reshape(2, 3)
    size = (high - low) * [CORNER, CORNER, 1.0]
    corner = manifold3d.Manifold.cube(tuple(size))
    places = [(x, y, low[2]) for x in (low[0], high[0] - size[0]) for y in (low[1], high[1] - size[1])]
    pads = [piece ^ corner.translate(place) for place in places]
    return [pad for pad in pads if not pad.is_empty()]


def _nearest_hull(foot: Hull, hulls: HullSet) -> Hull:
    """The hull of a link that a foot is nearest to, or deepest in."""
    still = np.eye(4)
    found = signed_distances(HullSet(hulls=(foot,)), hulls, still, still, max_distance=np.inf)
    return hulls.hulls[int(found.second[found.distance.argmin()])]


@dataclass(frozen=True, kw_only=True, eq=False)
class Levelled:
    """Links, feet as visuals of the body, and a sentence where any were added."""

    links: tuple[Link, ...]
    feet: tuple[Visual, ...] = ()
    records: tuple[str, ...] = ()


def level_object(
    links: Sequence[Link],
    joints: Sequence[Joint],
    requirements: Sequence[Requirement],
    category: str,
    shown: Float[np.ndarray, "F 3 3"],
) -> Levelled:
    """Adds feet under the corners of the body where the object does not stand by itself.

    Args:
        links: Links with hulls and inertials, object frame at rest; the body is the last.
        shown: Triangles (m) that are seen of the body; feet reach up to them.

    Returns:
        New links; all are the same objects where none is needed, or where none has room.
    """
    unchanged = Levelled(links=tuple(links))
    kind = find_kind(category)
    if kind is None or not kind.feet or not links[-1].hulls:
        return unchanged
    sets = [HullSet(hulls=link.hulls) for link in links]
    low, high = _bounds(sets)
    rolling = any(link.label == "wheel" for link in links)
    margin = stable_margin(np.stack([low, high]))
    if _depth_of_mass(links, sets) >= (0.0 if rolling else margin):
        return unchanged
    sweeps = read_sweeps(links, joints, requirements)
    wanted = _place_feet(sets[-1], float(low[2]), float(high[2] - low[2]))
    if rolling:
        wanted = _choose_feet(wanted, links, sets, margin)
    feet = [foot for foot in wanted if _stands(foot, sets, sweeps)]
    part = links[-1].parts[0]
    points = sample_triangles(shown, SAMPLES)[0] if feet else np.zeros((0, 3))
    visuals = tuple(
        Visual(name=f"foot_{index}", part=part, label="base", mesh=_show_foot(foot, points))
        for index, foot in enumerate(feet)
    )
    if not feet:
        return replace(unchanged, records=(f"{links[-1].name}: stands badly, and no foot has room",))
    after = _depth_of_mass(links, sets)
    tallest = 1000 * max(np.ptp(foot.vertices[:, 2]) for foot in feet)
    record = (
        f"{links[-1].name}: {len(feet)} levelling feet up to {tallest:.0f} mm high were added because its "
        f"centre of mass was not above its support{'' if after >= margin else '; it still is not'}"
    )
    body = replace(links[-1], hulls=sets[-1].hulls)
    return Levelled(links=(*links[:-1], body), feet=visuals, records=(record,))


def _show_foot(foot: Hull, points: Float[np.ndarray, "N 3"]) -> Mesh:
    """A foot, stretched up to points on the body above it where the hull that carries it ends lower."""
    low, high = foot.vertices.min(axis=0), foot.vertices.max(axis=0)
    above = ((points[:, :2] >= low[:2]) & (points[:, :2] <= high[:2])).all(axis=1)
    gap = float(points[above, 2].min(initial=np.inf) - high[2])
    stretched = foot.vertices.copy()
    if 0.0 < gap <= MAX_STRETCH:
        stretched[foot.vertices[:, 2] > low[2] + 1e-6, 2] += gap
    return Mesh(vertices=stretched, faces=foot.faces, color=COLOR)


def _bounds(sets: Sequence[HullSet]) -> tuple[np.ndarray, np.ndarray]:
    points = np.concatenate([hulls.vertices for hulls in sets])
    return points.min(axis=0), points.max(axis=0)


def _depth_of_mass(links: Sequence[Link], sets: Sequence[HullSet]) -> float:
    """How far (m) the centre of mass lies inside of what touches the floor; negative outside."""
    return depth_of_mass(np.concatenate([hulls.vertices for hulls in sets]), center_of_mass(links))


def _choose_feet(
    feet: Sequence[Hull], links: Sequence[Link], sets: Sequence[HullSet], margin: float
) -> list[Hull]:
    """A pair of feet, or more, with which the centre of mass lies ``margin`` (m) inside of the support: the
    fewest, and of these those that hold it deepest; none if all do not suffice."""
    for count in range(2, len(feet) + 1):
        chosen = [list(some) for some in combinations(feet, count)]
        depths = [_depth_of_mass(links, [*sets, HullSet(hulls=tuple(some))]) for some in chosen]
        if max(depths) >= margin:
            return chosen[int(np.argmax(depths))]
    return []


def _place_feet(body: HullSet, floor: float, height: float) -> list[Hull]:
    """Boxes from the floor into the underside of the body, near its four corners; those not needed too."""
    width = min(WIDTH, height / 15.0)
    low, high = body.vertices.min(axis=0)[:2], body.vertices.max(axis=0)[:2]
    back = INSET + width / 2
    axes = [np.linspace(low[n] + back, high[n] - back, GRID) for n in range(2)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    under = _undersides(body, points) - floor
    able = np.flatnonzero(under <= MAX_HEIGHT * height)
    feet, taken = [], set()
    for corner in ((low[0], low[1]), (low[0], high[1]), (high[0], low[1]), (high[0], high[1])):
        if not len(able):
            break
        away = np.linalg.norm(points[able] - corner, axis=1)
        best = int(able[(away + CLIMB * under[able]).argmin()])
        if best in taken:
            continue
        taken.add(best)
        middle, top = points[best], floor + max(under[best] + 1e-3, 2e-3)
        low_corner, high_corner = np.append(middle - width / 2, floor), np.append(middle + width / 2, top)
        feet.append(box_hull(low_corner, high_corner))
    return feet


def _undersides(body: HullSet, points: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, "N"]:
    """Height (m) at which vertical lines through points first meet a hull from below; infinite for none."""
    out = np.full(len(points), np.inf)
    for hull in body.hulls:
        planes = hull_planes(hull)
        enter, leave = np.full(len(points), -np.inf), np.full(len(points), np.inf)
        rest = planes[:, 3] - points @ planes[:, :2].T  # N F: n_z z <= rest
        for slope, room in zip(planes[:, 2], rest.T, strict=True):
            if slope < -1e-12:
                enter = np.maximum(enter, room / slope)
            elif slope > 1e-12:
                leave = np.minimum(leave, room / slope)
            else:
                enter = np.where(room < 0, np.inf, enter)
        out = np.where(enter <= leave, np.minimum(out, enter), out)
    return out


def _stands(foot: Hull, sets: list[HullSet], sweeps: Sequence[Sweep]) -> bool:
    """Adds a foot to the body's hulls, the last of ``sets``, if it has room."""
    still = np.eye(4)
    found = signed_distances(HullSet(hulls=(foot,)), sets[-1], still, still, max_distance=np.inf)
    order = np.argsort(found.distance, kind="stable")[:NEIGHBOURS]
    nearest = [sets[-1].hulls[int(index)] for index in dict.fromkeys(found.second[order].tolist())]
    for stand in nearest:
        added = add_hull(sets, sweeps, len(sets) - 1, foot, stand)
        if added is not None:
            sets[-1] = added
            return True
    return False
