"""Geometry of an OpenUSD stage as triangles in metres, z up, with the colours and images of its materials.

Materials are read from UsdPreviewSurface and, by the names of their inputs, from MDL (OmniPBR).
"""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from artigen.datasets.mesh_files import open_image

if TYPE_CHECKING:
    from PIL.Image import Image
    from pxr import Usd, UsdShade
    from trimesh import Trimesh

PLAIN = (0.7, 0.7, 0.7)
"""Colour (sRGB) of what has none."""
COORDINATES = ("st", "st0", "st_0", "UVMap", "uv", "map1", "Texture_uv")
"""Names of texture coordinates, most usual first."""
COLORS = ("diffuseColor", "diffuse_color_constant", "diffuse_tint", "base_color", "diffuse_reflection_color")
IMAGES = ("file", "diffuse_texture", "base_color_texture", "diffuse_reflection_color_image")
SECTIONS = 48


def read_gprim(prim: "Usd.Prim", T_world_prim: Float[np.ndarray, "4 4"]) -> "list[Trimesh]":
    """The triangles of a mesh, cube, sphere, cylinder, capsule or cone, one mesh per material.

    Args:
        T_world_prim: Any affine map, also one that mirrors.
    """
    from pxr import UsdGeom, UsdShade
    from trimesh import Trimesh

    found = _read_mesh(UsdGeom.Mesh(prim)) if prim.IsA(UsdGeom.Mesh) else _read_primitive(prim)
    if found is None:
        return []
    vertices, corners, faces = found
    moved = vertices @ T_world_prim[:3, :3].T + T_world_prim[:3, 3]
    if np.linalg.det(T_world_prim[:3, :3]) < 0:
        corners = corners[:, ::-1]
    coords = _read_coordinates(prim, int(corners.max()) + 1 if len(corners) else 0)
    whole = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
    groups = [(np.ones(len(faces), dtype=bool), whole)]
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        chosen = np.isin(faces, np.asarray(subset.GetIndicesAttr().Get() or (), dtype=np.int64))
        groups[0][0][chosen] = False
        groups.append((chosen, UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0]))
    points = _corner_points(prim, len(vertices))
    pieces = []
    for chosen, material in groups:
        if chosen.any():
            rows = corners[chosen].ravel()
            mesh = Trimesh(moved[points[rows]], np.arange(len(rows)).reshape(-1, 3), process=False)
            mesh.visual = _make_visual(prim, material, None if coords is None else coords[rows])
            pieces.append(mesh)
    return pieces


def _corner_points(prim: "Usd.Prim", count: int) -> Int[np.ndarray, "C"]:
    """Vertex of every corner of a mesh; those of a primitive are its vertices."""
    from pxr import UsdGeom

    if prim.IsA(UsdGeom.Mesh):
        return np.asarray(UsdGeom.Mesh(prim).GetFaceVertexIndicesAttr().Get(), dtype=np.int64)
    return np.arange(count)


