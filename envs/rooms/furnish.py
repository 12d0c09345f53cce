"""Furnishes a room in order: runs, windows, wall cabinets, groups, and objects on top of them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .arrange import Place, Plan, Taste, best_place, fits, middle_places, wall_places
from .catalogue import Entry
from .fittings import FITTINGS, make_fitting
from .footprints import carries, read_footprint
from .hung import hang_cabinets
from .pieces import GAP, Cluster, Member, Piece, back_to_back, line_up, move_boxes
from .recipes import WINDOWS, Group, Recipe, Share
from .room import SIDES, turn_matrix
from .runs import Chooser, close_corners, close_gaps, count_objects, place_runs, runs_of
from .worktops import hang_hoods, lay_worktops, worktop_height

AISLE = 0.6
"""Distance (m) of groups in the middle from other bodies."""
HAIR = 4e-4
"""Gap (m) between a top and the object on it."""
CLEAR = 1e-3
"""Distance (m) of fillers from the worktop above them."""
BEFORE_WINDOW = 0.65
"""Distance (m) from the wall at which a robot stands to open a window: in front of what is below it. As far
from the wall nothing is taller than the sill."""
TOP_HEIGHTS = (0.5, 1.05)
"""Range of heights (m) of tops that may carry objects."""
BARE_ROLES = frozenset(
    {"range", "wall cabinet", "safe", "cart", "window", "toilet", "nightstand", "microwave", "table oven"}
)
"""Roles that carry nothing."""
GOOD_TOPS = frozenset({"worktop", "base cabinet", "sideboard", "filing cabinet", "island"})
"""Roles that are preferred as supports."""


def furnish(plan: Plan, recipe: Recipe, chooser: Chooser) -> tuple[Plan, str]:
    """The fully furnished plan, and the missing requirement (empty if there is none)."""
    if recipe.layouts:
        plan, missing = place_runs(plan, recipe, chooser)
        if missing:
            return plan, missing
        runs = runs_of(plan)
        height = worktop_height(runs)
        if height is not None:
            plan = lay_worktops(close_gaps(close_corners(plan, height - CLEAR)), runs, height)
        plan = hang_hoods(plan, runs)
    plan, _ = _place_groups(plan, recipe, (WINDOWS,), chooser)
    if recipe.hung is not None:
        plan = hang_cabinets(plan, recipe.hung, chooser)
    plan, missing = _place_groups(plan, recipe, recipe.groups, chooser)
    for share in () if missing else recipe.tops:
        plan = put_on_tops(plan, share, chooser)
    return plan, missing


def _place_groups(plan: Plan, recipe: Recipe, groups: Sequence[Group], chooser: Chooser) -> tuple[Plan, str]:
    """The plan with groups, and the missing requirement (empty if there is none)."""
    for group in groups:
        count = int(chooser.rng.integers(group.count[0], group.count[1] + 1))
        if chooser.rng.random() < 0.6:
            count = group.count[1]  # prefer furnished over bare
        for copy in range(count):
            placed = place_group(plan, recipe, group, chooser, whole=copy < group.count[0])
            if placed is None and copy < group.count[0]:
                return plan, f"no room for the {group.name}"
            plan = placed or plan
    return plan, ""


def place_group(plan: Plan, recipe: Recipe, group: Group, chooser: Chooser, *, whole: bool) -> Plan | None:
    """The plan with one more group, whose last members are dropped if they do not fit; None if it cannot be
    placed.

    With ``whole``, a member of every role that the room needs is required.
    """
    needed = {role.name for role in recipe.needed} | set(FITTINGS)
    chosen: dict[str, int] = {}
    roles = list(group.roles)
    while roles:
        pieces = _draw_pieces(roles, chooser, chosen, group)
        asked = [role for role in roles if role in needed] if whole else []
        lacking = [role for role in asked if role not in {piece.role for piece in pieces}]
        if lacking or not pieces or count_objects(plan) + len(pieces) > chooser.most:
            return None
        place = _find_place(plan, group, _cluster(group, pieces, chooser), chooser)
        if place is not None:
            return plan.with_place(place)
        roles.pop()
        if whole and not set(group.roles) & needed <= set(roles):
            return None
    return None


def _draw_pieces(roles: list[str], chooser: Chooser, chosen: dict[str, int], group: Group) -> list[Piece]:
    """A piece for every role that has packages; equal roles get the same package."""
    pieces = []
    for role in roles:
        if role in FITTINGS:
            pieces.append(make_fitting(role))
            continue
        entries = chooser.shortlists[role]
        if not entries:
            continue
        index = chosen.setdefault(role, int(chooser.rng.integers(len(entries))))
        if group.height is None:
            pieces.append(chooser.piece(entries[index], role))
        else:
            pieces.append(_draw_window(entries[index], role, chooser, group.sunk, group.height))
    return pieces


def _draw_window(entry: Entry, role: str, chooser: Chooser, sunk: float, height: float) -> Piece:
    """A window as a piece that keeps the space before it free, from its sill to its top."""
    body = read_footprint(entry.folder).body
    front = float(body[1, 0]) + GAP - sunk - BEFORE_WINDOW
    piece = chooser.piece(entry, role, front, height)
    before = np.array([[front, *body[0, 1:]], body[1]])
    return replace(
        piece, boxes=replace(piece.boxes, sweeps=np.concatenate([piece.boxes.sweeps, before[None]]))
    )


def _cluster(group: Group, pieces: list[Piece], chooser: Chooser) -> Cluster:
    if group.double and len(pieces) > 1:
        half = (len(pieces) + 1) // 2
        return back_to_back(group.name, line_up("near", pieces[:half]), line_up("far", pieces[half:]))
    flipped = chooser.rng.random() < 0.5
    return line_up(group.name, pieces[::-1] if flipped else pieces, group.height)


def _find_place(plan: Plan, group: Group, cluster: Cluster, chooser: Chooser) -> Place | None:
    near = [place.center for place in plan.places if place.cluster.name == group.near]
    taste = Taste(
        corner=1.0 if group.like == "corner" else 0.0,
        middle=1.2 if group.like == "middle" else 0.0,
        near=(float(near[0][0]), float(near[0][1])) if near else None,
    )
    if group.where == "middle":
        return best_place(plan, middle_places(plan, cluster), taste, chooser.rng, aisle=AISLE)
    sides = plan.outer if group.sunk > 0.0 else SIDES
    places = [place for side in sides for place in wall_places(plan, cluster, side, sunk=group.sunk)]
    return best_place(plan, places, taste, chooser.rng)


def put_on_tops(plan: Plan, share: Share, chooser: Chooser) -> Plan:
    """The plan with up to the desired number of objects of a role on level tops."""
    entries = chooser.shortlists[share.role.name]
    supports = [
        (place, member)
        for place in plan.places
        for member in place.cluster.members
        if member.piece.footprint is not None
        and (member.piece.role in share.on if share.on else member.piece.role not in BARE_ROLES)
    ]
    order = chooser.rng.permutation(len(supports)).tolist()
    order.sort(key=lambda index: supports[index][1].piece.role not in GOOD_TOPS)
    wanted = int(chooser.rng.integers(max(share.wanted - 1, 1), share.wanted + 1))
    left = min(wanted, len(entries), chooser.most - count_objects(plan))
    likes = chooser.rng.permutation(len(entries)).tolist()
    for index in order:
        if left <= 0:
            break
        entry = entries[likes[left - 1]]
        place = _top_place(plan, supports[index], chooser, (share.role.name, entry))
        if place is not None:
            plan = plan.with_place(place)
            left -= 1
    return plan


def _top_place(
    plan: Plan, under: tuple[Place, Member], chooser: Chooser, what: tuple[str, Entry]
) -> Place | None:
    """A place for a package on a member, with parallel backs: on a worktop anywhere, else in its middle."""
    (place, member), (role, entry) = under, what
    support = member.piece.footprint
    assert support is not None
    T_support = place.T @ member.T
    top = float(support.body[1, 2] + T_support[2, 3])
    if not TOP_HEIGHTS[0] <= top <= TOP_HEIGHTS[1] or not support.tops:
        return None
    probe = chooser.piece(entry, role)
    assert probe.footprint is not None
    body = probe.footprint.body
    outline = np.concatenate(support.tops)
    back = float(outline[:, 0].max()) - 0.02
    shift = np.array([back - body[1, 0], 0.0, support.body[1, 2] + HAIR - body[0, 2]])
    front = float(support.body[0, 0]) - shift[0]
    piece = chooser.piece(entry, role, front, elevation=top + HAIR)
    low, high = float(outline[:, 1].min() - body[0, 1]), float(outline[:, 1].max() - body[1, 1])
    against = plan.boxes
    middle = (
        (low + high) / 2.0 if member.piece.entry is not None else chooser.rng.uniform(low, max(low, high))
    )
    for y in sorted(np.arange(low, high, 0.05).tolist(), key=lambda y: abs(y - middle)):
        step = turn_matrix(0.0)
        step[:3, 3] = (shift[0], y, shift[2])
        if not _carried(support.tops, body, step):
            continue
        T = T_support @ step
        boxes = move_boxes(piece.boxes, T)
        if fits(plan, boxes, against):
            alone = replace(member, piece=piece, T=np.eye(4))
            cluster = Cluster(name=role, members=(alone,), boxes=piece.boxes, length=0.0, depth=0.0)
            return Place(cluster=cluster, T=T, boxes=boxes, side=None, support=member.piece)
    return None


def _carried(tops: tuple, body: np.ndarray, T: np.ndarray) -> bool:
    """Whether a grid over a body's footprint lies on the tops."""
    x, y = np.meshgrid(
        np.linspace(body[0, 0] + 0.01, body[1, 0] - 0.03, 5),
        np.linspace(body[0, 1] + 0.01, body[1, 1] - 0.01, 5),
    )
    points = np.column_stack([x.ravel(), y.ravel()]) + T[:2, 3]
    return bool(carries(tops, points).all())
