"""`list_rows`: a layout as rows of fronts, for kinds whose front is no tree of cells."""

from dataclasses import dataclass

from artigen.shapes.furniture.cabinet import list_cells
from artigen.shapes.furniture.splits import Cell, Node, Split


@dataclass(frozen=True, kw_only=True)
class LaidRow:
    """Fronts side by side."""

    height: float
    """Relative to that of the other rows."""
    cells: tuple[Cell, ...]
    """From the left."""
    shares: tuple[float, ...]
    """Their relative widths."""

    @property
    def paired(self) -> bool:
        """Whether there are two fronts."""
        return len(self.cells) == 2 or self.cells[0].fill in ("double", "slide", "fold")

    @property
    def drawers(self) -> bool:
        """Whether all fronts are drawers."""
        return all(cell.fill == "drawer" for cell in self.cells)


def list_rows(node: Node) -> list[LaidRow]:
    """The rows of a layout from the top down; of each column the first front, and no cells without one."""
    rows: list[tuple[Node, float]] = [(node, 1.0)]
    if isinstance(node, Split) and node.along == "rows":
        rows = list(zip(node.children, node.shares, strict=True))
    return [row for child, height in rows if (row := _make_row(child, height)).cells]


def _make_row(node: Node, height: float) -> LaidRow:
    columns: list[tuple[Node, float]] = [(node, 1.0)]
    if isinstance(node, Split):
        columns = list(zip(node.children, node.shares, strict=True))
    found = [(list_cells(child)[0], share) for child, share in columns]
    closed = [(cell, share) for cell, share in found if cell.fill not in ("open", "blank")]
    return LaidRow(
        height=height,
        cells=tuple(cell for cell, _ in closed),
        shares=tuple(share for _, share in closed),
    )
