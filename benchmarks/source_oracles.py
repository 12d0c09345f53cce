"""Compares sources as MuJoCo, yourdfpy and usd-core load them with what is read and with packages.

    python benchmarks/source_oracles.py FILES [--packages FOLDER]

What is read, and each package as MuJoCo and yourdfpy load it, is compared in the closed pose and with each
joint at its open end, in the coordinates of the source's own joints. Which geoms of an MJCF are drawn is the
reader's choice; their poses are MuJoCo's.
"""

# mujoco is a compiled module without stubs; usd-core has none and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

import argparse
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Set
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from artigen.api.convert import ConvertJob, ConvertSettings, convert_object, list_jobs
from artigen.datasets.mechanism_object import find_mesh
from artigen.datasets.mjcf import compile_mjcf
from artigen.datasets.mjcf_geoms import find_drawn
from artigen.datasets.mjcf_scene import choose_object
from artigen.datasets.source_object import SourceObject
from artigen.datasets.sources import find_layout
from artigen.datasets.xacro_file import expand_xacro
from artigen.errors import ArtigenError
from artigen.files.urdf import is_xacro
from artigen.kinematics import displacements, movable_parts
from artigen.transforms import rotation_about, transform_points
from artigen.types import Joint
from sim_export.files.read import read_package
from sim_export.package import SimPackage

