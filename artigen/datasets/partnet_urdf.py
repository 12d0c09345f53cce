"""The URDF of a PartNet-Mobility folder: links, joints, and which mesh each link draws.

It is one export of the annotation, and repositories that carry these objects have sometimes edited
it; so it is checked, used to find meshes, and compared with the annotation, but not trusted.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.datasets.partnet_annotation import SourceNode
from artigen.datasets.partnet_joints import joint_kind
from artigen.errors import SourceError
from artigen.transforms import matrix_from_rpy

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

URDF_JOINTS = ("fixed", "revolute", "continuous", "prismatic", "floating", "planar")


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfVisual:
    """A mesh reference: link, visual name, file as written, and its placement at zero joint values."""

    link: str
    name: str
    file: str
    T_base_visual: Float[np.ndarray, "4 4"]


@dataclass(frozen=True, kw_only=True)
class UrdfJoint:
    """A URDF joint."""

    name: str
    type: str
    parent: str
    child: str
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfFile:
    """Relevant contents of a URDF; ``primitives`` names visuals that are not mesh files."""

    links: tuple[str, ...]
    joints: tuple[UrdfJoint, ...]
    visuals: tuple[UrdfVisual, ...]
    primitives: tuple[str, ...]
    T_base_link: dict[str, np.ndarray]


def read_urdf(path: Path) -> UrdfFile:
    """Reads links, joints and visual meshes; refuses entities, cycles and more than one root.

    Raises:
        SourceError: names the element and its value.
    """
    from xml.etree.ElementTree import ParseError

    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        robot = fromstring(path.read_bytes(), forbid_dtd=True)
    except FileNotFoundError as err:
        raise SourceError(f"{path}: file is missing") from err
    except (ParseError, OSError) as err:
        raise SourceError(f"{path}: not valid XML: {err}") from err
    except DefusedXmlException as err:
        raise SourceError(f"{path}: declares a DTD or entities, which are refused: {err}") from err
    links = tuple(_attribute(link, "name", path) for link in robot.iter("link"))
    if len(set(links)) != len(links):
        twice = sorted({name for name in links if links.count(name) > 1})
        raise SourceError(f"{path}: link names occur twice: {', '.join(twice)}")
    joints = tuple(_parse_joint(joint, links, path) for joint in robot.iter("joint"))
    origins = {
        _attribute(joint.find("child"), "link", path): _parse_origin(
            joint, path, f"joint {joint.get('name')!r}"
        )
        for joint in robot.iter("joint")
    }
    T_base_link = _chain(links, joints, origins, path)
    visuals, primitives = [], []
    for link in robot.iter("link"):
        for visual in link.findall("visual"):
            mesh = visual.find("geometry/mesh")
            if mesh is None:
                primitives.append(visual.get("name") or link.get("name", ""))
            else:
                visuals.append(_parse_visual(link.get("name", ""), visual, mesh, T_base_link, path))
    return UrdfFile(
        links=links,
        joints=joints,
        visuals=tuple(visuals),
        primitives=tuple(primitives),
        T_base_link=T_base_link,
    )


EXPECTED_TYPES: dict[str, tuple[str, ...]] = {
    "fixed": ("fixed",),
    "revolute": ("revolute",),
    "prismatic": ("prismatic",),
    "continuous": ("continuous",),
    "screw": ("continuous", "revolute", "prismatic"),
}


def compare_urdf(nodes: tuple[SourceNode, ...], urdf: UrdfFile) -> list[str]:
    """Says where the URDF differs from mobility_v2.json, which is what is used."""
    joints = {joint.child: joint for joint in urdf.joints}
    changed = [
        change
        for node in nodes
        if node.parent != -1 and (change := _compare_joint(node, joints.get(f"link_{node.id}")))
    ]
    notes = []
    if changed:
        notes.append(f"the URDF differs from mobility_v2.json, which was taken: {', '.join(changed)}")
    known = {f"link_{node.id}" for node in nodes} | {"base"}
    known |= {f"link_{node.id}_helper" for node in nodes if node.rotates}
    extra = [link for link in urdf.links if link not in known]
    if extra:
        notes.append(f"the URDF has links that mobility_v2.json does not know: {', '.join(extra)}")
    base = next(node for node in nodes if node.parent == -1)
    expected = urdf.T_base_link.get(f"link_{base.id}")
    if expected is not None:
        shifted = [v.link for v in urdf.visuals if not np.allclose(v.T_base_visual, expected, atol=1e-4)]
        if shifted:
            notes.append(
                f"{len(shifted)} visuals are shifted by the URDF ({', '.join(dict.fromkeys(shifted))}); "
                "they were drawn where their mesh files lie"
            )
    return notes


def _compare_joint(node: SourceNode, joint: UrdfJoint | None) -> str:
    kind = joint_kind(node)
    if joint is None:
        return f"link_{node.id} is missing"
    if joint.type not in EXPECTED_TYPES[kind]:
        return f"link_{node.id} is {joint.type} instead of {kind}"
    if kind in ("revolute", "prismatic"):
        span = abs(node.b - node.a) if kind == "prismatic" else np.radians(abs(node.b - node.a))
        if abs((joint.upper - joint.lower) - span) > 0.01 * span:
            return f"link_{node.id} spans {joint.upper - joint.lower:.4g} instead of {span:.4g}"
    return ""


def _parse_visual(
    link: str, visual: "Element", mesh: "Element", T_base_link: dict[str, np.ndarray], path: Path
) -> UrdfVisual:
    name = visual.get("name") or ""
    where = f"visual {name!r} of link {link!r}"
    if _floats(mesh, "scale", "1 1 1", path, where) != [1.0, 1.0, 1.0]:
        raise SourceError(f"{path}: {where}: mesh scale {mesh.get('scale')!r}, expected 1 1 1")
    return UrdfVisual(
        link=link,
        name=name,
        file=_attribute(mesh, "filename", path),
        T_base_visual=T_base_link[link] @ _parse_origin(visual, path, where),
    )


def _attribute(element: "Element | None", key: str, path: Path) -> str:
    value = None if element is None else element.get(key)
    if not value:
        tag = "element" if element is None else f"<{element.tag}>"
        raise SourceError(f"{path}: a {tag} lacks its {key!r}")
    return value


def _floats(element: "Element", key: str, default: str, path: Path, where: str) -> list[float]:
    text = element.get(key, default)
    try:
        values = [float(word) for word in text.split()]
    except ValueError as err:
        raise SourceError(f"{path}: {where}: {key} {text!r} is not made of numbers") from err
    if len(values) != len(default.split()) or not np.isfinite(values).all():
        raise SourceError(f"{path}: {where}: {key} {text!r}, expected {len(default.split())} finite numbers")
    return values


def _parse_origin(owner: "Element", path: Path, where: str) -> np.ndarray:
    T = np.eye(4)
    origin = owner.find("origin")
    if origin is not None:
        T[:3, :3] = matrix_from_rpy(np.array(_floats(origin, "rpy", "0 0 0", path, where)))
        T[:3, 3] = _floats(origin, "xyz", "0 0 0", path, where)
    return T


def _parse_joint(joint: "Element", links: tuple[str, ...], path: Path) -> UrdfJoint:
    name = _attribute(joint, "name", path)
    kind = _attribute(joint, "type", path)
    if kind not in URDF_JOINTS:
        raise SourceError(f"{path}: joint {name!r}: type {kind!r} is not one of {', '.join(URDF_JOINTS)}")
    ends = [_attribute(joint.find(tag), "link", path) for tag in ("parent", "child")]
    for end in ends:
        if end not in links:
            raise SourceError(f"{path}: joint {name!r}: link {end!r} does not exist")
    limit = joint.find("limit")
    where = f"joint {name!r}"
    lower, upper = (
        (0.0, 0.0)
        if limit is None
        else (_floats(limit, key, "0", path, where)[0] for key in ("lower", "upper"))
    )
    return UrdfJoint(name=name, type=kind, parent=ends[0], child=ends[1], lower=lower, upper=upper)


def _chain(
    links: tuple[str, ...], joints: tuple[UrdfJoint, ...], origins: dict[str, np.ndarray], path: Path
) -> dict[str, np.ndarray]:
    """Placement of every link at zero joint values, which also proves that the links form one tree."""
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
