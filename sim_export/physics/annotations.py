"""Annotates handles and knobs: position, direction, grasp and motion.

Everything is measured on the part meshes at rest. The outward normal is the direction with the carrier behind
the handle and nothing in front of it. The box is the smallest one around the handle with an axis along that
normal. Of a handle that passes through its carrier, like a door's two levers on one spindle, only the side
towards which the carrier opens is annotated. Clearance comes from rays through the bar to the surface behind
it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.types import Asset, Joint, Part
from sim_export.geometry.rays import bar_depths, first_hits, free_depths, hit_cosines, plane_axes
from sim_export.geometry.triangles import meet_box
from sim_export.package import HandleAnnotation, Mesh
from sim_export.physics.links import LinkTree, link_names, link_owners

SNAP_DEGREES = 5.0
"""Normals closer than this to one of the object's axes are that axis; closer to each other, they agree."""
MAX_TILT_DEGREES = 35.0
"""Largest angle between a handle's outward direction and the face that it lies along."""
AGREEMENT = 0.6
"""Share of the rays behind a handle that must agree on a face's normal."""
REACH = 0.15
"""Search distance (m) for the carrier behind a handle; also the largest clearance reported."""
RAYS = 15
"""Rays along a handle; more resolve thinner legs."""
FINGERS = 3
"""Neighbouring rays with free depth behind a bar that fingers need: a sixth of its length."""
BACK_SIDE = 0.01
"""Length (m) from which the end of a handle that comes out behind its carrier is a second side."""
BAR_RATIO = 2.0
"""Ratio of length to width from which a fixed handle is a line handle instead of a round one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Frame:
    """Box of a handle: rows of ``axes`` are its normal, its long and its short direction."""

    center: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "3 3"]
    size: Float[np.ndarray, "3"]


def annotate_handles(asset: Asset, meshes: Sequence[Mesh], tree: LinkTree) -> tuple[HandleAnnotation, ...]:
    """Annotates every handle and knob that moves with a link; those fixed to the body are skipped.

    A movable part without handle or knob has no annotation.

    Args:
        meshes: One mesh per part (metres, object frame at rest); an empty one is skipped.
        tree: Links of the asset, from `build_links`.
    """
    owners, names = link_owners(asset), link_names(asset)
    joints = {joint.child: joint for joint in tree.joints}
    triangles = [mesh.vertices[mesh.faces] for mesh in meshes]
    out = []
    for index, part in enumerate(asset.parts):
        if part.label not in ("handle", "knob") or owners[index] == asset.root or not len(triangles[index]):
            continue
        link = names[owners[index]]
        carrier, leaf = triangles[part.parent], joints.get(names[owners[part.parent]])
        others = np.concatenate([found for k, found in enumerate(triangles) if k != index])
        out.append(_annotate(part, link, joints[link], leaf, triangles[index], carrier, others))
    return tuple(out)


def _annotate(
    part: Part,
    link: str,
    joint: Joint,
    leaf: Joint | None,
    triangles: Float[np.ndarray, "F 3 3"],
    carrier: Float[np.ndarray, "G 3 3"],
    others: Float[np.ndarray, "H 3 3"],
) -> HandleAnnotation:
    """One handle on ``carrier``, which ``leaf`` moves, or ``None`` if it is fixed to the body."""
    points = triangles.reshape(-1, 3)
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    motion = joint_velocity(joint, center)
    in_place = joint.type != "prismatic" and np.linalg.norm(motion) < np.ptp(points, axis=0).max() / 4
    guide = np.asarray(joint.axis) if in_place else motion / np.linalg.norm(motion)
    pull = guide if leaf is None else joint_velocity(leaf, center)
    if part.label == "handle" and part.joint.type == "prismatic":
        points = _leading_bar(triangles, motion)
    carrier = _near(carrier, points)
    normal = _outward_normal(points, carrier, guide, pull / max(float(np.linalg.norm(pull)), 1e-9))
    frame = _box_along(_front_side(points, normal, carrier), normal)
    if part.label == "knob":
        half = 0.4 * frame.size[1] * frame.axes[1]
        line = np.stack([frame.center - half, frame.center + half])
        clearance = min(_stand_off(frame, carrier), REACH)
    else:
        clearance, line = _grip(frame, triangles, _near(others, points))
    direction = motion
    if in_place:  # its outline moves, while its centre hardly does
        direction = joint_velocity(joint, line[1])
    if np.linalg.norm(direction) < 1e-9:
        direction = joint.axis
    return HandleAnnotation(
        link=link,
        part=part.name,
        corners=_corners(frame),
        normal=frame.axes[0],
        grasp_line=line,
        width=float(frame.size[2]),
        clearance=clearance,
        opening_direction=direction / np.linalg.norm(direction),
        gapart=gapart_class(part, float(frame.size[1] / max(frame.size[2], 1e-9))),
    )


def joint_velocity(joint: Joint, point: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Velocity of a point per unit of joint speed, at rest; the small travel of a screw is ignored."""
    if joint.type == "prismatic" and not joint.is_travel:
        return np.array(joint.axis)
    axis = np.asarray(joint.axis)
    return np.cross(axis, point - joint.origin)


