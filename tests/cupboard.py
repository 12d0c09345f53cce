"""A cupboard of few cells, and rows of outlines for parts that fill boxes of cells."""

import numpy as np

from artigen.types import JOINT_TYPES, PART_LABELS, JointType, PartLabel
from artigen.voxels.fields import CHANNELS, FIELD

EDGE = 32
CARCASS = [
    (slice(4, 28), slice(4, 28), slice(4, 6)),
    (slice(4, 28), slice(4, 28), slice(26, 28)),
    (slice(4, 28), slice(4, 6), slice(4, 28)),
    (slice(4, 28), slice(26, 28), slice(4, 28)),
    (slice(26, 28), slice(4, 28), slice(4, 28)),
]
"""Five boards, open towards -x."""
DOOR = (slice(1, 3), slice(4, 28), slice(4, 28))
KNOB = (slice(0, 1), slice(14, 16), slice(14, 16))
"""Two cells by two before the door: too little for a board."""
Place = tuple[slice, slice, slice]


def row(
    label: PartLabel,
    box: Place,
    joint: JointType = "fixed",
    *,
    axis: tuple[float, float, float] = (0.0, 0.0, 0.0),
    origin: tuple[float, float, float] | None = None,
    travel: float = 0.0,
    turn: float = 0.0,
) -> np.ndarray:
    """What an outline says of a part that fills a box.

    Args:
        label: of the part.
        box: its cells.
        joint: its joint.
        axis: direction of that.
        origin: a point on it, in cells; the middle of the box when None.
        travel: how far it slides, in cells.
        turn: how far it turns, in turns.
    """
    out = np.zeros(CHANNELS, dtype=np.float32)
    out[FIELD.label.start + PART_LABELS.index(label)] = 1.0
    out[FIELD.joint_type.start + JOINT_TYPES.index(joint)] = 1.0
    low, high = np.array([(side.start, side.stop) for side in box]).T / EDGE - 0.5
    out[FIELD.box] = [*(low + high) / 2, *high - low]
    out[FIELD.axis] = axis
    out[FIELD.origin] = (low + high) / 2 if origin is None else np.array(origin) / EDGE - 0.5
    out[FIELD.range] = turn, travel / EDGE
    return out[1:]


def carcass() -> np.ndarray:
    """Cells of the boards, of row 0, with nothing in it."""
    owners = np.full((EDGE,) * 3, -1)
    for board in CARCASS:
        owners[board] = 0
    return owners


BASE = row("base", (slice(4, 28), slice(4, 28), slice(4, 28)))
