"""Poses in which a gripper closes on a target, wherever else it may be."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from artigen.transforms import inverse, rotation_about, transform_points
from sim_export.geometry.hulls import hull_triangles
from sim_export.geometry.rays import plane_axes
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import area_normals
from sim_export.package import Hull, SimPackage

from .boxes import TOUCH
from .gripper import Gripper
from .pairs import FRICTION, SAMPLES, Pairs, find_pairs, held_hulls
from .targets import Target

TURNS = 16
"""Directions of approach about the closing direction."""
BEHIND = -0.3
"""Least cosine between a direction of approach and that against the handle's normal."""
DEPTHS = (0.0, 0.5, 0.9)
"""Places of the contacts on the pads, from their middles to the finger tips."""
SPARE = 0.003
"""Least free distance (m) of each pad as the gripper arrives."""
CONE = float(np.cos(np.arctan(FRICTION)))
INSIDE = np.array(
    [np.roll(weights, k) for weights in ((0.7, 0.15, 0.15), (0.1, 0.45, 0.45)) for k in range(3)]
)
"""Points of every triangle at which pads may touch it, as weights of its corners."""
EVEN = float(np.cos(np.radians(10.0)))
"""Least cosine between closing direction and faces for poses nearby: pads turn what is not even."""
JITTERS = 24
"""Poses tried near each."""
SHIFTED, TILTED = 0.004, np.radians(15.0)
"""Most distances (m) and angles by which they differ."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Hands:
    """Poses of a gripper, the ``width`` (m) between its pads, and ``angle`` as in `Pairs`."""

    T: Float[np.ndarray, "G 4 4"]
    width: Float[np.ndarray, "G"]
    angle: Float[np.ndarray, "G"]
    reason: str = ""

    def __len__(self) -> int:
        return len(self.T)

    def some(self, chosen: np.ndarray) -> "Hands":
        """The chosen ones."""
        return Hands(T=self.T[chosen], width=self.width[chosen], angle=self.angle[chosen])

    def join(self, other: "Hands") -> "Hands":
        """These and others."""
        T, width, angle = (np.concatenate([getattr(self, name), getattr(other, name)])
                           for name in ("T", "width", "angle"))  # fmt: skip
        return Hands(T=T, width=width, angle=angle)


def close_on(package: SimPackage, target: Target, gripper: Gripper, fine: int = 1) -> Hands:
    """Poses in which a gripper closes on a target, of ``fine`` times as many pairs of contacts; none with the
    reason."""
    own = next(link.hulls for link in package.links if link.name == target.link)
    if not own:
        return _no_hands("it has no collision shape")
    normal = None if target.normal is None else np.asarray(target.normal)
    pairs = find_pairs(own, target.region, normal, fine)
    if not len(pairs):
        return _no_hands("it has no two places that face away from each other")
    spans = pairs.some(pairs.width + 2.0 * SPARE <= gripper.opening)
    if not len(spans):
        return _no_hands(
            f"its narrowest place is {1e3 * pairs.width.min():.0f} mm wide, and the gripper opens to "
            f"{1e3 * gripper.opening:.0f} mm, of which {2e3 * SPARE:.0f} mm stay free"
        )
    T, rows = gripper_poses(spans, gripper, normal)
    hands = _settle(Hands(T=T, width=spans.width[rows], angle=spans.angle[rows]), target, gripper, own)
    if not len(hands):
        return _no_hands(
            "pads would touch it on slanted faces, from which they slip, or the gripper is too narrow"
        )
    return hands


def nearby(hands: Hands, target: Target, gripper: Gripper, own: Sequence[Hull]) -> Hands:
    """Poses near those of some hands in which the gripper closes on the target as well: moved along x and z,
    turned about y and z. The random numbers are always the same."""
    rng, y, z = np.random.default_rng(0), *np.eye(3)[1:]
    move = rng.uniform(-1.0, 1.0, (len(hands), JITTERS, 4))
    T = np.tile(np.eye(4), (*move.shape[:2], 1, 1))
    T[..., :3, :3] = rotation_about(y, TILTED * move[..., 0]) @ rotation_about(z, TILTED * move[..., 1])
    T[..., 0, 3], T[..., 2, 3] = SHIFTED * move[..., 2], SHIFTED * move[..., 3]
    angle = np.minimum(hands.angle[:, None] + TILTED * np.abs(move[..., 1]), np.arctan(FRICTION))
    moved = (hands.T[:, None] @ T).reshape(-1, 4, 4)
    found = Hands(T=moved, width=np.zeros(len(moved)), angle=angle.ravel())
    return _settle(found, target, gripper, own, EVEN)


def _settle(
    hands: Hands, target: Target, gripper: Gripper, own: Sequence[Hull], cosine: float = CONE
) -> Hands:
    """The hands that hold with their pads' faces, in the middle of what they hold."""
    T, width, kept = close(hands.T, hands.width, gripper, held_hulls(own, target.region), cosine)
    return Hands(T=T, width=width, angle=hands.angle).some(kept & (width + 2.0 * SPARE <= gripper.opening))


