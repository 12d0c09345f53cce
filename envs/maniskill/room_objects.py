"""Loads objects of a room into a ManiSkill scene: furniture fixed in place, its joints with friction in SI
units, and loose contents."""

from typing import TYPE_CHECKING, Any

import numpy as np
import sapien
from mani_skill.utils.structs import Pose

from envs.rooms.footprints import cached_package
from envs.rooms.room import Item, Placement, Room, pose_matrix_of
from envs.rooms.solids import item_motion
from envs.rooms.things import thing_solids

from .load import SURFACE, load_placed

if TYPE_CHECKING:
    from mani_skill.envs.scene import ManiSkillScene
    from mani_skill.utils.structs import Actor, Articulation

_ALONG_Z = np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""Turns a cylinder of SAPIEN, which lies along x, to lie along z."""


def load_placement(scene: "ManiSkillScene", placement: Placement, name: str, index: int) -> "Articulation":
    """Builds an object at its place in one of the parallel scenes, all joints at 0; raises `LoadError` if the
    engine loses a collision shape."""
    pose = Pose.create(sapien.Pose(p=list(placement.position), q=list(placement.quat)))
    return load_placed(scene, placement.package, cached_package(placement.package), name, index, pose)


def load_item(scene: "ManiSkillScene", room: Room, item: Item, name: str, index: int) -> "Actor":
    """Builds a loose thing at its place in one of the parallel scenes, as a dynamic actor."""
    builder = scene.create_actor_builder()
    material = sapien.physx.PhysxMaterial(**SURFACE)
    solids = thing_solids(item.thing, item.size)
    volume = sum(solid.volume for solid, _ in solids)
    for solid, color in solids:
        shape: dict[str, Any]
        if solid.kind == "box":
            collide, show, T = builder.add_box_collision, builder.add_box_visual, solid.T_object_shape
            shape = {"half_size": tuple(edge / 2.0 for edge in solid.sizes)}
        else:
            collide, show = builder.add_cylinder_collision, builder.add_cylinder_visual
            T = solid.T_object_shape @ _ALONG_Z
            shape = {"radius": solid.sizes[0], "half_length": solid.sizes[1] / 2.0}
        pose = sapien.Pose(T)
        collide(pose=pose, material=material, density=item.mass / volume, **shape)
        if scene.can_render():
            paint = sapien.render.RenderMaterial(base_color=[*item.colors[color], 1.0])
            show(pose=pose, material=paint, **shape)
    builder.set_scene_idxs([index])
    builder.initial_pose = item_pose(room, item)
    return builder.build(name=name)


def item_pose(room: Room, item: Item) -> Pose:
    """Pose of an item in the room, with the joints at the room's coordinates."""
    return Pose.create(sapien.Pose(item_motion(room, item) @ pose_matrix_of(item)))
