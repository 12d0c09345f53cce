"""Visual meshes and their materials, with an image or a plain colour.

Every material says the same twice: as a UsdPreviewSurface, and as an OpenPBR surface of MaterialX.
"""

# usd-core has no type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

import hashlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.kind import MaterialName
from artigen.splats.colors import linear_from_srgb
from sim_export.files.obj import png_bytes
from sim_export.geometry.normals import corner_normals
from sim_export.geometry.triangles import bounds_of
from sim_export.package import Mesh, Visual
from sim_export.usd.labels import MATERIAL_WORDS, NONVISUAL_BASES, add_label, label_part

if TYPE_CHECKING:
    from pxr import Sdf, Usd, UsdGeom, UsdShade

TEXTURES = "textures"


@dataclass(frozen=True, kw_only=True, eq=False)
class Looks:
    """Parent of the materials, and the image files they refer to, by their path beside the USD file."""

    stage: "Usd.Stage"
    scope: "Sdf.Path"
    files: dict[str, bytes] = field(default_factory=dict)
    made: "dict[tuple[str, MaterialName], UsdShade.Material]" = field(default_factory=dict)
    """Materials by what they are and what they are made of, which visuals share."""


def add_visual(
    looks: Looks, path: "Sdf.Path", visual: Visual, mesh: Mesh, made_of: MaterialName, offset: np.ndarray
) -> None:
    """Adds one mesh of a visual with its material, of the same name where it is unknown what it is.

    Args:
        path: Path of the new prim, below its link's.
        offset: The link's origin in the object frame (m), which is subtracted.
    """
    from pxr import Gf, Sdf, UsdGeom, UsdShade, Vt

    shape = define_mesh(looks.stage, path, mesh.vertices - offset, mesh.faces)
    normals = corner_normals(mesh.vertices[mesh.faces]).reshape(-1, 3)
    shape.CreateNormalsAttr().Set(Vt.Vec3fArray.FromNumpy(normals.astype(np.float32)))
    shape.SetNormalsInterpolation(UsdGeom.Tokens.faceVarying)
    color = np.array(mesh.color)
    if mesh.uv is not None:
        st = UsdGeom.PrimvarsAPI(shape).CreatePrimvar(
            "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying
        )
        st.Set(Vt.Vec2fArray.FromNumpy(mesh.uv.reshape(-1, 2).astype(np.float32)))
    if mesh.texture is not None:
        color = mesh.texture[::8, ::8, :3].mean(axis=(0, 1)) / 255.0
    linear = np.clip(linear_from_srgb(color), 0.0, 1.0).tolist()
    shape.CreateDisplayColorAttr().Set([Gf.Vec3f(*linear)])
    label_part(shape.GetPrim(), visual.label)
    key = mesh.material.name or path.name, made_of
    if key not in looks.made:
        taken = {material.GetPath().name for material in looks.made.values()}
        name = next(name for name in (key[0], f"{key[0]}_{made_of}") if name not in taken)
        looks.made[key] = _add_material(looks, name, mesh, linear, made_of)
    material = looks.made[key]
    UsdShade.MaterialBindingAPI.Apply(shape.GetPrim()).Bind(material)


def define_mesh(
    stage: "Usd.Stage", path: "Sdf.Path", vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]
) -> "UsdGeom.Mesh":
    """A mesh prim of triangles with its extent; no subdivision, no normals."""
    from pxr import UsdGeom, Vt

    mesh = UsdGeom.Mesh.Define(stage, path)
    points = np.ascontiguousarray(vertices, dtype=np.float32)
    mesh.CreatePointsAttr().Set(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexCountsAttr().Set(Vt.IntArray.FromNumpy(np.full(len(faces), 3, np.int32)))
    mesh.CreateFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(faces.astype(np.int32).ravel()))
    mesh.CreateSubdivisionSchemeAttr().Set(UsdGeom.Tokens.none)
    mesh.CreateExtentAttr().Set(Vt.Vec3fArray.FromNumpy(bounds_of(points)))
    return mesh


def _add_material(
    looks: Looks, name: str, mesh: Mesh, color: list[float], made_of: MaterialName
) -> "UsdShade.Material":
    """A material of two surfaces with an image and its alpha, or with one linear colour."""
    from pxr import Gf, Sdf, UsdShade

    said = mesh.material

    types = Sdf.ValueTypeNames
    path = looks.scope.AppendChild(name)
    material = UsdShade.Material.Define(looks.stage, path)
    surface = UsdShade.Shader.Define(looks.stage, path.AppendChild("surface"))
    surface.CreateIdAttr("UsdPreviewSurface")
    for key, value in (
        ("roughness", said.roughness),
        ("metallic", said.metallic),
        ("ior", said.ior),
        ("clearcoat", said.coat),
        ("clearcoatRoughness", said.coat_roughness),
        *((("opacity", said.opacity),) if said.opacity < 1.0 else ()),
    ):
        surface.CreateInput(key, types.Float).Set(value)
    diffuse = surface.CreateInput("diffuseColor", types.Color3f)
    masked = mesh.texture is not None and mesh.texture.shape[2] == 4
    transparent = masked or said.opacity < 1.0
    if mesh.normal_map is not None:
        file = Sdf.AssetPath(f"./{_keep_image(looks, mesh.normal_map)}")
        sampler = _add_sampler(looks, path.AppendChild("normals"), file, "raw")
        for word, value in (
            ("scale", Gf.Vec4f(2.0, 2.0, 2.0, 1.0)),
            ("bias", Gf.Vec4f(-1.0, -1.0, -1.0, 0.0)),
        ):
            sampler.CreateInput(word, types.Float4).Set(value)
        normal = surface.CreateInput("normal", types.Normal3f)
        normal.ConnectToSource(sampler.CreateOutput("rgb", types.Float3))
    if mesh.texture is None:
        diffuse.Set(Gf.Vec3f(*color))
    else:
        file = Sdf.AssetPath(f"./{_keep_image(looks, mesh.texture)}")
        image = _add_sampler(looks, path.AppendChild("image"), file, "sRGB")
        diffuse.ConnectToSource(image.CreateOutput("rgb", types.Float3))
        if masked:
            # Alpha is not a colour: a second sampler reads the same image as raw data.
            alpha = _add_sampler(looks, path.AppendChild("alpha"), file, "raw")
            opacity = surface.CreateInput("opacity", types.Float)
            opacity.ConnectToSource(alpha.CreateOutput("a", types.Float))
    material.CreateSurfaceOutput().ConnectToSource(surface.CreateOutput("surface", types.Token))
    _add_open_pbr(looks, material, mesh, color)
    prim = material.GetPrim()
    add_label(prim, "material", MATERIAL_WORDS[made_of])
    # The coating is unknown, so that attribute has no value.
    prim.CreateAttribute("omni:simready:nonvisual:base", types.Token).Set(NONVISUAL_BASES[made_of])
    prim.CreateAttribute("omni:simready:nonvisual:coating", types.Token)
    prim.CreateAttribute("omni:simready:nonvisual:attributes", types.TokenArray).Set(
        ["visually_transparent" if transparent else "none"]
    )
    return material


