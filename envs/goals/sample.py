"""Samples goals from what a room has: ten families, each goal with words that refer to nothing else."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import dist

import numpy as np

from artigen.types import Joint
from envs.rooms.ajar import stays
from envs.rooms.check import overlapping
from envs.rooms.compartments import Compartment, cached_compartments
from envs.rooms.footprints import cached_package, read_footprint
from envs.rooms.furnish import BARE_ROLES
from envs.rooms.map import drive_map, start_place, way_to
from envs.rooms.recipes import DISHWASHER, DOOR, FRIDGE, WASHER, WINDOW
from envs.rooms.room import Item, Placement, Room
from envs.rooms.solids import item_poses
from envs.rooms.sweeps import opening_joints
from envs.rooms.things import thing_hulls
from sim_export.package import SimPackage

from .goal import (
    FAMILIES,
    BaseGoal,
    Family,
    Goal,
    ItemGoal,
    JointGoal,
    LiftGoal,
    Region,
    is_reached,
    start_room,
    state_of,
)
from .names import is_inside, name_items, name_objects, name_part, zone_of

GOALS = 40
"""Number of goals that are written for a room."""
OPENED, CLOSED = 0.75, 0.05
"""Shares of its range from which a part counts as open, and up to which as closed."""
AJAR = 0.8
"""Share of its range to which a part is open that is to be closed."""
REACH = (0.35, 1.15)
"""Range of heights (m) of tops onto which things are put."""
ROOMY = 0.12
"""Area (m^2) of the smallest top onto which things are put: bins and toasters carry nothing."""
ABOVE = 0.35
"""Height (m) of the space over a top or a compartment in which the middle of a thing is on or in it."""
LOADS: dict[str, tuple[str, ...]] = {
    DISHWASHER.name: ("cup", "bowl", "plate", "spoon"),
    WASHER.name: ("towel",),
    FRIDGE.name: ("bottle", "jar", "carton"),
}
"""Things that are loaded into what fills a role."""
MOST_LOADED = 2
LIFT, GRASP = 0.1, 0.075
"""Height (m) by which a thing is picked up, and largest width (m) of what a gripper picks up."""
NEAR = 0.25
"""Distance (m) of a robot's base from a standing place of an object at which the robot is at it."""
LARGE = 0.4
"""Length (m) from which things are furniture, which stays where it is."""
UNNAMED = frozenset({WINDOW.name})
"""Roles without goals."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Scene:
    """A room with its phrases."""

    room: Room

    @cached_property
    def objects(self) -> dict[str, str]:
        return name_objects(self.room)

    @cached_property
    def items(self) -> dict[str, str]:
        return name_items(self.room, self.objects)

    def leaves(self, placement: Placement, *labels: str) -> list[Joint]:
        """Joints of its doors and drawers, or of some labels, that open without another part."""
        if placement.role in UNNAMED:
            return []
        package = cached_package(placement.package)
        wanted = labels or ("door", "drawer")
        label = {link.name: link.label for link in package.links}
        fronts = {joint.name for joint in package.joints if label.get(joint.child) in ("door", "drawer")}
        waiting = {need.joint for need in package.requires_open if need.needs in fronts}
        return [
            joint
            for joint in opening_joints(package)
            if label[joint.child] in wanted and joint.name not in waiting and joint.type != "continuous"
        ]

    def part(self, placement: Placement, joint: Joint) -> str:
        return name_part(self.room, self.objects, placement.id, joint.child)


def sample_goals(room: Room, seed: int, count: int) -> tuple[Goal, ...]:
    """Up to ``count`` goals of a room, as evenly from all families as it has them; deterministic.

    None is reached when it begins, and none begins with things that overlap. Goals whose parts have handles
    come first: the others take hands that pinch or push.
    """
    scene, rng = _Scene(room=room), np.random.default_rng([seed, 11])
    found: list[Goal] = []
    said: set[str] = set()
    waiting = {
        family: iter(sorted(MAKERS[family](scene, rng), key=lambda goal: not _is_handy(scene, goal)))
        for family in FAMILIES
    }
    while waiting and len(found) < count:
        for family in list(waiting):
            goal = next(
                (each for each in waiting[family] if each.words not in said and _begins(each, room)), None
            )
            if goal is None:
                del waiting[family]
            elif len(found) < count:
                found.append(goal)
                said.add(goal.words)
    return tuple(found)


def _begins(goal: Goal, room: Room) -> bool:
    """Whether the goal is not reached in its first state, in which what was opened for it touches nothing."""
    started = start_room(room, goal)
    named = {each.item for each in (*goal.items, *goal.lifts)}
    asked = replace(started, contents=tuple(item for item in started.contents if item.id in named))
    if is_reached(goal, asked, state_of(asked)):
        return False
    opened = {name for name, _, _ in goal.start}
    return not any(overlapping(started, started.placement(name)) for name in opened)


def _shuffled(rng: np.random.Generator, room: Room) -> list[Placement]:
    return [room.placements[index] for index in rng.permutation(len(room.placements))]


def _opened(placement: Placement, joint: Joint) -> JointGoal:
    return JointGoal(object=placement.id, joint=joint.name, low=OPENED * joint.upper, high=1.1 * joint.upper)


def _shut(placement: Placement, joint: Joint) -> JointGoal:
    return JointGoal(
        object=placement.id, joint=joint.name, low=-CLOSED * joint.upper, high=CLOSED * joint.upper
    )


def _parts(scene: _Scene, rng: np.random.Generator, *labels: str) -> list[tuple[Placement, Joint]]:
    """Objects and joints of their doors or drawers, in random order."""
    return [
        (placement, joint)
        for placement in _shuffled(rng, scene.room)
        for joint in scene.leaves(placement, *labels)
    ]


def _is_handy(scene: _Scene, goal: Goal) -> bool:
    """Whether all parts that a goal moves have handles; where things are behind doors, one of these."""
    held = []
    for each in goal.joints:
        package = cached_package(scene.room.placement(each.object).package)
        (link,) = (joint.child for joint in package.joints if joint.name == each.joint)
        held.append(_is_held(package, link))
    for item in goal.items if goal.family != "put_on" else ():
        placement = scene.room.placement(item.object)
        links = {region.link for region in item.regions}
        leaves = [joint.child for joint in scene.leaves(placement)]
        fronts = links.intersection(leaves) or leaves
        held.append(any(_is_held(cached_package(placement.package), link) for link in fronts))
    return all(held)


def _is_held(package: SimPackage, link: str) -> bool:
    """Whether a handle is annotated on a link, or on one that it carries."""
    carried = [joint.child for joint in package.joints if joint.parent == link]
    return any(handle.link == link for handle in package.handles) or any(
        _is_held(package, each) for each in carried
    )


def _open_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    for placement, joint in _parts(scene, rng, "door"):
        words = f"open {scene.part(placement, joint)}"
        yield Goal(words=words, family="open", joints=(_opened(placement, joint),))


def _pull_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    for placement, joint in _parts(scene, rng, "drawer"):
        words = f"pull out {scene.part(placement, joint)}"
        yield Goal(words=words, family="pull", joints=(_opened(placement, joint),))


def _staying(placement: Placement, joints: list[Joint]) -> tuple[tuple[str, str, float], ...]:
    """Start coordinates at which each of the joints stays open by friction."""
    package = cached_package(placement.package)
    return tuple(
        (placement.id, joint.name, round(AJAR * joint.upper, 6))
        for joint in joints
        if joint.spring <= 0.0 and stays(package, {joint.name: AJAR * joint.upper}, joint.name)
    )


def _close_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    for placement, joint in _parts(scene, rng):
        start = _staying(placement, [joint])
        if start:
            words = f"close {scene.part(placement, joint)}"
            yield Goal(words=words, family="close", joints=(_shut(placement, joint),), start=start)


def _shut_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    for placement in _shuffled(rng, scene.room):
        joints = [joint for joint in scene.leaves(placement) if _staying(placement, [joint])]
        if len(joints) > 1 and placement.role != DOOR.name:
            yield Goal(
                words=f"close everything that is open in the {scene.objects[placement.id]}",
                family="shut",
                joints=tuple(_shut(placement, joint) for joint in joints),
                start=_staying(placement, joints),
            )


def _region(compartment: Compartment) -> Region:
    return Region(link=compartment.link, low=compartment.low, high=compartment.high)


def _targets(scene: _Scene, placement: Placement) -> Iterator[tuple[str, list[Compartment]]]:
    """Compartments of an object with the words for where they are: each drawer, and all behind its doors."""
    closed = [each for each in cached_compartments(placement.package) if not each.open]
    joints = {joint.child: joint for joint in scene.leaves(placement, "drawer")}
    for link, joint in joints.items():
        inside = [each for each in closed if each.link == link]
        if inside:
            yield scene.part(placement, joint), inside
    behind = [each for each in closed if each.kind == "shelf"]
    if behind and scene.leaves(placement, "door"):
        yield f"the {scene.objects[placement.id]}", behind


def _fits(item: Item, compartment: Compartment) -> bool:
    points = np.concatenate([hull.vertices for hull in thing_hulls(item.thing, item.size)])
    need, room = np.ptp(points, axis=0) + 0.02, np.subtract(compartment.high, compartment.low)
    return bool(need[2] < room[2] and min(need[:2]) < room[:2].min() and max(need[:2]) < room[:2].max())


def _near(scene: _Scene, rng: np.random.Generator, placement: Placement) -> list[Item]:
    """Small things with names in the same room that are not in or on an object, in random order."""
    zone = zone_of(scene.room, placement.id)
    items = [
        item
        for item in scene.room.contents
        if item.id in scene.items
        and item.holder != placement.id
        and max(item.size) < LARGE
        and zone_of(scene.room, item.id) == zone
    ]
    return [items[index] for index in rng.permutation(len(items))]


def _go_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    """Objects that a robot reaches with all doors as they are."""
    start, reach = start_place(scene.room), drive_map(scene.room)
    for placement in _shuffled(rng, scene.room):
        places = tuple(place for place in placement.standing if way_to(reach, place) < NEAR)
        if places and min(dist(start, place) for place in places) > 2.0 * NEAR:
            words = f"go to the {scene.objects[placement.id]}"
            yield Goal(words=words, family="go", bases=(BaseGoal(places=places, reach=NEAR),))


def _pick_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    """Things in the open that a gripper closes around."""
    poses = item_poses(scene.room)
    for index in rng.permutation(len(scene.room.contents)):
        item = scene.room.contents[index]
        if item.id not in scene.items or min(item.size[:2]) > GRASP or is_inside(scene.room, item):
            continue
        height = round(float(poses[item.id][2, 3]) + LIFT, 6)
        lift = LiftGoal(item=item.id, height=height)
        yield Goal(words=f"pick up {scene.items[item.id]}", family="pick", lifts=(lift,))


def _put_in_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    for placement in _shuffled(rng, scene.room):
        for where, compartments in _targets(scene, placement):
            for item in _near(scene, rng, placement):
                fitting = [each for each in compartments if _fits(item, each)]
                if fitting:
                    goal = ItemGoal(item=item.id, object=placement.id, regions=tuple(map(_region, fitting)))
                    yield Goal(
                        words=f"put {scene.items[item.id]} into {where}", family="put_in", items=(goal,)
                    )
                    break


def _take_out_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    for index in rng.permutation(len(scene.room.contents)):
        item = scene.room.contents[index]
        if item.id not in scene.items or item.holder is None:
            continue
        placement = scene.room.placement(item.holder)
        for where, compartments in _targets(scene, placement):
            goal = ItemGoal(
                item=item.id, object=placement.id, regions=tuple(map(_region, compartments)), inside=False
            )
            phrase = scene.items[item.id].split(f" in the {scene.objects[placement.id]}")[0]
            if any(each.link == item.link for each in compartments):
                words = f"take {phrase} out of {where}"
                yield Goal(words=words, family="take_out", items=(goal,))
                break


def _root(placement: Placement) -> str:
    package = cached_package(placement.package)
    moved = {joint.child for joint in package.joints}
    return next(link.name for link in package.links if link.name not in moved)


def _put_on_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    for placement in _shuffled(rng, scene.room):
        footprint = read_footprint(placement.package)
        top = float(footprint.body[1, 2])
        if placement.role in BARE_ROLES - {"nightstand"} or not footprint.tops:
            continue
        if not REACH[0] <= top + placement.position[2] <= REACH[1]:
            continue
        root = _root(placement)
        outline = np.concatenate(footprint.tops)
        if np.prod(np.ptp(outline, axis=0)) < ROOMY:
            continue
        (x0, y0), (x1, y1) = outline.min(axis=0).tolist(), outline.max(axis=0).tolist()
        region = Region(link=root, low=(x0, y0, top), high=(x1, y1, top + ABOVE))
        for item in _near(scene, rng, placement):
            goal = ItemGoal(item=item.id, object=placement.id, regions=(region,))
            words = f"put {scene.items[item.id]} on the {scene.objects[placement.id]}"
            yield Goal(words=words, family="put_on", items=(goal,))
            break


def _load_goals(scene: _Scene, rng: np.random.Generator) -> Iterator[Goal]:
    """An appliance is loaded with things, and shut: they are within its body then."""
    for placement in _shuffled(rng, scene.room):
        doors = scene.leaves(placement, "door")
        items = [item for item in _near(scene, rng, placement) if item.thing in LOADS.get(placement.role, ())]
        if not doors or not items:
            continue
        root = _root(placement)
        (x0, y0, z0), (x1, y1, z1) = read_footprint(placement.package).body.tolist()
        region = Region(link=root, low=(x0, y0, z0), high=(x1, y1, z1))
        chosen = items[:MOST_LOADED]
        listed = " and ".join(scene.items[item.id] for item in chosen)
        yield Goal(
            words=f"load the {scene.objects[placement.id]} with {listed} and close it",
            family="load",
            joints=tuple(_shut(placement, joint) for joint in doors),
            items=tuple(ItemGoal(item=item.id, object=placement.id, regions=(region,)) for item in chosen),
        )


MAKERS: dict[Family, Callable[[_Scene, np.random.Generator], Iterator[Goal]]] = {
    "open": _open_goals,
    "pull": _pull_goals,
    "close": _close_goals,
    "shut": _shut_goals,
    "go": _go_goals,
    "pick": _pick_goals,
    "put_in": _put_in_goals,
    "take_out": _take_out_goals,
    "put_on": _put_on_goals,
    "load": _load_goals,
}
