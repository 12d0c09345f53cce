"""Two exact cabinets as packages, whose boxes are both hulls and visuals.

`cabinet` is the embedded sample; `double` has two doors instead of one, mirror images of each other.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from sample_cabinet import SAMPLE_PARTS, SamplePart, sample_box_arrays

from artigen.types import FIXED, Asset, Joint, Part
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull
from sim_export.grasps.find import find_grasps
from sim_export.grasps.gripper import FRANKA
from sim_export.motion.requirements import find_requirements
from sim_export.package import Hull, Mesh, SimPackage
from sim_export.physics.annotations import annotate_handles
from sim_export.physics.inertia import combine, mesh_inertial
from sim_export.physics.links import PartGeometry, build_links

DENSITY = 600.0
GAP = 5e-4
"""Every moving box is this much (m) smaller on all sides, so that nothing touches."""


def double_door_parts() -> tuple[SamplePart, ...]:
    """The sample with its door, handle and lock cut in two leaves that open away from each other."""
    by_name = {part.name: part for part in SAMPLE_PARTS}
    leaves = []
    for side, sign in (("left", 1.0), ("right", -1.0)):
        leaf = f"{side}_door"
        edges = sorted((sign * 0.40, sign * 0.002))
        door = by_name["door"].boxes[0]
        grip = sorted((sign * 0.03, sign * 0.05))
        leaves.append(
            replace(
                by_name["door"],
                name=leaf,
                boxes=(replace(door, low=(-0.25, edges[0], 0.05), high=(-0.23, edges[1], 0.71)),),
                axis=(0.0, 0.0, -sign),
                origin=(-0.25, sign * 0.40, 0.0),
            )
        )
        boxes = tuple(
            replace(box, low=(box.low[0], grip[0], box.low[2]), high=(box.high[0], grip[1], box.high[2]))
            for box in by_name["door_handle"].boxes
        )
        leaves.append(replace(by_name["door_handle"], name=f"{side}_handle", parent=leaf, boxes=boxes))
    kept = [part for part in SAMPLE_PARTS if part.name not in ("door", "door_handle", "lock")]
    return (*kept, *leaves)


def as_asset(parts: Sequence[SamplePart]) -> Asset:
    """Sample parts at one metre per unit, centred, without surface or voxels."""
    low, high = _bounds(parts)
    names = [part.name for part in parts]
    out = []
    for part in parts:
        boxes = sample_box_arrays(part) - (low + high) / 2.0
        joint = FIXED
        if part.joint != "fixed":
            origin = np.array(part.origin) - (low + high) / 2.0
            joint = Joint(type=part.joint, axis=np.array(part.axis), origin=origin, upper=part.upper)
        corners = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        out.append(
            Part(
                name=part.name,
                label=part.label,
                parent=-1 if part.parent is None else names.index(part.parent),
                joint=joint,
                box=np.stack([(corners[0] + corners[1]) / 2.0, corners[1] - corners[0]]),
            )
        )
    return Asset(name="sample_cabinet", category="StorageFurniture", scale=1.0, parts=tuple(out))


def build_package(parts: Sequence[SamplePart]) -> SimPackage:
    """Hulls, closed textured meshes, masses, handles and requirements of sample parts."""
    asset = as_asset(parts)
    low, high = _bounds(parts)
    center = (low + high) / 2.0
    geometry, meshes = [], []
    for part in parts:
        shrink = 0.0 if part.joint == "fixed" else GAP
        hulls = tuple(box_hull(a - center + shrink, b - center - shrink) for a, b in sample_box_arrays(part))
        meshes.append(_paint(_boxes(hulls), part.boxes[0].color))
        inertial = combine([mesh_inertial(hull, DENSITY) for hull in hulls])
        geometry.append(PartGeometry(visuals=(meshes[-1],), hulls=hulls, inertial=inertial))
    tree = build_links(asset, geometry)
    return SimPackage(
        name=asset.name,
        category=asset.category,
        visual="voxels",
        links=tree.links,
        joints=tree.joints,
        handles=annotate_handles(asset, meshes, tree),
        requires_open=find_requirements(tree.links, tree.joints),
        records=tree.records,
    )


def write_samples(folder: Path) -> dict[str, Path]:
    """Writes both cabinets below a folder, with the best grasp of every handle."""
    written = {}
    for name, parts in (("cabinet", SAMPLE_PARTS), ("double", double_door_parts())):
        package = build_package(parts)
        grasps = tuple(grasp for each in find_grasps(package, FRANKA) for grasp in each.grasps[:1])
        written[name] = write_package(replace(package, grasps=grasps), folder / name)
    return written


def _bounds(parts: Sequence[SamplePart]) -> tuple[np.ndarray, np.ndarray]:
    corners = np.concatenate([sample_box_arrays(part).reshape(-1, 3) for part in parts])
    return corners.min(axis=0), corners.max(axis=0)


def _boxes(hulls: Sequence[Hull]) -> Mesh:
    """All boxes in one mesh; each is closed, and where they overlap they enclose their union."""
    starts = np.cumsum([0, *(len(hull.vertices) for hull in hulls)])
    return Mesh(
        vertices=np.concatenate([hull.vertices for hull in hulls]),
        faces=np.concatenate([hull.faces + start for hull, start in zip(hulls, starts, strict=False)]),
    )


def _paint(mesh: Mesh, color: tuple[int, int, int]) -> Mesh:
    """Every triangle gets the same upper half of a small texture of one color."""
    uv = np.tile([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]], (len(mesh.faces), 1, 1))
    texture = np.tile(np.array(color, dtype=np.uint8), (16, 16, 1))
    return replace(mesh, uv=uv, texture=texture)
