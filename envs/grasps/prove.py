"""Proves grasps in engines: the best of every handle, until enough of them hold."""

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from sim_export.files.write import write_package
from sim_export.grasps.find import ENOUGH, Found
from sim_export.grasps.gripper import Gripper
from sim_export.package import Grasp, SimPackage

from ..sim.load import EngineName
from .mujoco import MujocoTrials
from .rail import lay_rail
from .sapien import SapienTrials


def prove_grasps(
    package: SimPackage,
    found: Sequence[Found],
    gripper: Gripper,
    engines: Sequence[EngineName],
    folder: Path | None = None,
) -> tuple[Found, ...]:
    """The grasps that were tried, with a proof by every engine; of each stroke those that passed first.

    Trials of a stroke end with `ENOUGH` grasps that pass in all engines. A grasp that fails in one engine is
    not tried in the others.

    Args:
        folder: Folder of the package, if it lies on disk.

    Raises:
        PackageError: If an engine rejects the package.
    """
    if folder is None:
        with tempfile.TemporaryDirectory() as scratch:
            written = write_package(package, Path(scratch) / package.name)
            return prove_grasps(package, found, gripper, engines, written)
    loose = any(each.target.joint is None for each in found)
    stages = []
    if any(each.grasps for each in found):
        for engine in engines:
            if engine == "sapien":
                stages.append(SapienTrials(folder, package, loose=loose))
            else:
                stages.append(MujocoTrials(folder, package, gripper, loose=loose))
    return tuple(replace(each, grasps=_prove(package, each.grasps, stages)) for each in found)


def _prove(
    package: SimPackage, grasps: Sequence[Grasp], stages: Sequence[SapienTrials | MujocoTrials]
) -> tuple[Grasp, ...]:
    tried: list[Grasp] = []
    for grasp in grasps:
        rail, proofs = lay_rail(package, grasp), []
        for stage in stages:
            proofs.append(stage.prove(rail))
            if not proofs[-1].passed:
                break
        tried.append(replace(grasp, proofs=tuple(proofs)))
        if sum(each.proven for each in tried) == ENOUGH:
            break
    return tuple(sorted(tried, key=lambda each: not each.proven))
