"""Records demonstrations of the scripted solvers in ManiSkill's trajectory format (HDF5 and JSON)."""

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import gymnasium as gym
from mani_skill.utils.wrappers.record import RecordEpisode

from artigen.io import write_whole

from ..objects import TaskError
from .solve import Outcome

TRAJECTORIES, DESCRIPTION = "demonstrations.h5", "demonstrations.json"


def record_episodes(
    env: gym.Env,
    solver: Callable[..., Outcome],
    seeds: Iterable[int],
    out: Path,
    objects: Sequence[str] = (),
) -> tuple[Outcome, ...]:
    """Plays one episode per seed and stores the successful ones.

    The JSON holds for every episode, besides what ManiSkill writes, ``task`` (in words), ``object``,
    ``package`` (its folder, relative to ``packages`` if it lies in there) and ``joint``, and for all of them
    ``control_freq`` (Hz) and the names of the robot's ``joints``. The environment's id is preceded by the
    module that registers it, so that ManiSkill's own commands find it.

    Args:
        env: A task with the control mode ``pd_joint_pos``; it is closed at the end.
        solver: `solve_open_part` or `solve_put_inside`.
        seeds: Seeds of the episodes.
        out: Folder for ``demonstrations.h5`` and ``demonstrations.json``; created if missing.
        objects: Names of the objects, taken in turn by the seeds: object ``seed % len(objects)``; default:
            sampled by the seeds.

    Returns:
        One outcome per seed, including failures and objects that the task cannot use.
    """
    recorder = RecordEpisode(
        env,  # type: ignore[arg-type]
        output_dir=str(out),
        save_video=False,
        save_on_reset=False,
        trajectory_name=Path(TRAJECTORIES).stem,
        source_type="motionplanning",
        source_desc="artigen's scripted solver: inverse kinematics along the joint's path",
    )
    task: Any = env.unwrapped
    outcomes, told = [], []
    for seed in seeds:
        try:
            outcome = solver(recorder, seed, objects[seed % len(objects)] if objects else None)
        except TaskError as error:
            outcomes.append(Outcome(success=False, steps=0, open_fraction=0.0, reason=str(error)))
            continue
        recorder.flush_trajectory(save=outcome.success)
        outcomes.append(outcome)
        if outcome.success:
            told.append(_tell(task, env))
    more = {
        "control_freq": task.control_freq,
        "joints": [joint.name for joint in task.agent.robot.active_joints],
    }
    recorder.close()
    path = out / DESCRIPTION
    if told:
        written = json.loads(path.read_text())
        written |= more
        written["env_info"]["env_id"] = f"envs:{written['env_info']['env_id']}"
        for episode, about in zip(written["episodes"], told, strict=True):
            episode |= about
        write_whole(path, json.dumps(written, indent=2))
    return tuple(outcomes)


def _tell(task: Any, env: gym.Env) -> dict[str, str]:
    """What an episode was about."""
    entry, part = task.drawn[0]
    folder, given = entry.folder.resolve(), (env.spec.kwargs if env.spec else {}).get("packages")
    top = Path(given).resolve() if isinstance(given, str | Path) else None
    inside = top is not None and folder != top and folder.is_relative_to(top)
    return {
        "task": task.get_language_instruction()[0],
        "object": task.get_info()["object"][0],
        "package": folder.relative_to(top).as_posix() if top is not None and inside else str(entry.folder),
        "joint": part.joint.name,
    }
