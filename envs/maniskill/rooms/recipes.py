"""Recipes of rooms as tables: roles by category and size, their numbers, and placement preferences.

Sizes are depth, width and height in metres, handles included.
"""

from dataclasses import dataclass
from typing import Literal

from .room import THICKNESS, RoomKind, Side

Size = tuple[float, float, float]
Where = Literal["wall", "middle"]

STORAGE = "StorageFurniture"
COUNTERS = ("base cabinet", "island", "sideboard")


@dataclass(frozen=True, kw_only=True)
class Role:
    """A function in a room that packages of some categories and sizes can fill."""

    name: str
    categories: tuple[str, ...]
    low: Size
    high: Size
    needs_joint: str | None = None
    """Kind of joint that a package must have."""
    draws: tuple[tuple[str, Size], ...] = ()
    """Objects to generate without a folder of packages: category and desired size (0 samples it from the
    seed)."""


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
    wall_color: tuple[float, float, float] = (0.90, 0.89, 0.86)

    @property
    def all_roles(self) -> tuple[Role, ...]:
        """Every role that the room can use, once each."""
        hung = () if self.hung is None else (self.hung,)
        every = [*self.roles, *(share.role for share in (*self.shares, *hung, *self.tops))]
        return tuple({role.name: role for role in every}.values())


def _role(
    name: str, categories: str, low: Size, high: Size, needs: str | None = None, draws: tuple = ()
) -> Role:
    return Role(
        name=name, categories=tuple(categories.split()), low=low, high=high, needs_joint=needs, draws=draws
    )


