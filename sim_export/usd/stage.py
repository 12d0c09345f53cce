"""Content of a package's USD file: a root, its links as siblings, joints and materials.

Links are not nested, because nested rigid bodies have another meaning in USD; joints define the tree. Hulls
and grasp lines are guides, which renderers skip.
"""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.kind import MaterialName
from sim_export.files.urdf import link_origins
from sim_export.motion.ignored_pairs import ignored_pairs
from sim_export.motion.kinematics import box_sides
from sim_export.package import Hull, Link, Mesh, SimPackage, Visual
from sim_export.physics.links import check_kinematics
from sim_export.picture.draw import visual_meshes
from sim_export.usd.labels import add_label, category_code, label_part, link_material, visual_material
from sim_export.usd.looks import Looks, add_visual
from sim_export.usd.names import asset_name, prim_names
from sim_export.usd.physics import (
    Frames,
    add_body,
    add_collider,
    add_joint,
    add_physics_material,
    fix_to_world,
    follow_joint,
)

if TYPE_CHECKING:
    from pxr import Sdf, Usd

SCOPES = ("joints", "materials", "physics_materials")
FORWARD = "simready:assetFrame:forwardDirection"
"""SimReady's attribute (AF.001) for the unit direction from the origin towards the front."""
INSIDE = 0.004
"""Tolerance (m) for a hull to count as inside the piece it represents; slightly above the actual
protrusion."""
GRASP_WIDTH = 0.002
"""Drawn width (m) of grasp lines."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """A mesh to draw, with the names of its prim and link, its visual and its material."""

    name: str
    link: str
    visual: Visual
    mesh: Mesh
    made_of: MaterialName
    low: Float[np.ndarray, "3"]
    high: Float[np.ndarray, "3"]


def stage_files(package: SimPackage) -> dict[str, bytes]:
    """The USD file and its images, by their path beside each other.

    Raises:
        InvalidKinematics: If links and joints are not a tree.
        PackageError: If a source mesh or an image cannot be read.
        ImportError: If usd-core is missing.
    """
    from pxr import Usd

    # Visual prims get new names, because names of visuals may repeat.
    check_kinematics(replace(package, links=tuple(replace(link, visuals=()) for link in package.links)))
    stage = Usd.Stage.CreateInMemory()
    root = _add_root(stage, package)
    names = prim_names((link.name for link in package.links), SCOPES)
    paths = {link.name: root.AppendChild(name) for link, name in zip(package.links, names, strict=True)}
    frames = Frames(paths=paths, origins=link_origins(package))
    for scope in SCOPES:
        stage.DefinePrim(root.AppendChild(scope), "Scope")
    pieces = gather_pieces(package)
    looks = Looks(stage=stage, scope=root.AppendChild("materials"))
    for link in package.links:
        _add_link(stage, link, frames)
    for piece in pieces:
        path, origin = frames.paths[piece.link].AppendChild(piece.name), frames.origins[piece.link]
        add_visual(looks, path, piece.visual, piece.mesh, piece.made_of, origin)
    _add_colliders(stage, root.AppendChild("physics_materials"), package, pieces, frames)
    _add_joints(stage, root, package, frames)
    _add_grasps(stage, package, frames)
    return {f"{asset_name(package.name)}.usd": _layer_bytes(stage.GetRootLayer()), **looks.files}


def gather_pieces(package: SimPackage) -> tuple[Piece, ...]:
    """All meshes to draw; a source mesh of several materials yields several pieces."""
    shown = [
        (link, visual, _drop_unused(mesh))
        for link in package.links
        for visual in link.visuals
        for mesh in visual_meshes(visual)
        if len(mesh.faces)
    ]
    most = max((len(link.hulls) for link in package.links), default=0)
    taken = [
        *(f"collision_{index}" for index in range(most)),
        *(f"grasp_identifier_{index}" for index in range(len(package.handles))),
    ]
    names = prim_names((visual.name for _, visual, _ in shown), taken)
    return tuple(
        Piece(
            name=name,
            link=link.name,
            visual=visual,
            mesh=mesh,
            made_of=visual_material(package, visual),
            low=mesh.vertices.min(axis=0),
            high=mesh.vertices.max(axis=0),
        )
        for name, (link, visual, mesh) in zip(names, shown, strict=True)
    )


def _drop_unused(mesh: Mesh) -> Mesh:
    """Removes unreferenced vertices, such as those of a source's other materials."""
    used, where = np.unique(mesh.faces, return_inverse=True)
    if len(used) == len(mesh.vertices):
        return mesh
    return replace(mesh, vertices=mesh.vertices[used], faces=where.reshape(-1, 3))


def _add_root(stage: "Usd.Stage", package: SimPackage) -> "Sdf.Path":
    """The default prim, the stage's units, and SimReady's asset metadata."""
    from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdPhysics

    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    (name,) = prim_names([package.name])
    prim = UsdGeom.Xform.Define(stage, Sdf.Path(f"/{name}")).GetPrim()
    stage.SetDefaultPrim(prim)
    Usd.ModelAPI(prim).SetKind(Kind.Tokens.component)
    UsdPhysics.ArticulationRootAPI.Apply(prim)
    forward = prim.CreateAttribute(FORWARD, Sdf.ValueTypeNames.Vector3f, custom=True)
    forward.SetVariability(Sdf.VariabilityUniform)
    forward.Set(Gf.Vec3f(-1.0, 0.0, 0.0))
    add_label(prim, "class", package.category or "object")
    add_label(prim, "wikidata_qcode", category_code(package.category))
    facts = _describe(package)
    # Older profiles expect some of these outside of the dictionary.
    older = {key: facts[key] for key in ("asset_name", "asset_type", "source_file", "usd_date_generated")}
    stage.GetRootLayer().customLayerData = {"SimReady_Metadata": facts, **older}
    return prim.GetPath()