def gapart_class(part: Part, ratio: float) -> str:
    """GAPartNet class of a handle or knob whose length is ``ratio`` times its width."""
    if part.label == "knob" and part.joint.type == "prismatic":
        return "slider_button"
    if part.joint.type != "fixed":
        return "hinge_knob" if part.label == "knob" else "hinge_handle"
    return "line_fixed_handle" if ratio >= BAR_RATIO else "round_fixed_handle"


def _near(
    triangles: Float[np.ndarray, "F 3 3"], points: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "G 3 3"]:
    """Triangles whose boxes come within `REACH` of the points' box."""
    low, high = points.min(axis=0) - REACH, points.max(axis=0) + REACH
    return triangles[meet_box(triangles, low, high)]


def _outward_normal(
    points: Float[np.ndarray, "N 3"],
    carrier: Float[np.ndarray, "F 3 3"],
    guide: Float[np.ndarray, "3"],
    pull: Float[np.ndarray, "3"],
) -> Float[np.ndarray, "3"]:
    """The direction with the carrier behind the handle and none of it in front.

    Candidates are the object's axes and the ``guide``: the handle's first motion, or its joint's axis if it
    turns in place. Among several, the one closest to the guide wins, of two opposite ones the one towards
    ``pull``, the first motion of the carrier; a face counts by the cosine at which it is seen, because the
    guide of a grip high above its hinge slants across the lid. The direction is then aligned with the
    carrier's face behind the handle.
    """
    candidates = np.concatenate([np.eye(3), -np.eye(3), [guide, -guide]])
    scores = []
    for direction in candidates:
        grid = _silhouette(points, direction)
        depth = np.ptp(points @ direction) + REACH
        behind = hit_cosines(grid, -direction, carrier, depth).mean()
        before = (hit_cosines(grid, direction, carrier, depth) > 0.0).mean()
        scores.append(behind - before + 0.3 * abs(direction @ guide) + 1e-3 * (direction @ pull))
    best = candidates[int(np.argmax(np.round(scores, 9)))]
    return _lay_along(best, _silhouette(points, best), carrier)


def _leading_bar(
    triangles: Float[np.ndarray, "F 3 3"], motion: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "N 3"]:
    """Points of the bar that a telescopic handle is pulled out by: as far from its leading end as rays run in
    it, in the median."""
    points = triangles.reshape(-1, 3)
    grid = _silhouette(points, motion)
    backs = bar_depths(grid + 1e-3 * motion, -motion, triangles)[1]
    backs = backs[np.isfinite(backs)]
    if not len(backs):
        return points
    depth = points @ motion
    return points[depth >= depth.max() - float(np.median(backs))]


