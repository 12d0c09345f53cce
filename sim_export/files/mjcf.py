"""Writes a package as MJCF for MuJoCo, with the same bodies, joints, hulls and masses as the URDF.

Visuals are in group 2 and do not collide; hulls are in group 3. Bodies connected by a joint do not collide,
as in SAPIEN. MuJoCo by itself would let a drawer collide with a carcass that is fixed to the world. Sites in
group 4 mark the handles: x along the grasp line, z away from the panel.

`srdf_text` writes what SAPIEN loads beside the URDF: further pairs of links whose contacts it ignores
(`sim_export.motion.ignored_pairs`).
"""

import xml.etree.ElementTree as ET
from collections import Counter

import numpy as np
from jaxtyping import Float

from artigen.files.mtl import NO_MATERIAL, MtlMaterial
from artigen.shapes.surfaces.physical import mirrored_head_on
from artigen.transforms import frame_along, quat_from_matrix
from artigen.types import Joint
from sim_export.files.obj import parse_mtl, parse_obj, read_image, shininess
from sim_export.files.urdf import (
    format_number,
    format_vector,
    hull_path,
    image_path,
    link_origins,
    visual_path,
    visual_placement,
    xml_text,
)
from sim_export.geometry.primitives import PrimitiveShape, find_primitive
from sim_export.package import Hull, Link, Mesh, SimPackage, SourceMesh, Visual

HULL_FRICTION = "0.8 0.005 0.0001"
MIN_MESH_VERTICES = 4
HARD_REFERENCE = "0.004 1"
HARD_IMPEDANCE = "0.99 0.999 0.0001"
FRICTION_IMPEDANCE = "0.999 0.9999 0.0001"
"""Constraint impedances, which are springs in MuJoCo. With the defaults, a light button on a loaded slide
moves a third of its travel too far and creeps under less force than its friction. These values come close to
other engines; 0.004 s is stable at MuJoCo's default time step and raised by MuJoCo at longer ones. Under a
third of its friction a dial creeps by 0.1 degrees per second with this impedance, and ten times as fast with
that of limits."""
MAX_PAIRS = 31
"""Pairs that SAPIEN accepts; further ones have MoveIt's reason ``Never``, which its loader passes over."""


SERVO = 0.1
"""Share of its range by which a joint is away from a position servo's target when the servo is at its
limit."""


def mjcf_text(
    package: SimPackage, apart: tuple[tuple[str, str], ...] = (), *, actuators: bool = False
) -> str:
    """The MJCF of a package.

    Args:
        package: The package; file names are those of `write_package`.
        apart: Further pairs of links that must not collide (those of the SRDF).
        actuators: Whether every joint has a servo with the joint's name and effort: one of position, or of
            velocity where the joint has no limits. Joints that follow others have none.
    """
    origins = link_origins(package)
    root = ET.Element("mujoco", model=package.name)
    ET.SubElement(root, "compiler", angle="radian", autolimits="true", balanceinertia="false")
    asset = ET.SubElement(root, "asset")
    world = ET.SubElement(root, "worldbody")
    bodies: dict[str, ET.Element] = {}
    by_child = {joint.child: joint for joint in package.joints}
    waiting = list(package.links)
    while waiting:
        ready = [
            link for link in waiting if link.name not in by_child or by_child[link.name].parent in bodies
        ]
        for link in ready:
            joint = by_child.get(link.name)
            holder = world if joint is None else bodies[joint.parent]
            at = origins[link.name] - (0.0 if joint is None else origins[joint.parent])
            body = _add_body(holder, asset, link, joint, at, origins[link.name])
            _add_handles(body, package, link.name, origins[link.name])
            bodies[link.name] = body
        waiting = [link for link in waiting if link.name not in bodies]
    _add_pairs(root, package, apart)
    if actuators:
        _add_actuators(root, package)
    return xml_text(root)


def _add_body(
    holder: ET.Element,
    asset: ET.Element,
    link: Link,
    joint: Joint | None,
    at: Float[np.ndarray, "3"],
    origin: Float[np.ndarray, "3"],
) -> ET.Element:
    body = ET.SubElement(holder, "body", name=link.name, pos=format_vector(at))
    if link.inertial is not None:
        inertia = link.inertial.inertia
        rows, columns = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
        ET.SubElement(
            body,
            "inertial",
            pos=format_vector(link.inertial.com - origin),
            mass=f"{link.inertial.mass:.9g}",
            fullinertia=" ".join(f"{value + 0.0:.9g}" for value in inertia[rows, columns]),
        )
    if joint is not None and joint.type != "fixed":
        _add_joint(body, joint)
    for visual in link.visuals:
        _add_visual(body, asset, visual, origin)
    for index, hull in enumerate(link.hulls):
        _add_hull(body, asset, hull, f"{link.name}_{index}", hull_path(link, index), origin)
    return body


