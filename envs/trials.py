"""The simulated trials of checks V302 to V307: rest, lean, pull open, push closed, stand free.

`run_trials` runs all of them at one time step and returns plain measurements; `envs.dynamics` compares those
with thresholds. Everything uses CPU PhysX and is deterministic.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import sapien
from jaxtyping import Float

from artigen.shapes.support import measure_overhang
from artigen.transforms import transform_points
from artigen.types import Joint
from sim_export.package import SimPackage

from .hand import link_vertices, pose_matrix, push_wrench
from .limits import limit_tolerance
from .plan import JointPlan, TrialPlan, plan_trials
from .sim.loaded import LinkLoad, LoadedJoint, LoadedPackage, collision_boxes
from .sim.sapien import LoadConfig, load_package
from .sim.scene import create_scene

REST_SECONDS = 5.0
"""Duration (seconds) for which the fixed object rests under gravity (V302)."""
STAND_SECONDS = 3.0
"""Duration (seconds) for which the free object stands on the ground (V303)."""
PULL_SECONDS = 5.0
"""Time limit (seconds) for opening or closing a joint by hand (V304)."""
LEAN_SECONDS = 2.0
"""Duration (seconds) of the observation of the tilted object (V305)."""
LEAN_DEGREES = 5.0
"""Tilt of the object in degrees (V305)."""
STALL_SPEED = 1e-3
"""Speed of every joint, in its ranges per second, below which what is pushed stands still ..."""
STALL_SECONDS = 0.25
"""... and the time (seconds) after which it is given up. A leaf that still swings holds the one that it hangs
on."""
FLOOR_BAND = 0.005
"""Height (m) above the lowest point within which a vertex counts as touching the floor."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PullResult:
    """Trial of one joint; distances to the limits and speeds in m or rad, ``opened`` as a share of the
    range."""

    opened: float
    open_gap: float
    close_gap: float
    peak_speed: float


@dataclass(frozen=True, kw_only=True, eq=False)
class StandResult:
    """Free base on the ground: degrees, metres; ``overhang`` is the distance of the centre of mass outside of
    the support polygon (m, negative inside)."""

    tilt: float
    drift: float
    penetration: float
    overhang: float


@dataclass(frozen=True, kw_only=True, eq=False)
class TrialResults:
    """All measurements at one time step. Arrays follow ``LoadedPackage.joints``."""

    joints: tuple[Joint, ...]
    loads: tuple[LinkLoad, ...]
    plan: TrialPlan
    rest_drift: Float[np.ndarray, "J"]
    rest_speed: Float[np.ndarray, "J"]
    lean_drift: Float[np.ndarray, "J"]
    pulls: tuple[PullResult, ...]
    stand: StandResult
    size_ratio: float
    trace: Float[np.ndarray, "T"]


def run_trials(folder: Path, package: SimPackage, timestep: float) -> TrialResults:
    """All trials of one package at one time step (seconds), in new scenes."""
    loaded = load_package(create_scene(timestep), folder, LoadConfig(base="fixed"), package)
    plan = plan_trials(loaded)
    trace: list[np.ndarray] = []
    loaded.reset()
    size = _size(loaded)
    rest_drift, rest_speed = _rest(loaded, trace)
    growth = [_size(loaded)]
    lean_drift = _lean(loaded, plan, trace)
    pulls: dict[int, PullResult] = {}
    for group in plan.groups:
        pulls |= _pull_group(loaded, plan, group, trace)
        growth.append(_size(loaded))
    stand = _stand(folder, package, timestep, trace)
    return TrialResults(
        joints=tuple(joint.spec for joint in loaded.joints),
        loads=loaded.links,
        plan=plan,
        rest_drift=rest_drift,
        rest_speed=rest_speed,
        lean_drift=lean_drift,
        pulls=tuple(pulls[index] for index in range(len(loaded.joints))),
        stand=stand,
        size_ratio=max(growth) / size if size > 0 else 1.0,
        trace=np.concatenate([np.zeros(0), *trace]),
    )


def _steps(loaded: LoadedPackage, seconds: float) -> int:
    return max(1, round(seconds / loaded.scene.timestep))


def _of_joints(loaded: LoadedPackage, values: np.ndarray) -> np.ndarray:
    """Entries of a ``qpos``-like array for ``loaded.joints``."""
    return np.asarray(values, dtype=np.float64)[[joint.index for joint in loaded.joints]]


