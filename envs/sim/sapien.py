"""Loads a package into SAPIEN strictly, with friction and damping in SI units.

SAPIEN's own loader drops collision shapes that it cannot read, assumes masses that a URDF lacks, ignores
joint friction, and needs a render device (or aborts) as soon as there is a visual. `load_package` compares
everything with the package, and skips the visuals unless they are requested. Followers and springs, which
SAPIEN lacks, act at every step of the scene.
"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from sim_export.errors import PackageError
from sim_export.package import HandleAnnotation, SimPackage

from .articulation import act_before_steps, equip, prepare, step_followers_and_springs
from .hull_cache import forget_changed_hulls
from .loaded import LinkLoad, LoadedJoint, LoadedPackage
from .mechanism import Mechanism, find_mechanism
from .urdf_text import without_visuals

if TYPE_CHECKING:
    import sapien
    from sapien.physx import PhysxArticulation


@dataclass(frozen=True, kw_only=True)
class LoadConfig:
    """Options for loading a package into a scene."""

    base: Literal["fixed", "free"] = "fixed"
    """``fixed`` fixes the object to the world, ``free`` lets it stand (or fall) freely."""

    visuals: Literal["none", "all"] = "none"
    """``all`` needs a scene with a render system; physics never needs visuals."""

    joint_resistance: Literal["package", "engine"] = "package"
    """``package`` applies the package's friction and damping exactly; ``engine`` keeps SAPIEN's
    interpretation of the URDF, as other loaders do. Joints with neither value in the package are left to the
    engine in both cases."""


def load_package(
    scene: "sapien.Scene", folder: Path, cfg: LoadConfig, package: SimPackage | None = None
) -> LoadedPackage:
    """Loads ``mobility.urdf`` of a package folder into ``scene``, at rest, with its frame at the world's.

    Args:
        scene: Scene for the articulation, with any time step.
        folder: A package, or an original PartNet-Mobility folder.
        cfg: Base, visuals and joint resistance.
        package: Content of the folder if already read.

    Raises:
        PackageError: If the folder cannot be read or the engine rejects it.
    """
    from sim_export.files.read import read_package

    if package is None:
        package = read_package(folder)
    forget_changed_hulls(folder)
    loader = scene.create_urdf_loader()
    loader.fix_root_link = cfg.base == "fixed"
    loader.load_multiple_collisions_from_file = True
    builder = _parse(loader, folder, cfg.visuals)
    package = prepare(builder, package, folder, 1 + len(scene.get_all_articulations()))
    records = {record.name: record for record in builder.link_builders}
    try:
        articulation = builder.build()
    except (RuntimeError, AssertionError) as error:
        raise PackageError(f"{folder / 'mobility.urdf'}: SAPIEN cannot build it: {error}") from error
    masses = {link.name: link.inertial.mass if link.inertial else None for link in package.links}
    links = tuple(_compare(link, records[link.name], masses.get(link.name)) for link in articulation.links)
    joints = _match_joints(articulation, package)
    mechanism = find_mechanism(package, [joint.spec.name for joint in joints])
    equip(articulation, package, resistance=cfg.joint_resistance)
    if mechanism:
        act_before_steps(scene, partial(_act, articulation, mechanism))
    order = [joint.name for joint in package.joints]
    moving = [joint for joint in joints if joint.spec.follows is None]
    moving.sort(key=lambda joint: order.index(joint.spec.name))
    return LoadedPackage(
        package=package,
        scene=scene,
        articulation=articulation,
        joints=tuple(moving),
        links=links,
        mechanism=mechanism,
    )


def _act(articulation: "PhysxArticulation", mechanism: Mechanism, scene: "sapien.Scene") -> None:
    """Moves followers and springs of an object while it is in its scene."""
    if articulation in scene.get_all_articulations():
        step_followers_and_springs(articulation, mechanism)


def _parse(loader, folder: Path, visuals: str):
    """One articulation builder from SAPIEN's URDF loader."""
    urdf = folder / "mobility.urdf"
    srdf = str(folder / "mobility.srdf")
    try:
        if visuals == "all":
            articulations, actors, _ = loader.parse(str(urdf), srdf)
        else:
            with without_visuals(urdf) as stripped:
                articulations, actors, _ = loader.parse(str(stripped), srdf)
    except PackageError:
        raise
    except Exception as error:  # SAPIEN's loader raises plain Exception, besides four other types
        raise PackageError(f"{urdf}: SAPIEN cannot parse it: {type(error).__name__}: {error}") from error
    if len(articulations) != 1 or actors:
        raise PackageError(
            f"{urdf}: {len(articulations)} articulations and {len(actors)} loose bodies, expected one "
            "articulation; write a root link and at least one joint, and no floating ones"
        )
    return articulations[0]


def _compare(link, record, mass: float | None) -> LinkLoad:
    """Compares a link with its record; links are matched by name, because SAPIEN reorders them."""
    hulls, shapes = len(record.collision_records), len(link.collision_shapes)
    lost: tuple[str, ...] = ()
    if shapes < hulls or any(not Path(entry.filename).is_file() for entry in _mesh_records(record)):
        lost = tuple(sorted(Path(entry.filename).name for entry in _mesh_records(record) if _is_lost(entry)))
    return LinkLoad(
        name=link.name, hulls=hulls, shapes=shapes, lost=lost, mass=mass, engine_mass=float(link.mass)
    )


def _mesh_records(record) -> list:
    return [entry for entry in record.collision_records if entry.type == "multiple_convex_meshes"]


def _is_lost(entry) -> bool:
    """Whether a collision mesh yields no shape at all; called only if shapes are missing."""
    from sapien.physx import PhysxCollisionShapeConvexMesh

    if not Path(entry.filename).is_file():
        return True
    try:
        shapes = PhysxCollisionShapeConvexMesh.load_multiple(
            filename=entry.filename, scale=entry.scale, material=entry.material
        )
    except RuntimeError:
        return True
    return not shapes


def _match_joints(articulation: "PhysxArticulation", package: SimPackage) -> tuple[LoadedJoint, ...]:
    specs = {joint.name: joint for joint in package.joints}
    labels = {link.name: link.label for link in package.links}
    handles: dict[str, HandleAnnotation] = {}
    for handle in package.handles:
        handles.setdefault(handle.link, handle)
    # A screw's turning joint moves the intermediate link; the labelled part with its handle follows.
    held = {spec.name: spec.child for spec in package.joints}
    held |= {
        spec.follows: spec.child for spec in package.joints if spec.follows is not None and spec.is_travel
    }
    strangers = [joint.name for joint in articulation.active_joints if joint.name not in specs]
    if strangers:
        raise PackageError(f"package {package.name!r}: SAPIEN has joints {strangers} that the package lacks")
    return tuple(
        LoadedJoint(
            spec=specs[joint.name],
            index=index,
            label=labels.get(held[joint.name]),
            handle=handles.get(held[joint.name]),
            engine=joint,
        )
        for index, joint in enumerate(articulation.active_joints)
    )