def _add_hull(
    body: ET.Element, asset: ET.Element, hull: Hull, name: str, file: str, origin: Float[np.ndarray, "3"]
) -> None:
    """A collision geom: a box or cylinder where the hull is exactly that, else a mesh."""
    shape = find_primitive(hull)
    if shape is None:
        ET.SubElement(asset, "mesh", name=f"hull_{name}", file=file)
        geom = {"type": "mesh", "mesh": f"hull_{name}", "pos": format_vector(-origin)}
    else:
        geom = primitive_geom(shape, origin)
    style = {"group": "3", "friction": HULL_FRICTION, "mass": "0", "rgba": "0.6 0.6 0.6 0.5"}
    ET.SubElement(body, "geom", {"name": f"collision_{name}"} | geom | style)


def primitive_geom(shape: PrimitiveShape, origin: Float[np.ndarray, "3"]) -> dict[str, str]:
    """Attributes of a geom for a box or cylinder, in a frame with that origin."""
    T = shape.T_object_shape
    halved = [0.5, 0.5, 0.5] if shape.kind == "box" else [1.0, 0.5]
    return {
        "type": shape.kind,
        "size": format_vector(np.array(shape.sizes) * halved),
        "pos": format_vector(T[:3, 3] - origin),
        "quat": format_vector(quat_from_matrix(T[:3, :3]), 12),
    }


def _add_handles(body: ET.Element, package: SimPackage, link: str, origin: Float[np.ndarray, "3"]) -> None:
    """A site in the middle of each grasp line of a link, ``handle_LINK_0`` and so on."""
    for index, handle in enumerate(each for each in package.handles if each.link == link):
        begin, end = handle.grasp_line
        z = handle.normal / np.linalg.norm(handle.normal)
        x = (end - begin) - z * (z @ (end - begin))
        x = x / length if (length := np.linalg.norm(x)) > 1e-6 else frame_along(z)[0]
        attributes = {
            "name": f"handle_{link}_{index}",
            "pos": format_vector((begin + end) / 2.0 - origin),
            "quat": format_vector(quat_from_matrix(np.stack([x, np.cross(z, x), z], axis=1)), 12),
        }
        ET.SubElement(body, "site", attributes | {"group": "4", "size": "0.01"})


def _add_actuators(root: ET.Element, package: SimPackage) -> None:
    """A servo for every joint that moves by itself; damping is integrated implicitly, for light links."""
    root.insert(1, ET.Element("option", integrator="implicitfast"))
    holder = ET.SubElement(root, "actuator")
    for joint in package.joints:
        if joint.type == "fixed" or joint.follows is not None:
            continue
        force = format_number(joint.effort)
        servo = {"name": joint.name, "joint": joint.name, "forcerange": f"-{force} {force}"}
        if joint.type == "continuous":
            speed = format_number(joint.velocity)
            own = {"kv": format_number(joint.effort / joint.velocity), "ctrlrange": f"-{speed} {speed}"}
            ET.SubElement(holder, "velocity", servo | own)
        else:
            kp = joint.effort / (SERVO * (joint.upper - joint.lower))
            own = {"kp": format_number(kp), "dampratio": "1", "inheritrange": "1"}
            ET.SubElement(holder, "position", servo | own)


def _add_joint(body: ET.Element, joint: Joint) -> None:
    attributes = {
        "name": joint.name,
        "type": "slide" if joint.type == "prismatic" else "hinge",
        "axis": format_vector(joint.axis),
        "damping": format_number(joint.damping),
        "frictionloss": format_number(joint.friction),
        "solimpfriction": FRICTION_IMPEDANCE,
    }
    if joint.type != "continuous":
        attributes["range"] = f"{format_number(joint.lower)} {format_number(joint.upper)}"
        attributes |= {"solreflimit": HARD_REFERENCE, "solimplimit": HARD_IMPEDANCE}
    if joint.spring != 0.0:
        attributes |= {"stiffness": format_number(joint.stiffness), "springref": format_number(joint.relaxed)}
    ET.SubElement(body, "joint", attributes)


