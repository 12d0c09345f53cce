"""Finishes: what a surface is made of; `artigen.shapes.surfaces.textures` evaluates it anywhere."""

from dataclasses import dataclass
from typing import Literal

from artigen.shapes.primitives import Vector

FinishKind = Literal["wood", "lacquer", "steel", "plastic", "glass", "rubber", "stone"]
Color = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Finish:
    """A surface: its material, two colours (sRGB in [0, 1]) and where its pattern lies."""

    kind: FinishKind
    color: Color
    """The main colour."""
    accent: Color
    """What grain, brushing or speckles are drawn in."""
    grain: Vector = (0.0, 0.0, 1.0)
    """Direction (object axes) along which wood grows and steel is brushed."""
    period: float = 0.05
    """Length (m) after which the pattern looks new across the grain."""
    seed: int = 0
    """Which of all patterns."""
    gloss: float = 0.2
    """Share of light mirrored head-on at full gloss: 0 is chalk, 1 a mirror."""
    opacity: float = 1.0
    """Share of what lies behind that is hidden; below 1 only for glass that one sees through."""
