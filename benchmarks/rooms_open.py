"""Opens every door and drawer of rooms in MuJoCo and SAPIEN, after two seconds in which nothing may move.

    python benchmarks/rooms_open.py --packages out/packages --kinds kitchen office --seeds 3

Joints whose sweeps do not meet are pushed at once, with forces that a hand has. A joint is open at 95 % of
its range. Writes ``open.md``.
"""

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
import tyro
from jaxtyping import Float
from tqdm import tqdm

from artigen.types import Joint, RoomKind
from envs.rooms.catalogue import PopulateError, read_catalogue
from envs.rooms.clutter import clutter_room
from envs.rooms.footprints import cached_package
from envs.rooms.mjcf import home_position, write_room_mjcf
from envs.rooms.populate import populate
from envs.rooms.room import Room, pose_matrix_of
from envs.rooms.solids import fixture_shape, item_motion
from envs.rooms.sweeps import opening_joints, sweep_boxes, sweep_joint
from envs.rooms.things import thing_solids
from envs.sim.loaded import LoadedPackage, qpos_of
from envs.sim.mujoco import compile_model
from envs.sim.sapien import LoadConfig, load_package
from envs.sim.scene import create_scene
from sim_export.geometry.triangles import bounds_of
from sim_export.motion.kinematics import required_openings
from sim_export.package import SimPackage

EngineName = Literal["mujoco", "sapien"]
Push = tuple[str, Joint]
"""Id of an object, and one of its joints."""
REST, PUSH = 2.0, 4.0
"""Seconds at rest, and for which a joint is pushed."""
OPEN = 0.95
"""Share of a range from which on a joint is open."""
STILL = 0.005
"""Motion (m) of a body from which on it has moved."""
FORCE, TORQUE = 80.0, 30.0
"""Largest force (N) and torque (N m) of a push."""
SPEED, GROWS = 0.8, 0.8
"""Share of its range that a joint opens in a second, and seconds in which a push grows to its largest."""


class Engine(Protocol):
    """A room in an engine. Joints are named by the id of their object and their own name."""

    timestep: float

    def reset(self, coordinates: Mapping[tuple[str, str], float]) -> None:
        """Everything at its place in the room, some independent joints elsewhere, without speed."""
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


class MujocoRoom:
    """A room in MuJoCo."""

    def __init__(self, room: Room, folder: Path) -> None:
        import mujoco

        self.room, self.model = room, compile_model(write_room_mjcf(room, folder))
        self.data, self.timestep = mujoco.MjData(self.model), float(self.model.opt.timestep)

    def reset(self, coordinates: Mapping[tuple[str, str], float]) -> None:
        import mujoco

        placements = []
        for placement in self.room.placements:
            own = {joint: q for (name, joint), q in coordinates.items() if name == placement.id}
            placements.append((placement, own))
        mujoco.mj_resetData(self.model, self.data)
        moved = tuple(
            replace(placement, joints=tuple((dict(placement.joints) | own).items()))
            for placement, own in placements
        )
        self.data.qpos[:] = home_position(replace(self.room, placements=moved), self.model)
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