FRIDGE = _role(
    "fridge", "Refrigerator", (0.5, 0.45, 1.3), (0.95, 1.4, 2.2), draws=(("Refrigerator", (0.68, 0.7, 1.75)),)
)
RANGE = _role("range", "Oven", (0.5, 0.45, 0.75), (0.85, 1.25, 1.3), draws=(("Oven", (0.65, 0.6, 0.92)),))
DISHWASHER = _role(
    "dishwasher", "Dishwasher", (0.4, 0.4, 0.7), (0.75, 0.75, 1.0), draws=(("Dishwasher", (0.6, 0.6, 0.86)),)
)
WASHER = _role(
    "washing machine", "WashingMachine", (0.4, 0.4, 0.7), (0.8, 0.8, 1.3),
    draws=(("WashingMachine", (0.6, 0.6, 0.88)),),
)  # fmt: skip
SINK = _role("sink", "Table", (0.5, 0.5, 1.05), (0.7, 1.35, 1.25), draws=(("Table", (0.6, 0.9, 1.15)),))
BASE = _role(
    "base cabinet", STORAGE, (0.5, 0.28, 0.72), (0.74, 1.4, 1.0),
    draws=tuple((STORAGE, (0.6, width, 0.88)) for width in (0.45, 0.6, 0.8, 0.9)),
)  # fmt: skip
LARDER = _role("larder", STORAGE, (0.45, 0.4, 1.6), (0.74, 1.7, 2.3))
HUNG = _role(
    "wall cabinet", STORAGE, (0.25, 0.3, 0.34), (0.44, 1.25, 0.95), needs="revolute",
    draws=tuple((STORAGE, (0.34, width, 0.72)) for width in (0.6, 0.8)),
)  # fmt: skip
MICROWAVE = _role(
    "microwave", "Microwave", (0.25, 0.35, 0.2), (0.6, 0.7, 0.5), draws=(("Microwave", (0, 0, 0)),)
)
TABLE_OVEN = _role("table oven", "Oven", (0.3, 0.3, 0.25), (0.6, 0.8, 0.62))
CART = _role("cart", "Cart", (0.3, 0.4, 0.6), (0.7, 1.1, 1.1), draws=(("Cart", (0, 0, 0)),))
ISLAND = _role("island", STORAGE, (0.5, 0.9, 0.7), (0.95, 1.8, 1.0), draws=((STORAGE, (0.62, 1.2, 0.88)),))
DINING = _role("table", "Table", (0.55, 0.75, 0.66), (1.1, 2.0, 0.84), draws=(("Table", (0.8, 1.4, 0.75)),))
DESK = _role(
    "desk", "Table", (0.45, 0.95, 0.66), (0.9, 1.9, 0.82),
    draws=(("Table", (0.7, 1.4, 0.74)), ("Table", (0.65, 1.2, 0.74))),
)  # fmt: skip
PEDESTAL = _role(
    "pedestal", STORAGE, (0.3, 0.28, 0.38), (0.66, 0.66, 0.86), draws=((STORAGE, (0.5, 0.42, 0.6)),)
)
FILING = _role(
    "filing cabinet", f"FilingCabinet {STORAGE}", (0.3, 0.3, 0.7), (0.7, 1.7, 1.7),
    draws=((STORAGE, (0.45, 0.8, 1.1)), ("FilingCabinet", (0, 0, 1.3))),
)  # fmt: skip
BOOKCASE = _role("bookcase", STORAGE, (0.25, 0.4, 1.4), (0.7, 1.7, 2.3), draws=((STORAGE, (0.38, 0.9, 1.9)),))
SIDEBOARD = _role(
    "sideboard", STORAGE, (0.3, 0.7, 0.55), (0.6, 2.0, 0.98), draws=((STORAGE, (0.42, 1.3, 0.8)),)
)
BIN = _role("bin", "TrashCan", (0.18, 0.18, 0.25), (0.5, 0.5, 0.75), draws=(("TrashCan", (0, 0, 0)),))
LAMP = _role("lamp", "DeskLamp", (0.2, 0.1, 0.3), (0.6, 0.4, 0.7), draws=(("DeskLamp", (0, 0, 0)),))
LAPTOP = _role("laptop", "Laptop", (0.15, 0.25, 0.01), (0.35, 0.45, 0.05), draws=(("Laptop", (0, 0, 0)),))
PRINTER = _role("printer", "Printer", (0.25, 0.3, 0.1), (0.5, 0.6, 0.5), draws=(("Printer", (0, 0, 0)),))
TOASTER = _role("toaster", "Toaster", (0.2, 0.1, 0.12), (0.4, 0.4, 0.3), draws=(("Toaster", (0, 0, 0)),))
BREAD = _role("bread box", "BreadBox", (0.15, 0.2, 0.12), (0.35, 0.5, 0.3), draws=(("BreadBox", (0, 0, 0)),))
POT = _role("pot", "Pot", (0.1, 0.15, 0.08), (0.35, 0.5, 0.35), draws=(("Pot", (0, 0, 0)),))
DOOR = _role("door", "Door", (0.1, 0.6, 1.9), (0.45, 1.95, 2.3), draws=(("Door", (0.2, 0, 0)),))
WINDOW = _role("window", "Window", (0.05, 0.4, 0.6), (0.4, 1.9, 1.5), draws=(("Window", (0, 1.0, 1.2)),))
TOILET = _role("toilet", "Toilet", (0.45, 0.3, 0.35), (0.8, 0.65, 1.2), draws=(("Toilet", (0, 0, 0)),))
DRYER = _role("dryer", "Dryer", (0.4, 0.5, 0.7), (0.8, 0.8, 1.2), draws=(("Dryer", (0, 0, 0)),))
FREEZER = _role(
    "chest freezer", "ChestFreezer", (0.5, 0.5, 0.7), (0.8, 1.7, 1.0), draws=(("ChestFreezer", (0, 0, 0)),)
)
TOOL_BOX = _role("tool box", "ToolBox", (0.15, 0.3, 0.12), (0.3, 0.6, 0.4), draws=(("ToolBox", (0, 0, 0)),))
TOOL_CHEST = _role(
    "tool chest", "ToolBox", (0.25, 0.35, 0.45), (0.6, 0.9, 1.1), draws=(("ToolBox", (0, 0, 0.6)),)
)
CRATE = _role("crate", "Box", (0.2, 0.25, 0.15), (0.5, 1.0, 0.5), draws=(("Box", (0, 0, 0)),))
LUGGAGE = _role("suitcase", "Suitcase", (0.2, 0.3, 0.45), (0.4, 0.6, 0.85), draws=(("Suitcase", (0, 0, 0)),))
SAFE = _role("safe", "Safe", (0.25, 0.3, 0.55), (0.65, 0.75, 1.35), draws=(("Safe", (0, 0, 0.9)),))
SMALL_FRIDGE = _role("small fridge", "Refrigerator", (0.4, 0.35, 0.45), (0.7, 0.65, 1.0))
LOW_TABLE = _role(
    "low table", "Table", (0.4, 0.65, 0.28), (0.9, 1.4, 0.56), draws=(("Table", (0.55, 1.0, 0.42)),)
)
NIGHTSTAND = _role(
    "nightstand", f"{STORAGE} Table", (0.28, 0.3, 0.38), (0.52, 0.66, 0.72),
    draws=((STORAGE, (0.4, 0.45, 0.55)),),
)  # fmt: skip
WARDROBE = _role(
    "wardrobe", f"Wardrobe {STORAGE}", (0.35, 0.45, 1.4), (0.75, 1.8, 2.4),
    draws=((STORAGE, (0.6, 1.2, 2.1)), ("Wardrobe", (0, 1.2, 0))),
)  # fmt: skip
DRESSER = _role(
    "dresser", f"Dresser {STORAGE}", (0.35, 0.6, 0.6), (0.7, 1.8, 1.4),
    draws=((STORAGE, (0.48, 1.0, 0.9)), ("Dresser", (0, 1.2, 0))),
)  # fmt: skip
LOWBOARD = _role(
    "lowboard", STORAGE, (0.3, 0.8, 0.34), (0.6, 2.0, 0.78), draws=((STORAGE, (0.42, 1.4, 0.5)),)
)

