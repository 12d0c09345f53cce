"""`write_usd`: a package as a SimReady folder: one file, its textures, its picture."""

import io
import re
import shutil
import tempfile
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from pxr import Gf, Kind, Usd, UsdGeom, UsdPhysics, UsdSemantics, Vt

from sim_export.errors import PackageError
from sim_export.files.srdf import touching_pairs
from sim_export.files.urdf import link_origins
from sim_export.package import HandleAnnotation, SimPackage
from sim_export.physics.materials import MATERIALS, MaterialName
from sim_export.picture.draw import visual_meshes
from sim_export.usd.labels import LABEL_ITEMS, SUBSTANCES, category_item
from sim_export.usd.looks import Looks
from sim_export.usd.physics import (
    add_collider,
    add_joint,
    add_mass,
    add_physics_material,
    joined_pairs,
    keep_apart,
    leading_material,
)

# pxr is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

FOLDER = "simready"
"""Folder, inside the asset's own, of the file and what it refers to; SimReady wants one between."""
THUMBNAIL = 256
"""Pixels of the picture's edge."""


def asset_name(package: SimPackage) -> str:
    """The package's name as a prim, a file and a folder may be called: lower case, no digit first."""
    name = re.sub(r"[^a-z0-9_]+", "_", package.name.lower()).strip("_")
    return name if name[:1].isalpha() else f"object_{name}"


def write_usd(package: SimPackage, out: Path, *, date: str, license: str = "Apache-2.0") -> Path:
    """Writes ``out/<name>/simready/<name>.usda`` with textures and a thumbnail, and returns the file.

    A folder that is there already is replaced once the new one is whole.

    Args:
        package: what to write, in its object frame: z up, front -x, metres.
        out: folder of the asset's folder.
        date: when it was made, which SimReady asks for: YYYY-MM-DD.
        license: under which the object may be used.

    Raises:
        PackageError: If nothing of the package has a mass, or a kept source mesh cannot be read.
    """
    name = asset_name(package)
    stage, images = build_stage(package, date=date, license=license)
    files = {f"{name}.usda": stage.GetRootLayer().ExportToString().encode(), **images}
    files[f".thumbs/{THUMBNAIL}x{THUMBNAIL}/{name}.usda.png"] = _png(draw_thumbnail(package))
    out.mkdir(parents=True, exist_ok=True)
    scratch = Path(tempfile.mkdtemp(prefix=f".{name}.partial-", dir=out))
    try:
        for path, content in files.items():
            file = scratch / FOLDER / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        scratch.chmod(0o755)
        target = out / name
        if target.exists():
            shutil.rmtree(target)
        scratch.rename(target)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    return out / name / FOLDER / f"{name}.usda"


def build_stage(package: SimPackage, *, date: str, license: str) -> tuple[Usd.Stage, dict[str, bytes]]:
    """The stage in memory, and the images that it refers to by their path beside it."""
    root = f"/{asset_name(package)}"
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    top = UsdGeom.Xform.Define(stage, root).GetPrim()
    stage.SetDefaultPrim(top)
    Usd.ModelAPI(top).SetKind(Kind.Tokens.component)
    UsdPhysics.ArticulationRootAPI.Apply(top)
    _label(top, package.category, category_item(package.category))
    materials: dict[str, MaterialName] = {
        part: known for part, name in package.materials for known in MATERIALS if known == name
    }
    looks = Looks(stage=stage, scope=f"{root}/looks")
    UsdGeom.Scope.Define(stage, looks.scope)
    UsdGeom.Scope.Define(stage, f"{root}/physics_materials")
    origins = link_origins(package)
    solid = [link for link in package.links if link.inertial is not None]
    if not solid:
        raise PackageError(f"package {package.name!r}: no link has a mass, so there is no body to write")
    bodies = {link.name: f"{root}/{link.name}" for link in solid}
    frictions = {}
    for link in solid:
        assert link.inertial is not None
        body = UsdGeom.Xform.Define(stage, bodies[link.name])
        body.AddTranslateOp().Set(Gf.Vec3d(*map(float, origins[link.name])))
        UsdPhysics.RigidBodyAPI.Apply(body.GetPrim())
        add_mass(body.GetPrim(), link.inertial, origins[link.name])
        if link.label is not None:
            _label(body.GetPrim(), link.label, LABEL_ITEMS.get(link.label))
        for visual in link.visuals:
            substance = SUBSTANCES[materials.get(visual.part, leading_material(link, materials))]
            for index, mesh in enumerate(visual_meshes(visual)):
                place = f"{bodies[link.name]}/{visual.name}" + (f"_{index}" if index else "")
                looks.add_visual(place, mesh, origins[link.name], substance)
        name = leading_material(link, materials)
        if name not in frictions:
            frictions[name] = add_physics_material(stage, f"{root}/physics_materials/{name}", name)
        for index, hull in enumerate(link.hulls):
            place = f"{bodies[link.name]}/collision_{index}"
            add_collider(stage, place, hull, origins[link.name], frictions[name])
    for handle in package.handles:
        _add_grasp(stage, bodies[handle.link], handle, origins[handle.link])
    _add_joints(stage, root, package, bodies)
    keep_apart(stage, [*joined_pairs(package), *touching_pairs(package)], bodies)
    _add_metadata(stage, package, date=date, license=license)
    return stage, looks.images


