"""Surface points of a robot arm's links, and their clearance from obstacles."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.transforms import inverse, transform_points
from sim_export.geometry.hulls import convex_hull

from ...hand import pose_matrix, shape_vertices
from .chain import Chain, held_motion, joint_frames
from .field import Field, distances

if TYPE_CHECKING:
    from sapien.physx import PhysxArticulation, PhysxArticulationLinkComponent

SPACING = 0.03
"""Spacing of points, metres; on the hand, which comes closer to objects, half of it."""
ARM_GAP = 0.016
HAND_GAP = 0.008
"""Clearance of arm and hand from everything, metres, beyond the field's accuracy of half a cell."""
BLOCK = 400
"""Number of arm poses processed together."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """Points in the frame after the turning joint ``carrier``, and the clearance that each of them needs."""

    points: Float[np.ndarray, "P 3"]
    carrier: Int[np.ndarray, "P"]
    gap: Float[np.ndarray, "P"]

    def some(self, chosen: Bool[np.ndarray, "P"], gap: float) -> "Body":
        """The chosen points, which all need the same clearance."""
        return Body(
            points=self.points[chosen], carrier=self.carrier[chosen], gap=np.full(int(chosen.sum()), gap)
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Obstacle:
    """A solid, and the pose of the robot's root in its frame.

    ``T_field_root`` is one pose, or one per arm pose for obstacles that move with the arm.
    """

    field: Field
    T_field_root: Float[np.ndarray, "*B 4 4"]


def read_body(
    articulation: "PhysxArticulation",
    chain: Chain,
    hand: tuple[str, ...],
    spacing: float = SPACING,
    *,
    closed: bool = False,
) -> Body:
    """Surface points of everything that the chain's joints move, in the engine's current state.

    Args:
        hand: Suffixes of the names of links that may come close to objects.
        spacing: Spacing of the points, metres.
        closed: Assume closed fingers, regardless of their current position.
    """
    names = [joint.name for joint in articulation.active_joints]
    coordinates = dict(zip(names, np.asarray(articulation.qpos, dtype=np.float64).tolist(), strict=True))
    if closed:
        coordinates |= {name: 0.0 for name in names if "finger" in name}
    movers = [names[column] for column in chain.columns]
    points, carriers, gaps = [], [], []
    for link in articulation.links:
        carrier, T = _carried(link, movers, coordinates)
        if carrier is None or not link.collision_shapes:
            continue
        near = link.name.endswith(hand)
        for shape in link.collision_shapes:
            found = surface_points(shape_vertices(shape), spacing / 2.0 if near else spacing)
            points.append(transform_points(T, found))
            carriers.append(np.full(len(found), carrier))
            gaps.append(np.full(len(found), HAND_GAP if near else ARM_GAP))
    return Body(points=np.concatenate(points), carrier=np.concatenate(carriers), gap=np.concatenate(gaps))


def holding(body: Body, chain: Chain, held: Float[np.ndarray, "V 3"], gap: float) -> Body:
    """The body with an object in its hand, given as corner points in the tool frame."""
    found = transform_points(chain.tool, surface_points(held, SPACING / 2.0))
    last = np.full(len(found), len(chain.before) - 1)
    return Body(
        points=np.concatenate([body.points, found]),
        carrier=np.concatenate([body.carrier, last]),
        gap=np.concatenate([body.gap, np.full(len(found), gap)]),
    )


def body_points(chain: Chain, body: Body, q: Float[np.ndarray, "B J"]) -> Float[np.ndarray, "B P 3"]:
    """The points in the frame of the robot's root."""
    frames = joint_frames(chain, q)
    points = np.empty((len(q), len(body.points), 3))
    for carrier in np.unique(body.carrier):
        mine = body.carrier == carrier
        points[:, mine] = transform_points(frames[:, carrier], body.points[mine])
    return points


def spare_room(
    chain: Chain, body: Body, obstacles: tuple[Obstacle, ...], q: Float[np.ndarray, "B J"]
) -> Float[np.ndarray, "B"]:
    """Smallest clearance beyond the required one over all points, metres; negative if an obstacle is too
    close."""
    out = [np.zeros(0)]
    for begin in range(0, len(q), BLOCK):
        points = body_points(chain, body, q[begin : begin + BLOCK])
        least = np.full(len(points), np.inf)
        for obstacle in obstacles:
            T = obstacle.T_field_root
            T = T if T.ndim == 2 else T[begin : begin + BLOCK]
            near = distances(obstacle.field, transform_points(T, points)) - body.gap
            least = np.minimum(least, near.min(axis=1))
        out.append(least)
    return np.concatenate(out)


def is_free(
    chain: Chain, body: Body, obstacles: tuple[Obstacle, ...], q: Float[np.ndarray, "B J"]
) -> Bool[np.ndarray, "B"]:
    """Whether each arm pose keeps all clearances."""
    return spare_room(chain, body, obstacles, q) >= 0.0


def surface_points(vertices: Float[np.ndarray, "V 3"], spacing: float) -> Float[np.ndarray, "N 3"]:
    """Points on the convex hull of ``vertices``, at most about ``spacing`` metres apart."""
    hull = convex_hull(vertices)
    faces = [triangle_points(corners, spacing, 0.0) for corners in hull.vertices[hull.faces]]
    points = np.concatenate([hull.vertices, *faces])
    return points[first_of_each(np.rint(points / spacing))]


def triangle_points(
    corners: Float[np.ndarray, "3 3"], spacing: float, offset: float
) -> Float[np.ndarray, "N 3"]:
    """Points of a grid on a triangle, at most about ``spacing`` metres apart; the grid begins ``offset``
    steps away from two of the sides."""
    a, b, c = corners
    longest = max(np.linalg.norm(b - a), np.linalg.norm(c - a), np.linalg.norm(c - b))
    count = int(np.ceil(longest / spacing))
    steps = (np.arange(count + 1) + offset) / count
    u, v = np.meshgrid(steps, steps)
    inside = u + v <= 1.0 + 1e-9
    return a + u[inside, None] * (b - a) + v[inside, None] * (c - a)


def first_of_each(rows: Float[np.ndarray, "N K"]) -> Int[np.ndarray, "M"]:
    """Indices of the first of equal rows, in order."""
    return np.sort(np.unique(rows, axis=0, return_index=True)[1])


def _carried(
    link: "PhysxArticulationLinkComponent", movers: list[str], coordinates: dict[str, float]
) -> tuple[int | None, Float[np.ndarray, "4 4"]]:
    """The last of the joints ``movers`` before a link, and the link's pose in the frame after it."""
    T = np.eye(4)
    while link.parent is not None:
        joint = link.joint
        T = inverse(pose_matrix(joint.pose_in_child)) @ T
        if joint.name in movers:
            return movers.index(joint.name), T
        if joint.name in coordinates:
            T = held_motion(joint.type, coordinates[joint.name]) @ T
        T = pose_matrix(joint.pose_in_parent) @ T
        link = link.parent
    return None, T
