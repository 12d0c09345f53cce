"""Handles of eight kinds, plain, on backplates or hanging, and their usual places.

A `HandleDesign` is chosen once for an object, so that its handles match; `make_handle` fits it to a panel.
Bars, pulls and arches leave room for fingers behind them; the other kinds protrude enough to be pinched.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, get_args

import numpy as np

from artigen.shapes.choices import choose
from artigen.shapes.fittings.hardware import Edge, Panel
from artigen.shapes.primitives import Primitive, Vector, block, cylinder, polygon, polytope
from artigen.shapes.ranges import between
from artigen.shapes.shape import ShapePart

HandleKind = Literal["bar", "pull", "arch", "knob", "cup", "recessed", "edge", "block"]
HANDLE_KINDS: tuple[HandleKind, ...] = get_args(HandleKind)
HandleTrim = Literal["plain", "plate", "drop"]
"""Fixed to the front alone, on a backplate, or hanging: bails instead of arches, pendants of knobs."""
PLATE, RIM = 0.003, 0.009
"""Thickness (m) of a backplate, and how far it is seen around its handle."""
OUT = 0.02
"""Distance (m) of the middle of a hanging handle from its front."""
FINGERS = 0.027
"""Free depth (m) behind a bar."""
LENGTHS: dict[HandleKind, tuple[float, float]] = {
    "bar": (0.12, 0.32),
    "pull": (0.10, 0.26),
    "arch": (0.10, 0.18),
    "knob": (0.026, 0.038),
    "cup": (0.08, 0.11),
    "recessed": (0.10, 0.16),
    "edge": (0.12, 0.40),
    "block": (0.06, 0.14),
}


@dataclass(frozen=True, kw_only=True)
class HandleDesign:
    """One handle model (lengths in metres)."""

    kind: HandleKind
    length: float
    """Length; shorter panels get shorter handles."""
    thickness: float
    """Thickness of a bar or lip, seen from the front."""
    finish: str = "handle"
    trim: HandleTrim = "plain"
    """As it is made; cups, recessed grips, edges and blocks are always plain."""

    @property
    def height(self) -> float:
        """Extent across the length, seen from the front."""
        wide = {"knob": self.length, "cup": 0.42 * self.length, "recessed": 0.4 * self.length}
        across = max(wide.get(self.kind, self.thickness), self.thickness)
        if self.hangs:
            return 1.6 * self.length if self.kind == "knob" else 0.34 * self.length
        return across + 2 * RIM if self.has_plate else across

    @property
    def hangs(self) -> bool:
        """Whether its grip hangs below where it is fixed."""
        return self.trim == "drop" and self.kind in ("knob", "arch")

    @property
    def has_plate(self) -> bool:
        """Whether it has a backplate."""
        return self.trim != "plain" and not self.hangs and self.kind in ("knob", "arch", "bar", "pull")

    @property
    def reach(self) -> float:
        """Protrusion from its panel."""
        if self.hangs:
            return OUT + self.grip
        bow = FINGERS + self.thickness
        return {"knob": 0.030, "cup": 0.026, "recessed": 0.008, "edge": 0.022, "block": 0.028}.get(
            self.kind, bow
        )

    @property
    def grip(self) -> float:
        """Radius of what hangs: of a pendant at its lower end, or of a bail."""
        return 0.26 * self.length if self.kind == "knob" else 0.36 * self.thickness


def design_handle(
    rng: np.random.Generator,
    kind: HandleKind | None = None,
    *,
    longest: float = 1.0,
    trim: HandleTrim = "plain",
) -> HandleDesign:
    """Draws a design for an object with longest edge ``longest`` (m); large objects get thicker handles."""
    drawn = HANDLE_KINDS[int(rng.choice(len(HANDLE_KINDS), p=(0.26, 0.17, 0.1, 0.2, 0.08, 0.06, 0.09, 0.04)))]
    kind = kind or drawn
    low, high = LENGTHS[kind]
    length = choose(rng, low, high) * float(np.clip(0.75 + 0.25 * longest, 0.85, 1.3))
    thickness = choose(rng, 0.010, 0.014) * float(np.clip(0.7 + 0.4 * longest, 0.9, 1.6))
    return HandleDesign(kind=kind, length=length, thickness=thickness, trim=trim)


def place_handle(
    panel: Panel, design: HandleDesign, edge: Edge | None, hand: float = 1.05
) -> tuple[bool, tuple[float, float]]:
    """The usual place of a handle: whether it is vertical, and its centre as (y, z).

    Args:
        panel: The front.
        design: The handle.
        edge: Hinged edge of the front; None for a drawer.
        hand: Height (m, object frame) at which a hand takes it.
    """
    y, z = panel.center
    upright = edge in ("left", "right") and design.kind not in ("cup", "knob")
    half = (design.length if upright else design.height) / 2
    room = 0.0 if design.kind == "edge" else min(0.045, panel.height / 4)
    if edge in ("left", "right"):
        across = design.height if upright else design.length
        inset = across / 2 + (0.0 if design.kind == "edge" else min(0.028, panel.width / 6))
        y = panel.y[0] + inset if edge == "left" else panel.y[1] - inset
        margin = min(half + max(room, 0.03), panel.height / 2)
        z = float(np.clip(hand, panel.z[0] + margin, panel.z[1] - margin))
    elif edge == "top":
        z = panel.z[0] + half + room
    elif edge == "bottom" or design.kind == "edge":
        z = panel.z[1] - half - room
    elif panel.height > 0.22:  # deep drawers have it in their upper third
        z = panel.z[1] - max(half + 0.03, 0.08)
    return upright, (y, z)


def make_handle(
    panel: Panel, design: HandleDesign, *, name: str, parent: str, upright: bool, at: tuple[float, float]
) -> ShapePart:
    """A handle on the face of a panel, its centre at (y, z) = ``at``, fixed to ``parent``."""
    span = panel.height if upright else panel.width
    long = min(design.length, 0.86 * span) if design.kind != "knob" else design.length
    offset = np.array([panel.x, *at])
    model = _build_model(design, long, upright)
    primitives = tuple(replace(primitive, center=primitive.center + offset) for primitive in model)
    return ShapePart(name, "handle", primitives, parent=parent)


@dataclass(frozen=True)
class _Solid:
    """A piece of a handle in (out of the panel, along the handle, across it) coordinates, metres.

    It is a box between two corners, a rod between two ends if it has a ``radius``, or a hull of ``corners``.
    """

    low: Vector = (0.0, 0.0, 0.0)
    high: Vector = (0.0, 0.0, 0.0)
    bevel: float = 0.0
    radius: float = 0.0
    corners: tuple[Vector, ...] = ()
    finish: str | None = None


@lru_cache(maxsize=64)
def _build_model(design: HandleDesign, long: float, upright: bool) -> tuple[Primitive, ...]:  # noqa: FBT001
    """The pieces on a panel at x = 0, about y = z = 0; cached, since an object's handles are alike."""
    build = _HANGING if design.hangs else _BUILDERS
    solids = build[design.kind](design, long)
    if design.has_plate:
        solids.append(_build_plate(design, long))
    return tuple(_place_solid(solid, solid.finish or design.finish, upright) for solid in solids)


