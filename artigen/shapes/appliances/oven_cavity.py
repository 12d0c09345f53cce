"""Interiors of ovens: rails at several levels, wire racks and baking sheets that slide on them."""

from dataclasses import replace

import numpy as np

from artigen.shapes.appliances.cavity import build_tub
from artigen.shapes.appliances.racks import build_rack, choose_thickness
from artigen.shapes.choices import choose
from artigen.shapes.fittings.hardware import ROOM, Space, slide
from artigen.shapes.primitives import Primitive, box
from artigen.shapes.ranges import narrow
from artigen.shapes.shape import ShapePart, require

RAIL = 0.024
"""Protrusion of a rail from its wall (m)."""


def choose_levels(rng: np.random.Generator, space: Space, floor: float, count: int) -> list[float]:
    """Heights (m) of at most ``count`` racks above ``floor``, far enough apart for dishes."""
    low, high = max(space.z[0] + 0.045, floor), space.z[1] - 0.09
    count = max(0, min(count, int((high - low) / 0.075) + 1))
    if count == 0:
        return []
    slack = max(0.0, high - low - 0.075 * (count - 1))
    cuts = np.sort(rng.uniform(0.0, slack, count))
    return [low + float(cut) + 0.075 * k for k, cut in enumerate(cuts)]


def build_rails(space: Space, levels: list[float]) -> tuple[Primitive, ...]:
    """Two rails under each rack."""
    x0, x1 = space.x[0] + 0.012, space.x[1]
    rails = []
    for level in levels:
        top = level - 0.0015
        height = max(0.010, (x1 - x0) / 50)
        rails += [
            box((x0, y, top - height), (x1, y + RAIL, top), "steel") for y in (space.y[0], space.y[1] - RAIL)
        ]
    return tuple(rails)


def make_racks(
    rng: np.random.Generator, space: Space, levels: list[float], *, stem: str, door: str, aside: float = ROOM
) -> list[ShapePart]:
    """Draws wire racks and sometimes a baking sheet, which slide when ``door`` is open.

    ``aside`` (m) is the clearance at each side; racks without rails run in grooves close to the walls.
    """
    out = []
    for k, level in enumerate(levels):
        lie = Space(
            x=(space.x[0] + 0.016, space.x[1] - 0.012), y=narrow(space.y, aside), z=(level, level + 0.028)
        )
        wall = choose_thickness(lie, 0.006)
        lie = replace(lie, z=(level, level + max(0.028, 2 * wall)))  # its rim is as stout as its floor
        if rng.random() < 0.25:
            pieces = build_tub(lie, wall, "rubber" if rng.random() < 0.5 else "steel", sides=False)
        else:
            pieces = build_rack(lie, bars=int(rng.integers(7, 14)), lip=0.028)
        motion, needs = slide(choose(rng, 0.5, 0.7) * lie.depth), require(door, fraction=1.0)
        out.append(ShapePart(f"{stem}_{k}", "tray", pieces, motion, needs=needs))
    return out
