"""Latches that hold leaves shut: a tongue on the spindle of a lever, and a sliding bolt.

With the lever at rest the tongue lies in its keep beyond the leaf's edge and the leaf cannot move, in
simulators too, because tongue and keep collide. Pressed down, the lever turns the tongue back into the pocket
of the leaf. Lengths are in metres; ``edge`` is the y of the leaf's edge and ``side`` the direction out of it,
1 or -1.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import radians
from typing import Literal

import numpy as np

from artigen.shapes.appliances.cavity import build_frame
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.fittings.hardware import Space, slide
from artigen.shapes.fittings.hinges import Leaf, build_astragal, fit_hinges
from artigen.shapes.primitives import DOWN, Primitive, Vector, block, cylinder, polytope
from artigen.shapes.ranges import Range, around, between, narrow
from artigen.shapes.shape import ShapePart, require

TURN = radians(45.0)
"""Angle (rad) by which a lever is pressed down (DIN 18255)."""
RELEASED = 0.9
"""Share of the lever's range at which the tongue has left the keep."""
THROW = 0.0105
"""Length of the tongue beyond the leaf's edge."""
TONGUE = 0.0075
"""Half the height of the tongue."""
THICK = 0.012
"""Thickness of the tongue."""
PLAY = 0.004
"""Free space beside the tongue; with less, engines that predict contacts jam it in its keep."""
BOLT_PLAY = 0.002
"""Free space around a bolt in its staple: a leaf held by bolt and tongue has the play of both."""
HOLE = 0.011
"""Half the edge of the square holes for the spindle."""


@dataclass(frozen=True, kw_only=True)
class Latch:
    """Place of a latch in its leaf."""

    x: Range
    """Front and rear face of the leaf."""
    edge: float
    side: float
    level: float
    """Height of the spindle."""
    backset: float = 0.055
    """Distance from the edge to the spindle (DIN 18251)."""
    lift: Literal[-1, 1] = 1
    """1 if the tongue rises as it leaves the keep, -1 if it drops."""

    @property
    def axis(self) -> tuple[float, float]:
        """The spindle as (y, z)."""
        return self.edge - self.side * self.backset, self.level

    @property
    def pocket(self) -> Space:
        """The free space in the leaf, open at the edge."""
        x = around(sum(self.x) / 2, THICK / 2 + PLAY)
        y = between(self.edge, self.edge - self.side * (self.backset + 0.024))
        low, high = between(-self.lift * 0.024, self.lift * (self.backset + THROW + 0.006))
        return Space(x=x, y=y, z=(self.level + low, self.level + high))

    @property
    def keep(self) -> Space:
        """The free space in the frame, beyond the edge."""
        y = between(self.edge, self.edge + self.side * (THROW + PLAY))
        rise = ((self.backset + THROW) ** 2 - self.backset**2) ** 0.5  # when the tip passes the edge
        low, high = between(-self.lift * (TONGUE + PLAY), self.lift * (rise + TONGUE + PLAY))
        return Space(x=self.pocket.x, y=y, z=(self.level + low, self.level + high))


@dataclass(frozen=True, kw_only=True)
class Hanging:
    """Hinges, bolt and astragal of the leaves of a door or window (lengths in metres)."""

    levels: tuple[float, ...]
    """Heights of the hinges."""
    barrel: float
    """Length of a hinge."""
    straps: tuple[float, float]
    swing: Range
    """Range of the opening angle (degrees)."""
    key: str
    """Name of the part that releases the first leaf."""
    bolt: tuple[float, float]
    """Bolt of a second leaf: its distance from the leaf's edge, and the height where the frame begins."""
    over: float
    """Protrusion of that frame before the leaf."""
    length: float
    """Length of the bolt."""
    astragal: tuple[float, float]
    """Overlap of the strip between two leaves with the second leaf, and with the first."""


def hang_parts(
    rng: np.random.Generator,
    leaves: Sequence[Leaf],
    hanging: Hanging,
    build_leaf: Callable[[Leaf], Sequence[Primitive]],
) -> Assembly:
    """One or two leaves on their hinges: the solids on the frame, and the leaves and the bolt.

    The key of the latch releases the first leaf; the second leaf waits for the first and for its bolt.
    """
    frame: list[Primitive] = []
    parts: list[ShapePart] = []
    bolts: list[ShapePart] = []
    for index, leaf in enumerate(leaves):
        on_leaf, on_frame = fit_hinges(leaf, hanging.levels, length=hanging.barrel, straps=hanging.straps)
        frame += on_frame
        pieces = [*build_leaf(leaf), *on_leaf]
        if len(leaves) == 2 and index == 0:
            cover, inset = hanging.astragal
            pieces += build_astragal(leaf, cover=cover, inset=inset)
        if index == 1:
            at = (leaf.x[0], leaf.edge - leaf.side * hanging.bolt[0], hanging.bolt[1])
            bolt, guides, staple = make_bolt(at, hanging.over, parent="leaf_1", length=hanging.length)
            bolts.append(bolt)
            pieces += guides
            frame += staple
        needs = (hanging.key,) if index == 0 else ("leaf", "bolt")
        swing = leaf.swing(radians(choose(rng, *hanging.swing)))
        held = require(*needs, fraction=RELEASED)
        parts.append(ShapePart(("leaf", "leaf_1")[index], "door", pieces, swing, parent="frame", needs=held))
    return Assembly(frame, (*parts, *bolts))


