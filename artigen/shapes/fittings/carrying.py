"""Carrying handles and telescopic handles of luggage and tool boxes."""

from artigen.shapes.fittings.hardware import FINGER_ROOM, GAP, slide
from artigen.shapes.primitives import UP, Primitive, Vector, block, cylinder
from artigen.shapes.ranges import Range, around
from artigen.shapes.shape import ShapePart

ROD = 0.013
"""Edge (m) of a telescopic rod."""
CHANNEL = ROD + 2 * GAP
"""Depth (m) of the channel that telescopic rods run in."""


def make_grip(
    at: Vector, length: float, *, name: str, parent: str, finish: str = "handle", thick: float = 0.016
) -> ShapePart:
    """A grip along y on two posts on an upward face; `FINGER_ROOM` plus its thickness high."""
    x, y, z = at
    low, half, deep = z + FINGER_ROOM, length / 2, 0.5 * thick
    middle, round_ = low + thick / 2, thick / 2
    posts = [
        block(around(x, deep), (a, a + thick), (z, middle), finish) for a in (y - half, y + half - thick)
    ]
    bar = cylinder((x, y - half, middle), (x, y + half, middle), round_, finish)
    return ShapePart(name, "handle", (bar, *posts), parent=parent)


def make_pull_handle(
    x: float,
    spread: float,
    z: Range,
    travel: float,
    *,
    out: float = 0.0,
    finish: str = "steel",
) -> ShapePart:
    """A telescopic handle: two rods and a grip that slide up out of a channel.

    Args:
        x: Front face of the channel (m); rods keep `GAP` from both faces.
        spread: Distance between the rods.
        z: Lower end of the rods and top of the grip.
        travel: Range of the joint (m).
        out: Distance (m) of the grip behind the rods.
        finish: Finish of the rods.
    """
    front, half = x + GAP, spread / 2
    rods: list[Primitive] = [
        block((front, front + ROD), around(a, ROD / 2), (z[0], z[1] - 0.02), finish) for a in (-half, half)
    ]
    bar, top = front + out, (z[1] - 0.02, z[1])
    if out > 0.0:
        rods += [block((front, bar), around(a, ROD / 2), top, finish) for a in (-half, half)]
    grip = block((bar, bar + ROD), around(0.0, half + ROD / 2), top, "rubber")
    return ShapePart("pull_handle", "handle", (grip, *rods), slide(travel, UP))


def build_channel(x: float, spread: float, z: Range, finish: str) -> tuple[Primitive, ...]:
    """The channel of `make_pull_handle` behind a face at ``x``: cheeks and a cover, open at the top."""
    half, back, wall = spread / 2 + ROD / 2 + GAP, x + CHANNEL, 0.006
    return (
        block((x, back), (-half - wall, -half), z, finish),
        block((x, back), (half, half + wall), z, finish),
        block((back, back + wall), (-half - wall, half + wall), z, finish),
    )
