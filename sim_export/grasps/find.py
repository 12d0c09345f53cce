"""Finds grasps: antipodal pairs, all directions of approach, room for the gripper along the whole motion.

The gripper opens to a little more than the width, comes along its direction of approach, closes, and then
moves rigidly with the link; it neither slides nor turns about what it holds. Where it finds no room along the
whole range of a joint, the range is divided into strokes: after each the gripper lets go and grasps anew.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from artigen.kind import find_kind
from artigen.transforms import inverse, rotation_about, transform_points
from artigen.types import Joint
from sim_export.geometry.hulls import box_hull, hull_triangles, inside_hulls
from sim_export.geometry.rays import plane_axes
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import area_normals
from sim_export.motion.kinematics import (
    hanging_links,
    link_displacements,
    object_joints,
    required_openings,
)
from sim_export.package import PROVEN, WHOLE, Grasp, Hull, SimPackage

from .gripper import Gripper, mirrored
from .pairs import FRICTION, MOST, SAMPLES, Pairs, find_pairs, held_hulls
from .room import Solids, meet, near_solids
from .targets import Target, find_targets

CARRIED = 0.95
"""Share of a stroke along which the gripper needs room."""
QUARTER = np.pi / 2.0
"""Range (rad) of joints without limits."""
POSES = 9
"""Poses of a joint at which the gripper's room is measured."""
TURNS = 16
"""Directions of approach about the closing direction."""
BEHIND = -0.3
"""Least cosine between a direction of approach and that against the handle's normal."""
DEPTHS = (0.0, 0.5, 0.9)
"""Places of the contacts on the pads, from their middles to the finger tips."""
SPARE, ROOMY = 0.003, 0.012
"""Least and most free distance (m) of each pad as the gripper arrives."""
BULGE = 0.010
"""Farthest (m) beyond a contact that a part without a handle may bulge between the pads."""
ARRIVAL = 0.08
"""Length (m) of the straight approach."""
CONE = float(np.cos(np.arctan(FRICTION)))
CLEAR, TOUCH = 0.002, 0.001
"""Clearance (m) of the gripper; depth by which a pad may overlap what it holds, where that is curved."""
WIDE = 0.010
"""Clearance (m) from which more counts nothing."""
ENOUGH = 3
"""Grasps of a handle from which no finer search is made."""
FINE = 2
"""Times as many pairs and turns in a finer search."""
STROKES = (1, 2, 4, 8)
"""Strokes into which the range of a joint may be divided; more would not be worth the gripper's time."""
APART, TURNED = 0.0075, np.radians(20.0)
"""Two kept grasps differ by this distance (m) or this angle."""
KEPT = 12
FLOOR = 2.0
"""Half the edge (m) of the floor on which free-standing objects stand."""
WEIGHTS = {"antipodal": 0.3, "margin": 0.3, "clearance": 0.2, "facing": 0.2}
"""Weights of the score: angle of the normals within the friction cone, share of the pads that touch, free
distance, and the cosine between the approach and the handle's normal."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """Grasps of one target for one stroke, the best first; without any, ``reason`` says why. ``stroke`` are
    the shares of the joint's range at which the gripper takes hold and lets go."""

    target: Target
    grasps: tuple[Grasp, ...]
    reason: str = ""
    stroke: tuple[float, float] = WHOLE


@dataclass(frozen=True, kw_only=True, eq=False)
class _Hands:
    """Poses of a gripper that closes on a target, wherever else it may be; ``angle`` as in `Pairs`."""

    T: Float[np.ndarray, "G 4 4"]
    width: Float[np.ndarray, "G"]
    angle: Float[np.ndarray, "G"]
    reason: str = ""

    def some(self, chosen: np.ndarray) -> "_Hands":
        return _Hands(T=self.T[chosen], width=self.width[chosen], angle=self.angle[chosen])


