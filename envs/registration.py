"""Registers the environments. Entry points are small factories that import the physics engine when called."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import gymnasium as gym
from gymnasium.envs.registration import WrapperSpec

if TYPE_CHECKING:
    from .actuate import ActuateConfig, ActuateEnv
    from .joint_sweep import JointSweepConfig, JointSweepEnv
    from .settle import SettleConfig, SettleEnv

TASKS = {
    "ArtiGen-OpenPart-v1": ("envs.maniskill.open_part:OpenPartEnv", 500),
    "ArtiGen-PutInside-v1": ("envs.maniskill.put_inside:PutInsideEnv", 300),
    "ArtiGen-OpenCabinetDrawer-v1": ("envs.maniskill.stock:PackageDrawerEnv", 100),
    "ArtiGen-OpenCabinetDoor-v1": ("envs.maniskill.stock:PackageDoorEnv", 100),
}
"""ManiSkill tasks: id, entry point, steps per episode. ManiSkill is imported when one is created."""
VERB_TASKS = {
    "ArtiGen-TurnPart-v1": "turn",
    "ArtiGen-PressPart-v1": "press",
    "ArtiGen-LiftPart-v1": "lift",
    "ArtiGen-SlidePart-v1": "slide",
}
"""Variants of ``ArtiGen-OpenPart-v1`` with another verb."""
ROOM_ID = "ArtiGen-Room-v1"
"""A furnished room in ManiSkill; takes ``scenes`` instead of packages."""
ENVIRONMENT_IDS = ("ArtiGen/Actuate-v0", "ArtiGen/JointSweep-v0", "ArtiGen/Settle-v0")


def make_actuate(
    package: str | Path, cfg: "ActuateConfig | None" = None, render_mode: str | None = None
) -> "ActuateEnv":
    """``ArtiGen/Actuate-v0``."""
    from .actuate import ActuateConfig, ActuateEnv

    return ActuateEnv(Path(package), ActuateConfig() if cfg is None else cfg, render_mode)


def make_joint_sweep(
    package: str | Path, cfg: "JointSweepConfig | None" = None, render_mode: str | None = None
) -> "JointSweepEnv":
    """``ArtiGen/JointSweep-v0``."""
    from .joint_sweep import JointSweepConfig, JointSweepEnv

    return JointSweepEnv(Path(package), JointSweepConfig() if cfg is None else cfg, render_mode)


def make_settle(
    package: str | Path, cfg: "SettleConfig | None" = None, render_mode: str | None = None
) -> "SettleEnv":
    """``ArtiGen/Settle-v0``."""
    from .settle import SettleConfig, SettleEnv

    return SettleEnv(Path(package), SettleConfig() if cfg is None else cfg, render_mode)


def register_environments() -> None:
    """Registers every id once; gymnasium adds the time limits."""
    _register("ArtiGen/Actuate-v0", make_actuate, steps=100)
    _register("ArtiGen/JointSweep-v0", make_joint_sweep, steps=200)
    _register("ArtiGen/Settle-v0", make_settle, steps=100)
    for name, (entry_point, steps) in TASKS.items():
        _register_task(name, entry_point, steps=steps)
    for name, verb in VERB_TASKS.items():
        _register_task(name, *TASKS["ArtiGen-OpenPart-v1"], verb=verb)
    _register_task(ROOM_ID, "envs.maniskill.scene:RoomEnv", steps=200)


def _register(name: str, factory: Callable[..., gym.Env], *, steps: int) -> None:
    if name not in gym.registry:
        gym.register(id=name, entry_point=factory, max_episode_steps=steps)


def _register_task(name: str, entry_point: str, steps: int, **kwargs: str) -> None:
    """Registers a task whose class takes ``kwargs``, with ManiSkill's batched time limit instead of
    gymnasium's."""
    if name not in gym.registry:
        limit = WrapperSpec(
            "MSTimeLimit",
            entry_point="mani_skill.utils.registration:TimeLimitWrapper",
            kwargs={"max_episode_steps": steps},
        )
        gym.register(
            id=name,
            entry_point=entry_point,
            max_episode_steps=steps,
            disable_env_checker=True,
            additional_wrappers=(limit,),
            kwargs=kwargs,
        )
