"""What is behind doors that cover several compartments: boards, shelves and rails, in the depth of a case."""

from artigen.shapes.fittings.hardware import GAP, Edge, Space, fill_space
from artigen.shapes.furniture.cabinet import Looks
from artigen.shapes.furniture.cells import Fitting, Furnished, furnish_cells
from artigen.shapes.furniture.splits import Node, lay_out
from artigen.shapes.primitives import Primitive


def furnish_interior(
    space: Space, node: Node, looks: Looks, *, parent: str, prefix: str = "in_"
) -> Furnished:
    """Open cells in a space, and the boards between them.

    Args:
        space: What is free behind the doors.
        node: How it is divided; all its cells are open.
        looks: Designs.
        parent: The part that the boards join and that all else hangs from.
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
    solids: list[Primitive] = [fill_space(Space(x=space.x, y=y, z=z), "inside") for y, z in boards]
    return Furnished(primitives=(*solids, *cells.primitives), parts=cells.parts)
