"""Goals as values: words, a state to start from, and conditions on joints and loose things.

A state is read from an engine (`envs.goals.mujoco`, `envs.maniskill.scene`); what is inside of what follows
from it by the kinematics of the packages.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import dist
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from envs.rooms.footprints import cached_package
from envs.rooms.room import Room, pose_matrix_of
from envs.rooms.solids import item_poses
from sim_export.motion.kinematics import link_displacements

Family = Literal["open", "pull", "close", "shut", "go", "pick", "put_in", "take_out", "put_on", "load"]
FAMILIES: tuple[Family, ...] = get_args(Family)


@dataclass(frozen=True, kw_only=True)
class JointGoal:
    """A joint of an object is to be between two coordinates (rad or m)."""

    object: str
    joint: str
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class Region:
    """A box (m) in the frame of an object at rest, which moves with a link."""

    link: str
    low: tuple[float, float, float]
    high: tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class ItemGoal:
    """The middle of a loose thing is to be in one of the regions of an object, or in none of them."""

    item: str
    object: str
    regions: tuple[Region, ...]
    inside: bool = True


@dataclass(frozen=True, kw_only=True)
class LiftGoal:
    """The lowest point of a loose thing is to be at least as high (m) in the room."""

    item: str
    height: float


@dataclass(frozen=True, kw_only=True)
class BaseGoal:
    """The middle of a robot's base is to be within ``reach`` (m) of one of some places (x, y) in the room."""

    places: tuple[tuple[float, float], ...]
    reach: float


@dataclass(frozen=True, kw_only=True)
class Goal:
    """What is to be done, in words, and when it is: all conditions hold.

    ``start`` are coordinates (object, joint, rad or m) that differ from those of the room when it begins.
    """

    words: str
    family: Family
    joints: tuple[JointGoal, ...] = ()
    items: tuple[ItemGoal, ...] = ()
    lifts: tuple[LiftGoal, ...] = ()
    bases: tuple[BaseGoal, ...] = ()
    start: tuple[tuple[str, str, float], ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """Coordinates by object and joint (rad or m; others are at 0), poses of things in the room, and the
    middle of the robot's base (x, y); None without a robot."""

    joints: Mapping[tuple[str, str], float]
    items: Mapping[str, Float[np.ndarray, "4 4"]]
    base: tuple[float, float] | None = None


def start_room(room: Room, goal: Goal) -> Room:
    """The room as a goal finds it. What lies in a drawer is where the drawer is."""
    placements = []
    for placement in room.placements:
        moved = {joint: q for name, joint, q in goal.start if name == placement.id}
        placements.append(replace(placement, joints=tuple((dict(placement.joints) | moved).items())))
    return replace(room, placements=tuple(placements))


def state_of(room: Room) -> State:
    """The state that a room describes."""
    return State(
        joints={(place.id, joint): q for place in room.placements for joint, q in place.joints},
        items=item_poses(room),
    )


def is_reached(goal: Goal, room: Room, state: State) -> bool:
    """Whether all conditions of a goal hold."""
    at = all(
        each.low <= state.joints.get((each.object, each.joint), 0.0) <= each.high for each in goal.joints
    )
    lifted = all(state.items[each.item][2, 3] >= each.height for each in goal.lifts)
    there = all(
        state.base is not None and min(dist(state.base, place) for place in each.places) <= each.reach
        for each in goal.bases
    )
    return at and lifted and there and all(_is_placed(each, room, state) for each in goal.items)


def _is_placed(goal: ItemGoal, room: Room, state: State) -> bool:
    placement = room.placement(goal.object)
    package = cached_package(placement.package)
    known = {joint.name for joint in package.joints}
    coordinates = {
        joint: q for (name, joint), q in state.joints.items() if name == goal.object and joint in known
    }
    T = link_displacements(package.links, package.joints, coordinates)
    links = [link.name for link in package.links]
    (size,) = (item.size for item in room.contents if item.id == goal.item)
    middle = transform_points(state.items[goal.item], np.array([[0.0, 0.0, size[2] / 2.0]]))

    def holds(region: Region) -> bool:
        T_room_link = pose_matrix_of(placement) @ T[links.index(region.link)]
        (point,) = transform_points(inverse(T_room_link), middle)
        return bool((point >= region.low).all() and (point <= region.high).all())

    return any(map(holds, goal.regions)) == goal.inside
