"""A room as an OpenUSD stage: references to one asset per package, walls as cubes, loose things as bodies.

Nothing of a package is copied into the stage. Links whose joints are not at 0 get an opinion about their
pose, from which engines start.
"""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.kind import MaterialName
from artigen.splats.colors import linear_from_srgb
from artigen.transforms import quat_from_matrix, shift
from sim_export.files.read import read_package
from sim_export.files.urdf import link_origins
from sim_export.geometry.primitives import PrimitiveShape
from sim_export.motion.kinematics import link_displacements
from sim_export.package import Visual
from sim_export.usd.looks import Looks, add_visual
from sim_export.usd.names import asset_name, free_name, prim_names
from sim_export.usd.physics import add_primitive
from sim_export.usd.stage import SCOPES
from sim_export.usd.write import require_usd, write_usd

from .covers import fixture_mesh
from .footprints import cached_package
from .patterns import Pattern
from .room import Fixture, Item, Placement, Room, pose_matrix_of
from .solids import fixture_shape, item_poses
from .things import thing_solids
from .views import find_lamps, find_views

if TYPE_CHECKING:
    from pxr import Sdf, Usd, UsdGeom

USD_FILE = "scene.usda"
ASSETS = "usd"
"""Subfolder of the room for the assets of its packages."""
ORIGIN = np.zeros(3)
BRIGHTNESS, SKY = 30000.0, 300.0
"""Intensities of all lamps together and of the light from everywhere."""
FOCAL = 24.0
"""Focal length of cameras, in tenths of a scene unit."""
SCOPE_NAMES = ("physics", "lights", "cameras", "Looks")
"""Prims of the stage that are no part of the room."""
MADE_OF: dict[Pattern, MaterialName] = {
    "planks": "wood_board", "wood": "wood_board", "tiles": "stone", "small_tiles": "stone", "stone": "stone",
    "cloth": "plastic", "sky": "plastic",
}  # fmt: skip
"""Materials of patterns."""


def write_room_usd(room: Room, folder: Path) -> Path:
    """Writes ``scene.usda`` and the assets that it refers to, and returns its path.

    Raises:
        PackageError: If usd-core is missing, or a package cannot be read or written as USD.
    """
    require_usd()
    from pxr import Sdf, Usd, UsdGeom, UsdPhysics

    assets = _write_assets(room, folder)
    # References resolve beside the layer, so that it is written in its folder from the beginning.
    path, draft = folder / USD_FILE, folder / f"draft_{USD_FILE}"
    stage = Usd.Stage.CreateNew(str(draft))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    world = UsdGeom.Xform.Define(stage, "/World").GetPrim()
    stage.SetDefaultPrim(world)
    UsdPhysics.Scene.Define(stage, "/World/physics")
    names = [
        *(f.name for f in room.fixtures),
        *(p.id for p in room.placements),
        *(i.id for i in room.contents),
    ]
    paths = iter(Sdf.Path("/World").AppendChild(name) for name in prim_names(names, SCOPE_NAMES))
    _add_lights_and_cameras(stage, room)
    looks = Looks(stage=stage, scope=Sdf.Path("/World/Looks"))
    UsdGeom.Scope.Define(stage, looks.scope)
    for fixture in room.fixtures:
        _add_fixture(looks, next(paths), fixture)
    for placement in room.placements:
        _add_placement(stage, next(paths), placement, assets[placement.package])
    poses = item_poses(room)
    for item in room.contents:
        _add_item(stage, next(paths), item, poses[item.id])
    for name, image in looks.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(image)
    stage.GetRootLayer().Save()
    return draft.replace(path)


def _write_assets(room: Room, folder: Path) -> dict[Path, str]:
    """One asset per package, by its path relative to the stage."""
    written: dict[Path, str] = {}
    used: set[str] = set()
    for placement in room.placements:
        if placement.package in written:
            continue
        package = read_package(placement.package)
        package = replace(package, name=free_name(package.name, used))
        used.add(asset_name(package.name))
        path = write_usd(package, folder / ASSETS, "replace")
        written[placement.package] = f"./{path.relative_to(folder).as_posix()}"
    return written


def _place(shape: "UsdGeom.Xformable", T: Float[np.ndarray, "4 4"]) -> None:
    """Sets the pose of a prim by a translation and a rotation, whatever it had."""
    from pxr import Gf, UsdGeom

    shape.ClearXformOpOrder()
    shape.AddTranslateOp().Set(Gf.Vec3d(*T[:3, 3].tolist()))
    turn = shape.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    turn.Set(Gf.Quatd(*quat_from_matrix(T[:3, :3]).tolist()))


