"""Error of the mean colour of each part in pictures.

Only parts that the closed object shows count; a picture holds no information about the others.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float, UInt8

from artigen.appearance.photographs import NOTHING
from artigen.examples.appearance import AppearanceExample
from artigen.metrics.appearance import Comparison

MIN_PIXELS = 12
"""Least number of pixels of a part, over all pictures, for it to count."""
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


def score_colors(
    examples: Sequence[AppearanceExample], answers: Mapping[str, Sequence[Comparison]]
) -> dict[str, float]:
    """Mean absolute error of the mean colour of each part that the closed object shows, over objects.

    Args:
        answers: Pictures of each of them, by method.
    """
    rows: dict[str, list[float]] = {name: [] for name in answers}
    for number, example in enumerate(examples):
        closed = example.pictures.state == 0
        parts = example.pictures.parts[closed]
        truth = mean_colors(example.pictures.rgb[closed] / 255.0, parts)
        for name, comparisons in answers.items():
            drawn = comparisons[number].drawn.double().numpy()[closed]
            rows[name].append(color_error(mean_colors(drawn, parts), truth))
    return {name: float(np.mean(values)) for name, values in rows.items()}
