"""Parallel grippers as boxes.

The frame lies between the middles of the finger pads: z is the direction of approach, y that in which the
fingers close.

- Franka Hand: finger boxes, tool point and stroke of ``franka_description`` (Franka Robotics, Apache-2.0),
  the slanted box replaced by the box around it; the hand is the box around its collision mesh; 70 N
  continuous force by the product manual.
- Robotiq 2F-85: stroke 85 mm, 149 mm wide when open and 20 to 235 N by the instruction manual; pads of
  22 x 37.5 x 8 mm and their distance from the base by ``robotiq_2f85`` of MuJoCo Menagerie. Its fingers
  close on a linkage; here they slide, with the linkages as boxes that are as wide as the open gripper.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sim_export.errors import PackageError

MOST = 0.2
"""Widest ``parallel:WIDTH``, metres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Gripper:
    """A gripper with two sliding fingers; metres and newtons.

    ``palm [P 2 3]`` are the lowest and highest corners of its boxes. ``finger [F 2 3]`` are those of the
    finger at +y with its pad's face at y = 0; the first is the pad. The other finger is its mirror image.
    ``base`` is the distance of the frame of the hand, along z behind ours. ``joint`` is the name of the
    driven finger joint, ``closed`` and ``opened`` are its coordinates at widths of 0 and ``opening``.
    """

    name: str
    opening: float
    force: float
    palm: Float[np.ndarray, "P 2 3"]
    finger: Float[np.ndarray, "F 2 3"]
    base: float
    joint: str
    closed: float
    opened: float

    @property
    def pad(self) -> Float[np.ndarray, "2 3"]:
        """Box of the pad of the finger at +y, with its face at y = 0."""
        return self.finger[0]

    def coordinate(self, width: float) -> float:
        """Coordinate of ``joint`` with the pads ``width`` metres apart."""
        return self.closed + (self.opened - self.closed) * width / self.opening


def mirrored(boxes: Float[np.ndarray, "*B 2 3"]) -> Float[np.ndarray, "*B 2 3"]:
    """Boxes on the other side of y = 0."""
    out = boxes.copy()
    out[..., 0, 1], out[..., 1, 1] = -boxes[..., 1, 1], -boxes[..., 0, 1]
    return out


def _box(x: float, y: tuple[float, float], z: tuple[float, float]) -> list[list[float]]:
    """A box of half width ``x`` (mm), as corners in metres."""
    return (np.array([[-x, y[0], z[0]], [x, y[1], z[1]]]) / 1e3).tolist()


FRANKA = Gripper(
    name="franka",
    opening=0.080,
    force=70.0,
    palm=np.array([_box(31.6, (-104.0, 104.0), (-129.3, -37.4))]),
    finger=np.array(
        [
            _box(8.75, (0.0, 15.2), (-9.0, 9.5)),
            _box(8.75, (7.0, 24.8), (-28.6, -4.7)),
            _box(11.0, (11.0, 26.0), (-44.0, -24.0)),
        ]
    ),
    base=0.1034,
    joint="panda_finger_joint1",
    closed=0.0,
    opened=0.04,
)
ROBOTIQ = Gripper(
    name="robotiq_2f85",
    opening=0.085,
    force=70.0,
    palm=np.array([_box(37.5, (-37.5, 37.5), (-141.4, -47.4))]),
    finger=np.array(
        [
            _box(11.0, (0.0, 8.0), (-18.75, 18.75)),
            _box(13.5, (4.0, 32.0), (-76.0, -18.75)),
        ]
    ),
    base=0.1414,
    joint="finger_joint",
    closed=0.8,
    opened=0.0,
)
GRIPPERS = {gripper.name: gripper for gripper in (FRANKA, ROBOTIQ)}


def find_gripper(name: str) -> Gripper:
    """The gripper of a name: franka, robotiq_2f85, or a plain one that opens to ``parallel:WIDTH`` metres.

    Raises:
        PackageError: If there is none of that name, or the width is not above 0 and at most `MOST`.
    """
    if name in GRIPPERS:
        return GRIPPERS[name]
    kind, _, text = name.partition(":")
    try:
        width = float(text)
    except ValueError:
        width = 0.0
    if kind != "parallel" or not 0.0 < width <= MOST:
        raise PackageError(
            f"gripper {name!r}, expected {', '.join(GRIPPERS)} or parallel:WIDTH with a width of up to "
            f"{MOST} m, such as parallel:0.08"
        )
    half = 1e3 * width / 2.0
    return Gripper(
        name=name,
        opening=width,
        force=50.0,
        palm=np.array([_box(30.0, (-half - 20.0, half + 20.0), (-110.0, -40.0))]),
        finger=np.array([_box(10.0, (0.0, 10.0), (-40.0, 10.0))]),
        base=0.110,
        joint="finger_joint",
        closed=0.0,
        opened=width / 2.0,
    )
