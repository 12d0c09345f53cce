"""Settings of the physical trials and of validation; importing them loads no engine."""

from dataclasses import dataclass, field
from typing import Literal

from sim_export.checks import CheckConfig


@dataclass(frozen=True, kw_only=True)
class HandConfig:
    """Limits of the hand that opens and closes joints, in newtons and newton metres."""

    pull: float = 30.0
    """Largest force on a drawer, or at the handle of a turning part."""

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
    """Hand limits for pulling and pushing joints."""

    rest_seconds: float = 5.0
    """Duration (seconds) for which the fixed object rests under gravity (V302)."""

    stand_seconds: float = 3.0
    """Duration (seconds) for which the free object stands on the ground (V303)."""

    pull_seconds: float = 5.0
    """Time limit (seconds) for opening or closing a joint by hand (V304)."""

    lean_seconds: float = 2.0
    """Duration (seconds) of the observation of the tilted object (V305)."""

    lean_degrees: float = 5.0
    """Tilt of the object in degrees (V305)."""

    limit_fraction: float = 0.01
    """Distance from a limit, as a share of the range, within which it counts as reached, and as kept at rest
    (V302, V305) ..."""

    limit_degrees: float = 0.5
    """... or, for turning joints, this angle if it is larger."""


@dataclass(frozen=True, kw_only=True)
class DynamicsConfig:
    """Settings of the L3 checks."""

    trials: TrialConfig = field(default_factory=TrialConfig)
    """Durations, hand forces and tolerances."""

    timestep: float = 1.0 / 100.0
    """Time step (seconds) of checks V302 to V307: ManiSkill's default."""

    other_timesteps: tuple[float, ...] = (1.0 / 60.0, 1.0 / 240.0)
    """Time steps (seconds) at which V309 repeats V302 to V306."""


@dataclass(frozen=True, kw_only=True)
class EngineChoice:
    """An engine for checks L5, by its name in `envs.engines.witness.WITNESSES`."""

    name: str
    """``mujoco``, ``pybullet``, ``newton``, ...; the list gives the file that each reads."""

    python: str | None = None
    """Python interpreter of an environment that has the engine; default: the current one."""


@dataclass(frozen=True, kw_only=True)
class ValidateConfig:
    """Settings of a whole validation."""

    checks: CheckConfig = field(default_factory=CheckConfig)
    """Thresholds of L0 to L2."""

    dynamics: DynamicsConfig = field(default_factory=DynamicsConfig)
    """Settings of L3."""

    tasks: Literal["none", "run"] = "none"
    """``run`` also performs the L4 checks in ManiSkill: 5 to 60 seconds more, depending on the number of
    parts."""

    task_timeout: float = 600.0
    """Time limit (seconds) for the L4 checks."""

    engines: tuple[EngineChoice, ...] = ()
    """Engines that also test the package (checks L5), each in its own process."""

    engine_timeout: float = 600.0
    """Time limit (seconds) for one engine."""

    timeout: float = 120.0
    """Time limit (seconds) for the static and for the dynamic checks."""

    output: Literal["package", "none"] = "package"
    """``package`` writes ``validation.json`` into the folder, ``none`` only returns the report."""
