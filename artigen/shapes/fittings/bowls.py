"""Bowls with rounded corners: half shells of luggage, housings that are open on one side."""

from artigen.shapes.fittings.outlines import Outline, build_loft
from artigen.shapes.primitives import Primitive, line
from artigen.shapes.ranges import Range, between


def build_bowl(
    outline: Outline,
    span: Range,
    wall: float,
    *,
    axis: int = 0,
    bevel: float = 0.0,
) -> tuple[Primitive, ...]:
    """A bowl: a closed face and walls around a hollow that is open at one end.

    Args:
        outline: Outline across the axis: (y, z) for x, (x, y) for z.
        span: Coordinates of the closed and of the open end along the axis, in either order.
        wall: Thickness (m).
        axis: 0 or 2 for x or z.
        bevel: Chamfer of the edges of the face (m); the face is at least as thick.
    """
    way = 1.0 if span[1] > span[0] else -1.0
    inner = span[0] + way * max(wall, bevel)
    inward = (way, 0.0, 0.0) if axis == 0 else (0.0, 0.0, way)
    (face,) = build_loft(outline, axis, between(span[0], inner), "body", inset=way * bevel)
    walls = build_loft(outline, axis, between(inner, span[1]), "body", wall=wall, lining="inside")
    return line(face, "inside", inward), *walls
