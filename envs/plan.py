"""Trial plans of joints: efforts, requirements, directions, and groups that can be tested at the same time.

Testing every joint alone is exact but slow. Joints whose swept volumes are disjoint cannot affect each other,
so they move together; the others have separate runs.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.transforms import rotation_about
from sim_export.motion.kinematics import needed_fractions

from .hand import Moved, hand_effort, measure_moved, weight_effort
from .sim.loaded import LoadedJoint, LoadedPackage, qpos_of

SWEEP_SAMPLES = 13
SPEED_MARGIN = 1.5


@dataclass(frozen=True, kw_only=True, eq=False)
class JointPlan:
    """Trial of one joint.

    ``opening`` and ``closing`` are efforts (N or N m) including the weight that the hand carries.
    ``needs`` are joints that are open during the trial. ``speed_limit`` bounds the joint's speed (m/s or
    rad/s) by the applied work; ``lean`` is the horizontal direction in which a tilt would open the joint,
    zero if there is none.
    """

    opening: float
    closing: float
    needs: tuple[str, ...]
    speed_limit: float
    lean: Float[np.ndarray, "3"]
    axis: Float[np.ndarray, "3"]

    def effort(self, direction: float) -> float:
        """Effort in a direction: > 0 opens."""
        return self.opening if direction > 0 else self.closing


@dataclass(frozen=True, kw_only=True, eq=False)
class TrialPlan:
    """Plans in the order of ``LoadedPackage.joints``, and groups of their indices that run together."""

    joints: tuple[JointPlan, ...]
    groups: tuple[tuple[int, ...], ...]


def plan_trials(loaded: LoadedPackage) -> TrialPlan:
    """Measures every joint of a fixed-base object and groups the independent ones."""
    plans, swept = [], []
    for joint in loaded.joints:
        needs = tuple(needed_fractions(joint.spec.name, loaded.package.requires_open))
        at_limits = {name: loaded.joint(name).spec.upper for name in needs}
        loaded.articulation.set_qpos(
            qpos_of(loaded, at_limits | {joint.spec.name: joint.lower}).astype(np.float32)
        )
        moved = measure_moved(joint)
        plans.append(_plan(joint, moved, needs))
        swept.append(_swept_box(joint, moved))
    loaded.reset()
    return TrialPlan(joints=tuple(plans), groups=_group(plans, np.array(swept).reshape(-1, 2, 3)))


def _plan(joint: LoadedJoint, moved: Moved, needs: tuple[str, ...]) -> JointPlan:
    hand = hand_effort(joint, moved)
    travel = np.linspace(0.0, joint.span, SWEEP_SAMPLES)
    weight = weight_effort(joint, moved, travel) - joint.spec.spring - joint.spec.stiffness * travel
    opening = hand + max(0.0, float(-weight.min()))
    closing = hand + max(0.0, float(weight.max()))
    # Work of the largest effort plus the largest work of gravity, converted completely to speed.
    work = (max(opening, closing) + float(np.abs(weight).max())) * joint.span
    load = moved.mass if joint.spec.type == "prismatic" else moved.inertia
    if joint.spec.type == "prismatic":
        lean = moved.axis.copy()
    else:
        lean = np.cross(moved.axis, moved.com - moved.origin)
    lean[2] = 0.0
    length = np.linalg.norm(lean)
    return JointPlan(
        opening=opening,
        closing=closing,
        needs=needs,
        speed_limit=SPEED_MARGIN * float(np.sqrt(2.0 * work / max(load, 1e-9))),
        lean=lean / length if length > 1e-3 else np.zeros(3),
        axis=moved.axis,
    )


def _swept_box(joint: LoadedJoint, moved: Moved) -> np.ndarray:
    """Bounds of everything the joint moves, over its whole range and not only at the sampled poses."""
    if not len(moved.vertices):
        return np.stack([moved.origin, moved.origin])
    travel = np.linspace(0.0, joint.span, SWEEP_SAMPLES)
    bulge = 0.0
    if joint.spec.type == "prismatic":
        points = moved.vertices + travel[[0, -1], None, None] * moved.axis
    else:
        turns = rotation_about(moved.axis, travel)
        arms = moved.vertices - moved.origin
        points = arms @ np.swapaxes(turns, -1, -2) + moved.origin
        # Between two samples a point leaves their chord by this much: the corner of a square knob.
        radius = float(np.linalg.norm(np.cross(moved.axis, arms), axis=1).max())
        bulge = radius * (1.0 - np.cos(joint.span / (SWEEP_SAMPLES - 1) / 2.0))
    points = points.reshape(-1, 3)
    return np.stack([points.min(axis=0) - bulge, points.max(axis=0) + bulge])


def _group(plans: list[JointPlan], swept: np.ndarray) -> tuple[tuple[int, ...], ...]:
    """Greedy colouring: equal requirements, and disjoint swept boxes."""
    groups: list[list[int]] = []
    for index, plan in enumerate(plans):
        for group in groups:
            same = all(plans[other].needs == plan.needs for other in group)
            apart = all(_boxes_apart(swept[index], swept[other]) for other in group)
            if same and apart:
                group.append(index)
                break
        else:
            groups.append([index])
    return tuple(tuple(group) for group in groups)


def _boxes_apart(a: np.ndarray, b: np.ndarray) -> bool:
    return bool(((a[0] > b[1]) | (b[0] > a[1])).any())
