"""Objects of the grammar for conditions, in place of those of the sketch network."""

from contextlib import suppress

import numpy as np

from artigen.metrics.draws import ShapeSource
from artigen.models.conditions import StructureCondition
from artigen.shapes.draw import ShapeError, Wish, draw_shape
from artigen.shapes.shape import Shape

TRIES = 40
"""Objects of the grammar from which the nearest is chosen."""


def grammar_source(*, tries: int = TRIES) -> ShapeSource:
    """Objects of the grammar with the requested lengths and the nearest counts among several draws.

    Args:
        tries: Most draws per object.
    """

    def draw_grammar(asked: StructureCondition, seed: int) -> Shape:
        if asked.category is None:
            raise ShapeError("no category is given, and the grammar cannot read pictures; give a category")
        wanted = dict(asked.counts)
        depth, width, height = asked.size or (None, None, None)
        wish = Wish(depth=depth, width=width, height=height)
        best: tuple[int, Shape] | None = None
        for number in np.random.SeedSequence(seed).generate_state(tries).tolist():
            with suppress(ValueError):  # some styles have no such lengths
                shape = draw_shape(asked.category, number, wish)
                held = dict(shape.condition.counts)
                off = sum(abs(held.get(label, 0) - count) for label, count in wanted.items())
                if best is None or off < best[0]:
                    best = off, shape
                if off == 0:
                    break
        if best is None:
            raise ShapeError(f"no {asked.category} of {tries} has the size {asked.size} m")
        return best[1]

    return draw_grammar
