"""Runs trials in other engines, each in its own process and in any Python environment that has it."""

import json
import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from artigen.plugins import PluginError, find_plugins
from sim_export.errors import PackageError
from sim_export.report import CheckResult

from ..config import EngineChoice
from ..titles import ENGINE_TITLES, make_result
from .judge import judge
from .plan import EnginePlan, make_plan

RUNNERS = Path(__file__).parent / "runners"
PROJECT = Path(__file__).parents[2]
FILES = {"urdf": "mobility.urdf", "mjcf": "mobility.mjcf.xml"}


@dataclass(frozen=True, kw_only=True)
class Witness:
    """An engine: its runner, the file of the package that it reads, and the package to install.

    The runner is a file in ``runners``; that of an extension is an absolute path, and may import
    ``harness`` as those do.
    """

    runner: str
    file: Literal["urdf", "mjcf"]
    install: str


WITNESSES = {
    "mujoco": Witness(runner="run_mujoco.py", file="mjcf", install="mujoco"),
    "mujoco-urdf": Witness(runner="run_mujoco.py", file="urdf", install="mujoco"),
    "sapien": Witness(runner="run_sapien.py", file="urdf", install="sapien"),
    "pybullet": Witness(runner="run_pybullet.py", file="urdf", install="pybullet"),
    "newton": Witness(runner="run_newton.py", file="mjcf", install="newton[sim,importers]"),
    "newton-urdf": Witness(runner="run_newton.py", file="urdf", install="newton[sim,importers]"),
}


def find_witnesses() -> dict[str, Witness]:
    """`WITNESSES`, and behind them those that extensions add.

    Raises:
        PluginError: If an extension cannot be loaded, or names an engine that exists.
    """
    found = dict(WITNESSES)
    for plugin in find_plugins("artigen.engines", Witness):
        if plugin.name in found:
            raise PluginError(f"{plugin.origin}: engine {plugin.name!r} exists already; name it otherwise")
        found[plugin.name] = plugin.value
    return found


def ask_engines(folder: Path, engines: tuple[EngineChoice, ...], timeout: float) -> tuple[CheckResult, ...]:
    """Checks V501 to V506 of every engine; a missing engine is skipped with a message."""
    from sim_export.files.read import read_package

    try:
        plan = make_plan(folder, read_package(folder, appearance=False))
    except PackageError as error:
        return not_asked(engines, str(error))
    return tuple(check for engine in engines for check in _ask(plan, engine, timeout))


def not_asked(engines: tuple[EngineChoice, ...], reason: str) -> tuple[CheckResult, ...]:
    """All checks of all engines as failures with one reason."""
    return tuple(check for engine in engines for check in _failed(engine.name, reason))


def _ask(plan: EnginePlan, engine: EngineChoice, timeout: float) -> tuple[CheckResult, ...]:
    witness = find_witnesses()[engine.name]
    if not (Path(plan.folder) / FILES[witness.file]).is_file():
        return _skipped(engine.name, f"the package has no {FILES[witness.file]}")
    answer = run_engine(plan, engine, timeout)
    if "missing" in answer:
        return _skipped(
            engine.name,
            f"no module {answer['missing']} in {engine.python or sys.executable}; "
            f"`pip install {witness.install}` there, or name another with --engine-python {engine.name}=PATH",
        )
    if "error" in answer:
        return _failed(engine.name, str(answer["error"]))
    return judge(engine.name, plan, answer)


def run_engine(
    plan: EnginePlan, engine: EngineChoice, timeout: float, extra: dict[str, object] | None = None
) -> dict:
    """The engine's measurements for a plan; ``missing`` or ``error`` if there are none.

    ``extra`` adds to the plan: ``as_loaded`` skips what runners restore after loading, ``bisect`` also
    measures the effort at which each joint starts to move.
    """
    witness = find_witnesses()[engine.name]
    asked = asdict(plan) | {"file": witness.file} | (extra or {})
    # Runners import from their own environment only; SAPIEN's is this one and also needs this project.
    environment = dict(os.environ)
    paths = [str(PROJECT)] if engine.name == "sapien" else []
    paths += [str(RUNNERS)] if Path(witness.runner).is_absolute() else []
    if paths:
        environment["PYTHONPATH"] = os.pathsep.join([*paths, *filter(None, [environment.get("PYTHONPATH")])])
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "plan.json"
        file.write_text(json.dumps(asked))
        command = [engine.python or sys.executable, str(RUNNERS / witness.runner), str(file)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=timeout, check=False, cwd=scratch,
                env=environment,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return {"error": f"took longer than {timeout:g} s and was stopped"}
        except OSError as error:
            return {"error": f"{command[0]} cannot be run: {error.strerror}"}
    try:
        return json.loads(done.stdout)
    except json.JSONDecodeError:
        last = done.stderr.strip().splitlines()[-1:] or ["no output"]
        return {"error": f"the process ended with {_code(done.returncode)}: {last[0]}"}


def _code(code: int) -> str:
    return f"exit code {code}" if code >= 0 else f"signal {signal.Signals(-code).name}"


def _skipped(engine: str, reason: str) -> tuple[CheckResult, ...]:
    return (make_result("V501", "not_applicable", f"skipped: {reason}", engine=engine),)


def _failed(engine: str, reason: str) -> tuple[CheckResult, ...]:
    first, *rest = ENGINE_TITLES
    return (
        make_result(first, "fail", reason, engine=engine),
        *(make_result(check, "fail", f"not run: {first} failed", engine=engine) for check in rest),
    )
