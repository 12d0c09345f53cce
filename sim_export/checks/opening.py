"""L2: opening directions of doors, drawers and trays (V203, V205, V206)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from artigen.transforms import line_distance, thin_direction
from artigen.types import Joint
from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, at_least, count_problems
from sim_export.checks.subject import Subject
from sim_export.geometry.hulls import hull_planes, hull_triangles
from sim_export.geometry.sampling import sample_triangles
from sim_export.motion.held_drawers import held_length
from sim_export.package import Hull

_SIGHT_LINES = 400
_FIRST_TURN = 1.0
"""Largest rotation (radians) for which the tangent stands for the motion of a door's points."""
PARALLEL = 0.5
"""Cosine between axis and panel normal above which a lid screws or spins and has no hinge edge."""
_TWIN_SIZE = 0.05
_TWIN_AXIS_DEGREES = 5.0


def opening_joints(subject: Subject, labels: tuple[str, ...], types: tuple[str, ...]) -> list[Joint]:
    """Joints of given types whose child link has one of the labels and collision geometry."""
    return [
        joint
        for joint in subject.driven
        if joint.type in types
        and subject.labels.get(joint.child) in labels
        and subject.hull_sets[joint.child].hulls
    ]


def panel_joints(subject: Subject) -> list[Joint]:
    """Sliding drawers and hinged doors with limits; sliding doors and spinning caps are excluded."""
    return opening_joints(subject, ("drawer",), ("prismatic",)) + opening_joints(
        subject, ("door",), ("revolute",)
    )


def has_panels(subject: Subject) -> str:
    """Applies to sliding drawers and hinged doors."""
    return "" if panel_joints(subject) else "no drawer slides and no door turns between limits"


