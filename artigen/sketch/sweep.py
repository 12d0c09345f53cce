"""Collisions of a moving part along the range of its joint.

Few pairs of primitives can ever collide. Axis-aligned boxes on slides have closed formulas. For rotations,
pairs are pruned whose heights along the axis, distances from it or angles about it never overlap. The
remaining pairs are tested pose by pose.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.shapes.poses import pose_parts
from artigen.shapes.shape import Shape
from artigen.sketch.contact import Bodies, displace, penetrate, separate
from artigen.transforms import frame_along, screw_motion, transform_points
from artigen.types import FULL_TURN, Joint

TOUCH = 1e-4
"""Penetration (m) below which solids count as disjoint."""
STEP = 0.005
"""Largest displacement (m) of a point between consecutive poses."""
POSES = (21, 401)
"""Smallest and largest number of poses over a range."""
RUN = 16
"""Consecutive poses that are pruned together."""
_ON_AXIS = 1e-6


@dataclass(frozen=True, kw_only=True, eq=False)
class Path:
    """Screw motion of a part about a line, in the object frame with all required parts open."""

    axis: Float[np.ndarray, "3"]
    origin: Float[np.ndarray, "3"]
    turn: float
    """Radians over the whole range."""
    travel: float
    """Metres along the axis over the whole range."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Meetings:
    """Penetrations along a path deeper than `TOUCH`: primitives, pose and depth (m, upper bound unless
    exact); exact ones, of boxes on slides, have no pose."""

    first: Int[np.ndarray, "C"]
    second: Int[np.ndarray, "C"]
    T: Float[np.ndarray, "C 4 4"]
    depth: Float[np.ndarray, "C"]
    exact: Bool[np.ndarray, "C"]


def read_path(motion: Joint, T_parent: Float[np.ndarray, "4 4"]) -> Path:
    """Path of a part whose parent is displaced from rest."""
    slides = motion.type == "prismatic"
    upper = FULL_TURN if motion.type == "continuous" else motion.upper
    return Path(
        axis=T_parent[:3, :3] @ motion.axis,
        origin=transform_points(T_parent, motion.origin[None])[0],
        turn=0.0 if slides else upper,
        travel=upper if slides else motion.pitch * upper,
    )


def open_needed(shape: Shape, index: int) -> Float[np.ndarray, "P 4 4"]:
    """Displacement of every part with the requirements of one part open, recursively."""
    rows = {part.name: row for row, part in enumerate(shape.parts)}
    qpos, waiting, seen = np.zeros(len(shape.parts)), [index], set()
    while waiting:
        for need in shape.parts[waiting.pop()].needs:
            row = rows[need.part]
            motion = shape.parts[row].joint
            if row not in seen and motion is not None:
                upper = FULL_TURN if motion.type == "continuous" else motion.upper
                qpos[row] = need.fraction * upper
                seen.add(row)
                waiting.append(row)
    return pose_parts(shape, qpos) if seen else np.tile(np.eye(4), (len(qpos), 1, 1))


def place_opened(bodies: Bodies, T: Float[np.ndarray, "P 4 4"]) -> Bodies:
    """The primitives of displaced parts."""
    moved = np.flatnonzero(np.any(np.eye(4) != T, axis=(1, 2))[bodies.parts])
    return displace(bodies, moved, T[bodies.parts[moved]]) if len(moved) else bodies


def find_meetings(bodies: Bodies, path: Path, carried: Bool[np.ndarray, "N"]) -> Meetings:
    """Penetrations of primitives that move along a path.

    Args:
        bodies: All primitives, at the start of the path.
        carried: Primitives that move.
    """
    ours, others = np.flatnonzero(carried), np.flatnonzero(~carried)
    if path.turn == 0.0 and np.abs(path.axis).max() > 1.0 - 1e-9:
        first, second, depth = _sliding_pairs(bodies, path, ours, others)
        known = bodies.upright[first] & bodies.upright[second]
    else:
        first, second = _turning_pairs(bodies, path, ours, others)
        depth, known = np.zeros(len(first)), np.zeros(len(first), dtype=bool)
    rows, T, deep = _measure(bodies, path, ours, first[~known], second[~known])
    return Meetings(
        first=np.concatenate([first[known], first[~known][rows]]),
        second=np.concatenate([second[known], second[~known][rows]]),
        T=np.concatenate([np.tile(np.eye(4), (int(known.sum()), 1, 1)), T]),
        depth=np.concatenate([depth[known], deep]),
        exact=np.arange(known.sum() + len(rows)) < known.sum(),
    )


