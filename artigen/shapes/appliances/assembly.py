"""`Assembly`: what one step of drawing adds to an object."""

from dataclasses import dataclass

from artigen.shapes.primitives import Primitive
from artigen.shapes.shape import ShapePart


@dataclass(frozen=True, kw_only=True, eq=False)
class Assembly:
    """Pieces of the body, and parts of their own; steps are added up."""

    pieces: tuple[Primitive, ...] = ()
    parts: tuple[ShapePart, ...] = ()

    def __add__(self, other: "Assembly") -> "Assembly":
        return Assembly(pieces=self.pieces + other.pieces, parts=self.parts + other.parts)

    def close(self) -> tuple[ShapePart, ...]:
        """All parts of the object: the body, made of the pieces, and the parts that hang on it."""
        return ShapePart(name="body", label="base", parent=None, primitives=self.pieces), *self.parts
