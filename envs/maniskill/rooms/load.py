"""One object of a room in a ManiSkill scene: bolted where it stands, its joints with friction in SI units.

Screws stay as they are: the engine couples their two joints by a tendon that gains energy.
"""

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import sapien
from mani_skill.utils import sapien_utils
from mani_skill.utils.structs import Pose

from sim_export.errors import PackageError
from sim_export.package import SimPackage

from ...friction import apply_damping, apply_friction, apply_velocity
from ...urdf_text import physics_urdf
from .footprints import cached_package
from .room import Placement

if TYPE_CHECKING:
    from mani_skill.envs.scene import ManiSkillScene
    from mani_skill.utils.structs import Articulation

SURFACE = {"static_friction": 1.0, "dynamic_friction": 1.0, "restitution": 0.0}
"""Contact material, as that of ManiSkill's own cabinets."""


def load_placement(scene: "ManiSkillScene", placement: Placement, name: str, index: int) -> "Articulation":
    """Builds an object at its place in one of the parallel scenes, all joints at 0.

    Args:
        scene: ManiSkill's scene; visuals are built only if it can render.
        placement: package and pose.
        name: unique in the scene.
        index: which parallel scene.

    Raises:
        PackageError: If the engine loses a collision shape.
    """
    package = cached_package(placement.package)
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    loader.load_multiple_collisions_from_file = True
    sapien_utils.apply_urdf_config(loader, sapien_utils.parse_urdf_config({"material": SURFACE}))
    urdf, srdf = placement.package / "mobility.urdf", str(placement.package / "mobility.srdf")
    if scene.can_render():
        builder = loader.parse(str(urdf), srdf)["articulation_builders"][0]
    else:
        with tempfile.TemporaryDirectory() as scratch:
            stripped = Path(scratch) / "mobility.urdf"
            stripped.write_text(physics_urdf(urdf))
            builder = loader.parse(str(stripped), srdf)["articulation_builders"][0]
    screws = {joint.name for joint in package.joints if joint.kind == "screw" or joint.mimic is not None}
    screws |= {joint.mimic for joint in package.joints if joint.mimic is not None}
    for link in builder.link_builders:
        if link.joint_record.name in screws:
            link.joint_record.joint_type = "fixed"
    builder.set_scene_idxs([index])
    builder.initial_pose = Pose.create(sapien.Pose(p=list(placement.position), q=list(placement.quat)))
    articulation = builder.build(name=name, build_mimic_joints=False)
    prefix = f"scene-{index}-{name}_"
    _compare(articulation, package, placement, prefix)
    _apply_resistance(articulation, package, prefix)
    return articulation


def _compare(articulation: "Articulation", package: SimPackage, placement: Placement, prefix: str) -> None:
    wanted = {link.name: len(link.hulls) for link in package.links}
    for link in articulation._objs[0].links:
        name = link.name.removeprefix(prefix)
        if len(link.collision_shapes) < wanted[name]:
            raise PackageError(
                f"{placement.package}: link {name!r} has {len(link.collision_shapes)} collision shapes in "
                f"the engine, the package has {wanted[name]}; run artigen validate on it"
            )


def _apply_resistance(articulation: "Articulation", package: SimPackage, prefix: str) -> None:
    specs = {joint.name: joint for joint in package.joints}
    for engine in articulation._objs:
        for joint in engine.active_joints:
            spec = specs[joint.name.removeprefix(prefix)]
            if spec.friction == 0.0 and spec.damping == 0.0:
                continue
            apply_friction(joint, spec.friction)
            apply_damping(engine, joint, spec.damping)
            if spec.velocity > 0.0:
                apply_velocity(joint, spec.velocity)
