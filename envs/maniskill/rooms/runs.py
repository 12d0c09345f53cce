"""Gapless runs of cabinets and appliances along walls, with fillers in corners and gaps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise
from typing import Literal

import numpy as np
from jaxtyping import Float

from .arrange import Place, Plan, fits, wall_places
from .catalogue import Catalogue, Entry
from .choose import TALL, Offer, Wall, choose_units, order_units
from .footprints import is_level
from .pieces import GAP, Boxes, Cluster, Member, Piece, line_up, make_piece, move_boxes
from .recipes import STORAGE, Recipe
from .room import Side, along_wall, wall_length

RESERVE = 0.78
"""Length (m) of both walls that a corner between two runs takes."""
ORDERS = 3
"""Number of random orders of a run; the one with the smallest gaps is used."""
NARROW = 0.012
"""Gap (m) between units above which a panel closes it."""
SHIFTS = np.arange(0.0, 0.62, 0.04)
"""Distances (m) from its corner at which a run may start."""


@dataclass(frozen=True, kw_only=True)
class Chooser:
    """Inputs of one arrangement: packages by role, random numbers, and required free space."""

    shortlists: Mapping[str, tuple[Entry, ...]]
    rng: np.random.Generator
    radius: float
    sweeps: Literal["free", "any"]
    most: int

    def piece(self, entry: Entry, role: str, front: float | None = None, elevation: float = GAP) -> Piece:
        """A package as a piece with the free space that the settings require."""
        piece = make_piece(entry, role, self.radius, front, elevation)
        if self.sweeps == "free":
            return piece
        empty = np.zeros((0, 2, 3))
        return replace(piece, boxes=Boxes(bodies=piece.boxes.bodies, sweeps=empty, stands=empty))


def draw_shortlists(
    recipe: Recipe, catalogue: Catalogue, rng: np.random.Generator, variety: int
) -> dict[str, tuple[Entry, ...]]:
    """At most ``variety`` packages for every role of a room; cabinets without a top only if all are."""
    lists: dict[str, tuple[Entry, ...]] = {}
    for role in recipe.all_roles:
        entries = catalogue.of_role(role)
        order = rng.permutation(len(entries)).tolist()
        covered = (k for k in order if entries[k].category != STORAGE or is_level(entries[k].folder, "top"))
        picked = list(islice(covered, variety)) or order[:variety]
        lists[role.name] = tuple(entries[index] for index in sorted(picked))
    return lists


def count_objects(plan: Plan) -> int:
    """Number of packages placed so far."""
    return sum(member.piece.entry is not None for place in plan.places for member in place.cluster.members)


def place_runs(plan: Plan, recipe: Recipe, chooser: Chooser) -> tuple[Plan, str]:
    """The plan with the recipe's runs, and the reason of failure (empty on success)."""
    sides = recipe.layouts[int(chooser.rng.integers(len(recipe.layouts)))]
    offers = [
        Offer(share=index, entry=entry)
        for index, share in enumerate(recipe.shares)
        for entry in chooser.shortlists[share.role.name]
    ]
    meets = [_corners(side, sides) for side in sides]
    walls = [
        Wall(
            length=max(0.0, wall_length(side, plan.size) - RESERVE * len(ends) - 0.04),
            enclosed=len(ends) == 2,
        )
        for side, ends in zip(sides, meets, strict=True)
    ]
    chosen = choose_units(offers, recipe.shares, walls, chooser.rng)
    if chosen is None:
        return plan, (
            f"walls with {' + '.join(f'{wall.length:.2f}' for wall in walls)} m free of corners hold less "
            f"than the least a {recipe.kind} needs"
        )
    for side, ends, units in zip(sides, meets, chosen, strict=True):
        inner = [_group_end(side, end) for end in ends]
        orders = [order_units(units, chooser.rng, inner) for _ in range(ORDERS)]
        ordered = min(orders, key=lambda order: _run_length(order, recipe, chooser))
        placed = _place_run(plan, recipe, chooser, side, ends, ordered)
        if placed is None:
            return plan, f"the run along the {side} wall does not fit"
        plan = placed
    return plan, ""


def _run_length(units: Sequence[Offer], recipe: Recipe, chooser: Chooser) -> float:
    """Length (m) of units side by side, with the gaps that they need to open."""
    pieces = [chooser.piece(unit.entry, recipe.shares[unit.share].role.name) for unit in units]
    return line_up("run", pieces).length if pieces else 0.0


def _corners(side: Side, sides: Sequence[Side]) -> list[int]:
    """Ends of a wall (0 low, 1 high along it) at which another run meets it."""
    meets: dict[Side, tuple[Side, Side]] = {
        "front": ("left", "right"),
        "back": ("left", "right"),
        "left": ("front", "back"),
        "right": ("front", "back"),
    }
    return [end for end, other in enumerate(meets[side]) if other in sides]


def _group_end(side: Side, end: int) -> int:
    """End of a cluster at an end of its wall: swapped along back and left walls."""
    return 1 - end if side in ("back", "left") else end


