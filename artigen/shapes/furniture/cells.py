"""Furnishes the cells of a layout: moving fronts, and their contents.

`furnish_cell` turns one `Placed` cell into solids that join the body and parts that it carries. A `Fitting`
holds the choices that are made once per object (design, swings, runners).
"""

from dataclasses import dataclass, replace
from math import radians

from artigen.shapes.assembly import Assembly
from artigen.shapes.fittings.drawers import make_drawer, make_tray
from artigen.shapes.fittings.fronts import FrontDesign, make_door, make_front
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import GAP, ROOM, Edge, Panel, Space, rotate, slide, sweep_gap
from artigen.shapes.furniture.looks import Looks
from artigen.shapes.furniture.splits import Cell, Placed
from artigen.shapes.primitives import FRONT, LEFT, RIGHT, Primitive, block, cylinder
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import Need, ShapePart

RUNNER = 0.0105
"""Thickness (m) of a runner beside a drawer box."""
SHELF = 0.016
"""Thickness (m) of loose shelves."""


@dataclass(frozen=True, kw_only=True)
class Fitting(Looks):
    """The looks of one body and its place (m)."""

    front_x: float
    """x of the front face of the fronts."""
    body: Range
    """x of the front and of the inner back of the body."""
    frame: float = 0.0
    """Depth of a face frame at the front of the body; 0 for none."""


def furnish_cells(placed: tuple[Placed, ...], fitting: Fitting, prefix: str = "") -> Assembly:
    """Furnishes all cells, named by a prefix and their place in the layout."""
    done = [furnish_cell(cell, fitting, f"{prefix}{index}") for index, cell in enumerate(placed)]
    return sum(done, Assembly())


def furnish_cell(placed: Placed, fitting: Fitting, tag: str) -> Assembly:
    """Furnishes one cell; ``tag`` makes its names unique."""
    fill = placed.cell.fill
    if fill == "drawer":
        return _hang_drawer(placed, fitting, tag)
    if fill == "blank":
        return Assembly((_make_blank(placed, fitting),))
    if fill == "slide":
        doors = _hang_sliding(placed, fitting, tag)
        start = fitting.body[0] + 2 * fitting.thickness + ROOM + 0.012
    else:
        doors = _hang_doors(placed, fitting, tag)
        start = fitting.body[0] + (0.002 if fill == "open" else 0.012)
        start = start if fill == "open" else max(start, fitting.front_x + fitting.thickness + 0.010)
        start = max(start, fitting.body[0] + fitting.frame)
    needs = tuple(Need(part=part.name) for part in doors if part.label == "door")
    inside = _fill_inside(placed, fitting, tag, start, needs)
    return Assembly(inside.pieces, (*doors, *inside.parts))


def suit_cell(design: FrontDesign, cell: Cell) -> FrontDesign:
    """The design of the fronts of one cell: with its panes and its number of handles."""
    if cell.pane is not None and cell.pane != (design.style == "framed_glass"):
        design = replace(
            design,
            style="framed_glass"
            if cell.pane
            else "shaker"
            if design.style == "framed_glass"
            else design.style,
        )
    if cell.handles is None:
        return design
    return replace(design, handle=design.handle if cell.handles else None, pair=cell.handles > 1)


def front_panel(placed: Placed, fitting: Fitting) -> Panel:
    """The front panel of a whole cell."""
    return Panel(x=fitting.front_x, thickness=fitting.thickness, y=placed.front_y, z=placed.front_z)


def _hang_drawer(placed: Placed, fitting: Fitting, tag: str) -> Assembly:
    panel = front_panel(placed, fitting)
    space = Space(x=(panel.back, fitting.body[1]), y=placed.y, z=placed.z)
    drawer_box, rails = fitting.box, ()
    if fitting.runners:
        drawer_box = replace(drawer_box, side_gap=RUNNER + GAP)
        middle = placed.z[0] + 0.4 * space.height
        start = max(fitting.body[0] + max(fitting.frame, 0.002), panel.back + 0.003)
        run = (start, start + 0.85 * (fitting.body[1] - start))
        rails = tuple(
            block(run, span, around(middle, 0.018), "steel")
            for span in ((placed.room_y[0], placed.y[0] + RUNNER), (placed.y[1] - RUNNER, placed.room_y[1]))
        )
    name, travel = f"drawer_{tag}", fitting.travel
    front = suit_cell(fitting.drawers, placed.cell)
    parts = make_drawer(panel, space, front, box=drawer_box, name=name, travel=travel)
    return Assembly(rails, parts)


