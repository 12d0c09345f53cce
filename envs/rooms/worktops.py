"""One worktop over neighbouring units of a run, with what goes with it: end panels, hood.

It lies on the highest of the tops below it, all around the room at one height, has holes for sinks and stops
at ranges and tall units.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from .arrange import Place, Plan, fits
from .footprints import Deck, Footprint, bounds_of
from .pieces import GAP, Boxes, Cluster, Member, Piece, move_boxes
from .room import Side

WORKTOP = "worktop"
HOOD = "hood"
THICKNESS = 0.024
"""Thickness (m) of worktops."""
OVERHANG = 0.015
"""Distance (m) by which a worktop reaches beyond the fronts below it."""
PANEL = 0.018
"""Thickness (m) of panels."""
SETBACK = 0.01
"""Distance (m) of end panels behind the fronts beside them."""
LYING = 5e-4
"""Distance (m) between tops and the worktop on them."""
RIM = 0.004
"""Distance (m) of a worktop from the basin and the tap in its hole."""
HIGHEST = 1.02
"""Height (m) of the highest top below a worktop."""
JOINED = 0.35
"""Largest gap (m) between units below one worktop."""
HOOD_BOTTOM, HOOD_DEPTH, HOOD_HEIGHT, CHIMNEY = 1.62, 0.36, 0.07, 0.26
"""Underside above the floor, depth and height of hoods, and width of their chimneys (m)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Unit:
    """A unit in its run's frame: ends along y, x of its front, its deck's height and hole; ``covered`` if a
    worktop can lie on it."""

    start: float
    stop: float
    face: float
    height: float
    hole: Float[np.ndarray, "2 2"] | None
    covered: bool


def worktop_height(runs: dict[Side, Place]) -> float | None:
    """Height (m) of the underside of the worktops of runs; None if nothing can have one."""
    heights = [unit.height for run in runs.values() for unit in _units(run) if unit.covered]
    return max(heights) + LYING if heights else None


def lay_worktops(plan: Plan, runs: dict[Side, Place], height: float) -> Plan:
    """The plan with worktops on the low units of its runs, and panels at their open ends."""
    for side, run in runs.items():
        for units in _stretches(run):
            start, stop = units[0].start, units[-1].stop
            front = min(unit.face for unit in units) - OVERHANG
            plan, start, stop = _close_ends(plan, run, (start, stop), front, height)
            bodies = _slab(units, (start, stop), front, height)
            fitting = [
                box for box in bodies if fits(plan, move_boxes(Boxes(bodies=box[None]), run.T), plan.boxes)
            ]
            plan = _with_worktop(plan, run, side, np.array(fitting).reshape(-1, 2, 3))
            plan = _hide_gaps(plan, run, units, height)
    closed: set[Side] = {
        side for side in runs for place in plan.places if place.cluster.name.startswith(f"{side}_corner")
    }
    for side in closed:
        plan = _cover_corner(plan, side, height)
    return plan


def hang_hoods(plan: Plan, runs: dict[Side, Place]) -> Plan:
    """The plan with a hood above each range of its runs: a canopy, and a chimney up to the ceiling."""
    for run in runs.values():
        for member in run.cluster.members:
            if member.piece.role != "range":
                continue
            box = bounds_of(move_boxes(member.piece.boxes, member.T).bodies)
            middle, ceiling = float(box[:, 1].sum() / 2.0), plan.size[2]
            top = HOOD_BOTTOM + HOOD_HEIGHT
            bodies = np.array(
                [
                    [[-HOOD_DEPTH, box[0, 1], HOOD_BOTTOM], [-GAP, box[1, 1], top]],
                    [[-CHIMNEY, middle - CHIMNEY / 2, top], [-GAP, middle + CHIMNEY / 2, ceiling - GAP]],
                ]
            )
            plan = _with_fixture(plan, run, HOOD, bodies)
    return plan


def _units(run: Place) -> list[_Unit]:
    """The units of a run in their order along it."""
    units = []
    for member in run.cluster.members:
        piece, T = member.piece, member.T
        if piece.entry is None or piece.footprint is None:
            continue
        deck = piece.footprint.deck
        box = bounds_of(move_boxes(piece.boxes, T).bodies)
        height, face = deck.height + float(T[2, 3]), piece.face + float(T[0, 3])
        above = piece.footprint.sweeps[:, 1, 2] > deck.height + 0.005
        inside = piece.footprint.sweeps[:, 1, 0] > piece.face + 0.03
        low = height <= HIGHEST and piece.role != "range"
        opens = deck.hole is None and bool((above & inside).any())
        hole = None if deck.hole is None else deck.hole + T[:2, 3]
        units.append(
            _Unit(
                start=float(box[0, 1]), stop=float(box[1, 1]), face=face, height=height, hole=hole,
                covered=low and not opens,
            )
        )  # fmt: skip
    return sorted(units, key=lambda unit: unit.start)


def _stretches(run: Place) -> list[list[_Unit]]:
    """Neighbours that one worktop can cover."""
    stretches: list[list[_Unit]] = [[]]
    for unit in _units(run):
        if not unit.covered or (stretches[-1] and unit.start - stretches[-1][-1].stop > JOINED):
            stretches.append([])
        if unit.covered:
            stretches[-1].append(unit)
    return [units for units in stretches if units]


