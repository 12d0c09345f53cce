"""Finds defects of shapes, on their primitives, that would make the package fail its checks.

Drawing a shape takes a moment; exporting and checking it takes a second or more. `find_faults` decides within
milliseconds whether export is worthwhile. Procedural shapes have no faults. `artigen.sketch.fault` lists the
ids.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool

from artigen.shapes.primitives import Primitive
from artigen.shapes.shape import Shape
from artigen.shapes.solids import list_solids
from artigen.sketch.cavity import find_cavities, measure_sealed
from artigen.sketch.contact import (
    Bodies,
    Near,
    find_near,
    find_overhang,
    list_bodies,
    measure_pairs,
    measure_thickness,
    penetrate,
)
from artigen.sketch.fault import Fault, FaultId
from artigen.sketch.opening import (
    FREE_MARGIN,
    MIN_HELD,
    MIN_HUNG,
    Opener,
    find_obstacles,
    leans_back,
    list_openers,
    measure_blocked,
    measure_handle,
    measure_held,
    measure_hinge,
    measure_hung,
)
from artigen.sketch.request import SketchRequest
from artigen.sketch.sweep import (
    TOUCH,
    Meetings,
    Path,
    deepest,
    find_meetings,
    open_needed,
    place_opened,
    read_path,
)
from artigen.sketch.tree import Tree, read_tree
from artigen.types import FULL_TURN
from artigen.voxels.regions import connected_groups

MAX_OVERLAP = 1e-6
"""Penetration (m) of two bodies at rest: that of rounded numbers. Exact bodies touch; checks allow hulls of
scanned objects more, but MuJoCo pushes apart whatever overlaps (V308)."""
MAX_PLAY = 0.01
"""Share of its range that a part may move before its latch holds it."""
MAX_GAP = 0.005
"""Distance (m) of a body from its carrier."""
MAX_SLIT = 0.002
"""Distance (m) between pieces of one body; those of procedural shapes touch."""
MIN_THICKNESS = 0.001
"""Smallest thickness of a hull (m)."""
MAX_ASPECT = 60.0
"""Ratio of length to thickness beyond which an exporter splits a hull that is not a box."""
MAX_HULLS, MAX_HULLS_IN_ALL, MAX_LINKS = 32, 256, 64
"""Hulls per body, hulls in total, and bodies."""
MAX_SEALED = 0.5
"""Share of a panel's area behind which its carrier may enclose a cavity."""
WITHIN = 0.01
"""Relative tolerance of requested extents."""
HOPELESS = 4
"""Number of faults at rest beyond which motions are not checked."""
FLOOR_BAND = 0.005
"""Height (m) above the lowest point within which corners count as support."""
TURN_TOLERANCE = 1e-3
"""Radians by which a hinge's range may exceed a full turn."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Course:
    """Motion of one part with the parts it requires opened: placed bodies, path and contacts."""

    index: int
    placed: Bodies
    path: Path
    found: Meetings


@dataclass(frozen=True, kw_only=True, eq=False)
class _Subject:
    """A shape and the data that the finders share."""

    shape: Shape
    tree: Tree
    bodies: Bodies
    near: Near
    rest: dict[tuple[int, int], tuple[float, int, int]]
    """Overlapping bodies, lower leader first: depth (m) and the two primitives."""
    courses: tuple[_Course, ...] = ()
    openers: tuple[Opener, ...] = ()

    def name(self, row: int) -> str:
        """Name of the part that a primitive belongs to."""
        return self.shape.parts[self.bodies.parts[row]].name


def find_faults(shape: Shape) -> tuple[Fault, ...]:
    """Finds faults that would make the package of a shape fail its checks.

    Stricter than the checks: exact bodies must not overlap, and a screw is followed through all of its turns.
    Motions are skipped after more than `HOPELESS` faults at rest; where everything overlaps, they are slow.
    """
    return tuple(search_faults(shape))


def search_faults(shape: Shape) -> Iterator[Fault]:
    """Yields the faults of `find_faults` lazily, so that a caller may stop at the first."""
    tree = read_tree(shape)
    bodies = list_bodies(shape, tree.leaders)
    near = find_near(bodies, 2 * MAX_GAP)
    rest = _measure_rest(bodies, near)
    subject = _Subject(shape=shape, tree=tree, bodies=bodies, near=near, rest=rest)
    count = 0
    for finder in (_overlaps, _floating, _loose, _ranges, _trees, _hulls, _tips, _latches):
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
    for finder in (_inward, _openings, _sealed):
        yield from finder(moving)


def _follow_parts(shape: Shape, tree: Tree, bodies: Bodies) -> Iterator[_Course]:
    for index, part in enumerate(shape.parts):
        if part.joint is None:
            continue
        T = open_needed(shape, index)
        placed = place_opened(bodies, T)
        chain = tree.ancestors[index]
        path = read_path(part.joint, T[chain[0]] if chain else np.eye(4))
        found = find_meetings(placed, path, np.isin(placed.links, tree.carried(index)))
        yield _Course(index=index, placed=placed, path=path, found=found)


def _measure_rest(bodies: Bodies, near: Near) -> dict[tuple[int, int], tuple[float, int, int]]:
    found: dict[tuple[int, int], tuple[float, int, int]] = {}
    same = bodies.links[near.first] == bodies.links[near.second]
    for row in np.flatnonzero(~same & (near.distance < -MAX_OVERLAP)):
        first, second = int(near.first[row]), int(near.second[row])
        one, other = sorted((int(bodies.links[first]), int(bodies.links[second])))
        depth = float(-near.distance[row])
        if depth > found.get((one, other), (0.0,))[0]:
            if not (bodies.upright[first] and bodies.upright[second]):
                depth = penetrate(bodies, first, second, np.eye(4)[None])
            found[one, other] = max(found.get((one, other), (0.0, -1, -1)), (depth, first, second))
    return found


def _overlaps(subject: _Subject) -> Iterator[Fault]:
    for depth, first, second in subject.rest.values():
        if depth > MAX_OVERLAP:
            names = subject.name(first), subject.name(second)
            yield Fault(id="overlap", part=names[0], other=names[1], value=depth, allowed=MAX_OVERLAP)


def _blocked(subject: _Subject, course: _Course) -> Iterator[Fault]:
    """Pairs of bodies that run into each other along one motion, deeper than at rest."""
    placed, found = course.placed, course.found
    pairs = np.column_stack([placed.links[found.first], placed.links[found.second]])
    for pair in np.unique(pairs, axis=0):
        depth, at = deepest(placed, found, np.flatnonzero((pairs == pair).all(axis=1)))
        one, other = sorted(pair.tolist())
        excess = depth - subject.rest.get((one, other), (0.0,))[0]
        if excess > TOUCH:
            names = subject.name(int(found.first[at])), subject.name(int(found.second[at]))
            yield Fault(id="blocked", part=names[0], other=names[1], value=excess, allowed=TOUCH)


def _latches(subject: _Subject) -> Iterator[Fault]:
    """Parts that move although a part on them, which they require opened, is closed: nothing holds them."""
    bodies, tree = subject.bodies, subject.tree
    numbers = {part.name: index for index, part in enumerate(subject.shape.parts)}
    for index, part in enumerate(subject.shape.parts):
        keys = [need.part for need in part.needs if index in tree.ancestors[numbers[need.part]]]
        if part.joint is None or not keys:
            continue
        play = replace(part.joint, upper=MAX_PLAY * part.joint.upper)
        carried = np.isin(bodies.links, tree.carried(index))
        if not len(find_meetings(bodies, read_path(play, np.eye(4)), carried).first):
            yield Fault(id="unheld", part=part.name, other=keys[0], value=1.0, allowed=MAX_PLAY)


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
                gap = _measure_gap(bodies, bodies.links == leader, bodies.links == chain[0])
            yield Fault(id="floating", part=names[0], other=names[1], value=gap, allowed=MAX_GAP)


def _measure_gap(bodies: Bodies, some: Bool[np.ndarray, "N"], others: Bool[np.ndarray, "N"]) -> float:
    """Smallest distance (m) between two sets of primitives."""
    pairs = np.meshgrid(np.flatnonzero(some), np.flatnonzero(others))
    return float(measure_pairs(bodies, pairs[0].ravel(), pairs[1].ravel()).min())


def _loose(subject: _Subject) -> Iterator[Fault]:
    """Pieces of a body that are detached from its largest connected piece."""
    bodies, near = subject.bodies, subject.near
    same = bodies.links[near.first] == bodies.links[near.second]
    joined = same & (near.distance <= MAX_SLIT)
    groups = connected_groups(len(bodies.links), np.stack([near.first[joined], near.second[joined]]))
    sizes = (bodies.high - bodies.low).prod(axis=1)
    for leader in np.unique(bodies.links).tolist():
        own = bodies.links == leader
        volumes = {group: sizes[groups == group].sum() for group in np.unique(groups[own])}
        main = max(volumes, key=lambda group: volumes[group])
        for group in set(volumes) - {main}:
            piece, rest = groups == group, own & (groups != group)
            gap = _measure_gap(bodies, piece, rest)
            name, whole = subject.name(int(piece.argmax())), set(bodies.parts[piece].tolist())
            apart = not (whole & set(bodies.parts[rest].tolist()))
            kind: FaultId = "floating" if apart else "loose"
            carrier = subject.shape.parts[leader].name if apart else None
            yield Fault(id=kind, part=name, other=carrier, value=gap, allowed=MAX_SLIT)


def _inward(subject: _Subject) -> Iterator[Fault]:
    """Drawers and doors whose way back is clearer than the way out, or whose handles trail the motion."""
    met = {course.index for course in subject.courses if len(course.found.first)}
    for opener in subject.openers:
        label = subject.shape.parts[opener.index].label
        if label == "tray" or (label, opener.joint.type) == ("door", "prismatic"):
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
    """Hinges away from the edge, handles that cannot be grasped, slides that leave their carriers."""
    shape, bodies = subject.shape, subject.bodies
    for opener in subject.openers:
        part = shape.parts[opener.index]
        if part.label == "door" and opener.joint.type == "revolute":
            off, allowed = measure_hinge(bodies, opener)
            if off > allowed:
                yield Fault(id="hinge", part=part.name, value=off, allowed=allowed)
            carrier = subject.tree.ancestors[opener.index][0]
            hung = measure_hung(bodies, opener, np.flatnonzero(bodies.links == carrier))
            if hung < MIN_HUNG:
                name = shape.parts[carrier].name
                yield Fault(id="unhung", part=part.name, other=name, value=hung, allowed=MIN_HUNG)
        if part.label != "door" and opener.joint.type == "prismatic":
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


def _sealed(subject: _Subject) -> Iterator[Fault]:
    """Drawers and doors that seem to close a cavity which walls enclose on all sides."""
    openers = [opener for opener in subject.openers if opener.label != "tray"]
    carriers = [subject.tree.ancestors[opener.index][0] for opener in openers]
    cavities = {link: find_cavities(subject.bodies, link) for link in set(carriers)}
    for opener, link in zip(openers, carriers, strict=True):
        sealed = measure_sealed(subject.bodies, opener, cavities[link])
        if sealed > MAX_SEALED:
            one, other = subject.shape.parts[opener.index].name, subject.shape.parts[link].name
            yield Fault(id="sealed", part=one, other=other, value=sealed, allowed=MAX_SEALED)


def _ranges(subject: _Subject) -> Iterator[Fault]:
    bodies = subject.bodies
    diagonal = float(np.linalg.norm(bodies.high.max(axis=0) - bodies.low.min(axis=0)))
    for part in subject.shape.parts:
        if part.joint is None or part.joint.type not in ("prismatic", "revolute"):
            continue
        most = diagonal if part.joint.type == "prismatic" else FULL_TURN + TURN_TOLERANCE
        if part.joint.upper > most:
            yield Fault(id="range", part=part.name, value=part.joint.upper, allowed=most)


def _trees(subject: _Subject) -> Iterator[Fault]:
    """Faults of the tree: a root with a joint, or a part that requires a static part to be open."""
    moving = {part.name for part in subject.shape.parts if part.joint is not None}
    for part in subject.shape.parts:
        if part.parent is None and part.joint is not None:
            yield Fault(id="adrift", part=part.name, value=part.joint.upper, allowed=0.0)
        for need in part.needs:
            if part.joint is not None and need.part not in moving:
                yield Fault(id="unmet", part=part.name, other=need.part, value=0.0, allowed=0.0)


def _hulls(subject: _Subject) -> Iterator[Fault]:
    """Primitives that are too thin, and too many hulls after long ones are split."""
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
    """Whether the corners are those of the primitive's box in its own frame."""
    corners = np.abs(primitive.vertices)
    return len(corners) == 8 and np.allclose(corners, primitive.size / 2, rtol=0.0, atol=1e-9)


def _tips(subject: _Subject) -> Iterator[Fault]:
    outside = find_overhang(subject.bodies, FLOOR_BAND)
    if outside > 0.0:
        lowest = int(subject.bodies.low[:, 2].argmin())
        yield Fault(id="tipping", part=subject.name(lowest), value=outside, allowed=0.0)


def find_extent_faults(shape: Shape, request: SketchRequest) -> tuple[Fault, ...]:
    """A fault for every requested extent that the object misses by more than `WITHIN`.

    The object's measured extents are compared, not those in its header. Extents that were not requested are
    ignored.
    """
    solids = list_solids(shape)
    extents = (solids.high.max(axis=0) - solids.low.min(axis=0)).tolist()
    requested = (request.depth, request.width, request.height)
    return tuple(
        Fault(id="extent", part=name, value=abs(extent - wanted), allowed=WITHIN * wanted)
        for name, extent, wanted in zip(("depth", "width", "height"), extents, requested, strict=True)
        if wanted is not None and abs(extent - wanted) > WITHIN * wanted
    )