def _make_blank(placed: Placed, fitting: Fitting) -> Primitive:
    """A fixed board: before the body like the fronts of other cells, or within the opening."""
    if fitting.body[0] - fitting.front_x > 0.5 * fitting.thickness:
        x = (fitting.front_x, fitting.body[0])
        return block(x, placed.front_y, placed.front_z, "front")
    x = (fitting.body[0], fitting.body[0] + fitting.thickness)
    return block(x, placed.y, placed.z, "front")


def _hang_doors(placed: Placed, fitting: Fitting, tag: str) -> tuple[ShapePart, ...]:
    cell, panel = placed.cell, front_panel(placed, fitting)
    name = f"door_{tag}"
    match cell.fill:
        case "door":
            return _hang_leaf(panel, placed, cell.edge, fitting, name)
        case "double":
            left, right = panel.split(sweep_gap(panel.width / 2, panel.thickness))
            upper = min(_choose_swing(placed, "left", fitting), _choose_swing(placed, "right", fitting))
            alike = replace(fitting, swing=upper, wide_swing=upper)
            return (
                *_hang_leaf(left, placed, "left", alike, f"{name}_left"),
                *_hang_leaf(right, placed, "right", replace(alike, lock=False), f"{name}_right"),
            )
        case "drop" | "lift":
            low_handle = cell.fill == "drop" and panel.z[0] < 0.07
            upper = radians(74) if low_handle else min(fitting.swing, radians(90))
            edge: Edge = "bottom" if cell.fill == "drop" else "top"
            return make_door(panel, suit_cell(fitting.doors, cell), name=name, edge=edge, upper=upper)
        case "fold":
            return _hang_folding(panel, cell, fitting, name)
    return ()


def _hang_leaf(
    panel: Panel, placed: Placed, edge: Edge, fitting: Fitting, name: str
) -> tuple[ShapePart, ...]:
    upper = _choose_swing(placed, edge, fitting)
    parts = make_door(panel, suit_cell(fitting.doors, placed.cell), name=name, edge=edge, upper=upper)
    if fitting.lock and panel.height > 0.3:
        return (*parts, _make_lock(panel, parts, edge))
    return parts


def _choose_swing(placed: Placed, edge: Edge, fitting: Fitting) -> float:
    return fitting.swing if edge in placed.shared else fitting.wide_swing


def _make_lock(panel: Panel, parts: tuple[ShapePart, ...], edge: Edge) -> ShapePart:
    """A turning lock with a key near the door's free edge, clear of the handle."""
    door, radius = parts[0].name, 0.015
    y = panel.y[0] + 0.03 if edge == "left" else panel.y[1] - 0.03
    z = panel.center[1]
    if len(parts) > 1:
        low, high = parts[1].bounds()
        room = radius + 0.02
        z = high[2] + room if high[2] + 2 * room < panel.z[1] else low[2] - room
    x = panel.x - 0.0015
    disc = cylinder((x, y, z), (x - 0.010, y, z), radius, "handle")
    bow = block((x - 0.024, x - 0.010), around(y, 0.004), around(z, 0.012), "handle")
    turn = rotate(FRONT, (x, y, z))
    return ShapePart(f"{door}_lock", "knob", (disc, bow), turn, parent=door)


def _hang_folding(panel: Panel, cell: Cell, fitting: Fitting, name: str) -> tuple[ShapePart, ...]:
    """A folding pair: the second leaf is hinged on the free edge of the first."""
    left, right = panel.split(GAP)
    near, far = (left, right) if cell.edge == "left" else (right, left)
    bare = replace(fitting.doors, handle=None)
    first, second = f"{name}_first", f"{name}_second"
    upper = min(fitting.swing, radians(95))
    return (
        *make_door(near, bare, name=first, edge=cell.edge, upper=upper),
        *make_door(far, fitting.doors, name=second, parent=first, edge=cell.edge, upper=radians(88)),
    )