def _front_side(
    points: Float[np.ndarray, "N 3"], normal: Float[np.ndarray, "3"], carrier: Float[np.ndarray, "F 3 3"]
) -> Float[np.ndarray, "N 3"]:
    """The points, of which those behind the carrier's face are moved up to it. A handle whose end stands out
    behind the carrier by less than `BACK_SIDE` stays whole."""
    front = _surface(points, normal, carrier)
    back = -_surface(points, -normal, carrier)
    depth = points @ normal
    if not (depth.max() > front and depth.min() < back - BACK_SIDE):
        return points
    return points + np.maximum(front - depth, 0.0)[:, None] * normal


def _surface(
    points: Float[np.ndarray, "N 3"], direction: Float[np.ndarray, "3"], carrier: Float[np.ndarray, "F 3 3"]
) -> float:
    """Median position along ``direction`` of the carrier's surface that faces it, over the handle's outline;
    minus infinity if most rays miss."""
    grid = _silhouette(points, direction)
    distances, _ = first_hits(grid, -direction, carrier, entering=True)
    return float(grid[0] @ direction - np.median(distances))


def _lay_along(
    direction: Float[np.ndarray, "3"], grid: Float[np.ndarray, "R 3"], carrier: Float[np.ndarray, "F 3 3"]
) -> Float[np.ndarray, "3"]:
    """The carrier's normal behind the handle, if most rays agree on one; nearby object axes take
    precedence."""
    normal = direction
    distances, normals = first_hits(grid, -direction, carrier, entering=True)
    hit = np.isfinite(distances)
    normals = normals[hit & (normals @ direction > np.cos(np.radians(MAX_TILT_DEGREES)))]
    if len(normals):
        alike = normals @ normals.T > np.cos(np.radians(SNAP_DEGREES))
        most = int(alike.sum(axis=1).argmax())
        if alike[most].sum() > AGREEMENT * hit.sum():
            mean = normals[alike[most]].sum(axis=0)
            normal = mean / np.linalg.norm(mean)
    nearest = int(np.abs(normal).argmax())
    if abs(normal[nearest]) > np.cos(np.radians(SNAP_DEGREES)):
        normal = np.sign(normal[nearest]) * np.eye(3)[nearest] + 0.0
    return normal


def _silhouette(points: Float[np.ndarray, "N 3"], direction: Float[np.ndarray, "3"]) -> np.ndarray:
    """A grid over the outermost face of the points' box, shifted off the centre to avoid edges."""
    u, v = plane_axes(direction)
    steps = np.array([0.13, 0.31, 0.52, 0.71, 0.88])
    low_u, low_v = (points @ u).min(), (points @ v).min()
    grid_u = low_u + steps * np.ptp(points @ u)
    grid_v = low_v + steps * np.ptp(points @ v)
    top = (points @ direction).max()
    a, b = (axis.ravel() for axis in np.meshgrid(grid_u, grid_v))
    return a[:, None] * u + b[:, None] * v + top * direction


def _box_along(points: Float[np.ndarray, "N 3"], normal: Float[np.ndarray, "3"]) -> _Frame:
    """The smallest box with one axis along ``normal``: least area over the sides of the 2D hull."""
    from scipy.spatial import ConvexHull, QhullError

    u, v = plane_axes(normal)
    flat = np.stack([points @ u, points @ v], axis=1)
    angles = [0.0]
    try:
        outline = flat[ConvexHull(flat).vertices]
        sides = np.roll(outline, -1, axis=0) - outline
        angles += sorted(np.unique(np.round(np.arctan2(sides[:, 1], sides[:, 0]) % (np.pi / 2), 6)).tolist())
    except QhullError:  # collinear in projection: use the direction of the line
        spread = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=False)[2][0]
        angles = [float(np.arctan2(spread[1], spread[0]))]
    areas = [np.prod(np.ptp(flat @ _turn(angle), axis=0)) for angle in angles]
    best = angles[int(np.argmin(np.round(areas, 8)))]
    turn = _turn(best)
    axes = np.stack([normal, *(turn.T @ np.stack([u, v]))])
    if np.ptp(points @ axes[2]) > np.ptp(points @ axes[1]) + 1e-9:
        axes = np.stack([axes[0], axes[2], -axes[1]])
    local = points @ axes.T
    low, high = local.min(axis=0), local.max(axis=0)
    return _Frame(center=(low + high) / 2 @ axes, axes=axes, size=high - low)


