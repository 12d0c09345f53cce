"""Adds hulls clear of every sweep, and bridges gaps between a link and its carrier by such hulls.

Parts that touch can end up apart in collision: a hull stays short of the surface it stands for, or
room for a moving part was cut out of the face that a knob sits on. A peg, a box of a few millimetres,
then reaches from one to the other, wherever it is free along every sweep. Pegs only ever stand in
gaps that are a few cells wide; every one is seen, and recorded.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.types import Joint
from sim_export.collision.hull_limits import MAX_ASPECT, MAX_VERTICES, MOST_OF_LINK, hull_aspect
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import box_hull, convex_hull, hull_planes, inside_hulls, replace_hulls
from sim_export.geometry.rays import plane_axes
from sim_export.motion.kinematics import Sweep, read_sweeps
from sim_export.package import Hull, Link, Mesh, Requirement, Visual

GAP = 2e-4
"""What stays free (m) around an added hull; engines push apart what touches, however little."""
TOLERANCE = 2e-5
"""Depth (m) to which a stretched hull may enter another link; it may have touched that before."""
_LEVEL = 1e-3
"""Metres by which buttons in a row may end at different depths."""
# Lengths in metres.
NEAR = 0.0045
"""A gap up to this is left alone: links that are nearer count as attached, hulls that end this little above
the lowest visible point as standing on the floor."""
FAR = 0.032
"""A gap beyond this is left alone too: the two do not touch in the source either. A cell of an object of
two metres in a grid of 64^3 is as long: drawn parts may hang a cell off their body."""
ROOMS = (0.001, 0.004)
"""What stays free between a peg and the link it reaches for, tried in this order. Engines round hulls by
some tenths of a millimetre: at 0.3 mm, knobs of 15 g stuck at a turn of 30 degrees."""
ROOT = 1e-3
"""How deep a peg stands in its own link."""
WIDTHS = (0.012, 0.006, 0.003, 0.0015)
"""Edges of a peg's square cross-section, tried in this order."""
PAIRS = 4
"""Nearest pairs of hulls between which a peg is tried."""
ALONG = 0.9
"""Cosine from which on an axis runs across the gap."""
COLOR = (0.55, 0.55, 0.55)
"""Colour of pegs: grey metal."""


def add_hull(
    sets: Sequence[HullSet], sweeps: Sequence[Sweep], slot: int, addition: Hull, stand: Hull
) -> HullSet | None:
    """The hulls of link ``slot`` with one more, or ``None`` if that is in some link's way.

    ``stand`` is the hull that is stretched over ``addition`` where the link has `MOST_OF_LINK`.
    """
    hulls, least = [*sets[slot].hulls, addition], GAP
    if len(hulls) > MOST_OF_LINK:
        addition = convex_hull(np.concatenate([stand.vertices, addition.vertices]))
        hulls, least = [addition if hull is stand else hull for hull in sets[slot].hulls], -TOLERANCE
    fits = len(addition.vertices) <= MAX_VERTICES and hull_aspect(addition) <= MAX_ASPECT
    if not fits or not is_free(addition, slot, sets, sweeps, least):
        return None
    return HullSet(hulls=tuple(hulls))


def is_free(hull: Hull, slot: int, sets: Sequence[HullSet], sweeps: Sequence[Sweep], least: float) -> bool:
    """Whether a hull of link ``slot`` stays ``least`` (m) from all others, at rest and in every sweep."""
    alone = HullSet(hulls=(hull,))
    for other, T_hull, T_other in relative_poses(slot, sets, sweeps):
        found = signed_distances(alone, sets[other], T_hull, T_other, max(least, 0.0))
        if len(found.distance) and found.distance.min() < least:
            return False
    return True


