"""One object of a room in a ManiSkill scene: bolted where it stands, its joints with friction in SI units."""

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
        scene: ManiSkill's scene; visuals are built only if it can render.
        placement: package and pose.
        name: unique in the scene.
        index: which parallel scene.

    Raises:
        LoadError: If the engine loses a collision shape.
    """
    pose = Pose.create(sapien.Pose(p=list(placement.position), q=list(placement.quat)))
    return load_placed(scene, placement.package, cached_package(placement.package), name, index, pose)