WINDOWS = Group(name="windows", roles=("window",), count=(0, 2), like="middle", height=0.92, sunk=THICKNESS)

KITCHEN = Recipe(
    kind="kitchen",
    width=(3.9, 5.2),
    depth=(3.6, 4.8),
    needed=(BASE, FRIDGE, RANGE),
    layouts=(("back", "left"), ("back", "right"), ("back", "left", "right")),
    shares=(
        Share(role=FRIDGE, least=1, wanted=1, most=1),
        Share(role=RANGE, least=1, wanted=1, most=1),
        Share(role=DISHWASHER, wanted=1, most=1),
        Share(role=WASHER, wanted=1, most=1),
        Share(role=SINK, wanted=1, most=1),
        Share(role=BASE, least=2, wanted=6, most=10),
        Share(role=LARDER, wanted=1, most=2),
    ),
    hung=Share(role=HUNG, wanted=5, most=8),
    groups=(
        Group(name="island", roles=("island",), count=(0, 1), where="middle", like="middle"),
        Group(name="table", roles=("table",), count=(0, 1), where="middle"),
        Group(name="cart", roles=("cart",), count=(0, 1), like="corner"),
        Group(name="bin", roles=("bin",), count=(0, 1), like="corner"),
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
        Group(name="sideboard", roles=("sideboard",), count=(0, 1), like="middle"),
        Group(name="safe", roles=("safe",), count=(0, 1), like="corner"),
        Group(name="fridge", roles=("small fridge",), count=(0, 1), like="corner", near="sideboard"),
        Group(name="cart", roles=("cart",), count=(0, 1), like="corner"),
        Group(name="bin", roles=("bin",), count=(0, 2), like="corner", near="desks"),
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
        Group(name="lowboard", roles=("lowboard",), count=(0, 1), like="middle"),
        Group(name="bookcase", roles=("bookcase",), count=(0, 1), like="corner"),
        Group(name="chest", roles=("pedestal", "pedestal"), count=(0, 1)),
        Group(name="safe", roles=("safe",), count=(0, 1), like="corner"),
        Group(name="low table", roles=("low table",), count=(0, 1), where="middle"),
        Group(name="bin", roles=("bin",), count=(0, 1), like="corner"),
        Group(name="suitcase", roles=("suitcase",), count=(0, 1), like="corner"),
    ),
    roles=(
        NIGHTSTAND, WARDROBE, DRESSER, DESK, PEDESTAL, LOWBOARD, BOOKCASE, SAFE, LOW_TABLE, BIN, LUGGAGE,
        DOOR, WINDOW,
    ),
    tops=(
        Share(role=LAMP, wanted=1, most=1, on=("desk", "dresser")),
        Share(role=LAPTOP, wanted=1, most=1, on=("desk", "dresser")),
    ),
    wall_color=(0.91, 0.88, 0.85),
)  # fmt: skip