Pose = Mapping[str, float]
LENGTH = 1e-3
"""Extents may differ by this share of the object's longest edge (packages write six digits)."""
COLOR = 0.04
"""Mean colours may differ by this much: libraries sample textures at corners or centres."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Loaded:
    """An object as a library loads it: triangles in metres, z up, in a pose; the rest by joint or link."""

    triangles: Callable[[Pose], np.ndarray]
    axis: Callable[[str, Pose], np.ndarray]
    ranges: dict[str, tuple[float, float]]
    color: np.ndarray
    """Mean RGB in [0, 1] of the surface; NaN where the library leaves a part of it without colour."""
    masses: dict[str, float] = field(default_factory=dict)

    def extents(self, pose: Pose) -> np.ndarray:
        return np.ptp(self.triangles(pose).reshape(-1, 3), axis=0)


def mean_color(triangles: np.ndarray, colors: np.ndarray) -> np.ndarray:
    """Colour of a surface [3] by that of its triangles, weighted by area."""
    sides = np.diff(triangles, axis=1)
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=-1)
    return (areas[:, None] * colors).sum(axis=0) / areas.sum()


def load_read(found: SourceObject) -> Loaded:
    """The object as it was read; joints have the names of their parts."""
    asset = found.asset
    order = list(movable_parts(asset))
    parts = {asset.parts[k].name: k for k in order}
    corners = asset.scale * found.triangles.vertices[found.triangles.faces]

    def triangles(pose: Pose) -> np.ndarray:
        unit = {k: 1.0 if asset.parts[k].joint.type != "prismatic" else asset.scale for k in order}
        q = np.array([pose.get(asset.parts[k].name, 0.0) / unit[k] for k in order])
        moved = np.array(corners)
        for k, T in enumerate(displacements(asset, q)):
            own = found.triangles.part_ids == k
            T = np.array(T)
            T[:3, 3] *= asset.scale
            moved[own] = transform_points(T, corners[own].reshape(-1, 3)).reshape(-1, 3, 3)
        return moved

    assert asset.surface is not None
    slides = {name: asset.parts[k].joint.type == "prismatic" for name, k in parts.items()}
    return Loaded(
        triangles=triangles,
        axis=lambda name, pose: np.array(asset.parts[parts[name]].joint.axis),
        ranges={
            name: (0.0, asset.parts[k].joint.upper * (asset.scale if slides[name] else 1.0))
            for name, k in parts.items()
        },
        color=asset.surface.colors.mean(axis=0) / 255.0,
    )


def load_mujoco(path: Path, body: str | None = None, *, package: bool = False) -> Loaded:
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(path)) if package else compile_mjcf(path)[0]
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    shown = [geom for geom in range(model.ngeom) if model.geom_group[geom] < 3]
    geoms = shown if package else find_drawn(model, data, choose_object(model, path, body).geoms)[0]
    names = {model.joint(j).name or (f"joint_{j}"): j for j in range(model.njnt)}

    def move(pose: Pose) -> None:
        data.qpos[:] = model.qpos0
        for name, value in pose.items():
            data.qpos[model.jnt_qposadr[names[name]]] += value
        for _ in range(model.neq):  # chains of followers settle one by one
            for row in range(model.neq):
                if model.eq_type[row] == mujoco.mjtEq.mjEQ_JOINT and model.eq_active0[row]:
                    one, other = (
                        model.jnt_qposadr[k] if k >= 0 else -1
                        for k in (int(model.eq_obj1id[row]), int(model.eq_obj2id[row]))
                    )
                    x = 0.0 if other < 0 else data.qpos[other] - model.qpos0[other]
                    data.qpos[one] = model.qpos0[one] + np.polynomial.Polynomial(model.eq_data[row][:5])(x)
        mujoco.mj_kinematics(model, data)

    own = [_geom_triangles(model, geom) for geom in geoms]

    def triangles(pose: Pose) -> np.ndarray:
        move(pose)
        return np.concatenate(
            [
                corners @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
                for geom, corners in zip(geoms, own, strict=True)
            ]
        )

    def axis(name: str, pose: Pose) -> np.ndarray:
        move(pose)
        return np.array(data.xaxis[names[name]])

    return Loaded(
        triangles=triangles,
        axis=axis,
        ranges={
            name: tuple(model.jnt_range[j] - model.qpos0[model.jnt_qposadr[j]]) for name, j in names.items()
        },
        color=mean_color(
            triangles({}),
            np.concatenate(
                [_geom_colors(model, g, len(corners)) for g, corners in zip(geoms, own, strict=True)]
            ),
        ),
        masses={model.body(b).name: float(model.body_mass[b]) for b in range(1, model.nbody)},
    )


def _geom_triangles(model: object, geom: int) -> np.ndarray:
    import mujoco
    from trimesh import creation

    assert isinstance(model, mujoco.MjModel)
    kinds, size = mujoco.mjtGeom, model.geom_size[geom]
    match kinds(int(model.geom_type[geom])):
        case kinds.mjGEOM_MESH:
            mesh = model.mesh(int(model.geom_dataid[geom]))
            first, count = int(mesh.faceadr[0]), int(mesh.facenum[0])
            vertices = model.mesh_vert[int(mesh.vertadr[0]) :]
            return np.asarray(vertices[model.mesh_face[first : first + count]], dtype=float)
        case kinds.mjGEOM_BOX:
            found = creation.box(2 * size)
        case kinds.mjGEOM_CYLINDER:
            found = creation.cylinder(radius=size[0], height=2 * size[1], sections=48)
        case kinds.mjGEOM_CAPSULE:
            found = creation.capsule(radius=size[0], height=2 * size[1], count=(24, 48))
            found.apply_translation(-found.bounds.mean(axis=0))
        case _:
            found = creation.icosphere(3)
            found.apply_scale(size if model.geom_type[geom] == kinds.mjGEOM_ELLIPSOID else size[0])
    return np.asarray(found.triangles)


def _geom_colors(model: object, geom: int, count: int) -> np.ndarray:
    """Colour of every triangle: rgba times the texture at its middle, or times the texture's mean."""
    import mujoco

    assert isinstance(model, mujoco.MjModel)
    color, material = np.array(model.geom_rgba[geom][:3], dtype=float), int(model.geom_matid[geom])
    texture = -1
    if material >= 0:
        plain = np.allclose(model.geom_rgba[geom], (0.5, 0.5, 0.5, 1.0))
        color = np.array(model.mat_rgba[material][:3], dtype=float) if plain else color
        texture = max(model.mat_texid[material][1], model.mat_texid[material][2])
    if texture < 0:
        return np.tile(color, (count, 1))
    height, width, depth = (int(a[texture]) for a in (model.tex_height, model.tex_width, model.tex_nchannel))
    start = int(model.tex_adr[texture])
    pixels = model.tex_data[start : start + height * width * depth].reshape(height, width, depth) / 255.0
    pixels = np.repeat(pixels, 3, axis=2) if depth < 3 else pixels[..., :3]
    mesh = int(model.geom_dataid[geom])
    if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH or model.mesh_texcoordadr[mesh] < 0:
        return np.tile(color * pixels.reshape(-1, 3).mean(axis=0), (count, 1))
    first = int(model.mesh_faceadr[mesh])
    rows = int(model.mesh_texcoordadr[mesh]) + model.mesh_facetexcoord[first : first + count]
    u, v = np.moveaxis(model.mesh_texcoord[rows].mean(axis=1) % 1.0, -1, 0)
    return color * pixels[(v * (height - 1)).astype(int), (u * (width - 1)).astype(int)]


