"""Trials of a package for an engine, as plain JSON.

Runners do not depend on this project. Everything they need, including efforts and durations, is computed here
from the package and written once for all engines.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from artigen.types import Joint
from sim_export.motion.kinematics import moved_links, required_openings
from sim_export.package import SimPackage
from sim_export.physics.inertia import combine, inertia_about

from ..limits import joint_ends, limit_tolerance

TIMESTEP = 1.0 / 240.0
STEPS = 2000
"""Number of steps at rest, under gravity."""
DRIVE_SECONDS = 4.0
"""Largest duration (seconds) of a push in one direction."""
TRAVEL_SECONDS = 1.0
"""Duration (seconds) in which a pushed joint may cross its range."""
PUSH_RATIO = 1.5
"""Multiple of the friction in the effort of a push."""
HOLD, SLIP = 0.9, 1.1
"""Efforts relative to the friction that must not and must move a joint."""
TRIAL_SECONDS = 1.0
"""Largest duration (seconds) of a friction trial."""
TRIAL_SHARE = 0.25
"""Share of the range after which a friction trial ends."""


@dataclass(frozen=True, kw_only=True)
class FrictionTrial:
    """Trial from ``start`` without gravity: ``held`` (N or N m) must not move the joint, ``slipped`` must.

    ``expected`` is the motion under ``slipped`` in ``seconds`` with exact friction and damping.
    """

    start: float
    held: float
    slipped: float
    seconds: float
    expected: float


@dataclass(frozen=True, kw_only=True)
class JointTask:
    """A joint of the URDF, and its trial.

    ``open`` are the coordinates of joints that are open during the trial; ``effort`` pushes the joint through
    its range while it is slower than ``speed``; ``tolerance`` is the distance from an end that counts as
    reached. A joint without limits has a range of one turn. A follower (``mimic``) is not tested by itself.
    """

    name: str
    type: str
    lower: float
    upper: float
    friction: float
    damping: float
    mimic: str | None
    multiplier: float
    offset: float
    open: dict[str, float]
    effort: float
    speed: float
    tolerance: float
    trial: FrictionTrial | None


@dataclass(frozen=True, kw_only=True)
class LinkTask:
    """A link of the URDF; ``None`` if it has no mass."""

    name: str
    mass: float | None
    shapes: int


@dataclass(frozen=True, kw_only=True)
class EnginePlan:
    """One plan for a package and all engines. ``root`` is the link that is fixed to the world."""

    folder: str
    timestep: float
    steps: int
    drive_seconds: float
    root: str
    links: tuple[LinkTask, ...]
    joints: tuple[JointTask, ...]


def make_plan(folder: Path, package: SimPackage, steps: int = STEPS) -> EnginePlan:
    """The plan for the package in a folder."""
    children = {joint.child for joint in package.joints}
    return EnginePlan(
        folder=str(Path(folder).resolve()),
        timestep=TIMESTEP,
        steps=steps,
        drive_seconds=DRIVE_SECONDS,
        root=next(link.name for link in package.links if link.name not in children),
        links=tuple(
            LinkTask(
                name=link.name,
                mass=None if link.inertial is None else link.inertial.mass,
                shapes=len(link.hulls),
            )
            for link in package.links
        ),
        joints=tuple(_task(package, joint) for joint in package.joints if joint.type != "fixed"),
    )


def _task(package: SimPackage, joint: Joint) -> JointTask:
    lower, upper = joint_ends(joint)
    span = upper - lower
    load = moved_load(package, joint)
    speed = span / TRAVEL_SECONDS
    return JointTask(
        name=joint.name,
        type=joint.type,
        lower=lower,
        upper=upper,
        friction=joint.friction,
        damping=joint.damping,
        mimic=joint.follows,
        multiplier=joint.ratio,
        offset=joint.offset,
        open=open_coordinates(package, joint),
        effort=PUSH_RATIO * joint.friction + joint.damping * speed + 2.0 * load * span / TRAVEL_SECONDS**2,
        speed=speed,
        tolerance=limit_tolerance(joint),
        trial=_trial(joint, load),
    )


def open_coordinates(package: SimPackage, joint: Joint) -> dict[str, float]:
    """Coordinates of the joints that must be open before ``joint`` moves; requirements of unknown joints are
    ignored."""
    joints = []
    for other in package.joints:
        lower, upper = joint_ends(other)
        joints.append(replace(other, lower=lower, upper=upper))
    names = {other.name for other in joints}
    return required_openings(joint, joints, [need for need in package.requires_open if need.needs in names])


def moved_load(package: SimPackage, joint: Joint) -> float:
    """Mass (kg) that a sliding joint moves, or inertia (kg m^2) about the axis of a turning one, at rest."""
    carried = [package.links[slot] for slot in moved_links(package.links, package.joints, joint)]
    known = [link.inertial for link in carried if link.inertial is not None]
    if not known:
        return 0.0
    moved = combine(known)
    if joint.type == "prismatic":
        return moved.mass
    return float(joint.axis @ inertia_about(moved, joint.origin) @ joint.axis)


def _trial(joint: Joint, load: float) -> FrictionTrial | None:
    """A trial in the middle of the range, for the time in which the joint crosses `TRIAL_SHARE`, at most a
    second."""
    if joint.friction <= 0.0 or load <= 0.0 or joint.follows is not None:
        return None
    lower, upper = joint_ends(joint)
    net = (SLIP - 1.0) * joint.friction
    times = np.linspace(TIMESTEP, TRIAL_SECONDS, round(TRIAL_SECONDS / TIMESTEP))
    travel = travelled(net, load, joint.damping, times)
    enough = np.flatnonzero(travel >= TRIAL_SHARE * (upper - lower))
    at = int(enough[0]) if len(enough) else len(times) - 1
    return FrictionTrial(
        start=0.5 * (lower + upper),
        held=HOLD * joint.friction,
        slipped=SLIP * joint.friction,
        seconds=float(times[at]),
        expected=float(travel[at]),
    )


def travelled(net: float, load: float, damping: float, times: np.ndarray) -> np.ndarray:
    """Distance that a net effort moves a load against damping, from rest: m x'' + d x' = f."""
    if damping * times[-1] < 1e-6 * load:
        return 0.5 * net / load * times**2
    slowing = load / damping
    return net / damping * (times + slowing * np.expm1(-times / slowing))
