"""Scripted solvers: proof that the tasks can be done, and a source of demonstrations.

They act like any policy, through the environment's actions; what they know of the object comes from its
package. Nothing here learns, and nothing pushes a joint but the robot's fingers.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import gymnasium as gym
import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from sim_export.collision.hulls import box_hull

from ..hulls import ground_under, move_hull
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
    root_pose,
    start,
    wait,
)
from .field import build_field
from .opening import Opening
from .plan_open import NoPlan, OpenPlan, plan_open
from .plan_push import plan_push
from .plan_put import NoPutPlan, PutPlan, plan_put
from .work import Work

if TYPE_CHECKING:
    from ..open_part import OpenPartEnv
    from ..put_inside import PutInsideEnv

ATTEMPTS = 4
AJAR_ANGLES = (0.7, 0.5, 0.35, 0.26)
"""How far a door is pulled before it is pushed, rad; the first that the arm can do."""
TOUCH = 0.008
"""Pressing by less than this (m) along a path is no reason for another one: a field is not finer."""
FARTHER = 0.1
"""How much farther than asked a part is pushed, part of its range."""
PULL_SPEED = 0.6
PICKS = 3
LIFTED = 0.05
"""How far a cube has to have come up to be in the gripper, metres."""
STAND_HALF = np.array([0.03, 0.03, 0.2])
"""Of the upper end of the column under the cube, with some to spare, metres."""
MOVED = 0.02
"""Change of a part's open fraction from which on the arm has to look anew where the object is."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """How an episode went; ``reason`` says what stopped it where it failed, "" otherwise."""

    success: bool
    steps: int
    open_fraction: float
    reason: str


def solve_open_part(env: gym.Env, seed: int) -> Outcome:
    """Plays one episode of ``ArtiGen-OpenPart-v1`` with the control mode ``pd_joint_pos``.

    It pulls at the handle all the way; where the arm cannot go along with a door, it pulls it ajar and pushes
    from behind.

    Args:
        env: the task, one scene on the CPU, wrapped or not.
        seed: of the episode.
    """
    _, info = env.reset(seed=seed)
    driver = start(env, info)
    task: OpenPartEnv = env.unwrapped  # type: ignore[assignment]
    opening = _opening(driver)
    reason = ""
    for attempt in range(ATTEMPTS):
        try:
            plan = _next_plan(driver, task, opening, attempt)
        except NoPlan as none:
            reason = str(none)
            break
        _follow_plan(driver, plan)
        if driver.over:
            break
        reason = f"let go at {float(task.open_fraction[0]):.2f} of the range"
    success = bool(driver.info["success"][0])
    opened = float(task.open_fraction[0])
    if not success and driver.over:
        reason = f"time over at {opened:.2f} of the range"
    return Outcome(
        success=success, steps=driver.steps, open_fraction=opened, reason="" if success else reason
    )


def _opening(driver: Driver) -> Opening:
    """The part and everything around it, as an episode finds it."""
    entry, part = driver.task.drawn[0]
    carried, others = object_hulls(driver)
    closed = inverse(part_motion(part, np.array([driver.begin]))[0])
    return Opening(
        chain=driver.chain,
        robot=driver.robot,
        body=driver.body,
        part=part,
        T_root_object=object_in_root(driver),
        others=build_field((*others, ground_under(entry, carried + others))),
        carried=build_field([move_hull(hull, closed) for hull in carried]),
    )


