"""The sample cabinet as files of other people: a URDF, an object.json; and comparing what comes back."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import trimesh
from sample_cabinet import SAMPLE_PARTS, SamplePart, sample_box_arrays

from artigen.transforms import T_ZUP_FROM_PARTNET
from artigen.types import Part


def assert_same_parts(parts: Sequence[Part], expected: Sequence[Part], atol: float = 1e-6) -> None:
    """Equal tree, labels, joints and boxes; names may differ."""
    assert [part.label for part in parts] == [part.label for part in expected]
    assert [part.parent for part in parts] == [part.parent for part in expected]
    for part, want in zip(parts, expected, strict=True):
        assert part.joint.type == want.joint.type
        np.testing.assert_allclose(part.box, want.box, atol=atol, err_msg=want.name)
        if want.joint.type != "fixed":
            np.testing.assert_allclose(part.joint.axis, want.joint.axis, atol=atol, err_msg=want.name)
            off = np.cross(part.joint.origin - want.joint.origin, want.joint.axis)
            np.testing.assert_allclose(off * (want.joint.type != "prismatic"), 0.0, atol=atol)
            assert part.joint.lower == 0.0
            assert part.joint.upper == pytest.approx(want.joint.upper, abs=atol)


def join(values: object) -> str:
    """Numbers as URDF writes them."""
    return " ".join(f"{value:.12g}" for value in np.ravel(np.asarray(values, dtype=float)) + 0.0)


def urdf(*elements: str, name: str = "thing") -> str:
    """A URDF with these links and joints."""
    return "\n".join([f'<robot name="{name}">', *elements, "</robot>"])


def box_visual(size: object, xyz: object = (0, 0, 0), name: str = "", color: object = (0.7, 0.7, 0.7)) -> str:
    """A visual that is a box."""
    red, green, blue = np.asarray(color, dtype=float)
    return (
        f'<visual name="{name}"><origin xyz="{join(xyz)}"/><geometry><box size="{join(size)}"/></geometry>'
        f'<material name=""><color rgba="{red:.9g} {green:.9g} {blue:.9g} 1"/></material></visual>'
    )


def mesh_visual(file: str, scale: str = "", extra: str = "") -> str:
    """A visual that is a mesh file."""
    said = f' scale="{scale}"' if scale else ""
    return f'<visual><geometry><mesh filename="{file}"{said}/></geometry>{extra}</visual>'


def link(name: str, *shapes: str) -> str:
    """A link."""
    return f'<link name="{name}">{"".join(shapes)}</link>'


def joint(
    kind: str,
    parent: str,
    child: str,
    *,
    xyz: object = (0, 0, 0),
    axis: object = (1, 0, 0),
    limits: tuple[float, float] | None = None,
    extra: str = "",
) -> str:
    """A joint, called after its child."""
    bounds = "" if limits is None else f'<limit lower="{limits[0]:.12g}" upper="{limits[1]:.12g}"/>'
    return (
        f'<joint name="to_{child}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{join(xyz)}"/><axis xyz="{join(axis)}"/>{bounds}{extra}</joint>'
    )


def cabinet_urdf(folder: Path, form: str = "box", R: np.ndarray | None = None) -> Path:
    """The sample cabinet as a URDF in a frame turned by ``R``, its boxes primitives or files of a format."""
    turn = np.eye(3) if R is None else R
    origins = {part.name: np.array(part.origin) for part in SAMPLE_PARTS}
    rows = []
    for part in SAMPLE_PARTS:
        fixed = part.joint == "fixed" and part.parent is not None
        origin = origins[part.parent or part.name] if fixed else origins[part.name]
        origins[part.name] = origin
        rows.append(
            link(part.name, *(_shape(part, k, form, turn, origin, folder) for k in range(len(part.boxes))))
        )
        if part.parent is not None:
            limits = (0.0, part.upper) if part.joint in ("revolute", "prismatic") else None
            rows.append(
                joint(
                    part.joint,
                    part.parent,
                    part.name,
                    xyz=turn @ (origin - origins[part.parent]),
                    axis=turn @ np.array(part.axis),
                    limits=limits,
                )
            )
    path = folder / "sample_cabinet.urdf"
    path.write_text(urdf(*rows, name="sample_cabinet"))
    return path


def _shape(part: SamplePart, k: int, form: str, turn: np.ndarray, origin: np.ndarray, folder: Path) -> str:
    low, high = sample_box_arrays(part)[k]
    size, center = np.abs(turn @ (high - low)), turn @ ((low + high) / 2 - origin)
    color = np.array(part.boxes[k].color) / 255
    if form == "box":
        return box_visual(size, center, color=color)
    mesh = trimesh.creation.box(size)
    mesh.apply_translation(center)
    if form == "glb":  # the only format here that says colours by itself
        material = trimesh.visual.material.PBRMaterial(baseColorFactor=[*part.boxes[k].color, 255])
        mesh.visual = trimesh.visual.TextureVisuals(material=material)
    file = f"{part.name}_{k}.{form}"
    mesh.export(folder / file)
    rgba = f"{color[0]:.9g} {color[1]:.9g} {color[2]:.9g} 1"
    return mesh_visual(file, extra=f'<material name=""><color rgba="{rgba}"/></material>')


def cabinet_acd(folder: Path) -> Path:
    """The sample cabinet as SINGAPO's object.json with meshes: y up, front +z, degrees."""
    names = [part.name for part in SAMPLE_PARTS]
    (folder / "plys").mkdir()
    tree = []
    for index, part in enumerate(SAMPLE_PARTS):
        boxes = sample_box_arrays(part) @ T_ZUP_FROM_PARTNET[:3, :3]
        pieces = [trimesh.creation.box(bounds=np.sort(ends, axis=0)) for ends in boxes]
        trimesh.util.concatenate(pieces).export(folder / "plys" / f"{part.name}.ply")
        ends = boxes.reshape(-1, 3)
        degrees = part.joint in ("revolute", "continuous")
        item = {
            "id": index,
            "name": part.label,
            "parent": -1 if part.parent is None else names.index(part.parent),
            "children": [k for k, other in enumerate(SAMPLE_PARTS) if other.parent == part.name],
            "joint": {
                "type": part.joint,
                "range": [0.0, float(np.degrees(part.upper)) if degrees else part.upper],
                "axis": {
                    "direction": (np.array(part.axis) @ T_ZUP_FROM_PARTNET[:3, :3]).tolist(),
                    "origin": (np.array(part.origin) @ T_ZUP_FROM_PARTNET[:3, :3]).tolist(),
                },
            },
            "aabb": {
                "center": ((ends.min(axis=0) + ends.max(axis=0)) / 2).tolist(),
                "size": np.ptp(ends, axis=0).tolist(),
            },
            "objs": [],
            "plys": [f"plys/{part.name}.ply"],
        }
        tree.append(item)
    path = folder / "object.json"
    path.write_text(json.dumps({"meta": {"obj_cat": "armoire", "tree_hash": "0"}, "diffuse_tree": tree}))
    return path