def load_yourdfpy(path: Path) -> Loaded:
    import yourdfpy

    said = BytesIO(expand_xacro(path).encode()) if is_xacro(path) else str(path)
    robot = yourdfpy.URDF.load(said, filename_handler=lambda fname: str(find_mesh(fname, path)))

    def move(pose: Pose) -> None:
        robot.update_cfg(dict.fromkeys(robot.actuated_joint_names, 0.0) | dict(pose))

    nodes = [robot.scene.graph[node][1] for node in robot.scene.graph.nodes_geometry]
    meshes = [robot.scene.geometry[name] for name in nodes]

    def triangles(pose: Pose) -> np.ndarray:
        move(pose)
        graph = robot.scene.graph
        return np.concatenate(
            [
                transform_points(graph[node][0], np.asarray(mesh.triangles).reshape(-1, 3)).reshape(-1, 3, 3)
                for node, mesh in zip(graph.nodes_geometry, meshes, strict=True)
            ]
        )

    def axis(name: str, pose: Pose) -> np.ndarray:
        move(pose)
        joint = robot.joint_map[name]
        turned = robot.get_transform(joint.child)[:3, :3] @ np.asarray(joint.axis)
        return turned / np.linalg.norm(turned)

    return Loaded(
        triangles=triangles,
        axis=axis,
        ranges={
            joint.name: (joint.limit.lower or 0.0, joint.limit.upper or 0.0)
            for joint in robot.robot.joints
            if joint.limit is not None
        },
        color=mean_color(triangles({}), np.concatenate([_mesh_colors(mesh) for mesh in meshes])),
        masses={
            link.name: float(link.inertial.mass or 0.0)
            for link in robot.robot.links
            if link.inertial is not None
        },
    )


def _mesh_colors(mesh: Any) -> np.ndarray:
    """Colour of every triangle of a mesh of trimesh: of its image at the middle, else plain."""
    visual, count = mesh.visual, len(mesh.faces)
    if visual.kind is None:  # also where it does not find a material by its name
        return np.full((count, 3), np.nan)
    if visual.kind != "texture":
        return np.asarray(visual.face_colors)[:, :3] / 255.0
    image = getattr(visual.material, "image", None) or getattr(visual.material, "baseColorTexture", None)
    if image is None and visual.uv is not None:  # trimesh opens no image in a folder beside the mesh's
        return np.full((count, 3), np.nan)
    if image is None or visual.uv is None:
        return np.tile(np.asarray(visual.material.main_color)[:3] / 255.0, (count, 1))
    pixels = np.asarray(image.convert("RGB")) / 255.0
    u, v = np.moveaxis(np.asarray(visual.uv)[mesh.faces].mean(axis=1) % 1.0, -1, 0)
    height, width = pixels.shape[:2]
    return pixels[((1.0 - v) * (height - 1)).astype(int), (u * (width - 1)).astype(int)]