def build_latch_stile(latch: Latch, y: Range, z: Range, *, through: bool = True) -> tuple[Primitive, ...]:
    """Boards around the pocket of a leaf's latch, and two skins; the spindle passes through one or both."""
    free, (front, back) = latch.pocket, latch.x
    behind = (y[0], free.y[0]) if latch.side > 0 else (free.y[1], y[1])
    hole_y, hole_z = (around(at, HOLE) for at in latch.axis)
    around_hole = (free.y, free.z), (hole_y, hole_z), "front"
    skins = [*build_frame((front, free.x[0]), *around_hole)]
    if through:
        skins += build_frame((free.x[1], back), *around_hole)
    else:
        skins.append(block((free.x[1], back), free.y, free.z, "front"))
    return (
        block(latch.x, y, (z[0], free.z[0]), "front"),
        block(latch.x, y, (free.z[1], z[1]), "front"),
        block(latch.x, behind, free.z, "front"),
        *skins,
    )


def build_lock_stile(leaf: Leaf, latch: Latch, y: Range, *, through: bool = True) -> tuple[Primitive, ...]:
    """The stile beside a leaf's edge: that of the latch, or that of a second leaf with the latch's keep."""
    if leaf.edge == latch.edge:
        return build_latch_stile(latch, y, leaf.z, through=through)
    return build_keep(latch, Space(x=leaf.x, y=y, z=leaf.z), "front")


def build_jambs(inner: Space, width: float, latch: Latch | None) -> list[Primitive]:
    """Posts of a frame at both sides of a space; a latch in a single leaf has its keep in one of them."""
    pieces: list[Primitive] = []
    for side, at in zip((-1, 1), inner.y, strict=True):
        jamb = Space(x=inner.x, y=between(at, at + side * width), z=inner.z)
        if latch is not None and latch.side == side:
            pieces += build_keep(latch, jamb, "body")
        else:
            pieces.append(jamb.fill("body"))
    return pieces


def build_keep(latch: Latch, jamb: Space, finish: str) -> tuple[Primitive, ...]:
    """A jamb beside the leaf's edge with the keep cut out of it."""
    free, (x0, x1), (y0, y1), (z0, z1) = latch.keep, jamb.x, jamb.y, jamb.z
    web = (free.y[1], y1) if latch.side > 0 else (y0, free.y[0])
    return (
        block(jamb.x, jamb.y, (z0, free.z[0]), finish),
        block(jamb.x, jamb.y, (free.z[1], z1), finish),
        block((x0, free.x[0]), jamb.y, free.z, finish),
        block((free.x[1], x1), jamb.y, free.z, finish),
        block(free.x, web, free.z, finish),
    )


def build_tongue(latch: Latch, *, through: bool = True) -> tuple[Primitive, ...]:
    """Tongue, hub, and the spindle to a lever before the leaf, or to levers on both faces."""
    (y, z), free = latch.axis, latch.pocket
    x = narrow(free.x, PLAY)
    tip, high = y + latch.side * (latch.backset + THROW), latch.lift * TONGUE
    profile = [(y, z + high), (y, z - high), (tip, z + high), (tip, z), (tip - latch.side * 0.012, z - high)]
    tongue = polytope(np.array([(at, *corner) for at in x for corner in profile]), "steel")
    hub = cylinder((x[0], y, z), (x[1], y, z), 0.015, "steel")
    end = latch.x[1] + 0.006 if through else x[1]
    return tongue, hub, cylinder((latch.x[0] - 0.006, y, z), (end, y, z), 0.0055, "steel")


def make_bolt(
    at: Vector, over: float, *, parent: str, length: float
) -> tuple[ShapePart, tuple[Primitive, ...], tuple[Primitive, ...]]:
    """A vertical surface bolt in a staple on the frame above the leaf, which is drawn down to open.

    Args:
        at: Point on the leaf's face below the edge of the frame's face that the bolt reaches over.
        over: Protrusion (m) of the frame's face before the leaf's.
        parent: Name of the leaf.
        length: Length of the rod (m).

    Returns:
        The bolt, the solids fixed to the leaf and those fixed to the frame.
    """
    x, y, z = at
    radius, reach = 0.006, 0.022
    base = max(over, 0.004)
    middle = x - base - BOLT_PLAY - radius
    top, low = z + reach, z + reach - length
    rod = cylinder((middle, y, low), (middle, y, top), radius, "handle")
    level = min(low + length / 2, z - 0.065)  # below the guide, where fingers reach around it
    knob = cylinder((middle, y, level), (middle - 0.028, y, level), 0.009, "handle")
    bolt = ShapePart("bolt", "knob", (rod, knob), slide(reach + 0.012, DOWN), parent=parent)
    plate = block((x - base, x), around(y, 0.02), (low - 0.045, z - 0.02), "handle")
    guide = _build_staple((middle, y), radius, x - base, (z - 0.05, z - 0.03))
    return bolt, (plate, *guide), _build_staple((middle, y), radius, x - over, (z + 0.001, z + 0.016))


def _build_staple(at: tuple[float, float], radius: float, face: float, z: Range) -> tuple[Primitive, ...]:
    """Two cheeks and a cap around a rod at (x, y) before a face."""
    (x, y), inner, wall = at, radius + BOLT_PLAY, 0.004
    cap = x - inner
    cheeks = [block((cap, face), (y + a, y + a + wall), z, "handle") for a in (-inner - wall, inner)]
    return (*cheeks, block((cap - wall, cap), (y - inner - wall, y + inner + wall), z, "handle"))
