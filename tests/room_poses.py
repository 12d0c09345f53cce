"""Where the kinematics of packages put every body of a room."""

import numpy as np

from artigen.transforms import shift
from envs.rooms.footprints import cached_package
from envs.rooms.room import Room, pose_matrix_of
from envs.rooms.solids import item_motion
from sim_export.files.urdf import link_origins
from sim_export.motion.kinematics import link_displacements


def expected_poses(room: Room) -> dict[str, np.ndarray]:
    """Pose of every link and loose thing in the room, by ``cabinet_0/link_1`` and ``cup_1``."""
    poses = {item.id: item_motion(room, item) @ pose_matrix_of(item) for item in room.contents}
    for placement in room.placements:
        package = cached_package(placement.package)
        origins = link_origins(package)
        moved = link_displacements(package.links, package.joints, dict(placement.joints))
        for link, T in zip(package.links, moved, strict=True):
            poses[f"{placement.id}/{link.name}"] = pose_matrix_of(placement) @ T @ shift(origins[link.name])
    return poses