def _next_plan(driver: Driver, task: "OpenPartEnv", opening: Opening, attempt: int) -> OpenPlan:
    """Pull to the end if the arm keeps off everything; or else push to the end; or else pull only as far as
    a push needs; or else pull and press.

    Raises:
        NoPlan: if none of them works, with what kept the first from it.
    """
    part, begin, end = opening.part, float(task.open_fraction[0]), task.goal_open
    q = arm_angles(driver)
    whole, reason = _plan_or_reason(opening, q, begin, end, attempt)
    if whole is not None and whole.pressed <= TOUCH:
        return whole
    try:
        return _push(opening, q, begin, end)
    except NoPlan:
        pass
    partial = None
    for ajar in [angle / part.span for angle in AJAR_ANGLES if part.joint.type != "prismatic"]:
        if not begin < ajar < end:
            continue
        plan, _ = _plan_or_reason(opening, q, begin, ajar, attempt)
        partial = partial or plan
        try:
            _push(opening, q, ajar, end)
        except NoPlan:
            continue
        if plan is not None:
            return plan
    best = whole or partial
    if best is None:
        assert reason is not None
        raise reason
    return best


def _plan_or_reason(
    opening: Opening, q: Float[np.ndarray, "J"], begin: float, end: float, attempt: int
) -> tuple[OpenPlan | None, NoPlan | None]:
    try:
        return plan_open(opening, q, begin, end, skip=attempt), None
    except NoPlan as none:
        return None, none


def _push(opening: Opening, q: Float[np.ndarray, "J"], begin: float, end: float) -> OpenPlan:
    """Pushes farther than asked if the arm can: what stands out of a leaf keeps fingers off it."""
    try:
        return plan_push(opening, q, begin, min(1.0, end + FARTHER))
    except NoPlan:
        return plan_push(opening, q, begin, end)


def _follow_plan(driver: Driver, plan: OpenPlan) -> None:
    """To the part, along the joint's path, a moment for the part to come to rest, and away."""
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
    wait(driver, 8)
    if plan.width:
        grip(driver, 1.0, 4)
    for q in plan.leave:
        move(driver, q)


def solve_put_inside(env: gym.Env, seed: int) -> Outcome:
    """Plays one episode of ``ArtiGen-PutInside-v1`` with the control mode ``pd_joint_pos``."""
    _, info = env.reset(seed=seed)
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
    success = bool(driver.info["success"][0])
    if not success and not reason:
        lying = "inside" if bool(driver.info["inside"][0]) else "outside"
        reason = f"the cube ended {lying}, {'time over' if driver.over else 'not at rest'}"
    opened = float(task.open_fraction[0])
    return Outcome(
        success=success, steps=driver.steps, open_fraction=opened, reason="" if success else reason
    )


def _put_plan(driver: Driver, task: "PutInsideEnv") -> PutPlan:
    """A plan from where the cube lies now."""
    T_root_world = inverse(root_pose(driver))
    cube = np.asarray(task.cube.pose.to_transformation_matrix()[0].numpy(), dtype=np.float64)
    stand = np.asarray(task.cube_stand.pose.p[0].numpy(), dtype=np.float64)
    stand[2] += 1.0 - STAND_HALF[2]
    solid = task.solid_at_start(0)
    if abs(float(task.open_fraction[0]) - driver.begin) > MOVED:
        carried, others = object_hulls(driver)
        hulls = carried + others
        solid = build_field((*hulls, ground_under(task.drawn[0][0], hulls)))
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
    """Takes the cube and lifts it; whether it came along."""
    grip(driver, 1.0, 2)
    before = float(task.cube.pose.p[0, 2])
    _go(driver, plan.pick)
    grip(driver, -1.0, 6)
    _go(driver, plan.lift)
    return float(task.cube.pose.p[0, 2]) > before + LIFTED


def _bring(driver: Driver, plan: PutPlan) -> None:
    """Brings the cube to its place, lets go and draws back."""
    _go(driver, plan.place)
    grip(driver, 1.0, 5)
    _go(driver, plan.leave)
    wait(driver, 12)


def _go(driver: Driver, stage: Float[np.ndarray, "N J"]) -> None:
    """Through the waypoints of a stage: fast to the first, slowly along the others."""
    for index, q in enumerate(stage):
        move(driver, q, speed=0.9 if index == 0 else 0.5)
    wait(driver, 2)