def _run_free(loaded: LoadedPackage, seconds: float, trace: list) -> np.ndarray:
    """Steps without actions; returns the largest displacement of each joint from the start."""
    start = np.array(loaded.articulation.qpos, dtype=np.float64)
    worst = np.zeros(len(start))
    for step in range(_steps(loaded, seconds)):
        loaded.step()
        if step % 8 == 7:
            q = np.array(loaded.articulation.qpos, dtype=np.float64)
            worst = np.fmax(worst, np.abs(q - start)) if np.isfinite(q).all() else np.full(len(q), np.inf)
            trace.append(q)
    q = np.array(loaded.articulation.qpos, dtype=np.float64)
    trace.append(q)
    last = np.where(np.isfinite(q), np.abs(q - start), np.inf)
    return _of_joints(loaded, np.maximum(worst, last))


def _rest(loaded: LoadedPackage, trace: list) -> tuple[np.ndarray, np.ndarray]:
    drift = _run_free(loaded, REST_SECONDS, trace)
    # PhysX reports speeds of joints that stand still: asleep, or pressed against a limit.
    before = _of_joints(loaded, loaded.articulation.qpos)
    loaded.step()
    moved = np.abs(_of_joints(loaded, loaded.articulation.qpos) - before)
    return drift, moved / loaded.scene.timestep


def _lean(loaded: LoadedPackage, plan: TrialPlan, trace: list) -> np.ndarray:
    """Tilts the fixed object in the opening direction of each joint in turn; largest motion of each."""
    worst = np.zeros(len(loaded.joints))
    leans = {tuple(np.round(joint.lean, 2)): joint.lean for joint in plan.joints if joint.lean.any()}
    for _, lean in sorted(leans.items()):
        axis = np.cross([0.0, 0.0, 1.0], lean)  # rotation about this axis lowers the side of `lean`
        loaded.articulation.set_root_pose(sapien.Pose(q=quat_about(axis, np.radians(LEAN_DEGREES))))
        loaded.reset()
        worst = np.maximum(worst, _run_free(loaded, LEAN_SECONDS, trace))
    loaded.articulation.set_root_pose(sapien.Pose())
    return worst


def quat_about(axis: Float[np.ndarray, "3"], angle: float) -> list[float]:
    """Rotation by ``angle`` (radians) about a unit ``axis`` (wxyz)."""
    return [float(value) for value in (np.cos(angle / 2.0), *(np.sin(angle / 2.0) * axis))]


def _pull_group(
    loaded: LoadedPackage, plan: TrialPlan, group: tuple[int, ...], trace: list
) -> dict[int, PullResult]:
    """Opens joints together from their lower limits, then closes them; all others are at rest."""
    members = [(loaded.joints[index], plan.joints[index]) for index in group]
    needs = members[0][1].needs
    start = {name: loaded.joint(name).spec.upper for name in needs}
    start |= {joint.spec.name: joint.lower for joint, _ in members}
    loaded.reset(start)
    kept = [  # required joints are held open against their springs
        (joint.engine.child_link, push_wrench(joint, own.axis, own.opening))
        for joint, own in zip(loaded.joints, plan.joints, strict=True)
        if joint.spec.name in needs and joint.spec.spring > 0.0
    ]
    drive = partial(_drive, loaded, members, trace, kept=kept)
    opened, open_gap, speed_out = drive(direction=1.0)
    _, close_gap, speed_back = drive(direction=-1.0)
    return {
        index: PullResult(
            opened=float(opened[k]),
            open_gap=float(open_gap[k]),
            close_gap=float(close_gap[k]),
            peak_speed=float(max(speed_out[k], speed_back[k])),
        )
        for k, index in enumerate(group)
    }


