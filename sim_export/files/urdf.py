"""Writes a package as URDF text that SAPIEN, ManiSkill, MuJoCo and yourdfpy load unchanged.

Link frames have their origin at the joint and the object's axes. Meshes stay in the object frame, so the
origin of a mesh is minus the joint origin. `<material>` is omitted, because SAPIEN lets it override the
texture. Every hull is its own `<collision>`: a `<box>` or `<cylinder>` if it is exactly one, which engines
accept without cooking, else a mesh file.
"""

import xml.etree.ElementTree as ET  # writing only; reading goes through defusedxml
from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.transforms import rpy_from_matrix
from artigen.types import FULL_TURN, Joint
from sim_export.geometry.primitives import find_primitive
from sim_export.geometry.triangles import diagonal_of
from sim_export.package import Link, SimPackage, SourceMesh, Visual

UrdfVariant = Literal["standard", "maniskill", "glb"]
GLB_URDF = "mobility_glb.urdf"
"""The URDF of a package that shows GLBs."""
DECIMALS = 9


def visual_path(visual: Visual) -> str:
    """Path of a visual's mesh in the package."""
    return f"visual/{visual.name}.obj"


def glb_path(link: str) -> str:
    """Path of the visuals of a link in one GLB."""
    return f"visual/{link}.glb"


def image_path(look: str) -> str:
    """Path of the image of a material in the package."""
    return f"visual/{look}.png"


def normal_path(look: str) -> str:
    """Path of the normal map of a material in the package."""
    return f"visual/{look}_normal.png"


def hull_path(link: Link, index: int) -> str:
    """Path of a collision hull in the package."""
    return f"collision/{link.name}_{index}.obj"


def splats_path(link: str) -> str:
    """Path of a link's Gaussians in the package, in the link's frame; no URDF refers to them."""
    return f"splats/{link}.ply"


def format_number(value: float, decimals: int = DECIMALS) -> str:
    """Fixed decimals without trailing zeros or a negative zero."""
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def format_vector(values: Float[np.ndarray, "N"], decimals: int = DECIMALS) -> str:
    """Numbers separated by spaces."""
    return " ".join(format_number(float(value), decimals) for value in values)


def xml_text(root: ET.Element) -> str:
    """An XML document, indented."""
    ET.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def link_origins(package: SimPackage) -> dict[str, Float[np.ndarray, "3"]]:
    """Origin of every link frame in the object frame at rest."""
    origins = {link.name: np.zeros(3) for link in package.links}
    return origins | {joint.child: np.asarray(joint.origin, np.float64) for joint in package.joints}


def urdf_text(package: SimPackage, variant: UrdfVariant = "standard") -> str:
    """The URDF of a package.

    ``maniskill`` supports ManiSkill's cabinet tasks: continuous joints get limits, screws become one turning
    joint, and every link that slides or turns has a visual named as a handle (its largest one if it has no
    handle part). ``glb`` shows every link by one GLB in its frame, see `sim_export.files.glb.link_glbs`.
    """
    names = {visual.name: visual.name for link in package.links for visual in link.visuals}
    if variant == "maniskill":
        package = _for_maniskill(package)
        names |= _handle_names(package)
    origins = link_origins(package)
    robot = ET.Element("robot", name=package.name)
    compiler = {
        "strippath": "false",
        # MuJoCo rejects flat or open meshes even as visuals, and sources may contain them.
        "discardvisual": "true" if package.visual == "source" else "false",
        "fusestatic": "false",
        "balanceinertia": "false",
    }
    ET.SubElement(ET.SubElement(robot, "mujoco"), "compiler", compiler)
    for link in package.links:
        _add_link(robot, link, origins[link.name], names, variant)
    for joint in package.joints:
        _add_joint(robot, joint, origins[joint.parent])
    return xml_text(robot)