def _place_run(
    plan: Plan, recipe: Recipe, chooser: Chooser, side: Side, ends: list[int], units: list[Offer]
) -> Plan | None:
    """The longest part of a run that fits, starting at its corner."""
    length = wall_length(side, plan.size)
    needed = {index for index, share in enumerate(recipe.shares) if share.least}
    while units:
        names = [recipe.shares[unit.share].role.name for unit in units]
        pieces = [chooser.piece(unit.entry, name) for unit, name in zip(units, names, strict=True)]
        cluster = line_up(side, pieces)
        low = RESERVE if 0 in ends else GAP
        high = length - cluster.length - (RESERVE if 1 in ends else GAP)
        starts = high - SHIFTS if ends == [1] else low + SHIFTS
        starts = starts[(starts >= low - 1e-9) & (starts <= high + 1e-9)]
        against = plan.boxes
        for place in wall_places(plan, cluster, side, starts):
            if fits(plan, place.boxes, against):
                return plan.with_place(place)
        shares = [unit.share for unit in units]
        spare = [
            index
            for index, share in enumerate(shares)
            if share not in needed or shares.count(share) > recipe.shares[share].least
        ]
        if not spare:
            return None
        units = [unit for index, unit in enumerate(units) if index != spare[-1]]
    return plan


def close_corners(plan: Plan) -> Plan:
    """The plan with fillers between low runs that meet in a corner."""
    runs = {place.cluster.name: place for place in plan.places if place.side == place.cluster.name}
    for side in ("back",):
        for end, other in ((0, "left"), (1, "right")):
            if side in runs and other in runs:
                plan = _close_corner(plan, runs[side], runs[other], end)
    return plan


def _close_corner(plan: Plan, back: Place, beside: Place, end: int) -> Plan:
    """Two boxes from the first units of both runs into the corner, with aligned fronts."""
    first = _nearest(back, axis=0, end=end)
    second = _nearest(beside, axis=1, end=1)
    if max(first[1, 2], second[1, 2]) > TALL:
        return plan
    width, depth, _ = plan.size
    height = float(min(first[1, 2], second[1, 2]))
    start = float(first[0, 0] if end == 0 else width - first[1, 0]) - GAP
    front = depth - float(_face_of(back, 1, end))
    side_front = float(_face_of(beside, 0, end) if end == 0 else width - _face_of(beside, 0, end))
    stop = depth - float(second[1, 1]) - GAP
    along: Side = "back"
    a0, a1 = (GAP, start) if end == 0 else (width - start, width - GAP)
    boxes = [along_wall(along, plan.size, (a0, GAP, GAP), (a1, front, height))]
    if stop > front + 0.01:
        b0, b1 = (GAP, side_front) if end == 0 else (width - side_front, width - GAP)
        boxes.append(along_wall(along, plan.size, (b0, front + 1e-3, GAP), (b1, stop, height)))
    for box in boxes:
        plan = _with_filler(plan, box, f"{beside.cluster.name}_corner")
    return plan


def close_gaps(plan: Plan) -> Plan:
    """The plan with panels in the gaps of its runs, slightly behind the fronts on both sides."""
    for place in plan.places:
        if place.side is None or place.cluster.name != place.side:
            continue
        axis, out = (0, 1) if place.side in ("front", "back") else (1, 0)
        wall = 0.0 if place.side in ("front", "left") else plan.size[out]
        fronts = [
            abs(float((place.T @ member.T @ np.array([member.piece.face, 0.0, 0.0, 1.0]))[out]) - wall)
            for member in place.cluster.members
        ]
        units = sorted(zip(member_boxes(place), fronts, strict=True), key=lambda unit: unit[0][0, axis])
        for (one, front), (other, next_front) in pairwise(units):
            start, stop = float(one[1, axis]), float(other[0, axis])
            if stop - start > NARROW:
                low = (start + GAP, GAP, GAP)
                high = (stop - GAP, min(front, next_front) - 0.01, float(min(one[1, 2], other[1, 2])) - GAP)
                plan = _with_filler(plan, along_wall(place.side, plan.size, low, high), f"{place.side}_gap")
    return plan


def _with_filler(plan: Plan, box: Float[np.ndarray, "2 3"], name: str) -> Plan:
    """Adds a panel if it is thick enough and free of conflicts."""
    empty = np.zeros((0, 2, 3))
    solid = Boxes(bodies=box[None], sweeps=empty, stands=empty)
    if (box[1] - box[0] < 0.004).any() or not fits(plan, solid, plan.boxes):
        return plan
    piece = Piece(role="filler", entry=None, boxes=solid, face=0.0)
    members = (Member(piece=piece, T=np.eye(4)),)
    unique = f"{name}_{len(plan.places)}"
    cluster = Cluster(name=unique, members=members, boxes=solid, length=0.0, depth=0.0)
    return plan.with_place(Place(cluster=cluster, T=np.eye(4), boxes=solid, side=None))


def member_boxes(place: Place) -> list[Float[np.ndarray, "2 3"]]:
    """Box of every member in the room, in the order of members."""
    moved = [move_boxes(member.piece.boxes, place.T @ member.T).bodies for member in place.cluster.members]
    return [np.stack([bodies[:, 0].min(axis=0), bodies[:, 1].max(axis=0)]) for bodies in moved]


def _nearest(place: Place, axis: int, end: int) -> Float[np.ndarray, "2 3"]:
    """Box of the member nearest to the low (0) or high (1) end of an axis."""
    boxes = member_boxes(place)
    return min(boxes, key=lambda box: box[0, axis]) if end == 0 else max(boxes, key=lambda box: box[1, axis])


def _face_of(place: Place, axis: int, end: int) -> float:
    """Coordinate, across the wall, of the front without handles of the run's foremost unit."""
    faces = []
    for member in place.cluster.members:
        point = (place.T @ member.T) @ np.array([member.piece.face, 0.0, 0.0, 1.0])
        faces.append(float(point[axis]))
    # The back wall is at high y; the left one at low x, the right one at high x.
    return min(faces) if axis == 1 or end == 1 else max(faces)
