"""Demonstrations of the scripted solvers in ManiSkill tasks, as data sets of LeRobot or ManiSkill."""

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from artigen.api.batch import Finished, Laps, Made, make_supervised, run_with_progress
from artigen.datasets.lerobot import Episode, write_lerobot
from artigen.errors import ArtigenError, name_options
from artigen.io import whole_folder, write_whole
from artigen.runtime.runner import Runner
from artigen.runtime.workers import Worker

if TYPE_CHECKING:
    import gymnasium as gym

DemoFormat = Literal["lerobot", "maniskill"]
RECORDINGS = "recordings"
"""Subfolder of what was recorded, in parts, from which data sets are written."""
ENVIRONMENT = "meta/environment.json"
"""File of a LeRobot data set with the environment of its episodes."""
CHUNK = 5
"""Episodes that are tried one after the other in one process."""
TRIES = 4
"""Episodes that are tried for each that is wanted, at most."""
TIMEOUT = 150.0 * CHUNK
"""Time limit (seconds) for one chunk."""
PUT = "ArtiGen-PutInside-v1"
CAMERA = "observation.images"


@dataclass(frozen=True, kw_only=True)
class DemoSettings:
    """What is demonstrated, and what is recorded of it."""

    robot: Literal["panda", "fetch"] = "panda"
    """The solvers are measured with the Panda."""
    part: str = "any"
    """``drawer``, ``door`` or another label, or ``any`` that fits the task."""
    handles: Literal["required", "optional"] = "required"
    """Whether parts without an annotated handle are left out; no matter for putting things inside."""
    pictures: Literal["auto", "none"] = "auto"
    """Pictures of the task's cameras, where SAPIEN finds a render device."""
    validation: Literal["passed", "any"] = "passed"
    """``any`` takes packages without a passed validation.json."""
    unseen: float = 0.0
    """Share of the objects to leave out: the ``unseen`` ones of ``envs.split.split_objects``."""


@dataclass(frozen=True, kw_only=True)
class DemoJob:
    """Job to play some episodes with consecutive seeds."""

    task: str
    packages: Path
    first: int
    out: Path
    cfg: DemoSettings
    render: bool

    @property
    def key(self) -> str:
        """Name of the folder of these recordings."""
        return f"seeds_{self.first:06d}"

    @property
    def settings(self) -> str:
        """Everything that determines the episodes, as text."""
        return f"{self.key} {self.task} {self.packages} {self.cfg} {self.render}"


@dataclass(frozen=True, kw_only=True)
class Replayed:
    """An episode of a data set, played again by its seed, object and actions."""

    object: str
    seed: int
    success: bool


