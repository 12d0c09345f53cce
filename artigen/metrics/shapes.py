"""Exact objects for conditions, whose boxes a structure model draws within when it is evaluated."""

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from artigen.models.conditions import StructureCondition
from artigen.shapes.draw import ShapeError, Wish, draw_shape
from artigen.shapes.shape import Shape
from artigen.sketch.model import SketchConfig, draw_alike, draw_object
from artigen.sketch.network import SketchNetwork
from artigen.sketch.request import SketchRequest

ShapeSource = Callable[[StructureCondition, int], Shape]
"""Draws an object for a condition and a seed."""
TRIES = 40
"""Objects of the grammar among which the nearest is taken."""


def grammar_source(*, tries: int = TRIES) -> ShapeSource:
    """Objects of the grammar with the lengths that are asked for and the nearest counts among some draws.

    Args:
        tries: Draws per object, at most.
    """

    def draw_grammar(asked: StructureCondition, seed: int) -> Shape:
        if asked.category is None:
            raise ShapeError("no category is asked for, and the grammar reads none off pictures")
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


def sketch_source(network: SketchNetwork, cfg: SketchConfig | None = None) -> ShapeSource:
    """Objects of the sketch network, by words or by pictures: what a condition leaves open is drawn."""

    def draw_sketch(asked: StructureCondition, seed: int) -> Shape:
        depth, width, height = asked.size or (None, None, None)
        request = SketchRequest(
            category=asked.category, counts=asked.counts, depth=depth, width=width, height=height
        )
        if asked.image is None:
            return draw_object(network, request, seed, cfg).shape
        return draw_alike(network, request, seed, asked.image, cfg).shape

    return draw_sketch
