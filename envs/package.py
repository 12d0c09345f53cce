"""A package in SAPIEN: loaded strictly, with friction and damping in SI units, and nothing lost silently.

SAPIEN's own loader drops collision shapes that it cannot read, invents masses where a URDF has none,
ignores joint friction, and needs (or aborts without) a render device as soon as there is a visual.
`load_package` counts and compares everything, and leaves the visuals out unless asked for them.
"""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Float

from sim_export.errors import PackageError
from sim_export.package import HandleAnnotation, PackageJoint, SimPackage

from .friction import apply_damping, apply_friction
from .urdf_text import physics_urdf

if TYPE_CHECKING:
    import sapien
    from sapien.physx import PhysxArticulation, PhysxArticulationJoint, PhysxArticulationLinkComponent


@dataclass(frozen=True, kw_only=True)
class LoadConfig:
    """How a package is put into a scene."""

    base: Literal["fixed", "free"] = "fixed"
    """``fixed`` bolts the object to the world, ``free`` lets it stand (or fall) on its own."""

    visuals: Literal["none", "all"] = "none"
    """``all`` needs a scene with a render system; physics never needs visuals."""

    joint_resistance: Literal["package", "engine"] = "package"
    """``package`` applies the package's friction and damping exactly; ``engine`` leaves what SAPIEN
    makes of the URDF, which is how other loaders will see it. Joints that carry neither value in
    the package are left to the engine in both."""


@dataclass(frozen=True, kw_only=True)
class LinkLoad:
    """What the URDF says about a link and what the engine made of it; ``None`` mass: none authored."""

    name: str
    hulls: int
    shapes: int
    lost: tuple[str, ...]
    mass: float | None
    engine_mass: float


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadedJoint:
    """A joint with its engine counterpart; ``index`` is its place in the articulation's ``qpos``."""

    spec: PackageJoint
    index: int
    label: str | None
    handle: HandleAnnotation | None
    engine: "PhysxArticulationJoint"

    @property
    def limited(self) -> bool:
        """False for wheels and other joints that turn for ever."""
        return self.spec.type != "continuous"

    @property
    def span(self) -> float:
        """Length of the range (m or rad); a full turn where there are no limits."""
        return self.spec.upper - self.spec.lower if self.limited else 2.0 * np.pi


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadedPackage:
    """A package in a scene. ``joints`` are those that move on their own, screw followers left out, in
    the order of the package."""

    package: SimPackage
    folder: Path
    articulation: "PhysxArticulation"
    joints: tuple[LoadedJoint, ...]
    links: tuple[LinkLoad, ...]

    def joint(self, name: str) -> LoadedJoint:
        """The joint of that name; raises `ValueError` naming those that exist."""
        for joint in self.joints:
            if joint.spec.name == name:
                return joint
        known = ", ".join(joint.spec.name for joint in self.joints)
        raise ValueError(f"package {self.package.name!r} has no joint {name!r}; it has {known or 'none'}")


def load_package(
    scene: "sapien.Scene", folder: Path, cfg: LoadConfig, package: SimPackage | None = None
) -> LoadedPackage:
    """Loads ``mobility.urdf`` of a package folder into ``scene``, at rest, its frame on the world's.

    Args:
        scene: where the articulation is built; its time step is the caller's business.
        folder: the package; an original PartNet-Mobility folder will do.
        cfg: base, visuals and joint resistance.
        package: the folder's content where it has been read already.

    Raises:
        PackageError: if the folder cannot be read or the engine refuses it.
    """
    from sim_export.read import read_package

    if package is None:
        package = read_package(folder)
    loader = scene.create_urdf_loader()
    loader.fix_root_link = cfg.base == "fixed"
    loader.load_multiple_collisions_from_file = True
    builder = _parse(loader, folder, cfg.visuals)
    records = {record.name: record for record in builder.link_builders}
    try:
        articulation = builder.build()
    except (RuntimeError, AssertionError) as error:
        raise PackageError(f"{folder / 'mobility.urdf'}: SAPIEN cannot build it: {error}") from error
    masses = {link.name: link.inertial.mass if link.inertial else None for link in package.links}
    links = tuple(_compare(link, records[link.name], masses.get(link.name)) for link in articulation.links)
    joints = _match_joints(articulation, package)
    if cfg.joint_resistance == "package":
        for joint in joints:
            _apply_resistance(articulation, joint)
    order = [joint.name for joint in package.joints]
    moving = [joint for joint in joints if joint.spec.mimic is None]
    moving.sort(key=lambda joint: order.index(joint.spec.name))
    return LoadedPackage(
        package=package, folder=folder, articulation=articulation, joints=tuple(moving), links=links
    )


