"""What rooms are furnished with, as tables: roles by category and size, how many, and where they like to be.

Sizes are depth, width and height in metres, handles included.
"""

from dataclasses import dataclass
from typing import Literal

from .room import RoomKind, Side

Size = tuple[float, float, float]
Where = Literal["wall", "middle"]


@dataclass(frozen=True, kw_only=True)
class Role:
    """A part that packages of some categories and sizes can play."""

    name: str
    categories: tuple[str, ...]
    low: Size
    high: Size
    needs_joint: str | None = None
    """A kind of joint without which a package does not look the part."""
    draws: tuple[tuple[str, Size], ...] = ()
    """What to draw where there is no folder: category and size wished for (0 leaves it to the seed)."""


@dataclass(frozen=True, kw_only=True)
class Share:
    """How many of a role a run should hold: at least, rather, at most."""

    role: Role
    least: int
    wanted: int
    most: int


@dataclass(frozen=True, kw_only=True)
class Group:
    """Pieces that stand side by side, backs in one line; ``bed`` among ``roles`` is a bed made of boxes.

    ``facing`` rows: 1 along a wall or alone, 2 back to back.
    """

    name: str
    roles: tuple[str, ...]
    count: tuple[int, int]
    """At least and at most; what is above the least is left out where it does not fit."""
    where: Where = "wall"
    rows: int = 1
    like: Literal["corner", "middle", "anywhere"] = "anywhere"
    near: str | None = None
    """A group to be close to."""


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """A kind of room. ``shares`` fill gapless runs along ``layouts``' walls, ``groups`` stand by themselves,
    ``tops`` go on what is high enough."""

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

    def role(self, name: str) -> Role:
        """The role of that name; raises `KeyError`."""
        return {role.name: role for role in self.all_roles}[name]

    @property
    def all_roles(self) -> tuple[Role, ...]:
        """Every role the room can use, each once."""
        hung = () if self.hung is None else (self.hung,)
        every = [*self.roles, *(share.role for share in (*self.shares, *hung, *self.tops))]
        return tuple({role.name: role for role in every}.values())


def _role(
    name: str, categories: str, low: Size, high: Size, needs: str | None = None, draws: tuple = ()
) -> Role:
    return Role(
        name=name, categories=tuple(categories.split()), low=low, high=high, needs_joint=needs, draws=draws
    )


STORAGE = "StorageFurniture"
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
    draws=tuple((STORAGE, (0.34, width, 0.7)) for width in (0.6, 0.8)),
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
    "filing cabinet", STORAGE, (0.3, 0.3, 0.8), (0.66, 1.7, 1.4), draws=((STORAGE, (0.45, 0.8, 1.1)),)
)
BOOKCASE = _role("bookcase", STORAGE, (0.25, 0.4, 1.4), (0.7, 1.7, 2.3), draws=((STORAGE, (0.38, 0.9, 1.9)),))
SIDEBOARD = _role(
    "sideboard", STORAGE, (0.3, 0.7, 0.55), (0.6, 2.0, 0.98), draws=((STORAGE, (0.42, 1.3, 0.8)),)
)
SAFE = _role("safe", "Safe", (0.25, 0.3, 0.55), (0.65, 0.75, 1.35), draws=(("Safe", (0, 0, 0.9)),))
SMALL_FRIDGE = _role("small fridge", "Refrigerator", (0.4, 0.35, 0.45), (0.7, 0.65, 1.0))
LOW_TABLE = _role(
    "low table", "Table", (0.4, 0.65, 0.28), (0.9, 1.4, 0.56), draws=(("Table", (0.55, 1.0, 0.42)),)
)
NIGHTSTAND = _role(
    "nightstand",
    f"{STORAGE} Table",
    (0.28, 0.3, 0.38),
    (0.52, 0.66, 0.72),
    draws=((STORAGE, (0.4, 0.45, 0.55)),),
)
WARDROBE = _role(
    "wardrobe", STORAGE, (0.35, 0.45, 1.4), (0.75, 1.8, 2.4), draws=((STORAGE, (0.6, 1.2, 2.1)),)
)
DRESSER = _role("dresser", STORAGE, (0.35, 0.6, 0.6), (0.7, 1.7, 1.4), draws=((STORAGE, (0.48, 1.0, 0.9)),))
LOWBOARD = _role(
    "lowboard", STORAGE, (0.3, 0.8, 0.34), (0.6, 2.0, 0.78), draws=((STORAGE, (0.42, 1.4, 0.5)),)
)

