"""Interiors behind doors that cover several compartments: boards, shelves and rails."""

from artigen.shapes.assembly import Assembly
from artigen.shapes.fittings.hardware import GAP, Edge, Space
from artigen.shapes.furniture.cabinet import Looks
from artigen.shapes.furniture.cells import Fitting, furnish_cells
from artigen.shapes.furniture.splits import Node, lay_out
from artigen.shapes.primitives import Primitive, block


def furnish_interior(space: Space, node: Node, looks: Looks, *, parent: str, prefix: str = "in_") -> Assembly:
    """Furnishes open cells in a space, with the boards between them.

    Args:
        space: Free space behind the doors.
        node: Layout; all its cells are open.
        looks: Design.
        parent: Name of the part that the boards join and that carries all other parts.
        prefix: Makes the names of parts unique.
    """
    edges: tuple[Edge, ...] = ("left", "right", "top", "bottom")
    reach = dict.fromkeys(edges, -GAP)
    placed, boards = lay_out(node, space.y, space.z, board=looks.carcass.inner, reach=reach, inset=True)
    fitting = Fitting(
        front_x=space.x[0],
        thickness=looks.thickness,
        body=space.x,
        doors=looks.doors,
        drawers=looks.drawers,
        box=looks.box,
        parent=parent,
    )
    cells = furnish_cells(placed, fitting, prefix)
    solids: list[Primitive] = [block(space.x, y, z, "inside") for y, z in boards]
    return Assembly((*solids, *cells.pieces), cells.parts)