def relative_poses(
    slot: int, sets: Sequence[HullSet], sweeps: Sequence[Sweep]
) -> Iterator[tuple[int, Float[np.ndarray, "P 4 4"], Float[np.ndarray, "P 4 4"]]]:
    """Every other link with hulls, and displacements of link ``slot`` and of that one: at rest, and in every
    sweep that moves one against the other."""
    still = np.eye(4)[None]
    others = [index for index in range(len(sets)) if index != slot and sets[index].hulls]
    yield from ((other, still, still) for other in others)
    for sweep in sweeps:
        for other in others:
            if (slot in sweep.moved) != (other in sweep.moved):
                yield other, sweep.T[:, slot], sweep.T[:, other]


@dataclass(frozen=True, kw_only=True)
class Peg:
    """A hull of ``link`` that closes a gap (m) between ``child`` and ``parent`` to what is left of it."""

    link: str
    child: str
    parent: str
    gap: float
    left: float
    width: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Attachment:
    """Links with pegs, the pegs and how they are seen, and (child, parent, gap) where none was possible."""

    links: tuple[Link, ...]
    pegs: tuple[Peg, ...] = ()
    visuals: tuple[Visual, ...] = ()
    apart: tuple[tuple[str, str, float], ...] = ()

    @property
    def records(self) -> tuple[str, ...]:
        """One sentence for every gap that was found."""
        closed = [
            f"{peg.link}: a peg {1000 * peg.width:.1f} mm wide closes a gap of {1000 * peg.gap:.1f} mm "
            f"between {peg.child} and {peg.parent} to {1000 * peg.left:.1f} mm"
            for peg in self.pegs
        ]
        left = [
            f"{child}: stays {1000 * gap:.1f} mm from {parent}; nothing that closes the gap is free along "
            "every sweep"
            for child, parent, gap in self.apart
        ]
        return (*closed, *left)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Facing:
    """Two hulls of child and parent that face each other across a gap."""

    child: Hull
    parent: Hull
    gap: float
    normal: np.ndarray  # from the child to the parent
    points: np.ndarray  # on the child, on the parent


@dataclass(frozen=True, kw_only=True, eq=False)
class _Spot:
    """Where a peg could be: the hull it stands on and the middle of its two ends.

    ``bar`` is the long side of one that several buttons share; other pegs are square.
    """

    on_child: bool
    stand: Hull
    start: np.ndarray
    end: np.ndarray
    bar: np.ndarray | None = None


def attach_links(
    links: Sequence[Link], joints: Sequence[Joint], requirements: Sequence[Requirement] = ()
) -> Attachment:
    """Adds pegs where a link's hulls are too far from those of the link that carries it, at rest.

    Args:
        links: Links with hulls, object frame at rest.

    Returns:
        New links; those without pegs are the same objects. Hulls only grow.
    """
    sets = [HullSet(hulls=link.hulls) for link in links]
    sweeps = read_sweeps(links, joints, requirements)
    pegs, visuals, apart = [], [], []
    carried = list(_carried_links(links, joints))
    for child, parent, joint in carried:
        facing = _find_facing(sets[child], sets[parent], joint)
        if not facing or facing[0].gap <= NEAR:
            continue
        names = {"child": links[child].name, "parent": links[parent].name}
        peers = [sets[c].vertices for c, p, other in carried if p == parent and other.type == "prismatic"]
        boxes = np.array([[points.min(axis=0), points.max(axis=0)] for points in peers])
        found = _fit_peg(sets, sweeps, (child, parent), facing, joint, boxes)
        if found is None:
            apart.append((*names.values(), facing[0].gap))
            continue
        slot, sets[slot], peg, width = found
        mesh = Mesh(vertices=peg.vertices, faces=peg.faces, color=COLOR)
        part, label = links[slot].parts[0], links[slot].label or "base"
        visuals.append(Visual(name=f"peg_{len(visuals)}", part=part, label=label, mesh=mesh))
        left = min(each.gap for each in _find_facing(sets[child], sets[parent], joint))
        pegs.append(Peg(link=links[slot].name, **names, gap=facing[0].gap, left=left, width=width))
    return Attachment(
        links=replace_hulls(links, [hulls.hulls for hulls in sets]),
        pegs=tuple(pegs),
        visuals=tuple(visuals),
        apart=tuple(apart),
    )


