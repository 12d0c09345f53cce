"""Faults of shapes that would make the package fail its checks, found on the primitives.

A shape is written in a moment, exported and checked in a second or more. `find_faults` says in milliseconds
whether it is worth it; procedural shapes have no fault. Each id stands for what one check measures:

overlap    V202  two rigid bodies overlap at rest
blocked    V201  a body runs into another one along its joint's range
grazing    V201  it enters another one just a little, but with much of its volume
floating   V104  a body, or a part fixed to one, is away from what carries it
loose            pieces of a part are away from the rest; no check notices, a person does
inward     V203  a drawer or door opens into the body, or away from its handle
hinge      V203  a door turns about a line that is not its edge
handle     V204  no hand can take hold of a handle
released   V206  a drawer leaves what holds it
range      V005  a slide is longer than the object, a hinge turns more than once round
thin       V102  a primitive is too thin to be a hull
crowded    V006  a body has more hulls than engines handle well
tipping    V303  the middle of the object is not above what it stands on
unmet            a part needs another one open that does not move; exporters refuse it
adrift           the part that carries all others moves; exporters refuse it
extent           the object is not as large as was asked (`artigen.sketch.model`)
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Int

from artigen.shapes.primitives import Primitive
from artigen.shapes.shape import Shape
from artigen.sketch.contact import (
    Bodies,
    Near,
    find_near,
    list_bodies,
    measure_overhang,
    measure_pairs,
    measure_thickness,
    penetrate,
)
from artigen.sketch.opening import (
    FREE_MARGIN,
    MIN_HELD,
    Opener,
    find_obstacles,
    leans_back,
    list_openers,
    measure_blocked,
    measure_handle,
    measure_held,
    measure_hinge,
)
from artigen.sketch.sweep import (
    TOUCH,
    Meetings,
    Path,
    deepest,
    find_meetings,
    measure_share,
    open_needed,
    place_opened,
    read_path,
)
from artigen.sketch.tree import Tree, read_tree
from artigen.types import FULL_TURN

FaultId = Literal[
    "overlap", "blocked", "grazing", "floating", "loose", "inward", "hinge",
    "handle", "released", "range", "thin", "crowded", "tipping", "unmet", "adrift", "extent",
]  # fmt: skip

MAX_OVERLAP = 0.001
"""Depth (m) at rest between bodies of which neither carries the other."""
MAX_OVERLAP_CARRIED = 0.002
"""Depth (m) at rest between a body and what carries it."""
MAX_ENTRY = 0.002
"""Depth (m) on the way beyond that at rest."""
MAX_SHARE = 0.01
"""Share of a body's volume that may enter another one on its way."""
MAX_GAP = 0.005
"""Distance (m) of a body from what carries it."""
MAX_SLIT = 0.002
"""Distance (m) between pieces of one body; those of procedural shapes touch."""
MIN_THICKNESS = 0.001
"""Thinnest a hull may be (m)."""
MAX_ASPECT = 60.0
"""Length over thickness beyond which an exporter cuts a hull that is no box."""
MAX_HULLS, MAX_HULLS_IN_ALL, MAX_LINKS = 32, 256, 64
"""Hulls on a body and in all, and bodies."""
HOPELESS = 4
"""Faults at rest beyond which the way of parts is not looked at."""
FLOOR_BAND = 0.005
"""Height (m) above the lowest point up to which a corner stands on the floor."""
TURN_TOLERANCE = 1e-3
"""Radians by which a hinge's range may exceed a full turn."""
_METRES = {"overlap", "blocked", "floating", "loose", "hinge", "handle", "thin", "tipping", "extent"}


