"""Rooms on order: units side by side along one wall, exactly those and in that order.

Orders are words such as ``fridge``, ``sink:0.8`` or ``3*base cabinet:0.6``: a number, a role or a noun of a
kind that can fill one, and a width in metres; or the folder of a package.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from artigen.errors import ArtigenError
from artigen.kind import find_noun
from artigen.types import SceneKind

from .arrange import Plan, fits, wall_places
from .catalogue import Catalogue, Entry, fits_role, read_entry
from .pieces import GAP, Cluster, line_up, move_boxes, overlap
from .recipes import RECIPES, Role
from .room import Side, wall_length
from .runs import Chooser

SYNONYMS = {
    "pantry": "larder", "tall cabinet": "larder", "cabinet": "base cabinet", "cupboard": "base cabinet",
    "drawers": "base cabinet", "vanity": "base cabinet", "washer": "washing machine",
}  # fmt: skip
"""Roles by words that are neither roles nor nouns of the right kind."""
WIDTH = 0.02
"""Largest difference (m) from an ordered width."""
STEP = 0.02
"""Distance (m) between places that are tried along the wall."""


@dataclass(frozen=True, kw_only=True)
class Unit:
    """One ordered unit, and its width (m) if that was ordered."""

    role: Role
    width: float | None = None
    package: Path | None = None
    """The package that it is."""

    @property
    def draws(self) -> tuple[tuple[str, tuple[float, float, float]], ...]:
        """Kind and size (m) of an object to draw for it; none for a package."""
        if self.package is not None:
            return ()
        kind, place = self.role.places[0]
        middle = [(low + high) / 2.0 for low, high in zip(place.low, place.high, strict=True)]
        depth, width, height = place.draws[0] if place.draws else middle
        return ((kind, (depth, self.width or width, height)),)

    def accepts(self, entry: Entry) -> bool:
        """Whether a package is the ordered one, or has the ordered width."""
        if self.package is not None:
            return entry.folder == self.package
        return self.width is None or abs(entry.size[1] - self.width) <= WIDTH


def read_order(words: Sequence[str], kind: SceneKind) -> tuple[Unit, ...]:
    """The units that words ask for.

    Raises:
        ArtigenError: If a word names no role of the room, or its width is not a number in the role's range.
    """
    units: list[Unit] = []
    for word in words:
        count, star, one = word.partition("*")
        if not star:
            units.append(_read_unit(word, kind))
        elif count.strip().isdecimal() and int(count) > 0:
            units += [_read_unit(one, kind)] * int(count)
        else:
            raise ArtigenError(f"order {word!r}: {count!r} units, expected a number from 1 before the *")
    return tuple(units)


def _read_unit(word: str, kind: SceneKind) -> Unit:
    if (Path(word) / "mobility.urdf").is_file():
        return _read_package(Path(word).resolve(), kind)
    name, _, text = word.partition(":")
    name = " ".join(name.replace("_", " ").lower().split())
    recipe = RECIPES[kind]
    standing = {share.role.name for share in recipe.shares} | {
        role for group in recipe.groups for role in group.roles if group.where == "wall"
    }
    roles = {role.name: role for role in recipe.all_roles if role.name in standing and role.places}
    found = SYNONYMS.get(name, name)
    if found not in roles:
        noun = find_noun(name)
        filled = [place.role for place in noun.places] if noun is not None else []
        found = next((role for role in filled if role in roles), "")
    if not found:
        raise ArtigenError(f"order {word!r}: a {kind} has no {name!r}, expected one of {', '.join(roles)}")
    role = roles[found]
    if not text:
        return Unit(role=role)
    try:
        width = float(text)
    except ValueError:
        width = np.nan
    ranges = [(place.low[1], place.high[1]) for _, place in role.places]
    if not any(low <= width <= high for low, high in ranges):
        said = " or ".join(f"{low:g} to {high:g}" for low, high in ranges)
        raise ArtigenError(f"order {word!r}: width {text!r} m, a {role.name} is {said} m wide")
    return Unit(role=role, width=width)


def _read_package(folder: Path, kind: SceneKind) -> Unit:
    """The unit that a package is: in the first role of the room that it fits, or in one of its own."""
    entry = read_entry(folder)
    roles = (role for role in RECIPES[kind].all_roles if fits_role(entry, role))
    role = next(roles, Role(entry.category.lower()))
    return Unit(role=role, width=entry.size[1], package=folder)


def order_entries(catalogue: Catalogue, unit: Unit) -> list[Entry]:
    """The packages that a unit can be."""
    if unit.package is not None:
        return [read_entry(unit.package)]
    return [entry for entry in catalogue.of_role(unit.role) if unit.accepts(entry)]


def least_length(order: Sequence[Unit]) -> float:
    """Length (m) of wall below which the units cannot stand side by side."""
    widths = [unit.width or min(place.low[1] for _, place in unit.role.places) for unit in order]
    return sum(widths) + GAP * (len(order) + 1)


def demand_order(catalogue: Catalogue, order: Sequence[Unit]) -> None:
    """Raises `ArtigenError` unless every ordered unit has a package."""
    for unit in order:
        if not order_entries(catalogue, unit):
            entries = catalogue.of_role(unit.role)
            widths = ", ".join(f"{entry.size[1]:.2f}" for entry in entries) or "none at all"
            wide = f" {unit.width:g} m wide" if unit.width else ""
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
    pieces = []
    for unit in order:
        entries = order_entries(catalogue, unit)
        if depth is not None and height is not None:
            sizes = np.array([entry.size for entry in entries])
            off = np.abs(sizes[:, 0] - depth) + np.abs(sizes[:, 2] - height)
            entry = entries[int((off + 1e-3 * chooser.rng.random(len(off))).argmin())]
        else:
            entry = entries[int(chooser.rng.integers(len(entries)))]
        if depth is None and entry.size[2] < 1.0:
            depth, _, height = entry.size
        pieces.append(chooser.piece(entry, unit.role.name))
    # Clusters run from right to left, as their fronts face the room.
    cluster = line_up(side, pieces[::-1])
    blocked = _find_blocked(cluster)
    if blocked:
        return plan, blocked
    spare = wall_length(side, plan.size) - cluster.length - 2 * GAP
    if spare < 0.0:
        return plan, f"the order is {-spare:.2f} m longer than the {side} wall"
    against = plan.boxes
    offsets = np.arange(GAP, spare + GAP + 1e-9, STEP)
    middle = GAP + spare / 2.0
    for place in wall_places(plan, cluster, side, offsets[np.argsort(np.abs(offsets - middle))]):
        if fits(plan, place.boxes, against):
            return plan.with_place(place), ""
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
