"""Real-world sizes of categories: PartNet's lengths are normalised, a simulator needs metres.

Each rule gives one extent of the closed object in metres. Where one number would be wrong for half
of a category (a nightstand and a wardrobe are both storage furniture), the rule depends on the ratio
of height to footprint. A limit on the depth keeps sizes plausible.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

Extent = Literal["height", "width", "longest"]

LONGEST = 2.4
"""Longest edge of any object (metres)."""
DEPTH_LIMITS: dict[str, float] = {
    "StorageFurniture": 0.65,
    "Refrigerator": 0.8,
    "Oven": 0.7,
    "Dishwasher": 0.7,
    "WashingMachine": 0.75,
    "Microwave": 0.5,
    "Door": 0.5,
}
"""Largest depth by category (metres): a squat refrigerator is a small one."""


@dataclass(frozen=True, kw_only=True)
class SizeRule:
    """``extent`` is ``metres`` long when height over the larger footprint edge is at most ``up_to``."""

    extent: Extent
    metres: float
    up_to: float = np.inf
    note: str = ""


def _height(metres: float, up_to: float = np.inf, note: str = "") -> SizeRule:
    return SizeRule(extent="height", metres=metres, up_to=up_to, note=note)


def _width(metres: float, up_to: float = np.inf, note: str = "") -> SizeRule:
    return SizeRule(extent="width", metres=metres, up_to=up_to, note=note)


def _longest(metres: float) -> tuple[SizeRule, ...]:
    return (SizeRule(extent="longest", metres=metres),)


FALLBACK = _longest(0.5)

SIZE_TABLE: dict[str, tuple[SizeRule, ...]] = {
    "StorageFurniture": (
        _width(1.4, 0.45, "sideboard"),
        _height(0.8, 1.05, "chest, base cabinet"),
        _height(0.9, 1.6, "cupboard"),
        _height(1.9, note="wardrobe, tall cabinet"),
    ),
    "Table": (
        _height(0.45, 0.38, "coffee table"),
        _height(0.75, 0.95, "desk, dining table"),
        _height(0.65, note="bedside table"),
    ),
    "Refrigerator": (_height(1.75),),
    "Dishwasher": (_height(0.85),),
    "Oven": (
        _width(0.75, 0.35, "cooktop"),
        _width(0.6, 0.8, "built-in"),
        _height(0.92, 1.5, "range"),
        _height(1.15, note="range with back panel, double oven"),
    ),
    "WashingMachine": (_height(0.85),),
    "Microwave": (_width(0.5),),
    "Bottle": (_height(0.25),),
    "Box": _longest(0.4),
    "Bucket": (_height(0.3),),
    "Camera": _longest(0.13),
    "Cart": _longest(1.0),
    "Chair": (_height(1.0),),
    "Clock": _longest(0.3),
    "CoffeeMachine": (_height(0.35),),
    "Dispenser": (_height(0.2),),
    "Display": (_width(0.6),),
    "Door": (_height(2.05),),
    "Eyeglasses": (_width(0.14),),
    "Fan": _longest(0.5),
    "Faucet": _longest(0.3),
    "FoldingChair": (_height(0.85),),
    "Globe": (_height(0.4),),
    "Kettle": (_height(0.25),),
    "Keyboard": _longest(0.45),
    "KitchenPot": _longest(0.35),
    "Knife": _longest(0.25),
    "Lamp": _longest(0.5),
    "Laptop": (_width(0.34),),
    "Lighter": _longest(0.08),
    "Mouse": _longest(0.11),
    "Pen": _longest(0.14),
    "Phone": _longest(0.15),
    "Pliers": _longest(0.18),
    "Printer": (_width(0.45),),
    "Remote": _longest(0.18),
    "Safe": (_height(0.45, 1.7), _height(1.3, note="gun safe")),
    "Scissors": _longest(0.18),
    "Stapler": _longest(0.15),
    "Suitcase": _longest(0.65),
    "Switch": _longest(0.12),
    "Toaster": (_width(0.3),),
    "Toilet": (_height(0.75),),
    "TrashCan": (_height(0.6),),
    "USB": _longest(0.06),
    "Window": (_height(1.2),),
}


def estimate_size(category: str, extents: Float[np.ndarray, "3"]) -> tuple[float, bool]:
    """Longest edge in metres, and whether the table knows the category.

    Args:
        extents: Depth, width and height (x, y, z) of the closed object, in any unit.
    """
    depth, width, height = (float(extent) for extent in extents)
    rules = SIZE_TABLE.get(category, FALLBACK)
    slenderness = height / max(depth, width)
    rule = next(rule for rule in rules if slenderness <= rule.up_to)
    longest = max(depth, width, height)
    measured = {"height": height, "width": width, "longest": longest}[rule.extent]
    size = min(rule.metres / measured * longest, LONGEST)
    if category in DEPTH_LIMITS:
        size = min(size, DEPTH_LIMITS[category] / depth * longest)
    return size, category in SIZE_TABLE