def find_grasps(package: SimPackage, gripper: Gripper) -> tuple[Found, ...]:
    """Grasps of every handle, of moving parts without one, or of an object in which nothing moves.

    One entry for each stroke of each of them; most take a single stroke.
    """
    return tuple(found for target in find_targets(package) for found in find_on(package, target, gripper))


def joint_range(joint: Joint) -> tuple[float, float]:
    """Ends (rad or m) between which one grasp opens a joint: its limits; a quarter turn without any."""
    return (0.0, QUARTER) if joint.type == "continuous" else (joint.lower, joint.upper)


def carry(
    package: SimPackage, joint: Joint, fractions: Sequence[float] | Float[np.ndarray, "K"]
) -> Float[np.ndarray, "K L 4 4"]:
    """Displacements of all links with ``joint`` opened to fractions of its range, and what it needs open."""
    lower, upper = joint_range(joint)
    q = lower + (upper - lower) * np.asarray(fractions, dtype=np.float64)
    needs = required_openings(joint, package.joints, package.requires_open)
    return link_displacements(package.links, package.joints, {**needs, joint.name: q})


def place_link(package: SimPackage, grasp: Grasp) -> Float[np.ndarray, "4 4"]:
    """Displacement of the link of a grasp from rest as its stroke begins; what else must be open is open."""
    joint = next((joint for joint in object_joints(package.joints) if joint.name == grasp.joint), None)
    if joint is None:
        return np.eye(4)
    index = [link.name for link in package.links].index(grasp.link)
    return carry(package, joint, grasp.stroke[:1])[0, index]


def find_on(package: SimPackage, target: Target, gripper: Gripper) -> tuple[Found, ...]:
    """Grasps of one target, for each of the fewest strokes that all have `ENOUGH`.

    A handle without enough is searched more finely. If no number of strokes gives enough, the whole range
    counts, unless only strokes have any.
    """
    hands = _close_on(package, target, gripper, 1)
    first = _carried(package, target, gripper, hands, WHOLE)
    if len(first.grasps) >= ENOUGH or target.region is None:
        return (first,)
    hands, best, most = _close_on(package, target, gripper, FINE), (first,), len(first.grasps)
    for count in STROKES:
        found: list[Found] = []
        for stroke in divide_strokes(count):
            found.append(_carried(package, target, gripper, hands, stroke))
            if len(found[-1].grasps) <= most:
                break
        else:
            best, most = tuple(found), min(len(each.grasps) for each in found)
        if most >= ENOUGH:
            break
    return best


def divide_strokes(count: int) -> tuple[tuple[float, float], ...]:
    """Shares of a joint's range at which each of ``count`` equal strokes begins and ends. Each but the first
    begins where the one before is proven to have come to."""
    return tuple((max(0.0, (last - 1 + PROVEN) / count), (last + 1) / count) for last in range(count))


def _close_on(package: SimPackage, target: Target, gripper: Gripper, fine: int) -> _Hands:
    """Poses in which a gripper closes on a target; none with the reason."""
    own = next(link.hulls for link in package.links if link.name == target.link)
    if not own:
        return _no_hands("it has no collision shape")
    normal = None if target.normal is None else np.asarray(target.normal)
    pairs = find_pairs(own, target.region, normal, fine * MOST)
    if not len(pairs):
        return _no_hands("it has no two places that face away from each other")
    spans = pairs.some(pairs.width + 2.0 * SPARE <= gripper.opening)
    if not len(spans):
        return _no_hands(
            f"its narrowest place is {1e3 * pairs.width.min():.0f} mm wide, and the gripper opens to "
            f"{1e3 * gripper.opening:.0f} mm, of which {2e3 * SPARE:.0f} mm stay free"
        )
    T, rows = gripper_poses(spans, gripper, normal, fine * TURNS)
    bulge = BULGE if target.region is None else gripper.opening
    T, width, kept = close(T, spans.width[rows], gripper, held_hulls(own, target.region), bulge)
    fits = kept & (width + 2.0 * SPARE <= gripper.opening)
    if not fits.any():
        return _no_hands(
            "pads would touch it on slanted faces, from which they slip, or the gripper is too narrow"
        )
    return _Hands(T=T, width=width, angle=spans.angle[rows]).some(fits)


