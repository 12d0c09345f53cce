"""Settings of the physical trials and of validation; light, so that a parent process can hold them."""

from dataclasses import dataclass, field
from typing import Literal

from sim_export.checks import CheckConfig


@dataclass(frozen=True, kw_only=True)
class HandConfig:
    """Limits of the hand that opens and closes things, in newtons and newton metres."""

    pull: float = 30.0
    """Largest force on a drawer, or at the handle of anything that turns."""

    turn: float = 10.0
    """Largest torque on a door, lid or wheel."""

    push: float = 10.0
    """Largest force of fingers, on a button or at the rim of a knob."""

    twist: float = 1.0
    """Largest torque of fingers on a knob."""


@dataclass(frozen=True, kw_only=True)
class TrialConfig:
    """Durations and tolerances of the trials."""

    hand: HandConfig = field(default_factory=HandConfig)
    """How hard joints are pulled and pushed."""

    rest_seconds: float = 5.0
    """How long the fixed object stands under gravity (V302)."""

    stand_seconds: float = 3.0
    """How long the free object stands on the ground (V303)."""

    pull_seconds: float = 5.0
    """How long a hand may take to open or close a joint (V304)."""

    lean_seconds: float = 2.0
    """How long the tilted object is watched (V305)."""

    lean_degrees: float = 5.0
    """How far the object is tilted (V305)."""

    limit_fraction: float = 0.01
    """A limit counts as reached within this part of the range ..."""

    limit_degrees: float = 0.5
    """... or, for turning joints, within this angle if that is more."""


@dataclass(frozen=True, kw_only=True)
class DynamicsConfig:
    """Settings of the L3 checks."""

    trials: TrialConfig = field(default_factory=TrialConfig)
    """Durations, hand forces and tolerances."""

    timestep: float = 1.0 / 100.0
    """Seconds per step of checks V302 to V307: ManiSkill's default."""

    other_timesteps: tuple[float, ...] = (1.0 / 60.0, 1.0 / 240.0)
    """Where V309 repeats V302 to V306."""


@dataclass(frozen=True, kw_only=True)
class EngineChoice:
    """An engine that is asked for its opinion, by its name in `envs.engines.witness.WITNESSES`."""

    name: str
    """``mujoco``, ``pybullet``, ``newton``, ...; the list says which file each reads."""

    python: str | None = None
    """The interpreter of an environment that has the engine; without one the present interpreter."""


@dataclass(frozen=True, kw_only=True)
class ValidateConfig:
    """Settings of a whole validation."""

    checks: CheckConfig = field(default_factory=CheckConfig)
    """Thresholds of L0 to L2."""

    dynamics: DynamicsConfig = field(default_factory=DynamicsConfig)
    """Settings of L3."""

    tasks: Literal["none", "run"] = "none"
    """``run`` also makes the checks L4, in ManiSkill: 5 to 60 seconds more, by the number of parts."""

    task_timeout: float = 600.0
    """Seconds that the checks L4 may take, before they count as failed."""

    engines: tuple[EngineChoice, ...] = ()
    """Engines that also try the package (checks L5), each in a process of its own."""

    engine_timeout: float = 600.0
    """Seconds that one engine may take, before its checks count as failed."""

    timeout: float = 120.0
    """Seconds that the static and the dynamic half may take each, before they count as failed."""

    output: Literal["package", "none"] = "package"
    """``package`` leaves ``validation.json`` in the folder, ``none`` only returns the report."""
