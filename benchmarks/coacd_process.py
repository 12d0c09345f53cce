"""Runs CoACD in a separate process, which may abort or time out.

``python coacd_process.py IN.npz OUT.npz`` is the child's side.
"""

import json
import logging
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from sim_export.errors import DegeneratePart, ExportError
from sim_export.geometry.hulls import convex_hull
from sim_export.package import Hull, Mesh

logger = logging.getLogger(__name__)


class DecompositionFailed(ExportError):
    """A method gave no hulls."""


@dataclass(frozen=True, kw_only=True)
class CoacdConfig:
    """Parameters of CoACD; the defaults are its own but for the limits of physics engines."""

    threshold: float = 0.05
    """Concavity at which a piece is left alone, relative to the part's size; lower gives more hulls."""
    max_hulls: int = 32
    """Most hulls per part."""
    mcts_iterations: int = 150
    """Search effort per cut; 60 is about twice as fast and finds slightly worse cuts."""
    mcts_nodes: int = 20
    """Cut planes tried per axis."""
    resolution: int = 2000
    """Surface samples per concavity estimate."""
    max_vertices: int = 64
    """Most vertices per hull."""
    seed: int = 0
    """Seed of the search."""
    timeout: float = 60.0
    """Seconds before the process is ended; raise it for meshes of many faces."""


def run_coacd(mesh: Mesh, cfg: CoacdConfig) -> tuple[Hull, ...]:
    """Convex hulls by CoACD.

    Raises:
        DecompositionFailed: if the process aborts, runs out of time or gives no hull.
    """
    with tempfile.TemporaryDirectory(prefix="coacd-") as scratch:
        source, target = Path(scratch) / "in.npz", Path(scratch) / "out.npz"
        np.savez(source, vertices=mesh.vertices, faces=mesh.faces, cfg=json.dumps(asdict(cfg)))
        _run_child(source, target, cfg.timeout, len(mesh.faces))
        return _read_hulls(target)


def _run_child(source: Path, target: Path, timeout: float, faces: int) -> None:
    command = [sys.executable, __file__, str(source), str(target)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
    except subprocess.TimeoutExpired as err:
        raise DecompositionFailed(
            f"CoACD ran longer than {timeout:g} s on a mesh of {faces} faces; simplify the mesh, raise the "
            "timeout or the threshold"
        ) from err
    if done.returncode != 0 or not target.is_file():
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise DecompositionFailed(
            f"CoACD ended with status {done.returncode} on a mesh of {faces} faces ({last[:200]}); "
            "check the mesh for self-intersections"
        )


def _read_hulls(path: Path) -> tuple[Hull, ...]:
    with np.load(path) as stored:
        clouds = np.split(stored["vertices"], stored["starts"][1:]) if len(stored["starts"]) else []
    hulls = []
    for cloud in clouds:
        try:
            hulls.append(convex_hull(cloud))
        except DegeneratePart:
            logger.warning("CoACD gave a flat hull of %d points: left out", len(cloud))
    if not hulls:
        raise DecompositionFailed(f"CoACD gave {len(clouds)} hulls and none encloses a volume")
    return tuple(hulls)


def _child(source: Path, target: Path) -> None:
    import coacd

    with np.load(source) as stored:
        vertices, faces, cfg = stored["vertices"], stored["faces"], json.loads(str(stored["cfg"]))
    coacd.set_log_level("error")
    pieces = coacd.run_coacd(
        coacd.Mesh(vertices, faces),
        threshold=cfg["threshold"],
        max_convex_hull=cfg["max_hulls"],
        mcts_iterations=cfg["mcts_iterations"],
        mcts_nodes=cfg["mcts_nodes"],
        resolution=cfg["resolution"],
        decimate=True,
        max_ch_vertex=cfg["max_vertices"],
        seed=cfg["seed"],
    )
    clouds = [np.asarray(piece[0], dtype=np.float64) for piece in pieces]
    starts = np.cumsum([0, *(len(cloud) for cloud in clouds)])[:-1]
    stacked = np.concatenate(clouds) if clouds else np.zeros((0, 3))
    np.savez(target, vertices=stacked, starts=starts)


if __name__ == "__main__":
    _child(Path(sys.argv[1]), Path(sys.argv[2]))
