"""Changes of training objects, so that the network believes a photo more than what is usual in the grammar.

Real objects have open compartments and fronts without handles. `change_shape` removes parts of some objects
before they are photographed.
"""

from dataclasses import replace

import numpy as np

from artigen.shapes.shape import Shape, ShapePart

BARE, THINNED = 0.15, 0.2
"""Shares of the objects that lose all handles, and that lose random parts."""
THINNING = 0.5
"""Largest probability with which each part of a thinned object is removed."""
REMOVABLE = frozenset({"door", "drawer", "handle", "knob", "shelf", "tray"})
"""Labels of the parts that may be removed."""


def change_shape(shape: Shape, rng: np.random.Generator) -> Shape:
    """Removes parts of some shapes; others stay as they are.

    At least one part that moves remains.
    """
    chance = rng.random()
    if chance < BARE:
        shape = remove_parts(shape, {part.name for part in shape.parts if part.label == "handle"})
    elif chance < BARE + THINNED:
        share = THINNING * rng.random()
        chosen = [part for part in shape.parts if part.label in REMOVABLE and rng.random() < share]
        shape = remove_parts(shape, {part.name for part in chosen})
    return shape


def remove_parts(shape: Shape, names: set[str]) -> Shape:
    """Removes parts with all that they carry; the shape as it is if no part would move any more."""
    gone = set(names)
    while more := {part.name for part in shape.parts if part.parent in gone} - gone:
        gone |= more
    kept = [part for part in shape.parts if part.name not in gone]
    if all(part.joint is None for part in kept):
        return shape
    return replace(shape, parts=tuple(_release(part, gone) for part in kept))


def _release(part: ShapePart, gone: set[str]) -> ShapePart:
    """The part without references to parts that are gone."""
    motion = part.joint
    if motion is not None and motion.follows in gone:
        motion = replace(motion, follows=None)
    return replace(part, joint=motion, needs=tuple(need for need in part.needs if need.part not in gone))
