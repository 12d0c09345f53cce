"""The environments' ids. Entry points are small factories: the physics engine is imported when one runs."""

from pathlib import Path
from typing import TYPE_CHECKING

import gymnasium as gym

if TYPE_CHECKING:
    from .actuate import ActuateConfig, ActuateEnv
    from .joint_sweep import JointSweepConfig, JointSweepEnv
    from .settle import SettleConfig, SettleEnv

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
    factories = (make_actuate, make_joint_sweep, make_settle)
    for name, factory, steps in zip(ENVIRONMENT_IDS, factories, (100, 200, 100), strict=True):
        if name not in gym.registry:
            gym.register(id=name, entry_point=factory, max_episode_steps=steps)
