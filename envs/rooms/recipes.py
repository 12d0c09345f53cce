"""Recipes of rooms as tables: roles, their numbers, and placement preferences."""

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Literal

from artigen.kind import Place, Size, find_kind, kinds, list_words
from artigen.types import RoomKind, SceneKind

from .patterns import Pattern
from .room import THICKNESS, Side

Where = Literal["wall", "middle"]

MIDDLE = (0.2, 0.5)
"""Pull of categories that belong nowhere in a run."""
COUNTERS = ("worktop", "base cabinet", "island", "sideboard")


@dataclass(frozen=True)
class Role:
    """A function in a room; the records of kinds say which sizes of which kinds fill it."""

    name: str

    @property
    def places(self) -> tuple[tuple[str, Place], ...]:
        """Kinds and the sizes that fill the role, in the order of the kinds' words."""
        return tuple(
            (name, place)
            for name in list_words()
            for place in kinds()[name].places
            if place.role == self.name
        )

    @property
    def categories(self) -> tuple[str, ...]:
        """Kinds that fill the role."""
        return tuple(name for name, _ in self.places)

    @property
    def draws(self) -> tuple[tuple[str, Size], ...]:
        """Objects to draw without a folder of packages: kind and desired size (0 samples it from the
        seed)."""
        return tuple((name, size) for name, place in self.places for size in place.draws)


@dataclass(frozen=True, kw_only=True)
class Share:
    """Smallest, desired and largest number of a role in a run or on the tops of a room.

    If roles ``on`` are given, only their tops are used.
    """

    role: Role
    least: int = 0
    wanted: int
    most: int
    on: tuple[str, ...] = ()
    weight: float = 1.0
    """How much more than others a role is missed in a run, if its number is not the desired one."""


@dataclass(frozen=True, kw_only=True)
class Group:
    """Pieces side by side, backs in one line; ``bed`` among ``roles`` is a bed made of boxes."""

    name: str
    roles: tuple[str, ...]
    count: tuple[int, int]
    """Smallest and largest number; surplus pieces are dropped if they do not fit."""
    where: Where = "wall"
    double: bool = False
    """Two rows back to back instead of one."""
    like: Literal["corner", "middle", "anywhere"] = "anywhere"
    near: str | None = None
    """A group to be close to."""
    height: float | None = None
    """Height (m) of the undersides above the floor, for groups that hang on a wall."""
    sunk: float = 0.0
    """Depth (m) of the part that lies in an opening of the wall."""


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """A kind of room. ``shares`` fill gapless runs along the walls of ``layouts``, ``groups`` stand by
    themselves, and ``tops`` are placed on furniture of suitable height."""

    kind: RoomKind
    width: tuple[float, float]
    depth: tuple[float, float]
    needed: tuple[Role, ...]
    layouts: tuple[tuple[Side, ...], ...] = ()
    shares: tuple[Share, ...] = ()
    hung: Share | None = None
    groups: tuple[Group, ...] = ()
    roles: tuple[Role, ...] = ()
    tops: tuple[Share, ...] = ()
    least: int = 10
    """Smallest number of objects by default."""
    wall_color: tuple[float, float, float] = (0.90, 0.89, 0.86)
    floor: Pattern = "planks"
    wall: Pattern = "plain"

    @property
    def all_roles(self) -> tuple[Role, ...]:
        """Every role that the room can use, once each."""
        hung = () if self.hung is None else (self.hung,)
        every = [*self.roles, *(share.role for share in (*self.shares, *hung, *self.tops))]
        return tuple({role.name: role for role in every}.values())


def soften(recipe: Recipe, roles: Collection[str]) -> Recipe:
    """The recipe that also does without some roles, but those that its kind of room needs."""
    spare = set(roles) - {role.name for role in recipe.needed}
    shares = (replace(each, least=0) if each.role.name in spare else each for each in recipe.shares)
    groups = (
        replace(each, count=(0, each.count[1])) if set(each.roles) <= spare else each
        for each in recipe.groups
    )
    return replace(recipe, shares=tuple(shares), groups=tuple(groups))


