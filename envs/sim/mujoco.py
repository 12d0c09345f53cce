"""Packages in MuJoCo, whose MJCF states followers, springs, friction and limits: they act in its steps."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim_export.errors import PackageError
from sim_export.package import SimPackage

from ..limits import rest_coordinate
from .mechanism import Mechanism, find_mechanism
from .urdf_text import physics_urdf

if TYPE_CHECKING:
    from mujoco import MjData, MjModel

# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false


@dataclass(frozen=True, kw_only=True, eq=False)
class MujocoPackage:
    """A package in MuJoCo, fixed to the world. ``names`` are its moving joints in the order of ``qpos``."""

    package: SimPackage
    model: "MjModel"
    data: "MjData"
    names: tuple[str, ...]
    mechanism: Mechanism

    def reset(self, coordinates: Mapping[str, float] | None = None) -> None:
        """Poses the object without speed or efforts.

        Args:
            coordinates: Of independent joints by name (m or rad); others are at rest, and followers follow.

        Raises:
            ValueError: If a name is not that of an independent joint.
        """
        import mujoco

        specs = {joint.name: joint for joint in self.package.joints}
        free = [name for name in self.names if specs[name].follows is None]
        for name in coordinates or {}:
            if name not in free:
                known = ", ".join(free) or "none"
                raise ValueError(f"package {self.package.name!r} has no joint {name!r}; it has {known}")
        rest = {name: rest_coordinate(specs[name]) for name in self.names} | dict(coordinates or {})
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self.mechanism.complete(np.array([rest[name] for name in self.names]))
        mujoco.mj_forward(self.model, self.data)

    def step(self, efforts: Mapping[str, float] | None = None) -> None:
        """Performs one step.

        Args:
            efforts: On joints by name (N or N m), which act until others are given; ``None`` gives none.
        """
        import mujoco

        if efforts is not None:
            self.data.qfrc_applied[:] = [efforts.get(name, 0.0) for name in self.names]
        mujoco.mj_step(self.model, self.data)

    def positions(self) -> dict[str, float]:
        """Coordinates of all moving joints by name (m or rad), followers included."""
        return dict(zip(self.names, self.data.qpos.tolist(), strict=True))


def load_mujoco(folder: Path, package: SimPackage, timestep: float) -> MujocoPackage:
    """Loads the MJCF of a package folder, at rest.

    Args:
        package: Content of the folder.
        timestep: Seconds per step.

    Raises:
        PackageError: If MuJoCo cannot compile it.
    """
    import mujoco

    path = folder / "mobility.mjcf.xml"
    try:
        model = compile_model(path)
    except ValueError as error:
        text = " ".join(str(error).split())
        raise PackageError(f"{path}: MuJoCo cannot compile it: {text}; run artigen validate on it") from error
    model.opt.timestep = timestep
    names = tuple(model.joint(index).name for index in range(model.njnt))
    mechanism = find_mechanism(package, names)
    loaded = MujocoPackage(
        package=package, model=model, data=mujoco.MjData(model), names=names, mechanism=mechanism
    )
    loaded.reset()
    return loaded


def compile_model(path: Path, warnings: list[str] | None = None) -> "MjModel":
    """Compiles a URDF, without visuals, or an MJCF.

    MuJoCo keeps meshes and images of every file it compiles, up to half a gigabyte; this clears them.

    Args:
        warnings: Takes the compiler's warnings; without it they are dropped.

    Raises:
        PackageError: If a URDF is no plain, well-formed XML.
        ValueError: If MuJoCo cannot compile it.
    """
    import mujoco

    # Without a custom handler MuJoCo appends its warnings to a file in the working directory.
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning([].append if warnings is None else warnings.append)
    try:
        if path.suffix == ".urdf":
            return mujoco.MjModel.from_xml_string(physics_urdf(path, mujoco=True))
        return mujoco.MjModel.from_xml_path(str(path))
    finally:
        mujoco.set_mju_user_warning(before)
        mujoco.mj_clearCache(mujoco.mj_getCache())
