"""A URDF as written in the file, valid or not.

Readers of objects reject invalid files, but a check must report what is wrong. This parser therefore keeps
NaN limits, axes of any length, unknown joint types, cycles and missing files. It raises only for unsafe or
missing XML, and for missing elements or numbers. Files are untrusted: entities are refused.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np
from jaxtyping import Float

from artigen.errors import SourceError
from artigen.files.safe_xml import parse_xml, read_xml
from artigen.transforms import matrix_from_rpy

EXPRESSION = re.compile(rb"""\$(?:\([a-z]+ [^)"]*\)|\{[^}"]+\})""")
"""An expression that xacro replaces."""
Rgba = tuple[float, float, float, float]
"""Red, green, blue and opacity in [0, 1]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfShape:
    """One ``<visual>`` or ``<collision>``: a mesh file as written, or a primitive with its sizes (m)."""

    link: str
    name: str
    kind: str
    """``mesh``, ``box``, ``cylinder``, ``capsule`` or ``sphere``."""
    T_link_shape: Float[np.ndarray, "4 4"]
    file: str = ""
    sizes: tuple[float, ...] = ()
    """Edges, radius and length, or radius."""
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    color: tuple[float, float, float] | None = None
    """Colour of its material in [0, 1], if one is given."""
    opacity: float = 1.0
    """That of its material: 1 hides what is behind, 0 hides nothing."""
    texture: str = ""
    """Image of its material as written."""


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
    """One ``<joint>``; limits are None if missing, and any number may be NaN."""

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
    mimic_offset: float
    effort: float | None = None
    velocity: float | None = None
    friction: float | None = None
    damping: float | None = None