def pull_along(category: str) -> tuple[float, float]:
    """Weight, and share of the length of a run of units at which a category belongs."""
    kind = find_kind(category)
    return max((place.along for place in kind.places), default=MIDDLE) if kind is not None else MIDDLE


FRIDGE = Role("fridge")
RANGE = Role("range")
DISHWASHER = Role("dishwasher")
WASHER = Role("washing machine")
SINK = Role("sink")
BASE = Role("base cabinet")
LARDER = Role("larder")
HUNG = Role("wall cabinet")
MICROWAVE = Role("microwave")
TABLE_OVEN = Role("table oven")
CART = Role("cart")
ISLAND = Role("island")
DINING = Role("table")
DESK = Role("desk")
PEDESTAL = Role("pedestal")
FILING = Role("filing cabinet")
BOOKCASE = Role("bookcase")
SIDEBOARD = Role("sideboard")
BIN = Role("bin")
LAMP = Role("lamp")
LAPTOP = Role("laptop")
PRINTER = Role("printer")
TOASTER = Role("toaster")
BREAD = Role("bread box")
POT = Role("pot")
DOOR = Role("door")
WINDOW = Role("window")
TOILET = Role("toilet")
DRYER = Role("dryer")
FREEZER = Role("chest freezer")
TOOL_BOX = Role("tool box")
TOOL_CHEST = Role("tool chest")
CRATE = Role("crate")
LUGGAGE = Role("suitcase")
SAFE = Role("safe")
SMALL_FRIDGE = Role("small fridge")
LOW_TABLE = Role("low table")
NIGHTSTAND = Role("nightstand")
WARDROBE = Role("wardrobe")
DRESSER = Role("dresser")
LOWBOARD = Role("lowboard")


def _perhaps(
    role: str,
    most: int = 1,
    *,
    where: Where = "wall",
    like: Literal["corner", "middle", "anywhere"] = "anywhere",
    near: str | None = None,
) -> Group:
    """None to ``most`` pieces of a role, each by itself; the group has the name of the role."""
    return Group(name=role, roles=(role,), count=(0, most), where=where, like=like, near=near)


WINDOWS = Group(name="windows", roles=("window",), count=(0, 2), like="middle", height=0.92, sunk=THICKNESS)

KITCHEN = Recipe(
    kind="kitchen",
    floor="tiles",
    width=(3.9, 5.2),
    depth=(3.6, 4.8),
    needed=(BASE, FRIDGE, RANGE),
    layouts=(("back", "left"), ("back", "right"), ("back", "left", "right")),
    shares=(
        Share(role=FRIDGE, least=1, wanted=1, most=1),
        Share(role=RANGE, least=1, wanted=1, most=1),
        Share(role=DISHWASHER, wanted=1, most=1),
        Share(role=WASHER, wanted=1, most=1),
        Share(role=SINK, least=1, wanted=1, most=1, weight=4.0),
        Share(role=BASE, least=2, wanted=6, most=10),
        Share(role=LARDER, wanted=1, most=2),
    ),
    hung=Share(role=HUNG, wanted=5, most=8),
    groups=(
        _perhaps("island", where="middle", like="middle"),
        _perhaps("table", where="middle"),
        _perhaps("cart", like="corner"),
        _perhaps("bin", like="corner"),
    ),
    roles=(ISLAND, DINING, CART, BIN, DOOR, WINDOW),
    tops=(
        Share(role=MICROWAVE, wanted=2, most=2),
        Share(role=TABLE_OVEN, wanted=1, most=1),
        Share(role=TOASTER, wanted=1, most=1, on=COUNTERS),
        Share(role=BREAD, wanted=1, most=1, on=COUNTERS),
        Share(role=POT, wanted=2, most=2, on=(*COUNTERS, "table")),
    ),
    wall_color=(0.90, 0.90, 0.87),
)