def _carried_links(links: Sequence[Link], joints: Sequence[Joint]) -> Iterator[tuple[int, int, Joint]]:
    """Links with hulls, the nearest link with hulls that carries each, and the joint that moves it."""
    slot = {link.name: index for index, link in enumerate(links)}
    above = {joint.child: joint for joint in joints}
    for index, link in enumerate(links):
        if not link.hulls or link.name not in above:
            continue
        parent = above[link.name].parent
        while not links[slot[parent]].hulls and parent in above:
            parent = above[parent].parent
        if links[slot[parent]].hulls:
            yield index, slot[parent], above[link.name]


def _find_facing(child: HullSet, parent: HullSet, joint: Joint) -> list[_Facing]:
    """The nearest pairs of hulls at rest; of those as near to a millimetre, the one at the joint's axis comes
    first, where a shaft would be; empty beyond `FAR`."""
    still = np.eye(4)
    for reach in (NEAR, FAR):
        found = signed_distances(child, parent, still, still, reach)
        if len(found.distance):
            break
    beside = np.zeros(len(found.distance))
    if joint.type != "prismatic":
        beside = np.linalg.norm(np.cross(found.points[:, 0] - joint.origin, joint.axis), axis=1)
    order = np.lexsort((beside, np.round(found.distance, 3)))[:PAIRS]
    return [
        _Facing(
            child=child.hulls[found.first[row]],
            parent=parent.hulls[found.second[row]],
            gap=float(found.distance[row]),
            normal=found.normal[row],
            points=found.points[row],
        )
        for row in order
    ]


def _fit_peg(
    sets: Sequence[HullSet],
    sweeps: Sequence[Sweep],
    pair: tuple[int, int],
    facing: Sequence[_Facing],
    joint: Joint,
    peers: np.ndarray,
) -> tuple[int, HullSet, Hull, float] | None:
    """The first peg that is free along every sweep: its link, that link's hulls with it, itself, its width.

    ``peers`` are the boxes of all links that slide on the same one; they may share a peg.
    """
    for room, width in ((room, width) for room in ROOMS for width in WIDTHS):
        spots = (*_straight_spots(facing, joint, room), *_side_spots(facing, joint, peers, room, width))
        for spot in spots:
            slot = pair[0] if spot.on_child else pair[1]
            peg = _peg_hull(spot, width)
            hulls = add_hull(sets, sweeps, slot, peg, spot.stand)
            if hulls is not None:
                return slot, hulls, peg, width
    return None


def _straight_spots(facing: Sequence[_Facing], joint: Joint, room: float) -> Iterator[_Spot]:
    """Pegs straight across the gap, on the child and on the parent."""
    for pair in facing:
        n, gap = pair.normal, pair.gap
        for at in _places(pair, joint):
            yield _Spot(on_child=True, stand=pair.child, start=at - ROOT * n, end=at + (gap - room) * n)
            yield _Spot(on_child=False, stand=pair.parent, start=at + (gap + ROOT) * n, end=at + room * n)


