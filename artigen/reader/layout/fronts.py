"""Fronts of a reading on their plane, in metres: where each is when closed, how many handles it has, and its
hinges."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float

from artigen.kind import kinds
from artigen.reader.layout.cells import OPEN, WIDEST_LEAF, Seen
from artigen.reader.layout.cutting import Tree, cut_rectangles, list_leaves
from artigen.reader.layout.plane import Plane, Sight, find_face, fit_face, frame_box, guess_sights
from artigen.reader.reading import Reading, ReadPart

TWICE = 0.6
"""Overlap (intersection over union) from which two fronts are one, read twice."""
WITHIN = 0.85
"""Share of a front within another one from which it is a part of that."""
CROSSED = 0.25
"""Overlap at a cut, as a share of the smaller front, from which it is said."""
BESIDE = 0.01
"""Distance, as a share of the picture, of what may hide a front."""
REACH = 0.1
"""Distance of a handle's middle from its front, as a share of the front, up to which it belongs to that."""
FREE_COST = 1.0
"""Cost of leaving all of a front free, against an overlap of the whole of a front, between ways to see it;
without it, five of 165 fronts less are where they were marked."""
GUESSED = 0.3
"""Cost of a way to see it other than the plainest; without it, ten of 165 fronts less are where they were
marked."""
ASIDE = 0.1
"""Distance of a handle from the middle of its front, as a share of it, from which hinges are on the other
side."""


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """The front of an object, cut."""

    size: tuple[float, float, float]
    """Width, depth and height (m)."""
    fronts: tuple[Seen, ...]
    tree: Tree | None
    """Cuts of the fronts; None where there are none."""
    gap: float | None
    """Usual distance (m) of neighbouring fronts; None for fewer than two."""
    shelves: Float[np.ndarray, "N 2"]
    """Middles of shelves on the plane (m), y down from the top."""
    looked: Float[np.ndarray, "M 2"]
    """Places on the plane (m) that were looked at, y down from the top."""
    closed: Bool[np.ndarray, "M"]
    """Whether each has the colour of the nearest front."""
    notes: tuple[str, ...]


Lengths = tuple[float | None, float | None, float | None]
"""Width, depth and height (m) that are given; None for those that are read."""
FREE: Lengths = (None, None, None)


def view_fronts(reading: Reading, lengths: Lengths = FREE) -> View:
    """The fronts of a reading on the front of the object, and their tree of cuts.

    Args:
        reading: What was read; fronts that were read twice are taken once, open ones are closed.
        lengths: Of the object, instead of the read ones.
    """
    fronts, notes = _sort_out(reading.fronts)
    if not fronts:
        size = _find_size(reading, find_face(reading), lengths)
        return View(
            size=size,
            fronts=(),
            tree=None,
            gap=None,
            shelves=np.zeros((0, 2)),
            looked=np.zeros((0, 2)),
            closed=np.zeros(0, bool),
            notes=(*notes, "no front was read"),
        )
    shut = [front for front in fronts if not front.open]
    seen = shut or list(fronts)
    sight, bounds = _choose_sight(reading, seen)
    hull = np.concatenate([bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)])
    face = fit_face(sight.plane, reading, hull)
    if len(seen) < len(fronts):
        placed = dict(zip(map(id, seen), bounds, strict=True))
        closed, more = _close_fronts(fronts, placed, sight.plane, face)
        bounds, notes = np.stack(closed), (*notes, *more)
        face = np.concatenate(
            [np.minimum(face[:2], bounds[:, :2].min(axis=0)), np.maximum(face[2:], bounds[:, 2:].max(axis=0))]
        )
    size, more = _grow(
        _find_size(reading, sight.plane.show(frame_box(face)), lengths),
        bounds,
        face,
        free=lengths[0] is None and lengths[2] is None and _is_furniture(reading.kind),
    )
    scale = np.array([size[0], size[2]]) / (face[2:] - face[:2])
    bounds = (bounds - np.tile(face[:2], 2)) * np.tile(scale, 2)
    cutting = cut_rectangles(bounds, [front.label == "drawer" for front in fronts])
    handles, lost = _count_handles(reading.parts, fronts)
    whole = (0.0, size[0])
    held = [
        Seen(part=front, bounds=bound, handles=len(own), hinge=_find_hinge(front, own, bound, whole))
        for front, bound, own in zip(fronts, bounds, handles, strict=True)
    ]
    shelves = [part.box for part in reading.parts if part.label == "shelf"]
    middles = [(box[:2] + box[2:]) / 2 for box in shelves]
    at = (sight.plane.locate(np.array(middles)) - face[:2]) * scale if middles else np.zeros((0, 2))
    surface = np.zeros((0, 0), bool) if reading.surface is None else reading.surface
    rows, columns = np.indices(surface.shape).reshape(2, -1)
    places = (np.stack([columns, rows], axis=1) + 0.5) / np.maximum(surface.shape[::-1], 1)
    crossed = tuple(_say_crossing(held, *crossing) for crossing in cutting.crossed if crossing[2] > CROSSED)
    said = (f"{lost} handle{'s' * (lost > 1)} on no front: left out",) if lost else ()
    return View(
        size=size,
        fronts=tuple(held),
        tree=cutting.tree,
        gap=_find_gap(cutting.tree, bounds),
        shelves=at,
        looked=(sight.plane.locate(places) - face[:2]) * scale,
        closed=surface.ravel(),
        notes=(*notes, *more, *crossed, *said),
    )


