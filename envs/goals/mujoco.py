"""The state of a room in MuJoCo, for its goals."""

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false

from typing import TYPE_CHECKING

import numpy as np

from artigen.transforms import matrix_from_quat
from envs.rooms.footprints import cached_package
from envs.rooms.room import Room

from .goal import State

if TYPE_CHECKING:
    from mujoco import MjData


def read_mujoco_state(room: Room, data: "MjData", base: str | None = None) -> State:
    """Coordinates of all joints and poses of all things of the room of a ``scene.xml``, and where the body
    ``base`` of a robot is."""
    joints = {
        (placement.id, joint.name): float(data.joint(f"{placement.id}/{joint.name}").qpos[0])
        for placement in room.placements
        for joint in cached_package(placement.package).joints
        if joint.type != "fixed"
    }
    items = {}
    for item in room.contents:
        qpos = data.joint(item.id).qpos
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = matrix_from_quat(np.array(qpos[3:])), qpos[:3]
        items[item.id] = T
    at = None if base is None else data.body(base).xpos
    return State(joints=joints, items=items, base=None if at is None else (float(at[0]), float(at[1])))
