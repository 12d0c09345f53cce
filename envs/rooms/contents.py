"""Puts loose things into the drawers and cupboards of a room, selected by its seed."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.kind import find_kind
from artigen.transforms import rotation_about
from artigen.types import SceneKind

from .check import check_contents
from .compartments import Compartment, cached_compartments
from .room import Item, Placement, Room, corner, rounded_quat
from .things import THINGS, Color, Size, Thing, thing_hulls

VARIETY = 3
"""Largest number of kinds of things in a compartment."""
TRIES = 40
"""Number of places tried in a compartment."""
FILL = (0.2, 0.6)
"""Range of the share of a floor that is covered, when enough things fit."""
SPACING = 0.008
"""Distance (m) between things."""
LIFT = 0.0005
"""Distance (m) of things from the floor."""
SKEW = np.radians(12.0)
"""Largest angle (radians) between a thing and a wall."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawn:
    """A thing of some size (m), rotation and colours, which has no place yet."""

    thing: Thing
    size: Size
    R: Float[np.ndarray, "3 3"]
    colors: tuple[Color, Color]

    @property
    def points(self) -> Float[np.ndarray, "N 3"]:
        """Corners of its hulls, turned, with its lowest point at z = 0."""
        return np.concatenate([hull.vertices for hull in thing_hulls(self.thing.name, self.size)]) @ self.R.T

    def item(self, number: int, holder: str | None, link: str, at: Float[np.ndarray, "3"]) -> Item:
        """The thing at a place in the frame of its holder."""
        return Item(
            id=f"{self.thing.name}_{number}",
            thing=self.thing.name,
            holder=holder,
            link=link,
            position=corner(at),
            quat=rounded_quat(self.R),
            size=self.size,
            mass=round(self.thing.density * float(np.prod(self.size)), 4),
            colors=self.colors,
        )


def draw_thing(thing: Thing, rng: np.random.Generator, skew: float = SKEW) -> Drawn:
    """A thing turned by quarters and up to ``skew`` (radians); what has a face shows it to -x."""
    x, y, z = (round(float(value), 4) for value in rng.uniform(thing.low, thing.high))
    quarters, rest = int(rng.integers(4)), float(rng.uniform(-skew, skew))
    yaw = rest if thing.faces else quarters * np.pi / 2 + rest
    palette = thing.colors[int(rng.integers(len(thing.colors)))]
    R = rotation_about(np.array([0.0, 0.0, 1.0]), np.array(yaw))[:3, :3]
    return Drawn(thing=thing, size=(x, y, z), R=R, colors=palette)


def fill_room(room: Room, share: float) -> Room:
    """The room with things in about ``share`` of its drawers and cupboards.

    What is in a compartment does not depend on ``share``. Things that fail the check of the room are left
    out.
    """
    items: list[Item] = []
    for index, placement in enumerate(room.placements):
        for place, compartment in enumerate(cached_compartments(placement.package)):
            rng = np.random.default_rng([room.seed, room.attempt, 2, index, place])
            if not compartment.open and rng.random() < share:
                items += fill_compartment(compartment, room.kind, placement, rng)
    return add_items(room, items)


def add_items(room: Room, items: Sequence[Item]) -> Room:
    """The room with more things, numbered on; those that fail the check of the room are left out."""
    numbers = Counter(item.thing for item in room.contents)
    added = []
    for item in items:
        numbers[item.thing] += 1
        added.append(replace(item, id=f"{item.thing}_{numbers[item.thing]}"))
    full = replace(room, contents=(*room.contents, *added))
    new = {item.id for item in added}
    failed = {name for problem in check_contents(full) for name in (problem.id, problem.other)} & new
    return replace(full, contents=tuple(item for item in full.contents if item.id not in failed))


def fill_compartment(
    compartment: Compartment, kind: SceneKind, holder: Placement, rng: np.random.Generator
) -> list[Item]:
    """Things of a few kinds at free places of a compartment; none where none fits."""
    low, high = np.array(compartment.low), np.array(compartment.high)
    held = find_kind(holder.category)
    cold = held is not None and held.holds == "food"
    where = "fridge" if cold else f"{kind} {compartment.kind}"
    fitting = [thing for thing in THINGS if where in thing.where and _fits(thing, high - low)]
    fitting = [fitting[index] for index in rng.permutation(len(fitting))[:VARIETY]]
    wanted = float(rng.uniform(*FILL)) * float(np.prod((high - low)[:2]))
    items: list[Item] = []
    boxes = np.zeros((0, 2, 2))
    for _ in range(TRIES if fitting else 0):
        thing = fitting[int(rng.integers(len(fitting)))]
        drawn = draw_thing(thing, rng)
        turned = drawn.points
        spare = high - low - np.ptp(turned, axis=0) - np.array([0.0, 0.0, LIFT])
        at = low[:2] + rng.random(2) * spare[:2] - turned[:, :2].min(axis=0)
        box = np.stack([turned[:, :2].min(axis=0), turned[:, :2].max(axis=0)]) + at
        apart = (boxes[:, 0] - SPACING >= box[1]) | (boxes[:, 1] + SPACING <= box[0])
        if (spare < 0.0).any() or not apart.any(axis=1).all():
            continue
        boxes = np.concatenate([boxes, box[None]])
        items.append(drawn.item(len(items), holder.id, compartment.link, np.array([*at, low[2] + LIFT])))
        if float(np.prod(boxes[:, 1] - boxes[:, 0], axis=1).sum()) > wanted:
            break
    return items


def _fits(thing: Thing, room: Float[np.ndarray, "3"]) -> bool:
    """Whether the smallest thing of a kind fits into a box in one of two directions."""
    x, y, z = thing.low
    return bool(z < room[2] and min(x, y) < room[:2].min() and max(x, y) < room[:2].max())
