"""Settings of validation; importing them loads no engine."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class EngineChoice:
    """An engine for checks L5, by its name in `envs.engines.witness.find_witnesses`."""

    name: str
    """``mujoco``, ``pybullet``, ``newton``, ...; the list gives the file that each reads."""
    python: str | None = None
    """Python interpreter of an environment that has the engine; default: the current one."""


@dataclass(frozen=True, kw_only=True)
class ValidateConfig:
    """Settings of a whole validation."""

    tasks: Literal["none", "run"] = "none"
    """``run`` also performs the L4 checks in ManiSkill: 5 to 60 seconds more, depending on the number of
    parts."""
    engines: tuple[EngineChoice, ...] = ()
    """Engines that also test the package (checks L5), each in its own process."""
    output: Literal["package", "none"] = "package"
    """``package`` writes ``validation.json`` into the folder, ``none`` only returns the report."""