def _drive(
    loaded: LoadedPackage, members: list[tuple[LoadedJoint, JointPlan]], trace: list, *,
    direction: float, kept: list[tuple],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """Pushes joints in one direction until all have arrived, all have stalled, or the time is over.

    ``kept`` are links with forces and torques that hold other joints. Returns the covered share of the range,
    the remaining distance to the limit, and the peak speed.
    """
    joints = [joint for joint, _ in members]
    columns = np.array([joint.index for joint in joints])
    span = np.array([joint.span for joint in joints])
    spans = np.array([joint.span for joint in loaded.joints])
    limited = np.array([joint.limited for joint in joints])
    near = np.array([limit_tolerance(joint.spec) for joint in joints])
    target = np.array([joint.spec.upper if direction > 0 else joint.spec.lower for joint in joints])
    pushes = [
        (joint.engine.child_link, push_wrench(joint, direction * plan.axis, plan.effort(direction)))
        for joint, plan in members
    ]
    travelled, peak = np.zeros(len(joints)), np.zeros(len(joints))
    still_for, dt = 0, loaded.scene.timestep
    q = np.array(loaded.articulation.qpos, dtype=np.float64)[columns]
    gap = np.where(limited, np.abs(target - q), span)
    for _ in range(_steps(loaded, PULL_SECONDS)):
        for k, (link, wrench) in enumerate(pushes):
            # Release a joint without limits once it has turned far enough.
            if limited[k] or gap[k] > 0.0:
                link.add_force_torque(*wrench)
        for link, wrench in kept:
            link.add_force_torque(*wrench)
        loaded.step()
        q = np.array(loaded.articulation.qpos, dtype=np.float64)[columns]
        v = np.array(loaded.articulation.qvel, dtype=np.float64)[columns]
        travelled = travelled + direction * v * dt
        peak = np.fmax(peak, np.abs(v))
        trace.append(q)
        if not np.isfinite(q).all():
            return np.zeros(len(q)), np.full(len(q), np.inf), np.full(len(q), np.inf)
        gap = np.where(limited, np.abs(target - q), np.maximum(span - travelled, 0.0))
        rates = np.abs(_of_joints(loaded, loaded.articulation.qvel))
        still_for = still_for + 1 if (rates < STALL_SPEED * np.maximum(spans, 0.1)).all() else 0
        if (gap < near / 2).all() or still_for * dt > STALL_SECONDS:
            break
    return np.clip(1.0 - gap / np.maximum(span, 1e-9), 0.0, 1.0), gap, peak


def _size(loaded: LoadedPackage) -> float:
    """Diagonal of the box around all collision shapes (m)."""
    boxes = collision_boxes(loaded)
    if not len(boxes):
        return 0.0
    return float(np.linalg.norm(boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)))


def local_vertices(loaded: LoadedPackage) -> tuple[Float[np.ndarray, "V 3"], ...]:
    """Vertices of the collision shapes of every link of the articulation, in link frames."""
    return tuple(link_vertices(link) for link in loaded.articulation.links)


def world_vertices(
    loaded: LoadedPackage, local: Sequence[Float[np.ndarray, "V 3"]]
) -> Float[np.ndarray, "W 3"]:
    """All vertices of `local_vertices` at the current poses of the links."""
    pairs = zip(loaded.articulation.links, local, strict=True)
    chunks = [transform_points(pose_matrix(link.entity_pose), points) for link, points in pairs]
    return np.concatenate([np.zeros((0, 3)), *chunks])


def _stand(folder: Path, package: SimPackage, timestep: float, trace: list) -> StandResult:
    scene = create_scene(timestep, ground=True)
    loaded = load_package(scene, folder, LoadConfig(base="free"), package)
    loaded.reset()
    local = local_vertices(loaded)
    vertices = world_vertices(loaded, local)
    if not len(vertices):
        return StandResult(tilt=np.inf, drift=np.inf, penetration=np.inf, overhang=np.inf)
    loaded.articulation.set_root_pose(sapien.Pose(p=[0.0, 0.0, -float(vertices[:, 2].min())]))
    overhang = overhang_of(loaded, world_vertices(loaded, local))
    start = pose_matrix(loaded.articulation.root_pose)
    _run_free(loaded, STAND_SECONDS, trace)
    end = pose_matrix(loaded.articulation.root_pose)
    trace.append(end.ravel())
    lowest = float(world_vertices(loaded, local)[:, 2].min())
    return StandResult(
        tilt=float(np.degrees(np.arccos(np.clip(end[2, 2] * start[2, 2], -1.0, 1.0)))),
        drift=float(np.linalg.norm(end[:2, 3] - start[:2, 3])),
        penetration=max(0.0, -lowest),
        overhang=overhang,
    )


def overhang_of(loaded: LoadedPackage, vertices: Float[np.ndarray, "V 3"]) -> float:
    """Distance (m) of the centre of mass outside of the support polygon; negative inside.

    Args:
        vertices: Its collision vertices in the world.
    """
    feet = vertices[vertices[:, 2] < vertices[:, 2].min() + FLOOR_BAND][:, :2]
    return measure_overhang(feet, center_of_mass(loaded)[:2])


def center_of_mass(loaded: LoadedPackage) -> Float[np.ndarray, "3"]:
    """Centre of mass of all links in the world."""
    masses = np.array([link.mass for link in loaded.articulation.links])
    centers = np.array(
        [
            (pose_matrix(link.entity_pose) @ pose_matrix(link.cmass_local_pose))[:3, 3]
            for link in loaded.articulation.links
        ]
    )
    if not masses.sum() > 0:
        return centers.mean(axis=0)
    return np.average(centers, axis=0, weights=masses)
