"""A loaded package: poses, stepping, moving links."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.types import Joint
from sim_export.package import HandleAnnotation, SimPackage

from ..limits import joint_ends, rest_coordinate
from .mechanism import Mechanism

if TYPE_CHECKING:
    import sapien
    from sapien.physx import PhysxArticulation, PhysxArticulationJoint, PhysxArticulationLinkComponent


@dataclass(frozen=True, kw_only=True)
class LinkLoad:
    """A link's properties in the URDF and in the engine; a ``None`` mass means that none was given."""

    name: str
    hulls: int
    shapes: int
    lost: tuple[str, ...]
    mass: float | None
    engine_mass: float


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadedJoint:
    """A joint with its engine counterpart; ``index`` is its position in the articulation's ``qpos``."""

    spec: Joint
    index: int
    label: str | None
    handle: HandleAnnotation | None
    engine: "PhysxArticulationJoint"

    @property
    def limited(self) -> bool:
        """False for wheels and other joints that turn without limits."""
        return self.spec.type != "continuous"

    @property
    def lower(self) -> float:
        """Lower end of the range (m or rad); 0 without limits."""
        return joint_ends(self.spec)[0]

    @property
    def span(self) -> float:
        """Length of the range (m or rad); a full turn without limits."""
        lower, upper = joint_ends(self.spec)
        return upper - lower


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadedPackage:
    """A package in a scene. ``joints`` are the independent ones, without followers, in the order of the
    package. It holds a reference to the scene, without which SAPIEN frees the articulation."""

    package: SimPackage
    scene: "sapien.Scene"
    articulation: "PhysxArticulation"
    joints: tuple[LoadedJoint, ...]
    links: tuple[LinkLoad, ...]
    mechanism: Mechanism

    def joint(self, name: str) -> LoadedJoint:
        """The joint with that name; raises `ValueError` with the existing names."""
        for joint in self.joints:
            if joint.spec.name == name:
                return joint
        known = ", ".join(joint.spec.name for joint in self.joints)
        raise ValueError(f"package {self.package.name!r} has no joint {name!r}; it has {known or 'none'}")

    def reset(self, coordinates: Mapping[str, float] | None = None) -> None:
        """Poses the object without speed or efforts.

        Args:
            coordinates: Of independent joints by name (m or rad); others are at rest, and followers follow.

        Raises:
            ValueError: If a name is not that of an independent joint.
        """
        rest = {joint.spec.name: rest_coordinate(joint.spec) for joint in self.joints}
        given = {self.joint(name).spec.name: value for name, value in (coordinates or {}).items()}
        qpos = qpos_of(self, rest | given).astype(np.float32)
        self.articulation.set_qpos(qpos)
        self.articulation.set_qvel(np.zeros_like(qpos))
        self.articulation.set_qf(np.zeros_like(qpos))

    def step(self, efforts: Mapping[str, float] | None = None) -> None:
        """Performs one step of the whole scene.

        Args:
            efforts: On joints by name (N or N m), which act until others are given; ``None`` gives none.
        """
        if efforts is not None:
            joints = self.articulation.active_joints
            self.articulation.set_qf(np.array([efforts.get(x.name, 0.0) for x in joints], dtype=np.float32))
        self.scene.step()

    def positions(self) -> dict[str, float]:
        """Coordinates of all moving joints by name (m or rad), followers included."""
        values = np.asarray(self.articulation.qpos, dtype=np.float64).tolist()
        return dict(zip((joint.name for joint in self.articulation.active_joints), values, strict=True))


def set_open_fraction(
    loaded: LoadedPackage, fraction: float | Sequence[float] | Float[np.ndarray, "J"]
) -> Float[np.ndarray, "Q"]:
    """Poses every joint at a fraction of its range, at rest; returns the articulation's ``qpos``.

    Args:
        fraction: 0 is the lower limit and 1 the upper; one number for all joints or one per joint of
            ``loaded.joints``. For a joint without limits it is a share of a full turn.
    """
    count = len(loaded.joints)
    values = np.broadcast_to(np.asarray(fraction, dtype=np.float64), (count,))
    if ((values < 0.0) | (values > 1.0)).any():
        raise ValueError(f"open fraction {values.tolist()}: must lie in [0, 1]")
    q = {
        joint.spec.name: joint.lower + value * joint.span
        for joint, value in zip(loaded.joints, values, strict=True)
    }
    qpos = qpos_of(loaded, q)
    loaded.articulation.set_qpos(qpos.astype(np.float32))
    loaded.articulation.set_qvel(np.zeros(len(qpos), dtype=np.float32))
    return qpos


def qpos_of(loaded: LoadedPackage, coordinates: dict[str, float]) -> Float[np.ndarray, "Q"]:
    """The articulation's ``qpos`` for joint coordinates by name; other joints are at 0, followers follow."""
    names = [joint.name for joint in loaded.articulation.active_joints]
    return loaded.mechanism.complete(np.array([coordinates.get(name, 0.0) for name in names]))


def collision_boxes(loaded: LoadedPackage) -> Float[np.ndarray, "L 2 3"]:
    """Boxes in the world of all links with collision shapes."""
    links = [link for link in loaded.articulation.links if link.collision_shapes]
    return np.array([link.get_global_aabb_fast() for link in links]).reshape(-1, 2, 3)


def moving_links(joint: LoadedJoint) -> list["PhysxArticulationLinkComponent"]:
    """The joint's child link and its descendants."""
    out, waiting = [], [joint.engine.child_link]
    while waiting:
        link = waiting.pop()
        out.append(link)
        waiting += sorted(link.children, key=lambda child: child.name)
    return out
