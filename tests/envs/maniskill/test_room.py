"""A furnished room in ManiSkill without a renderer: everything is there, in place, and stays there."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from project import ROOT
from sample_packages import SAMPLE_PARTS, build_package

import envs
from envs.rooms.file import write_room
from envs.rooms.footprints import read_footprint
from envs.rooms.room import Opening, Placement, Room, room_shell
from sim_export.files.write import write_package

pytest.importorskip("mani_skill")
pytestmark = pytest.mark.sim

SIZE = (4.0, 3.5, 2.6)
OPENED = 0.2


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Two rooms with three and with two of the sample cabinet, one drawer of the first open."""
    base = tmp_path_factory.mktemp("rooms")
    package = build_package(SAMPLE_PARTS)
    cabinet = write_package(package, base / "cabinet").resolve()
    body = read_footprint(cabinet).body
    entrance = Opening(side="front", start=1.5, width=0.9, height=2.0)
    rooms = []
    for count in (3, 2):
        placements = [
            Placement(
                id=f"cabinet_{index}", role="base cabinet", category="StorageFurniture", package=cabinet,
                position=(0.6 + 1.2 * index, SIZE[1] - 0.5, float(-body[0, 2]) + 0.002),
                quat=(0.5**0.5, 0.0, 0.0, 0.5**0.5), size=(0.5, 0.5, 0.5),
                joints=(("joint_0", OPENED),) if index == 1 else (),
            )
            for index in range(count)
        ]  # fmt: skip
        room = Room(
            kind="kitchen", seed=count, attempt=0, size=SIZE, entrance=entrance, standing_radius=0.3,
            fixtures=room_shell(SIZE, (entrance,), (0.9, 0.9, 0.9)), placements=tuple(placements),
        )  # fmt: skip
        rooms.append(write_room(room, base / f"room_{count}"))
    return rooms


def make(scenes: list[Path] | Path, **kwargs: Any) -> gym.Env:
    settings: dict[str, Any] = {"sim_backend": "physx_cpu", "render_backend": "none", "reward_mode": "none"}
    return gym.make("ArtiGen-Room-v1", scenes=scenes, obs_mode="state", **settings, **kwargs)


def room_of(env: gym.Env) -> Any:
    """The environment inside its wrappers, whose attributes gymnasium's types do not know."""
    return env.unwrapped


def test_registering_loads_no_simulator():
    assert "ArtiGen-Room-v1" in gym.registry
    assert envs.__doc__
    heavy = {"mani_skill", "sapien", "torch"}
    code = f"import sys, envs.rooms.populate; print(*({heavy} & set(sys.modules)))"
    root = ROOT
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize("robot", ["fetch", "panda"])
def test_objects_are_in_place_and_stay_there(scenes, robot):
    env = make(scenes[0], robot_uids=robot)
    env.reset(seed=3)
    built = room_of(env).furnished.placed[0]
    room = room_of(env).furnished.rooms[0]
    assert list(built) == ["cabinet_0", "cabinet_1", "cabinet_2"]
    for placement in room.placements:
        pose = built[placement.id].pose.raw_pose[0].numpy()
        assert np.allclose(pose, [*placement.position, *placement.quat], atol=1e-5)
    names = [joint.name for joint in built["cabinet_1"].active_joints]
    before = {name: articulation.get_qpos().clone() for name, articulation in built.items()}
    assert float(before["cabinet_1"][0, names.index("joint_0")]) == pytest.approx(OPENED, abs=1e-6)
    env.action_space.seed(0)
    for _ in range(20):
        obs, *_ = env.step(env.action_space.sample())
        assert torch.isfinite(obs).all()
    moved = max(float((built[name].get_qpos() - before[name]).abs().max()) for name in built)
    assert moved < 0.005
    robot_at = room_of(env).agent.robot.links[-1].pose.p[0].numpy()
    assert 0.0 < robot_at[0] < SIZE[0]
    assert 0.0 < robot_at[1] < SIZE[1]
    env.close()


def test_a_seed_decides_the_room_and_everything_in_it(scenes):
    runs = []
    for _ in range(2):
        env = make(scenes)
        seen = []
        for seed in (1, 2, 3, 4):
            obs, _ = env.reset(seed=seed)
            env.action_space.seed(seed)
            for _ in range(3):
                obs, *_ = env.step(env.action_space.sample())
            seen.append((room_of(env).furnished.rooms[0].seed, obs.clone()))
        env.close()
        runs.append(seen)
    assert {number for number, _ in runs[0]} == {2, 3}
    for (first, one), (second, other) in zip(*runs, strict=True):
        assert first == second
        assert torch.equal(one, other)


def test_a_state_can_be_put_back(scenes):
    env = make(scenes[0])
    env.reset(seed=0)
    task = room_of(env)
    state, before = task.get_state_dict(), task.furnished.placed[0]["cabinet_1"].get_qpos().clone()
    assert sum("cabinet" in name for name in state["articulations"]) == 3
    task.furnished.placed[0]["cabinet_1"].set_qpos(before * 0.5)
    task.set_state_dict(state)
    assert torch.equal(task.furnished.placed[0]["cabinet_1"].get_qpos(), before)
    env.close()


def test_wrong_arguments_are_refused(scenes):
    with pytest.raises(ValueError, match="expected fetch or panda"):
        make(scenes[0], robot_uids="xarm6")
    with pytest.raises(ValueError, match="empty list"):
        make([])


def test_the_builder_is_registered_by_name():
    from mani_skill.utils.scene_builder.registration import REGISTERED_SCENE_BUILDERS

    import envs.maniskill.scene as module

    spec = REGISTERED_SCENE_BUILDERS["ArtiGenRoom"]
    assert spec.scene_builder_cls is module.RoomSceneBuilder