def _no_hands(reason: str) -> _Hands:
    return _Hands(T=np.zeros((0, 4, 4)), width=np.zeros(0), angle=np.zeros(0), reason=reason)


def _carried(
    package: SimPackage, target: Target, gripper: Gripper, hands: _Hands, stroke: tuple[float, float]
) -> Found:
    """Grasps with room for the gripper as it arrives and along a stroke."""
    if hands.reason:
        return Found(target=target, grasps=(), reason=hands.reason, stroke=stroke)
    index = [link.name for link in package.links].index(target.link)
    still, moving = _obstacles(package, target, index, hands.T[:, :3, 3], stroke)
    here = hands.some(~meet(hands.T, arriving_boxes(gripper, hands.width, CLEAR), still))
    if not len(here.T):
        reason = f"the gripper has no room in any of {len(hands.T)} poses"
        return Found(target=target, grasps=(), reason=reason, stroke=stroke)
    free = here.some(~meet(here.T, carried_boxes(gripper, here.width, CLEAR), moving))
    if not len(free.T):
        reason = f"the gripper meets something as it opens, in all of {len(here.T)} poses"
        return Found(target=target, grasps=(), reason=reason, stroke=stroke)
    normal = None if target.normal is None else np.asarray(target.normal)
    score = _score(free, gripper, package.links[index].hulls, still, normal)
    order = np.argsort(-score, kind="stable")
    kept = order[spread_poses(free.T[order], KEPT)]
    joint = "" if target.joint is None else target.joint.name
    grasps = tuple(
        Grasp(
            link=target.link, part=target.part, joint=joint, gripper=gripper.name, stroke=stroke,
            pose=free.T[row], width=float(free.width[row]), score=float(score[row]),
        )
        for row in kept
    )  # fmt: skip
    return Found(target=target, grasps=grasps, stroke=stroke)


def gripper_poses(
    pairs: Pairs, gripper: Gripper, normal: Float[np.ndarray, "3"] | None, count: int
) -> tuple[Float[np.ndarray, "G 4 4"], np.ndarray]:
    """Poses of a gripper that closes on pairs from ``count`` turns, and the pair of each; the first turn of a
    pair points against ``normal`` as nearly as it can, and none comes from behind it."""
    poses, rows = [], []
    turns = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    turns = turns if normal is None else turns[np.cos(turns) > BEHIND]
    for row, (middle, axis) in enumerate(zip(pairs.middle, pairs.axis, strict=True)):
        ahead = plane_axes(axis)[0]
        if normal is not None:
            against = (normal @ axis) * axis - normal
            length = float(np.linalg.norm(against))
            ahead = against / length if length > 0.1 else ahead
        turned = rotation_about(axis, turns) @ ahead  # A 3
        for depth in DEPTHS:
            T = np.tile(np.eye(4), (len(turns), 1, 1))
            T[:, :3, 0], T[:, :3, 1], T[:, :3, 2] = np.cross(axis, turned), axis, turned
            T[:, :3, 3] = middle - depth * gripper.pad[1, 2] * turned
            poses.append(T)
            rows.append(np.full(len(turns), row))
    return np.concatenate(poses), np.concatenate(rows)


