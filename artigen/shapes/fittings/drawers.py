"""Drawers and trays: open boxes of boards behind a front, on runners."""

from dataclasses import dataclass

from artigen.shapes.fittings.fronts import FrontDesign, fit_handle, make_front, suit_drawer
from artigen.shapes.fittings.hardware import GAP, Panel, Space, slide
from artigen.shapes.primitives import Primitive
from artigen.shapes.ranges import Range, margins, narrow
from artigen.shapes.shape import Need, ShapePart

MAX_RATIO = 56.0
"""Largest ratio of a board's length to its thickness; engines replace more oblong hulls by boxes."""


@dataclass(frozen=True, kw_only=True)
class BoxDesign:
    """Dimensions of drawer boxes (m)."""

    wall: float = 0.013
    """Thickness of sides and back."""
    floor: float = 0.008
    """Minimum thickness of the bottom; long bottoms are thicker."""
    rim: float = 0.75
    """Height of the walls relative to the space."""
    finish: str = "drawer"
    side_gap: float = GAP
    """Clearance on each side of the box; 13 mm with runners."""


def make_drawer(
    panel: Panel,
    space: Space,
    front: FrontDesign,
    *,
    box: BoxDesign,
    name: str,
    travel: float = 0.75,
) -> tuple[ShapePart, ...]:
    """A drawer that fills a space behind its front, with its handles.

    Args:
        panel: Rectangle of the front; the box begins at its rear face.
        space: Free space behind it; the box keeps its clearances within it.
        front: Design of the front.
        box: Design of the box.
        name: Name of the drawer.
        travel: Range as a share of the box's depth.
    """
    front = suit_drawer(panel, front)
    depth = space.x[1] - GAP - panel.back
    primitives = (*make_front(panel, front), *make_box(space, box, (panel.back, space.x[1] - GAP)))
    drawer = ShapePart(name, "drawer", primitives, slide(travel * depth))
    return (drawer, *fit_handle(panel, front, parent=name, edge=None))


def make_tray(space: Space, box: BoxDesign, *, name: str, needs: tuple[Need, ...] = ()) -> ShapePart:
    """A low drawer without a front, which slides out once the doors before it are open."""
    front, back = space.x[0], space.x[1] - GAP
    solids = make_box(space, box, (front + box.wall, back))
    y, z = _inner_edges(space, box)
    rim = z[0] + _rim(space, box)
    lip = Space(x=(front, front + box.wall), y=y, z=(z[0], rim))
    pieces = (lip.fill(box.finish), *solids)
    return ShapePart(name, "tray", pieces, slide(0.7 * (back - front)), needs=needs)


def make_box(space: Space, box: BoxDesign, x: Range) -> tuple[Primitive, ...]:
    """Bottom, back and two sides over the range ``x``; the front closes the box."""
    y, z = _inner_edges(space, box)
    rim = z[0] + _rim(space, box)
    floor = max(box.floor, max(x[1] - x[0], y[1] - y[0]) / MAX_RATIO)
    wall = max(box.wall, max(x[1] - x[0], y[1] - y[0]) / MAX_RATIO)
    bottom = Space(x=x, y=y, z=(z[0], z[0] + floor))
    up = (z[0] + floor, rim)
    back = Space(x=(x[1] - wall, x[1]), y=y, z=up)
    sides = [Space(x=(x[0], x[1] - wall), y=span, z=up) for span in margins(y, wall)]
    return tuple(part.fill(box.finish) for part in (bottom, back, *sides))


def _inner_edges(space: Space, box: BoxDesign) -> tuple[Range, Range]:
    return narrow(space.y, box.side_gap), narrow(space.z, GAP)


def _rim(space: Space, box: BoxDesign) -> float:
    return box.rim * (space.height - 2 * GAP)
