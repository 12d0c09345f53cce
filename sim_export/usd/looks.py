"""Visual meshes and their materials: one UsdPreviewSurface for every texture or plain colour."""

import hashlib
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSemantics, UsdShade, Vt

from sim_export.files.obj import png_bytes
from sim_export.package import Mesh
from sim_export.usd.labels import Substance
from sim_export.usd.physics import add_mesh

# pxr is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

TEXTURES = "textures"
ROUGHNESS = 0.5


@dataclass(frozen=True, kw_only=True, eq=False)
class Looks:
    """The materials of a stage, and the images they refer to by file."""

    stage: Usd.Stage
    scope: str
    images: dict[str, bytes] = field(default_factory=dict)
    _made: dict[str, UsdShade.Material] = field(default_factory=dict)

    def add_visual(self, path: str, mesh: Mesh, origin: Float[np.ndarray, "3"], substance: Substance) -> None:
        """A mesh in the frame of a link that stands at ``origin``, with its material bound."""
        made = add_mesh(self.stage, path, mesh.vertices - origin, mesh.faces)
        made.GetDoubleSidedAttr().Set(value=True)
        if mesh.uv is not None:
            uv = Vt.Vec2fArray.FromNumpy(np.round(mesh.uv.reshape(-1, 2), 6).astype(np.float32))
            primvars = UsdGeom.PrimvarsAPI(made)
            primvars.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying").Set(uv)
        color = Vt.Vec3fArray([Gf.Vec3f(*self._mean(mesh))])
        made.CreateDisplayColorAttr(color)
        UsdShade.MaterialBindingAPI.Apply(made.GetPrim()).Bind(self._material(mesh, substance))

    @staticmethod
    def _mean(mesh: Mesh) -> tuple[float, float, float]:
        if mesh.texture is None:
            return mesh.color
        red, green, blue = np.round(mesh.texture[..., :3].mean(axis=(0, 1)) / 255.0, 4)
        return float(red), float(green), float(blue)

    def _material(self, mesh: Mesh, substance: Substance) -> UsdShade.Material:
        """The material of a mesh; equal ones are made once."""
        image = None if mesh.texture is None else png_bytes(mesh.texture)
        key = f"{mesh.color}" if image is None else hashlib.sha256(image).hexdigest()[:12]
        key = f"{substance.label} {key}"
        if key not in self._made:
            self._made[key] = self._make(f"{substance.label}_{len(self._made)}", mesh, image, substance)
        return self._made[key]

    def _make(self, name: str, mesh: Mesh, image: bytes | None, substance: Substance) -> UsdShade.Material:
        path = f"{self.scope}/{name}"
        material = UsdShade.Material.Define(self.stage, path)
        surface = UsdShade.Shader.Define(self.stage, f"{path}/surface")
        surface.CreateIdAttr("UsdPreviewSurface")
        surface.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(ROUGHNESS)
        metallic = 1.0 if substance.label == "steel" and image is None else 0.0
        surface.CreateInput("metallic", Sdf.ValueTypeNames.Float).Set(metallic)
        color = surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
        if image is None or mesh.texture is None:
            color.Set(Gf.Vec3f(*map(float, _linear(np.array(mesh.color)))))
        else:
            self.images[f"{TEXTURES}/{name}.png"] = image
            sampler = self._sample(path, f"./{TEXTURES}/{name}.png")
            color.ConnectToSource(sampler.CreateOutput("rgb", Sdf.ValueTypeNames.Float3))
            if mesh.texture.shape[2] == 4:
                opacity = surface.CreateInput("opacity", Sdf.ValueTypeNames.Float)
                opacity.ConnectToSource(sampler.CreateOutput("a", Sdf.ValueTypeNames.Float))
        output = surface.CreateOutput("surface", Sdf.ValueTypeNames.Token)
        material.CreateSurfaceOutput().ConnectToSource(output)
        prim = material.GetPrim()
        UsdSemantics.LabelsAPI.Apply(prim, "material").CreateLabelsAttr([substance.label])
        for what, value in (("base", substance.base), ("coating", "none"), ("attributes", "none")):
            token = Sdf.ValueTypeNames.Token
            prim.CreateAttribute(f"omni:simready:nonvisual:{what}", token, custom=False).Set(value)
        return material

    def _sample(self, path: str, file: str) -> UsdShade.Shader:
        reader = UsdShade.Shader.Define(self.stage, f"{path}/st")
        reader.CreateIdAttr("UsdPrimvarReader_float2")
        reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
        sampler = UsdShade.Shader.Define(self.stage, f"{path}/texture")
        sampler.CreateIdAttr("UsdUVTexture")
        sampler.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(file)
        sampler.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set("sRGB")
        for side in ("wrapS", "wrapT"):
            sampler.CreateInput(side, Sdf.ValueTypeNames.Token).Set("clamp")
        sampler.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(
            reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
        )
        return sampler


def _linear(srgb: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Linear light of a colour of the screen, as shaders take it."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
