"""`read_shape`: what a reader without error would say of a shape that it sees from straight ahead and far
away."""

from typing import Literal

import numpy as np

from artigen.reader.reading import Label, Reading, ReadPart
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish

READ: dict[str, Label] = {
    "door": "door", "drawer": "drawer", "handle": "handle", "knob": "knob", "shelf": "shelf", "tray": "shelf",
    "wheel": "wheel",
}  # fmt: skip
LONG = 1.8
"""Ratio of a handle's sides from which it is a bar."""
FAR = 1e-3
"""Half the object's diagonal over its distance."""


def read_shape(shape: Shape, *, stand: Literal["flat", "legs", "wheels"] = "flat") -> Reading:
    """The reading of a closed shape from straight ahead; the picture ends at its outline.

    Shelves are left out, as if they were behind doors.
    """
    low, high = shape.bounds()
    depth, width, height = (float(length) for length in high - low)
    finishes = dict(shape.finishes)
    parts = [
        _read_part(part, low, high, finishes)
        for part in shape.parts
        if READ.get(part.label, "shelf") != "shelf"
    ]
    fronts = [part for part in parts if part.label in ("door", "drawer")]
    others = [part for part in parts if part.label not in ("door", "drawer")]
    red, green, blue = (round(255 * value) for value in finishes["body"].color)
    return Reading(
        kind=shape.category,
        kinds=((shape.category, 1.0),),
        box=np.array([0.0, 0.0, 1.0, 1.0]),
        parts=(*fronts, *others),
        size=(width, depth, height),
        view=(0.0, 0.0, FAR),
        stand=stand,
        color=(red, green, blue),
        extent=(round(1000 * width), round(1000 * height)),
    )


def _read_part(part: ShapePart, low: np.ndarray, high: np.ndarray, finishes: dict[str, Finish]) -> ReadPart:
    """A part as it is seen; left in the picture is +y."""
    ends = part.bounds()
    size = high - low
    left, right = (high[1] - ends[1, 1]) / size[1], (high[1] - ends[0, 1]) / size[1]
    top, bottom = (high[2] - ends[1, 2]) / size[2], (high[2] - ends[0, 2]) / size[2]
    wide, tall = float(ends[1, 1] - ends[0, 1]), float(ends[1, 2] - ends[0, 2])
    largest = max(part.primitives, key=lambda solid: float(solid.size[1] * solid.size[2]))
    finish = finishes[largest.finish]
    red, green, blue = (round(255 * value) for value in finish.color)
    front = part.label in ("door", "drawer")
    return ReadPart(
        label=READ[part.label],
        score=1.0,
        box=np.array([left, top, right, bottom]),
        hinge=_find_hinge(part) if part.label == "door" else None,
        pane=finish.kind == "glass",
        material=finish.kind if front else None,
        form=("bar" if max(wide, tall) > LONG * min(wide, tall) else "knob")
        if part.label == "handle"
        else None,
        color=(red, green, blue),
    )


def _find_hinge(part: ShapePart) -> Literal["left", "right", "top", "bottom"] | None:
    """The side of a door that its axis is at; None for a door that slides."""
    if part.motion is None or part.motion.type != "revolute":
        return None
    low, high = part.bounds()
    middle, at = (low + high) / 2, part.motion.origin
    if abs(part.motion.axis[2]) > 0.5:
        return "left" if at[1] > middle[1] else "right"
    return "top" if at[2] > middle[2] else "bottom"
