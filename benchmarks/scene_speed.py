"""Steps a second of scenes in MuJoCo beside those of scenes as robosuite builds them, in one process.

    pip download robosuite --no-deps && unzip robosuite-*.whl 'robosuite/models/assets/*' -d out
    python benchmarks/scene_speed.py --scenes out/scenes/kitchen_0 --assets out/robosuite/models/assets

The other scene stands for RoboCasa, whose wheel has no meshes: robosuite's empty arena with as
many free bodies (its objects of meshes in turn, resting apart on the floor), as many hinges (its door, one
each) and as many colliding geoms, the rest of which are boxes that stand apart, as fixtures do. Both scenes
rest, with MuJoCo's default solver, the same timestep and no robot; rounds alternate. Ours sleeps as its file
says, and is also measured awake, as robosuite's is.
"""

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import tyro

from envs.rooms.mjcf import MJCF_FILE

OBJECTS = ("bottle", "bread", "can", "cereal", "lemon", "milk")

APART = 0.7
"""Distance (m) of bodies of the other scene."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    scenes: tuple[Path, ...]
    """Folders of scenes with ``scene.xml``."""
    assets: Path
    """Folder ``robosuite/models/assets`` of robosuite's wheel."""
    seconds: float = 1.0
    """Simulated seconds of a round."""
    rounds: int = 3
    """Number of rounds; the best counts."""


def count(model: Any) -> tuple[int, int, int]:
    """Colliding geoms, free bodies, and other joints."""
    free = int((model.jnt_type == mujoco.mjtJoint.mjJNT_FREE).sum())
    return int((model.geom_contype | model.geom_conaffinity).astype(bool).sum()), free, model.njnt - free


def build_other(assets: Path, geoms: int, free: int, joints: int) -> Any:
    """A scene of robosuite's assets with as many colliding geoms, free bodies and hinges."""
    spec = mujoco.MjSpec.from_file(str(assets / "arenas" / "empty_arena.xml"))
    doors = joints
    loose = [OBJECTS[index % len(OBJECTS)] for index in range(free)]
    across = int(np.ceil(np.sqrt(geoms)))
    spots = (APART * np.array([index % across - across / 2, index // across]) for index in range(2 * geoms))

    def add(name: str, index: int, height: float) -> Any:
        child = mujoco.MjSpec.from_file(str(assets / "objects" / f"{name}.xml"))
        frame = spec.worldbody.add_frame(pos=[*next(spots), height])
        return frame.attach_body(child.worldbody.bodies[0].bodies[0], f"{name}_{index}_", "")

    for index, name in enumerate(loose):
        add(name, index, 0.12).add_freejoint()
    for index in range(doors):
        add("door", index, 0.35)
    boxes = geoms - count(spec.compile())[0]
    for _ in range(boxes):
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.2, 0.2, 0.4], pos=[*next(spots), 0.41]
        )
    return spec.compile()


def rate(model: Any, seconds: float, flags: int) -> float:
    """Steps a second after as long at rest, with flags that are enabled."""
    model.opt.enableflags = flags
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    steps = round(seconds / model.opt.timestep)
    for _ in range(steps):
        mujoco.mj_step(model, data)
    clock = time.perf_counter()
    for _ in range(steps):
        mujoco.mj_step(model, data)
    return steps / (time.perf_counter() - clock)


def main(options: Options) -> None:
    """Prints a table of both rates."""
    print(
        "| scene | geoms | free bodies | joints | steps/s | awake | robosuite's: geoms | joints | steps/s "
        "| ratio | awake |"
    )
    print("|---" * 11 + "|")
    for folder in options.scenes:
        ours = mujoco.MjModel.from_xml_path(str(folder / MJCF_FILE))
        geoms, free, joints = count(ours)
        other = build_other(options.assets, geoms, free, joints)
        other.opt.timestep = ours.opt.timestep
        flags = int(ours.opt.enableflags)
        runs = ((ours, flags), (ours, 0), (other, 0))
        rates = np.array(
            [[rate(model, options.seconds, own) for model, own in runs] for _ in range(options.rounds)]
        ).max(axis=0)
        others, _, hinges = count(other)
        print(
            f"| {folder.name} | {geoms} | {free} | {joints} | {rates[0]:.0f} | {rates[1]:.0f} | {others} "
            f"| {hinges} | {rates[2]:.0f} | {rates[0] / rates[2]:.2f} | {rates[1] / rates[2]:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main(tyro.cli(Options))
