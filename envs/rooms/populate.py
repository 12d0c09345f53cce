"""Furnishes rooms: from a room kind, a seed and validated packages to a `Room` in which everything opens.

The planner uses boxes and soft preferences; its result is verified on the actual hulls
(`envs.rooms.check`). An arrangement that fails is rejected and the next one is drawn, so that a
returned room keeps every guarantee. The first half of the attempts is of one look, with everything that the
recipe asks for; later ones take any package and do without what is not needed.
"""

import hashlib
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Literal
from zlib import crc32

import numpy as np

from artigen import __version__
from artigen.shapes.families import choose_suite
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.transforms import transform_points
from artigen.types import RoomKind

from .arrange import Place, Plan
from .catalogue import Catalogue, Entry, PopulateError, demand_roles
from .check import check_room
from .decor import decorate_room
from .doorway import hang_door
from .fittings import FITTINGS
from .floor import stand_on_floor
from .footprints import standing_places
from .furnish import furnish
from .openings import find_openings
from .order import demand_order, place_order, read_order
from .patterns import Pattern
from .pieces import Member, move_boxes
from .recipes import BASE, RECIPES, Recipe, soften
from .room import Fixture, Opening, Placement, Room, Side, corner, room_shell, rounded_quat
from .runs import Chooser, count_objects, draw_shortlists
from .site import Site
from .solids import place_solid
from .trim import trim_room
from .worktops import HOOD, WORKTOP

STEEL: Color = (0.70, 0.71, 0.72)
"""Colour of hoods."""

PASSAGE = 0.15
"""Width (m) of a passage beyond the robot's diameter."""


@dataclass(frozen=True, kw_only=True)
class PopulateConfig:
    """Room parameters; lengths in metres, None samples a value from the seed."""

    width: float | None = None
    """Inner length of the wall with the entrance."""
    depth: float | None = None
    """Inner distance from that wall to the opposite one."""
    height: float = 2.6
    """Height from floor to ceiling."""
    least: int | None = None
    """Smallest number of objects in a room; fewer is an error. By default that of its kind."""
    most: int = 30
    """Largest number of objects in a room."""
    sweeps: Literal["free", "any"] = "free"
    """``free`` keeps the swept space of doors and drawers free; ``any`` only avoids overlaps at rest."""
    standing_radius: float = 0.3
    """Radius of the robot's disc that stays free in front of every door and drawer; 0 disables it."""
    variety: int = 5
    """Number of packages per role; fewer make a room more uniform."""
    attempts: int = 12
    """Arrangements tried before giving up."""
    place: tuple[str, ...] = ()
    """Units along one wall, from left to right (`envs.rooms.order`); the room then holds nothing else but its
    door."""
    wall: Side = "back"
    """Wall of the ordered units."""

    def __post_init__(self) -> None:
        if not 1 <= (self.least or 1) <= self.most or self.least == 0:
            raise ValueError(f"least {self.least}, most {self.most} objects: expected 1 <= least <= most")
        if self.standing_radius < 0.0 or self.attempts < 1 or self.variety < 1:
            raise ValueError(
                f"standing_radius {self.standing_radius}, attempts {self.attempts}, variety {self.variety}: "
                "allowed is 0, 1 and 1 and above"
            )
        for name in ("width", "depth", "height"):
            value = getattr(self, name)
            if value is not None and not 0.5 <= value <= 20.0:
                raise ValueError(f"{name} {value} m, expected 0.5 to 20")


