"""A URDF as written in the file, valid or not, for the checks.

`read_package` refuses what it cannot use; a check has to say what is wrong. So this reader keeps
NaN limits, axes of any length, unknown joint types, cycles and missing files, and raises only where
there is no XML, no element or no number to speak of.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError

import numpy as np
from jaxtyping import Float

from artigen.transforms import matrix_from_rpy
from sim_export.errors import PackageError


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfShape:
    """One ``<visual>`` or ``<collision>``: a mesh file as written, or a primitive with its sizes (m)."""

    name: str
    kind: str
    file: str
    sizes: tuple[float, ...]
    scale: Float[np.ndarray, "3"]
    T_link_shape: Float[np.ndarray, "4 4"]


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfInertial:
    """``<inertial>`` in link axes; inertia about the centre of mass."""

    mass: float
    com: Float[np.ndarray, "3"]
    inertia: Float[np.ndarray, "3 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfLink:
    """One ``<link>``."""

    name: str
    inertial: UrdfInertial | None
    visuals: tuple[UrdfShape, ...]
    collisions: tuple[UrdfShape, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfJoint:
    """One ``<joint>``; limits are None where the file states none, and any number may be NaN."""

    name: str
    type: str
    parent: str
    child: str
    T_parent_joint: Float[np.ndarray, "4 4"]
    axis: Float[np.ndarray, "3"]
    lower: float | None
    upper: float | None
    mimic: str | None
    mimic_multiplier: float
    effort: float | None = None
    velocity: float | None = None
    friction: float | None = None
    damping: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfFile:
    """All links and joints in file order."""

    path: Path
    links: tuple[UrdfLink, ...]
    joints: tuple[UrdfJoint, ...]


def parse_urdf(path: Path) -> UrdfFile:
    """Reads a URDF without judging it.

    Raises:
        PackageError: if the file cannot be read, is no safe XML, or an element or number is missing.
    """
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        root = fromstring(path.read_bytes())
    except OSError as err:
        raise PackageError(f"{path.name}: cannot be read ({err.strerror})") from err
    except (ParseError, DefusedXmlException, ValueError) as err:
        raise PackageError(f"{path.name}: not well-formed XML ({type(err).__name__}: {err})") from err
    if root.tag != "robot":
        raise PackageError(f"{path.name}: root element <{root.tag}>, expected <robot>")
    return UrdfFile(
        path=path,
        links=tuple(_link(path, element) for element in root.findall("link")),
        joints=tuple(_joint(path, element) for element in root.findall("joint")),
    )


def tree_problems(urdf: UrdfFile) -> list[tuple[str, str]]:
    """What keeps the links from being one tree, as (where, sentence) pairs; empty when they are."""
    problems: list[tuple[str, str]] = []
    links = [link.name for link in urdf.links]
    joints = [joint.name for joint in urdf.joints]
    for kind, names in (("link", links), ("joint", joints)):
        for name in sorted({name for name in names if names.count(name) > 1}):
            problems.append((name, f"{kind} name {name!r} occurs {names.count(name)} times"))
    for joint in urdf.joints:
        for role, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in links:
                problems.append((joint.name, f"joint {joint.name!r} has {role} {name!r}, which is no link"))
    children = [joint.child for joint in urdf.joints]
    for name in sorted({name for name in children if children.count(name) > 1}):
        problems.append((name, f"link {name!r} is the child of {children.count(name)} joints"))
    roots = sorted(set(links) - set(children))
    if len(roots) != 1:
        problems.append(
            (", ".join(roots), f"{len(roots)} root links ({', '.join(roots) or 'none'}), expected one")
        )
    parents = {joint.child: joint.parent for joint in urdf.joints}
    for name in sorted(parents):
        at, seen = parents[name], {name}
        while at in parents and at not in seen:
            seen.add(at)
            at = parents[at]
        if at == name:
            problems.append((name, f"link {name!r} is its own ancestor"))
    return problems


def _floats(text: str, count: int, owner: str) -> np.ndarray:
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError as err:
        raise PackageError(f"{owner} is {text!r}, expected {count} numbers") from err
    if len(values) != count:
        raise PackageError(f"{owner} is {text!r}, expected {count} numbers")
    return values


def _number(element: Element, key: str, owner: str) -> float:
    text = element.get(key)
    if text is None:
        raise PackageError(f"{owner}: <{element.tag}> has no attribute {key!r}")
    return float(_floats(text, 1, f"{owner}: <{element.tag} {key}>")[0])


def _optional(element: Element | None, key: str, owner: str) -> float | None:
    return None if element is None or element.get(key) is None else _number(element, key, owner)


def _origin(element: Element, owner: str) -> np.ndarray:
    T = np.eye(4)
    origin = element.find("origin")
    if origin is not None:
        T[:3, 3] = _floats(origin.get("xyz", "0 0 0"), 3, f"{owner}: <origin xyz>")
        T[:3, :3] = matrix_from_rpy(_floats(origin.get("rpy", "0 0 0"), 3, f"{owner}: <origin rpy>"))
    return T


def _shape(element: Element, owner: str) -> UrdfShape:
    geometry = element.find("geometry")
    shapes: Sequence[Element] = [] if geometry is None else list(geometry)
    if len(shapes) != 1:
        raise PackageError(f"{owner}: <{element.tag}> holds {len(shapes)} shapes, expected one")
    shape = shapes[0]
    file, sizes, scale = "", (), np.ones(3)
    match shape.tag:
        case "mesh":
            file = shape.get("filename", "")
            scale = _floats(shape.get("scale", "1 1 1"), 3, f"{owner}: <mesh scale>")
        case "box":
            sizes = tuple(_floats(shape.get("size", ""), 3, f"{owner}: <box size>").tolist())
        case "cylinder":
            sizes = (_number(shape, "radius", owner), _number(shape, "length", owner))
        case "sphere":
            sizes = (_number(shape, "radius", owner),)
        case _:
            raise PackageError(f"{owner}: shape <{shape.tag}>, expected mesh, box, cylinder or sphere")
    return UrdfShape(
        name=element.get("name", ""),
        kind=shape.tag,
        file=file,
        sizes=sizes,
        scale=scale,
        T_link_shape=_origin(element, owner),
    )


def _inertial(element: Element, owner: str) -> UrdfInertial:
    mass, inertia = element.find("mass"), element.find("inertia")
    if mass is None or inertia is None:
        missing = "mass" if mass is None else "inertia"
        raise PackageError(f"{owner}: <inertial> has no <{missing}>")
    T = _origin(element, owner)
    xx, xy, xz, yy, yz, zz = (
        _number(inertia, key, owner) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return UrdfInertial(
        mass=_number(mass, "value", owner), com=T[:3, 3], inertia=T[:3, :3] @ tensor @ T[:3, :3].T
    )


def _link(path: Path, element: Element) -> UrdfLink:
    name = element.get("name", "")
    owner = f"{path.name}: link {name!r}"
    inertial = element.find("inertial")
    return UrdfLink(
        name=name,
        inertial=None if inertial is None else _inertial(inertial, owner),
        visuals=tuple(_shape(shape, owner) for shape in element.findall("visual")),
        collisions=tuple(_shape(shape, owner) for shape in element.findall("collision")),
    )


def _joint(path: Path, element: Element) -> UrdfJoint:
    name = element.get("name", "")
    owner = f"{path.name}: joint {name!r}"
    ends = {}
    for role in ("parent", "child"):
        end = element.find(role)
        if end is None or end.get("link") is None:
            raise PackageError(f"{owner}: has no <{role} link>")
        ends[role] = end.get("link", "")
    axis, limit, mimic = element.find("axis"), element.find("limit"), element.find("mimic")
    limits: list[float | None] = [None, None]
    if limit is not None:
        # URDF: a limit that is not stated is 0.
        limits = [
            float(_floats(limit.get(k, "0"), 1, f"{owner}: <limit {k}>")[0]) for k in ("lower", "upper")
        ]
    multiplier = 1.0 if mimic is None else float(mimic.get("multiplier", "1"))
    dynamics = element.find("dynamics")
    return UrdfJoint(
        name=name,
        type=element.get("type", ""),
        parent=ends["parent"],
        child=ends["child"],
        T_parent_joint=_origin(element, owner),
        axis=_floats("1 0 0" if axis is None else axis.get("xyz", ""), 3, f"{owner}: <axis xyz>"),
        lower=limits[0],
        upper=limits[1],
        mimic=None if mimic is None else mimic.get("joint", ""),
        mimic_multiplier=multiplier,
        effort=_optional(limit, "effort", owner),
        velocity=_optional(limit, "velocity", owner),
        friction=_optional(dynamics, "friction", owner),
        damping=_optional(dynamics, "damping", owner),
    )
