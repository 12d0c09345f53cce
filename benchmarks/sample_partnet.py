"""The sample cabinet in PartNet-Mobility's own format: y up, front +z, centred, half diagonal 1.

The embedded input of the demo, and the proof that the reader gets parts, joints and boxes right.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from sample_cabinet import SAMPLE_PARTS, SampleBox, SamplePart, sample_box_arrays

from artigen.io import whole_folder
from artigen.transforms import T_ZUP_FROM_PARTNET


@dataclass(frozen=True, kw_only=True)
class _SampleNode:
    """A node of the sample's annotation: PartNet's joint and name, and its pieces.

    Each piece is (name, part, numbers of the part's boxes) and becomes one mesh file.
    """

    part: str
    joint: str
    name: str
    parent: int
    semantics: str
    pieces: tuple[tuple[str, str, tuple[int, ...]], ...]


_SAMPLE_NODES: tuple[_SampleNode, ...] = (
    _SampleNode(
        part="drawer",
        joint="slider",
        name="drawer",
        parent=4,
        semantics="slider drawer",
        pieces=(
            ("drawer_side", "drawer", (4,)),
            ("drawer_side", "drawer", (5,)),
            ("drawer_front", "drawer", (0, 2)),
            ("drawer_back", "drawer", (3,)),
            ("drawer_bottom", "drawer", (1,)),
            ("handle", "drawer_handle", (0, 1, 2)),
        ),
    ),
    _SampleNode(
        part="door",
        joint="hinge",
        name="cabinet_door",
        parent=4,
        semantics="hinge rotation_door",
        pieces=(("cabinet_door_surface", "door", (0,)), ("handle", "door_handle", (0, 1, 2))),
    ),
    _SampleNode(
        part="lock",
        joint="hinge",
        name="knob",
        parent=1,
        semantics="hinge knob",
        pieces=(("knob", "lock", (0,)),),
    ),
    _SampleNode(
        part="tray",
        joint="slider",
        name="tray",
        parent=4,
        semantics="slider tray",
        pieces=(("tray", "tray", (0, 1, 2, 3, 4)),),
    ),
    _SampleNode(
        part="body",
        joint="heavy",
        name="cabinet_frame",
        parent=-1,
        semantics="heavy furniture_body",
        pieces=(
            ("vertical_side_panel", "body", (0,)),
            ("vertical_side_panel", "body", (1,)),
            ("top_panel", "body", (2,)),
            ("bottom_panel", "body", (3,)),
            ("back_panel", "body", (4,)),
            ("frame_horizontal_bar", "body", (5,)),
            ("drawer_rails", "body", (6,)),
            ("drawer_rails", "body", (7,)),
            ("shelf", "shelf", (0,)),
        ),
    ),
)
_BOX_QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
"""Corners of the faces of a box, counter-clockwise from outside; corner 4x + 2y + z."""


def write_sample(folder: Path) -> None:
    """Writes the cabinet as a PartNet-Mobility folder, the same bytes every time.

    Reading it gives the parts of `sample_cabinet.sample_asset` back.

    Raises:
        OSError: the disk refuses; nothing is left behind.
    """
    boxes = {part.name: sample_box_arrays(part) for part in SAMPLE_PARTS}
    corners = np.concatenate([array.reshape(-1, 3) for array in boxes.values()])
    low, high = corners.min(axis=0), corners.max(axis=0)
    unit = float(np.linalg.norm(high - low)) / 2  # metres per PartNet length
    with whole_folder(folder) as scratch:
        (scratch / "textured_objs").mkdir()
        nodes, listing, texts = [], [], []
        for index, node in enumerate(_SAMPLE_NODES):
            pieces = []
            for name, part, numbers in node.pieces:
                number = len(listing) + 1
                pieces.append({"id": number, "name": name, "children": []})
                listing.append({"id": number, "name": name, "objs": [f"original-{number}"]})
                chosen = [_part_named(part).boxes[box] for box in numbers]
                _write_mesh(chosen, (low + high) / 2, unit, scratch / "textured_objs", f"original-{number}")
            nodes.append(_annotate(index, node, pieces, (low + high) / 2, unit))
            texts.append(f"link_{index} {node.semantics}")
        bounds = (np.stack([low, high]) - (low + high) / 2) @ T_ZUP_FROM_PARTNET[:3, :3] / unit
        bounding_box = {"min": bounds.min(axis=0).tolist(), "max": bounds.max(axis=0).tolist()}
        meta = {"model_id": "sample_cabinet", "anno_id": "0", "model_cat": "StorageFurniture"}
        tree = [{"id": 0, "name": "cabinet", "children": listing}]
        for name, value in (
            ("mobility_v2.json", nodes),
            ("result.json", tree),
            ("meta.json", meta),
            ("bounding_box.json", bounding_box),
        ):
            (scratch / name).write_text(json.dumps(value) + "\n", encoding="utf-8")
        (scratch / "semantics.txt").write_text("\n".join(texts) + "\n", encoding="utf-8")
        (scratch / "mobility.urdf").write_text(_sample_urdf(nodes), encoding="utf-8")


def _part_named(name: str) -> SamplePart:
    return next(part for part in SAMPLE_PARTS if part.name == name)


def _write_mesh(boxes: list[SampleBox], center: np.ndarray, unit: float, folder: Path, name: str) -> None:
    """One OBJ of boxes with one material per colour, in PartNet's frame."""
    colors = list(dict.fromkeys(box.color for box in boxes))
    lines = [f"mtllib {name}.mtl", f"o {name}"]
    for box in boxes:
        ends = np.array([box.low, box.high])
        for corner in range(8):
            at = np.array([ends[corner >> (2 - axis) & 1, axis] for axis in range(3)])
            x, y, z = (at - center) / unit @ T_ZUP_FROM_PARTNET[:3, :3]
            lines.append(f"v {x:.9f} {y:.9f} {z:.9f}")
    for number, box in enumerate(boxes):
        lines.append(f"usemtl material_{colors.index(box.color)}")
        for quad in _BOX_QUADS:
            a, b, c, d = (8 * number + 1 + corner for corner in quad)
            lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    materials = []
    for number, color in enumerate(colors):
        red, green, blue = (channel / 255 for channel in color)
        materials += [f"newmtl material_{number}", f"Kd {red:.6f} {green:.6f} {blue:.6f}"]
    (folder / f"{name}.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / f"{name}.mtl").write_text("\n".join(materials) + "\n", encoding="utf-8")


def _annotate(
    index: int, node: _SampleNode, pieces: list[dict], center: np.ndarray, unit: float
) -> dict[str, object]:
    """A node of mobility_v2.json: degrees, PartNet lengths, PartNet frame."""
    part = _part_named(node.part)
    data: dict[str, object] = {}
    if node.joint in ("hinge", "slider"):
        origin = (np.array(part.origin) - center) / unit @ T_ZUP_FROM_PARTNET[:3, :3]
        direction = np.array(part.axis) @ T_ZUP_FROM_PARTNET[:3, :3]
        free = part.joint == "continuous"
        reach = 0.0 if free else part.upper / unit if node.joint == "slider" else np.degrees(part.upper)
        data = {
            "axis": {"origin": origin.tolist(), "direction": (direction + 0.0).tolist()},
            "limit": {"a": 0, "b": float(reach), "noLimit": free},
        }
    return {
        "id": index,
        "parent": node.parent,
        "joint": node.joint,
        "name": node.name,
        "parts": pieces,
        "jointData": data,
    }


def _sample_urdf(nodes: list) -> str:
    """The URDF that PartNet-Mobility writes for an annotation."""
    zero = np.zeros(3)
    origins = [np.array(node["jointData"].get("axis", {"origin": zero})["origin"]) for node in nodes]
    lines = ['<?xml version="1.0" ?>', '<robot name="partnet_sample_cabinet">', '\t<link name="base"/>']
    for node, origin in zip(nodes, origins, strict=True):
        index, data = node["id"], node["jointData"]
        lines.append(f'\t<link name="link_{index}">')
        for tag in ("visual", "collision"):
            for piece in node["parts"]:
                name = f' name="{piece["name"]}-{piece["id"]}"' if tag == "visual" else ""
                mesh = f'<mesh filename="textured_objs/original-{piece["id"]}.obj"/>'
                place = f'<origin xyz="{_join_numbers(-origin)}"/>'
                lines.append(f"\t\t<{tag}{name}>{place}<geometry>{mesh}</geometry></{tag}>")
        lines.append("\t</link>")
        if not data:
            kind, parent = "fixed", "base"
            inner = '<origin rpy="1.570796326794897 0 -1.570796326794897" xyz="0 0 0"/>'
        else:
            limit, parent = data["limit"], f"link_{node['parent']}"
            slider = node["joint"] == "slider"
            kind = "prismatic" if slider else "continuous" if limit["noLimit"] else "revolute"
            inner = f'<origin xyz="{_join_numbers(origin - origins[node["parent"]])}"/>'
            inner += f'<axis xyz="{_join_numbers(np.array(data["axis"]["direction"]))}"/>'
            if not limit["noLimit"]:
                upper = limit["b"] if slider else np.radians(limit["b"])
                inner += f'<limit lower="0" upper="{upper:.15g}"/>'
        lines.append(f'\t<joint name="joint_{index}" type="{kind}">{inner}')
        lines.append(f'\t\t<child link="link_{index}"/><parent link="{parent}"/>\n\t</joint>')
    return "\n".join([*lines, "</robot>"]) + "\n"


def _join_numbers(values: np.ndarray) -> str:
    return " ".join(f"{value:.15g}" for value in values + 0.0)
