"""Rooms on order: units side by side along one wall, exactly those and in that order.

Orders are words such as ``fridge``, ``base cabinet`` or ``sink:0.8``: a role, or a noun of a kind that can
fill one, and a width in metres; ``sink@NAME`` is the package of that name, and a folder the package in it.
``3*cabinet`` are three. A number by itself is a length of wall (m) that stays free. Units behind ``above``
hang on the wall, again from the left end of the order.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from artigen.errors import ArtigenError
from artigen.kind import find_noun
from artigen.types import SceneKind

from .arrange import Plan, fits, wall_places
from .catalogue import Catalogue, Entry, fits_role, read_entry
from .hung import HUNG_HEIGHT
from .pieces import GAP, Cluster, Piece, line_up, move_boxes, overlap
from .recipes import RECIPES, Role
from .room import Side, wall_axis, wall_length
from .runs import Chooser, member_boxes

SYNONYMS = {
    "pantry": "larder", "tall cabinet": "larder", "cabinet": "base cabinet", "cupboard": "base cabinet",
    "drawers": "base cabinet", "vanity": "base cabinet", "washer": "washing machine",
}  # fmt: skip
"""Roles by words that are neither roles nor nouns of the right kind."""
ABOVE = "above"
"""Word behind which units hang."""
NUMBER = re.compile(r"\d*\.?\d+")
WIDTH = 0.02
"""Largest difference (m) from an ordered width."""
LOW = 1.0
"""Height (m) above which what stands is tall."""
SLIPS = (0.0, 0.02, 0.05, 0.1, 0.2, 0.3)
"""Distances (m) to the right by which what hangs may be moved until it opens."""
STEP = 0.02
"""Distance (m) between places that are tried along the wall."""


@dataclass(frozen=True, kw_only=True)
class Unit:
    """One ordered unit, and its width (m) or package if that was ordered."""

    role: Role
    width: float | None = None
    package: str | None = None
    folder: Path | None = None
    """Where its package is, if that was ordered."""
    free: float = 0.0
    """Length (m) of wall that stays free before it."""
    hung: bool = False

    @property
    def draws(self) -> tuple[tuple[str, tuple[float, float, float]], ...]:
        """Kind and size (m) of an object to draw for it; none for a folder."""
        if self.folder is not None:
            return ()
        kind, place = self.role.places[0]
        middle = [(low + high) / 2.0 for low, high in zip(place.low, place.high, strict=True)]
        depth, width, height = place.draws[0] if place.draws else middle
        return ((kind, (depth, self.width or width, height)),)

    def accepts(self, entry: Entry) -> bool:
        """Whether a package has the ordered width and name, or is the ordered one."""
        if self.folder is not None:
            return entry.folder == self.folder
        if self.package not in (None, entry.name):
            return False
        return self.width is None or abs(entry.size[1] - self.width) <= WIDTH


def read_order(words: Sequence[str], kind: SceneKind) -> tuple[Unit, ...]:
    """The units that words ask for.

    Raises:
        ArtigenError: If a word names no role of the room, or its width is not a number in the role's range.
    """
    units: list[Unit] = []
    free, hung = 0.0, False
    for word in words:
        if word.lower() == ABOVE:
            free, hung = 0.0, True
        elif NUMBER.fullmatch(word):
            free += float(word)
        else:
            count, star, one = word.rpartition("*")
            if star and not (count.strip().isdecimal() and int(count) > 0):
                raise ArtigenError(f"order {word!r}: {count!r} units, expected a number from 1 before the *")
            unit = _read_unit(one, kind, free, hung=hung)
            units += [unit, *[replace(unit, free=0.0)] * (int(count or 1) - 1)]
            free = 0.0
    if not all(unit.hung for unit in units) or not units:
        return tuple(units)
    raise ArtigenError(f"order {' '.join(words)!r}: nothing stands below what hangs; name what does first")


def _read_unit(word: str, kind: SceneKind, free: float, *, hung: bool) -> Unit:
    if (Path(word) / "mobility.urdf").is_file():
        return replace(_read_folder(Path(word).resolve(), kind), free=free, hung=hung)
    said, _, package = word.partition("@")
    name, _, text = said.partition(":")
    name = " ".join(name.replace("_", " ").lower().split())
    recipe = RECIPES[kind]
    allowed = {share.role.name for share in recipe.shares} | {
        role for group in recipe.groups for role in group.roles if group.where == "wall"
    }
    if hung:
        allowed = set() if recipe.hung is None else {recipe.hung.role.name}
    roles = {role.name: role for role in recipe.all_roles if role.name in allowed and role.places}
    found = SYNONYMS.get(name, name)
    if found not in roles:
        noun = find_noun(name)
        filled = [place.role for place in noun.places] if noun is not None else []
        found = next((role for role in filled if role in roles), "")
    if not found:
        where = " on its walls" if hung else ""
        said = ", ".join(roles) or "nothing"
        raise ArtigenError(f"order {word!r}: a {kind} has no {name!r}{where}, expected one of {said}")
    unit = Unit(role=roles[found], package=package or None, free=free, hung=hung)
    if not text:
        return unit
    try:
        width = float(text)
    except ValueError:
        width = np.nan
    ranges = [(place.low[1], place.high[1]) for _, place in unit.role.places]
    if not any(low <= width <= high for low, high in ranges):
        said = " or ".join(f"{low:g} to {high:g}" for low, high in ranges)
        raise ArtigenError(f"order {word!r}: width {text!r} m, a {unit.role.name} is {said} m wide")
    return replace(unit, width=width)


def _read_folder(folder: Path, kind: SceneKind) -> Unit:
    """The unit that a package is: in the first role of the room that it fits, or in one of its own."""
    entry = read_entry(folder)
    roles = (role for role in RECIPES[kind].all_roles if fits_role(entry, role))
    role = next(roles, Role(entry.category.lower()))
    return Unit(role=role, width=entry.size[1], folder=folder)


def order_entries(catalogue: Catalogue, unit: Unit) -> list[Entry]:
    """The packages that a unit can be."""
    if unit.folder is not None:
        return [read_entry(unit.folder)]
    return [entry for entry in catalogue.of_role(unit.role) if unit.accepts(entry)]


def least_length(order: Sequence[Unit]) -> float:
    """Length (m) of wall below which the units cannot stand side by side."""
    widths = [
        unit.free + (unit.width or min(place.low[1] for _, place in unit.role.places))
        for unit in order
        if not unit.hung
    ]
    return sum(widths) + GAP * (len(widths) + 1)


def demand_order(catalogue: Catalogue, order: Sequence[Unit]) -> None:
    """Raises `ArtigenError` unless every ordered unit has a package."""
    for unit in order:
        if not order_entries(catalogue, unit):
            entries = catalogue.of_role(unit.role)
            widths = ", ".join(f"{entry.size[1]:.2f}" for entry in entries) or "none at all"
            wide = f" {unit.width:g} m wide" if unit.width else ""
            wide += f" called {unit.package}" if unit.package else ""
            raise ArtigenError(
                f"{catalogue.folder}: nothing in it can be the ordered {unit.role.name}{wide}; "
                f"widths of what can be one are {widths}"
            )


def place_order(
    plan: Plan, order: Sequence[Unit], side: Side, catalogue: Catalogue, chooser: Chooser
) -> tuple[Plan, str]:
    """The plan with the ordered units along a wall, from left to right as seen from the room.

    Returns:
        The plan, and why the order cannot stand there (empty on success).
    """
    depth = height = None
    blocks: list[list[Piece]] = []
    for unit in (unit for unit in order if not unit.hung):
        entry = _choose(
            catalogue, unit, chooser, None if depth is None or height is None else (depth, height)
        )
        if depth is None and entry.size[2] < LOW:
            depth, _, height = entry.size
        if unit.free or not blocks:
            blocks.append([])
        blocks[-1].append(chooser.piece(entry, unit.role.name))
    # Clusters run from right to left, as their fronts face the room.
    clusters = [line_up(side, pieces[::-1]) for pieces in blocks]
    blocked = next(filter(None, map(_find_blocked, clusters)), "")
    if blocked and chooser.sweeps == "free":
        return plan, blocked
    frees = [unit.free for unit in order if not unit.hung and unit.free]
    starts = _find_starts(clusters, [*([0.0] if len(frees) < len(clusters) else []), *frees])
    length = starts[-1] + clusters[-1].length
    spare = wall_length(side, plan.size) - length - 2 * GAP
    if spare < 0.0:
        return plan, f"the order is {-spare:.2f} m longer than the {side} wall"
    offsets = np.arange(GAP, spare + GAP + 1e-9, STEP)
    middle = GAP + spare / 2.0
    for offset in offsets[np.argsort(np.abs(offsets - middle))]:
        tried: Plan | None = plan
        for cluster, start in zip(clusters, starts, strict=True):
            tried = tried and _place_at(tried, cluster, side, offset + start)
        if tried is not None:
            return _hang(tried, [unit for unit in order if unit.hung], side, offset, catalogue, chooser)
    return plan, f"nowhere along the {side} wall do all of the order open with a robot before them"


def _find_blocked(cluster: Cluster) -> str:
    """Which unit does not open beside which other one, at the gaps between them; empty if all do."""
    moved = [move_boxes(member.piece.boxes, member.T) for member in cluster.members]
    for one, boxes in zip(cluster.members, moved, strict=True):
        for other, there in zip(cluster.members, moved, strict=True):
            if one is not other and (
                overlap(boxes.sweeps, there.bodies) or overlap(boxes.stands, there.bodies)
            ):
                return f"the {one.piece.role} does not open beside the {other.piece.role}"
    return ""


def _choose(catalogue: Catalogue, unit: Unit, chooser: Chooser, alike: tuple[float, float] | None) -> Entry:
    """A package for a unit, as alike in depth and height (m) as can be."""
    entries = order_entries(catalogue, unit)
    if alike is None:
        return entries[int(chooser.rng.integers(len(entries)))]
    sizes = np.array([entry.size for entry in entries])
    off = np.abs(sizes[:, 0] - alike[0]) + np.abs(sizes[:, 2] - alike[1])
    return entries[int((off + 1e-3 * chooser.rng.random(len(off))).argmin())]


def _find_starts(clusters: Sequence[Cluster], frees: Sequence[float]) -> list[float]:
    """Distances (m) of clusters from the left end of the order."""
    starts, end = [], 0.0
    for cluster, free in zip(clusters, frees, strict=True):
        starts.append(end + free)
        end = starts[-1] + cluster.length
    return starts


def _place_at(plan: Plan, cluster: Cluster, side: Side, left: float) -> Plan | None:
    """The plan with a cluster whose left end, as seen from the room, is at a distance (m) from the wall's."""
    start = left if side in ("back", "left") else wall_length(side, plan.size) - left - cluster.length
    place = next(wall_places(plan, cluster, side, np.array([start])))
    return plan.with_place(place) if fits(plan, place.boxes, plan.boxes) else None


