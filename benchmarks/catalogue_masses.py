"""Compares masses of procedural objects with catalogue masses of objects of the same size.

    python benchmarks/catalogue_masses.py --seeds 12 --out out/masses.md

draws objects of every entry's kind, size and style and compares the median of their masses with the
catalogue's. Catalogue masses are rounded typical net weights of product classes (2015 to 2024), not those of
a cited model; models of a class differ by 10 to 20 %. Writes a table; fails if fewer than ``--bar`` of the
entries are within 25 %.
"""

import statistics
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import tyro

from artigen.errors import ArtigenError
from artigen.shapes.draw import Wish, draw_shape
from sim_export.reference import weigh_shape

WITHIN = 0.25
"""Largest relative difference from the catalogue's mass."""


@dataclass(frozen=True)
class Entry:
    """A product class: kind, width, depth and height (m; 0 for the usual ones), mass (kg), description."""

    category: str
    size: tuple[float, float, float]
    mass: float
    product: str
    style: str | None = None

    @property
    def wish(self) -> Wish:
        """The wish of its objects."""
        width, depth, height = (length or None for length in self.size)
        return Wish(width=width, depth=depth, height=height, style=self.style)


ENTRIES = (
    Entry("Refrigerator", (0.60, 0.66, 1.86), 66, "fridge-freezer, 60 cm, no frost"),
    Entry("Refrigerator", (0.60, 0.65, 1.45), 50, "fridge with freezer on top, 230 l"),
    Entry("Refrigerator", (0.91, 0.72, 1.78), 108, "side by side, 600 l"),
    Entry("Refrigerator", (0.70, 0.70, 1.78), 72, "fridge-freezer, 70 cm"),
    Entry("Refrigerator", (0.48, 0.45, 0.50), 15, "mini bar, 45 l"),
    Entry("Oven", (0.60, 0.60, 0.90), 48, "electric cooker, 60 cm"),
    Entry("Oven", (0.50, 0.60, 0.86), 42, "electric cooker, 50 cm"),
    Entry("Oven", (0.76, 0.68, 0.92), 75, "range, 30 inches"),
    Entry("Oven", (0.595, 0.55, 0.595), 34, "built-in oven"),
    Entry("Oven", (0.76, 0.60, 1.30), 110, "double wall oven, 30 inches"),
    Entry("Dishwasher", (0.60, 0.60, 0.845), 48, "dishwasher, 60 cm"),
    Entry("Dishwasher", (0.45, 0.60, 0.845), 40, "dishwasher, 45 cm"),
    Entry("WashingMachine", (0.60, 0.60, 0.85), 68, "front loader, 8 kg of laundry"),
    Entry("WashingMachine", (0.60, 0.50, 0.85), 60, "front loader, slim"),
    Entry("Dryer", (0.60, 0.60, 0.85), 50, "heat pump dryer", "white"),
    Entry("Dryer", (0.69, 0.70, 1.02), 52, "vented dryer, American", "american"),
    Entry("Microwave", (0.45, 0.34, 0.26), 11.5, "microwave, 20 l"),
    Entry("Microwave", (0.51, 0.40, 0.30), 15, "microwave, 28 l"),
    Entry("ChestFreezer", (0.80, 0.56, 0.85), 35, "chest freezer, 200 l", "white"),
    Entry("ChestFreezer", (1.12, 0.62, 0.86), 44, "chest freezer, 300 l", "white"),
    Entry("Toaster", (0.18, 0.29, 0.19), 1.7, "two slices, steel", "steel"),
    Entry("Toaster", (0.31, 0.30, 0.19), 3.0, "four slices, steel", "steel"),
    Entry("Safe", (0.35, 0.30, 0.35), 20, "home safe"),
    Entry("Safe", (0.50, 0.45, 0.65), 75, "fire safe, 60 minutes"),
    Entry("FilingCabinet", (0.47, 0.62, 1.32), 44, "four drawers, steel", "vertical"),
    Entry("FilingCabinet", (0.47, 0.62, 0.71), 26, "two drawers, steel", "vertical"),
    Entry("FilingCabinet", (0.91, 0.47, 1.32), 95, "lateral, four drawers", "lateral"),
    Entry("FilingCabinet", (0.42, 0.57, 0.60), 25, "mobile pedestal, steel", "pedestal"),
    Entry("Wardrobe", (0.80, 0.52, 1.90), 56, "two doors, particle board", "flat"),
    Entry("Wardrobe", (1.00, 0.60, 2.01), 88, "two doors, particle board, shelves", "flat"),
    Entry("Wardrobe", (1.50, 0.60, 2.01), 135, "sliding doors", "sliding"),
    Entry("Dresser", (1.60, 0.48, 0.78), 76, "six drawers, particle board", "modern"),
    Entry("Dresser", (0.80, 0.48, 1.00), 48, "four drawers, particle board", "modern"),
    Entry("Dresser", (1.60, 0.50, 0.95), 85, "eight drawers, pine", "shaker"),
    Entry("StorageFurniture", (0.60, 0.60, 0.88), 36, "base cabinet, 60 cm"),
    Entry("StorageFurniture", (0.80, 0.60, 0.88), 44, "base cabinet, 80 cm"),
    Entry("StorageFurniture", (0.60, 0.37, 0.80), 22, "wall cabinet, 60 cm, doors"),
    Entry("StorageFurniture", (0.40, 0.48, 0.55), 20, "night stand, two drawers"),
    Entry("StorageFurniture", (0.80, 0.30, 2.02), 55, "bookcase with doors"),
    Entry("StorageFurniture", (1.80, 0.42, 0.50), 40, "television bench"),
    Entry("Table", (1.31, 0.60, 0.76), 41, "desk with drawers, particle board"),
    Entry("Table", (1.40, 0.65, 0.73), 45, "desk with drawer, particle board"),
    Entry("Table", (1.18, 0.75, 0.46), 33, "coffee table, pine"),
    Entry("Cart", (0.75, 0.48, 0.95), 58, "tool cart, steel, without tools", "tool"),
    Entry("Cart", (0.60, 0.45, 0.88), 16, "kitchen trolley, wood", "kitchen"),
    Entry("Cart", (1.35, 0.60, 0.63), 14, "wheelbarrow, 85 l, steel, tyre with air", "wheelbarrow"),
    Entry("Door", (0.0, 0.0, 2.053), 42, "interior door, 86 cm, tubular board, with frame", "flush"),
    Entry("Window", (1.00, 0.0, 1.20), 42, "casement, double glazing", "casement"),
    Entry("Toilet", (0.37, 0.66, 0.78), 33, "close-coupled, with cistern, empty", "close_coupled"),
    Entry("Toilet", (0.37, 0.64, 0.82), 40, "skirted, with cistern, empty", "skirted"),
    Entry("DeskLamp", (0.0, 0.0, 0.0), 2.0, "architect's lamp on a base", "architect"),
    Entry("Pot", (0.0, 0.0, 0.0), 1.1, "saucepan, 16 to 18 cm, with lid", "saucepan"),
    Entry("Pot", (0.0, 0.0, 0.0), 2.4, "casserole, 24 cm, with lid", "casserole"),
    Entry("Laptop", (0.305, 0.215, 0.0), 1.3, "13 inches, aluminium", "light"),
    Entry("Laptop", (0.36, 0.25, 0.0), 2.3, "15 inches, gaming", "gaming"),
    Entry("Printer", (0.43, 0.36, 0.16), 5.5, "inkjet with scanner", "inkjet"),
    Entry("Printer", (0.40, 0.39, 0.25), 9.0, "laser", "laser"),
    Entry("Printer", (0.41, 0.40, 0.36), 13, "laser with scanner and feeder", "multifunction"),
    Entry("TrashCan", (0.29, 0.33, 0.66), 4.4, "pedal bin, 30 l, steel", "pedal"),
    Entry("TrashCan", (0.48, 0.55, 0.94), 10, "EN 840, 120 l", "wheeled"),
    Entry("TrashCan", (0.58, 0.73, 1.07), 14, "EN 840, 240 l", "wheeled"),
    Entry("Box", (0.57, 0.39, 0.28), 2.4, "storage box with lid, 45 l", "plastic"),
    Entry("Box", (0.60, 0.40, 0.40), 1.1, "carton, double wall", "carton"),
    Entry("Box", (1.00, 0.45, 0.50), 20, "blanket chest, wood", "chest"),
    Entry("ToolBox", (0.40, 0.21, 0.20), 1.4, "16 inches, plastic", "plastic"),
    Entry("ToolBox", (0.48, 0.20, 0.24), 3.4, "hip roof, steel", "metal"),
    Entry("ToolBox", (0.66, 0.31, 0.38), 18, "six drawers, steel", "chest"),
    Entry("Suitcase", (0.40, 0.20, 0.55), 2.6, "cabin, hard shell", "cabin"),
    Entry("Suitcase", (0.50, 0.30, 0.75), 4.2, "large, hard shell", "large"),
    Entry("BreadBox", (0.38, 0.27, 0.19), 2.0, "roll top, steel", "curved"),
    Entry("BreadBox", (0.40, 0.27, 0.20), 2.8, "bamboo", "drop"),
)


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    seeds: int = 12
    """Objects per entry."""
    first: int = 0
    """Seed of the first object."""
    category: tuple[str, ...] = ()
    """Categories; all by default."""
    out: Path | None = None
    """File of the table."""
    bar: float = 1.0
    """Share of the entries that must be within 25 %."""


