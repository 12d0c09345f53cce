"""L2: handles can be grasped (V204), and stored grasps lie on what they hold (V207).

A handle is a visual whose name contains ``handle``, in the link that it opens; ManiSkill uses the same rule.
Its visual mesh is measured along the direction in which it starts to move; for a door that slides in its own
plane, along the panel normal.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.transforms import frame_along, thin_direction, transform_points
from artigen.types import Joint
from sim_export.checks.config import CheckConfig
from sim_export.checks.opening import PARALLEL, opening_joints, panel_points, velocity_at
from sim_export.checks.registry import CheckSpec, Finding, at_most
from sim_export.checks.subject import Shape, Subject
from sim_export.files.grasp_values import grasps_from_json
from sim_export.geometry.distances import triangle_distances
from sim_export.geometry.grid import Grid, column_crossings
from sim_export.geometry.triangles import meet_box
from sim_export.grasps.gripper import find_gripper
from sim_export.package import Grasp

_COLUMNS = 48
_NEAR = 0.02
"""Farthest (m) from a pad that its link is looked for."""
_DIRECTIONS = np.radians(np.arange(0.0, 180.0, 5.0))


@dataclass(frozen=True, kw_only=True)
class Grip:
    """Clearances around one handle, in metres; ``clearance`` is infinite if there is nothing behind it."""

    front: float
    clearance: float
    width: float
    protrusion: float


def handle_joints(subject: Subject) -> list[Joint]:
    """Joints of doors and drawers; wheels, knobs and buttons are themselves grasped, and trays are lifted."""
    return opening_joints(subject, ("drawer", "door"), ("prismatic", "revolute"))


def handle_shapes(subject: Subject, link: str) -> list[Shape]:
    """Visuals of a link that are handles."""
    return [s for s in subject.visuals if s.link == link and "handle" in s.name and len(s.faces)]


def annotated_links(subject: Subject) -> dict[str, int]:
    """Number of handles of each link in ``annotations.json``."""
    rows = subject.annotations.get("handles", [])
    names = [row.get("link") for row in rows if isinstance(row, dict)]
    return {name: names.count(name) for name in sorted({str(name) for name in names})}


def has_handles(subject: Subject) -> str:
    """Applies to doors and drawers that have a handle or an annotated one."""
    joints = handle_joints(subject)
    if not joints:
        return "there is no door or drawer"
    if any(
        handle_shapes(subject, joint.child) or joint.child in annotated_links(subject) for joint in joints
    ):
        return ""
    return "no door or drawer has a handle; they are opened at their edges"


def check_handles(subject: Subject, cfg: CheckConfig) -> Finding:
    """V204: each handle exists, lies in front of its panel, and can be hooked from behind or pinched."""
    annotated = annotated_links(subject)
    ratios: dict[str, tuple[float, str]] = {}
    for joint in handle_joints(subject):
        name = joint.child
        shapes = handle_shapes(subject, name)
        if not shapes and name in annotated:
            ratios[name] = (np.inf, f"{name!r} should have a handle and shows none")
        if shapes:
            grips = [measure_grip(subject, joint, shape) for shape in shapes]
            ratios[name] = min(judge_grip(grip, name, cfg) for grip in grips)
    where = max(ratios, key=lambda name: ratios[name][0])
    ratio, message = ratios[where]
    hard = [name for name, (ratio, _) in ratios.items() if ratio > 1.0]
    return at_most(float(min(ratio, 1e3)), 1.0, "of the allowed", where=where, message=message, links=hard)


def judge_grip(grip: Grip, name: str, cfg: CheckConfig) -> tuple[float, str]:
    """Ratio to the allowed value for the better of the two grasps (above 1 fails), and a message."""
    if grip.front <= 0.0:
        return (
            np.inf,
            f"the handle of {name!r} lies {1e3 * -grip.front:.3g} mm behind the middle of its panel",
        )
    hook = cfg.min_clearance / max(grip.clearance, 1e-9)
    pinch = max(grip.width / cfg.max_grasp_width, cfg.min_protrusion / max(grip.protrusion, 1e-9))
    text = (
        f"the handle of {name!r} is {1e3 * grip.width:.3g} mm wide, stands out by "
        f"{1e3 * grip.protrusion:.3g} mm and has {1e3 * min(grip.clearance, 9.999):.3g} mm behind it"
    )
    return min(hook, pinch), text


def measure_grip(subject: Subject, joint: Joint, handle: Shape) -> Grip:
    """Measures a handle against the rest of its link, along the approach direction of the hand."""
    center = (handle.vertices.min(axis=0) + handle.vertices.max(axis=0)) / 2.0
    out = way_out(subject, joint, center)
    frame = frame_along(out / np.linalg.norm(out))
    grip = handle.triangles @ frame.T
    rest = [s for s in subject.visuals if s.link == handle.link and "handle" not in s.name and len(s.faces)]
    width = _least_width(handle.vertices @ frame.T)
    if not rest:
        return Grip(front=np.inf, clearance=np.inf, width=width, protrusion=float(np.ptp(grip[..., 2])))
    panel = np.concatenate([s.triangles for s in rest]) @ frame.T
    front = float(center @ frame[2] - (panel[..., 2].min() + panel[..., 2].max()) / 2.0)
    clearance, protrusion = _gaps(grip, panel)
    return Grip(front=front, clearance=clearance, width=width, protrusion=protrusion)


def way_out(subject: Subject, joint: Joint, center: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Outward direction at a handle: its first motion, or the panel normal for a door that slides in its
    plane."""
    way = velocity_at(joint, center[None])[0]
    panel = panel_points(subject, joint.child)
    if joint.type != "prismatic" or subject.labels.get(joint.child) != "door" or not len(panel):
        return way
    middle = (panel.min(axis=0) + panel.max(axis=0)) / 2.0
    normal = thin_direction(panel - middle)
    if abs(normal @ joint.axis) > PARALLEL:
        return way
    return normal if (center - middle) @ normal >= 0.0 else -normal


