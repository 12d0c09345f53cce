"""JSON and text files beside the URDF: names, handles, physics, provenance.

`semantics.txt`, `mobility_v2.json`, `meta.json` and `bounding_box.json` follow PartNet-Mobility;
`annotations.json`, `physics.json` and `provenance.json` are ours. Lengths are metres. Everything is given in
the object frame at rest (z up, front -x), which is also the frame of the mesh files.
"""

import json

import numpy as np

from artigen.kind import find_kind
from artigen.types import Joint
from sim_export.errors import PackageError
from sim_export.files.grasp_values import grasps_value
from sim_export.files.rounding import number, rounded
from sim_export.files.urdf import image_path, normal_path
from sim_export.package import (
    HandleAnnotation,
    Link,
    Mesh,
    Requirement,
    SimPackage,
    SourceMesh,
)
from sim_export.physics.inertia import subtree_inertial
from sim_export.physics.materials import MATERIALS, physx_friction_coefficient
from sim_export.physics.phrases import name_parts
from sim_export.topology import find_topology

FORMAT = "artigen-package"
VERSION = 1


def json_text(value: object) -> str:
    """Indented JSON with a final newline; NaN raises an error."""
    return json.dumps(value, indent=1, allow_nan=False) + "\n"


def child_joint(package: SimPackage, link: Link) -> Joint | None:
    """The joint whose child is the link; for a screw its turning joint."""
    by_child = {joint.child: joint for joint in package.joints}
    joint = by_child.get(link.name)
    return by_child[joint.parent] if joint is not None and joint.is_travel else joint


def _semantic_kind(joint: Joint | None) -> str:
    """PartNet-Mobility's word for the motion of a link."""
    if joint is None or joint.type == "fixed":
        return "heavy"
    if joint.kind == "screw":
        return "slider+"
    return "slider" if joint.type == "prismatic" else "hinge"


def _semantic_name(package: SimPackage, link: Link, joint: Joint | None) -> str:
    if joint is None or joint.type == "fixed":
        kind = find_kind(package.category)
        return f"{package.category.lower()}_body" if kind is None else kind.body
    if link.label == "door":
        return "rotation_door" if joint.type != "prismatic" else "translation_door"
    return "part" if link.label in (None, "base") else link.label


def _named_links(package: SimPackage) -> list[tuple[Link, Joint | None]]:
    """Links that represent parts, with the joint that moves them; the root has none."""
    return [(link, child_joint(package, link)) for link in package.links if link.parts]


def semantics_text(package: SimPackage) -> str:
    """One line per link: name, kind of motion, meaning."""
    return "".join(
        f"{link.name} {_semantic_kind(joint)} {_semantic_name(package, link, joint)}\n"
        for link, joint in _named_links(package)
    )


def mobility_json(package: SimPackage) -> str:
    """PartNet-Mobility's `mobility_v2.json`; its ids are the indices of the links, angles are degrees."""
    named = _named_links(package)
    number = {link.name: index for index, (link, _) in enumerate(named)}
    entries = []
    part_id = 0
    for link, joint in named:
        pieces = []
        for part in link.parts:
            label = next((v.label for v in link.visuals if v.part == part), link.label)
            pieces.append({"id": part_id, "name": label, "children": []})
            part_id += 1
        entry = {
            "id": number[link.name],
            "parent": -1,
            "joint": _semantic_kind(joint),
            "name": _semantic_name(package, link, joint),
            "parts": pieces,
            "jointData": {},
        }
        if joint is not None and joint.type != "fixed":
            entry["parent"] = number.get(_part_link(package, joint.parent), -1)
            entry["jointData"] = _joint_data(package, link, joint)
        entries.append(entry)
    return json_text(entries)


def _part_link(package: SimPackage, name: str) -> str:
    """Link of a part; a screw's intermediate link is replaced by the link it carries."""
    for joint in package.joints:
        if joint.is_travel and joint.parent == name:
            return joint.child
    return name


