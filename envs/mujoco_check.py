"""Compiles the URDF and MJCF of a package with MuJoCo and measures forces at rest."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim_export.errors import PackageError

from .urdf_text import physics_urdf

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false


@dataclass(frozen=True, kw_only=True)
class MujocoResult:
    """``force`` is the sum of absolute constraint forces at rest without gravity (N and N m together);
    ``error`` is the compiler's message if there is no model, ``warnings`` are its warnings."""

    file: str
    force: float
    error: str | None = None
    warnings: tuple[str, ...] = ()


def compile_package(folder: Path) -> tuple[MujocoResult, ...]:
    """Compiles ``mobility.urdf`` and, if it exists, ``mobility.mjcf.xml``."""
    results = [_compile(folder / "mobility.urdf")]
    if (folder / "mobility.mjcf.xml").is_file():
        results.append(_compile(folder / "mobility.mjcf.xml"))
    return tuple(results)


def _compile(path: Path) -> MujocoResult:
    import mujoco

    warnings: list[str] = []
    # Without a custom handler MuJoCo appends its warnings to a file in the working directory.
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(warnings.append)
    try:
        if path.suffix == ".urdf":
            model = mujoco.MjModel.from_xml_string(physics_urdf(path, mujoco=True))
        else:
            model = mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, PackageError) as error:
        return MujocoResult(
            file=path.name, force=np.inf, error=" ".join(str(error).split()), warnings=tuple(warnings)
        )
    finally:
        mujoco.set_mju_user_warning(before)
    # Gravity and springs are off; the remaining forces come from overlaps and violated limits.
    model.opt.gravity[:] = 0.0
    model.jnt_stiffness[:] = 0.0
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    force = float(np.abs(data.qfrc_constraint).sum())
    return MujocoResult(file=path.name, force=force, warnings=tuple(warnings))