def _least_width(points: np.ndarray) -> float:
    """Smallest extent in the panel plane, which a gripper must span."""
    across = np.stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])
    return float(np.ptp(points[:, :2] @ across, axis=0).min())


def _gaps(grip: np.ndarray, panel: np.ndarray) -> tuple[float, float]:
    """Free depth behind the middle of the handle, and its protrusion from the panel (m)."""
    low, high = grip.min(axis=(0, 1)), grip.max(axis=(0, 1))
    cell = float((high - low)[:2].max()) / _COLUMNS
    shape = np.maximum(np.ceil((high - low)[:2] / cell), 1).astype(int)
    corner = ((low + high)[:2] - cell * shape) / 2.0  # centred, so that handles thinner than a cell are met
    grid = Grid(low=np.array([*corner, 0.0]), cell=cell, shape=(int(shape[0]), int(shape[1]), 1))
    back = _extreme(grip, grid, np.minimum, np.inf)
    face = _extreme(panel, grid, np.maximum, -np.inf)
    covered = np.isfinite(back)
    if not covered.any():
        return 0.0, 0.0
    along = int(np.argmax((high - low)[:2]))
    place = np.indices(back.shape)[along] / max(back.shape[along] - 1, 1)
    middle = covered & (np.abs(place - 0.5) <= 0.25)
    chosen = middle if middle.any() else covered
    gap = float(np.median(back[chosen] - face[chosen]))
    plate = face[covered & np.isfinite(face)]
    protrusion = float(high[2] - np.median(plate)) if len(plate) else float(high[2] - low[2])
    return max(0.0, gap), protrusion


def _extreme(triangles: np.ndarray, grid: Grid, better: np.ufunc, none: float) -> np.ndarray:
    """Lowest or highest intersection of each column with triangles (m)."""
    column, height, _ = column_crossings(triangles, grid, 2)
    out = np.full(grid.shape[0] * grid.shape[1], none)
    better.at(out, column, height * grid.cell)
    return out.reshape(grid.shape[:2])


def has_grasps(subject: Subject) -> str:
    """Applies to packages with grasps in ``annotations.json``."""
    stored = subject.annotations.get("grasps")
    return "" if stored and stored.get("grasps") else "no grasps are stored"


def check_grasps(subject: Subject, cfg: CheckConfig) -> Finding:
    """V207: both pads of every grasp, closed to its width, touch the visuals of the part that it holds."""
    grasps = grasps_from_json(subject.annotations, subject.poses)
    gaps = [pad_gap(subject, grasp) for grasp in grasps]
    worst = int(np.argmax(gaps))
    gap, where = min(gaps[worst], 1e3), grasps[worst].link
    message = (
        f"a pad of grasp {worst} is {1e3 * min(gap, 9.999):.3g} mm away from {grasps[worst].part!r} of "
        f"{where!r}, which it should touch"
    )
    wrong = [grasp.link for grasp, each in zip(grasps, gaps, strict=True) if each > cfg.max_grasp_gap]
    return at_most(gap, cfg.max_grasp_gap, "m", where=where, message=message, links=wrong)


def pad_gap(subject: Subject, grasp: Grasp) -> float:
    """Distance (m) of the pad that is farther from the visuals of its part, infinite beyond `_NEAR`."""
    low, high = find_gripper(grasp.gripper).pad
    x, z = np.meshgrid(*(np.linspace(low[axis], high[axis], 5) for axis in (0, 2)))
    pads = np.stack([np.stack([x, np.full_like(x, side), z], axis=-1).reshape(-1, 3)
                     for side in (grasp.width / 2.0, -grasp.width / 2.0)])  # fmt: skip
    pads = transform_points(grasp.pose, pads)
    shown = [shape for shape in subject.visuals if shape.link == grasp.link]
    parts = {v["name"]: v["part"] for each in subject.meta.get("links", []) for v in each["visuals"]}
    held = [shape for shape in shown if parts.get(shape.name) == grasp.part]
    shapes = [shape.triangles for shape in held or shown]
    triangles = np.concatenate([np.zeros((0, 3, 3)), *shapes])
    corners = pads.reshape(-1, 3)
    near = triangles[meet_box(triangles, corners.min(axis=0) - _NEAR, corners.max(axis=0) + _NEAR)]
    if not len(near):
        return float("inf")
    points = np.repeat(corners, len(near), axis=0)
    away = triangle_distances(points, np.tile(near, (len(corners), 1, 1)))
    return float(away.reshape(2, -1).min(axis=1).max())


HANDLE_CHECKS = (
    CheckSpec(id="V204", level="L2", title="handles", applies=has_handles, function=check_handles),
    CheckSpec(id="V207", level="L2", title="grasps", applies=has_grasps, function=check_grasps),
)
