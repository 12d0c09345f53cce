"""Furnishes flats: each room of a plan within its own walls, leaves of the tree of doors first."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from itertools import islice
from typing import Literal

import numpy as np

from artigen.transforms import inverse, transform_points
from artigen.types import RoomKind
from envs.rooms.catalogue import Catalogue, PopulateError
from envs.rooms.check import check_room
from envs.rooms.populate import PASSAGE, PopulateConfig, populate
from envs.rooms.recipes import DOOR, RECIPES, Recipe, Role
from envs.rooms.room import Opening, Room, wall_axis
from envs.rooms.site import Site

from .flat import Flat, frame_of, join_rooms, move_opening
from .layout import FlatPlan, draw_plans

PLANS, ROUNDS, ATTEMPTS = 6, 3, 12
"""Number of plans, of times that rooms of one are furnished anew, and of arrangements of a room."""
FRAME = 0.24
"""Width (m) of the frame of a door, its open leaf and its lever: the rest of it is free."""
WIDER = 0.2
"""Largest difference (m) of a door from the narrowest that a robot passes: without double doors."""


@dataclass(frozen=True, kw_only=True)
class FlatConfig:
    """Properties of all rooms of a flat, as those of `PopulateConfig`."""

    most: int = 30
    sweeps: Literal["free", "any"] = "free"
    standing_radius: float = 0.3


def furnish_flat(
    kinds: Sequence[RoomKind], seed: int, catalogue: Catalogue, cfg: FlatConfig | None = None
) -> Flat:
    """Furnishes a flat of the rooms; deterministic.

    Every room satisfies the guarantees of a room by itself, and the whole those of one room, whose doors
    stand open where a robot passes them.

    Raises:
        ArtigenError: If no plan is found, or none can be furnished.
    """
    cfg = cfg or FlatConfig()
    catalogue, width = choose_doors(catalogue, cfg.standing_radius)
    reason = ""
    for plan in islice(draw_plans(kinds, seed, width), PLANS):
        rooms: dict[int, Room] = {}
        for attempt in range(ROUNDS):
            try:
                rooms = _furnish_rooms(plan, rooms, seed + 1000 * attempt, catalogue, cfg)
            except PopulateError as error:
                reason = str(error)
                break
            made_from = dict(rooms[0].provenance)
            made_from["settings"] = json.dumps({"rooms": kinds, **asdict(cfg)}, sort_keys=True)
            flat = Flat(
                seed=seed,
                plan=plan,
                rooms=tuple(rooms[index] for index in range(len(plan.cells))),
                provenance=tuple(made_from.items()),
            )
            problems = [
                problem
                for problem in check_room(join_rooms(flat), open_doors=True)
                if cfg.sweeps == "free" or problem.kind in ("overlap", "outside")
            ]
            if not problems:
                return flat
            reason = problems[0].message
            wrong = {name for problem in problems for name in (problem.id, problem.other)}
            rooms = _without(plan, rooms, wrong)
    raise PopulateError(
        f"no flat of {', '.join(kinds)} with seed {seed} could be furnished in {PLANS} plans: {reason}; try "
        "another seed, other packages or a smaller radius of the robot"
    )


def choose_doors(catalogue: Catalogue, radius: float) -> tuple[Catalogue, float]:
    """The packages without doors that a robot cannot pass or that are far wider, and the width (m) of wall
    that the widest of the others takes, or an opening without a door."""
    doors = [entry for entry in catalogue.of_role(DOOR) if entry.size[1] >= least_door(radius)]
    narrowest = min((entry.size[1] for entry in doors), default=0.0)
    kept = {entry.folder for entry in doors if entry.size[1] <= narrowest + WIDER}
    entries = tuple(
        entry for entry in catalogue.entries if entry.category not in DOOR.categories or entry.folder in kept
    )
    widths = [entry.size[1] for entry in entries if entry.folder in kept]
    return replace(catalogue, entries=entries), max(widths, default=max(0.9, 2.0 * radius + PASSAGE))


def least_door(radius: float) -> float:
    """Width (m) of the narrowest door, with its frame, that a robot passes."""
    return 2.0 * radius + PASSAGE + FRAME


def _furnish_rooms(
    plan: FlatPlan, known: dict[int, Room], seed: int, catalogue: Catalogue, cfg: FlatConfig
) -> dict[int, Room]:
    """All rooms of a plan, those that are known already as they are."""
    rooms = dict(known)
    frames = [frame_of(cell) for cell in plan.cells]
    for index in _leaves_first(plan):
        if index in rooms:
            continue
        cell, frame = plan.cells[index], frames[index]
        doorways: list[Opening] = []
        for other, child in enumerate(plan.cells):
            if child.parent == index:
                T = inverse(frame.T) @ frames[other].T
                opposite = frame.side_in_room(frames[other].side_in_flat("back"))
                doorways.append(move_opening(rooms[other].entrance, rooms[other].size, T, opposite))
        ends = np.zeros((2, 3))
        ends[:, wall_axis(cell.side)] = cell.span
        low, high = np.sort(transform_points(inverse(frame.T), ends)[:, 0])
        site = Site(
            recipe=relax(RECIPES[cell.zone.kind]),
            size=frame.size,
            span=(float(low), float(high)),
            doorways=tuple(doorways),
            outer=tuple(frame.side_in_room(side) for side in cell.outer),
        )
        wanted = PopulateConfig(
            width=frame.size[0], depth=frame.size[1], height=frame.size[2], least=1, most=cfg.most,
            sweeps=cfg.sweeps, standing_radius=cfg.standing_radius, attempts=ATTEMPTS,
        )  # fmt: skip
        rooms[index] = populate(cell.zone.kind, 100 * seed + index, catalogue, wanted, site)
    return rooms


def relax(recipe: Recipe) -> Recipe:
    """The recipe with its runs, or its first group and a basin, as its purpose; all else is optional."""
    first = recipe.groups[:1] if recipe.kind != "hall" and not recipe.layouts else ()
    rest = recipe.groups[len(first) :]
    others = tuple(
        group if group.roles == ("sink",) else replace(group, count=(0, group.count[1])) for group in rest
    )
    asked = {role for group in first for role in group.roles} | {share.role.name for share in recipe.shares}
    needed = tuple(role for role in recipe.needed if role.name in asked)
    return replace(recipe, groups=(*first, *others), needed=needed)


def flat_roles(kinds: Sequence[RoomKind]) -> tuple[Role, ...]:
    """Every role that the rooms can use, once each, but doors."""
    roles = {role.name: role for kind in kinds for role in RECIPES[kind].all_roles}
    return tuple(role for role in roles.values() if role != DOOR)


def _leaves_first(plan: FlatPlan) -> list[int]:
    """Cells in an order in which those that a room leads to come before it."""

    def depth(index: int) -> int:
        parent = plan.cells[index].parent
        return 0 if parent is None else 1 + depth(parent)

    return sorted(range(len(plan.cells)), key=depth, reverse=True)


def _without(plan: FlatPlan, rooms: dict[int, Room], wrong: set[str]) -> dict[int, Room]:
    """The rooms but those that hold something wrong, and those that lead to one of them, whose doors move."""
    lost = {
        index
        for index, cell in enumerate(plan.cells)
        if any(name.startswith(f"{cell.zone.name}_") for name in wrong)
    } or set(rooms)
    for index in _leaves_first(plan):
        parent = plan.cells[index].parent
        if index in lost and parent is not None:
            lost.add(parent)
    return {index: room for index, room in rooms.items() if index not in lost}
