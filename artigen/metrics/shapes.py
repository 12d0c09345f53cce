"""Exact objects for conditions, whose outlines a structure model takes in evaluations."""

from collections.abc import Callable

from artigen.models.conditions import StructureCondition
from artigen.shapes.shape import Shape
from artigen.sketch.model import SketchConfig, draw_object, draw_pictured
from artigen.sketch.network import SketchNetwork
from artigen.sketch.request import SketchRequest

ShapeSource = Callable[[StructureCondition, int], Shape]
"""Draws an object for a condition and a seed."""


def sketch_source(network: SketchNetwork, cfg: SketchConfig | None = None) -> ShapeSource:
    """Objects of the sketch network, by fields or by picture; open fields are sampled."""

    def draw_sketch(asked: StructureCondition, seed: int) -> Shape:
        depth, width, height = asked.size or (None, None, None)
        request = SketchRequest(
            category=asked.category, counts=asked.counts, depth=depth, width=width, height=height
        )
        if asked.image is None:
            return draw_object(network, request, seed, cfg).shape
        return draw_pictured(network, request, seed, asked.image, cfg).shape

    return draw_sketch