def populate(
    kind: RoomKind,
    seed: int,
    catalogue: Catalogue,
    cfg: PopulateConfig | None = None,
    site: Site | None = None,
) -> Room:
    """Furnishes a room; deterministic.

    Args:
        site: What a building prescribes; default: a room by itself, whose size is drawn.

    Raises:
        PopulateError: If a required role has no package, or the room cannot be furnished in the available
            space.
    """
    cfg = cfg or PopulateConfig()
    recipe = RECIPES[kind] if site is None else site.recipe
    least = min(recipe.least, cfg.most) if cfg.least is None else cfg.least
    order = read_order(cfg.place, kind)
    if order:
        demand_order(catalogue, order)
    else:
        demand_roles(catalogue, recipe)
    reasons: Counter[str] = Counter()
    best = 0
    for attempt in range(cfg.attempts):
        rng = np.random.default_rng([crc32(kind.encode()), seed, attempt])
        bare = _draw_room(recipe, rng, cfg) if site is None else _place_room(site, rng, cfg)
        strict = 2 * attempt < cfg.attempts
        shortlists = draw_shortlists(recipe, catalogue, rng, cfg.variety, alike=strict)
        spare = [name for name, entries in shortlists.items() if not (strict and entries)]
        chooser = Chooser(
            shortlists=shortlists,
            rng=rng,
            radius=cfg.standing_radius if cfg.sweeps == "free" else 0.0,
            sweeps=cfg.sweeps,
            most=cfg.most,
        )
        plan = hang_door(bare, chooser, None if site is None else site.span)
        if order:
            plan, missing = place_order(plan, order, cfg.wall, catalogue, chooser)
        else:
            plan, missing = furnish(plan, soften(recipe, spare), chooser)
        objects = count_objects(plan)
        best = max(best, objects)
        if not order and not missing and not least <= objects <= cfg.most:
            missing = f"{objects} objects, {least} to {cfg.most} are wanted"
        if missing:
            reasons[missing] += 1
            continue
        room = trim_room(_room(recipe, seed, attempt, plan, catalogue, cfg))
        if not order:
            room = stand_on_floor(decorate_room(room))
        problems = check_room(room, open_doors=site is not None)
        if cfg.sweeps == "any":
            problems = tuple(problem for problem in problems if problem.kind in ("overlap", "outside"))
        if not problems:
            return room
        reasons[problems[0].message] += 1
    said = "; ".join(f"{reason} ({count} times)" for reason, count in reasons.most_common(2))
    raise PopulateError(
        f"no {kind} of {_text(cfg.width, recipe.width)} x {_text(cfg.depth, recipe.depth)} m could be "
        f"furnished in {cfg.attempts} attempts: {said}; at best {best} objects found room, needed are "
        f"{len(order) or least}; give it more room or other packages"
    )


def _text(asked: float | None, drawn: tuple[float, float]) -> str:
    return f"{asked:g}" if asked is not None else f"{drawn[0]:g} to {drawn[1]:g}"


def _draw_room(recipe: Recipe, rng: np.random.Generator, cfg: PopulateConfig) -> Plan:
    """An empty room of some size with its entrance in the front wall."""
    width, depth = round(float(rng.uniform(*recipe.width)), 2), round(float(rng.uniform(*recipe.depth)), 2)
    size = (cfg.width or width, cfg.depth or depth, cfg.height)
    opening = min(0.95, size[0] - 0.2)
    start = float(rng.uniform(0.08, max(size[0] - opening - 0.08, 0.09)))
    entrance = Opening(
        side="front", start=round(start, 2), width=round(opening, 2), height=min(2.05, size[2] - 0.1)
    )
    return Plan(size=size, entrance=entrance)


def _place_room(site: Site, rng: np.random.Generator, cfg: PopulateConfig) -> Plan:
    """The empty room of a building, with an entrance that a robot passes somewhere in its span."""
    low, high = site.span
    width = min(high - low, max(0.9, 2.0 * cfg.standing_radius + PASSAGE))
    start = low + float(rng.uniform()) * (high - low - width)
    entrance = Opening(side="front", start=start, width=width, height=min(2.05, site.size[2] - 0.1))
    return Plan(size=site.size, entrance=entrance, doorways=site.doorways, outer=site.outer)


def _room(
    recipe: Recipe, seed: int, attempt: int, plan: Plan, catalogue: Catalogue, cfg: PopulateConfig
) -> Room:
    """Converts a plan to a room with stable ids: a role and a number, in the order of placement."""
    radius = cfg.standing_radius if cfg.sweeps == "free" else 0.0
    counts: Counter[str] = Counter()
    placements: list[Placement] = []
    fixtures: list[Fixture] = []
    openings: list[Opening] = []
    names: dict[int, str] = {}
    members = [member.piece for place in plan.places for member in place.cluster.members]
    placed = [piece.entry for piece in members if piece.entry is not None]
    units = [piece.entry for piece in members if piece.entry is not None and piece.role == BASE.name]
    looks = choose_filler_color(units or placed), choose_top(units or placed)
    suites = sorted(f"{each[0]}, suite {each[1]}" for each in _suites(placed) if each is not None)
    for place in plan.places:
        for member in place.cluster.members:
            if member.piece.entry is None:
                role = member.piece.role
                counts[role] += 1
                names[id(member.piece)] = f"{role}_{counts[role]}"
                fixtures += _fixtures(place, member, looks, names[id(member.piece)])
                continue
            slug = member.piece.role.replace(" ", "_")
            counts[slug] += 1
            names[id(member.piece)] = f"{slug}_{counts[slug]}"
            placements.append(_placement(place, member, member.piece.entry, names, radius))
            if place.side is not None:
                boxes = place_solid(placements[-1]).boxes
                openings += find_openings(boxes, place.side, plan.size)
    openings += plan.doorways
    shell = room_shell(plan.size, (plan.entrance, *openings), recipe.wall_color, recipe.floor, recipe.wall)
    return Room(
        kind=recipe.kind,
        seed=seed,
        attempt=attempt,
        size=plan.size,
        entrance=plan.entrance,
        standing_radius=radius,
        openings=tuple(openings),
        fixtures=(*shell, *fixtures),
        placements=tuple(placements),
        provenance=(
            ("generator", f"artigen {__version__} scene"),
            ("packages", f"{len(catalogue.entries)} proven packages in {catalogue.folder.name}"),
            ("look", suites[0] if len(suites) == 1 else f"{len(suites)} suites"),
            ("settings", json.dumps(asdict(cfg), sort_keys=True)),
        ),
    )


