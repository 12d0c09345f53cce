"""Furnishes a room from a kind and a seed."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from artigen.api.batch import run_with_progress
from artigen.api.sample import ShapeJob, ShapeSettings, export_and_validate
from artigen.datasets.packing import need
from artigen.errors import ArtigenError, explain
from artigen.runtime.runner import LocalRunner, Runner
from artigen.types import Clutter, SceneKind

if TYPE_CHECKING:
    from envs.rooms.catalogue import Catalogue
    from envs.rooms.order import Unit
    from envs.rooms.populate import PopulateConfig
    from envs.rooms.recipes import Recipe, Role
    from envs.rooms.room import Room

SceneFormat = Literal["mjcf", "usd"]
Pictures = Literal["all", "daylight", "plan", "none"]
PACKAGES = "packages"
"""Subfolder of the room for objects that are drawn for it."""
SPARE = 0.05
"""Width (m) of the doors of a flat beyond the least that a robot passes."""
ROUNDS = 3
"""Maximum number of draws for a role without a valid object."""
FAMILIES: dict[SceneKind, tuple[str, ...]] = {
    "kitchen": ("shaker", "slab", "rustic", "industrial", "midcentury"),
    "office": ("slab", "industrial", "midcentury", "laboratory"),
    "bedroom": ("shaker", "slab", "rustic", "midcentury", "nursery"),
    "bathroom": ("shaker", "slab", "rustic", "laboratory"),
    "workshop": ("industrial", "laboratory"),
    "living_room": ("shaker", "slab", "rustic", "midcentury"),
    "hall": ("shaker", "slab", "rustic", "midcentury"),
    "laundry": ("shaker", "slab", "laboratory"),
    "flat": ("shaker", "slab", "rustic", "midcentury"),
}
"""Families that the seed chooses from by default."""


@dataclass(frozen=True, kw_only=True)
class SceneSettings:
    """Properties of the room; unset properties are sampled from the seed."""

    width: float | None = None
    """Inner width in metres, along the wall with the entrance."""
    depth: float | None = None
    """Inner depth in metres, from that wall to the opposite one."""
    least: int | None = None
    """Minimum number of objects; by default that of the kind of room."""
    most: int = 30
    """Maximum number of objects."""
    sweeps: Literal["free", "any"] = "free"
    """``free`` keeps the swept volume of doors and drawers clear; ``any`` only avoids overlaps at rest."""
    standing_radius: float = 0.3
    """Radius in metres of the disc kept free for a robot in front of every door and drawer; 0 for none."""
    ajar: float = 0.0
    """Fraction of the doors and drawers that stand open."""
    contents: float = 0.0
    """Fraction of the drawers and compartments behind doors that hold loose things."""
    clutter: Clutter = "tidy"
    """Amount of loose things on furniture."""
    place: tuple[str, ...] = ()
    """Units along one wall from left to right, such as ``fridge 2*cabinet:0.6 oven``, and nothing else;
    folders of packages, or a YAML file with a list of either."""
    wall: Literal["front", "back", "left", "right"] = "back"
    """Wall of these units."""
    rooms: tuple[str, ...] = ()
    """Rooms of a flat: how many (2 to 7, by default 4), or kinds such as ``hall kitchen bedroom``, where a
    hall or a living room leads to the others."""
    family: str | None = None
    """Look of everything that is drawn, such as shaker, slab or industrial; sampled if unset."""


@dataclass(frozen=True, kw_only=True)
class Furnished:
    """A room, its file, packages that were left out since they did not pass, and the time it took (s)."""

    room: "Room"
    path: Path
    failed: tuple[str, ...]
    seconds: float

    def describe(self) -> str:
        """Size, objects and file in one line."""
        room = self.room
        kinds = len({placement.package for placement in room.placements})
        loose = f", with {len(room.contents)} loose things" if room.contents else ""
        left_out = f", without {len(self.failed)} packages that did not pass" if self.failed else ""
        kind = room.kind.replace("_", " ")
        if room.zones:
            kind = f"flat with {', '.join(zone.name.replace('_', ' ') for zone in room.zones)}"
        return (
            f"{kind} of {room.size[0]:.2f} x {room.size[1]:.2f} m: {len(room.placements)} objects from "
            f"{kinds} packages{loose} in {self.path}, arranged and checked in {self.seconds:.1f} s{left_out}"
        )


def furnish_room(
    kind: str,
    out: Path,
    seed: int = 0,
    packages: Path | None = None,
    cfg: SceneSettings | None = None,
    *,
    formats: tuple[SceneFormat, ...] = ("mjcf",),
    pictures: Pictures = "all",
    runner: Runner | None = None,
) -> Furnished:
    """Furnishes a room or a flat in which every door and drawer opens; writes ``scene.json`` and pictures.

    Args:
        kind: Kitchen, office, bedroom, bathroom, workshop, living_room, hall, laundry or flat.
        out: Folder for ``scene.json``, ``goals.json``, ``references.json``, ``room.png``, ``entrance.png``
            and ``corner.png`` (of a flat, two for each room) and ``plan.png``.
        seed: Seed of everything that is not set.
        packages: Folder with packages, at any depth, that passed validation; without it, objects are sampled
            and validated first, which takes minutes.
        cfg: Properties of the room.
        formats: Files besides ``scene.json``: ``mjcf`` is ``scene.xml`` for MuJoCo, ``usd`` is ``scene.usda``
            with an asset per package.
        pictures: Pictures to render: all, all with those at eye level in daylight (Mitsuba 3, minutes),
            the plan only, or none.
        runner: Where objects are sampled; default: one after the other in this process.

    Raises:
        ArtigenError: If settings are out of range or contradict each other, no arrangement is found, or
            usd-core is missing where it is needed.
    """
    from envs.rooms.catalogue import read_catalogue

    cfg = cfg or SceneSettings()
    if kind not in FAMILIES:
        raise ArtigenError(f"room {kind!r} is not known, expected one of {', '.join(FAMILIES)}")
    check_extras(formats, pictures)
    cfg = replace(cfg, place=read_places(cfg.place))
    wanted = check_settings(kind, seed, cfg)
    if packages is not None and cfg.family is not None:
        raise ArtigenError(
            f"family {cfg.family} with packages {packages}: objects of a folder keep their looks; omit one of"
            " the two"
        )
    if packages is None:
        family = cfg.family or choose_family(kind, seed)
        catalogue = draw_packages(wanted, seed, family, out / PACKAGES, runner or LocalRunner(workers=0))
    else:
        catalogue = read_catalogue(packages)
    return furnish_from(kind, out, seed, catalogue, cfg, formats=formats, pictures=pictures)


def check_extras(formats: tuple[SceneFormat, ...], pictures: Pictures) -> None:
    """Checks that what formats and pictures need is installed.

    Raises:
        ArtigenError: If it is not.
    """
    from sim_export.picture.tracing import require_mitsuba
    from sim_export.usd.write import require_usd

    if "usd" in formats:
        require_usd()
    if pictures == "daylight":
        require_mitsuba()


def read_places(words: Sequence[str]) -> tuple[str, ...]:
    """The words of an order, those between commas one by one, with those of YAML files in place of the files;
    paths are relative to the file.

    Raises:
        ArtigenError: If a file cannot be read or is not a list of texts, or PyYAML is missing.
    """
    found: list[str] = []
    for word in words:
        path = Path(word)
        if path.suffix not in (".yaml", ".yml"):
            found += [word] if path.is_dir() else [one.strip() for one in word.split(",") if one.strip()]
            continue
        try:
            listed = need("yaml").safe_load(path.read_text())
        except (OSError, ValueError, need("yaml").YAMLError) as error:
            raise ArtigenError(f"{path}: cannot be read ({explain(error)})") from error
        if not isinstance(listed, list) or not all(isinstance(one, str) for one in listed):
            raise ArtigenError(f"{path}: expected a list of units, each a text such as 'sink: 0.8' in quotes")
        found += [str(path.parent / one) if (path.parent / one).is_dir() else one for one in listed]
    return tuple(found)


def check_settings(kind: SceneKind, seed: int, cfg: SceneSettings) -> "list[Role | Unit]":
    """What a room is furnished with, to be drawn.

    Raises:
        ArtigenError: If settings are out of range or contradict each other.
    """
    from artigen.shapes.families import choose_suite
    from envs.flats.furnish import flat_roles, least_door
    from envs.flats.layout import read_rooms
    from envs.rooms.order import Unit, read_order
    from envs.rooms.recipes import DOOR, RECIPES

    if seed < 0 or not (0.0 <= cfg.ajar <= 1.0 and 0.0 <= cfg.contents <= 1.0):
        raise ArtigenError(
            f"seed {seed}, ajar {cfg.ajar}, contents {cfg.contents}: expected a seed from 0 and shares from 0"
            " to 1"
        )
    if cfg.family is not None:
        choose_suite(cfg.family, seed)
    try:
        _populate_config(cfg)
    except ValueError as error:
        raise ArtigenError(str(error)) from error
    if kind == "flat":
        if cfg.width or cfg.depth or cfg.least or cfg.place:
            raise ArtigenError(
                "width, depth, least and place are those of single rooms; of a flat, give rooms and the"
                " radius of the robot"
            )
        door = Unit(role=DOOR, width=round(least_door(cfg.standing_radius) + SPARE, 3))
        return [*flat_roles(read_rooms(cfg.rooms)), door]
    if cfg.rooms:
        raise ArtigenError(f"rooms {' '.join(cfg.rooms)} of a {kind}: only a flat has rooms")
    order = read_order(cfg.place, kind)
    _demand_length(order, RECIPES[kind], cfg)
    return [*dict.fromkeys(order), DOOR] if order else list(RECIPES[kind].all_roles)


def furnish_from(
    kind: SceneKind,
    out: Path,
    seed: int,
    catalogue: "Catalogue",
    cfg: SceneSettings,
    *,
    formats: tuple[SceneFormat, ...],
    pictures: Pictures,
) -> Furnished:
    """Furnishes a room or a flat from packages and writes it; arguments are those of `furnish_room`.

    Raises:
        ArtigenError: If no arrangement is found.
    """
    from envs.flats.flat import join_rooms
    from envs.flats.furnish import FlatConfig, furnish_flat
    from envs.flats.layout import read_rooms
    from envs.flats.picture import write_flat_pictures
    from envs.goals.file import write_goals
    from envs.goals.references import refer, write_references
    from envs.goals.sample import GOALS, sample_goals
    from envs.rooms.file import write_room
    from envs.rooms.mjcf import write_room_mjcf
    from envs.rooms.picture import draw_daylight, draw_view, write_plan, write_view, write_views
    from envs.rooms.populate import populate
    from envs.rooms.usd import write_room_usd

    started = time.perf_counter()
    if kind == "flat":
        wishes = FlatConfig(most=cfg.most, sweeps=cfg.sweeps, standing_radius=cfg.standing_radius)
        flat = furnish_flat(read_rooms(cfg.rooms), seed, catalogue, wishes)
        flat = replace(flat, rooms=tuple(_live_in(room, cfg) for room in flat.rooms))
        room = join_rooms(flat)
    else:
        flat = None
        room = _live_in(populate(kind, seed, catalogue, _populate_config(cfg)), cfg)
    spent = time.perf_counter() - started
    path = write_room(room, out)
    write_goals(sample_goals(room, seed, GOALS), out)
    write_references(refer(room), out)
    if "mjcf" in formats:
        write_room_mjcf(room, out)
    if "usd" in formats:
        write_room_usd(room, out)
    draw = {"all": draw_view, "daylight": draw_daylight}.get(pictures)
    if pictures != "none" and flat is not None:
        write_flat_pictures(flat, room, out, draw)
    elif pictures != "none":
        write_plan(room, out / "plan.png")
    if draw is not None and flat is None:
        write_view(room, out / "room.png")
        write_views(room, out, draw)
    return Furnished(room=room, path=path, failed=tuple(catalogue.failed), seconds=spent)


def _populate_config(cfg: SceneSettings) -> "PopulateConfig":
    from envs.rooms.populate import PopulateConfig

    return PopulateConfig(
        width=cfg.width, depth=cfg.depth, least=cfg.least, most=cfg.most, sweeps=cfg.sweeps,
        standing_radius=cfg.standing_radius, place=cfg.place, wall=cfg.wall,
    )  # fmt: skip


def _live_in(room: "Room", cfg: SceneSettings) -> "Room":
    """The room with open doors and loose things."""
    from envs.rooms.ajar import open_some
    from envs.rooms.clutter import clutter_room
    from envs.rooms.contents import fill_room

    if cfg.ajar > 0.0:
        room = open_some(room, cfg.ajar)
    if cfg.contents > 0.0:
        room = fill_room(room, cfg.contents)
    return clutter_room(room, cfg.clutter) if cfg.clutter != "none" else room


def choose_family(kind: SceneKind, seed: int) -> str:
    """The default family of a room."""
    families = FAMILIES[kind]
    return families[int(np.random.default_rng(seed).integers(len(families)))]


def _demand_length(order: "Sequence[Unit]", recipe: "Recipe", cfg: SceneSettings) -> None:
    """Raises `ArtigenError` if the wall is too short for an order whatever is drawn."""
    from envs.rooms.order import least_length

    across = cfg.wall in ("front", "back")
    length = (cfg.width or recipe.width[1]) if across else (cfg.depth or recipe.depth[1])
    if order and least_length(order) > length:
        raise ArtigenError(
            f"{len(order)} units take at least {least_length(order):.2f} m, and the {cfg.wall} wall of a "
            f"{recipe.kind} is at most {length:g} m long; order less, or give --width or --depth"
        )


def draw_packages(
    wanted: "Sequence[Role | Unit]", seed: int, family: str, out: Path, runner: Runner
) -> "Catalogue":
    """Draws and validates objects for every role or ordered unit, all of one suite of a family.

    Those without a valid object are drawn again.
    """
    from envs.rooms.catalogue import read_catalogue

    look = ShapeSettings(family=family, suite=seed)
    waiting = list(wanted)
    jobs: list[ShapeJob] = []
    catalogue = None
    for attempt in range(ROUNDS):
        added = _jobs(waiting, seed * 1000 + 200 * attempt, look, out)
        jobs += added
        run_with_progress(export_and_validate, added, out, runner=runner)
        catalogue = read_catalogue(out)
        drawn = {job.key for job in jobs}
        # The folder may hold objects of an earlier run; the same seed must give the same room.
        entries = tuple(entry for entry in catalogue.entries if entry.name in drawn)
        failed = tuple(text for text in catalogue.failed if text.split()[0] in drawn)
        catalogue = replace(catalogue, entries=entries, failed=failed)
        waiting = [each for each in waiting if each.draws and not _is_there(catalogue, each)]
        if not waiting:
            break
    assert catalogue is not None
    return catalogue


def _is_there(catalogue: "Catalogue", wanted: "Role | Unit") -> bool:
    from envs.rooms.order import Unit

    if isinstance(wanted, Unit):
        return any(wanted.accepts(entry) for entry in catalogue.of_role(wanted.role))
    return bool(catalogue.of_role(wanted))


def _jobs(roles: "Sequence[Role | Unit]", first: int, look: ShapeSettings, out: Path) -> list[ShapeJob]:
    """One job for every draw of the roles, with the sizes of the roles."""
    jobs = []
    for role in roles:
        for category, (depth, width, height) in role.draws:
            wished = replace(look, depth=depth or None, width=width or None, height=height or None)
            jobs.append(ShapeJob(category=category, seed=first + len(jobs), out=out, cfg=wished))
    return jobs
