"""The list of seeded defects for checks L0 to L2, by the check that is meant to catch each."""

import xml.etree.ElementTree as ET  # edits files written by ourselves

import numpy as np
from defects import (
    Defect,
    append,
    chain,
    collapse_uv,
    delete,
    drop,
    edit_faces,
    edit_urdf,
    edit_vertices,
    fill_link,
    find,
    move_joint,
    paint,
    replace_text,
    reverse_face,
    scale_all,
    set_attribute,
    shift,
    turn_axis,
    write_hull,
)

ROBOT = '<robot name="sample_cabinet">'
BOMB = '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>\n' + ROBOT
DOOR = "link[@name='link_1']"
DRAWER_MESH = "link[@name='link_0']/visual/geometry/mesh"
LIMIT = "joint[@name='{}']/limit"


def _add_links(robot: ET.Element) -> None:
    for index in range(60):
        ET.SubElement(robot, "link", name=f"extra_{index}")
        joint = ET.SubElement(robot, "joint", name=f"extra_joint_{index}", type="fixed")
        ET.SubElement(joint, "parent", link="link_4")
        ET.SubElement(joint, "child", link=f"extra_{index}")


def _repeat_collision(robot: ET.Element) -> None:
    door = find(robot, DOOR)
    for _ in range(93):
        door.append(find(door, "collision"))


def _strip(path: str, *names: str):
    def change(robot: ET.Element) -> None:
        for name in names:
            del find(robot, path).attrib[name]

    return edit_urdf(change)


def _ball(count: int) -> np.ndarray:
    """Points on a sphere of 4 cm where the lock's hull is."""
    turn = np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    height = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    ring = np.sqrt(1.0 - height**2)
    ball = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    return 0.02 * ball + [-0.243, -0.255, 0.125]


def _slab(x: float, y: float, z: float) -> np.ndarray:
    """Corners of a box of these edges where the lock's hull is."""
    signs = np.stack(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5]), axis=-1).reshape(-1, 3)
    return signs * [x, y, z] + [-0.243, -0.255, 0.125]


def _dent(vertices: np.ndarray) -> np.ndarray:
    moved = vertices.copy()
    moved[0] = 0.3 * vertices[0] + 0.7 * vertices.mean(axis=0)
    return moved


def _inertia(ixx: float, iyy: float, izz: float):
    values = {"ixx": ixx, "iyy": iyy, "izz": izz, "ixy": 0.0, "ixz": 0.0, "iyz": 0.0}
    return set_attribute(f"{DOOR}/inertial/inertia", **{key: f"{value:g}" for key, value in values.items()})