def load_usd(path: Path) -> Loaded:
    """A stage of cubes as usd-core has it; a joint moves its second body and all that joints hang on it."""
    from pxr import Usd, UsdGeom, UsdPhysics
    from trimesh import creation

    stage = Usd.Stage.Open(str(path))
    cache = UsdGeom.XformCache(Usd.TimeCode.Default())
    turn = np.eye(4) * UsdGeom.GetStageMetersPerUnit(stage)
    if UsdGeom.GetStageUpAxis(stage) == "Y":
        turn[:3, :3] = turn[:3, :3] @ [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    turn[3, 3] = 1.0

    def world(prim: object) -> np.ndarray:
        return turn @ np.array(cache.GetLocalToWorldTransform(prim)).T

    joints = {p.GetName(): UsdPhysics.Joint(p) for p in stage.Traverse() if p.IsA(UsdPhysics.Joint)}
    ends = {
        name: tuple(str((rel.GetTargets() or ["/"])[0]) for rel in (joint.GetBody0Rel(), joint.GetBody1Rel()))
        for name, joint in joints.items()
    }
    moving = {name: joint for name, joint in joints.items() if joint.GetPrim().GetAttribute("physics:axis")}

    def below(name: str) -> set[str]:
        found, waiting = set[str](), [ends[name][1]]
        while waiting:
            at = waiting.pop()
            found.add(at)
            waiting += [b for n, (a, b) in ends.items() if a == at and n != name and b not in found]
        return found

    def frame(name: str) -> tuple[np.ndarray, np.ndarray]:
        joint = joints[name]
        T = world(stage.GetPrimAtPath(ends[name][0]))
        quat = joint.GetLocalRot0Attr().Get()
        local = np.eye(3)["XYZ".index(joint.GetPrim().GetAttribute("physics:axis").Get())]
        direction = T[:3, :3] @ np.array(quat.Transform(tuple(local)) if quat else local)
        place = T[:3, :3] @ np.array(joint.GetLocalPos0Attr().Get()) + T[:3, 3]
        return place, direction / np.linalg.norm(direction)

    own = []
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Cube) and UsdGeom.Imageable(prim).ComputePurpose() != "guide":
            box = creation.box(np.full(3, UsdGeom.Cube(prim).GetSizeAttr().Get()))
            points, faces = np.asarray(box.vertices), np.asarray(box.faces)
            said = UsdGeom.Gprim(prim).GetDisplayColorAttr().Get()
            color = np.array(said[0] if said else (np.nan, np.nan, np.nan))
            srgb = np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1 / 2.4) - 0.055)
            own.append(
                (
                    str(prim.GetPath()),
                    transform_points(world(prim), points)[faces],
                    np.tile(srgb, (len(faces), 1)),
                )
            )

    def triangles(pose: Pose) -> np.ndarray:
        placed = []
        for path, corners, _ in own:
            points = corners.reshape(-1, 3)
            for name, value in pose.items():
                if any(path.startswith(f"{body}/") for body in below(name)):
                    place, direction = frame(name)
                    if joints[name].GetPrim().GetTypeName() == "PhysicsPrismaticJoint":
                        points = points + value * direction
                    else:
                        points = (points - place) @ rotation_about(direction, np.array([value]))[0].T + place
            placed.append(points.reshape(-1, 3, 3))
        return np.concatenate(placed)

    def limits(name: str) -> tuple[float, float]:
        prim = joints[name].GetPrim()
        unit = np.pi / 180 if "Revolute" in prim.GetTypeName() else UsdGeom.GetStageMetersPerUnit(stage)
        return tuple(unit * prim.GetAttribute(f"physics:{side}Limit").Get() for side in ("lower", "upper"))

    return Loaded(
        triangles=triangles,
        axis=lambda name, pose: frame(name)[1],
        ranges={name: limits(name) for name in moving},
        color=mean_color(triangles({}), np.concatenate([color for _, _, color in own])),
    )


def load_source(path: Path, body: str | None) -> Loaded:
    """A source as the library of its layout loads it."""
    match find_layout(path):
        case "URDF":
            return load_yourdfpy(path)
        case "MJCF":
            return load_mujoco(path, body)
        case "USD":
            return load_usd(path)
        case other:
            raise ValueError(f"{path}: no library loads {other}")


