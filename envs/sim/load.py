"""Opens a package in an engine: ``load("out/fridge", "mujoco")``."""

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Literal, Protocol, overload

from sim_export.package import SimPackage

from .loaded import LoadedPackage
from .mujoco import MujocoPackage, load_mujoco

EngineName = Literal["sapien", "mujoco"]
TIMESTEP = 0.01
"""Default time step, seconds."""


class Simulation(Protocol):
    """A package in an engine, fixed to the world; followers, springs and friction act at every step."""

    @property
    def package(self) -> SimPackage:
        """What was loaded."""
        ...

    def reset(self, coordinates: Mapping[str, float] | None = None) -> None:
        """Poses independent joints by name (m or rad) and the others at rest; followers follow."""
        ...

    def step(self, efforts: Mapping[str, float] | None = None) -> None:
        """Performs one step; efforts on joints by name (N or N m) act until others are given."""
        ...

    def positions(self) -> dict[str, float]:
        """Coordinates of all moving joints by name (m or rad), followers included."""
        ...


@overload
def load(
    package: SimPackage | Path | str, engine: Literal["sapien"] = "sapien", *, timestep: float = TIMESTEP
) -> LoadedPackage: ...
@overload
def load(
    package: SimPackage | Path | str, engine: Literal["mujoco"], *, timestep: float = TIMESTEP
) -> MujocoPackage: ...
def load(
    package: SimPackage | Path | str, engine: EngineName = "sapien", *, timestep: float = TIMESTEP
) -> Simulation:
    """Loads a package into a new scene of an engine, at rest, with its frame at the world's.

    Args:
        package: A folder, or the package itself, which is then written to a temporary one.
        engine: ``sapien`` or ``mujoco``.
        timestep: Seconds per step.

    Raises:
        PackageError: If the folder cannot be read or the engine rejects it.
        ValueError: If there is no such engine, or the time step is not positive.
    """
    from sim_export.files.read import read_package
    from sim_export.files.write import write_package

    if engine not in ("sapien", "mujoco"):
        raise ValueError(f"engine {engine!r}, expected sapien or mujoco")
    if not timestep > 0.0:
        raise ValueError(f"timestep {timestep} s, expected > 0")
    if isinstance(package, SimPackage):
        with tempfile.TemporaryDirectory() as scratch:
            return _load(write_package(package, Path(scratch) / package.name), package, engine, timestep)
    return _load(Path(package), read_package(Path(package)), engine, timestep)


def _load(folder: Path, package: SimPackage, engine: EngineName, timestep: float) -> Simulation:
    if engine == "mujoco":
        return load_mujoco(folder, package, timestep)
    from .sapien import LoadConfig, load_package
    from .scene import create_scene

    return load_package(create_scene(timestep), folder, LoadConfig(base="fixed"), package)