def _joint_data(package: SimPackage, link: Link, joint: Joint) -> dict:
    """Axis and limits; as in the original, a screw has limits in metres for its slide and turns freely."""
    turning = joint.type != "prismatic"
    to_file = 180.0 / np.pi if turning else 1.0
    limit = {
        "a": number(joint.lower * to_file, 6),
        "b": number(joint.upper * to_file, 6),
        "noLimit": joint.type == "continuous",
    }
    travel = next((j for j in package.joints if j.child == link.name and j.is_travel), None)
    if travel is not None:
        limit = {
            "a": number(travel.lower),
            "b": number(travel.upper),
            "noLimit": False,
            "rotates": True,
            "noRotationLimit": joint.type == "continuous",
        }
    axis = joint.axis if travel is None else travel.axis
    return {"axis": {"origin": rounded(joint.origin), "direction": rounded(axis)}, "limit": limit}


def bounding_box_json(package: SimPackage) -> str:
    """Lowest and highest corner of all collision hulls, or of the visuals if there are none."""
    points = [hull.vertices for link in package.links for hull in link.hulls]
    if not points:
        points = [
            visual.mesh.vertices
            for link in package.links
            for visual in link.visuals
            if not isinstance(visual.mesh, SourceMesh)
        ]
    if not points:
        return json_text({})
    stacked = np.concatenate(points)
    return json_text({"min": rounded(stacked.min(axis=0), 6), "max": rounded(stacked.max(axis=0), 6)})


def materials_json(package: SimPackage) -> str:
    """Every material that we made, and the material and finish of every visual.

    Colours are sRGB. A finish is what may be varied: its visuals change together (`artigen.api.restyle`). A
    source's meshes keep their own materials, and have null.
    """
    own = [(visual, visual.mesh) for link in package.links for visual in link.visuals]
    made = {visual.look: mesh for visual, mesh in own if isinstance(mesh, Mesh)}
    materials = {
        look: {
            "color": rounded(_mean_color(mesh), 6),
            "image": None if mesh.texture is None else image_path(look),
            "normal_map": None if mesh.normal_map is None else normal_path(look),
            **{key: value for key, value in vars(mesh.material).items() if key != "name"},
        }
        for look, mesh in sorted(made.items())
    }
    visuals = [
        {
            "link": link.name,
            "visual": visual.name,
            "part": visual.part,
            "finish": visual.finish,
            "material": visual.look if isinstance(visual.mesh, Mesh) else None,
        }
        for link in package.links
        for visual in link.visuals
    ]
    return json_text({"materials": materials, "visuals": visuals})


def _mean_color(mesh: Mesh) -> object:
    return mesh.color if mesh.texture is None else mesh.texture[..., :3].mean(axis=(0, 1)) / 255.0


def meta_json(package: SimPackage) -> str:
    """Name and category of the package, and the parts of each link and visual."""
    links = [
        {
            "name": link.name,
            "label": link.label,
            "parts": list(link.parts),
            "visuals": [
                {
                    "name": visual.name,
                    "part": visual.part,
                    "label": visual.label,
                    "finish": visual.finish,
                    "source": isinstance(visual.mesh, SourceMesh),
                }
                for visual in link.visuals
            ],
            **({} if link.visual_error is None else {"visual_error": number(link.visual_error)}),
        }
        for link in package.links
    ]
    return json_text(
        {
            "format": FORMAT,
            "version": VERSION,
            "model_id": package.name,
            "model_cat": package.category,
            "frame": "z up, front -x, metres",
            "visual": package.visual,
            "topology": find_topology(package),
            "links": links,
            "records": list(package.records),
        }
    )


