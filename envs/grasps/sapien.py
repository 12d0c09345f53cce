"""Trials of grasps in SAPIEN."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.transforms import frame_along, inverse, quat_from_matrix, transform_points
from sim_export.grasps.pairs import FRICTION
from sim_export.package import Proof, SimPackage

from ..hand import pose_matrix
from ..sim.sapien import LoadConfig, load_package
from ..sim.scene import DEFAULT_MATERIAL, create_scene
from .rail import (
    ARMATURE,
    FINGER_GAINS,
    FINGER_MASS,
    LOOK,
    PALM_MASS,
    RAIL_GAINS,
    Rail,
)

if TYPE_CHECKING:
    import sapien
    from sapien.physx import PhysxArticulation

TIMESTEP = 0.005
FINGERS = ("finger_left", "finger_right")


class SapienTrials:
    """A package in a scene of its own, in which grippers try grasps one after the other."""

    engine = "sapien"

    def __init__(self, folder: Path, package: SimPackage, *, loose: bool) -> None:
        self.scene = create_scene(TIMESTEP, ground=loose)
        self.loaded = load_package(self.scene, folder, LoadConfig(base="free" if loose else "fixed"), package)
        low = min(hull.vertices[:, 2].min() for link in package.links for hull in link.hulls)
        self.rest = np.array([0.0, 0.0, -low if loose else 0.0])

    def prove(self, rail: Rail) -> Proof:
        """Closes the fingers, carries the gripper along its rail, and measures what came with it."""
        import sapien

        self.loaded.articulation.set_root_pose(sapien.Pose(self.rest.tolist()))
        self.loaded.articulation.set_root_linear_velocity([0.0, 0.0, 0.0])
        self.loaded.articulation.set_root_angular_velocity([0.0, 0.0, 0.0])
        self.loaded.reset(rail.needs)
        hand = build_hand(self.scene, rail, self.rest)
        try:
            return self._try(hand, rail)
        finally:
            self.scene.remove_articulation(hand)

    def _try(self, hand: "PhysxArticulation", rail: Rail) -> Proof:
        turn, slide, *fingers = hand.active_joints
        touched: set[str] = set()
        steps = round(rail.seconds / TIMESTEP)
        for step in range(steps):
            share = rail.share(step * TIMESTEP)
            hand.set_qf(np.array([0.0, 0.0, *[rail.press(step * TIMESTEP)] * 2], dtype=np.float32))
            turn.set_drive_target(share * rail.turn)
            slide.set_drive_target(share * rail.slide)
            middle = float(hand.qpos[2:].mean())
            for finger in fingers:
                finger.set_drive_target(middle)
            self.loaded.step()
            if (steps - step) * TIMESTEP <= LOOK:
                touched |= self._touching(rail.link)
        return Proof(engine=self.engine, opened=self._opened(rail), held=touched >= set(FINGERS))

    def _opened(self, rail: Rail) -> float:
        if rail.joint:
            return (self.loaded.positions()[rail.joint] - rail.lower) / rail.span
        link = next(link for link in self.loaded.articulation.links if link.name == rail.link)
        at = transform_points(pose_matrix(link.entity_pose), rail.point[None])[0]
        return float(at[2] - rail.start[2, 3] - self.rest[2]) / rail.span

    def _touching(self, link: str) -> set[str]:
        """Fingers in contact with a link."""
        found = set()
        for contact in self.scene.get_contacts():
            names = {body.entity.name for body in contact.bodies}
            if link in names and any(np.linalg.norm(point.impulse) > 0.0 for point in contact.points):
                found |= names & set(FINGERS)
        return found


def build_hand(scene: "sapien.Scene", rail: Rail, offset: Float[np.ndarray, "3"]) -> "PhysxArticulation":
    """A gripper on its rail, open; ``offset`` is the place of the object's frame in the world."""
    import sapien

    gripper = rail.gripper
    pads = 2.0 * FRICTION - DEFAULT_MATERIAL[0]  # PhysX takes the mean of both
    rubber = scene.create_physical_material(pads, pads, 0.0)
    J = np.eye(4)
    J[:3, :3] = np.roll(frame_along(rail.axis), 1, axis=0).T  # x along the axis
    J[:3, 3] = rail.origin + offset
    T_world_hand = rail.start.copy()
    T_world_hand[:3, 3] += offset
    T_hand = inverse(J) @ T_world_hand
    builder = scene.create_articulation_builder()
    links = [builder.create_link_builder()]
    links[0].set_name("rail")
    links[0].set_joint_properties("fixed", [], sapien.Pose(), sapien.Pose())
    for name, kind in (("turn", "revolute_unwrapped"), ("palm", "prismatic")):
        link = builder.create_link_builder(links[-1])
        link.set_name(name)
        link.set_joint_name(name)
        link.set_joint_properties(kind, [[-np.inf, np.inf]], sapien.Pose(), sapien.Pose())
        links.append(link)
    for low, high in gripper.palm:
        links[2].add_box_collision(_pose(T_hand, (low + high) / 2.0), (high - low) / 2.0, rubber)
    for name, side in zip(FINGERS, (1.0, -1.0), strict=True):
        R = np.array([[0.0, -side, 0.0], [side, 0.0, 0.0], [0.0, 0.0, 1.0]])  # x outwards
        frame = np.eye(4)
        frame[:3, :3] = R
        link = builder.create_link_builder(links[2])
        link.set_name(name)
        link.set_joint_name(name)
        link.set_joint_properties(
            "prismatic",
            [[0.0, gripper.opening / 2.0]],
            sapien.Pose(T_hand @ frame),
            sapien.Pose(),
        )
        for low, high in gripper.finger:
            middle, half = (low + high) / 2.0, (high - low) / 2.0
            link.add_box_collision(
                sapien.Pose([middle[1], -middle[0], middle[2]]), (half[1], half[0], half[2]), rubber
            )
        links.append(link)
    masses = (1.0, 1.0, PALM_MASS, FINGER_MASS, FINGER_MASS)
    for link, mass in zip(links, masses, strict=True):
        center = _pose(T_hand, np.zeros(3)) if link is links[2] else sapien.Pose()
        link.set_mass_and_inertia(mass, center, [1e-3 * mass] * 3)
    builder.initial_pose = sapien.Pose(J)
    hand = builder.build()
    for link in hand.links:
        link.disable_gravity = True
    turn, slide, *fingers = hand.active_joints
    for joint in (turn, slide):
        joint.set_armature(np.array([ARMATURE], dtype=np.float32))
        joint.set_drive_properties(*RAIL_GAINS)
    for finger in fingers:
        finger.set_drive_properties(*FINGER_GAINS)
    hand.set_qpos(np.array([0.0, 0.0, *[rail.gap / 2.0] * 2], dtype=np.float32))
    return hand


def _pose(T: Float[np.ndarray, "4 4"], point: Float[np.ndarray, "3"]) -> "sapien.Pose":
    """A pose in the frame ``T``, at a point in it."""
    import sapien

    return sapien.Pose((T[:3, :3] @ point + T[:3, 3]).tolist(), quat_from_matrix(T[:3, :3]).tolist())