def velocity_at(joint: Joint, points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3"]:
    """Velocity of points at rest for one unit of joint velocity (m per rad or per m)."""
    if joint.type == "prismatic":
        return np.broadcast_to(joint.axis, points.shape)
    return np.cross(joint.axis, points - joint.origin)


def check_opening(subject: Subject, cfg: CheckConfig) -> Finding:
    """V203: opening leads out of the body, and a hinge lies at the edge of its door."""
    problems, links = [], []
    for joint in panel_joints(subject):
        faults = _direction_faults(subject, joint, cfg)
        if joint.type == "revolute":
            faults += _hinge_faults(subject, joint, cfg)
        problems += [(joint.name, f"joint {joint.name!r} {fault}") for fault in faults]
        links += [joint.child] if faults else []
    fine = f"{len(panel_joints(subject))} doors and drawers open outwards from their edges"
    return count_problems(problems, fine, links)


def _direction_faults(subject: Subject, joint: Joint, cfg: CheckConfig) -> list[str]:
    """Compares the shares of sight lines that the body blocks in the opening and in the opposite direction.

    If the shares are equal (an empty frame), the handle must lead the motion.
    """
    triangles = hull_triangles(subject.hull_sets[joint.child].hulls)
    points, _ = sample_triangles(triangles, _SIGHT_LINES)
    reach = joint.upper if joint.type == "prismatic" else min(joint.upper, _FIRST_TURN)
    path = velocity_at(joint, points) * reach
    obstacles = tuple(
        hull
        for name in subject.links
        if name in subject.ancestors(joint.child) or name in subject.static_links
        for hull in subject.hull_sets[name].hulls
    )
    ahead = float(hit_hulls(points, path, obstacles).mean())
    behind = float(hit_hulls(points, -path, obstacles).mean())
    if ahead > behind + cfg.blocked_margin:
        return [
            f"opens into the body: {100 * ahead:.2g} % of it is blocked ahead, {100 * behind:.2g} % behind"
        ]
    handles = handle_points(subject, joint.child)
    if abs(ahead - behind) <= cfg.blocked_margin and len(handles):
        panel = triangles.mean(axis=(0, 1))
        direction = velocity_at(joint, handles.mean(axis=0)[None])[0]
        if (handles.mean(axis=0) - panel) @ direction < 0.0:
            return ["opens away from its handle"]
    return []


def handle_points(subject: Subject, link: str) -> Float[np.ndarray, "N 3"]:
    """Vertices of the visuals of a link that are named as handles."""
    chunks = [s.vertices for s in subject.visuals if s.link == link and "handle" in s.name]
    return np.concatenate([np.zeros((0, 3)), *chunks])


def panel_points(subject: Subject, link: str) -> Float[np.ndarray, "N 3"]:
    """Visual vertices of a link without its handles; its hull vertices if there are none."""
    seen = [s.vertices for s in subject.visuals if s.link == link and "handle" not in s.name]
    return np.concatenate(seen) if seen else subject.hull_sets[link].vertices


def hit_hulls(
    origins: Float[np.ndarray, "N 3"], paths: Float[np.ndarray, "N 3"], hulls: tuple[Hull, ...]
) -> Bool[np.ndarray, "N"]:
    """Whether each straight path enters a hull from outside."""
    hit = np.zeros(len(origins), dtype=bool)
    for hull in hulls:
        planes = hull_planes(hull)
        height = origins @ planes[:, :3].T - planes[:, 3]
        slope = paths @ planes[:, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            at = -height / slope
        enter = np.where(slope < 0, at, np.where(height > 0, np.inf, -np.inf)).max(axis=1)
        leave = np.where(slope > 0, at, np.inf).min(axis=1)
        hit |= (enter > 0.0) & (enter <= 1.0) & (enter < leave)
    return hit


@dataclass(frozen=True, kw_only=True, eq=False)
class Panel:
    """A door seen along its hinge: extent ``low..high`` across it, thickness, and hinge position (m).

    ``across`` is the direction in the panel, upright to the hinge, along which these are measured.
    """

    across: Float[np.ndarray, "3"]
    low: float
    high: float
    thickness: float
    hinge: float


def door_panel(subject: Subject, joint: Joint) -> Panel | None:
    """The door's extent across its hinge axis; None if the axis is perpendicular to the panel."""
    points = panel_points(subject, joint.child)
    centered = points - (points.min(axis=0) + points.max(axis=0)) / 2.0
    normal = thin_direction(centered)
    if abs(normal @ joint.axis) > PARALLEL:
        return None
    across = np.cross(normal, joint.axis)
    across /= np.linalg.norm(across)
    extent = points @ across
    return Panel(
        across=across,
        low=float(extent.min()),
        high=float(extent.max()),
        thickness=float(np.ptp(points @ normal)),
        hinge=float(joint.origin @ across),
    )


def hinge_offset(panel: Panel, cfg: CheckConfig) -> tuple[float, float]:
    """Distance of a hinge from the nearer edge of its door, and what is allowed (m)."""
    off = min(abs(panel.hinge - panel.low), abs(panel.hinge - panel.high))
    # A thick door turns about the middle of its thickness and clears its frame on both sides.
    return off, max(cfg.max_edge_ratio * (panel.high - panel.low), panel.thickness / 2.0)


def _hinge_faults(subject: Subject, joint: Joint, cfg: CheckConfig) -> list[str]:
    panel = door_panel(subject, joint)
    if panel is None:
        return []
    off, allowed = hinge_offset(panel, cfg)
    if off <= allowed:
        return []
    return [
        f"turns about a line {1e3 * off:.3g} mm from the edge of its {1e3 * (panel.high - panel.low):.3g} mm "
        f"wide door, allowed are {1e3 * allowed:.3g} mm"
    ]


def door_pairs(subject: Subject) -> list[tuple[Joint, Joint]]:
    """Pairs of doors with one parent and equal size, side by side, hinged on opposite sides about parallel
    axes."""
    doors = opening_joints(subject, ("door",), ("revolute",))
    return [
        (first, second)
        for index, first in enumerate(doors)
        for second in doors[index + 1 :]
        if first.parent == second.parent and _mirror_normal(subject, first, second) is not None
    ]


def _mirror_normal(subject: Subject, first: Joint, second: Joint) -> np.ndarray | None:
    """Normal of the mirror plane between two doors; None if they are not a pair."""
    boxes = [subject.hull_sets[joint.child].vertices for joint in (first, second)]
    low, high = (np.stack([f(points, axis=0) for points in boxes]) for f in (np.min, np.max))
    size, center = high - low, (low + high) / 2.0
    offset = center[1] - center[0]
    distance = float(np.linalg.norm(offset))
    axis = int(np.abs(offset).argmax())
    if distance == 0.0 or abs(offset[axis]) < 0.99 * distance:
        return None
    same = np.all(np.abs(size[0] - size[1]) <= _TWIN_SIZE * size.max())
    beside = abs(abs(offset[axis]) - size[:, axis].mean()) <= 2 * _TWIN_SIZE * size[:, axis].mean()
    normal = np.eye(3)[axis]
    parallel = abs(first.axis @ second.axis) >= np.cos(np.radians(_TWIN_AXIS_DEGREES))
    upright = abs(first.axis @ normal) <= np.sin(np.radians(_TWIN_AXIS_DEGREES))
    if not (same and beside and parallel and upright):
        return None
    middle = center.mean(axis=0)
    hinges = [(joint.origin - middle) @ normal for joint in (first, second)]
    apart = line_distance(first.origin, first.axis, second.origin, second.axis)
    mirrored = abs(hinges[0] + hinges[1]) <= 2 * _TWIN_SIZE * apart and hinges[0] * hinges[1] < 0
    return normal if mirrored else None


def has_pairs(subject: Subject) -> str:
    """Applies to double doors."""
    return "" if door_pairs(subject) else "no two doors are a mirrored pair"


def check_pairs(subject: Subject, cfg: CheckConfig) -> Finding:
    """V205: the two leaves of a double door open as mirror images."""
    angles, leaves = {}, {}
    for first, second in door_pairs(subject):
        normal = _mirror_normal(subject, first, second)
        assert normal is not None
        ways = []
        for joint in (first, second):
            # Evaluate in line with the hinge, so that geometry inside a leaf does not change the direction.
            vertices = subject.hull_sets[joint.child].vertices
            center = (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0
            beside = joint.origin + ((center - joint.origin) @ normal) * normal
            way = velocity_at(joint, beside[None])[0]
            ways.append(way / max(float(np.linalg.norm(way)), 1e-12))
        mirrored = ways[0] - 2.0 * (ways[0] @ normal) * normal
        pair = f"{first.name} and {second.name}"
        angles[pair] = float(np.degrees(np.arccos(np.clip(mirrored @ ways[1], -1, 1))))
        leaves[pair] = first.child, second.child
    where = max(angles, key=lambda name: angles[name])
    return Finding(
        passed=angles[where] < 90.0,  # hinges are parallel: they agree, or are opposite
        value=angles[where],
        threshold=90.0,
        unit="degrees",
        where=where,
        message=f"{where} open {angles[where]:.3g} degrees from mirrored directions",
        links=tuple(sorted({link for pair in angles if angles[pair] >= 90.0 for link in leaves[pair]})),
    )


def has_drawers(subject: Subject) -> str:
    """Applies to sliding drawers and trays."""
    return "" if opening_joints(subject, ("drawer", "tray"), ("prismatic",)) else "no drawer or tray slides"


def check_retained(subject: Subject, cfg: CheckConfig) -> Finding:
    """V206: a fully open drawer is still held by its carrier."""
    shares = {}
    for joint in opening_joints(subject, ("drawer", "tray"), ("prismatic",)):
        own = panel_points(subject, joint.child) @ joint.axis + joint.upper
        carrier = np.concatenate(
            [subject.hull_sets[name].vertices for name in subject.ancestors(joint.child)]
        )
        held = carrier @ joint.axis if len(carrier) else np.array([np.inf, -np.inf])
        shares[joint.name] = max(0.0, held_length(own, held, 0.0) / float(np.ptp(own)))
    where = min(shares, key=lambda name: shares[name])
    message = (
        f"joint {where!r} leaves {100 * shares[where]:.3g} % of its drawer's depth inside when open, "
        f"at least {100 * cfg.min_retained:g} % must stay"
    )
    loose = [joint.child for joint in subject.driven if shares.get(joint.name, 1.0) < cfg.min_retained]
    return at_least(
        shares[where], cfg.min_retained, "of the depth", where=where, message=message, links=loose
    )


OPENING_CHECKS = (
    CheckSpec(id="V203", level="L2", title="opening direction", applies=has_panels, function=check_opening),
    CheckSpec(id="V205", level="L2", title="double doors", applies=has_pairs, function=check_pairs),
    CheckSpec(id="V206", level="L2", title="drawer retained", applies=has_drawers, function=check_retained),
)
