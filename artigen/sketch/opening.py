"""Opening of drawers and doors: direction, hinge line, reachable handle, and support when open."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.shapes.shape import Shape
from artigen.sketch.contact import Bodies
from artigen.sketch.tree import Tree
from artigen.transforms import frame_along, thin_direction
from artigen.types import Joint, PartLabel

SIGHT_LINES = 200
"""Sample points per part; each casts a ray along the motion to measure which direction is free."""
FREE_MARGIN = 0.02
"""Smallest difference in the share of blocked sight lines that counts as a difference."""
FIRST_TURN = 1.0
"""Largest rotation (radians) for which the tangent stands for the motion of a door's points."""
EDGE_RATIO = 0.05
"""Largest distance of a hinge from the edge of its door, as a share of the door's width."""
MIN_HUNG, HUNG_WITHIN = 0.2, 0.05
"""Smallest share of a hinge's length that is at the carrier, and the distance (m) that counts as such. A door
that only its top and bottom edge hold covers its opening in part."""
MIN_HELD = 0.1
"""Smallest share of a drawer's depth that stays inside its carrier."""
HOOK_DEPTH = 0.025
"""Free depth (m) that fingers need behind a bar."""
GRASP_WIDTH = 0.08
"""Opening width (m) of a gripper."""
PROTRUSION = 0.005
"""Distance (m) by which a handle must protrude from its panel to be pinched."""
_PARALLEL = 0.5
"""Cosine between axis and panel normal above which a lid spins in its plane and has no hinge edge."""
_COLUMNS = 24
_HINGE_POINTS, _BEHIND = 101, 0.005
"""Points along a hinge, and their distance (m) behind the door."""
_GOLDEN = np.array([0.7548776662466927, 0.5698402909980532])
"""Steps of a low-discrepancy sequence in the unit square."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Opener:
    """A moving part and the primitives of its rigid body: all of them, and those that are not handles."""

    index: int
    label: PartLabel
    joint: Joint
    body: Int[np.ndarray, "B"]
    panel: Int[np.ndarray, "Q"]

    def velocity(self, points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 3"]:
        """Velocity of points at rest per unit of joint velocity (m per rad or per m)."""
        if self.joint.type == "prismatic":
            return np.broadcast_to(self.joint.axis, points.shape)
        return np.cross(self.joint.axis, points - self.joint.origin)


def list_openers(shape: Shape, bodies: Bodies) -> list[Opener]:
    """Drawers, trays and doors with a limited range of motion."""
    handles = np.array([part.label == "handle" for part in shape.parts])[bodies.parts]
    openers = []
    for index, part in enumerate(shape.parts):
        if part.joint is None or part.parent is None or part.label not in ("drawer", "door", "tray"):
            continue
        if part.joint.type in ("prismatic", "revolute"):
            own = bodies.links == index
            openers.append(
                Opener(
                    index=index,
                    label=part.label,
                    joint=part.joint,
                    body=np.flatnonzero(own),
                    panel=np.flatnonzero(own & ~handles),
                )
            )
    return openers


def measure_blocked(bodies: Bodies, opener: Opener, obstacles: Int[np.ndarray, "O"]) -> tuple[float, float]:
    """Shares of sight lines that hit an obstacle: ahead and behind."""
    points = _spread_points(bodies, opener.body, SIGHT_LINES)
    upper = opener.joint.upper
    reach = upper if opener.joint.type == "prismatic" else min(upper, FIRST_TURN)
    ways = opener.velocity(points) * reach
    hits = [_hit(bodies, points, way, obstacles) for way in (ways, -ways)]
    return float(hits[0].mean()), float(hits[1].mean())


def leans_back(bodies: Bodies, opener: Opener) -> bool:
    """Whether the handles are on the trailing side of a part as it begins to open."""
    handles = np.setdiff1d(opener.body, opener.panel)
    if not len(handles):
        return False
    grip = bodies.vertices[handles].reshape(-1, 3).mean(axis=0)
    whole = bodies.vertices[opener.body].reshape(-1, 3).mean(axis=0)
    return bool((grip - whole) @ opener.velocity(grip[None])[0] < 0.0)


def measure_hinge(bodies: Bodies, opener: Opener) -> tuple[float, float]:
    """Distance (m) of a hinge from the nearer edge of its door, and the largest allowed distance."""
    axis, origin = opener.joint.axis, opener.joint.origin
    points = bodies.vertices[opener.panel if len(opener.panel) else opener.body].reshape(-1, 3)
    normal = thin_direction(points - (points.min(axis=0) + points.max(axis=0)) / 2)
    if abs(normal @ axis) > _PARALLEL:
        return 0.0, np.inf
    across = np.cross(normal, axis)
    across /= np.linalg.norm(across)
    extent = points @ across
    low, high, hinge = float(extent.min()), float(extent.max()), float(origin @ across)
    allowed = max(EDGE_RATIO * (high - low), float(np.ptp(points @ normal)) / 2)
    return min(abs(hinge - low), abs(hinge - high)), allowed


def measure_hung(bodies: Bodies, opener: Opener, carrier: Int[np.ndarray, "C"]) -> float:
    """Share of a door's height along its hinge at which its carrier is beside the hinge, behind the door."""
    axis, origin = opener.joint.axis, opener.joint.origin
    points = bodies.vertices[opener.body].reshape(-1, 3)
    out = opener.velocity((points.min(axis=0) + points.max(axis=0))[None] / 2)[0]
    side = int(np.abs(out).argmax())
    normal = np.eye(3)[side] * np.sign(out[side])
    heights = (points - origin) @ axis
    line = origin + np.linspace(heights.min(), heights.max(), _HINGE_POINTS)[:, None] * axis
    line += np.outer((points @ normal).min() - _BEHIND - line @ normal, normal)
    planes = bodies.planes[carrier]
    outside = planes[:, :, :3] @ line.T + planes[:, :, 3:]
    return float((outside.max(axis=1).min(axis=0) < HUNG_WITHIN).mean())


