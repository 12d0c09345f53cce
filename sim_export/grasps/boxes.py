"""Boxes that a gripper sweeps as it arrives, and that it fills as it carries what it holds."""

import numpy as np
from jaxtyping import Float

from .gripper import Gripper, mirrored

ROOMY = 0.012
"""Most free distance (m) of each pad as the gripper arrives."""
ARRIVAL = 0.08
"""Length (m) of the straight approach."""
TOUCH = 0.001
"""Depth (m) by which a pad may overlap what it holds, where that is curved."""


def arriving_boxes(
    gripper: Gripper, width: Float[np.ndarray, "G"], clear: float
) -> Float[np.ndarray, "G B 2 3"]:
    """What the gripper sweeps as it arrives, opened a little more than ``width``, and as it then closes."""
    spare = np.minimum((gripper.opening - width) / 2.0, ROOMY)
    come = _fingers(gripper, width / 2.0 + spare, 0.0, clear)
    come[:, :, 0, 2] -= ARRIVAL
    palm = np.repeat(gripper.palm[None], len(width), axis=0) + clear * np.array([[-1.0], [1.0]])
    palm[:, :, 0, 2] -= ARRIVAL
    close = _fingers(gripper, width / 2.0 + TOUCH, spare, clear)
    return np.concatenate([palm, come, mirrored(come), close, mirrored(close)], axis=1)


def carried_boxes(
    gripper: Gripper, width: Float[np.ndarray, "G"], clear: float
) -> Float[np.ndarray, "G B 2 3"]:
    """Palm, finger at +y and finger at -y of the closed gripper, larger by ``clear`` but at the pads."""
    palm = np.repeat(gripper.palm[None], len(width), axis=0) + clear * np.array([[-1.0], [1.0]])
    near = _fingers(gripper, width / 2.0, 0.0, clear)
    return np.concatenate([palm, near, mirrored(near)], axis=1)


def _fingers(
    gripper: Gripper, inner: Float[np.ndarray, "G"], swept: Float[np.ndarray, "G"] | float, clear: float
) -> Float[np.ndarray, "G F 2 3"]:
    """Boxes of the finger at +y with its pad at ``inner``, swept outwards and larger by ``clear``."""
    boxes = np.repeat(gripper.finger[None], len(inner), axis=0)
    boxes[..., 1] += inner[:, None, None]
    boxes[:, :, 1, 1] += np.broadcast_to(swept, inner.shape)[:, None]
    return boxes + clear * np.array([[-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]])