class SapienRoom:
    """A room in SAPIEN, without visuals."""

    timestep = 0.005

    def __init__(self, room: Room, folder: Path) -> None:
        import sapien

        self.room, self.scene = room, create_scene(self.timestep)
        surface = sapien.physx.PhysxMaterial(static_friction=1.0, dynamic_friction=1.0, restitution=0.0)
        along_z = sapien.Pose(np.array([[0.0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]))

        def add(builder, solid, **more) -> None:
            pose = sapien.Pose(solid.T_object_shape)
            if solid.kind == "box":
                builder.add_box_collision(
                    pose=pose, half_size=[e / 2 for e in solid.sizes], material=surface, **more
                )
            else:
                radius, length = solid.sizes
                builder.add_cylinder_collision(
                    pose=pose * along_z, radius=radius, half_length=length / 2, material=surface, **more
                )

        for fixture in room.fixtures:
            builder = self.scene.create_actor_builder()
            add(builder, fixture_shape(fixture))
            builder.build_static(name=fixture.name)
        self.loaded: dict[str, LoadedPackage] = {}
        for placement in room.placements:
            one = load_package(self.scene, placement.package, LoadConfig())
            one.articulation.set_root_pose(sapien.Pose(p=list(placement.position), q=list(placement.quat)))
            self.loaded[placement.id] = one
        self.items, self.starts = {}, {}
        for item in room.contents:
            builder = self.scene.create_actor_builder()
            solids = thing_solids(item.thing, item.size)
            density = item.mass / sum(solid.volume for solid, _ in solids)
            for solid, _ in solids:
                add(builder, solid, density=density)
            self.starts[item.id] = sapien.Pose(item_motion(room, item) @ pose_matrix_of(item))
            builder.set_initial_pose(self.starts[item.id])
            self.items[item.id] = builder.build(name=item.id)

    def reset(self, coordinates: Mapping[tuple[str, str], float]) -> None:
        import sapien

        for placement in self.room.placements:
            one = self.loaded[placement.id]
            own = {joint: q for (name, joint), q in coordinates.items() if name == placement.id}
            q = qpos_of(one, dict(placement.joints) | own).astype(np.float32)
            one.articulation.set_qpos(q)
            one.articulation.set_qvel(np.zeros_like(q))
            one.articulation.set_qf(np.zeros_like(q))
        for name, entity in self.items.items():
            entity.set_pose(self.starts[name])
            body = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
            body.set_linear_velocity(np.zeros(3))
            body.set_angular_velocity(np.zeros(3))

    def step(self, efforts: Mapping[tuple[str, str], float]) -> None:
        pushed = {name for name, _ in efforts}
        for name in pushed:
            articulation = self.loaded[name].articulation
            values = [efforts.get((name, joint.name), 0.0) for joint in articulation.active_joints]
            articulation.set_qf(np.array(values, dtype=np.float32))
        self.scene.step()

    def coordinate(self, name: tuple[str, str]) -> float:
        return self.loaded[name[0]].positions()[name[1]]

    def bodies(self) -> dict[str, Float[np.ndarray, "3"]]:
        found = {
            f"{name}/{link.name}": np.array(link.entity_pose.p)
            for name, one in self.loaded.items()
            for link in one.articulation.links
        }
        return found | {name: np.array(entity.pose.p) for name, entity in self.items.items()}


ENGINES = {"mujoco": MujocoRoom, "sapien": SapienRoom}


@dataclass(frozen=True, kw_only=True)
class Result:
    """One room in one engine: what moved at rest (m), and which joints were pushed and did not open."""

    engine: EngineName
    room: str
    bodies: int
    moved: float
    by: str
    pushed: int
    shut: tuple[str, ...] = field(default=())
    steps_per_second: float = 0.0


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
            around = (bounds_of(points) if len(points) else np.zeros((2, 3))) + np.array([[-0.02], [0.02]])
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


def measure(engine_name: EngineName, room: Room, folder: Path) -> Result:
    """Rests and opens one room in one engine."""
    engine = ENGINES[engine_name](room, folder)
    engine.reset({})
    before, clock = engine.bodies(), time.perf_counter()
    steps = round(REST / engine.timestep)
    for _ in range(steps):
        engine.step({})
    spent, after = time.perf_counter() - clock, engine.bodies()
    moved = {name: float(np.linalg.norm(after[name] - at)) for name, at in before.items()}
    by = max(moved, key=lambda name: moved[name])
    packages = {placement.id: cached_package(placement.package) for placement in room.placements}
    groups = list_pushes(room)
    shut = [text for pushes in groups for text in open_group(engine, pushes, packages)]
    return Result(
        engine=engine_name, room=f"{room.kind} {room.seed}", bodies=len(before), moved=moved[by], by=by,
        pushed=sum(map(len, groups)), shut=tuple(shut), steps_per_second=steps / spent,
    )  # fmt: skip


def describe(results: Sequence[Result]) -> str:
    """The results as Markdown."""
    lines = [
        "| engine | rooms | at rest | doors and drawers | open | steps per second |",
        "|---|---|---|---|---|---|",
    ]
    for name in ENGINES:
        own = [result for result in results if result.engine == name]
        if own:
            rest = sum(result.moved < STILL for result in own)
            pushed, shut = sum(result.pushed for result in own), sum(len(result.shut) for result in own)
            rate = np.median([result.steps_per_second for result in own])
            lines.append(f"| {name} | {len(own)} | {rest} | {pushed} | {pushed - shut} | {rate:.0f} |")
    lines += [
        "",
        "| room | engine | bodies | farthest move | by | pushed | not open |",
        "|---|---|---|---|---|---|---|",
    ]
    for one in results:
        shut = ", ".join(one.shut) or "-"
        far = f"{1e3 * one.moved:.2f} mm | {one.by}"
        lines.append(f"| {one.room} | {one.engine} | {one.bodies} | {far} | {one.pushed} | {shut} |")
    return "\n".join(lines) + "\n"


def main(
    packages: Path,
    out: Path = Path("out/rooms_open"),
    kinds: tuple[RoomKind, ...] = ("kitchen", "office", "bedroom", "living_room"),
    seeds: int = 3,
    engines: tuple[EngineName, ...] = ("mujoco", "sapien"),
) -> int:
    """Writes ``open.md``; returns 1 if anything moved or stayed shut."""
    catalogue, results = read_catalogue(packages), []
    jobs: list[tuple[RoomKind, int]] = [(kind, seed) for seed in range(seeds) for kind in kinds]
    for kind, seed in tqdm(jobs):
        try:
            room = clutter_room(populate(kind, seed, catalogue), "lived")
        except PopulateError as error:
            print(f"{kind} {seed}: {error}")
            continue
        for engine in engines:
            results.append(measure(engine, room, out / f"{kind}_{seed}"))
            (out / "open.md").write_text(describe(results))
    print(describe(results))
    return int(any(result.shut or result.moved >= STILL for result in results))


if __name__ == "__main__":
    raise SystemExit(tyro.cli(main))
