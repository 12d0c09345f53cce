"""Whether the parts of an object have the colours that a picture showed: mean colours, part by part.

Only parts count that the closed object shows: of the others, a picture says nothing.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float, UInt8

from artigen.train.photographs import NOTHING
from artigen.types import Part

MIN_PIXELS = 12
"""Pixels, over all pictures, that a part must have to be counted."""
Colors = dict[int, Float[np.ndarray, "3"]]
"""Mean colour (sRGB in [0, 1]) by part."""


def mean_colors(rgb: Float[np.ndarray, "V H W 3"], parts: UInt8[np.ndarray, "V H W"]) -> Colors:
    """Mean colour of the pixels of each part that enough pixels show; ``parts`` is `NOTHING` elsewhere."""
    ids, counts = np.unique(parts[parts != NOTHING], return_counts=True)
    return {
        int(part): rgb[parts == part].mean(axis=0)
        for part, count in zip(ids, counts, strict=True)
        if count >= MIN_PIXELS
    }


def color_error(found: Mapping[int, np.ndarray], truth: Mapping[int, np.ndarray]) -> float:
    """Mean over the true parts of the mean absolute difference of their colours.

    Raises:
        ValueError: If there is no true part, or one has no counterpart.
    """
    if not truth or not truth.keys() <= found.keys():
        raise ValueError(f"colours of parts {sorted(found)}, expected those of {sorted(truth)}, at least one")
    return float(np.mean([np.abs(found[part] - color).mean() for part, color in truth.items()]))


def borrow_colors(
    truth: Mapping[int, np.ndarray], parts: Sequence[Part], lent: Colors, lenders: Sequence[Part]
) -> Colors:
    """The colours that another object would lend to the parts of this one.

    Each part takes those of the nearest part, by the centres of boxes, with the same label; of all parts
    that have a colour where none has the label.

    Args:
        truth: the parts that want a colour.
        parts: of this object.
        lent: colours of the other object's parts.
        lenders: parts of the other object.

    Raises:
        ValueError: If the other object has no colours.
    """
    if not lent:
        raise ValueError("an object without colours has none to lend")
    out = {}
    for index in truth:
        part = parts[index]
        alike = [other for other in lent if lenders[other].label == part.label] or list(lent)
        apart = [float(np.linalg.norm(lenders[other].box[0] - part.box[0])) for other in alike]
        out[index] = lent[alike[int(np.argmin(apart))]]
    return out
