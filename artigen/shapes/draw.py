"""`draw_shape`: a procedural object of any category, a pure function of category, seed and wish.

A category is a module of `artigen.shapes.categories` with ``CATEGORY``, its name, and
``draw(rng, wish) -> Draft``; putting a file there is all it takes to add one.
"""

from collections import Counter
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType
from zlib import crc32

import numpy as np

from artigen.errors import ArtigenError
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.types import PartLabel

MAX_DRAWS = 1000
FEW_DRAWS = 100
"""After so many, a count of more than twice the most seen is given up."""
LENGTHS = (0.02, 10.0)
"""Lengths that can be wished for (m)."""


class ShapeError(ArtigenError):
    """No object of the category meets the wish, or there is no such category."""


@dataclass(frozen=True, kw_only=True)
class Wish:
    """What a caller asks for; None leaves it to the seed. Lengths in metres."""

    width: float | None = None
    depth: float | None = None
    height: float | None = None
    style: str | None = None
    counts: tuple[tuple[PartLabel, int], ...] = ()
    """Parts wanted, exactly, by label; labels not named are free."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Draft:
    """What a category draws: everything of a `Shape` but its name."""

    style: str
    parts: tuple[ShapePart, ...]
    finishes: tuple[tuple[str, Finish], ...]


@cache
def categories() -> dict[str, ModuleType]:
    """The modules that draw, by category name, sorted."""
    package = import_module("artigen.shapes.categories")
    modules = [import_module(f"{package.__name__}.{found.name}") for found in iter_modules(package.__path__)]
    return {module.CATEGORY: module for module in sorted(modules, key=lambda module: module.CATEGORY)}


def draw_shape(category: str, seed: int, wish: Wish | None = None) -> Shape:
    """Draws one object; the same arguments give the same object on every run.

    Counts are met by drawing again, at most `MAX_DRAWS` times, from streams that follow from the seed; far
    fewer where they are out of all proportion.

    Raises:
        ShapeError: If the category is unknown, a length is out of bounds, or no draw has the counts
            wished for.
    """
    wish = wish or Wish()
    check_wish(wish)
    known = categories()
    if category not in known:
        raise ShapeError(f"category {category!r} is not known, expected one of {', '.join(known)}")
    seen: Counter[str] = Counter()
    most: Counter[str] = Counter()
    for attempt in range(MAX_DRAWS if wish.counts else 1):
        if attempt == FEW_DRAWS and any(0 < 2 * most[label] < count for label, count in wish.counts):
            break
        rng = np.random.default_rng([crc32(category.encode()), seed, attempt])
        draft = known[category].draw(rng, wish)
        held = Counter(part.label for part in draft.parts)
        if all(held[label] == count for label, count in wish.counts):
            return Shape(
                category=category, seed=seed, style=draft.style, parts=draft.parts, finishes=draft.finishes
            )
        seen[", ".join(f"{held[label]} {label}" for label, _ in wish.counts)] += 1
        most |= held
    wanted = ", ".join(f"{count} {label}" for label, count in wish.counts)
    near = "; ".join(text for text, _ in seen.most_common(5))
    raise ShapeError(f"{category}: no draw of {seen.total()} has {wanted}; most frequent were {near}")


def check_wish(wish: Wish) -> None:
    """Refuses what no object of any category can be.

    Raises:
        ShapeError: If a length is out of bounds, or more or less than one base is wished for.
    """
    for name in ("width", "depth", "height"):
        length = getattr(wish, name)
        if length is not None and not LENGTHS[0] <= length <= LENGTHS[1]:
            raise ShapeError(f"{name} {length:g} m: expected from {LENGTHS[0]:g} to {LENGTHS[1]:g} m")
    for label, count in wish.counts:
        if label == "base" and count != 1:
            raise ShapeError(f"{count} parts called base: every object has one")


def choose(rng: np.random.Generator, low: float, high: float, wished: float | None = None) -> float:
    """The wished value, or a uniform one; every call takes one number from ``rng``, wished or not."""
    drawn = float(rng.uniform(low, high))
    return drawn if wished is None else wished