def annotations_json(package: SimPackage) -> str:
    """Handles, joints that must be open before others can move, and phrases that refer to moving parts."""
    handles = [
        {
            "link": handle.link,
            "part": handle.part,
            "gapart": handle.gapart,
            "center": rounded(np.mean(handle.corners, axis=0)),
            "corners": rounded(handle.corners),
            "normal": rounded(handle.normal),
            "grasp_line": rounded(handle.grasp_line),
            "width": number(handle.width),
            "clearance": number(handle.clearance),
            "opening_direction": rounded(handle.opening_direction),
        }
        for handle in package.handles
    ]
    needs = [
        {"joint": need.joint, "needs": need.needs, "fraction": number(need.fraction)}
        for need in package.requires_open
    ]
    kind = find_kind(package.category)
    noun = package.category.lower() if kind is None else next(iter(kind.nouns))
    said = [
        {"link": part.link, "noun": part.noun, "phrases": list(part.phrases)}
        for part in name_parts(package, noun or "object")
    ]
    frame = {"frame": "object at rest, metres"}
    out = frame | {"handles": handles, "requires_open": needs, "parts": said}
    return json_text(out | ({"grasps": grasps_value(package)} if package.grasps else {}))


def physics_json(package: SimPackage) -> str:
    """Masses, materials and joint resistance, in SI units and as PhysX parameters."""
    links = [
        {"name": link.name, "mass": float(f"{link.inertial.mass:.9g}")}
        for link in package.links
        if link.inertial is not None
    ]
    joints = [
        {
            "name": joint.name,
            "kind": joint.kind,
            "lower": number(joint.lower),
            "upper": number(joint.upper),
            "friction": number(joint.friction),
            "damping": number(joint.damping),
            "physx_friction_coefficient": _coefficient(package, joint),
        }
        | ({"spring": number(joint.spring)} if joint.spring != 0.0 else {})
        for joint in package.joints
        if joint.type != "fixed"
    ]
    used = sorted({material for _, material in package.materials})
    table = {
        name: {
            "density": MATERIALS[name].density,
            "filled": number(MATERIALS[name].filled, 6),
            "static_friction": MATERIALS[name].static_friction,
            "sliding_friction": MATERIALS[name].sliding_friction,
        }
        for name in MATERIALS
        if name in used
    }
    return json_text(
        {"links": links, "joints": joints, "materials": dict(package.materials), "material_table": table}
    )


def _coefficient(package: SimPackage, joint: Joint) -> float | None:
    """Argument for SAPIEN's ``joint.set_friction``; ``None`` if masses are unknown."""
    by_name = {link.name: link for link in package.links}
    if by_name[joint.child].inertial is None:
        return None
    moved = subtree_inertial(package.links, package.joints, joint.child)
    lever = float(np.linalg.norm(moved.com - joint.origin))
    return float(f"{physx_friction_coefficient(joint, moved.mass, lever):.6g}")


def provenance_json(package: SimPackage) -> str:
    """Origin of the object, and versions of the tools that made the package."""
    wrong = next((pair for pair in package.provenance if not isinstance(pair[1], str)), None)
    if wrong is not None:
        raise PackageError(
            f"package {package.name!r}: provenance {wrong[0]!r} is {wrong[1]!r}, expected a text"
        )
    return json_text(dict(package.provenance))


def handles_from_json(value: dict) -> tuple[tuple[HandleAnnotation, ...], tuple[Requirement, ...]]:
    """Parses the output of `annotations_json`."""
    try:
        handles = tuple(
            HandleAnnotation(
                link=entry["link"],
                part=entry["part"],
                corners=np.array(entry["corners"], dtype=np.float64).reshape(8, 3),
                normal=np.array(entry["normal"], dtype=np.float64).reshape(3),
                grasp_line=np.array(entry["grasp_line"], dtype=np.float64).reshape(2, 3),
                width=float(entry["width"]),
                clearance=float(entry["clearance"]),
                opening_direction=np.array(entry["opening_direction"], dtype=np.float64).reshape(3),
                gapart=entry["gapart"],
            )
            for entry in value["handles"]
        )
        needs = tuple(
            Requirement(joint=entry["joint"], needs=entry["needs"], fraction=float(entry["fraction"]))
            for entry in value["requires_open"]
        )
    except (KeyError, TypeError, ValueError) as err:
        raise PackageError(f"annotations.json: does not have the expected structure ({err!r})") from err
    return handles, needs
