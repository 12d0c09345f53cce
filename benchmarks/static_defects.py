"""The list of seeded defects for checks L0 to L2, by the check that is meant to catch each."""

import json
import xml.etree.ElementTree as ET  # edits files written by ourselves
from pathlib import Path

import numpy as np
from defects import (
    Defect,
    Mutation,
    append,
    chain,
    delete,
    drop,
    edit_faces,
    edit_urdf,
    edit_vertices,
    fill_link,
    find,
    join_files,
    move_joint,
    paint,
    replace_text,
    reverse_face,
    scale_all,
    set_attribute,
    set_uv,
    shift,
    turn_axis,
    write_hull,
)

ROBOT = '<robot name="sample_cabinet">'
BOMB = '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>\n' + ROBOT
DOOR = "link[@name='link_1']"
DRAWER_MESH = "link[@name='link_0']/visual/geometry/mesh"
Vector = tuple[float, float, float]
LOCK: Vector = (-0.243, -0.255, 0.125)
"""Centre of the lock's hull."""
BAR = (-0.275, -0.26)
"""Front and rear of the bar of the door's handle, which overlaps its posts (x, m)."""


def _add_links(robot: ET.Element) -> None:
    for index in range(60):
        ET.SubElement(robot, "link", name=f"extra_{index}")
        joint = ET.SubElement(robot, "joint", name=f"extra_joint_{index}", type="fixed")
        ET.SubElement(joint, "parent", link="link_4")
        ET.SubElement(joint, "child", link=f"extra_{index}")


def _repeat_collision(link: str, count: int) -> Mutation:
    """Adds ``count`` copies of the first hull of a link."""

    def change(robot: ET.Element) -> None:
        owner = find(robot, f"link[@name='{link}']")
        owner.extend([find(owner, "collision")] * count)

    return edit_urdf(change)


def _joint(path: str, **values: str) -> Mutation:
    """Sets attributes of a joint, or of an element in it: ``joint_1/limit``."""
    joint, slash, element = path.partition("/")
    return set_attribute(f"joint[@name='{joint}']{slash}{element}", **values)


def _move_grasps(metres: float) -> Mutation:
    """Moves all grasps along x."""

    def mutate(folder: Path) -> None:
        path = folder / "annotations.json"
        notes = json.loads(path.read_text())
        for grasp in notes["grasps"]["grasps"]:
            grasp["position"][0] += metres
        path.write_text(json.dumps(notes))

    return mutate


def _ball(count: int) -> np.ndarray:
    """Points on a sphere of 4 cm where the lock's hull is."""
    turn = np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    height = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    ring = np.sqrt(1.0 - height**2)
    ball = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    return 0.02 * ball + LOCK


def _slab(x: float, y: float, z: float, center: Vector = LOCK) -> np.ndarray:
    """Corners of a box of these edges."""
    signs = np.stack(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5]), axis=-1).reshape(-1, 3)
    return signs * [x, y, z] + center


def _dent(vertices: np.ndarray) -> np.ndarray:
    moved = vertices.copy()
    moved[0] = 0.3 * vertices[0] + 0.7 * vertices.mean(axis=0)
    return moved


def _inertia(ixx: float, iyy: float, izz: float):
    values = {"ixx": ixx, "iyy": iyy, "izz": izz, "ixy": 0.0, "ixz": 0.0, "iyz": 0.0}
    return set_attribute(f"{DOOR}/inertial/inertia", **{key: f"{value:g}" for key, value in values.items()})


