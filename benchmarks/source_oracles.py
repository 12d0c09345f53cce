"""Compares objects as MuJoCo, yourdfpy and usd-core load them with the packages made of them.

    python benchmarks/source_oracles.py FILES [--packages FOLDER]

Each package is loaded by MuJoCo and yourdfpy, in the closed pose and with each joint at its open end, in the
coordinates of the source's own joints. Which geoms of an MJCF are drawn is taken from the reader, their poses
are MuJoCo's.
"""

# mujoco is a compiled module without stubs; usd-core has none and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

import argparse
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from artigen.api.convert import ConvertJob, ConvertSettings, convert_object, list_jobs
from artigen.datasets.mjcf import compile_mjcf
from artigen.datasets.mjcf_geoms import find_drawn
from artigen.datasets.mjcf_scene import choose_object
from artigen.datasets.source_object import SourceObject
from artigen.datasets.sources import find_layout
from artigen.errors import ArtigenError
from artigen.transforms import rotation_about, transform_points
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
    colors: np.ndarray
    """RGB in [0, 1] of every triangle."""
    masses: dict[str, float] = field(default_factory=dict)

    def extents(self, pose: Pose) -> np.ndarray:
        return np.ptp(self.triangles(pose).reshape(-1, 3), axis=0)

    def mean_color(self) -> np.ndarray:
        sides = np.diff(self.triangles({}), axis=1)
        areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=-1)
        return (areas[:, None] * self.colors).sum(axis=0) / areas.sum()


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
        colors=np.concatenate(
            [_geom_colors(model, geom, len(corners)) for geom, corners in zip(geoms, own, strict=True)]
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

    robot = yourdfpy.URDF.load(str(path))

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
        colors=np.concatenate([_mesh_colors(mesh) for mesh in meshes]),
        masses={
            link.name: float(link.inertial.mass or 0.0)
            for link in robot.robot.links
            if link.inertial is not None
        },
    )


def _mesh_colors(mesh: Any) -> np.ndarray:
    """Colour of every triangle of a mesh of trimesh: of its image at the middle, else plain."""
    visual, count = mesh.visual, len(mesh.faces)
    if visual.kind != "texture":
        return np.asarray(visual.face_colors)[:, :3] / 255.0
    image = getattr(visual.material, "image", None) or getattr(visual.material, "baseColorTexture", None)
    if image is None or visual.uv is None:
        return np.tile(np.asarray(visual.material.main_color)[:3] / 255.0, (count, 1))
    pixels = np.asarray(image.convert("RGB")) / 255.0
    u, v = np.moveaxis(np.asarray(visual.uv)[mesh.faces].mean(axis=1) % 1.0, -1, 0)
    height, width = pixels.shape[:2]
    return pixels[((1.0 - v) * (height - 1)).astype(int), (u * (width - 1)).astype(int)]


def load_usd(path: Path) -> Loaded:
    """The stage as usd-core has it; a joint moves its second body and all that joints hang on it."""
    from pxr import Usd, UsdGeom, UsdPhysics

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
        if prim.IsA(UsdGeom.Mesh) and UsdGeom.Imageable(prim).ComputePurpose() != "guide":
            mesh = UsdGeom.Mesh(prim)
            points = np.array(mesh.GetPointsAttr().Get())
            faces = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
            color = np.array(mesh.GetDisplayColorAttr().Get()[0])
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
        colors=np.concatenate([color for _, _, color in own]),
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


def compare(found: SourceObject, source: Loaded, folder: Path) -> Iterator[str]:
    """Differences between a source and its package, a sentence each; none if they agree."""
    package = read_package(folder, appearance=False)
    closed = {motion.joint: motion.closed for motion in found.motions}
    followers = {one for one, _ in found.follows}
    leaders = {m.joint: m.closed for m in found.motions if m.part not in followers}
    for name, made in (
        ("MuJoCo", load_mujoco(folder / "mobility.mjcf.xml", package=True)),
        ("yourdfpy", load_yourdfpy(folder / "mobility.urdf")),
    ):
        size = float(source.extents(leaders).max())
        yield from _differ(
            f"closed extents in {name}", source.extents(leaders), made.extents({}), LENGTH * size
        )
        yield from _differ(f"mean colour in {name}", source.mean_color(), made.mean_color(), COLOR)
        for motion in found.motions:
            joint = _joint_of(package, motion.part)
            if motion.part in followers or joint.kind in ("continuous", "screw"):
                continue
            sign, travel = np.sign(motion.open - motion.closed), abs(motion.open - motion.closed)
            if not np.isclose(joint.upper, travel, rtol=1e-3) and not _is_said(package, motion.part):
                yield f"range of {motion.joint!r} in {name}: {joint.upper:.4g}, expected {travel:.4g}"
            opened = (
                source.extents(leaders | {motion.joint: motion.closed + sign * joint.upper}),
                made.extents({joint.name: joint.upper}),
            )
            yield from _differ(f"extents with {motion.joint!r} open in {name}", *opened, LENGTH * size)
            axes = sign * source.axis(motion.joint, leaders), made.axis(joint.name, {})
            yield from _differ(f"axis of {motion.joint!r} in {name}", *axes, 1e-3)
    moving = [joint for joint in package.joints if joint.type != "fixed" and joint.mimic is None]
    if len(moving) != len(closed) - len(followers & {m.part for m in found.motions}):
        yield f"{len(moving)} joints move in the package, {len(closed)} in the source"


def _is_said(package: SimPackage, part: str) -> bool:
    """Whether the package says that the range of a part is not that of the source."""
    return any(part in record and ("range" in record or "travel" in record) for record in package.records)


def _joint_of(package: SimPackage, part: str):
    link = next(link.name for link in package.links if part in link.parts)
    return next(joint for joint in package.joints if joint.child == link)


def _differ(what: str, want: np.ndarray, got: np.ndarray | float, within: float) -> Iterator[str]:
    if np.abs(want - np.asarray(got)).max() > within:
        yield f"{what}: {np.round(got, 4)}, expected {np.round(want, 4)}"


def order_of_masses(source: Mapping[str, float], made: Mapping[str, float]) -> float:
    """Share of pairs of links of which the heavier one is the same in both, of those that differ by half."""
    names = [name for name in source if name in made]
    pairs = [(a, b) for a in names for b in names if source[a] > 1.5 * source[b]]
    return float(np.mean([made[a] > made[b] for a, b in pairs])) if pairs else 1.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", type=Path, nargs="+")
    parser.add_argument("--packages", type=Path, help="folder of the packages; default: a temporary one")
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    right = count = 0
    with tempfile.TemporaryDirectory() as scratch:
        out = args.packages or Path(scratch)
        for file in args.files:
            for job in list_jobs(file, out, ConvertSettings()):
                count += 1
                right += report(job)
    print(f"{right} of {count} agree")


def report(job: ConvertJob) -> bool:
    start = time.perf_counter()
    try:
        convert_object(job)
        with tempfile.TemporaryDirectory() as scratch:
            found = job.read(Path(scratch))
        wrong = list(compare(found, load_source(job.source, job.cfg.body), job.out / job.key))
    except ArtigenError as error:
        wrong = [str(error)]
    print(f"{job.key}: {'right' if not wrong else 'WRONG'} ({time.perf_counter() - start:.0f} s)", flush=True)
    for sentence in wrong:
        print(f"    {sentence}", flush=True)
    return not wrong


if __name__ == "__main__":
    main()
