"""Registers the environments. Their modules, and with them the engines, are imported when one is created."""

import gymnasium as gym
from gymnasium.envs.registration import WrapperSpec

ENVIRONMENTS = {
    "ArtiGen/Actuate-v0": ("envs.actuate:ActuateEnv", 100),
    "ArtiGen/JointSweep-v0": ("envs.joint_sweep:JointSweepEnv", 200),
    "ArtiGen/Settle-v0": ("envs.settle:SettleEnv", 100),
}
"""Environments of one package: id, entry point, steps per episode."""
TASKS = {
    "ArtiGen-OpenPart-v1": ("envs.maniskill.open_part:OpenPartEnv", 500),
    "ArtiGen-PutInside-v1": ("envs.maniskill.put_inside:PutInsideEnv", 300),
    "ArtiGen-OpenCabinetDrawer-v1": ("envs.maniskill.stock:PackageDrawerEnv", 100),
    "ArtiGen-OpenCabinetDoor-v1": ("envs.maniskill.stock:PackageDoorEnv", 100),
}
"""ManiSkill tasks: id, entry point, steps per episode."""
VERB_TASKS = {
    "ArtiGen-TurnPart-v1": "turn",
    "ArtiGen-PressPart-v1": "press",
    "ArtiGen-LiftPart-v1": "lift",
    "ArtiGen-SlidePart-v1": "slide",
}
"""Variants of ``ArtiGen-OpenPart-v1`` with another verb."""
SOLVED_TASKS = ("ArtiGen-OpenPart-v1", "ArtiGen-PutInside-v1", *VERB_TASKS)
"""Tasks that have a scripted solver."""
ROOM_ID = "ArtiGen-Room-v1"
"""A furnished room in ManiSkill; takes ``scenes`` instead of packages."""
ENVIRONMENT_IDS = tuple(ENVIRONMENTS)


def register_environments() -> None:
    """Registers every id once; gymnasium adds the time limits."""
    for name, (entry_point, steps) in ENVIRONMENTS.items():
        if name not in gym.registry:
            gym.register(id=name, entry_point=entry_point, max_episode_steps=steps)
    for name, (entry_point, steps) in TASKS.items():
        _register_task(name, entry_point, steps=steps)
    for name, verb in VERB_TASKS.items():
        _register_task(name, *TASKS["ArtiGen-OpenPart-v1"], verb=verb)
    _register_task(ROOM_ID, "envs.maniskill.scene:RoomEnv", steps=200)


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
