"""Drawers and trays: open boxes of boards behind a front, on runners."""

from dataclasses import dataclass

from artigen.shapes.fittings.fronts import FrontDesign, fit_handle, make_front, suit_drawer
from artigen.shapes.fittings.hardware import GAP, Panel, Range, Space, fill_space, slide
from artigen.shapes.primitives import Primitive
from artigen.shapes.shape import Need, ShapePart

MAX_RATIO = 56.0
"""Longest edge of a board over its thickness: engines replace more oblong hulls by boxes."""


@dataclass(frozen=True, kw_only=True)
class BoxDesign:
    """How drawer boxes are built, metres."""

    wall: float = 0.013
    """Sides and back."""
    floor: float = 0.008
    """Least thickness of the bottom; long bottoms are thicker."""
    rim: float = 0.75
    """Height of the walls as a share of the space."""
    finish: str = "drawer"
    side_gap: float = GAP
    """Room on each side of the box; 13 mm where there are runners."""


def make_drawer(
    panel: Panel,
    space: Space,
    front: FrontDesign,
    *,
    box: BoxDesign,
    name: str,
    parent: str,
    travel: float = 0.75,
) -> tuple[ShapePart, ...]:
    """A drawer that fills a space behind its front, and its handles.

    Args:
        panel: The front; the box begins at its rear face.
        space: What is free behind it, walls and neighbours excluded; the box keeps its clearances.
        front: Look of the front.
        box: How the box is built.
        name: Of the drawer.
        parent: What it runs in.
        travel: Share of the box's depth that it slides.
    """
    front = suit_drawer(panel, front)
    depth = space.x[1] - GAP - panel.back
    primitives = (*make_front(panel, front), *make_box(space, box, (panel.back, space.x[1] - GAP)))
    drawer = ShapePart(
        name=name,
        label="drawer",
        parent=parent,
        primitives=primitives,
        motion=slide(travel * depth),
    )
    return (drawer, *fit_handle(panel, front, parent=name, edge=None))


def make_tray(
    space: Space, box: BoxDesign, *, name: str, parent: str, needs: tuple[Need, ...] = (), travel: float = 0.7
) -> ShapePart:
    """A low drawer without front that slides out once the doors before it are open."""
    front, back = space.x[0], space.x[1] - GAP
    solids = make_box(space, box, (front + box.wall, back))
    y, z = _inner_edges(space, box)
    rim = z[0] + _rim(space, box)
    lip = Space(x=(front, front + box.wall), y=y, z=(z[0], rim))
    return ShapePart(
        name=name,
        label="tray",
        parent=parent,
        primitives=(fill_space(lip, box.finish), *solids),
        motion=slide(travel * (back - front)),
        needs=needs,
    )


def make_box(space: Space, box: BoxDesign, x: Range) -> tuple[Primitive, ...]:
    """Bottom, back and two sides between ``x``; the front closes the box."""
    y, z = _inner_edges(space, box)
    rim = z[0] + _rim(space, box)
    floor = max(box.floor, max(x[1] - x[0], y[1] - y[0]) / MAX_RATIO)
    wall = max(box.wall, max(x[1] - x[0], y[1] - y[0]) / MAX_RATIO)
    bottom = Space(x=x, y=y, z=(z[0], z[0] + floor))
    up = (z[0] + floor, rim)
    back = Space(x=(x[1] - wall, x[1]), y=y, z=up)
    sides = [
        Space(x=(x[0], x[1] - wall), y=span, z=up) for span in ((y[0], y[0] + wall), (y[1] - wall, y[1]))
    ]
    return tuple(fill_space(part, box.finish) for part in (bottom, back, *sides))


def _inner_edges(space: Space, box: BoxDesign) -> tuple[Range, Range]:
    return (space.y[0] + box.side_gap, space.y[1] - box.side_gap), (space.z[0] + GAP, space.z[1] - GAP)


def _rim(space: Space, box: BoxDesign) -> float:
    return box.rim * (space.height - 2 * GAP)
