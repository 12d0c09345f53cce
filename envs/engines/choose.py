"""Engines for checks L5, by name."""

from pathlib import Path

from artigen.errors import ArtigenError
from envs.config import EngineChoice
from envs.engines.witness import find_witnesses


def choose_engines(names: str, pythons: tuple[str, ...]) -> tuple[EngineChoice, ...]:
    """Parses comma-separated engine names, and interpreters given as ``NAME=PATH``.

    Args:
        names: Names of `envs.engines.witness.find_witnesses`, such as ``mujoco,newton``.
        pythons: Interpreters of environments that have an engine, such as ``newton=/path/to/python``.

    Raises:
        ArtigenError: If an engine is unknown, or an interpreter does not exist or belongs to no requested
            engine.
    """
    asked = [name.strip() for name in names.split(",") if name.strip()]
    known = find_witnesses()
    unknown = [name for name in asked if name not in known]
    if unknown:
        raise ArtigenError(f"unknown engine {', '.join(unknown)}: expected {', '.join(known)}")
    paths: dict[str, str] = {}
    for entry in pythons:
        name, _, path = entry.partition("=")
        if name not in asked:
            raise ArtigenError(f"--engine-python {entry}: expected NAME=PATH with NAME in --engines")
        if not Path(path).is_file():
            raise ArtigenError(f"--engine-python {entry}: no such file")
        paths[name] = path
    return tuple(EngineChoice(name=name, python=paths.get(name)) for name in asked)
