"""`Assembly`: solids and parts that one step of drawing adds to an object."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from artigen.shapes.draw import Draft, Wish, choose_lengths, choose_style
from artigen.shapes.fittings.hardware import Range
from artigen.shapes.primitives import Primitive
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Finish


@dataclass(frozen=True, kw_only=True, eq=False)
class Assembly:
    """Solids of the body, and separate parts; assemblies can be added."""

    pieces: tuple[Primitive, ...] = ()
    parts: tuple[ShapePart, ...] = ()

    def __add__(self, other: "Assembly") -> "Assembly":
        return Assembly(pieces=self.pieces + other.pieces, parts=self.parts + other.parts)

    def close(self) -> tuple[ShapePart, ...]:
        """All parts of the object: the body, made of the solids, and the parts that it carries."""
        return ShapePart(name="body", label="base", parent=None, primitives=self.pieces), *self.parts


Build = Callable[[np.random.Generator, float, float, float], Assembly]
"""Draws the parts of an object with the given width, depth and height (m)."""


def draw_styled(
    rng: np.random.Generator,
    wish: Wish,
    styles: Mapping[str, float],
    sizes: Mapping[str, tuple[Range, Range, Range]],
    builders: Mapping[str, Build],
    draw_finishes: Callable[[np.random.Generator, str], Mapping[str, Finish]],
) -> Draft:
    """Draws an object of a category whose styles have their own sizes and builders."""
    style = choose_style(rng, styles, wish.style)
    built = builders[style](rng, *choose_lengths(rng, wish, sizes[style]))
    return Draft(style=style, parts=built.close(), finishes=tuple(sorted(draw_finishes(rng, style).items())))
