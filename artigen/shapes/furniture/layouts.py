"""`Layout`: the front of a piece of furniture as given, instead of drawn."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from artigen.shapes.furniture.splits import Node

if TYPE_CHECKING:
    from artigen.shapes.fittings.feet import StandKind
    from artigen.shapes.fittings.fronts import FrontStyle


@dataclass(frozen=True, kw_only=True)
class Layout:
    """A division of a front, and what is visible around it (m); None is drawn."""

    node: Node
    """Cells with their handles and panes."""
    stands: tuple["StandKind", ...] = ()
    """Kinds of stands to draw from; none for the usual ones."""
    stand_height: float | None = None
    """Height of legs or of a plinth."""
    gap: float | None = None
    """Distance of neighbouring fronts: wide ones show a face frame, lesser ones the boards between inset
    fronts."""
    worktop: float | None = None
    """Thickness of a worktop; 0 for none."""
    doors: "FrontStyle | None" = None
    """Style of doors; that of the object's style where it is None."""
    drawers: "FrontStyle | None" = None
    """The same of drawers."""
