"""URDFs of sources: a file that is one tree of known joints and shapes with finite numbers, or an error."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from artigen.errors import SourceError
from artigen.files.urdf import UrdfFile, UrdfJoint, UrdfShape, parse_urdf, rest_poses, tree_problems
from artigen.transforms import rotation_about

URDF_JOINTS = ("fixed", "revolute", "continuous", "prismatic", "floating", "planar")
MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True, kw_only=True, eq=False)
class SourceUrdf:
    """The relevant contents of a valid URDF, in file order.

    Followers are where their leaders at 0 hold them when they are at 0 themselves: no mimic has an offset.
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[UrdfJoint, ...]
    visuals: tuple[UrdfShape, ...]
    collisions: tuple[UrdfShape, ...]
    T_base_link: dict[str, Float[np.ndarray, "4 4"]]
    """Pose of every link in the root link, with all joints at 0."""

    @property
    def root(self) -> str:
        """The link that is no child."""
        return next(iter(self.T_base_link))

    def place(self, shape: UrdfShape) -> Float[np.ndarray, "4 4"]:
        """Pose of a shape in the root link, with all joints at 0."""
        return self.T_base_link[shape.link] @ shape.T_link_shape


def read_urdf(path: Path) -> SourceUrdf:
    """Reads links, joints and shapes of one URDF.

    Raises:
        SourceError: If the file is invalid; names the element and its value.
    """
    urdf = parse_urdf(path, inertials=False)
    problem = next(_find_problems(urdf), None)
    if problem is not None:
        raise SourceError(f"{path}: {problem}")
    urdf = replace(urdf, joints=fold_offsets(urdf.joints))
    return SourceUrdf(
        name=urdf.name,
        links=tuple(link.name for link in urdf.links),
        joints=urdf.joints,
        visuals=tuple(shape for link in urdf.links for shape in link.visuals),
        collisions=tuple(shape for link in urdf.links for shape in link.collisions),
        T_base_link=rest_poses(urdf),
    )


def fold_offsets(joints: tuple[UrdfJoint, ...]) -> tuple[UrdfJoint, ...]:
    """The same joints with coordinates of followers that are 0 where their leaders are: no mimic offsets.

    A follower ``q = multiplier * q_leader + offset`` has its origin moved by its value at leader 0, and its
    limits shifted by that value. Mimics in a circle stay as they are.
    """
    by_name = {joint.name: joint for joint in joints}
    return tuple(_shift_zero(joint, _value_at_zero(joint, by_name)) for joint in joints)


def _value_at_zero(joint: UrdfJoint, joints: Mapping[str, UrdfJoint]) -> float:
    """Coordinate (m or rad) that a joint has while the first of its leaders is at 0."""
    value, factor, at, seen = 0.0, 1.0, joint, set[str]()
    while at.mimic is not None and at.type != "fixed":
        if at.name in seen:
            return 0.0
        seen.add(at.name)
        value += factor * at.mimic_offset
        factor *= at.mimic_multiplier
        at = joints[at.mimic]
    return value


def _shift_zero(joint: UrdfJoint, value: float) -> UrdfJoint:
    """The joint with a coordinate that is 0 where it was ``value`` before, and without mimic offset."""
    length = float(np.linalg.norm(joint.axis))
    if value == 0.0 or length == 0.0 or joint.type not in MOVING:
        return replace(joint, mimic_offset=0.0)
    axis, step = joint.axis / length, np.eye(4)
    if joint.type == "prismatic":
        step[:3, 3] = value * axis
    else:
        step[:3, :3] = rotation_about(axis, np.array([value]))[0]
    lower, upper = (None if limit is None else limit - value for limit in (joint.lower, joint.upper))
    T = joint.T_parent_joint @ step
    return replace(joint, T_parent_joint=T, lower=lower, upper=upper, mimic_offset=0.0)


def _find_problems(urdf: UrdfFile) -> Iterator[str]:
    """Reasons why a file cannot be converted, a sentence each."""
    yield from (sentence for _, sentence in tree_problems(urdf))
    joints = {joint.name for joint in urdf.joints}
    for joint in urdf.joints:
        where = f"joint {joint.name!r}"
        if joint.type not in URDF_JOINTS:
            yield f"{where}: type {joint.type!r} is not one of {', '.join(URDF_JOINTS)}"
        if joint.mimic is not None and joint.mimic not in joints:
            yield f"{where}: mimics joint {joint.mimic!r}, which does not exist"
        numbers = [*joint.T_parent_joint.ravel(), *joint.axis, joint.mimic_multiplier, joint.mimic_offset]
        if not np.isfinite(numbers).all():
            yield f"{where}: origin, axis or mimic holds numbers that are not finite"
        if np.isnan([joint.lower or 0.0, joint.upper or 0.0]).any():
            yield f"{where}: limits [{joint.lower}, {joint.upper}], expected numbers"
    for link in urdf.links:
        for shape in (*link.visuals, *link.collisions):
            where = f"shape {shape.name!r} of link {link.name!r}"
            if shape.kind == "mesh" and not shape.file:
                yield f"{where}: a <mesh> lacks its 'filename'"
            if not np.isfinite([*shape.T_link_shape.ravel(), *shape.sizes, *shape.scale]).all():
                yield f"{where}: origin, size or scale holds numbers that are not finite"
            if min(shape.sizes, default=1.0) <= 0.0:
                yield f"{where}: {shape.kind} {list(shape.sizes)} has no extent, expected lengths above 0"
