"""Carrying a held link: the range of its joint, and the room of the gripper along it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from artigen.kind import find_kind
from artigen.transforms import inverse
from artigen.types import Joint
from sim_export.geometry.hulls import box_hull
from sim_export.motion.kinematics import (
    hanging_links,
    link_displacements,
    object_joints,
    required_openings,
)
from sim_export.package import Grasp, Hull, SimPackage

from .boxes import ARRIVAL, arriving_boxes, carried_boxes
from .gripper import Gripper
from .poses import Hands
from .room import Solids, meet, near_solids
from .targets import Target

CARRIED = 0.95
"""Share of a stroke to which the gripper is carried if that ends at the joint's limit: it shall not press."""
QUARTER = np.pi / 2.0
"""Range (rad) of joints without limits."""
POSES = 25
"""Poses of a joint at which the gripper's room is measured."""
CLEAR = 0.002
"""Clearance (m) of the gripper."""
REACH = 0.25
"""Farthest (m) that a gripper extends from what it holds."""
FLOOR = 2.0
"""Half the edge (m) of the floor on which free-standing objects stand."""


def joint_range(joint: Joint) -> tuple[float, float]:
    """Ends (rad or m) between which one grasp opens a joint: its limits; a quarter turn without any."""
    return (0.0, QUARTER) if joint.type == "continuous" else (joint.lower, joint.upper)


def carry(
    package: SimPackage, joint: Joint, fractions: Sequence[float] | Float[np.ndarray, "K"]
) -> Float[np.ndarray, "K L 4 4"]:
    """Displacements of all links with ``joint`` opened to fractions of its range, and what it needs open."""
    lower, upper = joint_range(joint)
    q = lower + (upper - lower) * np.asarray(fractions, dtype=np.float64)
    needs = required_openings(joint, package.joints, package.requires_open)
    return link_displacements(package.links, package.joints, {**needs, joint.name: q})


def carried_to(begin: float, end: float) -> float:
    """Share of a joint's range to which the gripper is carried in a stroke."""
    return end if end < 1.0 else begin + CARRIED * (end - begin)


def place_link(package: SimPackage, grasp: Grasp) -> Float[np.ndarray, "4 4"]:
    """Displacement of the link of a grasp from rest as its stroke begins; what else must be open is open."""
    joint = next((joint for joint in object_joints(package.joints) if joint.name == grasp.joint), None)
    if joint is None:
        return np.eye(4)
    index = [link.name for link in package.links].index(grasp.link)
    return carry(package, joint, grasp.stroke[:1])[0, index]


@dataclass(frozen=True, kw_only=True, eq=False)
class Way:
    """A target in its object, seen from its link, and a gripper that takes it along its joint."""

    package: SimPackage
    target: Target
    gripper: Gripper

    @cached_property
    def index(self) -> int:
        """Index of the target's link."""
        return [link.name for link in self.package.links].index(self.target.link)

    @cached_property
    def root(self) -> int:
        """Index of the link that stands."""
        carried = {joint.child for joint in self.package.joints}
        return next(k for k, link in enumerate(self.package.links) if link.name not in carried)

    @property
    def own(self) -> tuple[Hull, ...]:
        """Hulls of the target's link."""
        return self.package.links[self.index].hulls

    @cached_property
    def floor(self) -> tuple[Hull, ...]:
        """What a loose or free-standing object stands on."""
        kind = find_kind(self.package.category)
        if self.target.joint is not None and kind is not None and kind.stands != "free":
            return ()
        low = min(hull.vertices[:, 2].min() for link in self.package.links for hull in link.hulls)
        return (box_hull(np.array([-FLOOR, -FLOOR, low - 0.05]), np.array([FLOOR, FLOOR, low])),)

    def along(self, fractions: Sequence[float] | Float[np.ndarray, "K"]) -> Float[np.ndarray, "K L 4 4"]:
        """Poses of all links, seen from the target's, with its joint opened to fractions of its range."""
        if self.target.joint is None:
            return np.tile(np.eye(4), (len(fractions), len(self.package.links), 1, 1))
        T = carry(self.package, self.target.joint, fractions)
        return inverse(T[:, self.index])[:, None] @ T

    def around(self, hands: Hands, T: Float[np.ndarray, "L 4 4"], *, moving: bool) -> Solids:
        """Solids near hands with the links at ``T``: all of them, or those that do not move with the target,
        and the floor."""
        center = (hands.T[:, :3, 3].min(axis=0) + hands.T[:, :3, 3].max(axis=0)) / 2.0
        reach = float(np.linalg.norm(hands.T[:, :3, 3] - center, axis=1).max()) + REACH + ARRIVAL
        joints, link = self.package.joints, self.target.link
        with_link = hanging_links(joints, link) if moving else frozenset()
        hulls, poses = list(self.floor), [T[self.root]] * len(self.floor)
        for each, pose in zip(self.package.links, T, strict=True):
            if each.name not in with_link:
                hulls += each.hulls
                poses += [pose] * len(each.hulls)
        return near_solids(hulls, np.array(poses).reshape(-1, 4, 4), center, reach)

    def arrive(self, hands: Hands, begin: float) -> Hands:
        """The hands with room to come and to close as the joint is opened to ``begin``."""
        if not len(hands):
            return hands
        boxes = arriving_boxes(self.gripper, hands.width, CLEAR)
        return hands.some(~meet(hands.T, boxes, self.around(hands, self.along([begin])[0], moving=False)))

    def reach(self, hands: Hands, begin: float) -> Float[np.ndarray, "G"]:
        """Share of the joint's range to which each hand can open it from ``begin``."""
        if self.target.joint is None:
            return np.ones(len(hands))
        ends, alive = np.full(len(hands), begin), np.arange(len(hands))
        boxes = carried_boxes(self.gripper, hands.width, CLEAR)
        shares = np.linspace(begin, 1.0, POSES)
        for end, T in zip(shares, self.along([carried_to(begin, end) for end in shares]), strict=True):
            if len(alive):
                solids = self.around(hands.some(alive), T, moving=True)
                alive = alive[~meet(hands.T[alive], boxes[alive], solids)]
                ends[alive] = end
        return ends
