"""`settle_extents`: lengths by what words say of their ranges and ratios, as usual as these allow."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from artigen.conditioning.measures import AXES, Axis
from artigen.conditioning.read import SLACK
from artigen.errors import ArtigenError
from artigen.kind import kinds
from artigen.shapes.draw import ShapeError, Wish, draw_shape
from artigen.sketch.request import SketchRequest

Range = tuple[Axis, float, float]
Ratio = tuple[Axis, float, Axis]


def settle_extents(
    request: SketchRequest,
    given: SketchRequest,
    ranges: Sequence[Range],
    ratios: Sequence[Ratio],
    factors: Mapping[str, float],
    seed: int,
) -> SketchRequest:
    """The request with the lengths (m) that have a range or a ratio.

    Args:
        request: A kind; its lengths are usual ones.
        given: The same with the lengths only that must be met.
        ranges: Least and largest lengths.
        ratios: Lengths as multiples of others.
        factors: Of usual lengths, by axes, where the request has none.
        seed: Of the object of the grammar whose lengths are usual where the request has none.

    Raises:
        ArtigenError: If no object of the kind has such lengths.
    """
    said = {axis for axis, _, _ in ranges} | {one for one, _, _ in ratios} | {one for _, _, one in ratios}
    if not said:
        return request
    kind = kinds()[str(request.category)]
    spans = dict(zip(AXES, kind.sizes, strict=True))
    spans |= {axis: (max(low, spans[axis][0]), min(high, spans[axis][1])) for axis, low, high in ranges}
    spans |= {axis: (length, length) for axis in AXES if (length := getattr(given, axis)) is not None}
    usual = {axis: factors.get(axis, 1.0) * length for axis, length in _draw_usual(request, seed).items()}
    size = {axis: float(np.clip(getattr(request, axis) or usual[axis], *spans[axis])) for axis in AXES}
    for one in ratios:
        for axis, ratio, other in (*ratios, *reversed(ratios)):  # what is left of each span by all ratios
            low = max(spans[other][0], spans[axis][0] / ratio)
            high = min(spans[other][1], spans[axis][1] / ratio)
            if low > high + SLACK:
                noun = next(iter(kind.nouns))
                raise ArtigenError(
                    f"a {noun} ({kind.name}) whose {axis} is {ratio:g} times its {other}: no {other} of it "
                    f"from {spans[other][0]:g} to {spans[other][1]:g} m has that; say another ratio"
                )
            spans |= {other: (low, high), axis: (ratio * low, ratio * high)}
        axis, ratio, other = one
        size[other] = float(np.clip(np.sqrt(size[axis] * size[other] / ratio), *spans[other]))
        size[axis] = ratio * size[other]
        spans |= {name: (size[name], size[name]) for name in (axis, other)}
    return replace(request, **{axis: size[axis] for axis in said})


def _draw_usual(request: SketchRequest, seed: int) -> dict[Axis, float]:
    """Lengths (m) of an object of the grammar: with the counts of the request where it has such a one."""
    wish = Wish(width=request.width, depth=request.depth, height=request.height, style=request.style)
    try:
        shape = draw_shape(str(request.category), seed, replace(wish, counts=request.counts))
    except ShapeError:
        shape = draw_shape(str(request.category), seed)
    depth, width, height = np.diff(shape.bounds(), axis=0)[0].tolist()
    return {"width": width, "depth": depth, "height": height}
