"""A package's URDF without visuals and with absolute mesh paths."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, tostring

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import parse

from artigen.errors import explain
from sim_export.errors import PackageError

MUJOCO_SETTINGS = {"strippath": "false", "discardvisual": "true", "fusestatic": "false"}


def physics_urdf(path: Path, *, mujoco: bool = False) -> str:
    """URDF text without visuals and materials, with absolute mesh paths.

    Args:
        mujoco: Also sets MuJoCo options, whose defaults strip folders from mesh paths.

    Raises:
        PackageError: If the file is missing or is not plain, well-formed XML.
    """
    robot = _root(path)
    for material in robot.findall("material"):
        robot.remove(material)
    for link in robot.findall("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    for mesh in robot.iter("mesh"):
        mesh.set("filename", str(path.parent.absolute() / mesh.get("filename", "")))
    if mujoco:
        _child(_child(robot, "mujoco"), "compiler").attrib.update(MUJOCO_SETTINGS)
    return tostring(robot, encoding="unicode")


@contextmanager
def without_visuals(path: Path) -> Iterator[Path]:
    """A temporary file of the same name with the text of `physics_urdf`."""
    with tempfile.TemporaryDirectory() as scratch:
        stripped = Path(scratch) / path.name
        stripped.write_text(physics_urdf(path))
        yield stripped


def _root(path: Path) -> Element:
    try:
        root = parse(path).getroot()
    except (OSError, ParseError, DefusedXmlException) as error:
        raise PackageError(f"{path}: cannot be read: {explain(error)}") from error
    if root is None:
        raise PackageError(f"{path}: contains no element")
    return root


def _child(parent: Element, tag: str) -> Element:
    found = parent.find(tag)
    if found is None:
        found = parent.makeelement(tag, {})
        parent.insert(0, found)
    return found
