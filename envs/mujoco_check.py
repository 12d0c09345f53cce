"""A second engine's opinion on a package: MuJoCo compiles its URDF and MJCF and finds nothing to push apart."""

from dataclasses import dataclass
from pathlib import Path

import defusedxml.ElementTree as DET  # noqa: N817 - the usual short name of an element tree module
import numpy as np
from defusedxml import DefusedXmlException

READER_SETTINGS = {"strippath": "false", "discardvisual": "true", "fusestatic": "false"}


@dataclass(frozen=True, kw_only=True)
class MujocoResult:
    """``force`` is the sum of absolute constraint forces at rest without gravity (N and N m together);
    ``error`` is the compiler's sentence where there is no model."""

    file: str
    force: float = 0.0
    error: str | None = None


def compile_package(folder: Path) -> tuple[MujocoResult, ...]:
    """Compiles ``mobility.urdf`` and, where there is one, ``mobility.mjcf.xml``."""
    results = [_compile(folder / "mobility.urdf")]
    if (folder / "mobility.mjcf.xml").is_file():
        results.append(_compile(folder / "mobility.mjcf.xml"))
    return tuple(results)


def _compile(path: Path) -> MujocoResult:
    import mujoco

    try:
        if path.suffix == ".urdf":
            model = mujoco.MjModel.from_xml_string(_readable_urdf(path))
        else:
            model = mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, OSError, DET.ParseError, DefusedXmlException) as error:
        return MujocoResult(file=path.name, error=" ".join(str(error).split()))
    # Weight is off: what is left are forces of overlap and of limits that rest violates.
    model.opt.gravity[:] = 0.0
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return MujocoResult(file=path.name, force=float(np.abs(data.qfrc_constraint).sum()))


def _readable_urdf(path: Path) -> str:
    """The URDF with absolute mesh paths and drawing left out: MuJoCo strips folders from paths unless
    told otherwise, and a check of mechanics has no use for pictures."""
    robot = DET.parse(path).getroot()
    settings = robot.find("mujoco")
    if settings is None:
        settings = robot.makeelement("mujoco", {})
        robot.insert(0, settings)
    compiler = settings.find("compiler")
    if compiler is None:
        compiler = settings.makeelement("compiler", {})
        settings.append(compiler)
    for key, value in READER_SETTINGS.items():
        compiler.set(key, value)
    for link in robot.findall("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    for mesh in robot.iter("mesh"):
        mesh.set("filename", str(path.parent.absolute() / mesh.get("filename", "")))
    return DET.tostring(robot, encoding="unicode")