def make_demos(
    task: str,
    packages: Path,
    count: int,
    out: Path,
    *,
    runner: Runner,
    seed: int = 0,
    cfg: DemoSettings | None = None,
    format: DemoFormat = "lerobot",
) -> str:
    """Records successful episodes, objects in turn, and writes a data set; returns a line about it.

    Args:
        task: Id of a ManiSkill task that has a solver, such as ``ArtiGen-OpenPart-v1``.
        packages: Folder of packages.
        count: Number of successful episodes.
        out: Folder for ``recordings/``, from which a rerun continues, and for the data set, a folder named as
            its format.
        runner: Where episodes are played.
        seed: Seed of the first episode that is tried.
        cfg: What is recorded.
        format: ``lerobot`` (v3.0) or ``maniskill`` (HDF5 and JSON).

    Raises:
        ArtigenError: If there is no such task, a number is out of range, or too few episodes succeed.
    """
    from envs.registration import SOLVED_TASKS
    from envs.sim.scene import has_render_device

    cfg = cfg or DemoSettings()
    if task not in SOLVED_TASKS:
        raise ArtigenError(f"task {task!r} has no solver, expected {name_options(task, SOLVED_TASKS)}")
    if count < 1 or seed < 0:
        raise ArtigenError(f"{count} episodes from seed {seed}: expected at least one, and a seed from 0")
    render = cfg.pictures == "auto" and has_render_device()
    jobs: list[DemoJob] = []
    done: list[Finished] = []
    found = tried = 0
    while found < count and tried < TRIES * count:
        for _ in range(-(-(count - found) // CHUNK)):
            jobs.append(
                DemoJob(
                    task=task, packages=packages.resolve(), first=seed + CHUNK * len(jobs),
                    out=out / RECORDINGS, cfg=cfg, render=render,
                )
            )  # fmt: skip
        done = run_with_progress(
            play_and_report, jobs, out / RECORDINGS, runner=runner, unit=f"{CHUNK} episodes"
        )
        if any(finished.error for finished in done):
            raise ArtigenError(f"{task}: {next(each.error for each in done if each.error)}")
        tried = CHUNK * len(jobs)
        found = tried - sum(len(finished.notes) for finished in done)
    reasons = Counter(note for finished in done for note in finished.notes)
    if found < count:
        common = "; ".join(f"{number} times: {reason}" for reason, number in reasons.most_common(3))
        raise ArtigenError(f"{task}: {found} of {tried} episodes succeed, {count} are wanted; {common}")
    recorded = islice(_read(jobs), count)
    target = out / format
    {"lerobot": _write_lerobot, "maniskill": _write_maniskill}[format](recorded, target)
    spent = sum(seconds for finished in done for _, seconds in finished.seconds)
    return f"{count} episodes in {target}: {found} of {tried} succeeded, {spent / tried:.1f} s each"


def play_and_report(worker: Worker, job: DemoJob) -> Finished:
    """Plays the episodes of a job in a supervised process; the notes are the reasons of those that failed."""
    return make_supervised(worker, job, _play, TIMEOUT)


def replay_demos(
    folder: Path, packages: Path | None = None, count: int | None = None
) -> tuple[Replayed, ...]:
    """Plays the first episodes of a LeRobot data set of `make_demos` again, from their actions alone.

    Args:
        folder: The data set.
        packages: Where the packages are now; default: where they were.
        count: Number of episodes; default: all.
    """
    import gymnasium as gym
    import pyarrow.parquet as parquet

    import envs  # noqa: F401  registers the tasks

    said = json.loads((folder / ENVIRONMENT).read_text())
    kwargs = said["env_kwargs"] | {"obs_mode": "none", "render_backend": "none"}
    env = gym.make(said["env_id"], **kwargs | ({} if packages is None else {"packages": str(packages)}))
    columns = ["episode_index", "object", "package", "seed"]
    rows = parquet.read_table(folder / "meta" / "episodes", columns=columns).to_pylist()
    found = []
    for row in rows[:count]:
        chosen = [("episode_index", "=", row["episode_index"])]
        frames = parquet.read_table(folder / "data", columns=["action"], filters=chosen)
        env.reset(seed=row["seed"], options={"object": row["package"]})
        info: dict[str, Any] = {"success": [False]}
        for action in np.stack(frames["action"].to_numpy()):
            *_, info = env.step(action)
        found.append(Replayed(object=row["object"], seed=row["seed"], success=bool(info["success"][0])))
    env.close()
    return tuple(found)


def _play(job: DemoJob) -> Made:
    laps = Laps()
    env = _open(job)
    from envs.maniskill.solver.record import record_episodes
    from envs.maniskill.solver.solve import solve_open_part, solve_put_inside
    from envs.split import split_objects

    task: Any = env.unwrapped
    left_out = split_objects(job.packages, job.cfg.unseen).unseen if job.cfg.unseen else ()
    folders = [entry.folder for entry in task.objects if entry.folder not in left_out]
    objects = [
        str(folder) if folder == job.packages else folder.relative_to(job.packages).as_posix()
        for folder in folders
    ]
    solver = solve_put_inside if job.task == PUT else solve_open_part
    laps.end("make")
    with whole_folder(job.out / job.key) as scratch:
        seeds = range(job.first, job.first + CHUNK)
        outcomes = record_episodes(env, solver, seeds, scratch, objects)
    laps.end("play")
    return laps.made(tuple(outcome.reason for outcome in outcomes if not outcome.success))


def _open(job: DemoJob) -> "gym.Env":
    import gymnasium as gym

    import envs  # noqa: F401  registers the tasks

    own: dict[str, Any] = {} if job.task == PUT else {"handles": job.cfg.handles}
    return gym.make(
        job.task, packages=str(job.packages), part=job.cfg.part, robot_uids=job.cfg.robot,
        validation=job.cfg.validation, control_mode="pd_joint_pos", sim_backend="physx_cpu",
        obs_mode="state_dict+rgb" if job.render else "state_dict",
        render_backend="sapien_cpu" if job.render else "none", **own,
    )  # fmt: skip


def _read(jobs: list[DemoJob]) -> Iterator[tuple[dict, dict, Any]]:
    """The description of the recording, that of the episode, and its HDF5 group, for every episode."""
    import h5py

    from envs.maniskill.solver.record import DESCRIPTION, TRAJECTORIES

    for job in jobs:
        path = job.out / job.key / DESCRIPTION
        if path.is_file():  # a recording without a success has none
            head = json.loads(path.read_text())
            with h5py.File(path.with_name(TRAJECTORIES)) as file:
                for episode in head["episodes"]:
                    yield head, episode, file[f"traj_{episode['episode_id']}"]


def _write_maniskill(recorded: Iterator[tuple[dict, dict, Any]], out: Path) -> None:
    """One HDF5 file of all episodes, and its JSON."""
    import h5py

    from envs.maniskill.solver.record import DESCRIPTION, TRAJECTORIES

    listed: list[dict] = []
    head: dict = {}
    with whole_folder(out) as scratch:
        with h5py.File(scratch / TRAJECTORIES, "w") as file:
            for number, (first, episode, group) in enumerate(recorded):
                head = head or first
                group.file.copy(group, file, f"traj_{number}")
                listed.append(episode | {"episode_id": number})
        write_whole(scratch / DESCRIPTION, json.dumps(head | {"episodes": listed}, indent=2))


def _write_lerobot(recorded: Iterator[tuple[dict, dict, Any]], out: Path) -> None:
    first = next(recorded)
    head, _, group = first
    names = {
        "observation.state": head["joints"],
        "observation.environment_state": [
            f"{name}_{k}" for name, values in group["obs/extra"].items() for k in range(values.shape[1])
        ],
    }

    def episodes() -> Iterator[Episode]:
        yield _episode(*first[1:])
        for _, episode, group in recorded:
            yield _episode(episode, group)

    robot = head["env_info"]["env_kwargs"]["robot_uids"]
    said = {"env_id": head["env_info"]["env_id"], "env_kwargs": head["env_info"]["env_kwargs"]}
    files = {ENVIRONMENT: json.dumps(said, indent=1)}
    write_lerobot(episodes(), out, fps=head["control_freq"], robot=robot, names=names, files=files)


def _episode(episode: dict, group: Any) -> Episode:
    """An episode of ManiSkill as one of LeRobot."""
    steps = len(group["actions"])
    extra = [np.asarray(values)[:steps] for values in group["obs/extra"].values()]
    cameras = group["obs/sensor_data"] if "sensor_data" in group["obs"] else {}
    return Episode(
        task=episode["task"],
        arrays={
            "observation.state": np.asarray(group["obs/agent/qpos"])[:steps],
            "observation.environment_state": np.concatenate(extra, axis=1),
            "action": np.asarray(group["actions"]),
            "next.reward": np.asarray(group["rewards"]),
            "next.success": np.asarray(group["success"]),
        },
        pictures={f"{CAMERA}.{name}": np.asarray(each["rgb"])[:steps] for name, each in cameras.items()},
        about={key: episode[key] for key in ("object", "package", "joint", "success")}
        | {"seed": episode["episode_seed"]},
    )