def deepest(bodies: Bodies, found: Meetings, rows: Int[np.ndarray, "M"]) -> tuple[float, int]:
    """Exact depth (m) of the deepest of some penetrations, and its row; 0 and -1 if none is deep."""
    best, at = 0.0, -1
    order = rows[np.argsort(-found.depth[rows], kind="stable")]
    pairs = found.first[order] * len(bodies.parts) + found.second[order]
    for pair in dict.fromkeys(pairs.tolist()):
        same = order[pairs == pair]
        same = same[found.depth[same] > best]
        if not len(same):
            continue
        if found.exact[same[0]]:
            depth = float(found.depth[same[0]])
        else:
            depth = penetrate(bodies, int(found.first[same[0]]), int(found.second[same[0]]), found.T[same])
        if depth > best:
            best, at = depth, int(same[0])
    return best, at


def _sliding_pairs(
    bodies: Bodies, path: Path, ours: Int[np.ndarray, "M"], others: Int[np.ndarray, "O"]
) -> tuple[Int[np.ndarray, "C"], Int[np.ndarray, "C"], Float[np.ndarray, "C"]]:
    """Pairs whose bounds overlap along a slide, and their depth (m); exact for axis-aligned boxes."""
    ahead = bodies.high[ours][:, None] - bodies.low[others][None]
    behind = bodies.high[others][None] - bodies.low[ours][:, None]
    way = path.axis * path.travel
    level = (ahead + behind) / 2  # where the centres align, both ways out are equally long
    shared = np.minimum(level, np.minimum(ahead + way.clip(min=0), behind - way.clip(max=0)))
    depth = shared.min(axis=2)
    i, j = np.nonzero(depth > TOUCH)
    return ours[i], others[j], depth[i, j]


def _turning_pairs(
    bodies: Bodies, path: Path, ours: Int[np.ndarray, "M"], others: Int[np.ndarray, "O"]
) -> tuple[Int[np.ndarray, "C"], Int[np.ndarray, "C"]]:
    """Pairs that may collide: heights along the axis, distances from it and angles about it overlap."""
    frame = frame_along(path.axis).T.copy()  # as columns
    local = (bodies.vertices - path.origin) @ frame
    low, high = local.min(axis=1), local.max(axis=1)
    outer = np.linalg.norm(local[:, :, :2], axis=2).max(axis=1)
    inner = np.linalg.norm(np.maximum(low, -high)[:, :2].clip(min=0.0), axis=1)
    bottom, top = low[ours, 2] + min(0.0, path.travel), high[ours, 2] + max(0.0, path.travel)
    heights = np.minimum(top[:, None], high[others, 2]) - np.maximum(bottom[:, None], low[others, 2])
    rings = np.minimum(outer[ours, None], outer[others]) - np.maximum(inner[ours, None], inner[others])
    i, j = np.nonzero((heights > TOUCH) & (rings > TOUCH))
    first, second = ours[i], others[j]
    if path.turn == 0.0 or not len(first):
        return first, second
    rows, place = np.unique(np.concatenate([first, second]), return_inverse=True)
    normals = bodies.planes[rows][:, :, :3] @ frame[:, :2]
    closest, start, width = _see_from_axis(local[rows, :, :2], normals)
    one, other = place[: len(first)], place[len(first) :]
    apart = np.maximum(closest[one], closest[other]) > np.minimum(outer[first], outer[second]) - TOUCH
    ahead = (start[other] - start[one]) % FULL_TURN
    beside = (ahead > width[one] + path.turn - _ON_AXIS) & (ahead + width[other] < FULL_TURN + _ON_AXIS)
    kept = ~(apart | beside)
    return first[kept], second[kept]


def _see_from_axis(
    corners: Float[np.ndarray, "R V 2"], normals: Float[np.ndarray, "R K 2"]
) -> tuple[Float[np.ndarray, "R"], Float[np.ndarray, "R"], Float[np.ndarray, "R"]]:
    """Distance of convex solids from an axis (m), their start angle and their angular extent.

    A solid that contains the axis starts at 0 and spans the full turn.
    """
    ways = np.concatenate([corners, -normals], axis=1)
    lengths = np.linalg.norm(ways, axis=2, keepdims=True)
    ways = np.where(lengths > 1e-9, ways / np.maximum(lengths, 1e-9), 0.0)
    reach = (ways @ np.swapaxes(corners, 1, 2)).min(axis=2)
    reach[lengths[:, :, 0] <= 1e-9] = -np.inf
    best = reach.argmax(axis=1)
    rows = np.arange(len(corners))
    ahead, closest = ways[rows, best], reach[rows, best]
    along = np.einsum("rvi,ri->rv", corners, ahead)
    aside = corners[:, :, 1] * ahead[:, None, 0] - corners[:, :, 0] * ahead[:, None, 1]
    angles = np.where(np.hypot(along, aside) > _ON_AXIS, np.arctan2(aside, along), 0.0)
    around = closest < -_ON_AXIS
    start = np.where(around, 0.0, np.arctan2(ahead[:, 1], ahead[:, 0]) + angles.min(axis=1))
    return closest.clip(min=0.0), start, np.where(around, FULL_TURN, np.ptp(angles, axis=1))


