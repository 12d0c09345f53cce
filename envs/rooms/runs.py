"""Gapless runs of cabinets and appliances along walls, with fillers in corners and gaps."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise
from typing import Literal

import numpy as np
from jaxtyping import Float

from .arrange import Place, Plan, fits, wall_places
from .catalogue import Catalogue, Entry
from .choose import TALL, Offer, Wall, choose_units, order_units
from .compartments import cached_compartments
from .footprints import bounds_of, is_level
from .pieces import GAP, Boxes, Cluster, Member, Piece, line_up, make_piece, move_boxes
from .recipes import BASE, BOOKCASE, Recipe
from .room import Side, along_wall, wall_axis, wall_length

RESERVE = 0.88
"""Length (m) of both walls that a corner between two runs takes."""
ORDERS = 3
"""Number of random orders of a run; the one with the smallest gaps is used."""
NARROW = 0.012
"""Gap (m) between units above which a panel closes it."""
SETBACKS = (0.0, 0.03, 0.06, 0.11, 0.16)
"""Distances (m) of a corner's filler behind the fronts beside it that are tried."""
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
        return replace(piece, boxes=Boxes(bodies=piece.boxes.bodies))


def draw_shortlists(
    recipe: Recipe, catalogue: Catalogue, rng: np.random.Generator, variety: int, *, alike: bool
) -> dict[str, tuple[Entry, ...]]:
    """At most ``variety`` packages for every role of a room; cabinets without a top only if all are.

    Those that are ``alike`` are of one suite that has what the room needs, where it has the role, else of the
    suite with most roles.
    Bookcases have open shelves if any have.
    """
    of_role = {role: catalogue.of_role(role) for role in recipe.all_roles}
    roles = Counter(suite for entries in of_role.values() for suite in {entry.suite for entry in entries})
    whole = [
        suite
        for suite in roles
        if suite and all(any(entry.suite == suite for entry in of_role[role]) for role in recipe.needed)
    ]
    wide = sorted(whole or (suite for suite in roles if suite), key=str)
    lead = wide[int(rng.integers(len(wide)))] if wide else None
    lists: dict[str, tuple[Entry, ...]] = {}
    for role, entries in of_role.items():
        if alike and entries:
            suites = sorted({entry.suite for entry in entries}, key=str)
            first = max(suites, key=lambda suite: (suite == lead, roles[suite]))
            entries = [entry for entry in entries if entry.suite == first]
        if role == BOOKCASE:
            entries = [entry for entry in entries if _is_open(entry)] or entries
        order = rng.permutation(len(entries)).tolist()
        covered = (
            k
            for k in order
            if entries[k].category not in BASE.categories or is_level(entries[k].folder, "top")
        )
        picked = list(islice(covered, variety)) or order[:variety]
        lists[role.name] = tuple(entries[index] for index in sorted(picked))
    return lists


def _is_open(entry: Entry) -> bool:
    """Whether an object has open shelves."""
    return any(compartment.open for compartment in cached_compartments(entry.folder))


def count_objects(plan: Plan) -> int:
    """Number of packages placed so far."""
    return sum(member.piece.entry is not None for place in plan.places for member in place.cluster.members)


def runs_of(plan: Plan) -> dict[Side, Place]:
    """The runs by their walls, whose names they have."""
    return {place.side: place for place in plan.places if place.side and place.side == place.cluster.name}


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
    chosen = choose_units(offers, recipe.shares, walls, chooser.rng, most=chooser.most - count_objects(plan))
    if chosen is None:
        return plan, (
            f"walls with {' + '.join(f'{wall.length:.2f}' for wall in walls)} m free of corners hold less "
            f"than the least a {recipe.kind} needs, or {chooser.most} objects are fewer"
        )
    for side, ends, units in zip(sides, meets, chosen, strict=True):
        # Clusters run in the other direction along back and left walls.
        inner = [1 - end if side in ("back", "left") else end for end in ends]
        orders = [order_units(units, chooser.rng, inner) for _ in range(ORDERS)]
        ordered = min(
            orders, key=lambda order: _line_up(side, order, recipe, chooser).length if order else 0.0
        )
        placed = _place_run(plan, recipe, chooser, side, ends, ordered)
        if placed is None:
            return plan, f"the run along the {side} wall does not fit"
        plan = placed
    return plan, ""


def _line_up(name: str, units: Sequence[Offer], recipe: Recipe, chooser: Chooser) -> Cluster:
    """Units side by side, with the gaps that they need to open."""
    return line_up(name, [chooser.piece(unit.entry, recipe.shares[unit.share].role.name) for unit in units])


def _corners(side: Side, sides: Sequence[Side]) -> list[int]:
    """Ends of a wall (0 low, 1 high along it) at which another run meets it."""
    meets = ("front", "back") if wall_axis(side) else ("left", "right")
    return [end for end, other in enumerate(meets) if other in sides]