def _find_gap(tree: Tree, bounds: Float[np.ndarray, "N 4"]) -> float | None:
    """Median distance of neighbours in the tree, open cells aside; 0 where most overlap."""
    found: list[float] = []

    def gather(node: Tree) -> None:
        if isinstance(node, int):
            return
        low = 1 if node.along == "rows" else 0
        for first, second in pairwise(node.children):
            end = max(float(bounds[leaf, low + 2]) for leaf in list_leaves(first))
            start = min(float(bounds[leaf, low]) for leaf in list_leaves(second))
            if start - end < OPEN:
                found.append(max(start - end, 0.0))
        for child in node.children:
            gather(child)

    gather(tree)
    return float(np.median(found)) if found else None


def _choose_sight(reading: Reading, fronts: Sequence[ReadPart]) -> tuple[Sight, Float[np.ndarray, "N 4"]]:
    """The sight in which the fronts overlap least and leave least free, and the fronts on its plane."""
    drawers = [front.label == "drawer" for front in fronts]
    found: list[tuple[float, Sight, Float[np.ndarray, "N 4"]]] = []
    for guess, sight in enumerate(guess_sights(reading, fronts)):
        bounds = sight.plane.bound(sight.quads)
        cost = cut_rectangles(bounds, drawers).cost + FREE_COST * _measure_free(bounds)
        cost += GUESSED * (guess > 0)
        found.append((cost, sight, bounds))
    return min(found, key=lambda one: one[0])[1:]


def _measure_free(bounds: Float[np.ndarray, "N 4"]) -> float:
    """Share of the hull of rectangles that they leave free."""
    low, high = bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)
    areas = np.clip(bounds[:, 2:] - bounds[:, :2], 0.0, None).prod(axis=1)
    return max(0.0, 1.0 - float(areas.sum() / (high - low).prod()))


def _sort_out(fronts: Sequence[ReadPart]) -> tuple[tuple[ReadPart, ...], tuple[str, ...]]:
    """Fronts without those that another one holds."""
    kept: list[ReadPart] = []
    notes: list[str] = []
    for front in sorted(fronts, key=lambda part: -part.score):
        rival = next((other for other in kept if _hides(other, front)), None)
        if rival is None:
            kept.append(front)
        else:
            notes.append(f"{_name(front)} is the same as, or within, {_name(rival)}: left out")
    return tuple(front for front in fronts if any(front is other for other in kept)), tuple(notes)


def _hides(one: ReadPart, other: ReadPart) -> bool:
    """Whether two fronts are one, or a front is within another one on one plane; fronts that are open hide
    nothing."""
    low, high = np.maximum(one.box[:2], other.box[:2]), np.minimum(one.box[2:], other.box[2:])
    shared = float(np.clip(high - low, 0, None).prod())
    areas = [float((part.box[2:] - part.box[:2]).prod()) for part in (one, other)]
    if one.open != other.open:
        return False
    if shared > TWICE * (sum(areas) - shared):
        return True
    flat = one.corners is None and other.corners is None
    return shared > (0.97 if flat else WITHIN) * areas[1] and areas[1] < areas[0] / 2


