"""Furnishes scenes as `artigen scenes` does, checks them again, and opens every door and drawer in engines.

    python benchmarks/rooms.py --packages out/packages --count 200 --out out/rooms

Each scene is furnished, read from its file and checked on its hulls; then it stands for two seconds in
ArtiGen-Room-v1 (SAPIEN), and every fourth in MuJoCo, where nothing may move, and all doors and drawers are
pushed, those at once whose sweeps do not meet, with forces that a hand has. A joint is open at 95 % of its
range. ``scenes.jsonl`` has a line per scene and step, and what it has is not measured again; ``rooms.md`` is
the summary.
"""

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false

import json
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, Protocol, get_args

import numpy as np
import tyro
from jaxtyping import Float
from tqdm import tqdm

from artigen.api.scene import SceneSettings, furnish_from
from artigen.errors import ArtigenError
from artigen.types import Joint, SceneKind
from envs.rooms.catalogue import Catalogue, read_catalogue
from envs.rooms.check import check_room
from envs.rooms.file import read_room
from envs.rooms.footprints import cached_package
from envs.rooms.mjcf import MJCF_FILE, home_position
from envs.rooms.room import Room, pose_matrix_of
from envs.rooms.sweeps import opening_joints, sweep_boxes, sweep_joint
from sim_export.geometry.triangles import bounds_of
from sim_export.motion.kinematics import required_openings
from sim_export.package import SimPackage

Push = tuple[str, Joint]
"""Id of an object, and one of its joints."""
REST, PUSH = 2.0, 4.0
"""Seconds at rest, and for which a joint is pushed."""
OPEN = 0.95
"""Share of a range from which on a joint is open."""
STILL = 0.005
"""Motion (m) of a body from which on it has moved."""
FORCE, TORQUE = 100.0, 30.0
"""Largest force (N) and torque (N m) of a push."""
SPEED, GROWS = 0.8, 0.8
"""Share of its range that a joint opens in a second, and seconds in which a push grows to its largest."""
CROWD = 0.02
"""Distance (m) of two sweeps from which on they do not meet."""
LINES, PAGE = "scenes.jsonl", "rooms.md"


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    packages: Path
    """Folder of validated packages."""
    out: Path = Path("out/rooms")
    """Folder of scenes and results; what is in it is kept."""
    kinds: tuple[SceneKind, ...] = get_args(SceneKind)
    """Kinds of scenes, in turn."""
    count: int = 200
    """Number of scenes."""
    seed: int = 0
    """Seed of the first scene of each kind."""
    mujoco_every: int = 4
    """MuJoCo opens the first of so many scenes; 0 for none."""
    contents: float = 0.3
    """Share of compartments that hold things."""


class Engine(Protocol):
    """A scene in an engine. Joints are named by the id of their object and their own name."""

    timestep: float

    def reset(self, coordinates: Mapping[tuple[str, str], float], *, sleep: bool = True) -> None:
        """Everything at its place in the scene, some independent joints elsewhere, without speed; without
        ``sleep``, MuJoCo also steps what rests."""
        ...

    def step(self, efforts: Mapping[tuple[str, str], float]) -> None:
        """One step with efforts (N or N m) on joints."""
        ...

    def coordinate(self, name: tuple[str, str]) -> float:
        """Coordinate of a joint."""
        ...

    def bodies(self) -> dict[str, Float[np.ndarray, "3"]]:
        """Positions of all bodies."""
        ...

    def close(self) -> None:
        """Frees the engine."""
        ...


def _moved(room: Room, coordinates: Mapping[tuple[str, str], float]) -> Room:
    """The room with some joints elsewhere."""
    placements = []
    for placement in room.placements:
        own = {joint: q for (name, joint), q in coordinates.items() if name == placement.id}
        placements.append(replace(placement, joints=tuple((dict(placement.joints) | own).items())))
    return replace(room, placements=tuple(placements))


