"""Bowls with rounded corners: half shells of luggage, housings that are open on one side."""

from artigen.shapes.fittings.hardware import Range
from artigen.shapes.fittings.outlines import Outline, build_loft
from artigen.shapes.primitives import Primitive, Vector, line


def build_bowl(
    outline: Outline,
    span: Range,
    wall: float,
    finish: str,
    *,
    axis: int = 0,
    bevel: float = 0.0,
    lining: str | None = None,
) -> tuple[Primitive, ...]:
    """A bowl: a closed face and walls around a hollow that is open at one end.

    Args:
        outline: Outline across the axis: (y, z) for x, (x, y) for z.
        span: Coordinates of the closed and of the open end along the axis, in either order.
        wall: Thickness (m).
        finish: Role of the finish.
        axis: 0 or 2 for x or z.
        bevel: Chamfer of the edges of the face (m); the face is at least as thick.
        lining: Finish of the inside.
    """
    way = 1.0 if span[1] > span[0] else -1.0
    inner = span[0] + way * max(wall, bevel)
    ends = (min(span[0], inner), max(span[0], inner)), (min(inner, span[1]), max(inner, span[1]))
    (face,) = build_loft(outline, axis, ends[0], finish, inset=way * bevel)
    if lining is not None:
        inward: dict[int, Vector] = {0: (way, 0.0, 0.0), 1: (0.0, way, 0.0), 2: (0.0, 0.0, way)}
        face = line(face, lining, inward[axis])
    return face, *build_loft(outline, axis, ends[1], finish, wall=wall, lining=lining)