def _turn(angle: float) -> Float[np.ndarray, "2 2"]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def _corners(frame: _Frame) -> Float[np.ndarray, "8 3"]:
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return frame.center + (signs * frame.size / 2) @ frame.axes


def _grip(
    frame: _Frame, triangles: Float[np.ndarray, "F 3 3"], behind: Float[np.ndarray, "G 3 3"]
) -> tuple[float, Float[np.ndarray, "2 3"]]:
    """Clearance behind a bar and its grasp line, from rays along its middle and its two sides.

    The clearance is the largest depth that is free along `FINGERS` neighbouring rays. The line runs through
    the middle of the bar over the stretch where most of that depth is free. Without free depth it runs
    through the middle of the box.
    """
    normal, along, across = frame.axes
    steps = ((np.arange(RAYS) + 0.5) / RAYS - 0.5) * frame.size[1]
    start = frame.center + normal * (frame.size[0] / 2 + 1e-3)
    free = np.full(RAYS, np.inf)
    middle = np.zeros(RAYS)
    for side in (-0.3, 0.0, 0.3):
        origins = start + side * frame.size[2] * across + steps[:, None] * along
        fronts, backs = bar_depths(origins, -normal, triangles)
        depth = free_depths(origins, -normal, backs, behind)
        free = np.minimum(free, np.where(np.isfinite(backs), depth, 0.0 if side == 0.0 else np.inf))
        if side == 0.0:
            middle = (fronts + backs) / 2
    free = np.minimum(free, REACH)
    stretches = np.lib.stride_tricks.sliding_window_view(free, FINGERS).min(axis=1)
    clearance = float(stretches.max())
    if clearance < 1e-4:
        half = 0.4 * frame.size[1] * along
        return 0.0, np.stack([frame.center - half, frame.center + half])
    low, high = _run_around(free >= 0.8 * clearance, int(stretches.argmax()))
    origins = start + steps[[low, high - 1], None] * along
    return clearance, origins - float(np.median(middle[low:high])) * normal


def _stand_off(frame: _Frame, carrier: Float[np.ndarray, "F 3 3"]) -> float:
    """Distance between a knob's back and the carrier around it; 0 if it touches or there is no carrier.

    Voxels under a knob belong to the knob, so its carrier often has a hole there. The rays therefore pass the
    knob's outline instead of crossing it.
    """
    normal, along, across = frame.axes
    turn = np.linspace(0.0, 2 * np.pi, 16, endpoint=False)[:, None]
    ring = np.cos(turn) * along * frame.size[1] + np.sin(turn) * across * frame.size[2]
    origins = frame.center + normal * (frame.size[0] / 2 + 1e-3) + 0.75 * ring
    depths = free_depths(origins, -normal, np.zeros(len(origins)), carrier)
    depths = depths[np.isfinite(depths)]
    return max(0.0, float(np.median(depths)) - 1e-3 - float(frame.size[0])) if len(depths) else 0.0


def _run_around(flags: np.ndarray, index: int) -> tuple[int, int]:
    """Start and end of the run of true values that contains ``index``."""
    low = high = index
    while low > 0 and flags[low - 1]:
        low -= 1
    while high < len(flags) and flags[high]:
        high += 1
    return low, high
