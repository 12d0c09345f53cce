"""Converts PartNet's joint annotation: finds the closed pose and measures joints from it.

PartNet states limits ``[a, b]`` relative to the modelled pose, which may be half open. Limits may start
below zero, run backwards, or exclude the modelled pose. ``a`` is nearly always the closed end; `closed_pose`
verifies that by geometry: in the closed pose the part protrudes least from the body's box.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.datasets.partnet_annotation import MOVING_JOINTS, SourceNode
from artigen.transforms import screw_motion
from artigen.types import FIXED, FULL_TURN, Joint, PartLabel

JointKind = Literal["fixed", "revolute", "prismatic", "continuous", "screw"]

HINGE_TOLERANCE = 0.01
"""Poses count as equal if their mean distances outside the body differ by less (in body diagonals) ..."""
OPEN_TOLERANCE = 0.08
"""... or by less than this share of the largest distance."""
BOTH_WAYS = 0.25
"""A part swings both ways if at least this share of its range is on either side of the modelled pose."""
SLIDER_TOLERANCE = 0.1
"""Tolerance of equal poses of sliders, as a share of the travel."""
POSES_TRIED = 61


@dataclass(frozen=True, kw_only=True)
class RestPose:
    """Rest coordinate and far end in PartNet's units (degrees or lengths)."""

    rest: float
    far: float
    note: str = ""


def joint_kind(node: SourceNode) -> JointKind:
    """The joint type of a node; a slider that also turns freely counts as continuous."""
    if node.joint == "hinge":
        return "continuous" if node.unlimited else "fixed" if node.a == node.b else "revolute"
    if node.joint != "slider":
        return "fixed"
    if node.rotates and node.rotation_unlimited:
        return "continuous"
    if node.a == node.b:
        return "fixed"
    return "screw" if node.rotates and node.rotation_limit != 0.0 else "prismatic"


def motion(node: SourceNode, q: Float[np.ndarray, "*B"]) -> Float[np.ndarray, "*B 4 4"]:
    """Motion of the node by its own joint, in PartNet's frame; ``q`` as in `RestPose`."""
    axis = np.array(node.direction) / np.linalg.norm(node.direction)
    still = np.zeros_like(np.asarray(q, dtype=np.float64))
    if node.joint == "hinge":
        return screw_motion(axis, np.array(node.origin), np.radians(q), still)
    return screw_motion(axis, np.array(node.origin), still, q)


def closed_pose(
    node: SourceNode,
    label: PartLabel,
    points: Float[np.ndarray, "N 3"],
    body: Float[np.ndarray, "2 3"],
    *,
    first: tuple[float, ...] = (),
) -> RestPose:
    """Finds the closed pose of a node.

    The first candidate that protrudes from the body no more than the best one wins. Candidates are ``a``,
    then ``b``. Hinged doors and handles first try the modelled pose if it is well between the limits, and
    doors finally try the best pose between them (a window that swings both ways). Sliding doors first try
    the end nearer to the modelled pose. Knobs, buttons and wheels rest at ``a``: pressing a button hides it,
    which does not close it.

    Args:
        points: Points on the part and all that it carries, as modelled.
        body: Lowest and highest corner of the body.
        first: Candidates that come before all others.
    """
    candidates = [node.a, node.b]
    tried = np.linspace(node.a, node.b, POSES_TRIED)
    values = _protrusions(node, tried, points, body)
    if label in ("knob", "wheel"):
        candidates = [node.a]
    elif label == "door" and node.joint == "slider":
        candidates.sort(key=abs)
    elif label in ("door", "handle") and swings_both_ways(node):
        candidates = [0.0, *candidates]
    if label == "door" and node.joint == "hinge":
        candidates.append(float(tried[values <= values.min() + 1e-4].mean()))
    if node.joint == "hinge":
        diagonal = float(np.linalg.norm(body[1] - body[0]))
        tolerance = max(HINGE_TOLERANCE * diagonal, OPEN_TOLERANCE * float(values.max()))
    else:
        tolerance = SLIDER_TOLERANCE * abs(node.b - node.a)
    candidates = [*first, *candidates]
    values = _protrusions(node, np.array(candidates), points, body)
    rest = candidates[int(np.argmax(values <= values.min() + tolerance))]
    far = max(node.a, node.b, key=lambda q: abs(q - rest))
    return RestPose(rest=rest, far=far, note=describe_rest(node, rest, far))


