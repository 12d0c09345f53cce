"""Loads one object of a room into a ManiSkill scene: fixed in place, its joints with friction in SI units."""

from typing import TYPE_CHECKING

import sapien
from mani_skill.utils.structs import Pose

from ..load import load_placed
from .footprints import cached_package
from .room import Placement

if TYPE_CHECKING:
    from mani_skill.envs.scene import ManiSkillScene
    from mani_skill.utils.structs import Articulation


def load_placement(scene: "ManiSkillScene", placement: Placement, name: str, index: int) -> "Articulation":
    """Builds an object at its place in one of the parallel scenes, all joints at 0.

    Args:
        scene: ManiSkill scene; visuals are built only if it can render.
        placement: Package and pose.
        name: Unique name in the scene.
        index: Index of the parallel scene.

    Raises:
        LoadError: If the engine loses a collision shape.
    """
    pose = Pose.create(sapien.Pose(p=list(placement.position), q=list(placement.quat)))
    return load_placed(scene, placement.package, cached_package(placement.package), name, index, pose)