def _read_mesh(mesh: "object") -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Vertices, corners of triangles (fans of the polygons), and the polygon of each triangle."""
    from pxr import UsdGeom

    assert isinstance(mesh, UsdGeom.Mesh)
    points, counts = mesh.GetPointsAttr().Get(), mesh.GetFaceVertexCountsAttr().Get()
    indices = mesh.GetFaceVertexIndicesAttr().Get()
    if not points or not counts or not indices:
        return None
    sides = np.asarray(counts, dtype=np.int64)
    vertices = np.asarray(points, dtype=np.float64)
    if sides.sum() != len(indices) or max(indices) >= len(points) or min(indices) < 0:
        raise ValueError(f"{mesh.GetPath()}: faces name vertices that are not there")
    if not np.isfinite(vertices).all():
        raise ValueError(f"{mesh.GetPath()}: a vertex is not finite")
    starts = np.cumsum(sides) - sides
    corners, faces = [], []
    for side in np.unique(sides[sides >= 3]).tolist():
        own = np.flatnonzero(sides == side)
        fan = np.array([[0, k, k + 1] for k in range(1, side - 1)])
        corners.append((starts[own][:, None, None] + fan).reshape(-1, 3))
        faces.append(np.repeat(own, side - 2))
    if not corners:
        return None
    order = np.concatenate(corners)
    if mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded:
        order = order[:, ::-1]
    return vertices, order, np.concatenate(faces)


def _read_primitive(prim: "Usd.Prim") -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    from pxr import UsdGeom
    from trimesh import creation

    def number(name: str) -> float:
        return float(prim.GetAttribute(name).Get())

    if prim.IsA(UsdGeom.Cube):
        mesh = creation.box(np.full(3, number("size")))
    elif prim.IsA(UsdGeom.Sphere):
        mesh = creation.icosphere(subdivisions=3, radius=number("radius"))
    elif prim.IsA(UsdGeom.Cylinder):
        mesh = creation.cylinder(radius=number("radius"), height=number("height"), sections=SECTIONS)
    elif prim.IsA(UsdGeom.Capsule):
        mesh = creation.capsule(radius=number("radius"), height=number("height"), count=(24, SECTIONS))
        mesh.apply_translation(-mesh.bounds.mean(axis=0))
    elif prim.IsA(UsdGeom.Cone):
        mesh = creation.cone(radius=number("radius"), height=number("height"), sections=SECTIONS)
        mesh.apply_translation(-mesh.bounds.mean(axis=0))
    else:
        return None
    axis = prim.GetAttribute("axis").Get() if prim.HasAttribute("axis") else "Z"
    turn = {"X": [2, 0, 1], "Y": [1, 2, 0], "Z": [0, 1, 2]}[axis]  # z becomes the axis, right-handed
    vertices = np.asarray(mesh.vertices)[:, turn]
    return vertices, np.asarray(mesh.faces), np.arange(len(mesh.faces))


def _read_coordinates(prim: "Usd.Prim", corners: int) -> Float[np.ndarray, "C 2"] | None:
    """Texture coordinates of every corner of a mesh."""
    from pxr import UsdGeom

    primvars = UsdGeom.PrimvarsAPI(prim)
    found = [primvars.FindPrimvarWithInheritance(name) for name in COORDINATES]
    found += [one for one in primvars.GetPrimvars() if "texCoord2" in str(one.GetTypeName())]
    for primvar in found:
        values = primvar.ComputeFlattened() if primvar and primvar.HasValue() else None
        if values is None or not len(values) or np.ndim(values) != 2:
            continue
        uv = np.asarray(values, dtype=np.float64)
        if primvar.GetInterpolation() in (UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying):
            points = _corner_points(prim, len(uv))
            return uv[points] if int(points.max()) < len(uv) else None
        if primvar.GetInterpolation() == UsdGeom.Tokens.faceVarying and len(uv) >= corners:
            return uv
    return None


def _make_visual(prim: "Usd.Prim", material: "UsdShade.Material", uv: np.ndarray | None):
    """The look of a mesh: of its material, or else its display colour."""
    from pxr import UsdGeom
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    gprim = UsdGeom.Gprim(prim)
    color, opacity, image = (
        _mean(gprim.GetDisplayColorAttr().Get()),
        gprim.GetDisplayOpacityAttr().Get(),
        None,
    )
    alpha = float(np.mean(opacity)) if opacity else 1.0
    if material:
        color, alpha, image = _read_material(material, color, alpha)
    factor = np.ones(3) if image is not None else np.array(PLAIN) if color is None else _to_srgb(color)
    mode = "OPAQUE" if alpha == 1.0 else "BLEND"
    pbr = PBRMaterial(
        baseColorFactor=[*np.clip(factor, 0.0, 1.0), alpha], baseColorTexture=image, alphaMode=mode
    )
    return TextureVisuals(uv=uv, material=pbr)


def _to_srgb(color: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Colours of a stage are linear, those of files and images are not."""
    linear = np.clip(color, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)


def _mean(colors: object) -> np.ndarray | None:
    return np.asarray(colors, dtype=float).reshape(-1, 3).mean(axis=0) if colors else None


def _read_material(
    material: "UsdShade.Material", color: np.ndarray | None, alpha: float
) -> "tuple[np.ndarray | None, float, Image | None]":
    """Colour, opacity and image of a material; what it does not say stays."""
    from pxr import Usd, UsdShade

    image = None
    for prim in Usd.PrimRange(material.GetPrim(), Usd.TraverseInstanceProxies()):
        shader = UsdShade.Shader(prim)
        if not shader:
            continue
        kind = shader.GetIdAttr().Get() or ""
        for name in COLORS:
            value = shader.GetInput(name).Get() if shader.GetInput(name) else None
            color = np.asarray(value, dtype=float)[:3] if value is not None else color
        for name in ("opacity", "opacity_constant"):
            value = shader.GetInput(name).Get() if shader.GetInput(name) else None
            used = shader.GetInput("enable_opacity").Get() if shader.GetInput("enable_opacity") else True
            alpha = float(value) if value is not None and used else alpha
        if kind == "UsdUVTexture" and not _feeds_color(material, shader):
            continue
        for name in IMAGES:
            value = shader.GetInput(name).Get() if shader.GetInput(name) else None
            image = image or (None if value is None else _open_asset(value))
    return color, alpha, image


def _feeds_color(material: "UsdShade.Material", texture: "UsdShade.Shader") -> bool:
    """Whether the diffuse colour of a material comes from a texture."""
    surface = material.ComputeSurfaceSource()[0]
    said = surface.GetInput("diffuseColor") if surface else None
    if not said or not said.HasConnectedSource():
        return False
    return said.GetConnectedSource()[0].GetPrim() == texture.GetPrim()


def _open_asset(asset: "object") -> "Image | None":
    """The image of an asset, also one inside a USDZ; None if it is missing."""
    from pxr import Ar, Sdf

    assert isinstance(asset, Sdf.AssetPath)
    opened = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(asset.resolvedPath)) if asset.resolvedPath else None
    if opened is None:
        return None
    return open_image(BytesIO(opened.GetBuffer()), asset.path)
