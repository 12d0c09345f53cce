"""A mechanism as a file of any format has it: a tree of links, joints and shapes with finite numbers.

Readers of formats make one; `artigen.datasets.mechanism_object` turns it into a `SourceObject`.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Float

from artigen.files.urdf import UrdfJoint, UrdfShape, place_links
from artigen.transforms import rotation_about
from artigen.types import PartLabel

if TYPE_CHECKING:
    from trimesh import Trimesh

Direction = Literal["x", "-x", "y", "-y", "z", "-z"]
JOINT_TYPES = ("fixed", "revolute", "continuous", "prismatic", "floating", "planar")
MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True, kw_only=True, eq=False)
class Solid:
    """A shape in memory: triangles with their colours and images, in metres in its own frame."""

    link: str
    name: str
    T_link_shape: Float[np.ndarray, "4 4"]
    pieces: "tuple[Trimesh, ...]"


Shape = UrdfShape | Solid


@dataclass(frozen=True, kw_only=True, eq=False)
class Mechanism:
    """Links, joints and shapes of one object, in file order.

    Followers are where their leaders at 0 hold them when they are at 0 themselves: no mimic has an offset.
    """

    path: Path
    name: str
    links: tuple[str, ...]
    joints: tuple[UrdfJoint, ...]
    visuals: tuple[Shape, ...]
    collisions: tuple[Shape, ...]
    T_base_link: dict[str, Float[np.ndarray, "4 4"]]
    """Pose of every link in the root link, with all joints at 0."""
    notes: tuple[str, ...] = ()
    """What the file holds and the mechanism does not, a sentence each."""
    labels: Mapping[str, PartLabel] = field(default_factory=dict)
    """Labels of links that the file states."""
    frame: tuple[Direction, Direction] = ("z", "-x")
    """Up axis, and the axis that the front faces."""

    @property
    def root(self) -> str:
        """The link that is no child."""
        return next(iter(self.T_base_link))

    @property
    def elements(self) -> tuple[UrdfShape, ...]:
        """Visuals that are elements of a URDF."""
        return tuple(shape for shape in self.visuals if isinstance(shape, UrdfShape))

    def place(self, shape: Shape) -> Float[np.ndarray, "4 4"]:
        """Pose of a shape in the root link, with all joints at 0."""
        return self.T_base_link[shape.link] @ shape.T_link_shape


def make_mechanism(
    path: Path,
    name: str,
    links: Iterable[str],
    joints: Iterable[UrdfJoint],
    *,
    visuals: Iterable[Shape],
    collisions: Iterable[Shape] = (),
    notes: Iterable[str] = (),
    labels: Mapping[str, PartLabel] | None = None,
    frame: tuple[Direction, Direction] = ("z", "-x"),
) -> Mechanism:
    """The mechanism of links that are one tree, without offsets of mimics."""
    links, joints = tuple(links), fold_offsets(tuple(joints))
    return Mechanism(
        path=path,
        name=name,
        links=links,
        joints=joints,
        visuals=tuple(visuals),
        collisions=tuple(collisions),
        T_base_link=place_links(links, joints),
        notes=tuple(notes),
        labels=labels or {},
        frame=frame,
    )


def fold_offsets(joints: tuple[UrdfJoint, ...]) -> tuple[UrdfJoint, ...]:
    """The same joints with coordinates of followers that are 0 where their leaders are: no mimic offsets.

    A follower ``q = multiplier * q_leader + offset`` has its origin moved by its value at leader 0, and its
    limits shifted by that value. Mimics in a circle stay as they are.
    """
    by_name = {joint.name: joint for joint in joints}
    return tuple(
        replace(shift_zero(joint, _value_at_zero(joint, by_name)), mimic_offset=0.0) for joint in joints
    )


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


def shift_zero(joint: UrdfJoint, value: float) -> UrdfJoint:
    """The joint with a coordinate that is 0 where it was ``value`` (m or rad) before."""
    length = float(np.linalg.norm(joint.axis))
    if value == 0.0 or length == 0.0 or joint.type not in MOVING:
        return joint
    axis, step = joint.axis / length, np.eye(4)
    if joint.type == "prismatic":
        step[:3, 3] = value * axis
    else:
        step[:3, :3] = rotation_about(axis, np.array([value]))[0]
    lower, upper = (None if limit is None else limit - value for limit in (joint.lower, joint.upper))
    return replace(joint, T_parent_joint=joint.T_parent_joint @ step, lower=lower, upper=upper)


def say_dropped(counts: Mapping[str, int]) -> list[str]:
    """One sentence on everything in a file that is not used, with its number; none if all is."""
    found = [f"{what} ({count})" for what, count in counts.items() if count]
    return [f"not used: {', '.join(found)}"] if found else []


def unique_names(names: Iterable[str], stem: str) -> list[str]:
    """The names, with a number after every one that is missing or occurs before (``body_3``, ``door_2``)."""
    names = list(names)
    taken, made = Counter(names), list[str]()
    seen: set[str] = set()
    for number, name in enumerate(names):
        new, count = name, number if not name else 2
        while not new or new in seen or (new != name and taken[new]):
            new, count = f"{name or stem}_{count}", count + 1
        seen.add(new)
        made.append(new)
    return made