def _measure(
    bodies: Bodies,
    path: Path,
    ours: Int[np.ndarray, "M"],
    first: Int[np.ndarray, "C"],
    second: Int[np.ndarray, "C"],
) -> tuple[Int[np.ndarray, "R"], Float[np.ndarray, "R 4 4"], Float[np.ndarray, "R"]]:
    """Penetrations of pairs, pose by pose: row of the pair, displacement of its first, depth (m, upper
    bound)."""
    if not len(first):
        return first, np.zeros((0, 4, 4)), np.zeros(0)
    arms = np.linalg.norm(np.cross(path.axis, bodies.vertices - path.origin), axis=2).max(axis=1)
    way = path.turn * float(arms[ours].max()) if path.turn else path.travel
    T = _sample_poses(path, way)
    row, pose = _close_poses(bodies, path, first, second, np.minimum(arms[first], arms[second]), len(T))
    depth = _shared_depth(bodies, T[pose], first[row], second[row])
    met = np.flatnonzero(depth > TOUCH)
    row, pose, depth = row[met], pose[met], depth[met]
    slanted = np.flatnonzero(~(bodies.upright[first[row]] & bodies.upright[second[row]]))
    apart = separate(bodies, first[row[slanted]], second[row[slanted]], T[pose[slanted]])
    depth[slanted] = np.minimum(depth[slanted], -apart)
    deep = depth > TOUCH
    return row[deep], T[pose[deep]], depth[deep]


def _sample_poses(path: Path, way: float) -> Float[np.ndarray, "P 4 4"]:
    """Displacements along a path on which the farthest point travels ``way`` (m)."""
    share = np.linspace(0.0, 1.0, int(np.clip(np.ceil(way / STEP) + 1, *POSES)))
    return screw_motion(path.axis, path.origin, path.turn * share, path.travel * share)


def _close_poses(
    bodies: Bodies,
    path: Path,
    first: Int[np.ndarray, "C"],
    second: Int[np.ndarray, "C"],
    arms: Float[np.ndarray, "C"],
    count: int,
) -> tuple[Int[np.ndarray, "R"], Int[np.ndarray, "R"]]:
    """Pairs and poses to test: every run of `RUN` poses whose bounds nearly overlap at its middle pose.

    Colliding points lie within ``arms`` (m) of the axis, which limits their distance from the middle pose.
    """
    starts = np.arange(0, count, RUN)
    ends = np.minimum(starts + RUN, count) - 1
    middle, half = (starts + ends) / (2 * (count - 1)), (ends - starts) / (2 * (count - 1))
    T = screw_motion(path.axis, path.origin, path.turn * middle, path.travel * middle)
    runs, pairs = np.divmod(np.arange(len(starts) * len(first)), len(first))
    near = half[runs] * (path.turn * arms[pairs] + abs(path.travel))
    met = _shared_depth(bodies, T[runs], first[pairs], second[pairs]) + near > 0
    runs, pairs = runs[met], pairs[met]
    poses = starts[runs, None] + np.arange(RUN)
    kept = poses <= ends[runs, None]
    return np.broadcast_to(pairs[:, None], poses.shape)[kept], poses[kept]


def _shared_depth(
    bodies: Bodies, T: Float[np.ndarray, "R 4 4"], first: Int[np.ndarray, "R"], second: Int[np.ndarray, "R"]
) -> Float[np.ndarray, "R"]:
    """Penetration (m) of the bounds of displaced solids with those of others, the smaller over both frames.

    For axis-aligned boxes this is the exact depth unless two edges separate them.
    """
    middle, half = (bodies.low + bodies.high) / 2, (bodies.high - bodies.low) / 2
    turn = T[:, :3, :3]
    size = np.abs(turn)
    between = (turn @ middle[first][:, :, None])[:, :, 0] + T[:, :3, 3] - middle[second]
    seen = (size @ half[first][:, :, None])[:, :, 0] + half[second] - np.abs(between)
    back = np.swapaxes(turn, 1, 2)
    behind = (back @ between[:, :, None])[:, :, 0]
    turned = (np.swapaxes(size, 1, 2) @ half[second][:, :, None])[:, :, 0] + half[first] - np.abs(behind)
    return np.minimum(seen.min(axis=1), turned.min(axis=1))