def _add_visual(body: ET.Element, asset: ET.Element, visual: Visual, origin: Float[np.ndarray, "3"]) -> None:
    """Adds a visual geom with its mesh asset and its texture or colour; source meshes that are too small are
    skipped."""
    xyz, _, scale = visual_placement(visual, origin)
    geom = {"name": visual.name, "type": "mesh", "mesh": visual.name, "pos": format_vector(xyz)}
    mesh = {"name": visual.name, "file": visual_path(visual), "inertia": "shell"}
    if isinstance(visual.mesh, SourceMesh):
        data = parse_obj(visual.mesh.path)
        if len(data.vertices) < MIN_MESH_VERTICES:
            return
        mesh["scale"] = format_vector(np.full(3, scale), 12)
        geom["quat"] = format_vector(quat_from_matrix(visual.mesh.T_object_file[:3, :3]), 12)
        geom["rgba"] = format_vector(np.array([*source_color(visual.mesh), 1.0]), 6)
    else:
        geom["material"] = visual.look
        if all(known.get("name") != visual.look for known in asset.findall("material")):
            _add_material(asset, visual.look, visual.mesh)
    ET.SubElement(asset, "mesh", mesh)
    ET.SubElement(body, "geom", geom | {"group": "2", "contype": "0", "conaffinity": "0", "mass": "0"})


def _add_material(asset: ET.Element, look: str, mesh: Mesh) -> None:
    """A material with its image or colour. MuJoCo's own renderer uses specular and shininess, others metallic
    and roughness."""
    said = mesh.material
    color = np.ones(3) if mesh.texture is not None else np.array(mesh.color)
    values = {
        "rgba": np.array([*color, said.opacity]),
        "specular": np.array([max(mirrored_head_on(said), said.metallic)]),
        "shininess": np.array([min(shininess(said) / 128.0, 1.0)]),
        "metallic": np.array([said.metallic]),
        "roughness": np.array([said.roughness]),
    }
    material = {"name": look} | {key: format_vector(value, 6) for key, value in values.items()}
    if mesh.texture is not None:
        ET.SubElement(asset, "texture", name=look, type="2d", file=image_path(look))
        material["texture"] = look
    ET.SubElement(asset, "material", material)


def source_color(source: SourceMesh) -> tuple[float, float, float]:
    """Colour of the material that covers most faces of a source mesh; the mean colour for an image."""
    data = parse_obj(source.path)
    if not data.libraries or not len(data.faces):
        return NO_MATERIAL
    ((main, _),) = Counter(data.face_materials.tolist()).most_common(1)
    library = source.path.parent / data.libraries[-1]
    said = parse_mtl(library).get(main, MtlMaterial())
    if not said.image:
        return said.color
    red, green, blue = read_image(library.parent / said.image)[..., :3].mean(axis=(0, 1)) / 255.0
    return float(red), float(green), float(blue)


def _add_pairs(root: ET.Element, package: SimPackage, apart: tuple[tuple[str, str], ...]) -> None:
    """Excludes collisions of bodies connected by a joint, and couples followers: the two joints of a screw,
    or a lid and its pedal."""
    contact = ET.SubElement(root, "contact")
    hulls = {link.name for link in package.links if link.hulls}
    joined = [(joint.parent, joint.child) for joint in package.joints]
    for first, second in [*joined, *apart]:
        if first in hulls and second in hulls:
            ET.SubElement(contact, "exclude", body1=first, body2=second)
    mimics = [joint for joint in package.joints if joint.follows is not None]
    if mimics:
        equality = ET.SubElement(root, "equality")
        for joint in mimics:
            assert joint.follows is not None
            ET.SubElement(
                equality,
                "joint",
                joint1=joint.name,
                joint2=joint.follows,
                polycoef=f"{joint.offset:.12g} {joint.ratio:.12g} 0 0 0",
                solref=HARD_REFERENCE,
                solimp=HARD_IMPEDANCE,
            )


def srdf_text(name: str, pairs: tuple[tuple[str, str], ...]) -> str:
    """The SRDF of the robot ``name`` with these pairs; SAPIEN reads those whose ``reason`` is ``Default``."""
    robot = ET.Element("robot", name=name)
    for count, (first, second) in enumerate(pairs):
        reason = "Default" if count < MAX_PAIRS else "Never"
        ET.SubElement(robot, "disable_collisions", link1=first, link2=second, reason=reason)
    return xml_text(robot)
