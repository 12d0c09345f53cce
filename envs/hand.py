"""Forces that a hand applies to a joint: magnitude, place and direction.

A person pulls a drawer with at most 30 N and turns a door with at most 20 N m, and never with more than 30 N
at its handle, which limits the torque on small lids. Fingers push a button with 10 N and turn a knob with 10
N at its rim and at most 1 N m. The hand also carries the weight of what it lifts, because packages do not
model the springs and counterweights of appliances.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.transforms import rotation_about, transform_points
from sim_export.physics.materials import GRAVITY

from .sim.loaded import LoadedJoint, moving_links

if TYPE_CHECKING:
    import sapien
    from sapien.physx import PhysxArticulationLinkComponent, PhysxCollisionShape

PULL = 30.0
"""Largest force (N) on a drawer, or at the handle of a turning part."""
TURN = 20.0
"""Largest torque (N m) on a door, lid or wheel: 22 N at the handle of a door 0.9 m wide, the most that
interior doors may need (2010 ADA Standards, 404.2.9)."""
PUSH = 10.0
"""Largest force (N) of fingers, on a button or at the rim of a knob."""
TWIST = 1.0
"""Largest torque (N m) of fingers on a knob."""
FINGER_LABELS = ("knob",)
ON_AXIS = 0.01
"""A handle whose middle is nearer to the axis (m), such as a cross on a tap, is turned at its rim."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Moved:
    """Everything that a joint moves, in the world at the current pose: mass, centre, hull vertices.

    ``inertia`` is about the joint's axis (kg m^2); ``axis`` and ``origin`` are the joint's.
    """

    mass: float
    com: Float[np.ndarray, "3"]
    inertia: float
    vertices: Float[np.ndarray, "V 3"]
    axis: Float[np.ndarray, "3"]
    origin: Float[np.ndarray, "3"]


def pose_matrix(pose: "sapien.Pose") -> Float[np.ndarray, "4 4"]:
    """A SAPIEN pose (single precision) as a matrix."""
    return np.asarray(pose.to_transformation_matrix(), dtype=np.float64)


def link_vertices(link: "PhysxArticulationLinkComponent") -> Float[np.ndarray, "V 3"]:
    """Vertices of a link's collision shapes in its own frame, metres."""
    return np.concatenate([np.zeros((0, 3)), *(shape_vertices(shape) for shape in link.collision_shapes)])


def shape_vertices(shape: "PhysxCollisionShape") -> Float[np.ndarray, "V 3"]:
    """Vertices of one collision shape in its link's frame, metres."""
    return transform_points(pose_matrix(shape.local_pose), _shape_points(shape))


def measure_moved(joint: LoadedJoint) -> Moved:
    """Mass properties of everything that ``joint`` moves at the current pose."""
    frame = pose_matrix(joint.engine.global_pose)
    axis, origin = frame[:3, 0], frame[:3, 3]  # the axis of a SAPIEN joint is the x axis of its frame
    masses, centers, inertias, vertices = [], [], [], [np.zeros((0, 3))]
    for link in moving_links(joint):
        T = pose_matrix(link.entity_pose)
        principal = T @ pose_matrix(link.cmass_local_pose)
        arm = np.cross(axis, principal[:3, 3] - origin)
        along = principal[:3, :3].T @ axis
        masses.append(float(link.mass))
        centers.append(principal[:3, 3])
        inertias.append(float(along @ (np.asarray(link.inertia) * along)) + link.mass * float(arm @ arm))
        vertices.append(transform_points(T, link_vertices(link)))
    mass = sum(masses)
    com = np.average(centers, axis=0, weights=masses) if mass > 0 else origin
    return Moved(
        mass=mass,
        com=com,
        inertia=sum(inertias),
        vertices=np.concatenate(vertices),
        axis=axis,
        origin=origin,
    )


def hand_effort(joint: LoadedJoint, moved: Moved) -> float:
    """Largest effort of a hand on a joint: N for sliding joints, N m for turning ones."""
    fingers = joint.label in FINGER_LABELS
    if joint.spec.type == "prismatic":
        return PUSH if fingers else PULL
    lever = _lever(joint, moved)
    return min(TWIST, PUSH * lever) if fingers else min(TURN, PULL * lever)


def weight_effort(joint: LoadedJoint, moved: Moved, q: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N"]:
    """Effort of gravity on the joint at coordinates ``q`` from the current pose: > 0 opens."""
    weight = np.array([0.0, 0.0, -GRAVITY * moved.mass])
    if joint.spec.type == "prismatic":
        return np.full(len(q), float(weight @ moved.axis))
    arms = rotation_about(moved.axis, q) @ (moved.com - moved.origin)
    return np.cross(arms, weight) @ moved.axis


def push_wrench(joint: LoadedJoint, axis: Float[np.ndarray, "3"], effort: float) -> tuple:
    """Force and torque on the child link, in SAPIEN's convention, that act on the joint with ``effort``.

    A force at the handle differs from this wrench only in the reaction of the joint's bearing.
    """
    vector = (effort * axis).astype(np.float32)
    zero = np.zeros(3, dtype=np.float32)
    return (vector, zero) if joint.spec.type == "prismatic" else (zero, vector)


def _lever(joint: LoadedJoint, moved: Moved) -> float:
    """Distance from the axis at which a hand grasps: that of the handle, else of the farthest point."""
    if joint.handle is None:
        axis, arms = moved.axis, moved.vertices - moved.origin
    else:
        # Fingers hold a knob at its rim, a hand holds other handles in their middle.
        axis, arms = joint.spec.axis, joint.handle.corners - joint.spec.origin
        middle = float(np.linalg.norm(np.cross(axis, arms.mean(axis=0))))
        if joint.label not in FINGER_LABELS and middle >= ON_AXIS:
            return middle
    return float(np.linalg.norm(np.cross(axis, arms), axis=1).max(initial=0.0))


def _shape_points(shape) -> np.ndarray:
    """Corners of a collision shape before its local pose."""
    import sapien.physx as physx

    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
    match shape:
        case physx.PhysxCollisionShapeConvexMesh() | physx.PhysxCollisionShapeTriangleMesh():
            return np.asarray(shape.vertices, dtype=np.float64) * np.asarray(shape.scale)
        case physx.PhysxCollisionShapeBox():
            return signs * np.asarray(shape.half_size)
        case physx.PhysxCollisionShapeSphere():
            return signs * shape.radius
        case physx.PhysxCollisionShapeCylinder():  # SAPIEN's cylinder is a prism of 32 sides along x
            turns = np.linspace(0.0, 2 * np.pi, 32, endpoint=False)
            rim = shape.radius * np.column_stack([np.cos(turns), np.sin(turns)])
            ends = [np.column_stack([np.full(32, side * shape.half_length), rim]) for side in (-1, 1)]
            return np.concatenate(ends)
        case physx.PhysxCollisionShapeCapsule():
            return signs * np.array([shape.half_length, shape.radius, shape.radius])
    raise TypeError(f"collision shape {type(shape).__name__} has no corners")
