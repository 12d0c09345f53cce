"""Categories of PartNet-Mobility and other sources that the grammar does not draw."""

import numpy as np

from artigen.kind import Build, Category, SizeRule, Stands, by_height, by_longest, by_width, plurals

Diagonal = tuple[float, float]


def _foreign(
    name: str,
    nouns: tuple[str, ...],
    *size: SizeRule,
    build: Build | None = None,
    stands: Stands = "free",
    diagonal: Diagonal | None = None,
) -> Category:
    return Category(
        name=name, nouns=plurals(*nouns), hints=(), size=size, deepest=np.inf, diagonal=diagonal, build=build,
        stands=stands,
    )  # fmt: skip


CATEGORIES = (
    _foreign("Bottle", ("bottle",), by_height(0.25), build="plastic", diagonal=(0.1, 0.8)),
    _foreign("Bucket", ("bucket",), by_height(0.3)),
    _foreign("Camera", ("camera",), by_longest(0.13)),
    _foreign("Chair", ("chair",), by_height(1.0), diagonal=(0.5, 2.0)),
    _foreign("Clock", ("clock",), by_longest(0.3)),
    _foreign("CoffeeMachine", ("coffee maker", "espresso machine"), by_height(0.35), build="sheet"),
    _foreign("Dispenser", ("dispenser",), by_height(0.2), build="plastic"),
    _foreign("Display", ("display",), by_width(0.6)),
    _foreign("Eyeglasses", ("eyeglasses/eyeglasses",), by_width(0.14), stands="held"),
    _foreign("Fan", ("fan",), by_longest(0.5)),
    _foreign("FoldingChair", ("folding chair",), by_height(0.85)),
    _foreign("Globe", ("globe",), by_height(0.4)),
    _foreign("Kettle", ("kettle",), by_height(0.25), build="metal"),
    _foreign("Keyboard", ("keyboard",), by_longest(0.45), build="plastic"),
    _foreign("Knife", ("knife/knives",), by_longest(0.25), build="metal", stands="held"),
    _foreign("Lamp", ("lamp",), by_longest(0.5)),
    _foreign("Lighter", ("lighter",), by_longest(0.08), stands="held", diagonal=(0.04, 0.2)),
    _foreign("Mouse", ("mouse/mice",), by_longest(0.11)),
    _foreign("Pen", ("pen",), by_longest(0.14), stands="held"),
    _foreign("Phone", ("phone",), by_longest(0.15), build="plastic", stands="held"),
    _foreign("Pliers", ("pliers/pliers",), by_longest(0.18), build="metal", stands="held"),
    _foreign("Remote", ("remote",), by_longest(0.18), build="plastic", stands="held"),
    _foreign("Scissors", ("scissors/scissors",), by_longest(0.18), build="metal", stands="held"),
    _foreign("Stapler", ("stapler",), by_longest(0.15), stands="held"),
    _foreign("USB", ("usb",), by_longest(0.06), stands="held", diagonal=(0.03, 0.15)),
)