def _find_size(
    reading: Reading, face: Float[np.ndarray, "4 2"], lengths: Lengths
) -> tuple[float, float, float]:
    """Width, depth and height (m): as given, and else as read, in the proportions of the object's front in
    the picture."""
    wide, deep, high = reading.size
    yaw, pitch, _ = reading.view
    edges = np.linalg.norm((np.roll(face, -1, axis=0) - face) * reading.extent, axis=1)
    across = (edges[0] + edges[2]) / max(float(np.cos(yaw)), 0.3)
    along = (edges[1] + edges[3]) / max(float(np.cos(pitch)), 0.3)
    aspect = float(along / across)
    read = float(np.sqrt(wide * high / aspect))
    usual = (read, deep, read * aspect)
    if reading.measured:
        usual = reading.size
    elif not _is_furniture(
        reading.kind
    ):  # of one form, whose proportions the reader knows better than its boxes
        low, high = np.array(kinds()[reading.kind].sizes).T
        usual = tuple(np.clip(reading.size, low, high).tolist())
    scales = [own / length for own, length in zip(lengths[::2], usual[::2], strict=True) if own is not None]
    scale = float(np.exp(np.mean(np.log(scales)))) if scales else 1.0
    size = [scale * length if own is None else own for own, length in zip(lengths, usual, strict=True)]
    return size[0], size[1], size[2]


def _is_furniture(kind: str) -> bool:
    return kind not in kinds() or kinds()[kind].trade == "furniture"


LEAST_FRONT = np.array([0.12, 0.06])
"""Width and height (m) of the smallest front that holds a box or a handle."""


def _grow(
    size: tuple[float, float, float],
    bounds: Float[np.ndarray, "N 4"],
    face: Float[np.ndarray, "4"],
    *,
    free: bool,
) -> tuple[tuple[float, float, float], tuple[str, ...]]:
    """A size at which all fronts have a usual size."""
    shares = ((bounds[:, 2:] - bounds[:, :2]) / (face[2:] - face[:2])).min(axis=0)
    needed = float((LEAST_FRONT / (shares * (size[0], size[2]))).max())
    if needed <= 1.0:
        return size, ()
    if not free:
        return size, (f"at this size the smallest front is {100 / needed:.0f} % of a usual one",)
    width, depth, height = (length * min(needed, 2.0) for length in size)
    return (width, depth, height), (f"enlarged by {min(needed, 2.0):.2f} for the smallest front",)


def _count_handles(parts: Sequence[ReadPart], fronts: Sequence[ReadPart]) -> tuple[list[list[ReadPart]], int]:
    """The handles of every front, and how many belong to none."""
    held: list[list[ReadPart]] = [[] for _ in fronts]
    lost = 0
    for handle in (part for part in parts if part.label == "handle"):
        middle = (handle.box[:2] + handle.box[2:]) / 2
        near = []
        for index, front in enumerate(fronts):
            at = (middle - front.box[:2]) / np.maximum(front.box[2:] - front.box[:2], 1e-9)
            if (at >= -REACH).all() and (at <= 1 + REACH).all():
                near.append((float(np.abs(at - 0.5).max()), index))
        if near:
            held[min(near)[1]].append(handle)
        else:
            lost += 1
    return held, lost


def _find_hinge(
    front: ReadPart, handles: Sequence[ReadPart], bound: Float[np.ndarray, "4"], whole: tuple[float, float]
) -> str | None:
    """The side of a door's hinges: as read, opposite to its handle, or away from the middle of the object."""
    if front.label != "door" or front.hinge is not None:
        return front.hinge
    size = bound[2:] - bound[:2]
    if len(handles) == 1:
        middle = (handles[0].box[:2] + handles[0].box[2:]) / 2
        out = (middle - (front.box[:2] + front.box[2:]) / 2) / (front.box[2:] - front.box[:2])
        if abs(out[0]) > ASIDE:
            return "right" if out[0] < 0 else "left"
        if abs(out[1]) > ASIDE and size[0] > size[1]:
            return "top" if out[1] > 0 else "bottom"
    if size[0] >= WIDEST_LEAF:
        return None
    aside = (bound[0] + bound[2]) / 2 - sum(whole) / 2
    if abs(aside) < ASIDE * (whole[1] - whole[0]):
        return None
    return "left" if aside < 0 else "right"


