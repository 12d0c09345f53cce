"""Controls of appliances: dials, push buttons, displays.

Controls are on a face with normal ``out``: (-1, 0, 0) on a front, (0, 0, 1) on a hob. The gap between a dial
and its face is `DIAL_GAP`, that of a button its travel.
"""

from dataclasses import dataclass, replace
from functools import cache
from math import radians
from typing import Literal

import numpy as np

from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.fittings.hardware import rotate, slide
from artigen.shapes.primitives import (
    FRONT,
    Primitive,
    Vector,
    as_vector,
    block,
    box,
    cylinder,
    polygon,
    prism,
)
from artigen.shapes.ranges import Range, around
from artigen.shapes.shape import ShapePart

DialKind = Literal["round", "grip", "collar", "faceted"]
DIAL_GAP = 0.0015
BADGE = 0.003
"""Thickness of a maker's plate (m)."""
PRESS = 0.0022
"""Travel of a button (m)."""


@dataclass(frozen=True, kw_only=True)
class DialDesign:
    """One model of dial, shared by all dials of an appliance (m)."""

    kind: DialKind
    radius: float
    length: float
    """Protrusion from its panel."""
    finish: str
    mark: str
    """Role of the finish of pointer or collar."""
    upper: float | None
    """Range (rad); None for no limits."""


def design_dial(
    rng: np.random.Generator, radius: Range, *, endless: float, finish: str = "handle"
) -> DialDesign:
    """Draws a dial with a radius from a range; ``endless`` is the probability of no limits."""
    kinds: tuple[DialKind, ...] = ("round", "grip", "collar", "faceted")
    drawn = choose(rng, *radius)
    return DialDesign(
        kind=choose_one(rng, kinds),
        radius=drawn,
        length=float(np.clip(rng.uniform(0.9, 1.5) * drawn, 0.015, 0.035)),
        finish=finish,
        mark="accent" if finish != "accent" else "rubber",
        upper=None if rng.random() < endless else radians(choose(rng, 180, 300)),
    )


def make_dial(
    design: DialDesign, at: Vector, *, name: str, parent: str = "body", out: Vector = FRONT
) -> ShapePart:
    """A dial whose axis meets the face at ``at`` and points along ``out``."""
    place = _Placing(at=np.array(at), out=np.array(out))
    low, high, r = DIAL_GAP, DIAL_GAP + design.length, design.radius
    middle = low + 0.45 * design.length
    solids = {
        "round": [
            place.rod(low, high, r, design.finish),
            place.bar(around(high, 0.002), around(0.0, 0.12 * r), (0.25 * r, 0.95 * r), design.mark),
        ],
        "grip": [
            place.rod(low, middle, r, design.finish),
            place.bar((middle, high), around(0.0, 0.22 * r), around(0.0, 0.95 * r), design.finish),
        ],
        "collar": [
            place.rod(low, low + 0.22 * design.length, r, design.mark),
            place.rod(low + 0.22 * design.length, high, 0.78 * r, design.finish),
        ],
        "faceted": [place.cone(low, high, r, design.finish)],
    }[design.kind]
    return ShapePart(name, "knob", solids, rotate(out, at, design.upper), parent=parent)


def make_button(
    at: Vector,
    size: tuple[float, float, float],
    *,
    name: str,
    parent: str = "body",
    finish: str,
    shape: Literal["round", "square"] = "square",
    out: Vector = FRONT,
) -> ShapePart:
    """A push button of ``size`` (width, height, length; m) with a travel of `PRESS` into its face."""
    width, height, length = size
    place = _Placing(at=np.array(at), out=np.array(out))
    low = 0.0012 + PRESS
    solid = (
        place.rod(low, low + length, min(width, height) / 2, finish)
        if shape == "round"
        else place.bar((low, low + length), around(0.0, width / 2), around(0.0, height / 2), finish)
    )
    inward = (-out[0], -out[1], -out[2])
    return ShapePart(name, "knob", (solid,), slide(PRESS, inward), parent=parent)