def _place_solid(solid: _Solid, finish: str, upright: bool) -> Primitive:  # noqa: FBT001
    def place(point: Vector) -> Vector:
        out, along, across = point
        return (-out, across, along) if upright else (-out, along, across)

    if solid.corners:
        return polytope(np.array([place(corner) for corner in solid.corners]), finish)
    a, b = place(solid.low), place(solid.high)
    if solid.radius:
        return cylinder(a, b, solid.radius, finish)
    x, y, z = (between(first, second) for first, second in zip(a, b, strict=True))
    return block(x, y, z, finish, solid.bevel)


def _build_bar(design: HandleDesign, long: float) -> list[_Solid]:
    """A round rod on two posts, inset from its ends."""
    radius = design.thickness / 2
    middle, foot = FINGERS + radius, 0.36 * long
    posts = [
        _Solid(low=(0, side * foot, 0), high=(middle, side * foot, 0), radius=0.75 * radius)
        for side in (-1, 1)
    ]
    return [_Solid(low=(middle, -long / 2, 0), high=(middle, long / 2, 0), radius=radius), *posts]


def _build_pull(design: HandleDesign, long: float) -> list[_Solid]:
    """A square bracket with feet at its ends."""
    half, end = design.thickness / 2, long / 2
    feet = [
        _Solid(low=(0, side * (end - 2 * half), -half), high=(FINGERS, side * end, half)) for side in (-1, 1)
    ]
    grip = _Solid(low=(FINGERS, -end, -half), high=(FINGERS + 2 * half, end, half), bevel=0.3 * half)
    return [grip, *feet]


def _build_arch(design: HandleDesign, long: float) -> list[_Solid]:
    """A bow of five straight pieces between two half ellipses."""
    half = design.thickness / 2
    turns = np.linspace(0, np.pi, 6)
    outer, inner = (
        [(max(float(rise * np.sin(t)), 0.0), float(-run * np.cos(t))) for t in turns]
        for rise, run in ((FINGERS + 2 * half, long / 2), (FINGERS, long / 2 - 2 * half))
    )
    return [
        _Solid(
            corners=tuple(
                (*place, side * half)
                for place in (outer[k], outer[k + 1], inner[k], inner[k + 1])
                for side in (-1, 1)
            )
        )
        for k in range(5)
    ]


def _build_knob(design: HandleDesign, long: float) -> list[_Solid]:
    """A neck that flares out to a cap with a cut rim."""
    radius, neck, rim = long / 2, design.reach - 0.014, design.reach - 0.005
    return [
        _Solid(high=(neck, 0, 0), radius=0.45 * radius),
        _cone((neck, 0.5 * radius), (rim, radius)),
        _cone((rim, radius), (design.reach, 0.72 * radius)),
    ]


