"""Scores of grasps, and a choice of different ones."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from sim_export.geometry.hulls import inside_hulls
from sim_export.package import Hull

from .boxes import arriving_boxes
from .carry import Way
from .gripper import Gripper
from .pairs import FRICTION
from .poses import Hands
from .room import meet

WIDE = 0.010
"""Clearance (m) from which more counts nothing."""
APART, TURNED = 0.0075, np.radians(20.0)
"""Two kept grasps differ by this distance (m) or this angle."""
WEIGHTS = {"antipodal": 0.3, "margin": 0.3, "clearance": 0.2, "facing": 0.2}
"""Weights of the score: angle of the normals within the friction cone, share of the pads that touch, free
distance, and the cosine between the approach and the handle's normal."""


def score_hands(way: Way, hands: Hands, begin: float) -> Float[np.ndarray, "G"]:
    """Scores in [0, 1] by `WEIGHTS` of hands that take hold of a target as a stroke begins."""
    T, normal = hands.T, way.target.normal
    wide = arriving_boxes(way.gripper, hands.width, WIDE)
    terms = {
        "antipodal": 1.0 - hands.angle / np.arctan(FRICTION),
        "margin": pad_share(T, hands.width, way.gripper, way.own),
        "clearance": ~meet(T, wide, way.around(hands, way.along([begin])[0], moving=False)),
        "facing": np.full(len(T), 0.5) if normal is None else (1.0 - T[:, :3, 2] @ normal) / 2.0,
    }
    return np.clip(sum(WEIGHTS[name] * value for name, value in terms.items()), 0.0, 1.0)


def pad_share(
    T: Float[np.ndarray, "G 4 4"], width: Float[np.ndarray, "G"], gripper: Gripper, own: Sequence[Hull]
) -> Float[np.ndarray, "G"]:
    """Share of the two pads that touches the link: of points on a grid, those with the link 2 mm below."""
    low, high = gripper.pad
    x, z = np.meshgrid(*(np.linspace(low[k], high[k], 7)[1::2] for k in (0, 2)))
    places = np.stack([x.ravel(), np.zeros(x.size), z.ravel()], axis=1)
    sides = np.array([1.0, -1.0])[:, None] * np.maximum(width / 2.0 - 2e-3, 0.0)  # 2 G
    points = np.repeat(places[None, None], 2, axis=0) + sides[:, :, None, None] * np.array([0.0, 1.0, 0.0])
    placed = np.einsum("gij,sgnj->sgni", T[:, :3, :3], points) + T[:, None, :3, 3]
    touched = inside_hulls(placed.reshape(-1, 3), own).reshape(placed.shape[:3])
    return touched.mean(axis=(0, 2))


def spread_poses(T: Float[np.ndarray, "G 4 4"], count: int, least: int = 0) -> Int[np.ndarray, "K"]:
    """Indices of the first poses, at most ``count``, that differ by `APART` or `TURNED` from all before; if
    they are fewer than ``least``, and more are found from one end of the poses on, those."""
    kept = _spread(T, np.arange(len(T)), count)
    if len(kept) < least and len(T):
        first = int(_differ(T, T[0]).sum(axis=0).argmax())
        other = _spread(T, np.argsort(_differ(T, T[first]).sum(axis=0), kind="stable"), count)
        kept = other if len(other) > len(kept) else kept
    return kept


def _spread(T: Float[np.ndarray, "G 4 4"], left: Int[np.ndarray, "G"], count: int) -> Int[np.ndarray, "K"]:
    kept = []
    while len(left) and len(kept) < count:
        kept.append(left[0])
        left = left[(_differ(T[left], T[left[0]]) >= 1.0).any(axis=0)]
    return np.array(kept, dtype=np.int64)


def _differ(T: Float[np.ndarray, "G 4 4"], one: Float[np.ndarray, "4 4"]) -> Float[np.ndarray, "2 G"]:
    """Distances of poses from one, in `APART`, and angles, in `TURNED`."""
    cosine = (np.einsum("gij,ij->g", T[:, :3, :3], one[:3, :3]) - 1.0) / 2.0
    away = np.linalg.norm(T[:, :3, 3] - one[:3, 3], axis=1)
    return np.stack([away / APART, np.arccos(np.clip(cosine, -1.0, 1.0)) / TURNED])
