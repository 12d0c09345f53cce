"""Furnishes rooms, checks them, and simulates them in MuJoCo and one of them in SAPIEN.

    python benchmarks/rooms.py --packages out/shapes_packages/voxels --count 200 --out out/rooms

Counts violated conditions of every room on its hulls, measures the time per room, lets rooms full of things
stand for two seconds in MuJoCo, and simulates a room with 20 objects for five seconds in SAPIEN. Writes
``rooms.md``.
"""

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false

import json
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np
import tyro
from tqdm import tqdm

from artigen.transforms import transform_points
from artigen.types import RoomKind
from envs.hand import link_vertices, pose_matrix
from envs.rooms.ajar import open_some
from envs.rooms.catalogue import Catalogue, PopulateError, read_catalogue
from envs.rooms.check import check_room
from envs.rooms.contents import fill_room
from envs.rooms.mjcf import HOME, write_room_mjcf
from envs.rooms.populate import PopulateConfig, populate
from envs.rooms.room import Room
from envs.sim.loaded import LoadedPackage, qpos_of
from envs.sim.mujoco import compile_model
from envs.sim.sapien import LoadConfig, load_package
from envs.sim.scene import create_scene

KINDS = get_args(RoomKind)


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    packages: Path
    """Folder of validated packages."""
    out: Path = Path("out/rooms")
    """Folder of the table."""
    count: int = 200
    """Number of rooms, of the three kinds in turn."""
    objects: int = 20
    """Minimum number of objects of the simulated room."""
    mujoco: int = 50
    """Number of rooms that stand in MuJoCo, with some joints open and all compartments full."""
    seconds: float = 5.0
    """Simulated duration (s)."""
    timestep: float = 0.01
    """Time step (s)."""


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One room: problems by kind, objects, rejected attempts, wall and processor seconds."""

    kind: RoomKind
    problems: tuple[str, ...]
    objects: int
    attempts: int
    wall: float
    cpu: float
    error: str = ""


def measure_room(kind: RoomKind, seed: int, catalogue: Catalogue) -> Measured:
    """Furnishes one room and checks it a second time from its poses."""
    wall, cpu = time.perf_counter(), time.process_time()
    try:
        room = populate(kind, seed, catalogue)
    except PopulateError as error:
        spent = time.perf_counter() - wall, time.process_time() - cpu
        return Measured(
            kind=kind, problems=(), objects=0, attempts=0, wall=spent[0], cpu=spent[1], error=str(error)
        )
    spent = time.perf_counter() - wall, time.process_time() - cpu
    return Measured(
        kind=kind,
        problems=tuple(problem.kind for problem in check_room(room)),
        objects=len(room.placements),
        attempts=room.attempt,
        wall=spent[0],
        cpu=spent[1],
    )


def find_full_room(catalogue: Catalogue, objects: int) -> Room:
    """The first room with at least a number of objects."""
    cfg = PopulateConfig(least=objects)
    for seed in range(20):
        for kind in KINDS:
            try:
                return populate(kind, seed, catalogue, cfg)
            except PopulateError:
                continue
    raise PopulateError(f"none of 60 rooms has {objects} objects")


@dataclass(frozen=True, kw_only=True)
class Stood:
    """Result of a simulation: largest motion of a hull corner (m), its object, and speed."""

    room: str
    objects: int
    moved: float
    by: str
    finite: bool
    steps_per_second: float


def stand(room: Room, options: Options, base: str) -> Stood:
    """Simulates a room under gravity in SAPIEN and measures the motion."""
    import sapien

    scene = create_scene(options.timestep)
    for fixture in room.fixtures:
        low, high = np.array(fixture.low), np.array(fixture.high)
        builder = scene.create_actor_builder()
        builder.add_box_collision(half_size=((high - low) / 2.0).tolist())
        builder.set_initial_pose(sapien.Pose(p=((low + high) / 2.0).tolist()))
        builder.build_static(name=fixture.name)
    loaded: dict[str, LoadedPackage] = {}
    for placement in room.placements:
        cfg = LoadConfig(base="free" if base == "free" else "fixed")
        loaded[placement.id] = load_package(scene, placement.package, cfg)
        articulation = loaded[placement.id].articulation
        articulation.set_root_pose(sapien.Pose(p=list(placement.position), q=list(placement.quat)))
        articulation.set_qpos(qpos_of(loaded[placement.id], dict(placement.joints)).astype(np.float32))
    before = {name: corners(entry) for name, entry in loaded.items()}
    moved, by, finite = 0.0, "", True
    steps = round(options.seconds / options.timestep)
    spent = 0.0
    for step in range(steps):
        clock = time.perf_counter()
        scene.step()
        spent += time.perf_counter() - clock
        if step % 10 and step != steps - 1:
            continue
        for name, entry in loaded.items():
            now = corners(entry)
            finite &= bool(np.isfinite(now).all())
            far = float(np.linalg.norm(now - before[name], axis=1).max())
            if far > moved:
                moved, by = far, name
    return Stood(
        room=f"{room.kind} {room.seed}",
        objects=len(room.placements),
        moved=moved,
        by=by,
        finite=finite,
        steps_per_second=steps / spent,
    )


def stand_in_mujoco(room: Room, folder: Path) -> Stood:
    """Simulates a room for two seconds in MuJoCo and measures the motion of its bodies."""
    import mujoco

    model = compile_model(write_room_mjcf(room, folder))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(HOME).id)
    mujoco.mj_forward(model, data)
    before, clock = data.xpos.copy(), time.perf_counter()
    steps = round(2.0 / model.opt.timestep)
    for _ in range(steps):
        mujoco.mj_step(model, data)
    spent = time.perf_counter() - clock
    moved = np.linalg.norm(data.xpos - before, axis=1)
    return Stood(
        room=f"{room.kind} {room.seed}",
        objects=len(room.placements) + len(room.contents),
        moved=float(moved.max()),
        by=model.body(int(moved.argmax())).name,
        finite=bool(np.isfinite(data.qpos).all()),
        steps_per_second=steps / spent,
    )


def stand_all(catalogue: Catalogue, options: Options) -> list[Stood]:
    """The first rooms of all kinds in MuJoCo, with things in them and three in ten joints open."""
    stood = []
    for index in tqdm(range(options.mujoco)):
        try:
            room = populate(KINDS[index % len(KINDS)], index // len(KINDS), catalogue)
        except PopulateError:
            continue  # is counted among the rooms that were not made
        stood.append(stand_in_mujoco(fill_room(open_some(room, 0.3), 1.0), options.out / f"room_{index}"))
    return stood


def corners(entry: LoadedPackage) -> np.ndarray:
    """All hull corners of an object in the world, including those of turning wheels and knobs."""
    parts = [
        transform_points(pose_matrix(link.entity_pose), link_vertices(link))
        for link in entry.articulation.links
    ]
    return np.concatenate(parts)


def describe_mujoco(stood: list[Stood]) -> str:
    """How far things moved in MuJoCo, as Markdown."""
    if not stood:
        return "No room could be made for MuJoCo\n"
    moved = np.array([result.moved for result in stood])
    rates = np.array([result.steps_per_second for result in stood])
    objects = np.array([result.objects for result in stood])
    worst = stood[int(moved.argmax())]
    return (
        f"{len(stood)} rooms for 2 s in MuJoCo: {int((moved < 0.005).sum())} in which nothing moves by 5 mm "
        f"(farthest {1e3 * worst.moved:.1f} mm, {worst.by} in {worst.room}), "
        f"{np.median(objects):.0f} objects and things, {np.median(rates):.0f} steps per second (medians)\n"
    )


def describe(results: list[Measured], stood: dict[str, Stood], catalogue: Catalogue, seconds: float) -> str:
    """The results as Markdown."""
    names = ("overlap", "outside", "sweep", "standing", "unreachable")
    lines = [
        f"{len(catalogue.entries)} validated packages, {len(results)} rooms; seconds are wall / processor.",
        "",
        "| rooms | made | " + " | ".join(names) + " | objects least / median / most | first attempt "
        "| s median | s 95 % | s most |",
        "|---" * (len(names) + 7) + "|",
    ]
    for kind in (*KINDS, "all"):
        own = [result for result in results if kind in (result.kind, "all")]
        if not own:
            continue
        made = [result for result in own if not result.error]
        counts = Counter(problem for result in made for problem in result.problems)
        objects = [result.objects for result in made] or [0]
        times = np.array([[result.wall, result.cpu] for result in own])
        spread = [
            f"{np.quantile(times[:, 0], q):.2f} / {np.quantile(times[:, 1], q):.2f}" for q in (0.5, 0.95, 1)
        ]
        cells = [kind, f"{len(made)} of {len(own)}", *(str(counts[name]) for name in names)]
        cells += [f"{min(objects)} / {int(np.median(objects))} / {max(objects)}"]
        cells += [str(sum(result.attempts == 0 for result in made)), *spread]
        lines.append("| " + " | ".join(cells) + " |")
    slow = sum(result.wall > 2.0 for result in results)
    slow_cpu = sum(result.cpu > 2.0 for result in results)
    lines += [
        "",
        f"Rooms over 2 s: {slow} by the clock, {slow_cpu} by processor time.",
        "",
        f"| {seconds:g} s in SAPIEN | room | objects | farthest move | by | NaN | steps per second |",
        "|---|---|---|---|---|---|---|",
    ]
    for base, result in stood.items():
        lines.append(
            f"| bases {base} | {result.room} | {result.objects} | {1e3 * result.moved:.3f} mm "
            f"| {result.by} | {'no' if result.finite else 'yes'} | {result.steps_per_second:.0f} |"
        )
    errors = Counter(result.error for result in results if result.error)
    lines += ["", *(f"- {error} ({count})" for error, count in errors.items())]
    return "\n".join(lines) + "\n"


def main(options: Options) -> int:
    """Measures, prints and writes the table; returns 1 if a condition is violated."""
    catalogue = read_catalogue(options.packages)
    jobs = [(KINDS[index % len(KINDS)], index // len(KINDS)) for index in range(options.count)]
    results = [measure_room(kind, seed, catalogue) for kind, seed in tqdm(jobs)]
    stood = {}
    if options.objects:
        room = find_full_room(catalogue, options.objects)
        stood = {base: stand(room, options, base) for base in ("fixed", "free")}
    text = describe(results, stood, catalogue, options.seconds)
    if options.mujoco:
        text += describe_mujoco(stand_all(catalogue, options))
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "rooms.md").write_text(text)
    rows = [result.__dict__ for result in results]
    (options.out / "rooms.json").write_text(json.dumps(rows, indent=1) + "\n")
    print(text)
    return int(any(result.problems or result.error for result in results))


if __name__ == "__main__":
    raise SystemExit(main(tyro.cli(Options)))