def _add_joints(stage: Usd.Stage, root: str, package: SimPackage, bodies: dict[str, str]) -> None:
    """All joints, and a fixed one that holds the body to the world."""
    UsdGeom.Scope.Define(stage, f"{root}/joints")
    origins = link_origins(package)
    children = {joint.child for joint in package.joints}
    for joint in package.joints:
        add_joint(stage, f"{root}/joints/{joint.name}", joint, bodies, origins)
    for name in bodies:
        if name not in children:
            anchor = UsdPhysics.FixedJoint.Define(stage, f"{root}/joints/world")
            anchor.CreateBody1Rel().SetTargets([bodies[name]])


def _add_grasp(stage: Usd.Stage, body: str, handle: HandleAnnotation, origin: np.ndarray) -> None:
    """The segment that closing fingers should straddle."""
    number = sum(1 for prim in stage.GetPrimAtPath(body).GetChildren() if prim.IsA(UsdGeom.BasisCurves))
    line = UsdGeom.BasisCurves.Define(stage, f"{body}/grasp_identifier_{number}")
    ends = (handle.grasp_line - origin).astype(np.float32)
    line.CreateTypeAttr("linear")
    line.CreateCurveVertexCountsAttr([2])
    line.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(ends))
    line.CreateWidthsAttr([0.002])
    line.SetWidthsInterpolation("constant")
    line.CreatePurposeAttr("guide")
    line.CreateExtentAttr(
        Vt.Vec3fArray.FromNumpy(np.stack([ends.min(axis=0) - 0.001, ends.max(axis=0) + 0.001]))
    )


def _label(prim: Usd.Prim, word: str, item: str | None) -> None:
    UsdSemantics.LabelsAPI.Apply(prim, "class").CreateLabelsAttr([word])
    if item is not None:
        UsdSemantics.LabelsAPI.Apply(prim, "wikidata_qcode").CreateLabelsAttr([item])


def _add_metadata(stage: Usd.Stage, package: SimPackage, *, date: str, license: str) -> None:
    corners = np.concatenate([hull.vertices for link in package.links for hull in link.hulls])
    masses = [link.inertial.mass for link in package.links if link.inertial is not None]
    facts: dict[str, object] = {
        "asset_name": asset_name(package),
        "asset_type": "prop",
        "source_file": f"{package.name}/mobility.urdf",
        "usd_date_generated": date,
        "author": "artigen",
        "asset_license": license,
        "category": package.category,
        "qcode": category_item(package.category),
        "rigid_body_count": len(masses),
        "asset_extents": Gf.Vec3f(*map(float, np.ptp(corners, axis=0))),
        "mass": float(sum(masses)),
    }
    identity = ("asset_name", "asset_type", "source_file", "usd_date_generated")
    told: dict[str, object] = {key: facts[key] for key in identity}
    stage.GetRootLayer().customLayerData = told | {"SimReady_Metadata": facts}


def draw_thumbnail(package: SimPackage) -> UInt8[np.ndarray, "H W 3"]:
    """The closed object on a floor."""
    from sim_export.picture.camera import Viewpoint
    from sim_export.picture.preview import PreviewConfig, draw_standing, frame_shapes, prepare_shapes

    cfg = PreviewConfig(panels=("closed",), viewpoint=Viewpoint(width=THUMBNAIL, height=THUMBNAIL))
    shapes = prepare_shapes(package, cfg)
    return draw_standing(shapes, shapes.visual, frame_shapes(shapes, cfg, ("closed",)), cfg)


def _png(pixels: UInt8[np.ndarray, "H W 3"]) -> bytes:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "PNG")
    return stream.getvalue()