class MujocoScene:
    """The ``scene.xml`` of a folder in MuJoCo."""

    def __init__(self, folder: Path) -> None:
        import mujoco

        self.room = read_room(folder)
        self.model = mujoco.MjModel.from_xml_path(str(folder / MJCF_FILE))
        self.data, self.timestep = mujoco.MjData(self.model), float(self.model.opt.timestep)

    def reset(self, coordinates: Mapping[tuple[str, str], float], *, sleep: bool = True) -> None:
        import mujoco

        self.model.opt.enableflags = int(mujoco.mjtEnableBit.mjENBL_SLEEP) if sleep else 0
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = home_position(_moved(self.room, coordinates), self.model)
        mujoco.mj_forward(self.model, self.data)

    def step(self, efforts: Mapping[tuple[str, str], float]) -> None:
        import mujoco

        self.data.qfrc_applied[:] = 0.0
        for (name, joint), effort in efforts.items():
            self.data.joint(f"{name}/{joint}").qfrc_applied[0] = effort
        mujoco.mj_step(self.model, self.data)

    def coordinate(self, name: tuple[str, str]) -> float:
        return float(self.data.joint("/".join(name)).qpos[0])

    def bodies(self) -> dict[str, Float[np.ndarray, "3"]]:
        return {
            self.model.body(index).name: self.data.xpos[index].copy() for index in range(1, self.model.nbody)
        }

    def close(self) -> None:
        del self.model, self.data


class SapienScene:
    """ArtiGen-Room-v1 with the scene of a folder, its robot away."""

    def __init__(self, folder: Path) -> None:
        import gymnasium as gym

        import envs  # noqa: F401 (registers the task)
        from envs.maniskill.scene import AWAY

        self.env: Any = gym.make(
            "ArtiGen-Room-v1", scenes=folder, robot_uids="panda", sim_backend="physx_cpu",
            render_backend="none", obs_mode="state", reward_mode="none",
        )  # fmt: skip
        self.env.reset(seed=0)
        task = self.env.unwrapped
        task.agent.robot.set_pose(AWAY)
        self.scene, self.furnished, self.timestep = task.scene, task.furnished, 1.0 / task.sim_freq
        self.room = self.furnished.rooms[0]
        self.objects = {name: one._objs[0] for name, one in self.furnished.placed[0].items()}
        self.items = {name: one._objs[0] for name, one in self.furnished.contents[0].items()}
        names = {name: one.active_joints for name, one in self.furnished.placed[0].items()}
        self.columns = {
            (name, joint.name): column
            for name, joints in names.items()
            for column, joint in enumerate(joints)
        }

    def reset(self, coordinates: Mapping[tuple[str, str], float], *, sleep: bool = True) -> None:
        import torch

        self.furnished.rooms[0] = _moved(self.room, coordinates)
        self.furnished.initialize(torch.tensor([0]))
        for one in self.objects.values():
            one.set_qf(np.zeros_like(one.qpos))

    def step(self, efforts: Mapping[tuple[str, str], float]) -> None:
        pushes = {name: np.zeros_like(self.objects[name].qpos) for name, _ in efforts}
        for (name, joint), effort in efforts.items():
            pushes[name][self.columns[name, joint]] = effort
        for name, efforts_of in pushes.items():
            self.objects[name].set_qf(efforts_of)
        self.scene.step()

    def coordinate(self, name: tuple[str, str]) -> float:
        return float(self.objects[name[0]].qpos[self.columns[name]])

    def bodies(self) -> dict[str, Float[np.ndarray, "3"]]:
        found = {
            f"{name}/{link.name}": np.array(link.entity_pose.p)
            for name, one in self.objects.items()
            for link in one.links
        }
        return found | {name: np.array(entity.pose.p) for name, entity in self.items.items()}

    def close(self) -> None:
        self.env.close()


ENGINES = {"sapien": SapienScene, "mujoco": MujocoScene}


@dataclass(frozen=True, kw_only=True)
class Line:
    """One step of one scene. ``made``: problems of the second check, objects, things and seconds. An engine:
    what moved at rest (m), joints pushed and those that stayed shut."""

    scene: str
    step: str
    error: str = ""
    problems: tuple[str, ...] = ()
    objects: int = 0
    things: int = 0
    seconds: float = 0.0
    moved: float = 0.0
    by: str = ""
    pushed: int = 0
    shut: tuple[str, ...] = ()
    steps_per_second: float = 0.0


@cache
def _library(folder: Path) -> Catalogue:
    return read_catalogue(folder)