def _add_lights_and_cameras(stage: "Usd.Stage", room: Room) -> None:
    """Round lamps that shine down, light from everywhere, and the cameras of the room."""
    from pxr import Gf, UsdGeom, UsdLux

    for lamp in find_lamps(room):
        light = UsdLux.DiskLight.Define(stage, f"/World/lights/{lamp.name}")
        light.CreateRadiusAttr().Set(0.2)
        light.CreateIntensityAttr().Set(BRIGHTNESS * lamp.share)
        _place(light, shift(np.array(lamp.position)))
    UsdLux.DomeLight.Define(stage, "/World/lights/sky").CreateIntensityAttr().Set(SKY)
    for view in find_views(room):
        camera = UsdGeom.Camera.Define(stage, f"/World/cameras/{view.name}")
        right, down, forward = view.camera.axes
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = np.column_stack([right, -down, -forward]), view.camera.position
        _place(camera, T)
        high = 2.0 * np.tan(np.radians(view.camera.fov) / 2.0) * FOCAL
        camera.CreateFocalLengthAttr().Set(FOCAL)
        camera.CreateVerticalApertureAttr().Set(high)
        camera.CreateHorizontalApertureAttr().Set(high * view.camera.width / view.camera.height)
        camera.CreateClippingRangeAttr().Set(Gf.Vec2f(0.02, 50.0))


def _add_fixture(looks: Looks, path: "Sdf.Path", fixture: Fixture) -> None:
    """A shape in its colour; with a pattern, the shape only collides, and a mesh with the image is seen."""
    from pxr import UsdGeom

    solid = fixture_shape(fixture)
    if fixture.pattern == "plain":
        _add_solid(looks.stage, path, solid, fixture.color)
        return
    UsdGeom.Xform.Define(looks.stage, path)
    shape = _add_solid(looks.stage, path.AppendChild("collision"), solid, fixture.color)
    shape.CreatePurposeAttr().Set(UsdGeom.Tokens.guide)
    mesh = fixture_mesh(fixture)
    visual = Visual(name=fixture.name, part=fixture.name, label="base", mesh=mesh)
    add_visual(looks, path.AppendChild("cover"), visual, mesh, MADE_OF[fixture.pattern], ORIGIN)


def _add_solid(
    stage: "Usd.Stage", path: "Sdf.Path", solid: PrimitiveShape, color: tuple[float, float, float]
) -> "UsdGeom.Gprim":
    """A shape that is seen and collides."""
    from pxr import Gf, UsdPhysics

    shape = add_primitive(stage, path, solid, ORIGIN)
    shape.CreateDisplayColorAttr().Set([Gf.Vec3f(*linear_from_srgb(np.array(color)).tolist())])
    UsdPhysics.CollisionAPI.Apply(shape.GetPrim())
    return shape


def _add_placement(stage: "Usd.Stage", path: "Sdf.Path", placement: Placement, asset: str) -> None:
    """A reference to the asset at its place, with its links where the joints put them."""
    from pxr import UsdGeom

    shape = UsdGeom.Xform.Define(stage, path)
    shape.GetPrim().GetReferences().AddReference(asset)
    _place(shape, pose_matrix_of(placement))
    if not placement.joints:
        return
    package = cached_package(placement.package)
    origins = link_origins(package)
    moved = link_displacements(package.links, package.joints, dict(placement.joints))
    names = prim_names((link.name for link in package.links), SCOPES)
    for link, name, T in zip(package.links, names, moved, strict=True):
        if not np.allclose(T, np.eye(4), atol=1e-9):
            prim = stage.OverridePrim(path.AppendChild(name))
            _place(UsdGeom.Xformable(prim), T @ shift(origins[link.name]))


def _add_item(stage: "Usd.Stage", path: "Sdf.Path", item: Item, T: Float[np.ndarray, "4 4"]) -> None:
    """A loose thing as a rigid body of its primitives."""
    from pxr import UsdGeom, UsdPhysics

    body = UsdGeom.Xform.Define(stage, path)
    _place(body, T)
    UsdPhysics.RigidBodyAPI.Apply(body.GetPrim())
    UsdPhysics.MassAPI.Apply(body.GetPrim()).CreateMassAttr().Set(item.mass)
    for index, (solid, color) in enumerate(thing_solids(item.thing, item.size)):
        _add_solid(stage, path.AppendChild(f"solid_{index}"), solid, item.colors[color])
