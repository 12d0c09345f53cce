"""Interiors behind doors that cover several compartments: boards, shelves and rails."""

from artigen.shapes.assembly import Assembly
from artigen.shapes.fittings.hardware import GAP, Edge, Space
from artigen.shapes.furniture.cells import Fitting, furnish_cells
from artigen.shapes.furniture.looks import Looks
from artigen.shapes.furniture.splits import Node, lay_out
from artigen.shapes.primitives import Primitive, block


def furnish_interior(space: Space, node: Node, looks: Looks) -> Assembly:
    """Furnishes a layout of open cells in the space behind doors, with the boards between them."""
    edges: tuple[Edge, ...] = ("left", "right", "top", "bottom")
    reach = dict.fromkeys(edges, -GAP)
    placed, boards = lay_out(node, space.y, space.z, board=looks.carcass.inner, reach=reach, inset=True)
    fitting = Fitting(**vars(looks), front_x=space.x[0], body=space.x)
    cells = furnish_cells(placed, fitting, "in_")
    solids: list[Primitive] = [block(space.x, y, z, "inside") for y, z in boards]
    return Assembly((*solids, *cells.pieces), cells.parts)