def make(kind: SceneKind, seed: int, folder: Path, options: Options) -> Line:
    """Furnishes and writes a scene, and checks it a second time from its file."""
    cfg = SceneSettings(clutter="lived", contents=options.contents)
    clock = time.process_time()
    made = furnish_from(
        kind, folder, seed, _library(options.packages), cfg, formats=("mjcf",), pictures="none"
    )
    spent, room = time.process_time() - clock, read_room(made.path)
    problems = tuple(problem.message for problem in check_room(room, open_doors=bool(room.zones)))
    return Line(
        scene=folder.name, step="made", problems=problems, objects=len(room.placements),
        things=len(room.contents), seconds=spent,
    )  # fmt: skip


def list_pushes(room: Room) -> list[list[Push]]:
    """All doors and drawers of a room in groups whose sweeps do not meet, one joint of an object in each."""
    groups: list[tuple[list[Push], list[np.ndarray]]] = []
    for placement in room.placements:
        package = cached_package(placement.package)
        for joint in opening_joints(package):
            if joint.type == "continuous":
                continue
            needed = required_openings(joint, package.joints, package.requires_open)
            rows = [np.zeros((0, 2, 3))]
            for each in (joint, *(other for other in package.joints if other.name in needed)):
                boxes, _ = sweep_boxes(package, sweep_joint(package, each), pose_matrix_of(placement))
                rows.append(boxes.reshape(-1, 2, 3))
            points = np.concatenate(rows).reshape(-1, 3)
            around = (bounds_of(points) if len(points) else np.zeros((2, 3))) + np.array([[-CROWD], [CROWD]])
            for pushes, taken in groups:
                apart = all((around[0] > other[1]).any() or (around[1] < other[0]).any() for other in taken)
                if apart and placement.id not in {name for name, _ in pushes}:
                    pushes.append((placement.id, joint))
                    taken.append(around)
                    break
            else:
                groups.append(([(placement.id, joint)], [around]))
    return [pushes for pushes, _ in groups]


@dataclass(frozen=True, kw_only=True)
class _Hand:
    """Pushes a joint of an object towards a coordinate."""

    name: str
    joint: Joint
    target: float

    def share(self, engine: Engine) -> float:
        """Share of the way to the target."""
        lower = self.joint.lower
        return (engine.coordinate((self.name, self.joint.name)) - lower) / max(self.target - lower, 1e-9)

    def change(self, effort: float, speed: float, timestep: float) -> float:
        """The next force or torque: it grows while the joint is slower than `SPEED`, and falls else."""
        most = FORCE if self.joint.type == "prismatic" else TORQUE
        step = most * timestep / GROWS * (1.0 if speed < SPEED else -2.0)
        return float(np.clip(effort + step, 0.0, most))


def open_group(engine: Engine, pushes: Sequence[Push], packages: Mapping[str, SimPackage]) -> list[str]:
    """Pushes joints at once until all are open, and holds those open that they need; returns those that are
    not after `PUSH` seconds."""
    start: dict[tuple[str, str], float] = {}
    for name, joint in pushes:
        package = packages[name]
        needed = required_openings(joint, package.joints, package.requires_open)
        start |= {(name, other): q for other, q in needed.items()}
    engine.reset(start)
    hands = [_Hand(name=name, joint=joint, target=joint.upper) for name, joint in pushes]
    for (name, other), q in start.items():
        joint = next(joint for joint in packages[name].joints if joint.name == other)
        hands.append(_Hand(name=name, joint=joint, target=q))
    waiting, last, efforts = set(range(len(pushes))), {}, {}
    for _ in range(round(PUSH / engine.timestep)):
        for index, hand in enumerate(hands):
            share = hand.share(engine)
            if index < len(pushes) and share >= OPEN:
                waiting.discard(index)
            speed = (share - last.get(index, share)) / engine.timestep
            key, last[index] = (hand.name, hand.joint.name), share
            efforts[key] = hand.change(efforts.get(key, 0.0), speed, engine.timestep)
        if not waiting:
            break
        engine.step(efforts)
    return [f"{pushes[index][0]}/{pushes[index][1].name} at {last[index]:.2f}" for index in waiting]


def open_all(name: str, folder: Path) -> Line:
    """Rests a scene in an engine and opens everything in it."""
    engine = ENGINES[name](folder)
    try:
        engine.reset({}, sleep=False)  # which would hide what creeps
        before, clock = engine.bodies(), time.perf_counter()
        steps = round(REST / engine.timestep)
        for _ in range(steps):
            engine.step({})
        spent, after = time.perf_counter() - clock, engine.bodies()
        moved = {body: float(np.linalg.norm(after[body] - at)) for body, at in before.items()}
        by = max(moved, key=lambda body: moved[body])
        packages = {placement.id: cached_package(placement.package) for placement in engine.room.placements}
        groups = list_pushes(engine.room)
        shut = [text for pushes in groups for text in open_group(engine, pushes, packages)]
    finally:
        engine.close()
    return Line(
        scene=folder.name, step=name, moved=moved[by], by=by, pushed=sum(map(len, groups)), shut=tuple(shut),
        steps_per_second=steps / spent,
    )  # fmt: skip