def _hang(
    plan: Plan, order: Sequence[Unit], side: Side, offset: float, catalogue: Catalogue, chooser: Chooser
) -> tuple[Plan, str]:
    """The plan with units on the wall, their tops level: the highest at the usual height, or each just above
    what is taller."""
    axis, end = wall_axis(side), offset
    wall = 0.0 if side in ("front", "left") else plan.size[1 - axis]
    entries = [_choose(catalogue, unit, chooser, None) for unit in order]
    top = HUNG_HEIGHT + max((entry.size[2] for entry in entries), default=0.0)
    for unit, entry in zip(order, entries, strict=True):
        wide, left = entry.size[1], end + unit.free
        end = left + wide
        for slip in SLIPS:
            low = (
                left + slip if side in ("back", "left") else wall_length(side, plan.size) - left - slip - wide
            )
            below = [
                box
                for place in plan.places
                if place.side == side
                for box in member_boxes(place)
                if box[0, axis] < low + wide and box[1, axis] > low and box[0, 2] < LOW
            ]
            ends = [float(box[1, 2]) for box in below]
            depth = max(
                (float(np.abs(box[:, 1 - axis] - wall).max()) for box in below), default=entry.size[0]
            )
            height = max([top - entry.size[2], *(end + GAP for end in ends if end > LOW)])
            piece = chooser.piece(entry, unit.role.name, entry.size[0] / 2.0 - depth, height)
            hung = _place_at(plan, line_up("hung", [piece], height), side, left + slip)
            if hung is not None:
                plan, end = hung, end + slip + GAP
                break
        else:
            return plan, f"the {unit.role.name} {unit.package or ''} has no place above the order"
    return plan, ""