def _add_link(
    robot: ET.Element,
    link: Link,
    origin: Float[np.ndarray, "3"],
    names: dict[str, str],
    variant: UrdfVariant,
) -> None:
    element = ET.SubElement(robot, "link", name=link.name)
    if link.inertial is not None:
        inertial = ET.SubElement(element, "inertial")
        ET.SubElement(inertial, "origin", xyz=format_vector(link.inertial.com - origin), rpy="0 0 0")
        ET.SubElement(inertial, "mass", value=f"{link.inertial.mass:.9g}")
        inertia = link.inertial.inertia
        entries = {
            f"i{'xyz'[i]}{'xyz'[j]}": f"{inertia[i, j] + 0.0:.9g}" for i in range(3) for j in range(i, 3)
        }
        ET.SubElement(inertial, "inertia", entries)
    if variant == "glb" and link.visuals:
        holder = ET.SubElement(element, "visual", name=link.name)
        ET.SubElement(ET.SubElement(holder, "geometry"), "mesh", filename=glb_path(link.name))
    for visual in () if variant == "glb" else link.visuals:
        xyz, rpy, scale = visual_placement(visual, origin)
        holder = ET.SubElement(element, "visual", name=names[visual.name])
        ET.SubElement(holder, "origin", xyz=format_vector(xyz), rpy=format_vector(rpy, 12))
        mesh = ET.SubElement(ET.SubElement(holder, "geometry"), "mesh", filename=visual_path(visual))
        if scale != 1.0:
            mesh.set("scale", format_vector(np.full(3, scale), 12))
    for index, hull in enumerate(link.hulls):
        holder = ET.SubElement(element, "collision", name=f"collision_{link.name}_{index}")
        shape = find_primitive(hull)
        if shape is None:
            ET.SubElement(holder, "origin", xyz=format_vector(-origin), rpy="0 0 0")
            ET.SubElement(ET.SubElement(holder, "geometry"), "mesh", filename=hull_path(link, index))
            continue
        T = shape.T_object_shape
        xyz, rpy = format_vector(T[:3, 3] - origin), format_vector(rpy_from_matrix(T[:3, :3]), 12)
        ET.SubElement(holder, "origin", xyz=xyz, rpy=rpy)
        if shape.kind == "box":
            sizes = {"size": format_vector(np.array(shape.sizes))}
        else:
            sizes = {"radius": format_number(shape.sizes[0]), "length": format_number(shape.sizes[1])}
        ET.SubElement(ET.SubElement(holder, "geometry"), shape.kind, sizes)


def visual_placement(
    visual: Visual, origin: Float[np.ndarray, "3"]
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"], float]:
    """Position, roll-pitch-yaw and scale of a visual's file in its link frame."""
    if not isinstance(visual.mesh, SourceMesh):
        return -origin, np.zeros(3), 1.0
    T = visual.mesh.T_object_file
    return T[:3, 3] - origin, rpy_from_matrix(T[:3, :3]), visual.mesh.scale


def _add_joint(robot: ET.Element, joint: Joint, parent_origin: Float[np.ndarray, "3"]) -> None:
    element = ET.SubElement(robot, "joint", name=joint.name, type=joint.type)
    ET.SubElement(element, "origin", xyz=format_vector(joint.origin - parent_origin), rpy="0 0 0")
    ET.SubElement(element, "parent", link=joint.parent)
    ET.SubElement(element, "child", link=joint.child)
    if joint.type == "fixed":
        return
    ET.SubElement(element, "axis", xyz=format_vector(joint.axis))
    limit = {"effort": format_number(joint.effort), "velocity": format_number(joint.velocity)}
    if joint.type != "continuous":
        limit = {"lower": format_number(joint.lower), "upper": format_number(joint.upper)} | limit
    ET.SubElement(element, "limit", limit)
    ET.SubElement(
        element, "dynamics", damping=format_number(joint.damping), friction=format_number(joint.friction)
    )
    if joint.follows is not None:
        multiplier, offset = f"{joint.ratio:.12g}", f"{joint.offset:.12g}"
        ET.SubElement(element, "mimic", joint=joint.follows, multiplier=multiplier, offset=offset)


def _for_maniskill(package: SimPackage) -> SimPackage:
    """Reduces screws to turning joints and bounds continuous joints."""
    package = turn_screws(package)
    joints = []
    for joint in package.joints:
        if joint.type == "continuous":
            upper = joint.upper if joint.upper > joint.lower else joint.lower + FULL_TURN
            joint = replace(joint, type="revolute", upper=upper)
        joints.append(joint)
    return replace(package, joints=tuple(joints))


def turn_screws(package: SimPackage) -> SimPackage:
    """The package without travel along screws: intermediate links are removed, and the parts only turn.

    For engines in which a sliding joint cannot mimic a turning one.
    """
    travels = {joint.follows: joint for joint in package.joints if joint.is_travel}
    joints = []
    for joint in package.joints:
        if joint.is_travel:
            continue
        child = travels[joint.name].child if joint.name in travels else joint.child
        joints.append(replace(joint, child=child))
    dropped = {joint.parent for joint in travels.values()}
    links = tuple(link for link in package.links if link.name not in dropped)
    return replace(package, links=links, joints=tuple(joints))


def _handle_names(package: SimPackage) -> dict[str, str]:
    """New names for the main visual of each movable link without a visible handle."""
    moving = {joint.child for joint in package.joints if joint.type in ("prismatic", "revolute")}
    out = {}
    for link in package.links:
        if link.name in moving and link.visuals and not any("handle" in v.name for v in link.visuals):
            main = max(link.visuals, key=_visual_size)
            out[main.name] = f"handle_{main.name}"
    return out


def _visual_size(visual: Visual) -> float:
    """Diagonal of a visual's box; for source meshes the size of the file."""
    if isinstance(visual.mesh, SourceMesh):
        return float(visual.mesh.path.stat().st_size)
    return diagonal_of(visual.mesh.vertices)
