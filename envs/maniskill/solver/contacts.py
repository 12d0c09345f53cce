"""Contacts at which closed fingers can push a part, and at which open ones can pinch it.

Candidates are points on the part's own hulls near its grip, also inside a leaf that stands ajar; one is valid
if the hand around it collides with nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.transforms import inverse, rotation_about, transform_points
from artigen.types import Joint
from sim_export.geometry.hulls import hull_planes
from sim_export.package import Hull

from ..placement import part_motion
from .body import HAND_GAP, Body, first_of_each, triangle_points
from .field import distances
from .grasp import SPARE, TIP, Grasps, across, gripper_pose
from .opening import Opening

NEAR = 0.20
"""Search distance from the grip, metres."""
SPACING = 0.012
MOST_POINTS = 90
OUT = 0.007
"""Free distance required in front of a surface point, metres."""
ALONG = 0.75
"""Smallest cosine between a push and the motion of its point."""
LEVER = 0.35
"""Smallest distance of a pushed point from the axis, relative to the largest."""
FINGER = 0.011
"""Half the thickness of the closed fingers, metres."""
TOUCHING = 0.022
"""Distance of hand points from the contact within which they may touch, metres."""
CLEAR = 0.003
"""Clearance of the rest of the hand, metres."""
LEANS = np.radians([0.0, 30.0, 60.0, 90.0])
"""Angles of the fingers from the direction of the push; at 90 degrees their side pushes."""
AROUND = 8
THIN = 0.002
KEPT = 240


@dataclass(frozen=True, kw_only=True, eq=False)
class Contacts:
    """Tool poses in the object frame at rest, their costs, and the outward surface normals at the
    contacts."""

    poses: Float[np.ndarray, "C 4 4"]
    cost: Float[np.ndarray, "C"]
    normals: Float[np.ndarray, "C 3"]


def push_contacts(opening: Opening, begin: float, sign: float) -> Contacts:
    """Contacts at which closed fingers push the part open (``sign`` 1) or closed (-1) from fraction ``begin``
    of its range, with room for the hand: on its outside, or behind a leaf that stands ajar."""
    part = opening.part
    T_rest = part_motion(part, np.array([begin]))[0]
    points, normals = _exposed(opening, T_rest)
    velocity = sign * _velocity(part.joint, points)
    speed = np.linalg.norm(velocity, axis=1)
    way = velocity / np.maximum(speed, 1e-9)[:, None]
    lever = speed / max(float(speed.max(initial=0.0)), 1e-9)
    good = np.flatnonzero(((-normals * way).sum(axis=1) > ALONG) & (lever > LEVER))
    away = np.linalg.norm(points[good] - part.grip, axis=1)
    good = _spread(points, good[np.argsort(away - 0.1 * lever[good], kind="stable")])
    found = []
    for k in good:
        base = 0.5 * float(np.linalg.norm(points[k] - part.grip)) + 0.2 * (1.0 - lever[k])
        for lean in LEANS:
            for turn in np.linspace(0.0, 2.0 * np.pi, 1 if lean == 0.0 else AROUND, endpoint=False):
                side = rotation_about(normals[k], np.array(turn)) @ across(normals[k])
                point = -np.cos(lean) * normals[k] + np.sin(lean) * side
                # Contact with the tip, and with the flank of the leaning finger.
                place = points[k] - TIP * np.cos(lean) * point + FINGER * np.sin(lean) * normals[k]
                for close in (across(point), np.cross(point, across(point))):
                    for way_round in (1.0, -1.0):
                        pose = gripper_pose(point, way_round * close, place, opening.robot)
                        found.append((pose, base + 0.15 * lean, normals[k]))
    return _with_room(opening, T_rest, _contacts(found), opening.closed, TOUCHING)


def pinch_grasps(opening: Opening) -> Grasps:
    """Pinch grasps of the part itself, where it is thin enough and free on both sides."""
    part, robot = opening.part, opening.robot
    points, normals = _exposed(opening, np.eye(4))
    near = np.argsort(np.linalg.norm(points - part.grip, axis=1), kind="stable")[: 2 * MOST_POINTS]
    points, normals = points[near], normals[near]
    thick = _thickness(part.own, points, -normals, robot.opening - SPARE)
    speed = np.linalg.norm(_velocity(part.joint, points), axis=1)
    lever = speed / max(float(speed.max(initial=0.0)), 1e-9)
    grasps = []
    for k in np.flatnonzero(np.isfinite(thick) & (lever > LEVER)):
        base = 0.5 * float(np.linalg.norm(points[k] - part.grip)) + 0.2 * (1.0 - lever[k])
        for turn in np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False):
            point = rotation_about(normals[k], np.array(turn)) @ across(normals[k])
            place = points[k] - 0.5 * thick[k] * normals[k]
            for way_round in (1.0, -1.0):
                pose = gripper_pose(point, way_round * normals[k], place, robot)
                grasps.append((pose, base + 0.1 * max(0.0, float(point[2])), normals[k]))
    found = _with_room(opening, np.eye(4), _contacts(grasps), opening.body, 0.0, fingers=True)
    # Grasps have x along the pointing direction and y along the closing direction.
    axes = np.eye(4)
    axes[:3, :3] = robot.tool_axes
    return Grasps(poses=found.poses @ axes, cost=found.cost, width=robot.opening)


def _exposed(
    opening: Opening, T_rest: Float[np.ndarray, "4 4"]
) -> tuple[Float[np.ndarray, "P 3"], Float[np.ndarray, "P 3"]]:
    """Unobstructed surface points of the part near its grip, displaced from rest by ``T_rest``, and their
    normals, both at rest."""
    points, normals = surface_samples(opening.part.own, SPACING)
    near = np.linalg.norm(points - opening.part.grip, axis=1) < NEAR
    points, normals = points[near], normals[near]
    before = points + OUT * normals
    free = _room(opening, T_rest, before) > CLEAR
    return points[free], normals[free]


def surface_samples(
    hulls: Sequence[Hull], spacing: float
) -> tuple[Float[np.ndarray, "P 3"], Float[np.ndarray, "P 3"]]:
    """Points on the faces of hulls, at most about ``spacing`` metres apart, and their normals."""
    points, normals = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for hull in hulls:
        for corners in hull.vertices[hull.faces]:
            cross = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            length = float(np.linalg.norm(cross))
            if length < 1e-9:
                continue
            points.append(triangle_points(corners, spacing, 1.0 / 3.0))
            normals.append(np.repeat(cross[None] / length, len(points[-1]), axis=0))
    found, outward = np.concatenate(points), np.concatenate(normals)
    first = first_of_each(np.rint(np.c_[found / spacing, 2.0 * outward]))
    return found[first], outward[first]


def _room(
    opening: Opening, T_rest: Float[np.ndarray, "4 4"], points: Float[np.ndarray, "*N 3"]
) -> Float[np.ndarray, "*N"]:
    """Distance (m) of points, which move with the part, from all solids."""
    others = distances(opening.near_others, transform_points(T_rest, points))
    return np.minimum(others, distances(opening.near_carried, points))


def _spread(points: Float[np.ndarray, "P 3"], order: Int[np.ndarray, "K"]) -> Int[np.ndarray, "M"]:
    """The first of every neighbourhood, in neighbourhoods so large that `MOST_POINTS` at most are left."""
    spacing = SPACING
    while len(order) > MOST_POINTS:
        spacing *= 1.25
        order = order[first_of_each(np.rint(points[order] / spacing))]
    return order


def _with_room(
    opening: Opening,
    T_rest: Float[np.ndarray, "4 4"],
    found: Contacts,
    body: Body,
    touching: float,
    *,
    fingers: bool = False,
) -> Contacts:
    """The cheapest contacts at which the hand collides with nothing but the contact area; with ``fingers``,
    they must also hit nothing but the part as they close."""
    last = len(opening.chain.before) - 1
    mine = (body.carrier == last) & (body.gap <= HAND_GAP)
    hand = transform_points(inverse(opening.chain.tool), body.points[mine])
    order = np.argsort(found.cost, kind="stable")
    tip = TIP * opening.robot.tool_axes[:, 0]
    allowed = np.linalg.norm(hand - tip, axis=1) < touching
    good: list[np.ndarray] = []
    for rows in np.array_split(order, max(1, len(order) // 400)):
        points = transform_points(found.poses[rows], hand)
        room = _room(opening, T_rest, points)
        room[:, allowed] = np.inf
        free = room.min(axis=1) > CLEAR
        if fingers:
            sweep = transform_points(found.poses[rows], _finger_sweep(opening))
            free &= distances(opening.near_others, transform_points(T_rest, sweep)).min(axis=1) > CLEAR
        good.append(rows[free])
        if sum(map(len, good)) >= KEPT:
            break
    rows = np.concatenate([np.zeros(0, dtype=np.int64), *good])[:KEPT]
    return Contacts(poses=found.poses[rows], cost=found.cost[rows], normals=found.normals[rows])


def _finger_sweep(opening: Opening) -> Float[np.ndarray, "S 3"]:
    """Points that the ends of both fingers sweep as they close, in the tool frame."""
    point, close, _ = opening.robot.tool_axes.T
    half = opening.robot.opening / 2.0
    across = np.linspace(-half, half, 15)
    return np.concatenate([across[:, None] * close + back * point for back in (TIP, 0.0, -0.015)])


def _thickness(
    hulls: Sequence[Hull], points: Float[np.ndarray, "P 3"], inwards: Float[np.ndarray, "P 3"], most: float
) -> Float[np.ndarray, "P"]:
    """Thickness of the union of hulls behind points on its surface (m); infinite beyond ``most``."""
    steps = np.arange(THIN / 2.0, most + THIN, THIN)
    along = points[:, None] + steps[:, None] * inwards[:, None]
    inside = np.zeros(along.shape[:2], dtype=bool)
    for hull in hulls:
        inside |= is_inside(hull, along)
    out = ~inside
    first = out.argmax(axis=1)  # 0 also where no step is outside
    return np.where(first > 0, steps[first], np.inf)


def is_inside(hull: Hull, points: Float[np.ndarray, "*N 3"]) -> Bool[np.ndarray, "*N"]:
    """Whether points lie in a hull."""
    planes = hull_planes(hull)
    return np.asarray((points @ planes[:, :3].T <= planes[:, 3] + 1e-6).all(axis=-1))


def _velocity(joint: Joint, points: Float[np.ndarray, "P 3"]) -> Float[np.ndarray, "P 3"]:
    """Velocities of points per unit of joint speed, at rest."""
    if joint.type == "prismatic":
        return np.repeat(np.asarray(joint.axis)[None], len(points), axis=0)
    return np.cross(joint.axis, points - joint.origin)


def _contacts(found: list[tuple[np.ndarray, float, np.ndarray]]) -> Contacts:
    """Contacts from pose, cost and normal of each."""
    return Contacts(
        poses=np.array([pose for pose, _, _ in found]).reshape(-1, 4, 4),
        cost=np.array([cost for _, cost, _ in found], dtype=np.float64),
        normals=np.array([normal for _, _, normal in found]).reshape(-1, 3),
    )