@dataclass(frozen=True, kw_only=True)
class Fault:
    """Something that cannot stay: which kind, where, how far off, and what is allowed.

    ``value`` and ``allowed`` are metres; shares for ``grazing``, ``inward`` and ``released``; numbers for
    ``crowded``; for ``range`` and ``adrift`` metres of a slide and radians of a hinge; nothing for ``unmet``.
    """

    id: FaultId
    part: str
    other: str | None = None
    value: float
    allowed: float

    @property
    def text(self) -> str:
        """One sentence: what was found, where, and what is allowed."""
        unit, factor = ("mm", 1e3) if self.id in _METRES else ("%", 1e2)
        if self.id in ("range", "adrift", "crowded"):
            unit, factor = "", 1.0
        found, allowed = (f"{factor * number:.3g} {unit}".strip() for number in (self.value, self.allowed))
        return _SENTENCES[self.id].format(part=self.part, other=self.other, value=found, allowed=allowed)


_SENTENCES: dict[FaultId, str] = {
    "overlap": "{part} and {other} overlap by {value} at rest, allowed is {allowed}",
    "blocked": "{part} runs into {other} by {value} on its way, allowed is {allowed}",
    "grazing": "{part} enters {other} with {value} of its volume on its way, allowed is {allowed}",
    "floating": "{part} is {value} away from {other}, allowed is {allowed}",
    "loose": "pieces of {part} are {value} away from the rest, allowed is {allowed}",
    "inward": "{part} opens into {other} or away from its handle: {value} more is blocked ahead than behind, "
    "allowed is {allowed}",
    "hinge": "{part} turns about a line {value} from its edge, allowed is {allowed}",
    "handle": "{part} cannot be taken hold of: {value} is missing, allowed is {allowed}",
    "released": "{part} is held by {value} of its depth when it is open, at least {allowed} is needed",
    "range": "{part} moves by {value} (m or rad), allowed is {allowed}",
    "thin": "{part} has a piece {value} thin, at least {allowed} is needed",
    "crowded": "the body of {part} has {value} hulls or links, allowed is {allowed}",
    "tipping": "the middle of the object lies {value} outside of what {part} stands on, allowed is {allowed}",
    "unmet": "{part} needs {other} open, which does not move",
    "extent": "the {part} is {value} off what was asked, allowed is {allowed}",
    "adrift": "{part} carries all others and moves by {value} (m or rad), it must be fixed",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class _Course:
    """One part's way, with all that it needs open: what is where, and what meets."""

    index: int
    placed: Bodies
    path: Path
    found: Meetings


@dataclass(frozen=True, kw_only=True, eq=False)
class _Subject:
    """A shape and what the finders need of it."""

    shape: Shape
    tree: Tree
    bodies: Bodies
    near: Near
    courses: tuple[_Course, ...]
    openers: tuple[Opener, ...]
    rest: dict[tuple[int, int], tuple[float, int, int]]
    """For pairs of bodies that overlap, lower leader first: how deep (m), and which primitives."""

    def name(self, row: int) -> str:
        """Name of the part that a primitive belongs to."""
        return self.shape.parts[self.bodies.parts[row]].name


def find_faults(shape: Shape) -> tuple[Fault, ...]:
    """Finds faults that would make the package of a shape fail its checks.

    Stricter than they are in one thing: a screw is followed through all of its turns, not through one. Parts
    of a shape with more than `HOPELESS` faults at rest are not moved: that takes long where all overlaps.
    """
    return tuple(search_faults(shape))


def search_faults(shape: Shape) -> Iterator[Fault]:
    """The faults of `find_faults` one by one: who takes the first only does not wait for the others."""
    tree = read_tree(shape)
    bodies = list_bodies(shape, tree.leaders)
    near = find_near(bodies, 2 * MAX_GAP)
    subject = _Subject(
        shape=shape,
        tree=tree,
        bodies=bodies,
        near=near,
        courses=(),
        openers=(),
        rest=_measure_rest(bodies, near),
    )
    count = 0
    for finder in (_overlaps, _floating, _loose, _ranges, _trees, _hulls, _tips):
        for fault in finder(subject):
            count += 1
            yield fault
    if count > HOPELESS:
        return
    courses = []
    for course in _follow_parts(shape, tree, bodies):
        courses.append(course)
        yield from _blocked(subject, course)
    moving = replace(subject, courses=tuple(courses), openers=tuple(list_openers(shape, bodies)))
    for finder in (_inward, _openings):
        yield from finder(moving)


def _follow_parts(shape: Shape, tree: Tree, bodies: Bodies) -> Iterator[_Course]:
    for index, part in enumerate(shape.parts):
        if part.motion is None:
            continue
        T = open_needed(shape, index)
        placed = place_opened(bodies, T)
        chain = tree.ancestors[index]
        path = read_path(part.motion, T[chain[0]] if chain else np.eye(4))
        found = find_meetings(placed, path, np.isin(placed.links, tree.carried(index)))
        yield _Course(index=index, placed=placed, path=path, found=found)


def _measure_rest(bodies: Bodies, near: Near) -> dict[tuple[int, int], tuple[float, int, int]]:
    found: dict[tuple[int, int], tuple[float, int, int]] = {}
    apart = bodies.links[near.first] == bodies.links[near.second]
    for row in np.flatnonzero(~apart & (near.distance < -TOUCH)):
        first, second = int(near.first[row]), int(near.second[row])
        one, other = sorted((int(bodies.links[first]), int(bodies.links[second])))
        depth = float(-near.distance[row])
        if depth > found.get((one, other), (0.0,))[0]:
            if not (bodies.upright[first] and bodies.upright[second]):
                depth = penetrate(bodies, first, second, np.eye(4)[None])
            found[one, other] = max(found.get((one, other), (0.0, -1, -1)), (depth, first, second))
    return found


def _overlaps(subject: _Subject) -> Iterator[Fault]:
    for (one, other), (depth, first, second) in subject.rest.items():
        allowed = MAX_OVERLAP_CARRIED if subject.tree.related(one, other) else MAX_OVERLAP
        if depth > allowed:
            names = subject.name(first), subject.name(second)
            yield Fault(id="overlap", part=names[0], other=names[1], value=depth, allowed=allowed)


def _blocked(subject: _Subject, course: _Course) -> Iterator[Fault]:
    links = course.placed.links
    pairs = np.column_stack([links[course.found.first], links[course.found.second]])
    for pair in np.unique(pairs, axis=0):
        rows = np.flatnonzero((pairs == pair).all(axis=1))
        yield from _judge_meetings(subject, course, rows)


def _judge_meetings(subject: _Subject, course: _Course, rows: Int[np.ndarray, "M"]) -> Iterator[Fault]:
    """Faults between two bodies along one motion."""
    placed, found = course.placed, course.found
    depth, at = deepest(placed, found, rows)
    one, other = sorted((int(placed.links[found.first[rows[0]]]), int(placed.links[found.second[rows[0]]])))
    excess = depth - subject.rest.get((one, other), (0.0,))[0]
    if excess <= TOUCH:
        return
    names = subject.name(int(found.first[at])), subject.name(int(found.second[at]))
    if excess > MAX_ENTRY:
        yield Fault(id="blocked", part=names[0], other=names[1], value=excess, allowed=MAX_ENTRY)
        return
    share = measure_share(placed, course.path, found, rows)
    if share > MAX_SHARE:
        yield Fault(id="grazing", part=names[0], other=names[1], value=share, allowed=MAX_SHARE)


def _floating(subject: _Subject) -> Iterator[Fault]:
    bodies, near = subject.bodies, subject.near
    pairs = np.sort(np.column_stack([bodies.links[near.first], bodies.links[near.second]]), axis=1)
    for leader in np.unique(bodies.links).tolist():
        chain = subject.tree.ancestors[leader]
        if not chain:
            continue
        beside = (pairs == sorted((leader, chain[0]))).all(axis=1)
        gap = float(near.distance[beside].min(initial=np.inf))
        if gap > MAX_GAP:
            names = subject.shape.parts[leader].name, subject.shape.parts[chain[0]].name
            if gap == np.inf:
                gap = _widest_gap(bodies, leader, chain[0])
            yield Fault(id="floating", part=names[0], other=names[1], value=gap, allowed=MAX_GAP)


def _widest_gap(bodies: Bodies, one: int, other: int) -> float:
    """Distance (m) of two bodies that are not near each other, by the bounds of their primitives."""
    first, second = np.flatnonzero(bodies.links == one), np.flatnonzero(bodies.links == other)
    pairs = np.stack(np.meshgrid(first, second, indexing="ij")).reshape(2, -1)
    return float(measure_pairs(bodies, pairs[0], pairs[1]).min())


def _loose(subject: _Subject) -> Iterator[Fault]:
    """Pieces of bodies that touch nothing of the largest piece of theirs."""
    bodies, near = subject.bodies, subject.near
    same = bodies.links[near.first] == bodies.links[near.second]
    joined = same & (near.distance <= MAX_SLIT)
    groups = _connect(len(bodies.links), near.first[joined], near.second[joined])
    sizes = (bodies.high - bodies.low).prod(axis=1)
    for leader in np.unique(bodies.links).tolist():
        rows = np.flatnonzero(bodies.links == leader)
        volumes = {group: sizes[rows[groups[rows] == group]].sum() for group in np.unique(groups[rows])}
        main = max(volumes, key=lambda group: volumes[group])
        for group in set(volumes) - {main}:
            piece, rest = rows[groups[rows] == group], rows[groups[rows] != group]
            pairs = np.stack(np.meshgrid(piece, rest, indexing="ij")).reshape(2, -1)
            gap = float(measure_pairs(bodies, pairs[0], pairs[1]).min())
            name, whole = subject.name(int(piece[0])), set(bodies.parts[piece].tolist())
            apart = not (whole & set(bodies.parts[rest].tolist()))
            kind: FaultId = "floating" if apart else "loose"
            carrier = subject.shape.parts[leader].name if apart else None
            yield Fault(id=kind, part=name, other=carrier, value=gap, allowed=MAX_SLIT)


def _connect(count: int, first: Int[np.ndarray, "C"], second: Int[np.ndarray, "C"]) -> Int[np.ndarray, "N"]:
    """For each of some things the lowest that it hangs together with."""
    group = np.arange(count)
    while True:
        lowest = group.copy()
        np.minimum.at(lowest, first, group[second])
        np.minimum.at(lowest, second, group[first])
        lowest = lowest[lowest]
        if (lowest == group).all():
            return group
        group = lowest


def _inward(subject: _Subject) -> Iterator[Fault]:
    """Drawers and doors for which the way back is freer than the way out, or is it for their handles."""
    met = {course.index for course in subject.courses if len(course.found.first)}
    for opener in subject.openers:
        label = subject.shape.parts[opener.index].label
        if label == "tray" or (label, opener.motion.type) == ("door", "prismatic"):
            continue
        backward = leans_back(subject.bodies, opener)
        if opener.index not in met and not backward:
            continue
        obstacles = find_obstacles(subject.bodies, subject.tree, opener.index)
        ahead, behind = measure_blocked(subject.bodies, opener, obstacles)
        more = ahead - behind
        if more > FREE_MARGIN or (backward and more >= -FREE_MARGIN):
            carrier = subject.shape.parts[subject.tree.ancestors[opener.index][0]].name
            name = subject.shape.parts[opener.index].name
            yield Fault(id="inward", part=name, other=carrier, value=max(more, 0.0), allowed=FREE_MARGIN)


def _openings(subject: _Subject) -> Iterator[Fault]:
    """Hinges beside the edge, handles out of reach, slides that come out."""
    shape, bodies = subject.shape, subject.bodies
    for opener in subject.openers:
        part = shape.parts[opener.index]
        if part.label == "door" and opener.motion.type == "revolute":
            off, allowed = measure_hinge(bodies, opener)
            if off > allowed:
                yield Fault(id="hinge", part=part.name, value=off, allowed=allowed)
        if part.label != "door" and opener.motion.type == "prismatic":
            carriers = find_obstacles(bodies, subject.tree, opener.index)
            held = measure_held(bodies, opener, carriers)
            if held < MIN_HELD:
                yield Fault(id="released", part=part.name, value=held, allowed=MIN_HELD)
        handles = np.unique(bodies.parts[np.setdiff1d(opener.body, opener.panel)]).tolist()
        if part.label != "tray" and handles:
            missing = {k: measure_handle(bodies, opener, np.flatnonzero(bodies.parts == k)) for k in handles}
            best = min(handles, key=lambda k: missing[k])
            if missing[best] > 0:
                name = shape.parts[best].name
                yield Fault(id="handle", part=name, other=part.name, value=missing[best], allowed=0.0)


def _ranges(subject: _Subject) -> Iterator[Fault]:
    bodies = subject.bodies
    diagonal = float(np.linalg.norm(bodies.high.max(axis=0) - bodies.low.min(axis=0)))
    for part in subject.shape.parts:
        if part.motion is None or part.motion.type not in ("prismatic", "revolute"):
            continue
        most = diagonal if part.motion.type == "prismatic" else FULL_TURN + TURN_TOLERANCE
        if part.motion.upper > most:
            yield Fault(id="range", part=part.name, value=part.motion.upper, allowed=most)


def _trees(subject: _Subject) -> Iterator[Fault]:
    """Faults of the tree: a root that moves, a part that needs one that cannot move."""
    moving = {part.name for part in subject.shape.parts if part.motion is not None}
    for part in subject.shape.parts:
        if part.parent is None and part.motion is not None:
            yield Fault(id="adrift", part=part.name, value=part.motion.upper, allowed=0.0)
        for need in part.needs:
            if part.motion is not None and need.part not in moving:
                yield Fault(id="unmet", part=part.name, other=need.part, value=0.0, allowed=0.0)


def _hulls(subject: _Subject) -> Iterator[Fault]:
    """Primitives too thin, and more pieces than are allowed once long ones are cut."""
    bodies, shape = subject.bodies, subject.shape
    thickness = measure_thickness(bodies)
    for row in np.flatnonzero(thickness < MIN_THICKNESS):
        value = float(thickness[row])
        yield Fault(id="thin", part=subject.name(int(row)), value=value, allowed=MIN_THICKNESS)
    sides = np.array([np.sort(primitive.size)[1:] for primitive in bodies.primitives])
    pieces = np.ceil(sides / (MAX_ASPECT * thickness[:, None]) - 1e-9).clip(min=1.0).prod(axis=1)
    pieces[[_is_box(primitive) for primitive in bodies.primitives]] = 1.0
    links, place = np.unique(bodies.links, return_inverse=True)
    counts = np.bincount(place, weights=pieces)
    worst = int(counts.argmax())
    found = ((counts[worst], MAX_HULLS), (counts.sum(), MAX_HULLS_IN_ALL), (len(links), MAX_LINKS))
    for count, most in found:
        if count > most:
            name = shape.parts[links[worst]].name
            yield Fault(id="crowded", part=name, value=float(count), allowed=float(most))


def _is_box(primitive: Primitive) -> bool:
    """Whether every corner is one of the box around the primitive in its own frame."""
    corners = np.abs(primitive.vertices)
    return len(corners) == 8 and bool(np.abs(corners - primitive.size / 2).max() < 1e-9)


def _tips(subject: _Subject) -> Iterator[Fault]:
    outside = measure_overhang(subject.bodies, FLOOR_BAND)
    if outside > 0.0:
        lowest = int(subject.bodies.low[:, 2].argmin())
        yield Fault(id="tipping", part=subject.name(lowest), value=outside, allowed=0.0)
