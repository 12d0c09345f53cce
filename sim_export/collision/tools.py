"""Convex decompositions by CoACD and V-HACD, in a process of their own, which may abort or run for minutes.

``python -m sim_export.collision.tools IN.npz OUT.npz`` is the child's side.
"""

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from sim_export.errors import DegeneratePart, ExportError
from sim_export.geometry.hulls import convex_hull
from sim_export.geometry.rows import number_rows
from sim_export.package import Hull

Tool = Literal["coacd", "vhacd"]
Options = Mapping[str, Any]
ONE_CORE = {"OMP_NUM_THREADS": "1"}


class DecompositionFailed(ExportError):
    """A tool gave no hulls."""


def read_options(text: str) -> dict[str, Any]:
    """Parameters such as ``threshold=0.03,pca=true`` by their names.

    Raises:
        ExportError: If a part of the text is not of the form NAME=VALUE.
    """
    out: dict[str, Any] = {}
    for part in filter(None, map(str.strip, text.split(","))):
        name, equals, value = map(str.strip, part.partition("="))
        if not (name.isidentifier() and equals and value):
            raise ExportError(
                f"parameters {text!r}: found {part!r}, expected NAME=VALUE, such as threshold=0.03"
            )
        try:
            out[name] = json.loads(value)
        except ValueError:
            out[name] = value
    return out


def decompose(
    tool: Tool, triangles: Float[np.ndarray, "F 3 3"], options: Options, seconds: float, owner: str
) -> tuple[Hull, ...]:
    """Convex hulls (m) of triangles that a tool finds with its own defaults but for some ``options``.

    Args:
        seconds: Seconds of one core that it may take.
        owner: How errors name what is decomposed.

    Raises:
        DecompositionFailed: If the tool refuses an option, aborts, takes too long, or gives
            no hull.
    """
    corners = triangles.reshape(-1, 3)
    first, faces = number_rows(np.rint(1e7 * corners).astype(np.int64))
    with tempfile.TemporaryDirectory(prefix="hulls-") as scratch:
        source, target = Path(scratch) / "in.npz", Path(scratch) / "out.npz"
        settings = json.dumps({"tool": tool, "options": dict(options)})
        np.savez(source, vertices=corners[first], faces=faces.reshape(-1, 3), settings=settings)
        begun = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(
            [sys.executable, "-m", __name__, str(source), str(target)],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, **ONE_CORE, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            preexec_fn=partial(_limit, seconds) if np.isfinite(seconds) else None,
        )
        ended = resource.getrusage(resource.RUSAGE_CHILDREN)
        if not target.is_file():
            last = (done.stderr.strip().splitlines() or ["no message"])[-1][:200]
            spent = ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime
            late = -done.returncode in (signal.SIGXCPU, signal.SIGKILL)
            why = f"took more than {spent:.0f} s" if late else f"ended with status {done.returncode} ({last})"
            hint = (
                "raise --budget or its threshold" if late else "check its parameters, or try --collision auto"
            )
            raise DecompositionFailed(f"{owner}: {tool} {why} on {len(triangles)} triangles; {hint}")
        return _read_hulls(target, tool, owner)


def _limit(seconds: float) -> None:
    """Ends this process after so many seconds of one core."""
    whole = max(int(np.ceil(seconds)), 1)
    resource.setrlimit(resource.RLIMIT_CPU, (whole, whole))


def _read_hulls(path: Path, tool: str, owner: str) -> tuple[Hull, ...]:
    hulls, flat = [], 0
    with np.load(path) as stored:
        clouds = np.split(stored["vertices"], stored["starts"][1:]) if len(stored["starts"]) else []
    for cloud in clouds:
        try:
            hulls.append(convex_hull(cloud))
        except DegeneratePart:
            flat += 1
    if not hulls:
        raise DecompositionFailed(
            f"{owner}: {tool} gave {flat} hulls, none of which encloses a volume; try --collision auto"
        )
    return tuple(hulls)


def _child(source: Path, target: Path) -> None:
    with np.load(source) as stored:
        vertices, faces = stored["vertices"], stored["faces"]
        settings = json.loads(str(stored["settings"]))
    pieces = _run(settings["tool"], vertices, faces, settings["options"])
    clouds = [np.asarray(piece[0], dtype=np.float64) for piece in pieces]
    starts = np.cumsum([0, *(len(cloud) for cloud in clouds)])[:-1]
    np.savez(target, vertices=np.concatenate(clouds) if clouds else np.zeros((0, 3)), starts=starts)


def _run(tool: str, vertices: np.ndarray, faces: np.ndarray, options: Options) -> list:
    try:
        if tool == "coacd":
            import coacd

            coacd.set_log_level("error")
            return coacd.run_coacd(coacd.Mesh(vertices, faces), **options)
        import vhacdx

        sized = np.column_stack([np.full(len(faces), 3), faces])  # each with its number of corners
        return vhacdx.compute_vhacd(vertices, sized.ravel().astype(np.uint32), **options)
    except TypeError as err:
        sys.exit(str(err).splitlines()[0])


if __name__ == "__main__":
    _child(Path(sys.argv[1]), Path(sys.argv[2]))
