"""`Assembly`: solids and parts that one step of drawing adds to an object."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from artigen.shapes.choices import choose_style
from artigen.shapes.draw import Draft, Spans, Wish, choose_lengths
from artigen.shapes.primitives import Primitive
from artigen.shapes.shape import ShapePart, make_base
from artigen.shapes.surfaces.finishes import Finish


@dataclass(frozen=True, eq=False)
class Assembly:
    """Solids of the body, and the parts that it carries; assemblies can be added."""

    pieces: Sequence[Primitive] = ()
    parts: Sequence[ShapePart] = ()

    def __add__(self, other: "Assembly") -> "Assembly":
        return Assembly((*self.pieces, *other.pieces), (*self.parts, *other.parts))

    def close(self, name: str = "body") -> tuple[ShapePart, ...]:
        """All parts of the object: the body, made of the solids, and the parts that it carries."""
        return make_base(self.pieces, name), *self.parts


Build = Callable[[np.random.Generator, float, float, float], Assembly]
"""Draws the parts of an object with the given width, depth and height (m)."""


def draw_styled(
    rng: np.random.Generator,
    wish: Wish,
    styles: Mapping[str, float],
    sizes: Mapping[str, Spans],
    builders: Mapping[str, Build],
    draw_finishes: Callable[[np.random.Generator, str], Mapping[str, Finish]],
) -> Draft:
    """Draws an object of a category whose styles have their own sizes and builders."""
    style = choose_style(rng, styles, wish.style)
    built = builders[style](rng, *choose_lengths(rng, wish, sizes[style]))
    return Draft(style, built.close(), draw_finishes(rng, style))