def _close_fronts(
    fronts: Sequence[ReadPart],
    placed: dict[int, Float[np.ndarray, "4"]],
    plane: Plane,
    face: Float[np.ndarray, "4"],
) -> tuple[list[Float[np.ndarray, "4"]], tuple[str, ...]]:
    """Where fronts are when closed: open ones go into what the others leave free.

    An open drawer is taken to be as wide as the closed front that is nearest to it in the picture, and to
    fill its column's gap at its height; an open door fills the free width at its height."""
    opened = [front for front in fronts if front.open]
    placed = {
        id(front): _uncover(front, opened, placed[id(front)], list(placed.values()))
        for front in fronts
        if id(front) in placed
    }
    shut = list(placed.values())
    done: list[Float[np.ndarray, "4"]] = []
    notes: list[str] = []
    for front in fronts:
        if id(front) in placed:
            done.append(placed[id(front)])
            continue
        box = plane.bound(frame_box(front.box)[None])[0]
        bound = _drop_in(box, shut, face, 1 if front.label == "drawer" else 0)
        shut.append(bound)
        done.append(bound)
        notes.append(f"{_name(front)} is open: closed into the nearest free place")
    return done, tuple(notes)


def _uncover(
    front: ReadPart,
    opened: Sequence[ReadPart],
    bound: Float[np.ndarray, "4"],
    shut: Sequence[Float[np.ndarray, "4"]],
) -> Float[np.ndarray, "4"]:
    """A drawer that an open one hides in part: as wide as the widest one of its column."""
    hidden = front.label == "drawer" and any(
        (other.box[:2] < front.box[2:] + BESIDE).all() and (other.box[2:] > front.box[:2] - BESIDE).all()
        for other in opened
    )
    if not hidden:
        return bound
    column = [
        other
        for other in shut
        if min(other[2], bound[2]) - max(other[0], bound[0]) > 0.5 * (bound[2] - bound[0])
    ]
    widest = max(column, key=lambda other: float(other[2] - other[0]))
    return np.array([widest[0], bound[1], widest[2], bound[3]])


def _drop_in(
    box: Float[np.ndarray, "4"],
    shut: Sequence[Float[np.ndarray, "4"]],
    face: Float[np.ndarray, "4"],
    axis: int,
) -> Float[np.ndarray, "4"]:
    """The free place next to a box along an axis (0: x, 1: y), across it as its nearest neighbour."""
    bounds = np.stack(shut)
    middle = (box[axis] + box[axis + 2]) / 2
    across = 1 - axis
    apart = np.abs(bounds[:, across] + bounds[:, across + 2] - box[across] - box[across + 2])
    nearest = bounds[int(np.argmin(apart))]
    low, high = (nearest[across], nearest[across + 2]) if axis == 1 else (box[across], box[across + 2])
    beside = bounds[(bounds[:, across] < high) & (bounds[:, across + 2] > low)]
    middles = (beside[:, axis] + beside[:, axis + 2]) / 2
    before = beside[middles < middle, axis + 2]
    after = beside[middles >= middle, axis]
    start = float(before.max()) if len(before) else float(face[axis])
    end = float(after.min()) if len(after) else float(max(face[axis + 2], box[axis + 2]))
    shape = (box[axis + 2] - box[axis]) * (high - low) / max(float(box[across + 2] - box[across]), 1e-9)
    if len(before) and not len(after):
        end = min(end, start + float(shape))
    elif len(after) and not len(before):
        start = max(start, end - float(shape))
    if end - start < 0.25 * shape:  # no free place: where it seems to be
        return box
    out = np.empty(4)
    out[axis], out[axis + 2], out[across], out[across + 2] = start, end, low, high
    return out


def _say_crossing(fronts: Sequence[Seen], one: int, other: int, over: float) -> str:
    names = " and ".join(_name(fronts[index].part) for index in (one, other))
    return f"{names} overlap by {min(over, 1.0):.0%} of the smaller: parted at the middle"


def _name(front: ReadPart) -> str:
    left, top, right, bottom = front.box
    return f"the {front.label} at {left:.2f} {top:.2f} {right:.2f} {bottom:.2f}"


def settle_hinges(view: View, rng: np.random.Generator) -> View:
    """A view whose narrow doors all have hinges; those that nothing tells are drawn."""

    def settle(front: Seen) -> Seen:
        drawn = "left" if rng.random() < 0.5 else "right"
        if front.part.label != "door" or front.hinge is not None or front.width >= WIDEST_LEAF:
            return front
        return replace(front, hinge=drawn)

    return replace(view, fronts=tuple(settle(front) for front in view.fronts))