OFFICE = Recipe(
    kind="office",
    width=(5.4, 7.2),
    depth=(4.6, 6.0),
    needed=(DESK, PEDESTAL, BOOKCASE),
    groups=(
        Group(name="desks", roles=("desk", "pedestal"), count=(2, 3)),
        Group(name="bookcases", roles=("bookcase", "bookcase"), count=(1, 2), like="corner"),
        Group(name="team", roles=("desk", "desk"), count=(0, 1), where="middle", double=True, like="middle"),
        Group(name="filing", roles=("filing cabinet", "filing cabinet"), count=(0, 2), like="corner"),
        _perhaps("sideboard", like="middle"),
        _perhaps("safe", like="corner"),
        _perhaps("small fridge", like="corner", near="sideboard"),
        _perhaps("cart", like="corner"),
        _perhaps("bin", 2, like="corner", near="desks"),
    ),
    roles=(DESK, PEDESTAL, BOOKCASE, FILING, SIDEBOARD, SAFE, SMALL_FRIDGE, CART, BIN, DOOR, WINDOW),
    tops=(
        Share(role=LAPTOP, wanted=3, most=3, on=("desk",)),
        Share(role=LAMP, wanted=2, most=2, on=("desk",)),
        Share(role=PRINTER, wanted=1, most=1, on=("filing cabinet", "sideboard", "pedestal", "desk")),
        Share(role=MICROWAVE, wanted=1, most=1, on=("sideboard", "filing cabinet")),
    ),
    wall_color=(0.88, 0.90, 0.91),
)

BEDROOM = Recipe(
    kind="bedroom",
    width=(4.4, 5.8),
    depth=(4.2, 5.4),
    needed=(NIGHTSTAND, WARDROBE, DRESSER),
    groups=(
        Group(name="bed", roles=("nightstand", "bed", "nightstand"), count=(1, 1), like="middle"),
        Group(name="wardrobes", roles=("wardrobe", "wardrobe"), count=(1, 1), like="corner"),
        Group(name="dresser", roles=("dresser",), count=(1, 2)),
        Group(name="desk", roles=("desk", "pedestal"), count=(0, 1)),
        _perhaps("lowboard", like="middle"),
        _perhaps("bookcase", like="corner"),
        Group(name="chest", roles=("pedestal", "pedestal"), count=(0, 1)),
        _perhaps("safe", like="corner"),
        _perhaps("bin", like="corner"),
        _perhaps("suitcase", like="corner"),
    ),
    roles=(
        NIGHTSTAND, WARDROBE, DRESSER, DESK, PEDESTAL, LOWBOARD, BOOKCASE, SAFE, BIN, LUGGAGE, DOOR, WINDOW,
    ),
    tops=(
        Share(role=LAMP, wanted=1, most=1, on=("desk", "dresser")),
        Share(role=LAPTOP, wanted=1, most=1, on=("desk", "dresser")),
    ),
    wall_color=(0.91, 0.88, 0.85),
)  # fmt: skip

BATHROOM = Recipe(
    kind="bathroom",
    floor="tiles",
    wall="wall_tiles",
    width=(3.6, 4.8),
    depth=(3.2, 4.4),
    needed=(TOILET, WASHER),
    groups=(
        Group(name="toilet", roles=("toilet",), count=(1, 1), like="corner"),
        Group(name="sink", roles=("sink",), count=(1, 1), like="middle"),
        _perhaps("shower", like="corner"),
        Group(name="laundry", roles=("washing machine", "dryer"), count=(1, 1), like="corner"),
        Group(name="cupboards", roles=("nightstand", "nightstand"), count=(1, 2)),
        _perhaps("bookcase", like="corner"),
        _perhaps("dresser"),
        _perhaps("bin", 2, like="corner", near="toilet"),
        _perhaps("crate", 2, like="corner"),
        _perhaps("cart"),
    ),
    roles=(TOILET, SINK, WASHER, DRYER, NIGHTSTAND, BOOKCASE, DRESSER, BIN, CRATE, CART, DOOR, WINDOW),
    wall_color=(0.86, 0.91, 0.92),
)