FILE_DEFECTS = (
    Defect(name="XML cut off", check="V001", mutate=replace_text("mobility.urdf", "</robot>", "")),
    Defect(
        name="entity bomb",
        check="V001",
        mutate=replace_text("mobility.urdf", ROBOT, BOMB),
    ),
    Defect(
        name="two roots",
        check="V001",
        mutate=edit_urdf(lambda robot: robot.append(ET.Element("link", name="stray"))),
    ),
    Defect(
        name="cycle",
        check="V001",
        mutate=set_attribute("joint[@name='joint_1']/parent", link="link_2"),
    ),
    Defect(
        name="link with two parents",
        check="V001",
        mutate=set_attribute("joint[@name='joint_0']/child", link="link_1"),
    ),
    Defect(
        name="duplicate link name", check="V001", mutate=set_attribute("link[@name='link_3']", name="link_0")
    ),
    Defect(
        name="duplicate joint name",
        check="V001",
        mutate=set_attribute("joint[@name='joint_3']", name="joint_0"),
    ),
    Defect(name="limit without effort", check="V002", mutate=_strip(LIMIT.format("joint_0"), "effort")),
    Defect(name="missing mesh file", check="V003", mutate=delete("visual/door_link_1_0.obj")),
    Defect(name="missing hull file", check="V003", mutate=delete("collision/link_1_0.obj")),
    Defect(name="missing texture", check="V003", mutate=delete("visual/door_link_1_0.png")),
    Defect(
        name="dangling path", check="V003", mutate=set_attribute(DRAWER_MESH, filename="visual/nowhere.obj")
    ),
    Defect(
        name="absolute path", check="V003", mutate=set_attribute(DRAWER_MESH, filename="/data/drawer.obj")
    ),
    Defect(
        name="package path",
        check="V003",
        mutate=set_attribute(DRAWER_MESH, filename="package://a/drawer.obj"),
    ),
    Defect(
        name="escaping path", check="V003", mutate=set_attribute(DRAWER_MESH, filename="../../drawer.obj")
    ),
    Defect(name="unused file", check="V003", mutate=append("visual/left_over.obj", "v 0 0 0\n")),
    Defect(name="screw joint", check="V004", mutate=set_attribute("joint[@name='joint_1']", type="screw")),
    Defect(
        name="misspelt joint type", check="V004", mutate=set_attribute("joint[@name='joint_1']", type="hinge")
    ),
    Defect(name="NaN limit", check="V005", mutate=set_attribute(LIMIT.format("joint_1"), upper="nan")),
    Defect(name="infinite limit", check="V005", mutate=set_attribute(LIMIT.format("joint_0"), upper="inf")),
    Defect(
        name="lower above upper",
        check="V005",
        mutate=set_attribute(LIMIT.format("joint_1"), lower="0", upper="-1.5"),
    ),
    Defect(
        name="rest pose not closed", check="V005", mutate=set_attribute(LIMIT.format("joint_1"), lower="-0.4")
    ),
    Defect(name="revolute without limit", check="V005", mutate=drop("joint[@name='joint_1']", "limit")),
    Defect(name="range in degrees", check="V005", mutate=set_attribute(LIMIT.format("joint_1"), upper="90")),
    Defect(
        name="drawer longer than object",
        check="V005",
        mutate=set_attribute(LIMIT.format("joint_0"), upper="3.6"),
    ),
    Defect(
        name="axis not unit",
        check="V005",
        mutate=set_attribute("joint[@name='joint_1']/axis", xyz="0 0 -1.01"),
    ),
    Defect(name="axis zero", check="V005", mutate=set_attribute("joint[@name='joint_0']/axis", xyz="0 0 0")),
    Defect(name="65 links", check="V006", mutate=edit_urdf(_add_links)),
    Defect(name="97 hulls on a link", check="V006", mutate=edit_urdf(_repeat_collision)),
    Defect(
        name="mass of 10 tonnes", check="V007", mutate=set_attribute(f"{DOOR}/inertial/mass", value="10000")
    ),
    Defect(name="mass in tonnes", check="V007", mutate=set_attribute(f"{DOOR}/inertial/mass", value="0.006")),
    Defect(name="negative mass", check="V007", mutate=set_attribute(f"{DOOR}/inertial/mass", value="-6")),
    Defect(name="no mass", check="V007", mutate=drop(DOOR, "inertial")),
    Defect(name="zero inertia", check="V008", mutate=_inertia(0, 0, 0)),
    Defect(name="negative inertia", check="V008", mutate=_inertia(0.5, -0.2, 0.3)),
    Defect(name="inertia against the triangle inequality", check="V008", mutate=_inertia(1.0, 0.1, 0.1)),
    Defect(
        name="centre of mass outside",
        check="V008",
        mutate=set_attribute(f"{DOOR}/inertial/origin", xyz="-0.3 0.4 0.5"),
    ),
    Defect(name="lengths in inches", check="V009", mutate=scale_all(39.37)),
    Defect(name="metres read as millimetres", check="V009", mutate=scale_all(0.001)),
    Defect(
        name="tampered file",
        check="V010",
        mutate=append("semantics.txt", "link_9 hinge door\n"),
        reseal=False,
    ),
    Defect(name="manifest lost", check="V010", mutate=delete("manifest.json"), reseal=False),
)