SLIDING_GRIP = HandleDesign(kind="recessed", length=0.15, thickness=0.012)


def _hang_sliding(placed: Placed, fitting: Fitting, tag: str) -> tuple[ShapePart, ...]:
    """Two sliding leaves on two tracks within the opening, the left one in front."""
    overlap, margin = 0.03, 0.028
    y, z = narrow(placed.y, GAP), narrow(placed.z, GAP)
    width = (y[1] - y[0] + overlap) / 2
    grip = replace(SLIDING_GRIP, length=min(SLIDING_GRIP.length, 0.5 * (z[1] - z[0])))
    x = fitting.body[0] + 0.004
    front = Panel(x=x, thickness=fitting.thickness, y=(y[1] - width, y[1]), z=z)
    rear = replace(front, x=x + fitting.thickness + ROOM, y=(y[0], y[0] + width))
    inset = margin + grip.height / 2
    travel = width - overlap - margin - grip.height - 0.012
    names = f"door_{tag}_front", f"door_{tag}_rear"
    plain = replace(suit_cell(fitting.doors, placed.cell), handle=None)

    def hold(panel: Panel, name: str, at_y: float, index: int) -> ShapePart:
        at = (at_y, panel.center[1])
        return make_handle(panel, grip, name=f"{name}_handle_{index}", parent=name, upright=True, at=at)

    grips = [hold(front, names[0], at, k) for k, at in enumerate((front.y[1] - inset, front.y[0] + inset))]
    still = hold(rear, names[1], rear.y[0] + inset, 0)  # its leading edge is covered
    leaves = [
        ShapePart(name, "door", solids, slide(travel, axis))
        for name, solids, axis in (
            (names[0], make_front(front, plain), RIGHT),
            (names[1], (*make_front(rear, plain), *still.primitives), LEFT),
        )
    ]
    return (leaves[0], *grips, leaves[1])


def _fill_inside(
    placed: Placed, fitting: Fitting, tag: str, start: float, needs: tuple[Need, ...]
) -> Assembly:
    """Shelves, trays or a hanging rod between ``start`` and the back."""
    cell = placed.cell
    span = (start, fitting.body[1])
    low, high = placed.z
    if cell.inside == "shelves":
        pitch = (high - low) / (cell.count + 1)
        shelves = [
            _make_shelf(span, placed.room_y, low + (k + 1) * pitch, f"shelf_{tag}_{k}")
            for k in range(cell.count)
        ]
        return Assembly(parts=shelves)
    if cell.inside == "rod":
        hat = high - min(0.32, 0.25 * (high - low))
        x = (span[0] + span[1]) / 2
        y = placed.room_y
        rod = cylinder((x, y[0], hat - 0.06), (x, y[1], hat - 0.06), 0.014, "steel")
        return Assembly((rod,), (_make_shelf(span, y, hat, f"shelf_{tag}_0"),))
    if cell.inside == "trays":
        return _hang_trays(placed, fitting, tag, span, needs)
    return Assembly()


def _make_shelf(x: Range, y: Range, z: float, name: str) -> ShapePart:
    return ShapePart(name, "shelf", (block(x, y, (z, z + SHELF), "inside"),))


def _hang_trays(placed: Placed, fitting: Fitting, tag: str, x: Range, needs: tuple[Need, ...]) -> Assembly:
    """Trays on spacers that keep them clear of the open doors."""
    spacer = fitting.thickness + 0.007
    pitch = (placed.z[1] - placed.z[0]) / placed.cell.count
    y = narrow(placed.y, spacer)
    rails: list[Primitive] = []
    trays: list[ShapePart] = []
    tray_box = replace(fitting.box, rim=1.0, side_gap=GAP)
    for k in range(placed.cell.count):
        low = placed.z[0] + k * pitch + 0.012
        rim = low + min(0.11, 0.6 * pitch)
        for span in ((placed.room_y[0], y[0]), (y[1], placed.room_y[1])):
            rails.append(block((x[0] + 0.02, x[1]), span, (low, low + 0.04), "inside"))
        space = Space(x=(x[0] + 0.004, x[1]), y=y, z=(low, rim))
        trays.append(make_tray(space, tray_box, name=f"tray_{tag}_{k}", needs=needs))
    return Assembly(rails, trays)