def _no_hands(reason: str) -> Hands:
    return Hands(T=np.zeros((0, 4, 4)), width=np.zeros(0), angle=np.zeros(0), reason=reason)


def gripper_poses(
    pairs: Pairs, gripper: Gripper, normal: Float[np.ndarray, "3"] | None
) -> tuple[Float[np.ndarray, "G 4 4"], np.ndarray]:
    """Poses of a gripper that closes on pairs from `TURNS` turns, and the pair of each; the first turn of a
    pair points against ``normal`` as nearly as it can, and none comes from behind it."""
    poses, rows = [], []
    turns = np.linspace(0.0, 2.0 * np.pi, TURNS, endpoint=False)
    turns = turns if normal is None else turns[np.cos(turns) > BEHIND]
    for row, (middle, axis) in enumerate(zip(pairs.middle, pairs.axis, strict=True)):
        ahead = plane_axes(axis)[0]
        if normal is not None:
            against = (normal @ axis) * axis - normal
            length = float(np.linalg.norm(against))
            ahead = against / length if length > 0.1 else ahead
        turned = rotation_about(axis, turns) @ ahead  # A 3
        for depth in DEPTHS:
            T = np.tile(np.eye(4), (len(turns), 1, 1))
            T[:, :3, 0], T[:, :3, 1], T[:, :3, 2] = np.cross(axis, turned), axis, turned
            T[:, :3, 3] = middle - depth * gripper.pad[1, 2] * turned
            poses.append(T)
            rows.append(np.full(len(turns), row))
    return np.concatenate(poses), np.concatenate(rows)


def close(
    T: Float[np.ndarray, "G 4 4"],
    width: Float[np.ndarray, "G"],
    gripper: Gripper,
    held: Sequence[Hull],
    cosine: float = CONE,
) -> tuple[Float[np.ndarray, "G 4 4"], Float[np.ndarray, "G"], Bool[np.ndarray, "G"]]:
    """Poses and widths at which pads that close on the contacts first touch what is held: its widest place
    between them, with the gripper in its middle. And whether each
    pad then touches a face at a ``cosine`` or more, or with that of `CONE` a corner with its own face."""
    triangles = hull_triangles(held)
    spread, owner = sample_triangles(triangles, SAMPLES)
    spread = np.concatenate([spread, (INSIDE @ triangles).reshape(-1, 3)])  # narrow faces have few samples
    owner = np.concatenate([owner, np.arange(len(triangles)).repeat(len(INSIDE))])
    normals = area_normals(triangles)[owner]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)
    corners = np.concatenate([hull.vertices for hull in held])
    points = np.concatenate([corners, spread])
    local = transform_points(inverse(T), points)  # G N 3
    low, high = gripper.pad
    under = (np.abs(local[..., 1]) <= width[:, None] / 2.0 + gripper.opening) & (
        np.abs(local[..., 0]) <= high[0]
    )
    under &= (local[..., 2] >= low[2]) & (local[..., 2] <= high[2])
    facing = T[:, :3, 1] @ normals.T  # G S
    kept, ends = np.ones(len(T), dtype=bool), []
    for side in (1.0, -1.0):
        reach = np.where(under, side * local[..., 1], -np.inf)
        end = np.maximum(reach.max(axis=1), width / 2.0)
        good = np.concatenate(
            [np.full((len(T), len(corners)), cosine == CONE), side * facing >= cosine], axis=1
        )
        kept &= (good & (reach >= end[:, None] - TOUCH / 2.0)).any(axis=1)
        ends.append(end)
    moved = T.copy()
    moved[:, :3, 3] += ((ends[0] - ends[1]) / 2.0)[:, None] * T[:, :3, 1]
    return moved, ends[0] + ends[1], kept
