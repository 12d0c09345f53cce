"""Finishes of surfaces; `artigen.shapes.surfaces.textures` evaluates them at points."""

from dataclasses import dataclass
from typing import Literal

from artigen.shapes.primitives import Vector

FinishKind = Literal["wood", "lacquer", "steel", "plastic", "glass", "rubber", "stone"]
Color = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Finish:
    """A surface finish: its material, two colours (sRGB in [0, 1]) and its pattern."""

    kind: FinishKind
    color: Color
    """The main colour."""
    accent: Color
    """Colour of grain, brushing or speckles."""
    grain: Vector = (0.0, 0.0, 1.0)
    """Direction (object axes) of wood grain and of brushing."""
    period: float = 0.05
    """Period (m) of the pattern across the grain."""
    seed: int = 0
    """Seed that selects the pattern."""
    gloss: float = 0.2
    """Share of light mirrored head-on at full gloss: 0 is chalk, 1 a mirror."""
    opacity: float = 1.0
    """Share of what is behind that is hidden; below 1 only for transparent glass."""
