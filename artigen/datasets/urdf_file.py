"""Reads any URDF as plain values: links, joints, visual and collision shapes.

yourdfpy parses the file after the XML has been checked element by element, so that errors name the element
and its value. Files are untrusted: entities, cycles, several roots and non-finite numbers are refused.
"""

import io
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Float

from artigen.errors import SourceError

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from yourdfpy import urdf as yourdf

URDF_JOINTS = ("fixed", "revolute", "continuous", "prismatic", "floating", "planar")
ShapeKind = Literal["mesh", "box", "cylinder", "sphere"]
SHAPE_NUMBERS: dict[ShapeKind, dict[str, int]] = {
    "mesh": {},
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
}
NUMBERS: dict[tuple[str, str], tuple[int, ...]] = {
    ("origin", "xyz"): (3,),
    ("origin", "rpy"): (3,),
    ("axis", "xyz"): (3,),
    ("limit", "lower"): (1,),
    ("limit", "upper"): (1,),
    ("mimic", "multiplier"): (1,),
    ("mimic", "offset"): (1,),
    ("mesh", "scale"): (1, 3),
    ("color", "rgba"): (4,),
    **{(kind, key): (count,) for kind, keys in SHAPE_NUMBERS.items() for key, count in keys.items()},
}
"""Number of values of these attributes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfShape:
    """A visual or collision element, and its placement at zero joint values.

    ``size`` depends on the kind of primitive: edges, radius and length, or radius.
    """

    link: str
    name: str
    kind: ShapeKind
    T_base_shape: Float[np.ndarray, "4 4"]
    file: str = ""
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    size: tuple[float, ...] = ()
    color: tuple[float, float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class UrdfJoint:
    """A joint of a URDF; missing limits are None."""

    name: str
    type: str
    parent: str
    child: str
    axis: tuple[float, float, float]
    lower: float | None = None
    upper: float | None = None
    mimic: str | None = None
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfFile:
    """The relevant contents of a URDF; joints in file order."""

    name: str
    links: tuple[str, ...]
    joints: tuple[UrdfJoint, ...]
    visuals: tuple[UrdfShape, ...]
    collisions: tuple[UrdfShape, ...]
    T_base_link: dict[str, np.ndarray]

    @property
    def root(self) -> str:
        """The link that is no child."""
        children = {joint.child for joint in self.joints}
        return next(link for link in self.links if link not in children)


def read_urdf(path: Path) -> UrdfFile:
    """Reads links, joints and shapes of one URDF.

    Raises:
        SourceError: If the file is invalid; names the element and its value.
    """
    from yourdfpy import URDF

    content = _read(path)
    _check_elements(_parse_xml(content, path), path)
    robot = URDF.load(io.BytesIO(content), build_scene_graph=False, load_meshes=False).robot
    links = tuple(link.name for link in robot.links)
    joints = tuple(_convert_joint(joint) for joint in robot.joints)
    origins = {joint.child: _origin(joint.origin) for joint in robot.joints}
    T_base_link = _chain(links, joints, origins, path)
    colors = {material.name: material.color for material in robot.materials}
    visuals = [
        _convert_shape(link.name, visual, T_base_link[link.name], colors)
        for link in robot.links
        for visual in link.visuals
    ]
    collisions = [
        _convert_shape(link.name, collision, T_base_link[link.name], {})
        for link in robot.links
        for collision in link.collisions
    ]
    return UrdfFile(
        name=robot.name,
        links=links,
        joints=joints,
        visuals=tuple(visuals),
        collisions=tuple(collisions),
        T_base_link=T_base_link,
    )


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError as err:
        raise SourceError(f"{path}: file is missing") from err
    except OSError as err:
        raise SourceError(f"{path}: cannot be read: {err.strerror}") from err


def _parse_xml(content: bytes, path: Path) -> "Element":
    from xml.etree.ElementTree import ParseError

    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        robot = fromstring(content, forbid_dtd=True)
    except (ParseError, ValueError) as err:
        if isinstance(err, DefusedXmlException):
            raise SourceError(f"{path}: declares a DTD or entities, which are refused: {err}") from err
        raise SourceError(f"{path}: not valid XML: {err}") from err
    if robot.tag != "robot":
        raise SourceError(f"{path}: holds a <{robot.tag}>, expected a <robot>")
    return robot


def _check_elements(robot: "Element", path: Path) -> None:
    """Checks names, types, references and numbers of all elements that are read."""
    _attribute(robot, "name", str(path))
    links = _names(robot.findall("link"), path)
    joints = robot.findall("joint")
    names = _names(joints, path)
    for link in robot.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            _check_shape(shape, f"{path}: {shape.tag} {shape.get('name', '')!r} of link {link.get('name')!r}")
    for joint in joints:
        where = f"{path}: joint {joint.get('name')!r}"
        kind = _attribute(joint, "type", where)
        if kind not in URDF_JOINTS:
            raise SourceError(f"{where}: type {kind!r} is not one of {', '.join(URDF_JOINTS)}")
        for tag in ("parent", "child"):
            end = _attribute(joint.find(tag), "link", where, tag)
            if end not in links:
                raise SourceError(f"{where}: {tag} link {end!r} does not exist")
        mimic = joint.find("mimic")
        if mimic is not None and _attribute(mimic, "joint", where) not in names:
            raise SourceError(f"{where}: mimics joint {mimic.get('joint')!r}, which does not exist")
        _check_numbers(joint.iter(), where)


def _names(elements: list["Element"], path: Path) -> set[str]:
    names = [_attribute(element, "name", str(path)) for element in elements]
    if len(set(names)) != len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise SourceError(f"{path}: {elements[0].tag} names occur twice: {', '.join(twice)}")
    return set(names)


def _check_shape(shape: "Element", where: str) -> None:
    geometry = shape.find("geometry")
    solid = None if geometry is None or not len(geometry) else geometry[0]
    if solid is None:
        raise SourceError(f"{where}: has no geometry, expected one of {', '.join(SHAPE_NUMBERS)}")
    kind: ShapeKind | None = next((known for known in SHAPE_NUMBERS if known == solid.tag), None)
    if kind is None:
        raise SourceError(f"{where}: geometry {solid.tag!r} is not one of {', '.join(SHAPE_NUMBERS)}")
    for key in ("filename",) if kind == "mesh" else SHAPE_NUMBERS[kind]:
        _attribute(solid, key, where)
    _check_numbers(shape.iter(), where)
    lengths = [length for key in SHAPE_NUMBERS[kind] for length in _floats(solid, key)]
    if any(length <= 0.0 for length in lengths):
        raise SourceError(f"{where}: {kind} {dict(solid.attrib)} has no extent, expected lengths above 0")


def _check_numbers(elements: Iterable["Element"], where: str) -> None:
    for element in elements:
        for key, text in element.attrib.items():
            counts = NUMBERS.get((element.tag, key))
            if counts is None:
                continue
            try:
                values = _floats(element, key)
            except ValueError as err:
                raise SourceError(f"{where}: {key} {text!r} is not made of numbers") from err
            endless = element.tag == "limit" and not np.isnan(values).any()
            if len(values) not in counts or not (endless or np.isfinite(values).all()):
                wanted = " or ".join(str(count) for count in counts)
                raise SourceError(f"{where}: {key} {text!r}, expected {wanted} finite numbers")


def _floats(element: "Element", key: str) -> list[float]:
    return [float(word) for word in (element.get(key) or "").replace(",", " ").split()]


def _attribute(element: "Element | None", key: str, where: str, tag: str = "element") -> str:
    value = None if element is None else element.get(key)
    if not value:
        raise SourceError(f"{where}: a <{tag if element is None else element.tag}> lacks its {key!r}")
    return value


def _convert_joint(joint: "yourdf.Joint") -> UrdfJoint:
    limit, mimic = joint.limit, joint.mimic
    x, y, z = (float(value) for value in joint.axis)
    return UrdfJoint(
        name=joint.name,
        type=str(joint.type),
        parent=joint.parent,
        child=joint.child,
        axis=(x, y, z),
        lower=None if limit is None else limit.lower,
        upper=None if limit is None else limit.upper,
        mimic=None if mimic is None else mimic.joint,
        multiplier=1.0 if mimic is None or mimic.multiplier is None else mimic.multiplier,
        offset=0.0 if mimic is None or mimic.offset is None else mimic.offset,
    )


def _convert_shape(
    link: str, shape: "yourdf.Visual | yourdf.Collision", T_base_link: np.ndarray, colors: dict
) -> UrdfShape:
    geometry = shape.geometry
    material = getattr(shape, "material", None)
    color = None if material is None else material.color or colors.get(material.name)
    kind: ShapeKind = next(kind for kind in SHAPE_NUMBERS if getattr(geometry, kind, None) is not None)
    solid = getattr(geometry, kind)
    scale = np.ones(3) if kind != "mesh" or solid.scale is None else np.broadcast_to(solid.scale, 3)
    size = np.concatenate([np.zeros(0), *(np.ravel(getattr(solid, key)) for key in SHAPE_NUMBERS[kind])])
    x, y, z = scale.tolist()
    red, green, blue = (0.0, 0.0, 0.0) if color is None else np.clip(color.rgba[:3], 0.0, 1.0).tolist()
    return UrdfShape(
        link=link,
        name=shape.name or "",
        kind=kind,
        T_base_shape=T_base_link @ _origin(shape.origin),
        file=solid.filename if kind == "mesh" else "",
        scale=(x, y, z),
        size=tuple(size.tolist()),
        color=None if color is None else (red, green, blue),
    )


def _origin(origin: np.ndarray | None) -> np.ndarray:
    return np.eye(4) if origin is None else np.asarray(origin)


def _chain(
    links: tuple[str, ...], joints: tuple[UrdfJoint, ...], origins: dict[str, np.ndarray], path: Path
) -> dict[str, np.ndarray]:
    """Placement of every link at zero joint values; raises unless the links form one tree."""
    above = {joint.child: joint.parent for joint in joints}
    if len(above) != len(joints):
        children = [joint.child for joint in joints]
        twice = sorted({child for child in children if children.count(child) > 1})
        raise SourceError(f"{path}: links with two parents: {', '.join(twice)}")
    roots = [link for link in links if link not in above]
    if len(roots) != 1:
        raise SourceError(f"{path}: {len(roots)} root links ({', '.join(roots) or 'none'}), expected one")
    placed = {roots[0]: np.eye(4)}
    for link in links:
        trail: list[str] = []
        at = link
        while at not in placed:
            if at in trail:
                raise SourceError(f"{path}: links {', '.join(trail)} form a cycle")
            trail.append(at)
            at = above[at]
        for step in reversed(trail):
            placed[step] = placed[above[step]] @ origins[step]
    return placed
