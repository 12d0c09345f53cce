"""Adds levelling feet to objects that would topple or stand on a door.

Sources are drawn without a floor: a front trim hangs below the body, two legs are shorter than the others,
or a leaf is the lowest of all. Where the centre of mass lies outside of what touches the floor, or what
moves carries the object, feet under the corners of the body do what their maker would have done.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from jaxtyping import Float

from sim_export.collision.additions import add_hull
from sim_export.collision.contacts import HullSet, signed_distances
from sim_export.collision.hulls import box_hull, hull_planes
from sim_export.collision.sweeps import Sweep, read_sweeps
from sim_export.geometry.sampling import sample_triangles
from sim_export.package import Hull, Link, Mesh, PackageJoint, Requirement, Visual
from sim_export.physics.standing import MARGIN, center_of_mass, depth_of_mass

NEIGHBOURS = 4
"""Hulls near a foot that are tried for it to grow out of, where the body has no hull left to give."""

MARGIN_SHARE = 0.02
"""`MARGIN` over the smaller side of the object's floor plan, where this is less."""

# Lengths in metres.
LIFT = 0.003
"""How far feet lift what moves off the floor."""
MAX_HEIGHT = 0.2
"""Height of feet over that of the object, at most."""
WIDTH = 0.024
"""Side of a foot; over a fifteenth of the object's height, no more than that."""
INSET = 0.01
"""How far a foot stands back from the outline of the body."""
GRID = 80
"""Points along each side of the floor plan at which the body's underside is looked up."""
CLIMB = 3.0
"""What a metre of height counts against a metre away from the corner."""
MAX_STRETCH = 0.02
"""How far a foot is seen to reach above its hull, at most."""
SAMPLES = 200_000
"""Points on the body at which that is looked up."""
COLOR = (0.12, 0.12, 0.12)
"""Colour of feet: black rubber."""
CATEGORIES = frozenset({
    "BreadBox", "Cart", "ChestFreezer", "Dishwasher", "Dresser", "Dryer", "FilingCabinet", "Microwave",
    "Oven", "Printer", "Refrigerator", "Safe", "StorageFurniture", "Table", "Toaster", "Toilet", "ToolBox",
    "TrashCan", "Wardrobe", "WashingMachine",
})  # fmt: skip
"""What stands on the floor or on a worktop by itself."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Levelled:
    """Links, feet as visuals of the body, and a sentence where any were added."""

    links: tuple[Link, ...]
    feet: tuple[Visual, ...] = ()
    records: tuple[str, ...] = ()


def level_object(
    links: Sequence[Link],
    joints: Sequence[PackageJoint],
    requirements: Sequence[Requirement],
    category: str,
    shown: Float[np.ndarray, "F 3 3"],
) -> Levelled:
    """Adds feet under the corners of the body where the object does not stand by itself.

    Args:
        links: Links with hulls and inertials, object frame at rest; the body is the last.
        joints: Their joints.
        requirements: Joints that must be open while another moves.
        category: What the object is.
        shown: Triangles (m) that are seen of the body; feet reach up to them.

    Returns:
        New links; all are the same objects where none is needed, or where none has room.
    """
    unchanged = Levelled(links=tuple(links))
    if category not in CATEGORIES or not links[-1].hulls:
        return unchanged
    sets = [HullSet(hulls=link.hulls) for link in links]
    low, high = _bounds(sets)
    rolling = any(link.label == "wheel" for link in links)
    moving = min((float(s.vertices[:, 2].min()) for s in sets[:-1] if s.hulls), default=np.inf)
    on_leaf = not rolling and moving < low[2] + 0.5 * LIFT and moving <= sets[-1].vertices[:, 2].min()
    margin = min(MARGIN, MARGIN_SHARE * float((high - low)[:2].min()))
    carried = _depth_of_mass(links, sets)
    if carried >= (0.0 if rolling else margin) and not on_leaf:
        return unchanged
    floor = min(float(low[2]), moving - LIFT if on_leaf else np.inf)
    sweeps = read_sweeps(links, joints, requirements)
    wanted = _place_feet(sets[-1], floor, float(high[2] - floor))
    if rolling:
        wanted = _choose_feet(wanted, links, sets, margin)
    feet = [foot for foot in wanted if _stands(foot, sets, sweeps)]
    part = links[-1].parts[0]
    points = sample_triangles(shown, SAMPLES)[0] if feet else np.zeros((0, 3))
    visuals = tuple(
        Visual(
            name=f"foot_{index}",
            part=part,
            label="base",
            mesh=_show_foot(foot, points),
        )
        for index, foot in enumerate(feet)
    )
    if not feet:
        return replace(unchanged, records=(f"{links[-1].name}: stands badly, and no foot has room",))
    after = _depth_of_mass(links, sets)
    reason = "a moving link carried the object" if on_leaf else "its centre of mass was not above its support"
    record = (
        f"{links[-1].name}: {len(feet)} levelling feet up to "
        f"{1000 * max(np.ptp(foot.vertices[:, 2]) for foot in feet):.0f} mm high were added because {reason}"
        + ("" if after >= margin else "; it still is not")
    )
    body = replace(links[-1], hulls=sets[-1].hulls)
    return Levelled(links=(*links[:-1], body), feet=visuals, records=(record,))


def _show_foot(foot: Hull, points: Float[np.ndarray, "N 3"]) -> Mesh:
    """A foot, stretched up to points on the body above it where the hull that carries it ends lower."""
    low, high = foot.vertices.min(axis=0), foot.vertices.max(axis=0)
    above = ((points[:, :2] >= low[:2]) & (points[:, :2] <= high[:2])).all(axis=1)
    gap = float(points[above, 2].min(initial=np.inf) - high[2])
    stretched = foot.vertices.copy()
    if 0.0 < gap <= MAX_STRETCH:
        stretched[foot.vertices[:, 2] > low[2] + 1e-6, 2] += gap
    return Mesh(vertices=stretched, faces=foot.faces, color=COLOR)


def _bounds(sets: Sequence[HullSet]) -> tuple[np.ndarray, np.ndarray]:
    points = np.concatenate([hulls.vertices for hulls in sets])
    return points.min(axis=0), points.max(axis=0)


def _depth_of_mass(links: Sequence[Link], sets: Sequence[HullSet]) -> float:
    """How far (m) the centre of mass lies inside of what touches the floor; negative outside."""
    return depth_of_mass(np.concatenate([hulls.vertices for hulls in sets]), center_of_mass(links))


def _choose_feet(
    feet: Sequence[Hull], links: Sequence[Link], sets: Sequence[HullSet], margin: float
) -> list[Hull]:
    """A pair of feet, or more, with which the centre of mass lies ``margin`` (m) inside of the support: the
    fewest, and of these those that hold it deepest; none if all do not suffice."""
    for count in range(2, len(feet) + 1):
        chosen = [list(some) for some in combinations(feet, count)]
        depths = [_depth_of_mass(links, [*sets, HullSet(hulls=tuple(some))]) for some in chosen]
        if max(depths) >= margin:
            return chosen[int(np.argmax(depths))]
    return []


def _place_feet(body: HullSet, floor: float, height: float) -> list[Hull]:
    """Boxes from the floor into the underside of the body, near its four corners; those not needed too."""
    width = min(WIDTH, height / 15.0)
    low, high = body.vertices.min(axis=0)[:2], body.vertices.max(axis=0)[:2]
    back = INSET + width / 2
    axes = [np.linspace(low[n] + back, high[n] - back, GRID) for n in range(2)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    under = _undersides(body, points) - floor
    able = np.flatnonzero(under <= MAX_HEIGHT * height)
    feet, taken = [], set()
    for corner in ((low[0], low[1]), (low[0], high[1]), (high[0], low[1]), (high[0], high[1])):
        if not len(able):
            break
        away = np.linalg.norm(points[able] - corner, axis=1)
        best = int(able[(away + CLIMB * under[able]).argmin()])
        if best in taken:
            continue
        taken.add(best)
        middle, top = points[best], floor + max(under[best] + 1e-3, 2e-3)
        low_corner, high_corner = np.append(middle - width / 2, floor), np.append(middle + width / 2, top)
        feet.append(box_hull(low_corner, high_corner))
    return feet


def _undersides(body: HullSet, points: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, "N"]:
    """Height (m) at which vertical lines through points first meet a hull from below; infinite for none."""
    out = np.full(len(points), np.inf)
    for hull in body.hulls:
        planes = hull_planes(hull)
        enter, leave = np.full(len(points), -np.inf), np.full(len(points), np.inf)
        rest = planes[:, 3] - points @ planes[:, :2].T  # N F: n_z z <= rest
        for slope, room in zip(planes[:, 2], rest.T, strict=True):
            if slope < -1e-12:
                enter = np.maximum(enter, room / slope)
            elif slope > 1e-12:
                leave = np.minimum(leave, room / slope)
            else:
                enter = np.where(room < 0, np.inf, enter)
        out = np.where(enter <= leave, np.minimum(out, enter), out)
    return out


def _stands(foot: Hull, sets: list[HullSet], sweeps: Sequence[Sweep]) -> bool:
    """Adds a foot to the body's hulls, the last of ``sets``, if it has room."""
    still = np.eye(4)
    found = signed_distances(HullSet(hulls=(foot,)), sets[-1], still, still, max_distance=np.inf)
    order = np.argsort(found.distance, kind="stable")[:NEIGHBOURS]
    nearest = [sets[-1].hulls[int(index)] for index in dict.fromkeys(found.second[order].tolist())]
    for stand in nearest:
        added = add_hull(sets, sweeps, len(sets) - 1, foot, stand)
        if added is not None:
            sets[-1] = added
            return True
    return False