def _describe(package: SimPackage) -> dict[str, object]:
    """SimReady metadata; dates are omitted so that equal packages give equal files."""
    from pxr import Gf

    said = dict(package.provenance)
    return {
        "asset_name": asset_name(package.name),
        "asset_type": "prop",
        "source_file": "mobility.urdf",
        "usd_date_generated": "not recorded",
        "author": said.get("generator", "not recorded"),
        "asset_license": said.get("license", "not stated"),
        "source": said.get("source", "not recorded"),
        "category": package.category or "object",
        "qcode": category_code(package.category),
        "rigid_body_count": len(package.links),
        "asset_extents": Gf.Vec3f(*box_sides(package.links).tolist()),
        "mass": sum(link.inertial.mass for link in package.links if link.inertial is not None),
    }


def _add_link(stage: "Usd.Stage", link: Link, frames: Frames) -> None:
    from pxr import Gf, UsdGeom

    origin = frames.origins[link.name]
    shape = UsdGeom.Xform.Define(stage, frames.paths[link.name])
    shape.AddTranslateOp().Set(Gf.Vec3d(*origin.tolist()))
    add_body(shape.GetPrim(), link.inertial, origin)
    label_part(shape.GetPrim(), link.label)


def _add_colliders(
    stage: "Usd.Stage", scope: "Sdf.Path", package: SimPackage, pieces: tuple[Piece, ...], frames: Frames
) -> None:
    """Adds all hulls, each with the friction of its material."""
    from pxr import UsdShade

    materials: dict[MaterialName, UsdShade.Material] = {}
    for link in package.links:
        for index, hull in enumerate(link.hulls):
            made_of = hull_material(package, link, hull, pieces)
            if made_of not in materials:
                path = scope.AppendChild(made_of)
                materials[made_of] = add_physics_material(stage, path, made_of)
            path = frames.paths[link.name].AppendChild(f"collision_{index}")
            add_collider(stage, path, hull, frames.origins[link.name], materials[made_of])


def hull_material(package: SimPackage, link: Link, hull: Hull, pieces: tuple[Piece, ...]) -> MaterialName:
    """Material of a hull: that of the smallest piece of its link that contains it, else that of the link."""
    low, high = hull.vertices.min(axis=0) + INSIDE, hull.vertices.max(axis=0) - INSIDE
    around = [
        piece
        for piece in pieces
        if piece.link == link.name and (piece.low <= low).all() and (high <= piece.high).all()
    ]
    if not around:
        return link_material(package, link)
    return min(around, key=lambda piece: float(np.prod(piece.high - piece.low + INSIDE))).made_of


def _add_joints(stage: "Usd.Stage", root: "Sdf.Path", package: SimPackage, frames: Frames) -> None:
    """Adds all joints, the fixed joint of the root, and collision exclusions for pairs that touch at rest."""
    from pxr import UsdPhysics

    scope = root.AppendChild("joints")
    children = {joint.child for joint in package.joints}
    for link in package.links:
        if link.name not in children:
            fix_to_world(stage, scope.AppendChild("fixed_to_world"), root, frames.paths[link.name])
    names = prim_names((joint.name for joint in package.joints), ("fixed_to_world",))
    places = {joint.name: scope.AppendChild(name) for name, joint in zip(names, package.joints, strict=True)}
    for joint in package.joints:
        add_joint(stage, places[joint.name], joint, frames)
    for joint in package.joints:
        if joint.follows is not None:
            follower, leader = (stage.GetPrimAtPath(places[name]) for name in (joint.name, joint.follows))
            follow_joint(follower, joint, leader)
    for first, second in ignored_pairs(package):
        apart = UsdPhysics.FilteredPairsAPI.Apply(stage.GetPrimAtPath(frames.paths[first]))
        apart.CreateFilteredPairsRel().AddTarget(frames.paths[second])


def _add_grasps(stage: "Usd.Stage", package: SimPackage, frames: Frames) -> None:
    """Adds the segments that closing fingers straddle, as guides below their links."""
    from pxr import Gf, UsdGeom

    for index, handle in enumerate(package.handles):
        path = frames.paths[handle.link].AppendChild(f"grasp_identifier_{index}")
        ends = np.asarray(handle.grasp_line) - frames.origins[handle.link]
        points = [Gf.Vec3f(*end) for end in ends.tolist()]
        line = UsdGeom.BasisCurves.Define(stage, path)
        line.CreateTypeAttr().Set(UsdGeom.Tokens.linear)
        line.CreateCurveVertexCountsAttr().Set([2])
        line.CreatePointsAttr().Set(points)
        line.CreateWidthsAttr().Set([GRASP_WIDTH])
        line.SetWidthsInterpolation(UsdGeom.Tokens.constant)
        line.CreatePurposeAttr().Set(UsdGeom.Tokens.guide)
        line.CreateExtentAttr().Set(UsdGeom.Curves.ComputeExtent(points, [GRASP_WIDTH]))


def _layer_bytes(layer: "Sdf.Layer") -> bytes:
    """A layer as the content of a binary file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "layer.usd"
        layer.Export(str(path))
        return path.read_bytes()