def set_open_fraction(loaded: LoadedPackage, fraction: float | Sequence[float]) -> Float[np.ndarray, "Q"]:
    """Poses every joint at a fraction of its range, at rest; returns the articulation's ``qpos``.

    Args:
        loaded: the object.
        fraction: 0 is the lower limit and 1 the upper; one number for all joints or one per joint
            of ``loaded.joints``. A joint without limits takes it as part of a full turn.
    """
    count = len(loaded.joints)
    values = np.broadcast_to(np.asarray(fraction, dtype=np.float64), (count,))
    if ((values < 0.0) | (values > 1.0)).any():
        raise ValueError(f"open fraction {values.tolist()}: must lie in [0, 1]")
    q = {
        joint.spec.name: (joint.spec.lower if joint.limited else 0.0) + value * joint.span
        for joint, value in zip(loaded.joints, values, strict=True)
    }
    qpos = qpos_of(loaded, q)
    loaded.articulation.set_qpos(qpos.astype(np.float32))
    loaded.articulation.set_qvel(np.zeros(len(qpos), dtype=np.float32))
    return qpos


def qpos_of(loaded: LoadedPackage, coordinates: dict[str, float]) -> Float[np.ndarray, "Q"]:
    """The articulation's ``qpos`` for joint coordinates by name; the others are 0, followers follow."""
    qpos = np.zeros(loaded.articulation.dof)
    specs = {joint.name: joint for joint in loaded.package.joints}
    for index, joint in enumerate(loaded.articulation.active_joints):
        spec = specs[joint.name]
        if spec.mimic is not None:
            qpos[index] = spec.mimic_multiplier * coordinates.get(spec.mimic, 0.0)
        else:
            qpos[index] = coordinates.get(joint.name, 0.0)
    return qpos


def _parse(loader, folder: Path, visuals: str):
    """One articulation builder out of SAPIEN's URDF loader."""
    urdf = folder / "mobility.urdf"
    srdf = str(folder / "mobility.srdf")
    try:
        if visuals == "all":
            articulations, actors, _ = loader.parse(str(urdf), srdf)
        else:
            text = physics_urdf(urdf)
            with tempfile.TemporaryDirectory() as scratch:
                stripped = Path(scratch) / "mobility.urdf"
                stripped.write_text(text)
                articulations, actors, _ = loader.parse(str(stripped), srdf)
    except PackageError:
        raise
    except Exception as error:  # SAPIEN's loader raises the bare class, besides four others
        raise PackageError(f"{urdf}: SAPIEN cannot parse it: {type(error).__name__}: {error}") from error
    if len(articulations) != 1 or actors:
        raise PackageError(
            f"{urdf}: {len(articulations)} articulations and {len(actors)} loose bodies, expected one "
            "articulation; write a root link and at least one joint, and no floating ones"
        )
    return articulations[0]


def _compare(link, record, mass: float | None) -> LinkLoad:
    """What became of a link; SAPIEN orders links otherwise than their builders, so they meet by name."""
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
    """Whether a collision mesh gives no shape at all; asked only where shapes are missing."""
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
    # What a screw turns is the carrier; the part with a meaning and a handle is what follows it.
    held = {spec.name: spec.child for spec in package.joints}
    held |= {spec.mimic: spec.child for spec in package.joints if spec.mimic is not None}
    strangers = [joint.name for joint in articulation.active_joints if joint.name not in specs]
    if strangers:
        raise PackageError(
            f"package {package.name!r}: SAPIEN has joints {strangers} that the package has not"
        )
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


def _apply_resistance(articulation: "PhysxArticulation", joint: LoadedJoint) -> None:
    """Friction and damping of the package; a joint that has neither is left to the engine."""
    spec = joint.spec
    if spec.friction == 0.0 and spec.damping == 0.0:
        return
    apply_friction(joint.engine, spec.friction)
    apply_damping(articulation, joint.engine, spec.damping)


def moving_links(loaded: LoadedPackage, joint: LoadedJoint) -> list["PhysxArticulationLinkComponent"]:
    """The joint's child link and everything that hangs from it."""
    out, waiting = [], [joint.engine.child_link]
    while waiting:
        link = waiting.pop()
        out.append(link)
        waiting += sorted(link.children, key=lambda child: child.name)
    return out