def _places(pair: _Facing, joint: Joint) -> list[np.ndarray]:
    """Points on the child's side of the gap: at the joint's axis, amid the facing patch, the nearest."""
    import manifold3d

    moved = pair.child.vertices + (pair.gap + 2e-4) * pair.normal
    patch = manifold3d.Manifold.hull_points(moved) ^ manifold3d.Manifold.hull_points(pair.parent.vertices)
    points = np.array(patch.to_mesh64().vert_properties)[:, :3].reshape(-1, 3)
    if not len(points):
        return [pair.points[0]]
    height = pair.normal @ pair.points[0]
    facing, points = points, points - np.outer(points @ pair.normal - height, pair.normal)
    middle = points.mean(axis=0)
    if joint.type == "prismatic":
        return [middle, pair.points[0]]
    if abs(joint.axis @ pair.normal) > ALONG:
        foot = joint.origin + (facing.mean(axis=0) - joint.origin) @ pair.normal * joint.axis / (
            joint.axis @ pair.normal
        )
        if inside_hulls(foot[None], (convex_hull(facing),))[0]:
            return [foot + (height - foot @ pair.normal) * pair.normal, middle, pair.points[0]]
    beside = np.linalg.norm(np.cross(points - joint.origin, joint.axis), axis=1)
    return [points[beside.argmin()], middle, pair.points[0]]


def _side_spots(
    facing: Sequence[_Facing], joint: Joint, peers: np.ndarray, room: float, width: float
) -> Iterator[_Spot]:
    """Pegs that stand on the parent beside a button, which itself moves across the gap; bars first."""
    if joint.type != "prismatic":
        return
    for pair in facing:
        along = np.asarray(joint.axis) * np.sign(joint.axis @ pair.normal)
        planes = hull_planes(pair.parent)
        planes = planes[planes[:, :3] @ along < -0.5]
        if along @ pair.normal < 0.9 or not len(planes):
            continue
        corners = pair.child.vertices
        back = float((corners @ along).max())
        for bar, (aside, across) in ((b, axes) for b in (True, False) for axes in _sides(along)):
            row = _row(corners, peers, along, aside) if bar else corners
            low, high = (row @ across).min(), (row @ across).max()
            if bar and high - low <= np.ptp(corners @ across):
                continue
            at = (low + high) / 2 * across + ((row @ aside).max() + room + width / 2) * aside + back * along
            depth = float(((planes[:, 3] - planes[:, :3] @ at) / (planes[:, :3] @ along)).max())
            yield _Spot(
                on_child=False,
                stand=pair.parent,
                start=at + (depth + ROOT) * along,
                end=at - ROOT * along,
                bar=(high - low) * across if bar else None,
            )


def _sides(along: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """The four directions across ``along``, each with the one across both."""
    first, second = _frame(along)[1:]
    return [(first, second), (-first, second), (second, first), (-second, first)]


def _row(corners: np.ndarray, peers: np.ndarray, along: np.ndarray, aside: np.ndarray) -> np.ndarray:
    """Corners of a button and of its peers that end as deep and lie in a row across ``aside``."""
    low, high = (corners @ aside).min(), (corners @ aside).max()
    row = [corners]
    for box in peers:
        points = np.array([[box[i, 0], box[j, 1], box[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
        level = abs((points @ along).max() - (corners @ along).max()) < _LEVEL
        overlap = min((points @ aside).max(), high) - max((points @ aside).min(), low)
        if level and overlap > 0.5 * (high - low) and np.ptp(points @ aside) < 1.5 * (high - low):
            row.append(points)
    return np.concatenate(row)


def _frame(direction: np.ndarray) -> np.ndarray:
    """Three orthonormal rows, the first along ``direction``, the others as near to the axes as can be."""
    first = direction / np.linalg.norm(direction)
    return np.stack([first, *plane_axes(first)])


def _peg_hull(spot: _Spot, width: float) -> Hull:
    """The box of a peg: square, or a bar that is ``width`` wide."""
    frame = _frame(spot.end - spot.start)
    sides = [np.linalg.norm(spot.end - spot.start), width, width]
    if spot.bar is not None:
        sides[1] = np.linalg.norm(spot.bar)
        frame[1] = spot.bar / sides[1]
        frame[2] = np.cross(frame[0], frame[1])
    half = np.array(sides) / 2
    box = box_hull(-half, half)
    return Hull(vertices=(spot.start + spot.end) / 2 + box.vertices @ frame, faces=box.faces)