BATHROOM = Recipe(
    kind="bathroom",
    width=(3.6, 4.8),
    depth=(3.2, 4.4),
    needed=(TOILET, WASHER),
    groups=(
        Group(name="toilet", roles=("toilet",), count=(1, 1), like="corner"),
        Group(name="laundry", roles=("washing machine", "dryer"), count=(1, 1), like="corner"),
        Group(name="cupboards", roles=("nightstand", "nightstand"), count=(1, 2)),
        Group(name="linen", roles=("bookcase",), count=(0, 1), like="corner"),
        Group(name="dresser", roles=("dresser",), count=(0, 1)),
        Group(name="bin", roles=("bin",), count=(0, 2), like="corner", near="toilet"),
        Group(name="crates", roles=("crate",), count=(0, 2), like="corner"),
        Group(name="cart", roles=("cart",), count=(0, 1)),
    ),
    roles=(TOILET, WASHER, DRYER, NIGHTSTAND, BOOKCASE, DRESSER, BIN, CRATE, CART, DOOR, WINDOW),
    wall_color=(0.86, 0.91, 0.92),
)

WORKSHOP = Recipe(
    kind="workshop",
    width=(5.0, 6.6),
    depth=(4.4, 5.8),
    needed=(DESK, FILING),
    groups=(
        Group(name="benches", roles=("desk", "desk"), count=(1, 2), like="middle"),
        Group(name="filing", roles=("filing cabinet", "filing cabinet"), count=(1, 2), like="corner"),
        Group(name="tools", roles=("tool chest",), count=(0, 1), where="middle"),  # its lid leans out behind
        Group(name="shelves", roles=("bookcase", "bookcase"), count=(0, 2), like="corner"),
        Group(name="freezer", roles=("chest freezer",), count=(0, 1), like="corner"),
        Group(name="carts", roles=("cart",), count=(0, 2)),
        Group(name="crates", roles=("crate", "crate"), count=(0, 2)),
        Group(name="bin", roles=("bin",), count=(0, 1), like="corner"),
        Group(name="safe", roles=("safe",), count=(0, 1), like="corner"),
    ),
    roles=(DESK, TOOL_CHEST, FILING, BOOKCASE, FREEZER, CART, CRATE, BIN, SAFE, DOOR, WINDOW),
    tops=(
        Share(role=TOOL_BOX, wanted=3, most=3, on=("desk", "filing cabinet")),
        Share(role=LAMP, wanted=1, most=1, on=("desk",)),
    ),
    wall_color=(0.85, 0.85, 0.83),
)

RECIPES: dict[RoomKind, Recipe] = {
    "kitchen": KITCHEN, "office": OFFICE, "bedroom": BEDROOM, "bathroom": BATHROOM, "workshop": WORKSHOP,
}  # fmt: skip