DEFECTS: dict[str, dict[str, Mutation]] = {
    "V001": {
        "XML cut off": replace_text("mobility.urdf", "</robot>", ""),
        "entity bomb": replace_text("mobility.urdf", ROBOT, BOMB),
        "two roots": edit_urdf(lambda robot: robot.append(ET.Element("link", name="stray"))),
        "cycle": _joint("joint_1/parent", link="link_2"),
        "link with two parents": _joint("joint_0/child", link="link_1"),
        "duplicate link name": set_attribute("link[@name='link_3']", name="link_0"),
        "duplicate joint name": _joint("joint_3", name="joint_0"),
        "parent that does not exist": _joint("joint_1/parent", link="link_9"),
    },
    "V002": {
        "limit without effort": edit_urdf(
            lambda robot: find(robot, "joint[@name='joint_0']/limit").attrib.pop("effort")
        ),
    },
    "V003": {
        "missing mesh file": delete("visual/door_link_1_0.obj"),
        "missing hull file": delete("collision/link_1_0.obj"),
        "missing texture": delete("visual/door_link_1_0.png"),
        "dangling path": set_attribute(DRAWER_MESH, filename="visual/nowhere.obj"),
        "absolute path": set_attribute(DRAWER_MESH, filename="/data/drawer.obj"),
        "package path": set_attribute(DRAWER_MESH, filename="package://a/drawer.obj"),
        "escaping path": set_attribute(DRAWER_MESH, filename="../../drawer.obj"),
        "unused file": append("visual/left_over.obj", "v 0 0 0\n"),
    },
    "V004": {
        "screw joint": _joint("joint_1", type="screw"),
        "misspelt joint type": _joint("joint_1", type="hinge"),
    },
    "V005": {
        "NaN limit": _joint("joint_1/limit", upper="nan"),
        "infinite limit": _joint("joint_0/limit", upper="inf"),
        "lower above upper": _joint("joint_1/limit", lower="0", upper="-1.5"),
        "rest pose not closed": _joint("joint_1/limit", lower="-0.4"),
        "revolute without limit": drop("joint[@name='joint_1']", "limit"),
        "range in degrees": _joint("joint_1/limit", upper="90"),
        "drawer longer than object": _joint("joint_0/limit", upper="3.6"),
        "axis not unit": _joint("joint_1/axis", xyz="0 0 -1.01"),
        "axis zero": _joint("joint_0/axis", xyz="0 0 0"),
    },
    "V006": {
        "65 links": edit_urdf(_add_links),
        "97 hulls on a link": _repeat_collision("link_1", 93),
        "257 hulls in all": chain(*(_repeat_collision(f"link_{index}", 85) for index in (0, 1, 4))),
    },
    "V007": {
        "mass of 10 tonnes": set_attribute(f"{DOOR}/inertial/mass", value="10000"),
        "mass in tonnes": set_attribute(f"{DOOR}/inertial/mass", value="0.006"),
        "negative mass": set_attribute(f"{DOOR}/inertial/mass", value="-6"),
        "no mass": drop(DOOR, "inertial"),
    },
    "V008": {
        "zero inertia": _inertia(0, 0, 0),
        "negative inertia": _inertia(0.5, -0.2, 0.3),
        "inertia against the triangle inequality": _inertia(1.0, 0.1, 0.1),
        "centre of mass outside": set_attribute(f"{DOOR}/inertial/origin", xyz="-0.3 0.4 0.5"),
        "centre of mass not a number": set_attribute(f"{DOOR}/inertial/origin", xyz="nan 0 0"),
    },
    "V009": {
        "lengths in inches": scale_all(39.37),
        "metres read as millimetres": scale_all(0.001),
    },
    "V010": {
        "tampered file": append("semantics.txt", "link_9 hinge door\n"),
        "file added": append("visual/late.txt", "added after the manifest\n"),
        "manifest lost": delete("manifest.json"),
    },
    "V101": {
        "open mesh": edit_faces("visual/door_link_1_0.obj", lambda faces: faces[1:]),
        "flipped face": edit_faces(
            "visual/door_link_1_0.obj", lambda faces: [reverse_face(faces[0]), *faces[1:]]
        ),
        "mesh inside out": edit_faces(
            "visual/door_link_1_0.obj", lambda faces: [reverse_face(face) for face in faces]
        ),
        "flat visual": edit_vertices("visual/knob_link_2_0.obj", lambda v: v * [0.0, 1.0, 1.0]),
        "visual full of slivers": edit_vertices("visual/knob_link_2_0.obj", lambda v: v * [1.0, 4e-5, 1.0]),
        "visual of 60,000 faces": edit_faces("visual/knob_link_2_0.obj", lambda faces: faces * 5000),
    },
    "V102": {
        "non-convex hull": edit_vertices("collision/link_1_0.obj", _dent),
        "hull of 80 vertices": write_hull("collision/link_2_0.obj", _ball(80)),
        "oblong hull": write_hull("collision/link_2_0.obj", _slab(0.14, 0.002, 0.002)),
        "paper-thin hull": write_hull("collision/link_2_0.obj", _slab(0.0005, 0.02, 0.02)),
        "two solids in one file": join_files("collision/link_1_2.obj", "collision/link_1_3.obj"),
        "flat hull": edit_vertices("collision/link_2_0.obj", lambda v: v * [0.0, 1.0, 1.0]),
        "visible link without collision": drop("link[@name='link_2']", "collision"),
    },
    "V103": {
        "collision shifted by 5 cm": shift("collision/link_1_*.obj", x=-0.05),
        "collision 20 % too large": edit_vertices("collision/*.obj", lambda v: v * 1.2),
        "filled drawer": fill_link("link_0"),
        "filled body": fill_link("link_4"),
        "board over the drawer": write_hull(
            "collision/link_0_2.obj", _slab(0.4, 0.68, 0.01, (-0.025, 0, 0.47))
        ),
        "handle without collision": write_hull("collision/link_0_6.obj", _slab(0.01, 0.01, 0.01)),
    },
    "V104": {
        "detached part": shift("*/*link_2_*.obj", x=-0.03),
    },
    "V105": {
        "collision above the floor": shift("collision/*.obj", z=0.012),
        "collision below the floor": shift("collision/link_4_*.obj", z=-0.012),
    },
    "V106": {
        "black texture": paint("visual/door_link_1_0.png", (0, 0, 0)),
        "collapsed texture coordinates": set_uv("visual/door_link_1_0.obj", 0.5, 0.5),
        "coordinates beside the texture": set_uv("visual/door_link_1_0.obj", 1.5, 0.5),
    },
    "V107": {
        "handle 3 cm off": shift("visual/handle_link_0_0.obj", x=-0.03),
        "bar off its posts": edit_vertices(
            "*/handle_link_1_0.obj", lambda v: v - [0.02, 0, 0] * np.isin(v[:, :1], BAR)
        ),
        "shelf before the body": shift("visual/shelf_link_4_0.obj", x=-0.6),
        "loose hull": shift("collision/link_0_6.obj", x=-0.04),
    },
    "V201": {
        "door turns through the side": _joint("joint_1/limit", upper="5.2"),
        "drawer slides askew": _joint("joint_0/axis", xyz="-0.96 0.28 0"),
        "post before the drawer": write_hull(
            "collision/link_4_0.obj", _slab(0.02, 0.02, 0.9, (-0.36, 0.3, 0.0))
        ),
        "requirement forgotten": replace_text("annotations.json", '"joint": "joint_3"', '"joint": "joint_2"'),
    },
    "V202": {
        "5 cm overlap with the body": shift("*/*link_0_*.obj", x=0.05),
        "5 cm overlap of neighbours": shift("*/*link_1_*.obj", z=0.05),
    },
    "V203": {
        "flipped axis of a drawer": turn_axis("joint_0"),
        "flipped axis of a door": turn_axis("joint_1"),
        "hinge in the middle of the door": move_joint("joint_1", -0.4),
        "hinge at the other edge": move_joint("joint_1", -0.8),
    },
    "V204": {
        "missing handle visual": chain(
            drop("link[@name='link_0']", "visual[@name='handle_link_0_0']"),
            delete("visual/handle_link_0_0.obj"),
            delete("visual/handle_link_0_0.mtl"),
            delete("visual/handle_link_0_0.png"),
        ),
        "handle inside the drawer": shift("visual/handle_link_0_0.obj", x=0.25),
        "handle a flush plate": edit_vertices(
            "visual/handle_link_0_0.obj",
            lambda v: (v - [-0.275, 0, 0.35]) * [0.04, 1, 5] + [-0.2265, 0, 0.35],
        ),
    },
    "V205": {
        "one leaf opens inwards": turn_axis("joint_2"),
    },
    "V206": {
        "drawer falls out": _joint("joint_0/limit", upper="0.42"),
    },
    "V207": {
        "grasp inside the body": _move_grasps(0.2),
        "grasp beside its handle": _move_grasps(-0.02),
    },
}
"""Mutations by name, by the check meant to catch them."""

STATIC_DEFECTS = tuple(
    Defect(
        name=name,
        check=check,
        mutate=mutate,
        base="double" if check == "V205" else "cabinet",
        reseal=check != "V010",
    )
    for check, named in DEFECTS.items()
    for name, mutate in named.items()
)