def _place_run(
    plan: Plan, recipe: Recipe, chooser: Chooser, side: Side, ends: list[int], units: list[Offer]
) -> Plan | None:
    """The longest part of a run that fits, starting at its corner."""
    length = wall_length(side, plan.size)
    needed = {index for index, share in enumerate(recipe.shares) if share.least}
    while units:
        cluster = _line_up(side, units, recipe, chooser)
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
        dropped = min(reversed(spare), key=lambda index: recipe.shares[shares[index]].weight)
        units = [unit for index, unit in enumerate(units) if index != dropped]
    return plan


def close_corners(plan: Plan, height: float) -> Plan:
    """The plan with fillers up to a height (m) between low runs that meet in a corner at the back."""
    runs = runs_of(plan)
    for end, side in enumerate(("left", "right")):
        if "back" in runs and side in runs:
            plan = _close_corner(plan, runs["back"], runs[side], end, height)
    return plan


def _close_corner(plan: Plan, back: Place, beside: Place, end: int, height: float) -> Plan:
    """Two boxes from the first units of both runs into the corner, as near to their fronts as doors allow."""
    first = _nearest(back, axis=0, end=end)
    second = _nearest(beside, axis=1, end=1)
    if max(first[1, 2], second[1, 2]) > TALL:
        return plan
    width, depth, _ = plan.size
    start = float(first[0, 0] if end == 0 else width - first[1, 0]) - GAP
    stop = depth - float(second[1, 1]) - GAP
    for setback in SETBACKS:
        front = max(_fronts(back, "back", plan)) - setback
        side_front = max(_fronts(beside, "left" if end == 0 else "right", plan)) - setback
        a0, a1 = (GAP, start) if end == 0 else (width - start, width - GAP)
        boxes = [along_wall("back", plan.size, (a0, GAP, GAP), (a1, front, height))]
        if stop > front + 0.01:
            b0, b1 = (GAP, side_front) if end == 0 else (width - side_front, width - GAP)
            boxes.append(along_wall("back", plan.size, (b0, front + 1e-3, GAP), (b1, stop, height)))
        if fits(plan, Boxes(bodies=np.array(boxes)), plan.boxes):
            for box in boxes:
                plan = _with_filler(plan, box, f"{beside.cluster.name}_corner")
            return plan
    return plan


def close_gaps(plan: Plan) -> Plan:
    """The plan with panels in the gaps of its runs, slightly behind the fronts on both sides."""
    for side, run in runs_of(plan).items():
        axis = wall_axis(side)
        fronts = _fronts(run, side, plan)
        units = sorted(zip(member_boxes(run), fronts, strict=True), key=lambda unit: unit[0][0, axis])
        for (one, front), (other, next_front) in pairwise(units):
            start, stop = float(one[1, axis]), float(other[0, axis])
            if stop - start > NARROW:
                low = (start + GAP, GAP, GAP)
                high = (stop - GAP, min(front, next_front) - 0.01, float(min(one[1, 2], other[1, 2])) - GAP)
                plan = _with_filler(plan, along_wall(side, plan.size, low, high), f"{side}_gap")
    return plan


def _with_filler(plan: Plan, box: Float[np.ndarray, "2 3"], name: str) -> Plan:
    """Adds a panel if it is thick enough and free of conflicts."""
    solid = Boxes(bodies=box[None])
    if (box[1] - box[0] < 0.004).any() or not fits(plan, solid, plan.boxes):
        return plan
    piece = Piece(role="filler", entry=None, boxes=solid, face=0.0)
    members = (Member(piece=piece, T=np.eye(4)),)
    unique = f"{name}_{len(plan.places)}"
    cluster = Cluster(name=unique, members=members, boxes=solid, length=0.0, depth=0.0)
    return plan.with_place(Place(cluster=cluster, T=np.eye(4), boxes=solid, side=None))


def member_boxes(place: Place) -> list[Float[np.ndarray, "2 3"]]:
    """Box of every member in the room, in the order of members."""
    moved = [move_boxes(member.piece.boxes, place.T @ member.T) for member in place.cluster.members]
    return [bounds_of(boxes.bodies) for boxes in moved]


def _nearest(place: Place, axis: int, end: int) -> Float[np.ndarray, "2 3"]:
    """Box of the member nearest to the low (0) or high (1) end of an axis."""
    boxes = member_boxes(place)
    return min(boxes, key=lambda box: box[0, axis]) if end == 0 else max(boxes, key=lambda box: box[1, axis])


def _fronts(run: Place, side: Side, plan: Plan) -> list[float]:
    """Distance from the wall of every member's front without handles, in the order of members."""
    axis = 1 - wall_axis(side)
    wall = 0.0 if side in ("front", "left") else plan.size[axis]
    return [
        abs(float((run.T @ member.T @ np.array([member.piece.face, 0.0, 0.0, 1.0]))[axis]) - wall)
        for member in run.cluster.members
    ]