def measure_held(bodies: Bodies, opener: Opener, carriers: Int[np.ndarray, "C"]) -> float:
    """Share of a fully open slide's depth that overlaps the extent of its carriers."""
    axis = opener.joint.axis
    own = bodies.vertices[opener.panel if len(opener.panel) else opener.body] @ axis + opener.joint.upper
    held = bodies.vertices[carriers] @ axis
    inside = min(own.max(), held.max()) - max(own.min(), held.min())
    return max(0.0, float(inside / np.ptp(own)))


def measure_handle(bodies: Bodies, opener: Opener, handle: Int[np.ndarray, "H"]) -> float:
    """Clearance (m) that is missing to grasp a handle; 0 if it can be grasped.

    The middle of the handle must lie in front of the middle of its panel, with free depth for fingers behind
    it. A handle that is narrow enough for a gripper may be pinched instead if it protrudes from its panel.
    """
    corners = bodies.vertices[handle].reshape(-1, 3)
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    out = _way_out(bodies, opener, middle)
    frame = frame_along(out / max(float(np.linalg.norm(out)), 1e-12))
    grip = corners @ frame.T
    if not len(opener.panel):
        return 0.0
    panel = bodies.vertices[opener.panel] @ frame[2]
    front = float(middle @ frame[2] - (panel.min() + panel.max()) / 2)
    if front <= 0.0:
        return -front + PROTRUSION
    turns = np.radians(np.arange(0.0, 180.0, 5.0))
    width = np.ptp(grip[:, :2] @ np.stack([np.cos(turns), np.sin(turns)]), axis=0).min()
    if width <= GRASP_WIDTH and grip[:, 2].max() - panel.max() >= PROTRUSION:
        return 0.0
    clearance, protrusion = _measure_gaps(bodies, handle, opener.panel, frame, grip)
    pinch = max(width - GRASP_WIDTH, PROTRUSION - protrusion)
    return max(0.0, float(min(HOOK_DEPTH - clearance, pinch)))