KITCHEN = Recipe(
    kind="kitchen",
    width=(3.9, 5.2),
    depth=(3.6, 4.8),
    needed=(BASE, FRIDGE, RANGE),
    layouts=(("back", "left"), ("back", "right"), ("back", "left", "right")),
    shares=(
        Share(role=FRIDGE, least=1, wanted=1, most=1),
        Share(role=RANGE, least=1, wanted=1, most=1),
        Share(role=DISHWASHER, least=0, wanted=1, most=1),
        Share(role=WASHER, least=0, wanted=1, most=1),
        Share(role=SINK, least=0, wanted=1, most=1),
        Share(role=BASE, least=2, wanted=6, most=10),
        Share(role=LARDER, least=0, wanted=1, most=2),
    ),
    hung=Share(role=HUNG, least=0, wanted=5, most=8),
    groups=(
        Group(name="island", roles=("island",), count=(0, 1), where="middle", rows=1, like="middle"),
        Group(name="table", roles=("table",), count=(0, 1), where="middle", like="anywhere"),
        Group(name="cart", roles=("cart",), count=(0, 1), like="corner"),
    ),
    roles=(ISLAND, DINING, CART),
    tops=(
        Share(role=MICROWAVE, least=0, wanted=2, most=2),
        Share(role=TABLE_OVEN, least=0, wanted=1, most=1),
    ),
    wall_color=(0.90, 0.90, 0.87),
)

OFFICE = Recipe(
    kind="office",
    width=(5.4, 7.2),
    depth=(4.6, 6.0),
    needed=(DESK, PEDESTAL, BOOKCASE),
    groups=(
        Group(name="desks", roles=("desk", "pedestal"), count=(2, 3), like="anywhere"),
        Group(name="bookcases", roles=("bookcase", "bookcase"), count=(1, 2), like="corner"),
        Group(name="team", roles=("desk", "desk"), count=(0, 1), where="middle", rows=2, like="middle"),
        Group(name="filing", roles=("filing cabinet", "filing cabinet"), count=(0, 2), like="corner"),
        Group(name="sideboard", roles=("sideboard",), count=(0, 1), like="middle"),
        Group(name="safe", roles=("safe",), count=(0, 1), like="corner"),
        Group(name="fridge", roles=("small fridge",), count=(0, 1), like="corner", near="sideboard"),
        Group(name="cart", roles=("cart",), count=(0, 1), like="corner"),
    ),
    roles=(DESK, PEDESTAL, BOOKCASE, FILING, SIDEBOARD, SAFE, SMALL_FRIDGE, CART),
    tops=(Share(role=MICROWAVE, least=0, wanted=1, most=1),),
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
        Group(name="dresser", roles=("dresser",), count=(1, 2), like="anywhere"),
        Group(name="desk", roles=("desk", "pedestal"), count=(0, 1), like="anywhere"),
        Group(name="lowboard", roles=("lowboard",), count=(0, 1), like="middle"),
        Group(name="bookcase", roles=("bookcase",), count=(0, 1), like="corner"),
        Group(name="chest", roles=("pedestal", "pedestal"), count=(0, 1), like="anywhere"),
        Group(name="safe", roles=("safe",), count=(0, 1), like="corner"),
        Group(name="low table", roles=("low table",), count=(0, 1), where="middle", like="anywhere"),
    ),
    roles=(NIGHTSTAND, WARDROBE, DRESSER, DESK, PEDESTAL, LOWBOARD, BOOKCASE, SAFE, LOW_TABLE),
    wall_color=(0.91, 0.88, 0.85),
)

RECIPES: dict[RoomKind, Recipe] = {"kitchen": KITCHEN, "office": OFFICE, "bedroom": BEDROOM}