def _add_open_pbr(looks: Looks, material: "UsdShade.Material", mesh: Mesh, color: list[float]) -> None:
    """The same material as a network of MaterialX."""
    from pxr import Gf, Sdf, UsdShade

    types, said, path = Sdf.ValueTypeNames, mesh.material, material.GetPath()
    surface = UsdShade.Shader.Define(looks.stage, path.AppendChild("open_pbr"))
    surface.CreateIdAttr("ND_open_pbr_surface_surfaceshader")
    for key, value in (
        ("base_metalness", said.metallic),
        ("specular_roughness", said.roughness),
        ("specular_ior", said.ior),
        ("coat_weight", said.coat),
        ("coat_roughness", said.coat_roughness),
        ("geometry_opacity", said.opacity),
    ):
        surface.CreateInput(key, types.Float).Set(value)
    base = surface.CreateInput("base_color", types.Color3f)

    def sample(name: str, width: str, texture: np.ndarray, space: str) -> UsdShade.Shader:
        place = UsdShade.Shader.Define(looks.stage, path.AppendChild("mtlx_coordinates"))
        place.CreateIdAttr("ND_geompropvalue_vector2")
        place.CreateInput("geomprop", types.String).Set("st")
        image = UsdShade.Shader.Define(looks.stage, path.AppendChild(name))
        image.CreateIdAttr(f"ND_image_{width}")
        file = image.CreateInput("file", types.Asset)
        file.Set(Sdf.AssetPath(f"./{_keep_image(looks, texture)}"))
        file.GetAttr().SetColorSpace(space)
        image.CreateInput("texcoord", types.Float2).ConnectToSource(place.CreateOutput("out", types.Float2))
        return image

    if mesh.normal_map is not None:
        image = sample("mtlx_normals", "vector3", mesh.normal_map, "raw")
        turned = UsdShade.Shader.Define(looks.stage, path.AppendChild("mtlx_normal_map"))
        turned.CreateIdAttr("ND_normalmap_float")  # MaterialX 1.39, as OpenPBR is
        turned.CreateInput("in", types.Vector3f).ConnectToSource(image.CreateOutput("out", types.Vector3f))
        normal = surface.CreateInput("geometry_normal", types.Vector3f)
        normal.ConnectToSource(turned.CreateOutput("out", types.Vector3f))
    if mesh.texture is None:
        base.Set(Gf.Vec3f(*color))
    else:
        image = sample("mtlx_image", "color3", mesh.texture, "srgb_texture")
        base.ConnectToSource(image.CreateOutput("out", types.Color3f))
    material.CreateSurfaceOutput("mtlx").ConnectToSource(surface.CreateOutput("out", types.Token))


def _add_sampler(looks: Looks, path: "Sdf.Path", file: "Sdf.AssetPath", space: str) -> "UsdShade.Shader":
    """A node that reads an image in a colour space, ``sRGB`` or ``raw``."""
    from pxr import Sdf, UsdShade

    types = Sdf.ValueTypeNames
    reader = UsdShade.Shader.Define(looks.stage, path.GetParentPath().AppendChild("coordinates"))
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", types.String).Set("st")
    image = UsdShade.Shader.Define(looks.stage, path)
    image.CreateIdAttr("UsdUVTexture")
    image.CreateInput("file", types.Asset).Set(file)
    image.CreateInput("sourceColorSpace", types.Token).Set(space)
    image.CreateInput("wrapS", types.Token).Set("repeat")
    image.CreateInput("wrapT", types.Token).Set("repeat")
    image.CreateInput("st", types.Float2).ConnectToSource(reader.CreateOutput("result", types.Float2))
    return image


def _keep_image(looks: Looks, texture: UInt8[np.ndarray, "H W C"]) -> str:
    """Stores an image under a name derived from its pixels, so that equal images share one file; returns its
    path."""
    digest = hashlib.sha256(f"{texture.shape}".encode() + texture.tobytes()).hexdigest()
    path = f"{TEXTURES}/texture_{digest[:12]}.png"
    if path not in looks.files:
        looks.files[path] = png_bytes(texture)
    return path
