"""Compares loading times of packages whose hulls are boxes and cylinders or mesh files.

    python benchmarks/load_time.py FOLDER... --rounds 5

Every package is loaded as it is and as a copy whose collision shapes are all mesh files, in turns in this
process, without visuals; the ratio of the medians is what counts.
"""

import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import tyro
from defects import mesh_collisions

from envs.sim.urdf_text import physics_urdf
from sim_export.files.folders import find_packages

# mujoco and sapien are compiled modules whose stubs name nothing.
# pyright: reportAttributeAccessIssue=false


def load_mujoco(folder: Path) -> None:
    """Compiles the URDF."""
    import mujoco

    mujoco.MjModel.from_xml_string(physics_urdf(folder / "mobility.urdf", mujoco=True))


def load_sapien(folder: Path) -> None:
    """Parses the URDF and builds the articulation in a scene of its own."""
    import sapien
    from sapien.physx import PhysxCpuSystem, clear_cache

    clear_cache()
    loader = sapien.Scene([PhysxCpuSystem()]).create_urdf_loader()
    loader.load_multiple_collisions_from_file = True
    (folder / "bare.urdf").write_text(physics_urdf(folder / "mobility.urdf"))
    loader.parse(str(folder / "bare.urdf"), str(folder / "mobility.srdf"))[0][0].build()


def seconds(load: Callable[[Path], None], folder: Path) -> float:
    """Wall time of one load."""
    start = time.perf_counter()
    load(folder)
    return time.perf_counter() - start


def main(folders: tyro.conf.Positional[tuple[Path, ...]], rounds: int = 5) -> None:
    """Prints the mean over packages of the median time of both forms, and their ratio.

    Args:
        folders: packages, or folders that hold some at any depth.
        rounds: loads of each form of each package.
    """
    packages = find_packages(folders)
    with tempfile.TemporaryDirectory() as scratch:
        for name, load in (("MuJoCo", load_mujoco), ("SAPIEN", load_sapien)):
            medians = []
            for index, package in enumerate(packages):
                pair = [Path(scratch) / f"{name}_{index}_{form}" for form in ("shapes", "meshes")]
                for folder in pair:
                    shutil.copytree(package, folder)
                mesh_collisions(pair[1])
                times = [[seconds(load, folder) for folder in pair] for _ in range(rounds)]
                medians.append(np.median(times, axis=0))
            shapes, meshes = np.mean(medians, axis=0)
            print(
                f"{name}: {len(packages)} packages, {1e3 * shapes:.1f} ms as they are, {1e3 * meshes:.1f} ms "
                f"as meshes: {meshes / shapes:.2f} times as long"
            )


if __name__ == "__main__":
    tyro.cli(main)