def _cone(near: tuple[float, float], far: tuple[float, float]) -> _Solid:
    """A round solid about the axis out of the panel; (distance, radius) of both ends."""
    ring = polygon()
    corners = [(out, radius * float(a), radius * float(b)) for out, radius in (near, far) for a, b in ring]
    return _Solid(corners=tuple(corners))


def _build_plate(design: HandleDesign, long: float) -> _Solid:
    """A round plate behind a knob, an oblong one behind other handles."""
    if design.kind == "knob":
        return _Solid(high=(PLATE, 0, 0), radius=long / 2 + RIM)
    end, half = long / 2 + RIM, design.thickness / 2 + RIM
    return _Solid(low=(0, -end, -half), high=(PLATE, end, half), bevel=PLATE / 3)


def _build_pendant(design: HandleDesign, long: float) -> list[_Solid]:
    """A drop on a rosette with a stud."""
    half, radius = design.height / 2, design.grip
    stud = half - 0.36 * long
    drop = [
        (OUT + wide * radius * float(a), wide * radius * float(b), across)
        for across, wide in ((stud + 0.006, 0.5), (-half, 1.0))
        for a, b in polygon()
    ]
    return [
        _Solid(low=(0, 0, stud), high=(PLATE, 0, stud), radius=0.36 * long),
        _Solid(low=(0, 0, stud), high=(OUT + 0.5 * radius, 0, stud), radius=0.45 * radius),
        _Solid(corners=tuple(drop)),
    ]


def _build_bail(design: HandleDesign, long: float) -> list[_Solid]:
    """A bow that hangs between two studs on rosettes."""
    half, end, radius = design.height / 2, long / 2, design.grip
    rose = min(0.012, 0.6 * half)
    stud, bar = half - rose, radius - half
    sides = [side * (end - rose) for side in (-1, 1)]
    solids = [_Solid(low=(OUT, -end + rose, bar), high=(OUT, end - rose, bar), radius=radius)]
    for at in sides:
        solids += [
            _Solid(low=(0, at, stud), high=(PLATE, at, stud), radius=rose),
            _Solid(low=(0, at, stud), high=(OUT, at, stud), radius=radius),
            _Solid(low=(OUT, at, bar), high=(OUT, at, stud), radius=radius),
        ]
    return solids


def _build_cup(design: HandleDesign, long: float) -> list[_Solid]:
    """A cup that is open below: a roof, a slanted front, two cheeks."""
    high, deep, wall, half = design.height / 2, design.reach, 0.004, long / 2
    roof = 0.5 * deep
    slant = ((roof, high), (roof - wall, high), (deep, -high), (deep - wall, -high))
    cheek = ((0.0, high), (0.0, -high), (roof - wall, high), (deep - wall, -high))
    return [
        _Solid(corners=tuple((out, along, across) for along in (-half, half) for out, across in slant)),
        _Solid(low=(0, wall - half, high - wall), high=(roof - wall, half - wall, high)),
        *(
            _Solid(corners=tuple((out, along, across) for along in (side, inner) for out, across in cheek))
            for side, inner in ((-half, wall - half), (half, half - wall))
        ),
    ]


def _build_recessed(design: HandleDesign, long: float) -> list[_Solid]:
    """A recessed grip: a raised rim around a dark hollow."""
    half, high, rim, deep = long / 2, design.height / 2, 0.009, design.reach
    return [
        _Solid(low=(0, rim - half, rim - high), high=(0.003, half - rim, high - rim), finish="rubber"),
        _Solid(low=(0, -half, high - rim), high=(deep, half, high)),
        _Solid(low=(0, -half, -high), high=(deep, half, rim - high)),
        _Solid(low=(0, -half, rim - high), high=(deep, rim - half, high - rim)),
        _Solid(low=(0, half - rim, rim - high), high=(deep, half, high - rim)),
    ]


def _build_edge(design: HandleDesign, long: float) -> list[_Solid]:
    """A profile along the free edge of a front, thick enough to grip."""
    half = design.thickness / 2
    return [_Solid(low=(0, -long / 2, -half), high=(design.reach, long / 2, half), bevel=0.3 * half)]


def _build_block(design: HandleDesign, long: float) -> list[_Solid]:
    """A wedge that widens outwards."""
    half = design.thickness / 2
    corners = tuple(
        (out, side * (long / 2 - shrink), up * (half - 0.3 * shrink))
        for out, shrink in ((0.0, 0.008), (design.reach, 0.0))
        for side in (-1, 1)
        for up in (-1, 1)
    )
    return [_Solid(corners=corners)]


_BUILDERS: dict[HandleKind, Callable[[HandleDesign, float], list[_Solid]]] = {
    "bar": _build_bar,
    "pull": _build_pull,
    "arch": _build_arch,
    "knob": _build_knob,
    "cup": _build_cup,
    "recessed": _build_recessed,
    "edge": _build_edge,
    "block": _build_block,
}
_HANGING: dict[HandleKind, Callable[[HandleDesign, float], list[_Solid]]] = {
    "knob": _build_pendant,
    "arch": _build_bail,
}