def _slab(
    units: list[_Unit], ends: tuple[float, float], front: float, height: float
) -> list[Float[np.ndarray, "2 3"]]:
    """A worktop in its run's frame, in pieces around its holes."""
    top, back = height + THICKNESS, -GAP
    bodies, at = [], ends[0]
    for hole in (unit.hole for unit in units if unit.hole is not None):
        (x0, y0), (x1, y1) = hole[0] - RIM, hole[1] + RIM
        bodies += [((front, at), (back, y0)), ((front, y0), (x0, y1)), ((x1, y0), (back, y1))]
        at = y1
    bodies.append(((front, at), (back, ends[1])))
    rows = [np.array([[*low, height], [*high, top]]) for low, high in bodies]
    return [row for row in rows if (row[1] - row[0] > 0.004).all()]


def _close_ends(
    plan: Plan, run: Place, ends: tuple[float, float], front: float, height: float
) -> tuple[Plan, float, float]:
    """The plan with a panel at each end of a stretch that nothing stands beside, and the ends around them."""
    out = list(ends)
    for end, sign in ((0, -1.0), (1, 1.0)):
        near, far = ends[end] + sign * LYING, ends[end] + sign * PANEL
        box = np.array(
            [[front + OVERHANG + SETBACK, min(near, far), GAP], [-GAP, max(near, far), height - LYING]]
        )
        beside = box + np.array([[0.0, min(sign, 0.0) * 0.05, 0.0], [0.0, max(sign, 0.0) * 0.05, 0.0]])
        room_left = fits(plan, move_boxes(Boxes(bodies=beside[None]), run.T), plan.boxes)
        if room_left and fits(plan, move_boxes(Boxes(bodies=box[None]), run.T), plan.boxes):
            plan = _with_fixture(plan, run, "filler", box[None])
            out[end] = far
    return plan, out[0], out[1]


def _hide_gaps(plan: Plan, run: Place, units: list[_Unit], height: float) -> Plan:
    """The plan with a strip below the worktop in front of every unit that is too low for it."""
    for unit in units:
        if height - unit.height > 0.006:
            low = (unit.face + 0.004, unit.start, unit.height + LYING)
            box = np.array([low, (unit.face + PANEL, unit.stop, height - LYING)])
            plan = _with_fixture(plan, run, "filler", box[None])
    return plan


def _cover_corner(plan: Plan, side: Side, height: float) -> Plan:
    """The plan with a worktop in the corner of the back wall and a side wall, between those of both runs."""
    slabs = {
        wall: np.concatenate([np.zeros((0, 2, 3)), *(place.boxes.bodies for place in _worktops(plan, wall))])
        for wall in ("back", side)
    }
    if not all(len(boxes) for boxes in slabs.values()):
        return plan
    end = 0 if side == "left" else 1
    pick = np.argmin if end == 0 else np.argmax
    back = slabs["back"][int(pick(slabs["back"][:, end, 0]))]
    beside = slabs[side][int(slabs[side][:, 1, 1].argmax())]
    wall, inner, front = abs(end * plan.size[0] - GAP), float(back[end, 0]), float(beside[1 - end, 0])
    step = max(float(back[0, 1]), float(beside[1, 1]))
    rows = [
        [[min(wall, inner), step, height], [max(wall, inner), plan.size[1] - GAP, height + THICKNESS]],
        [[min(wall, front), beside[1, 1], height], [max(wall, front), step, height + THICKNESS]],
    ]
    bodies = np.array([row for row in rows if (np.subtract(row[1], row[0]) > 0.004).all()])
    if not len(bodies) or not fits(plan, Boxes(bodies=bodies), plan.boxes):
        return plan
    return _with_piece(plan, _worktop_piece(bodies), f"{side}_corner", np.eye(4))


def _worktops(plan: Plan, side: Side) -> list[Place]:
    """The worktops of a run."""
    return [place for place in plan.places if place.cluster.name.startswith(f"{side}_{WORKTOP}")]


def _with_worktop(plan: Plan, run: Place, side: Side, bodies: Float[np.ndarray, "N 2 3"]) -> Plan:
    if not len(bodies):
        return plan
    return _with_piece(plan, _worktop_piece(bodies), f"{side}_{WORKTOP}", run.T)


def _worktop_piece(bodies: Float[np.ndarray, "N 2 3"]) -> Piece:
    """Slabs as a piece that carries objects."""
    body = bounds_of(bodies)
    tops = tuple(np.array([low, [high[0], low[1]], high, [low[0], high[1]]]) for low, high in bodies[..., :2])
    none = np.zeros((0, 2, 3))
    footprint = Footprint(
        body=body,
        solid=bodies,
        sweeps=none,
        fronts=np.zeros((0, 2)),
        tops=tops,
        face=float(body[0, 0]),
        deck=Deck(height=float(body[1, 2])),
    )
    return Piece(
        role=WORKTOP, entry=None, boxes=Boxes(bodies=bodies), face=float(body[0, 0]), footprint=footprint
    )


def _with_fixture(plan: Plan, run: Place, role: str, bodies: Float[np.ndarray, "N 2 3"]) -> Plan:
    """The plan with boxes in a run's frame, where they are free of conflicts."""
    piece = Piece(role=role, entry=None, boxes=Boxes(bodies=bodies), face=0.0)
    if not fits(plan, move_boxes(piece.boxes, run.T), plan.boxes):
        return plan
    return _with_piece(plan, piece, f"{run.cluster.name}_{role}", run.T)


def _with_piece(plan: Plan, piece: Piece, name: str, T: Float[np.ndarray, "4 4"]) -> Plan:
    alone = (Member(piece=piece, T=np.eye(4)),)
    cluster = Cluster(
        name=f"{name}_{len(plan.places)}", members=alone, boxes=piece.boxes, length=0.0, depth=0.0
    )
    return plan.with_place(Place(cluster=cluster, T=T, boxes=move_boxes(piece.boxes, T), side=None))
