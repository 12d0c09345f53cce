"""Changes of training objects, so that the network believes a photo more than what is usual in the grammar.

Real objects have open compartments, fronts without handles and any colour. `change_shape` removes parts and
repaints finishes of some objects before they are photographed.
"""

from dataclasses import replace

import numpy as np

from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Color, Finish

BARE, THINNED, REPAINTED = 0.15, 0.2, 0.25
"""Shares of the objects that lose all handles, that lose random parts, and that are repainted."""
THINNING = 0.5
"""Largest probability with which each part of a thinned object is removed."""
REMOVABLE = frozenset({"door", "drawer", "handle", "knob", "shelf", "tray"})
"""Labels of the parts that may be removed."""


def change_shape(shape: Shape, rng: np.random.Generator) -> Shape:
    """Removes parts of some shapes and repaints some; others stay as they are.

    At least one part that moves remains.
    """
    chance = rng.random()
    if chance < BARE:
        shape = remove_parts(shape, {part.name for part in shape.parts if part.label == "handle"})
    elif chance < BARE + THINNED:
        share = THINNING * rng.random()
        chosen = [part for part in shape.parts if part.label in REMOVABLE and rng.random() < share]
        shape = remove_parts(shape, {part.name for part in chosen})
    if rng.random() < REPAINTED:
        finishes = tuple((role, repaint_finish(finish, rng)) for role, finish in shape.finishes)
        shape = replace(shape, finishes=finishes)
    return shape


def remove_parts(shape: Shape, names: set[str]) -> Shape:
    """Removes parts with all that they carry; the shape as it is if no part would move any more."""
    gone = set(names)
    while more := {part.name for part in shape.parts if part.parent in gone} - gone:
        gone |= more
    kept = [part for part in shape.parts if part.name not in gone]
    if all(part.motion is None for part in kept):
        return shape
    return replace(shape, parts=tuple(_release(part, gone) for part in kept))


def _release(part: ShapePart, gone: set[str]) -> ShapePart:
    """The part without references to parts that are gone."""
    motion = part.motion
    if motion is not None and motion.follows in gone:
        motion = replace(motion, follows=None)
    return replace(part, motion=motion, needs=tuple(need for need in part.needs if need.part not in gone))


def repaint_finish(finish: Finish, rng: np.random.Generator) -> Finish:
    """The same material in a random colour; its accent differs from it as before."""
    color = rng.random(3)
    accent = np.clip(color + np.subtract(finish.accent, finish.color), 0.0, 1.0)
    return replace(finish, color=_to_color(color), accent=_to_color(accent))


def _to_color(values: np.ndarray) -> Color:
    red, green, blue = values.tolist()
    return red, green, blue