SHAPE_DEFECTS = (
    Defect(
        name="open mesh", check="V101", mutate=edit_faces("visual/door_link_1_0.obj", lambda faces: faces[1:])
    ),
    Defect(
        name="flipped face",
        check="V101",
        mutate=edit_faces("visual/door_link_1_0.obj", lambda faces: [reverse_face(faces[0]), *faces[1:]]),
    ),
    Defect(
        name="mesh inside out",
        check="V101",
        mutate=edit_faces("visual/door_link_1_0.obj", lambda faces: [reverse_face(face) for face in faces]),
    ),
    Defect(
        name="flat visual",
        check="V101",
        mutate=edit_vertices("visual/knob_link_2_0.obj", lambda v: v * [0.0, 1.0, 1.0]),
    ),
    Defect(
        name="visual full of slivers",
        check="V101",
        mutate=edit_vertices("visual/knob_link_2_0.obj", lambda v: v * [1.0, 4e-5, 1.0]),
    ),
    Defect(
        name="visual of 60,000 faces",
        check="V101",
        mutate=edit_faces("visual/knob_link_2_0.obj", lambda faces: faces * 5000),
    ),
    Defect(name="non-convex hull", check="V102", mutate=edit_vertices("collision/link_1_0.obj", _dent)),
    Defect(name="hull of 80 vertices", check="V102", mutate=write_hull("collision/link_2_0.obj", _ball(80))),
    Defect(
        name="oblong hull",
        check="V102",
        mutate=write_hull("collision/link_2_0.obj", _slab(0.14, 0.002, 0.002)),
    ),
    Defect(
        name="paper-thin hull",
        check="V102",
        mutate=write_hull("collision/link_2_0.obj", _slab(0.0005, 0.02, 0.02)),
    ),
    Defect(
        name="flat hull",
        check="V102",
        mutate=edit_vertices("collision/link_2_0.obj", lambda v: v * [0.0, 1.0, 1.0]),
    ),
    Defect(
        name="visible link without collision", check="V102", mutate=drop("link[@name='link_2']", "collision")
    ),
    Defect(name="collision shifted by 5 cm", check="V103", mutate=shift("collision/link_1_*.obj", x=-0.05)),
    Defect(
        name="collision 20 % too large",
        check="V103",
        mutate=edit_vertices("collision/*.obj", lambda v: v * 1.2),
    ),
    Defect(name="filled drawer", check="V103", mutate=fill_link("link_0")),
    Defect(name="filled body", check="V103", mutate=fill_link("link_4")),
    Defect(
        name="handle without collision",
        check="V103",
        mutate=write_hull("collision/link_0_6.obj", _slab(0.01, 0.01, 0.01)),
    ),
    Defect(name="detached part", check="V104", mutate=shift("*/*link_2_*.obj", x=-0.03)),
    Defect(name="collision above the floor", check="V105", mutate=shift("collision/*.obj", z=0.012)),
    Defect(name="black texture", check="V106", mutate=paint("visual/door_link_1_0.png", (0, 0, 0))),
    Defect(
        name="collapsed texture coordinates", check="V106", mutate=collapse_uv("visual/door_link_1_0.obj")
    ),
)

ISLAND_DEFECTS = (
    Defect(name="handle 3 cm off", check="V107", mutate=shift("visual/handle_link_0_0.obj", x=-0.03)),
    Defect(name="shelf before the body", check="V107", mutate=shift("visual/shelf_link_4_0.obj", x=-0.6)),
    Defect(name="loose hull", check="V107", mutate=shift("collision/link_0_6.obj", x=-0.04)),
)

MOTION_DEFECTS = (
    Defect(
        name="door turns through the side",
        check="V201",
        mutate=set_attribute(LIMIT.format("joint_1"), upper="5.2"),
    ),
    Defect(
        name="drawer slides askew",
        check="V201",
        mutate=set_attribute("joint[@name='joint_0']/axis", xyz="-0.96 0.28 0"),
    ),
    Defect(
        name="requirement forgotten",
        check="V201",
        mutate=replace_text("annotations.json", '"joint": "joint_3"', '"joint": "joint_2"'),
    ),
    Defect(name="5 cm overlap with the body", check="V202", mutate=shift("*/*link_0_*.obj", x=0.05)),
    Defect(name="5 cm overlap of neighbours", check="V202", mutate=shift("*/*link_1_*.obj", z=0.05)),
    Defect(name="flipped axis of a drawer", check="V203", mutate=turn_axis("joint_0")),
    Defect(name="flipped axis of a door", check="V203", mutate=turn_axis("joint_1")),
    Defect(name="hinge in the middle of the door", check="V203", mutate=move_joint("joint_1", -0.4)),
    Defect(
        name="missing handle visual",
        check="V204",
        mutate=chain(
            drop("link[@name='link_0']", "visual[@name='handle_link_0_0']"),
            delete("visual/handle_link_0_0.obj"),
            delete("visual/handle_link_0_0.mtl"),
            delete("visual/handle_link_0_0.png"),
        ),
    ),
    Defect(name="handle inside the drawer", check="V204", mutate=shift("visual/handle_link_0_0.obj", x=0.25)),
    Defect(
        name="handle a flush plate",
        check="V204",
        mutate=edit_vertices(
            "visual/handle_link_0_0.obj",
            lambda v: (v - [-0.275, 0, 0.35]) * [0.04, 1, 5] + [-0.2265, 0, 0.35],
        ),
    ),
    Defect(name="one leaf opens inwards", check="V205", base="double", mutate=turn_axis("joint_2")),
    Defect(
        name="drawer falls out", check="V206", mutate=set_attribute(LIMIT.format("joint_0"), upper="0.42")
    ),
)

STATIC_DEFECTS = (*FILE_DEFECTS, *SHAPE_DEFECTS, *ISLAND_DEFECTS, *MOTION_DEFECTS)