@dataclass(frozen=True)
class Weighed:
    """An entry and the masses (kg) of its objects, sorted."""

    entry: Entry
    masses: tuple[float, ...]

    @property
    def median(self) -> float:
        """Median of the masses."""
        return statistics.median(self.masses)

    @property
    def good(self) -> bool:
        """Whether the median is within 25 % of the catalogue's mass."""
        return abs(self.median / self.entry.mass - 1.0) <= WITHIN


def weigh_entry(entry: Entry, seeds: Sequence[int]) -> Weighed:
    """Draws and weighs the objects of an entry."""
    masses = [weigh_shape(draw_shape(entry.category, seed, entry.wish)) for seed in seeds]
    return Weighed(entry, tuple(sorted(masses)))


def describe(weighed: Sequence[Weighed]) -> str:
    """The table as Markdown."""
    lines = ["| kind | product class | size, m | catalogue, kg | drawn, kg: least / median / most | ratio |"]
    lines.append("|---" * 6 + "|")
    for one in weighed:
        entry, low, high = one.entry, one.masses[0], one.masses[-1]
        size = " x ".join(f"{length:g}" if length else "-" for length in entry.size)
        ratio = f"{one.median / entry.mass:.2f}" + ("" if one.good else " **out**")
        kind = entry.category + (f", {entry.style}" if entry.style else "")
        cells = (kind, entry.product, size, f"{entry.mass:g}", f"{low:.3g} / {one.median:.3g} / {high:.3g}")
        lines.append("| " + " | ".join([*cells, ratio]) + " |")
    good = sum(one.good for one in weighed)
    return "\n".join([*lines, "", f"{good} of {len(weighed)} entries within {WITHIN:.0%}."])


def main(options: Options) -> int:
    """Weighs all entries and writes the table."""
    weighed = []
    for entry in ENTRIES:
        if options.category and entry.category not in options.category:
            continue
        try:
            weighed.append(weigh_entry(entry, range(options.first, options.first + options.seeds)))
        except ArtigenError as error:
            sys.stderr.write(f"{entry.category}, {entry.product}: {error}\n")
            return 2
    text = describe(weighed)
    print(text)
    if options.out is not None:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(text + "\n")
    return 0 if sum(one.good for one in weighed) >= options.bar * len(weighed) else 1


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
