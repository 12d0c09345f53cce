"""Loads a room into a ManiSkill scene: fixtures with their patterns, furniture fixed in place, its joints
with friction in SI units, and loose contents."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import sapien
from mani_skill.utils.structs import Pose

from artigen.splats.colors import linear_from_srgb
from envs.rooms.covers import write_cover_obj
from envs.rooms.footprints import cached_package
from envs.rooms.room import Fixture, Item, Placement
from envs.rooms.solids import fixture_shape
from envs.rooms.things import Color, thing_solids
from sim_export.geometry.primitives import PrimitiveShape

from .load import SURFACE, load_placed

if TYPE_CHECKING:
    from mani_skill.envs.scene import ManiSkillScene
    from mani_skill.utils.building.actor_builder import ActorBuilder
    from mani_skill.utils.structs import Actor, Articulation

_ALONG_Z = np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""Turns a cylinder of SAPIEN, which lies along x, to lie along z."""


def load_placement(scene: "ManiSkillScene", placement: Placement, name: str, index: int) -> "Articulation":
    """Builds an object at its place in one of the parallel scenes, all joints at 0; raises `LoadError` if the
    engine loses a collision shape."""
    pose = Pose.create(sapien.Pose(p=list(placement.position), q=list(placement.quat)))
    return load_placed(scene, placement.package, cached_package(placement.package), name, index, pose)


def load_fixture(scene: "ManiSkillScene", fixture: Fixture, name: str, index: int, covers: Path) -> "Actor":
    """Builds a fixture as a static actor in one of the parallel scenes.

    Where the scene can render, the files of its pattern are written to the folder ``covers``, from which the
    engine reads them at the first picture.
    """
    builder = scene.create_actor_builder()
    shape = fixture_shape(fixture)
    _add_primitive(builder, shape, None, None if fixture.pattern != "plain" else fixture.color, scene)
    builder.set_scene_idxs([index])
    builder.initial_pose = Pose.create(sapien.Pose())
    if fixture.pattern != "plain" and scene.can_render():
        covers.mkdir(parents=True, exist_ok=True)
        builder.add_visual_from_file(str(write_cover_obj(fixture, covers)))
    return builder.build_static(name=name)


def load_item(scene: "ManiSkillScene", item: Item, pose: Pose, name: str, index: int) -> "Actor":
    """Builds a loose thing at a pose in one of the parallel scenes, as a dynamic actor."""
    builder = scene.create_actor_builder()
    solids = thing_solids(item.thing, item.size)
    volume = sum(solid.volume for solid, _ in solids)
    for solid, color in solids:
        _add_primitive(builder, solid, item.mass / volume, item.colors[color], scene)
    builder.set_scene_idxs([index])
    builder.initial_pose = pose
    return builder.build(name=name)


def _add_primitive(
    builder: "ActorBuilder",
    solid: PrimitiveShape,
    density: float | None,
    color: Color | None,
    scene: "ManiSkillScene",
) -> None:
    """Adds a box or cylinder that collides, and is seen in a colour if one is given and the scene renders."""
    shape: dict[str, Any]
    if solid.kind == "box":
        collide, show, T = builder.add_box_collision, builder.add_box_visual, solid.T_object_shape
        shape = {"half_size": tuple(edge / 2.0 for edge in solid.sizes)}
    else:
        collide, show = builder.add_cylinder_collision, builder.add_cylinder_visual
        T = solid.T_object_shape @ _ALONG_Z
        shape = {"radius": solid.sizes[0], "half_length": solid.sizes[1] / 2.0}
    pose = sapien.Pose(T)
    dense = {} if density is None else {"density": density}
    collide(pose=pose, material=sapien.physx.PhysxMaterial(**SURFACE), **dense, **shape)
    if color is not None and scene.can_render():
        paint = [*linear_from_srgb(np.array(color)).tolist(), 1.0]
        show(pose=pose, material=sapien.render.RenderMaterial(base_color=paint), **shape)