WORKSHOP = Recipe(
    kind="workshop",
    floor="stone",
    width=(5.0, 6.6),
    depth=(4.4, 5.8),
    needed=(DESK, FILING),
    groups=(
        Group(name="benches", roles=("desk", "desk"), count=(1, 2), like="middle"),
        Group(name="filing", roles=("filing cabinet", "filing cabinet"), count=(1, 2), like="corner"),
        _perhaps("tool chest", where="middle"),  # its lid leans out behind
        Group(name="shelves", roles=("bookcase", "bookcase"), count=(0, 2), like="corner"),
        _perhaps("chest freezer", like="corner"),
        _perhaps("cart", 2),
        Group(name="crates", roles=("crate", "crate"), count=(0, 2)),
        _perhaps("bin", like="corner"),
        _perhaps("safe", like="corner"),
    ),
    roles=(DESK, TOOL_CHEST, FILING, BOOKCASE, FREEZER, CART, CRATE, BIN, SAFE, DOOR, WINDOW),
    tops=(
        Share(role=TOOL_BOX, wanted=3, most=3, on=("desk", "filing cabinet")),
        Share(role=LAMP, wanted=1, most=1, on=("desk",)),
    ),
    wall_color=(0.85, 0.85, 0.83),
)

LIVING_ROOM = Recipe(
    kind="living_room",
    width=(4.6, 6.2),
    depth=(4.2, 5.6),
    needed=(LOWBOARD, LOW_TABLE),
    least=6,
    groups=(
        Group(name="sofa", roles=("nightstand", "sofa"), count=(1, 1), like="middle"),
        Group(name="low table", roles=("low table",), count=(1, 1), where="middle", near="sofa"),
        Group(name="lowboard", roles=("lowboard",), count=(1, 1), like="middle"),
        Group(name="bookcases", roles=("bookcase", "bookcase"), count=(1, 2), like="corner"),
        _perhaps("armchair", 2, near="sofa"),
        _perhaps("sideboard"),
        _perhaps("dresser"),
        _perhaps("desk", like="corner"),
        _perhaps("bin", like="corner", near="desk"),
    ),
    roles=(NIGHTSTAND, LOW_TABLE, LOWBOARD, BOOKCASE, SIDEBOARD, DRESSER, DESK, BIN, DOOR, WINDOW),
    tops=(
        Share(role=LAMP, wanted=2, most=2, on=("sideboard", "desk", "dresser")),
        Share(role=LAPTOP, wanted=1, most=1, on=("desk", "low table")),
    ),
    wall_color=(0.92, 0.90, 0.86),
)

HALL = Recipe(
    kind="hall",
    width=(2.8, 4.2),
    depth=(3.0, 4.6),
    needed=(WARDROBE,),
    least=4,
    groups=(
        Group(name="wardrobes", roles=("wardrobe",), count=(1, 2), like="corner"),
        Group(name="bench", roles=("bench",), count=(1, 1)),
        _perhaps("dresser", like="middle"),
        _perhaps("nightstand"),
        _perhaps("suitcase", 2, like="corner"),
        _perhaps("crate", like="corner"),
        _perhaps("bin", like="corner"),
    ),
    roles=(WARDROBE, DRESSER, NIGHTSTAND, LUGGAGE, CRATE, BIN, DOOR, WINDOW),
    tops=(Share(role=LAMP, wanted=1, most=1, on=("dresser",)),),
    wall_color=(0.92, 0.91, 0.88),
)

LAUNDRY = Recipe(
    kind="laundry",
    floor="tiles",
    width=(3.0, 4.2),
    depth=(2.8, 4.0),
    needed=(WASHER, BASE),
    least=5,
    groups=(
        Group(name="machines", roles=("washing machine", "dryer"), count=(1, 2), like="middle"),
        Group(name="cupboards", roles=("base cabinet", "base cabinet"), count=(1, 1)),
        _perhaps("sink"),
        _perhaps("bookcase", like="corner"),
        _perhaps("crate", 2, like="corner"),
        _perhaps("cart"),
        _perhaps("bin", like="corner"),
    ),
    roles=(WASHER, DRYER, BASE, SINK, BOOKCASE, CRATE, CART, BIN, DOOR, WINDOW),
    wall_color=(0.90, 0.92, 0.92),
)

RECIPES: dict[SceneKind, Recipe] = {
    "kitchen": KITCHEN, "office": OFFICE, "bedroom": BEDROOM, "bathroom": BATHROOM, "workshop": WORKSHOP,
    "living_room": LIVING_ROOM, "hall": HALL, "laundry": LAUNDRY,
}  # fmt: skip