def _placement(place: Place, member: Member, entry: Entry, names: dict[int, str], radius: float) -> Placement:
    T = place.T @ member.T
    footprint = member.piece.footprint
    assert footprint is not None
    middles = standing_places(footprint, radius, member.piece.front)
    points = transform_points(T, np.column_stack([middles, np.zeros(len(middles))]))
    manifest = (entry.folder / "manifest.json").read_bytes()
    support = place.support
    return Placement(
        id=names[id(member.piece)],
        role=member.piece.role,
        category=entry.category,
        package=entry.folder,
        position=corner(T[:3, 3]),
        quat=rounded_quat(T[:3, :3]),
        size=corner(footprint.size),
        standing=tuple((round(float(x), 4), round(float(y), 4)) for x, y, _ in points),
        support=None if support is None else names[id(support)],
        provenance=(*entry.provenance, ("manifest_sha256", hashlib.sha256(manifest).hexdigest())),
    )


def _fixtures(
    place: Place, member: Member, looks: tuple[Color, tuple[Color, Pattern]], name: str
) -> list[Fixture]:
    """The boxes of a fitting, a worktop or a hood, or the cabinet front that closes a gap of a run.

    Args:
        looks: Colour of fronts, and colour and pattern of worktops.
    """
    role, bodies = member.piece.role, move_boxes(member.piece.boxes, place.T @ member.T).bodies
    front, (top, pattern) = looks
    if role in FITTINGS:
        parts = [(f"{name}_{part}", paint) for part, _, _, paint in FITTINGS[role].parts]
    elif role == WORKTOP:
        parts = [(f"{name}_{index}", top) for index in range(len(bodies))]
    elif role == HOOD:
        parts = [(f"{name}_canopy", STEEL), (f"{name}_chimney", STEEL)]
    else:
        parts = [(f"filler_{place.cluster.name}", front)]
    return [
        Fixture(
            name=part, low=corner(low), high=corner(high), color=paint,
            pattern=pattern if role == WORKTOP else "plain",
        )
        for (part, paint), (low, high) in zip(parts, bodies, strict=True)
    ]  # fmt: skip


def choose_top(entries: Sequence[Entry]) -> tuple[Color, Pattern]:
    """Colour and pattern of worktops: those of the suite of most packages; else pale stone."""
    finish = _finish(entries, "top")
    if finish is None:
        return (0.80, 0.78, 0.74), "stone"
    pattern: Pattern = "stone" if finish.kind == "stone" else "wood" if finish.kind == "wood" else "plain"
    return max(finish.color, finish.accent, key=sum) if pattern == "stone" else finish.color, pattern


def choose_filler_color(entries: Sequence[Entry]) -> Color:
    """That of the fronts in the suite of most packages; else a light grey."""
    finish = _finish(entries, "front")
    return (0.80, 0.79, 0.76) if finish is None else finish.color


def _finish(entries: Sequence[Entry], part: str) -> Finish | None:
    """The finish of a part of furniture in the suite of most packages; None if most are of none."""
    (suite, _), *_ = _suites(entries).most_common(1) or [(None, 0)]
    return None if suite is None else choose_suite(*suite).finishes["furniture"][part]


def _suites(entries: Sequence[Entry]) -> Counter[tuple[str, int] | None]:
    """How many packages are of each family and suite, and of none."""
    return Counter(entry.suite for entry in entries)