def swings_both_ways(node: SourceNode) -> bool:
    """Whether the modelled pose is well inside the range; near an end, the part was modelled ajar."""
    low, high = sorted((node.a, node.b))
    return low < 0.0 < high and min(-low, high) >= BOTH_WAYS * (high - low)


def _protrusions(node: SourceNode, q: np.ndarray, points: np.ndarray, body: np.ndarray) -> np.ndarray:
    """Mean distance of the points from the body's box at each pose."""
    T = motion(node, q)
    moved = points @ np.swapaxes(T[:, :3, :3], 1, 2) + T[:, None, :3, 3]
    outside = np.maximum(0.0, np.maximum(body[0] - moved, moved - body[1]))
    return np.linalg.norm(outside, axis=-1).mean(axis=1)


def describe_rest(node: SourceNode, rest: float, far: float) -> str:
    """The differences of the closed pose from the pose and range in the files; empty if there are none."""
    unit = " degrees" if node.joint == "hinge" else ""
    where = f"node {node.id} ({node.name}): limits [{node.a:g}, {node.b:g}]{unit}"
    said = []
    if rest != 0.0:
        said.append(f"moved by {rest:g} to its closed pose")
    if rest != node.a:
        said.append("closed at the other end" if rest == node.b else "closed inside the range")
    if rest not in (node.a, node.b):
        said.append(f"range cut to the larger side, {abs(far - rest):g}")
    return f"{where}: {', '.join(said)}" if said else ""


def build_joint(
    node: SourceNode, pose: RestPose, T_unit_partnet: Float[np.ndarray, "4 4"], scale: float
) -> Joint:
    """The joint of a node in the unit cube, measured from its rest pose, opening positively.

    Args:
        T_unit_partnet: Rigid placement of the scaled parent geometry at rest.
        scale: Unit-cube lengths per PartNet length.
    """
    kind = joint_kind(node)
    if kind == "fixed":
        return FIXED
    reach = pose.far - pose.rest
    sign = -1.0 if reach < 0 and kind != "continuous" else 1.0
    axis = T_unit_partnet[:3, :3] @ np.array(node.direction)
    axis = sign * axis / np.linalg.norm(axis)
    origin = T_unit_partnet[:3, :3] @ (scale * np.array(node.origin)) + T_unit_partnet[:3, 3]
    match kind:
        case "continuous":
            return Joint(type=kind, axis=axis, origin=origin, upper=FULL_TURN)
        case "revolute":
            return Joint(type=kind, axis=axis, origin=origin, upper=float(np.radians(abs(reach))))
        case "prismatic":
            return Joint(type=kind, axis=axis, origin=origin, upper=abs(reach) * scale)
        case "screw":
            turn = float(np.radians(abs(node.rotation_limit)))
            return Joint(type=kind, axis=axis, origin=origin, upper=turn, pitch=abs(reach) * scale / turn)


def describe_joint(node: SourceNode) -> str:
    """How the joint was simplified; empty if it is as annotated."""
    kind = joint_kind(node)
    where = f"node {node.id} ({node.name})"
    if kind == "continuous" and node.joint == "slider":
        return f"{where} turns freely and slides by {abs(node.b - node.a):g}; the slide was dropped"
    if kind == "fixed" and node.joint in MOVING_JOINTS:
        return f"{where}: limits [{node.a:g}, {node.b:g}] leave no motion, made fixed"
    if kind == "screw":
        return f"{where}: slides and turns by {node.rotation_limit:g} degrees, read as one screw"
    length = float(np.linalg.norm(node.direction))
    if kind != "fixed" and abs(length - 1.0) > 0.02:
        return f"{where}: axis direction had length {length:.3g}, normalised"
    return ""