def _way_out(bodies: Bodies, opener: Opener, grip: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Outward direction at a handle: its first motion, or the panel normal for a door that slides in its
    plane."""
    way = opener.velocity(grip[None])[0]
    if opener.joint.type != "prismatic" or opener.label != "door" or not len(opener.panel):
        return way
    points = bodies.vertices[opener.panel].reshape(-1, 3)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    normal = thin_direction(points - middle)
    if abs(normal @ way) > _PARALLEL:
        return way
    return normal if (grip - middle) @ normal >= 0.0 else -normal


def find_obstacles(bodies: Bodies, tree: Tree, index: int) -> Int[np.ndarray, "O"]:
    """Primitives of all bodies that carry a part."""
    return np.flatnonzero(np.isin(bodies.links, tree.ancestors[index]))


def _spread_points(bodies: Bodies, rows: Int[np.ndarray, "M"], count: int) -> Float[np.ndarray, "N 3"]:
    """Evenly spread points on the surfaces of primitives; deterministic."""
    corners = np.concatenate([bodies.vertices[row][bodies.primitives[row].faces] for row in rows])
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).cumsum()
    steps = np.arange(count)
    face = np.searchsorted(areas, (steps + 0.5) / count * areas[-1])
    along, aside = np.modf(0.5 + np.outer(_GOLDEN, steps))[0]
    over = along + aside > 1.0
    along, aside = np.where(over, 1.0 - along, along), np.where(over, 1.0 - aside, aside)
    return corners[face, 0] + along[:, None] * sides[face, 0] + aside[:, None] * sides[face, 1]


def _hit(
    bodies: Bodies,
    points: Float[np.ndarray, "N 3"],
    ways: Float[np.ndarray, "N 3"],
    obstacles: Int[np.ndarray, "O"],
) -> Bool[np.ndarray, "N"]:
    """Whether each straight path enters an obstacle from outside."""
    low = np.minimum(points, points + ways).min(axis=0)
    high = np.maximum(points, points + ways).max(axis=0)
    near = (bodies.low[obstacles] <= high).all(axis=1) & (bodies.high[obstacles] >= low).all(axis=1)
    enter, leave = _pass_through(bodies, obstacles[near], points, ways)
    return np.any((enter > 0.0) & (enter <= 1.0) & (enter < leave), axis=0)


def _pass_through(
    bodies: Bodies,
    rows: Int[np.ndarray, "R"],
    points: Float[np.ndarray, "N 3"],
    ways: Float[np.ndarray, "N 3"],
) -> tuple[Float[np.ndarray, "R N"], Float[np.ndarray, "R N"]]:
    """Parameters at which lines enter and leave solids, in units of ``ways``; a miss has enter >= leave."""
    planes = bodies.planes[rows]
    height = planes[:, :, :3] @ points.T + planes[:, :, 3:]
    slope = planes[:, :, :3] @ ways.T
    with np.errstate(divide="ignore", invalid="ignore"):
        at = -height / slope
    flat = np.abs(slope) < 1e-12
    enter = np.where(flat, np.where(height > 0, np.inf, -np.inf), np.where(slope < 0, at, -np.inf))
    leave = np.where(~flat & (slope > 0), at, np.inf)
    return enter.max(axis=1, initial=-np.inf), leave.min(axis=1, initial=np.inf)


def _measure_gaps(
    bodies: Bodies,
    handle: Int[np.ndarray, "H"],
    panel: Int[np.ndarray, "Q"],
    frame: Float[np.ndarray, "3 3"],
    grip: Float[np.ndarray, "N 3"],
) -> tuple[float, float]:
    """Free depth (m) behind the middle of a handle, and its protrusion (m) from its panel."""
    low, size = grip[:, :2].min(axis=0), np.ptp(grip[:, :2], axis=0)
    counts = np.maximum(np.ceil(size / size.max() * _COLUMNS), 1).astype(int)
    places = (np.indices(counts).reshape(2, -1).T + 0.5) / counts
    points = (low + places * size) @ frame[:2]
    ways = np.broadcast_to(frame[2], points.shape)
    enter, leave = _pass_through(bodies, handle, points, ways)
    back = np.where(enter < leave, enter, np.inf).min(axis=0)
    enter, leave = _pass_through(bodies, panel, points, ways)
    face = np.where(enter < leave, leave, -np.inf).max(axis=0)
    covered = np.isfinite(back)
    if not covered.any():
        return 0.0, 0.0
    middle = covered & (np.abs(places[:, int(size.argmax())] - 0.5) <= 0.25)
    chosen = middle if middle.any() else covered
    plate = face[covered & np.isfinite(face)]
    top = float(grip[:, 2].max())
    protrusion = top - float(np.median(plate)) if len(plate) else float(np.ptp(grip[:, 2]))
    return max(0.0, float(np.median(back[chosen] - face[chosen]))), protrusion
