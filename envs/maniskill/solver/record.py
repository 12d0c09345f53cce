"""Records demonstrations of the scripted solvers in ManiSkill's trajectory format (HDF5 and JSON)."""

from collections.abc import Callable, Iterable
from pathlib import Path

import gymnasium as gym
from mani_skill.utils.wrappers.record import RecordEpisode

from .solve import Outcome


def record_episodes(
    env: gym.Env, solver: Callable[[gym.Env, int], Outcome], seeds: Iterable[int], out: Path
) -> tuple[Outcome, ...]:
    """Plays one episode per seed and stores the successful ones.

    Args:
        env: A task with the control mode ``pd_joint_pos``; it is closed at the end.
        solver: `solve_open_part` or `solve_put_inside`.
        seeds: Seeds of the episodes.
        out: Folder for ``demonstrations.h5`` and ``demonstrations.json``; created if missing.

    Returns:
        One outcome per seed, including failures.
    """
    recorder = RecordEpisode(
        env,  # type: ignore[arg-type]
        output_dir=str(out),
        save_video=False,
        save_on_reset=False,
        trajectory_name="demonstrations",
        source_type="motionplanning",
        source_desc="artigen's scripted solver: inverse kinematics along the joint's path",
    )
    outcomes = []
    for seed in seeds:
        outcome = solver(recorder, seed)
        recorder.flush_trajectory(save=outcome.success)
        outcomes.append(outcome)
    recorder.close()
    return tuple(outcomes)