def spread_controls(
    rng: np.random.Generator,
    design: DialDesign,
    x: float,
    y: Range,
    z: Range,
    *,
    counts: tuple[int, int],
    parent: str = "body",
) -> Assembly:
    """A row of dials on a band at ``x``, with a display and keys between its two halves.

    Args:
        rng: Random generator.
        design: Design of the dials.
        x: Face of the band.
        y: Range of the band across.
        z: Range of the band upwards.
        counts: Number of dials and keys; keys that do not fit are omitted.
        parent: Name of the part that carries the controls.
    """
    dials, keys = counts
    middle = (z[0] + z[1]) / 2
    pitch = 2.5 * design.radius
    shows = rng.random() < 0.6 or dials == 0
    room = y[1] - y[0] - dials * pitch
    window = min(max(choose(rng, 0.10, 0.18), 0.032 * keys), 0.9 * room)
    pieces: list[Primitive] = []
    parts: list[ShapePart] = []
    left = int(dials * rng.uniform(0.35, 0.65)) if shows or keys else dials
    center = 0.5 * (y[0] + y[1])
    if (shows or keys) and window > 0.05:
        spare = (room - window) / 2
        center = y[1] - left * pitch - spare - window / 2
        frame = (center - window / 2 + 0.005, center + window / 2 - 0.005)
        if shows:
            low = middle - (0.006 if keys else 0.016)
            pieces.append(build_display(x, frame, (low, low + 0.032)))
        parts += _make_keys(
            frame, (x, middle - (0.022 if shows else 0.0)), min(keys, int(window / 0.03)), parent
        )
        spans = ((y[1] - left * pitch - spare, y[1], left), (y[0], center - window / 2, dials - left))
    else:
        spans = ((y[0], y[1], dials),)
    for low, high, count in spans:
        for k in range(count):
            at = (x, high - (k + 0.5) * (high - low) / count, middle)
            parts.append(make_dial(design, at, name=f"dial_{len(parts)}", parent=parent))
    return Assembly(pieces, parts)


def _make_keys(y: Range, at: tuple[float, float], count: int, parent: str) -> list[ShapePart]:
    """A row of push buttons from left to right at (x, z)."""
    pitch = (y[1] - y[0]) / max(count, 1)
    size = (min(0.024, 0.8 * pitch), 0.021, 0.007)
    places = [(at[0], y[1] - (k + 0.5) * pitch, at[1]) for k in range(count)]
    return [
        make_button(place, size, name=f"key_{k}", parent=parent, finish="plastic")
        for k, place in enumerate(places)
    ]


def build_display(x: float, y: Range, z: Range) -> Primitive:
    """A dark window that protrudes 3 to 4 mm from a front at ``x``."""
    rise = max(0.003, (y[1] - y[0]) / 50)
    return block((x - rise, x), y, z, "panel")


def build_badge(x: float, at: tuple[float, float], width: float) -> Primitive:
    """A maker's plate on a front at ``x``, its middle at (y, z) and without a name."""
    y, z = at
    return block((x - BADGE, x), around(y, width / 2), around(z, 0.1 * width), "accent", BADGE / 4)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Placing:
    """Local coordinates of a control: out of its face, across (y), and up along the face."""

    at: np.ndarray
    out: np.ndarray

    def point(self, out: float, across: float, up: float) -> Vector:
        rise = np.array([self.out[2], 0.0, -self.out[0]])
        return as_vector(self.at + out * self.out + up * rise + (0.0, across, 0.0))

    def rod(self, low: float, high: float, radius: float, finish: str) -> Primitive:
        return cylinder(self.point(low, 0, 0), self.point(high, 0, 0), radius, finish)

    def cone(self, low: float, high: float, radius: float, finish: str) -> Primitive:
        cone = _cone(high - low, radius, finish)
        return replace(cone, center=np.array(self.point((low + high) / 2, 0, 0)), rotation=self.frame)

    @property
    def frame(self) -> np.ndarray:
        """Rotation whose third column is ``out`` and whose second is y."""
        across = np.array([0.0, 1.0, 0.0])
        return np.column_stack([np.cross(across, self.out), across, self.out])

    def bar(self, out: Range, across: Range, up: Range, finish: str) -> Primitive:
        corners = np.array([self.point(a, b, c) for a in out for b in across for c in up])
        return box(as_vector(corners.min(axis=0)), as_vector(corners.max(axis=0)), finish)


@cache
def _cone(length: float, radius: float, finish: str) -> Primitive:
    """A faceted cone about z, centred on the origin."""
    low, high = (0.0, 0.0, -length / 2), (0.0, 0.0, length / 2)
    return prism(radius * polygon(10), low, high, finish, taper=0.82)
