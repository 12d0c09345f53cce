"""Scripted solvers: they show that the tasks can be solved, and generate demonstrations.

They act like any policy, through the environment's actions; their knowledge of the object comes from its
package. Nothing is learned, and only the robot's fingers move joints.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, TypeVar

import gymnasium as gym
import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from sim_export.geometry.hulls import box_hull, move_hull

from ..hulls import object_field, plinth_under
from ..objects import TaskPart
from ..placement import part_motion
from .body import Obstacle
from .drive import (
    Driver,
    arm_angles,
    finger_action,
    grip,
    move,
    object_hulls,
    object_in_root,
    object_qpos,
    opened,
    root_pose,
    start,
    wait,
)
from .field import build_field
from .grasp import Grasps
from .opening import Opening
from .plan_open import NoPlan, OpenPlan, edge_grasps, handle_grasps, plan_open
from .plan_put import NoPutPlan, PutPlan, plan_put
from .plan_touch import plan_touch, push_places
from .work import Work

if TYPE_CHECKING:
    from ..open_part import OpenPartEnv
    from ..put_inside import PutInsideEnv

Found = TypeVar("Found")
ATTEMPTS = 4
AJAR_ANGLES = (0.7, 0.5, 0.35, 0.26)
"""Angles to which a door is pulled before it is pushed, rad; the first feasible one is used."""
TOUCH = 0.008
"""Penetration (m) along a path that is tolerated, because a field is not more accurate."""
PROGRESS = 0.03
"""Smallest change of a part's open fraction after which the same plans are tried again."""
PART_WAYS = (0.6, 0.3, 0.15)
"""Shares of a motion that are tried if the wrist cannot turn, or the arm cannot reach, all the way at
once."""
AROUND_GRIP = 0.32
FINE = 0.005
"""Margin around the grip that is resolved more finely, and edge of the cells there, metres."""
PULL_SPEED = 0.6
REST = 8
"""Control steps in which a part comes to rest."""
PICKS = 3
LIFTED = 0.05
"""Height by which a cube must have risen to be in the gripper, metres."""
STAND_HALF = np.array([0.03, 0.03, 0.2])
"""Half extents of the upper end of the column under the cube, with some margin, metres."""
MOVED = 0.02
"""Change of a part's open fraction above which the arm updates its model of the object."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """Result of an episode; ``reason`` is the cause of a failure, "" for success."""

    success: bool
    steps: int
    open_fraction: float
    reason: str


def solve_open_part(env: gym.Env, seed: int, object: str | None = None) -> Outcome:
    """Plays one episode of ``ArtiGen-OpenPart-v1``, or of one of its verbs, with the control mode
    ``pd_joint_pos``.

    Latches other than the part's own handle are opened first. The part is gripped by its handle or edge and
    moved along its path; a door that the arm cannot follow is pulled ajar and pushed from behind. Parts that
    are pressed or cannot be held are pushed with closed fingers.

    Args:
        env: The task, one scene on the CPU, wrapped or not.
        seed: Seed of the episode.
        object: Name of the object; default: sampled by the seed.
    """
    _, info = env.reset(seed=seed, options=_choose(object))
    driver = start(env, info)
    task: OpenPartEnv = env.unwrapped  # type: ignore[assignment]
    part, reason = task.drawn[0][1], ""
    for latch in part.latches if task.latched else ():
        if latch is not part.grip_latch and opened(driver, latch.part) < latch.fraction and not reason:
            reason = _work(driver, latch.part, (1.0 + latch.fraction) / 2.0, latch.fraction)
    reason = reason or _work(driver, part, task.goal_open, task.goal_open)
    if not driver.succeeded:
        wait(driver, REST)
    if driver.over:
        fraction = float(task.open_fraction[0])
        reason = f"time over at {fraction:.2f} of the range" + (f"; {reason}" if reason else "")
    return _outcome(driver, reason)


def _choose(object: str | None) -> dict[str, str]:
    """Options of a reset for an object."""
    return {} if object is None else {"object": object}


def _outcome(driver: Driver, reason: str) -> Outcome:
    """The result of an episode that has ended; ``reason`` is the cause if it failed."""
    return Outcome(
        success=driver.succeeded,
        steps=driver.steps,
        open_fraction=float(driver.task.open_fraction[0]),
        reason="" if driver.succeeded else reason,
    )


def _work(driver: Driver, part: TaskPart, goal: float, least: float) -> str:
    """Moves a part towards ``goal`` until it is at ``least``, shares of its range; returns "" or the cause of
    a failure."""
    failed, reason = 0, ""
    rising = goal > opened(driver, part)
    while failed < ATTEMPTS and not driver.over:
        begin = opened(driver, part)
        try:
            plan = _next_plan(driver, part, goal, failed)
        except NoPlan as none:
            return f"{part.joint.name!r}: {none}"
        _follow_plan(driver, plan)
        now = opened(driver, part)
        if now >= least if rising else now <= least:
            return ""
        reason = f"{part.joint.name!r} let go at {now:.2f} of the range"
        failed += abs(now - begin) < PROGRESS
    return reason


def _opening(driver: Driver, part: TaskPart) -> Opening:
    """The current state of the part and everything around it."""
    entry = driver.task.drawn[0][0]
    carried, others = object_hulls(driver, part)
    others = (*others, plinth_under(entry)) if entry.raised > 0.0 else others
    T_rest = part_motion(part, np.array([opened(driver, part)]))[0]
    carried = tuple(move_hull(hull, inverse(T_rest)) for hull in carried)
    near = np.stack([part.grip - AROUND_GRIP, part.grip + AROUND_GRIP])
    moved = near + (transform_points(T_rest, part.grip[None])[0] - part.grip)
    latch = part.grip_latch
    return Opening(
        chain=driver.chain,
        robot=driver.robot,
        body=driver.body,
        closed=driver.closed,
        part=part,
        T_root_object=object_in_root(driver),
        others=build_field(others, ground=entry.floor),
        carried=build_field(carried),
        near_others=build_field(others, moved, FINE, ground=entry.floor),
        near_carried=build_field(carried, near, FINE),
        turned=opened(driver, latch.part) if latch is not None and driver.task.latched else 1.0,
    )


def _next_plan(driver: Driver, part: TaskPart, end: float, tries: int) -> OpenPlan:
    """The first plan without contact of the arm, or else the one that presses least.

    Candidates in order: pushing, for parts to be pressed; gripping to the end; pushing to the end; pulling a
    leaf ajar, so far that it can be pushed from inside; pinching the part itself; then a part of the motion.

    Raises:
        NoPlan: If none of them works; the message lists the reasons.
    """
    opening, q, begin = _opening(driver, part), arm_angles(driver), opened(driver, part)
    ajar = [angle / part.span for angle in AJAR_ANGLES if part.joint.type != "prismatic"]
    shares = [begin + share * (end - begin) for share in PART_WAYS]
    handle, edge = _once(partial(handle_grasps, opening)), _once(partial(edge_grasps, opening))
    sign = float(np.sign(end - begin))
    places = _once(partial(push_places, opening, begin, sign))
    skip, name = tries // 2, part.joint.name

    def held(grasps: Callable[[], Grasps], to: float) -> OpenPlan:
        return plan_open(opening, grasps(), q, begin, to, skip=skip)

    def touched(to: float) -> OpenPlan:
        return plan_touch(opening, places(), q, begin, to, skip=skip)

    def pulled_ajar(to: float) -> OpenPlan:
        if not begin < to < end or part.kind not in ("door", "drawer"):
            raise NoPlan(f"joint {name!r}: cannot be pulled ajar")
        plan_touch(opening, push_places(opening, to, sign), q, to, end)
        return held(handle, to)

    whole, pinched = [partial(held, handle, end)], [partial(held, edge, end)]
    touch = [partial(touched, end)]
    ways = whole + touch + [partial(pulled_ajar, to) for to in ajar] + pinched
    first = touch + whole if part.verb == "press" else ways
    first = first[tries % len(first) :] + first[: tries % len(first)]  # start with an untried plan
    rest = [partial(held, grasps, to) for to in shares for grasps in (handle, edge)]
    rest += [partial(touched, to) for to in shares]
    found: list[OpenPlan] = []
    reasons: list[NoPlan] = []
    for attempt in first + rest:
        try:
            plan = attempt()
        except NoPlan as none:
            reasons.append(none)
            continue
        if plan.pressed <= TOUCH:
            return plan
        found.append(plan)
    if found:
        return min(found, key=lambda plan: plan.pressed)
    raise NoPlan(
        "; ".join(dict.fromkeys(str(reason).removeprefix(f"joint {name!r}: ") for reason in reasons))
    )


def _once(function: Callable[[], Found]) -> Callable[[], Found]:
    """Caches the result of a function, or the exception that it raises."""
    known: list[Found | NoPlan] = []

    def value() -> Found:
        if not known:
            try:
                known.append(function())
            except NoPlan as none:
                known.append(none)
        if isinstance(known[0], NoPlan):
            raise known[0]
        return known[0]

    return value


def _follow_plan(driver: Driver, plan: OpenPlan) -> None:
    """Executes a plan: to the part, along the joint's path, a pause for the part to come to rest, and
    away."""
    grip(driver, finger_action(driver.robot, plan.width) if plan.width else -1.0, 1)
    for q in plan.before:
        move(driver, q)
    wait(driver, 2)
    for q in plan.approach:
        move(driver, q, speed=0.5)
        wait(driver, 2)
    if plan.width:
        grip(driver, -1.0, 6)
    for q in plan.path:
        move(driver, q, speed=PULL_SPEED)
    wait(driver, REST)
    if driver.succeeded:
        return  # a lid would fall
    if plan.width:
        grip(driver, 1.0, 4)
    for q in plan.leave:
        move(driver, q)


def solve_put_inside(env: gym.Env, seed: int, object: str | None = None) -> Outcome:
    """Plays one episode of ``ArtiGen-PutInside-v1`` with the control mode ``pd_joint_pos``; arguments as
    `solve_open_part`."""
    _, info = env.reset(seed=seed, options=_choose(object))
    driver = start(env, info)
    task: PutInsideEnv = env.unwrapped  # type: ignore[assignment]
    reason = ""
    for _ in range(PICKS):
        try:
            plan = _put_plan(driver, task)
        except NoPutPlan as none:
            reason = str(none)
            break
        if _pick(driver, task, plan):
            _bring(driver, plan)
            break
    if not reason:
        lying = "inside" if bool(driver.info["inside"][0]) else "outside"
        reason = f"the cube ended {lying}, {'time over' if driver.over else 'not at rest'}"
    return _outcome(driver, reason)


def _put_plan(driver: Driver, task: "PutInsideEnv") -> PutPlan:
    """A plan from the cube's current position."""
    T_root_world = inverse(root_pose(driver))
    cube = np.asarray(task.cube.pose.to_transformation_matrix()[0].numpy(), dtype=np.float64)
    stand = np.asarray(task.cube_stand.pose.p[0].numpy(), dtype=np.float64)
    stand[2] += 1.0 - STAND_HALF[2]
    solid = task.solid_at_start(0)
    if abs(float(task.open_fraction[0]) - driver.begin) > MOVED:
        solid = object_field(*task.drawn[0], object_qpos(driver))
    column = build_field((box_hull(stand - STAND_HALF, stand + STAND_HALF),))
    work = Work(
        chain=driver.chain, robot=driver.robot, body=driver.body,
        obstacles=(
            Obstacle(field=solid, T_field_root=inverse(object_in_root(driver))),
            Obstacle(field=column, T_field_root=root_pose(driver)),
        ),
    )  # fmt: skip
    container = task.containers[0]
    aims = task.resting_places(0) + np.array([0.0, 0.0, task.cube_size / 2.0])
    return plan_put(
        work, arm_angles(driver), T_root_world @ cube, size=task.cube_size,
        aims=transform_points(T_root_world, aims), down=container.down,
        inwards=T_root_world[:3, :3] @ container.inwards,
    )  # fmt: skip


def _pick(driver: Driver, task: "PutInsideEnv", plan: PutPlan) -> bool:
    """Grasps and lifts the cube; returns whether it was lifted."""
    grip(driver, 1.0, 2)
    before = float(task.cube.pose.p[0, 2])
    _go(driver, plan.pick)
    grip(driver, -1.0, 6)
    _go(driver, plan.lift)
    return float(task.cube.pose.p[0, 2]) > before + LIFTED


def _bring(driver: Driver, plan: PutPlan) -> None:
    """Brings the cube to its place, releases it and retreats."""
    _go(driver, plan.place)
    grip(driver, 1.0, 5)
    _go(driver, plan.leave)
    wait(driver, 12)


def _go(driver: Driver, stage: Float[np.ndarray, "N J"]) -> None:
    """Moves through the waypoints of a stage: fast to the first, slowly along the others."""
    for index, q in enumerate(stage):
        move(driver, q, speed=0.9 if index == 0 else 0.5)
    wait(driver, 2)