def close(
    T: Float[np.ndarray, "G 4 4"],
    width: Float[np.ndarray, "G"],
    gripper: Gripper,
    held: Sequence[Hull],
    bulge: float,
) -> tuple[Float[np.ndarray, "G 4 4"], Float[np.ndarray, "G"], Bool[np.ndarray, "G"]]:
    """Poses and widths at which pads that close on the contacts first touch what is held: its widest place
    between them, up to ``bulge`` metres beyond the contacts, with the gripper in its middle. And whether each
    pad then touches a corner with its face, or a face within the cone of `FRICTION`."""
    triangles = hull_triangles(held)
    spread, owner = sample_triangles(triangles, SAMPLES)
    normals = area_normals(triangles)[owner]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)
    corners = np.concatenate([hull.vertices for hull in held])
    points = np.concatenate([corners, spread])
    local = transform_points(inverse(T), points)  # G N 3
    low, high = gripper.pad
    under = (np.abs(local[..., 1]) <= width[:, None] / 2.0 + bulge) & (np.abs(local[..., 0]) <= high[0])
    under &= (local[..., 2] >= low[2]) & (local[..., 2] <= high[2])
    cosine = T[:, :3, 1] @ normals.T  # G S
    kept, ends = np.ones(len(T), dtype=bool), []
    for side in (1.0, -1.0):
        reach = np.where(under, side * local[..., 1], -np.inf)
        end = np.maximum(reach.max(axis=1), width / 2.0)
        good = np.concatenate([np.ones((len(T), len(corners)), dtype=bool), side * cosine >= CONE], axis=1)
        kept &= (good & (reach >= end[:, None] - TOUCH / 2.0)).any(axis=1)
        ends.append(end)
    moved = T.copy()
    moved[:, :3, 3] += ((ends[0] - ends[1]) / 2.0)[:, None] * T[:, :3, 1]
    return moved, ends[0] + ends[1], kept


def arriving_boxes(
    gripper: Gripper, width: Float[np.ndarray, "G"], clear: float
) -> Float[np.ndarray, "G B 2 3"]:
    """What the gripper sweeps as it arrives, opened a little more than ``width``, and as it then closes."""
    spare = np.minimum((gripper.opening - width) / 2.0, ROOMY)
    come = _fingers(gripper, width / 2.0 + spare, 0.0, clear)
    come[:, :, 0, 2] -= ARRIVAL
    palm = np.repeat(gripper.palm[None], len(width), axis=0) + clear * np.array([[-1.0], [1.0]])
    palm[:, :, 0, 2] -= ARRIVAL
    close = _fingers(gripper, width / 2.0 + TOUCH, spare, clear)
    return np.concatenate([palm, come, mirrored(come), close, mirrored(close)], axis=1)


def carried_boxes(
    gripper: Gripper, width: Float[np.ndarray, "G"], clear: float
) -> Float[np.ndarray, "G B 2 3"]:
    """Palm, finger at +y and finger at -y of the closed gripper, larger by ``clear`` but at the pads."""
    palm = np.repeat(gripper.palm[None], len(width), axis=0) + clear * np.array([[-1.0], [1.0]])
    near = _fingers(gripper, width / 2.0, 0.0, clear)
    return np.concatenate([palm, near, mirrored(near)], axis=1)


def _fingers(
    gripper: Gripper, inner: Float[np.ndarray, "G"], swept: Float[np.ndarray, "G"] | float, clear: float
) -> Float[np.ndarray, "G F 2 3"]:
    """Boxes of the finger at +y with its pad at ``inner``, swept outwards and larger by ``clear``."""
    boxes = np.repeat(gripper.finger[None], len(inner), axis=0)
    boxes[..., 1] += inner[:, None, None]
    boxes[:, :, 1, 1] += np.broadcast_to(swept, inner.shape)[:, None]
    return boxes + clear * np.array([[-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]])