def compare(
    found: SourceObject,
    source: Loaded,
    made: Loaded,
    joints: Mapping[str, str],
    shortened: Set[str] = frozenset(),
) -> Iterator[str]:
    """Differences between a source and what was made of it, a sentence each; none if they agree.

    Args:
        joints: Joint in ``made`` of every part.
        shortened: Parts of which a package says that their range is not that of the source.
    """
    followers = {one for one, _ in found.follows}
    leaders = {m.joint: m.closed for m in found.motions if m.part not in followers}
    closed = source.extents(leaders)
    size = LENGTH * float(closed.max())
    yield from _differ("closed extents", closed, made.extents({}), size)
    yield from _differ("mean colour", source.color, made.color, COLOR)
    for motion in found.motions:
        kind = next(part.joint.type for part in found.asset.parts if part.name == motion.part)
        if motion.part in followers or kind in ("continuous", "screw"):
            continue
        name, limits = joints[motion.part], np.array(source.ranges[motion.joint])
        if not np.isclose(limits, motion.open, rtol=1e-3, atol=1e-5).any():
            yield f"range of {motion.joint!r}: open at {motion.open:.4g}, expected one of {limits.round(4)}"
        sign, travel = np.sign(motion.open - motion.closed), abs(motion.open - motion.closed)
        upper = made.ranges[name][1]
        if not np.isclose(upper, travel, rtol=1e-3) and motion.part not in shortened:
            yield f"range of {motion.joint!r}: {upper:.4g}, expected {travel:.4g}"
        opened = leaders | {motion.joint: motion.closed + sign * upper}
        follow = {
            joints[one]: made.ranges[joints[one]][1] for one, other in found.follows if other == motion.part
        }
        pose = {name: upper} | (
            follow if joints.get(motion.part) == motion.part else {}
        )  # packages follow by themselves
        yield from _differ(
            f"extents with {motion.joint!r} open", source.extents(opened), made.extents(pose), size
        )
        axes = sign * source.axis(motion.joint, leaders), made.axis(name, {})
        yield from _differ(f"axis of {motion.joint!r}", *axes, 1e-3)


def compare_read(found: SourceObject, source: Loaded) -> list[str]:
    """Differences between a source and the object as it was read."""
    moving = len(movable_parts(found.asset))
    wrong = (
        [] if moving == len(found.motions) else [f"{moving} parts move, {len(found.motions)} in the source"]
    )
    names = {motion.part: motion.part for motion in found.motions}
    return [*wrong, *compare(found, source, load_read(found), names)]


def compare_package(found: SourceObject, source: Loaded, folder: Path) -> list[str]:
    """Differences between a source and its package, as MuJoCo and yourdfpy load it."""
    package = read_package(folder, appearance=False)
    owners = {part: link.name for link in package.links for part in link.parts}
    joints = {motion.part: _joint_of(package, owners[motion.part]).name for motion in found.motions}
    said = {record.partition(":")[0] for record in package.records if ": upper limit " in record}
    shortened = {part for part, joint in joints.items() if joint in said}
    loaded = {
        "MuJoCo": load_mujoco(folder / "mobility.mjcf.xml", package=True),
        "yourdfpy": load_yourdfpy(folder / "mobility.urdf"),
    }
    wrong = [
        f"{sentence} (package in {name})"
        for name, made in loaded.items()
        for sentence in compare(found, source, made, joints, shortened)
    ]
    masses = [[made.masses.get(link.name, 0.0) for link in package.links] for made in loaded.values()]
    return (
        wrong
        if np.allclose(*masses, rtol=1e-4, atol=1e-6)
        else [*wrong, "MuJoCo and yourdfpy weigh it differently"]
    )


def _joint_of(package: SimPackage, link: str) -> Joint:
    return next(joint for joint in package.joints if joint.child == link)


def _differ(what: str, want: np.ndarray, got: np.ndarray, within: float) -> Iterator[str]:
    if np.abs(want - got).max() > within:
        yield f"{what}: {np.round(got, 4)}, expected {np.round(want, 4)}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", type=Path, nargs="+")
    parser.add_argument("--packages", type=Path, help="convert into this folder and compare the packages too")
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    jobs = [job for file in args.files for job in list_jobs(file, args.packages or Path(), ConvertSettings())]
    right = sum(report(job, packages=args.packages is not None) for job in jobs)
    print(f"{right} of {len(jobs)} agree")


def report(job: ConvertJob, *, packages: bool) -> bool:
    start = time.perf_counter()
    try:
        with tempfile.TemporaryDirectory() as scratch:
            found = job.read(Path(scratch))
            source = load_source(job.source, job.cfg.body)
            wrong = compare_read(found, source)
        if packages:
            convert_object(job)
            wrong += compare_package(found, source, job.out / job.key)
    except ArtigenError as error:
        wrong = [str(error)]
    seconds = time.perf_counter() - start
    print(f"{job.key}: {'right' if not wrong else 'WRONG'} ({seconds:.0f} s)", flush=True)
    for sentence in wrong:
        print(f"    {sentence}", flush=True)
    return not wrong


if __name__ == "__main__":
    main()