def describe(lines: Sequence[Line], packages: int) -> str:
    """The results as Markdown."""
    text = [f"{packages} validated packages.", "", "| kind | made | without a problem | objects | things "]
    text[-1] += "| s of a core: median / most |"
    text.append("|---" * 6 + "|")
    made = [line for line in lines if line.step == "made"]
    for kind in sorted({line.scene.rpartition("_")[0] for line in made}):
        own = [line for line in made if line.scene.rpartition("_")[0] == kind]
        good = [line for line in own if not line.error] or [Line(scene="", step="")]
        objects, things, seconds = (
            np.median([getattr(line, name) for line in good]) for name in ("objects", "things", "seconds")
        )
        text.append(
            f"| {kind} | {sum(not line.error for line in own)} of {len(own)} "
            f"| {sum(not line.problems for line in own if not line.error)} | {objects:.0f} | {things:.0f} "
            f"| {seconds:.1f} / {max(line.seconds for line in good):.1f} |"
        )
    text += [
        "",
        "| engine | scenes | still | doors and drawers | open | steps per second |",
        "|---" * 6 + "|",
    ]
    for engine in ENGINES:
        own = [line for line in lines if line.step == engine and not line.error]
        if own:
            pushed, shut = sum(line.pushed for line in own), sum(len(line.shut) for line in own)
            rate = np.median([line.steps_per_second for line in own])
            still = sum(line.moved < STILL for line in own)
            text.append(f"| {engine} | {len(own)} | {still} | {pushed} | {pushed - shut} | {rate:.0f} |")
    faults = [f"{line.scene} {line.step}: {line.error or '; '.join(line.problems)}" for line in lines]
    faults = [fault for fault, line in zip(faults, lines, strict=True) if line.error or line.problems]
    faults += [f"{line.scene} {line.step}: shut {', '.join(line.shut)}" for line in lines if line.shut]
    faults += [
        f"{line.scene} {line.step}: {line.by} moved {1e3 * line.moved:.1f} mm"
        for line in lines
        if line.moved >= STILL
    ]
    return (
        "\n".join([*text, "", *(f"- {fault} ({count})" for fault, count in Counter(faults).items())]) + "\n"
    )


def main(options: Options) -> int:
    """Measures what is missing; returns 1 if anything failed, moved or stayed shut."""
    options.out.mkdir(parents=True, exist_ok=True)
    journal = options.out / LINES
    known = journal.read_text().splitlines() if journal.is_file() else []
    lines = {(line.scene, line.step): line for line in (Line(**json.loads(text)) for text in known)}

    def measure(scene: str, step: str, call: Any, *args: Any) -> Line:
        if (scene, step) not in lines:
            try:
                line = call(*args)
            except ArtigenError as error:
                line = Line(scene=scene, step=step, error=str(error))
            lines[scene, step] = line
            with journal.open("a") as file:
                file.write(json.dumps(asdict(line)) + "\n")
        return lines[scene, step]

    for index in tqdm(range(options.count)):
        kind, seed = options.kinds[index % len(options.kinds)], options.seed + index // len(options.kinds)
        folder = options.out / f"{kind}_{seed}"
        if measure(folder.name, "made", make, kind, seed, folder, options).error:
            continue
        measure(folder.name, "sapien", open_all, "sapien", folder)
        if options.mujoco_every and index % options.mujoco_every == 0:
            measure(folder.name, "mujoco", open_all, "mujoco", folder)
        text = describe(list(lines.values()), len(_library(options.packages).entries))
        (options.out / PAGE).write_text(text)
    text = describe(list(lines.values()), len(_library(options.packages).entries))
    (options.out / PAGE).write_text(text)
    print(text)
    bad = (line.error or line.problems or line.shut or line.moved >= STILL for line in lines.values())
    return int(any(bad))


if __name__ == "__main__":
    raise SystemExit(main(tyro.cli(Options)))