def weld(name: str, parent: str = "", child: str = "") -> UrdfJoint:
    """A fixed joint whose frames coincide."""
    return UrdfJoint(
        name=name,
        type="fixed",
        parent=parent,
        child=child,
        T_parent_joint=np.eye(4),
        axis=np.array([1.0, 0.0, 0.0]),
        lower=None,
        upper=None,
        mimic=None,
        mimic_multiplier=1.0,
        mimic_offset=0.0,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfFile:
    """All links and joints in file order."""

    path: Path
    name: str
    links: tuple[UrdfLink, ...]
    joints: tuple[UrdfJoint, ...]


def is_xacro(path: Path) -> bool:
    """Whether a file holds expressions that xacro replaces."""
    try:
        return EXPRESSION.search(path.read_bytes()) is not None
    except OSError:
        return False


def parse_urdf(path: Path, owner: str = "", *, inertials: bool = True, text: str | None = None) -> UrdfFile:
    """Parses a URDF without validating it.

    Args:
        owner: How errors name the file; by default by its path.
        inertials: Whether mass properties are read.
        text: What the file stands for, if it is not what it holds.

    Raises:
        SourceError: If the file cannot be read, is not safe XML, or lacks an element or number.
    """
    owner = owner or str(path)
    robot = read_xml(path, owner)[0] if text is None else parse_xml(text, owner)
    if robot.tag != "robot":
        raise SourceError(f"{owner}: root element <{robot.tag}>, expected <robot>")
    named = [*robot.findall("link//material"), *robot.findall("material")]  # those of the robot count first
    looks = {
        material.get("name", ""): look for material in named if (look := _look(material, owner)) != _Look()
    }
    return UrdfFile(
        path=path,
        name=robot.get("name", ""),
        links=tuple(_link(owner, one, looks, inertials=inertials) for one in robot.findall("link")),
        joints=tuple(_joint(owner, element) for element in robot.findall("joint")),
    )


def tree_problems(urdf: UrdfFile) -> list[tuple[str, str]]:
    """Reasons why the links are not one tree, as (location, sentence) pairs; empty for a tree."""
    problems: list[tuple[str, str]] = []
    links = [link.name for link in urdf.links]
    joints = [joint.name for joint in urdf.joints]
    for kind, names in (("link", links), ("joint", joints)):
        for name, count in sorted(Counter(names).items()):
            if count > 1:
                problems.append((name, f"{kind} name {name!r} occurs {count} times"))
    known = set(links)
    for joint in urdf.joints:
        for role, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in known:
                problems.append((joint.name, f"joint {joint.name!r} has {role} {name!r}, which is no link"))
    children = Counter(joint.child for joint in urdf.joints)
    for name, count in sorted(children.items()):
        if count > 1:
            problems.append((name, f"link {name!r} is the child of {count} joints"))
    roots = sorted(known - set(children))
    if len(roots) != 1:
        problems.append(
            (", ".join(roots), f"{len(roots)} root links ({', '.join(roots) or 'none'}), expected one")
        )
    parents = {joint.child: joint.parent for joint in urdf.joints}
    ends: dict[str, str] = {}
    for name in sorted(parents):
        at, path = name, dict[str, None]()
        while at in parents and at not in path and at not in ends:
            path[at] = None
            at = parents[at]
        if at in path:
            circle = list(path)[list(path).index(at) :]
            problems += [(link, f"link {link!r} is its own ancestor") for link in sorted(circle)]
        ends |= dict.fromkeys(path, at)
    return problems


def rest_poses(urdf: UrdfFile) -> dict[str, Float[np.ndarray, "4 4"]]:
    """Pose of every link of a tree in the frame of its root, with all joints at 0; parents first."""
    return place_links([link.name for link in urdf.links], urdf.joints)


def place_links(links: Sequence[str], joints: Sequence[UrdfJoint]) -> dict[str, Float[np.ndarray, "4 4"]]:
    """The same for links and joints; in file order, but for parents that are named after their children."""
    above = {joint.child: number for number, joint in enumerate(joints)}
    below: dict[str, list[UrdfJoint]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
    poses = {link: np.eye(4) for link in links if link not in above}
    # Times that the file is read through until a link is placed, and its line.
    order: dict[str, tuple[int, int]] = dict.fromkeys(poses, (0, -1))
    waiting = list(poses)
    for parent in waiting:
        for joint in below.get(parent, ()):
            if joint.child not in poses:
                rounds, place = order[parent]
                number = above[joint.child]
                order[joint.child] = (rounds + (number < place), number)
                poses[joint.child] = poses[parent] @ joint.T_parent_joint
                waiting.append(joint.child)
    return {link: poses[link] for link in sorted(poses, key=order.__getitem__)}


def _floats(text: str, count: int, owner: str) -> np.ndarray:
    try:
        values = np.array([float(word) for word in text.replace(",", " ").split()])
    except ValueError as err:
        raise SourceError(f"{owner} is {text!r}, expected {count} numbers") from err
    if len(values) != count:
        raise SourceError(f"{owner} is {text!r}, expected {count} numbers")
    return values


def _number(element: Element, key: str, owner: str) -> float:
    text = element.get(key)
    if text is None:
        raise SourceError(f"{owner}: <{element.tag}> has no attribute {key!r}")
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


class _Look(NamedTuple):
    rgba: Rgba | None = None
    texture: str = ""


def _look(material: Element | None, owner: str) -> _Look:
    """The colour with opacity, and the image, that a ``<material>`` gives itself."""
    if material is None:
        return _Look()
    said, image = material.find("color"), material.find("texture")
    rgba = None
    if said is not None and said.get("rgba") is not None:
        red, green, blue, opacity = np.clip(
            _floats(said.get("rgba", ""), 4, f"{owner}: <color rgba>"), 0, 1
        ).tolist()
        rgba = (red, green, blue, opacity)
    return _Look(rgba=rgba, texture="" if image is None else image.get("filename", ""))


def _shape(element: Element, link: str, owner: str, looks: Mapping[str, _Look]) -> UrdfShape:
    shapes = element.findall("geometry/*")
    if len(shapes) != 1:
        raise SourceError(f"{owner}: <{element.tag}> holds {len(shapes)} shapes, expected one")
    shape = shapes[0]
    sizes, scale = (), np.ones(3)
    match shape.tag:
        case "mesh":
            text = shape.get("scale", "1 1 1")
            scale = _floats(
                " ".join([text] * 3) if len(text.split()) == 1 else text, 3, f"{owner}: <mesh scale>"
            )
        case "box":
            sizes = tuple(_floats(shape.get("size", ""), 3, f"{owner}: <box size>").tolist())
        case "cylinder" | "capsule":
            sizes = (_number(shape, "radius", owner), _number(shape, "length", owner))
        case "sphere":
            sizes = (_number(shape, "radius", owner),)
        case _:
            raise SourceError(
                f"{owner}: shape <{shape.tag}>, expected mesh, box, cylinder, capsule or sphere"
            )
    material = element.find("material")
    look = _look(material, owner)
    if material is not None and look == _Look():
        look = looks.get(material.get("name", ""), look)
    x, y, z = scale.tolist()
    return UrdfShape(
        link=link,
        name=element.get("name", ""),
        kind=shape.tag,
        T_link_shape=_origin(element, owner),
        file=shape.get("filename", ""),
        sizes=sizes,
        scale=(x, y, z),
        color=None if look.rgba is None else look.rgba[:3],
        opacity=1.0 if look.rgba is None else look.rgba[3],
        texture=look.texture,
    )


def _inertial(element: Element, owner: str) -> UrdfInertial:
    mass, inertia = element.find("mass"), element.find("inertia")
    if mass is None or inertia is None:
        missing = "mass" if mass is None else "inertia"
        raise SourceError(f"{owner}: <inertial> has no <{missing}>")
    T = _origin(element, owner)
    xx, xy, xz, yy, yz, zz = (
        _number(inertia, key, owner) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return UrdfInertial(
        mass=_number(mass, "value", owner), com=T[:3, 3], inertia=T[:3, :3] @ tensor @ T[:3, :3].T
    )


def _link(file: str, element: Element, looks: Mapping[str, _Look], *, inertials: bool) -> UrdfLink:
    name = element.get("name", "")
    owner = f"{file}: link {name!r}"
    inertial = element.find("inertial") if inertials else None
    visuals, collisions = (
        tuple(_shape(shape, name, owner, looks) for shape in element.findall(tag))
        for tag in ("visual", "collision")
    )
    return UrdfLink(
        name=name,
        inertial=None if inertial is None else _inertial(inertial, owner),
        visuals=visuals,
        collisions=collisions,
    )


def _joint(file: str, element: Element) -> UrdfJoint:
    name = element.get("name", "")
    owner = f"{file}: joint {name!r}"
    ends = {}
    for role in ("parent", "child"):
        end = element.find(role)
        if end is None or end.get("link") is None:
            raise SourceError(f"{owner}: has no <{role} link>")
        ends[role] = end.get("link", "")
    axis, limit, mimic = element.find("axis"), element.find("limit"), element.find("mimic")
    limits: list[float | None] = [None, None]
    if limit is not None:
        # In URDF a missing limit is 0.
        limits = [_optional(limit, key, owner) or 0.0 for key in ("lower", "upper")]
    given = [_optional(mimic, key, owner) for key in ("multiplier", "offset")]
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
        mimic_multiplier=1.0 if given[0] is None else given[0],
        mimic_offset=given[1] or 0.0,
        effort=_optional(limit, "effort", owner),
        velocity=_optional(limit, "velocity", owner),
        friction=_optional(dynamics, "friction", owner),
        damping=_optional(dynamics, "damping", owner),
    )