def _obstacles(
    package: SimPackage,
    target: Target,
    index: int,
    places: Float[np.ndarray, "P 3"],
    stroke: tuple[float, float],
) -> tuple[Solids, Solids]:
    """Solids in the frame of the target's link at rest: all as a stroke begins, and those of other links
    along it. What the link carries moves with it."""
    center = (places.min(axis=0) + places.max(axis=0)) / 2.0
    reach = float(np.linalg.norm(places - center, axis=1).max()) + 0.25 + ARRIVAL
    hulls = [list(link.hulls) for link in package.links]
    standing = find_kind(package.category)
    floor: list[Hull] = []
    if target.joint is None or standing is None or standing.stands == "free":
        low = min(hull.vertices[:, 2].min() for each in hulls for hull in each)
        floor = [box_hull(np.array([-FLOOR, -FLOOR, low - 0.05]), np.array([FLOOR, FLOOR, low]))]
    if target.joint is None:
        return near_solids([*hulls[index], *floor], np.eye(4), center, reach), Solids(hulls=())
    begin, end = stroke
    T = carry(package, target.joint, np.linspace(begin, begin + CARRIED * (end - begin), POSES))
    back = inverse(T[:, index])
    with_link = hanging_links(package.joints, target.link)
    still, moving = [], list(near_solids(floor, back, center, reach).hulls)
    still += near_solids(floor, back[0], center, reach).hulls
    for place, link in enumerate(package.links):
        relative = back @ T[:, place]
        still += near_solids(hulls[place], relative[0], center, reach).hulls
        if link.name not in with_link:
            moving += near_solids(hulls[place], relative, center, reach).hulls
    return Solids(hulls=tuple(still)), Solids(hulls=tuple(moving))


def _score(
    hands: _Hands,
    gripper: Gripper,
    own: Sequence[Hull],
    still: Solids,
    normal: Float[np.ndarray, "3"] | None,
) -> Float[np.ndarray, "G"]:
    """Scores in [0, 1] by `WEIGHTS`."""
    T, width = hands.T, hands.width
    roomy = ~meet(T, arriving_boxes(gripper, width, WIDE), still)
    facing = np.full(len(T), 0.5) if normal is None else (1.0 - T[:, :3, 2] @ normal) / 2.0
    terms = {
        "antipodal": 1.0 - hands.angle / np.arctan(FRICTION),
        "margin": pad_share(T, width, gripper, own),
        "clearance": roomy.astype(np.float64),
        "facing": facing,
    }
    return np.clip(sum(WEIGHTS[name] * value for name, value in terms.items()), 0.0, 1.0)


def pad_share(
    T: Float[np.ndarray, "G 4 4"], width: Float[np.ndarray, "G"], gripper: Gripper, own: Sequence[Hull]
) -> Float[np.ndarray, "G"]:
    """Share of the two pads that touches the link: of points on a grid, those with the link 2 mm below."""
    low, high = gripper.pad
    x, z = np.meshgrid(*(np.linspace(low[k], high[k], 7)[1::2] for k in (0, 2)))
    places = np.stack([x.ravel(), np.zeros(x.size), z.ravel()], axis=1)
    sides = np.array([1.0, -1.0])[:, None] * np.maximum(width / 2.0 - 2e-3, 0.0)  # 2 G
    points = np.repeat(places[None, None], 2, axis=0) + sides[:, :, None, None] * np.array([0.0, 1.0, 0.0])
    placed = np.einsum("gij,sgnj->sgni", T[:, :3, :3], points) + T[:, None, :3, 3]
    touched = inside_hulls(placed.reshape(-1, 3), own).reshape(placed.shape[:3])
    return touched.mean(axis=(0, 2))


def spread_poses(T: Float[np.ndarray, "G 4 4"], count: int) -> np.ndarray:
    """Indices of the first poses, at most ``count``, that differ by `APART` or `TURNED` from all before."""
    kept: list[int] = []
    for index in range(len(T)):
        R = T[kept, :3, :3]
        away = np.linalg.norm(T[kept, :3, 3] - T[index, :3, 3], axis=1) >= APART
        cosine = (np.einsum("kij,ij->k", R, T[index, :3, :3]) - 1.0) / 2.0
        if (away | (np.arccos(np.clip(cosine, -1.0, 1.0)) >= TURNED)).all():
            kept.append(index)
        if len(kept) == count:
            break
    return np.array(kept, dtype=np.int64)
