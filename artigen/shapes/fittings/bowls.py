"""Bowls with rounded corners: half shells of luggage, housings that are open on one side."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from artigen.shapes.fittings.hardware import Range
from artigen.shapes.primitives import Primitive, line, polytope


@dataclass(frozen=True, kw_only=True)
class Outline:
    """A rectangle with rounded corners, metres: across the axis of a bowl."""

    a: Range
    b: Range
    radius: float
    pieces: int = 2
    """Straight pieces of each corner."""

    def shrink(self, by: float) -> "Outline":
        """The same, taken in by so much on every side."""
        return Outline(
            a=(self.a[0] + by, self.a[1] - by),
            b=(self.b[0] + by, self.b[1] - by),
            radius=max(self.radius - by, 0.2 * self.radius),
            pieces=self.pieces,
        )

    def trace(self) -> Float[np.ndarray, "N 2"]:
        """Corners, counterclockwise."""
        turns = np.linspace(0.0, np.pi / 2, self.pieces + 1)
        arc = self.radius * np.column_stack([np.cos(turns), np.sin(turns)])
        out = []
        for k, (a, b) in enumerate(((1, 1), (0, 1), (0, 0), (1, 0))):
            spin = np.array(
                [
                    [np.cos(k * np.pi / 2), -np.sin(k * np.pi / 2)],
                    [np.sin(k * np.pi / 2), np.cos(k * np.pi / 2)],
                ]
            )
            inset = np.array([self.a[a] + (1 - 2 * a) * self.radius, self.b[b] + (1 - 2 * b) * self.radius])
            out.append(inset + arc @ spin.T)
        return np.concatenate(out)


def build_bowl(
    outline: Outline,
    span: Range,
    wall: float,
    finish: str,
    *,
    axis: str = "x",
    bevel: float = 0.0,
    lining: str | None = None,
) -> tuple[Primitive, ...]:
    """A face and walls around a hollow that is open at one end.

    Args:
        outline: Across the axis: (y, z) for the axis x, (x, y) for z.
        span: Where the closed and where the open end are along the axis; either may be the larger.
        wall: Thickness (m).
        finish: Surface.
        axis: "x" or "z".
        bevel: What is taken off the edges of the face (m); the face is at least as thick.
        lining: Surface of the inside.
    """
    way = 1.0 if span[1] > span[0] else -1.0
    face = span[0] + way * max(wall, bevel)
    rim, inner = outline.trace(), outline.shrink(wall).trace()
    top = np.concatenate([_lift(outline.shrink(bevel).trace(), span[0], axis), _lift(rim, face, axis)])
    solids = [_line(polytope(top, finish), lining, _lift(np.zeros((1, 2)), way, axis)[0])]
    for k, after in pairwise([*range(len(rim)), 0]):
        flat = np.array([rim[k], rim[after], inner[k], inner[after]])
        corners = np.concatenate([_lift(flat, face, axis), _lift(flat, span[1], axis)])
        inward = _lift((inner[k] + inner[after] - rim[k] - rim[after])[None], 0.0, axis)[0]
        solids.append(_line(polytope(corners, finish), lining, inward))
    return tuple(solids)


def _lift(flat: Float[np.ndarray, "N 2"], at: float, axis: str) -> Float[np.ndarray, "N 3"]:
    """Points across the axis, at a place along it."""
    along = np.full((len(flat), 1), at)
    return np.concatenate([along, flat] if axis == "x" else [flat, along], axis=1)


def _line(solid: Primitive, lining: str | None, inward: Float[np.ndarray, "3"]) -> Primitive:
    if lining is None:
        return solid
    x, y, z = (inward / np.linalg.norm(inward)).tolist()
    return line(solid, lining, (x, y, z))
