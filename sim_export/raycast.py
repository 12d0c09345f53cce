"""Many surfaces in one Intel Embree scene: first hits with their attributes, and occlusion."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from artigen.types import frozen_array
from sim_export.shading import linear_from_srgb, sample_textures

# embreex is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false


@dataclass(frozen=True, kw_only=True, eq=False)
class Surface:
    """Triangles ready to be drawn, as loose corners, with the number they get in an id image.

    ``uv`` and ``texture`` as in `Mesh`; coordinates outside [0, 1] repeat the texture. ``color`` is
    sRGB in [0, 1].
    """

    triangles: Float[np.ndarray, "F 3 3"]
    normals: Float[np.ndarray, "F 3 3"]
    id: int = 0
    uv: Float[np.ndarray, "F 3 2"] | None = None
    texture: UInt8[np.ndarray, "H W 3"] | None = None
    color: tuple[float, float, float] = (0.7, 0.7, 0.7)

    def __post_init__(self) -> None:
        triangles = frozen_array(self.triangles, np.float64, (None, 3, 3), "surface triangles")
        normals = frozen_array(self.normals, np.float64, (len(triangles), 3, 3), "surface normals")
        object.__setattr__(self, "triangles", triangles)
        object.__setattr__(self, "normals", normals)
        if (self.uv is None) != (self.texture is None):
            raise ValueError("a surface has texture coordinates and a texture, or neither")
        if self.uv is not None:
            object.__setattr__(
                self, "uv", frozen_array(self.uv, np.float64, (len(triangles), 3, 2), "surface uv")
            )
        if self.id < 0:
            raise ValueError(f"surface id is {self.id}, allowed is 0 and above (-1 means background)")


@dataclass(frozen=True, kw_only=True, eq=False)
class Hits:
    """First hits of a bundle of rays: the triangle (-1 for none), its corner weights, and the depth."""

    triangle: Int[np.ndarray, "N"]
    weights: Float[np.ndarray, "N 3"]
    depth: Float[np.ndarray, "N"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """All triangles of some surfaces with their attributes, and Embree's hierarchy over them."""

    surfaces: tuple[Surface, ...]
    owner: Int[np.ndarray, "T"]
    """Index of each triangle's surface."""
    triangles: Float[np.ndarray, "T 3 3"]
    tree: object | None
    """embreex scene; None when there are no triangles."""

    @cached_property
    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest corner of all triangles."""
        corners = self.triangles.reshape(-1, 3)
        return np.stack([corners.min(axis=0), corners.max(axis=0)])

    @property
    def diagonal(self) -> float:
        """Length of the diagonal of the bounds."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))


def build_scene(surfaces: Sequence[Surface]) -> Scene:
    """Puts surfaces into one scene; embreex works in float32."""
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    counts = [len(surface.triangles) for surface in surfaces]
    empty = np.zeros((0, 3, 3))
    triangles = np.concatenate([empty, *(surface.triangles for surface in surfaces)]).astype(np.float32)
    tree = None
    if len(triangles):
        tree = rtcore_scene.EmbreeScene(robust=True)
        TriangleMesh(tree, triangles)
    return Scene(
        surfaces=tuple(surfaces),
        owner=np.repeat(np.arange(len(counts)), counts),
        triangles=triangles,
        tree=tree,
    )


def cast_rays(scene: Scene, origin: Float[np.ndarray, "3"], rays: Float[np.ndarray, "N 3"]) -> Hits:
    """First hit of every ray from one origin; depth is in units of each ray's length."""
    if scene.tree is None:
        missed = np.full(len(rays), -1)
        return Hits(
            triangle=missed, weights=np.zeros((len(rays), 3), np.float32), depth=np.full(len(rays), np.inf)
        )
    origins = np.broadcast_to(origin.astype(np.float32), rays.shape)
    found = scene.tree.run(np.ascontiguousarray(origins), rays, output=True)
    u, v = found["u"], found["v"]
    depth = np.where(found["primID"] >= 0, found["tfar"], np.float32(np.inf))
    return Hits(triangle=found["primID"], weights=np.stack([1.0 - u - v, u, v], axis=1), depth=depth)


def are_occluded(
    scene: Scene,
    origins: Float[np.ndarray, "N 3"],
    directions: Float[np.ndarray, "N 3"],
    limits: Float[np.ndarray, "N"],
) -> Bool[np.ndarray, "N"]:
    """True where something lies within ``limits`` (in units of the direction) of the origin."""
    if scene.tree is None or len(origins) == 0:
        return np.zeros(len(origins), dtype=bool)
    return scene.tree.run(origins, directions, limits, query="OCCLUDED") >= 0


def corner_normals_at(
    scene: Scene, triangle: Int[np.ndarray, "N"], weights: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "N 3"]:
    """Interpolated corner normals at hits, not normalised."""
    normals = np.concatenate([surface.normals for surface in scene.surfaces]).astype(np.float32)
    return np.einsum("nk,nkc->nc", weights, normals[triangle])


def face_normals_at(scene: Scene, triangle: Int[np.ndarray, "N"]) -> Float[np.ndarray, "N 3"]:
    """Normals of the hit triangles, not normalised."""
    edges = scene.triangles[:, 1:] - scene.triangles[:, :1]
    return np.cross(edges[:, 0], edges[:, 1])[triangle]


def albedo_at(
    scene: Scene, triangle: Int[np.ndarray, "N"], weights: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "N 3"]:
    """Colour of the surface at hits as linear light: its texture, or its plain colour."""
    plain = linear_from_srgb(np.array([surface.color for surface in scene.surfaces]))
    owner = scene.owner[triangle]
    albedo = plain.astype(np.float32)[owner]
    textured = np.array([surface.texture is not None for surface in scene.surfaces])
    if not textured.any():
        return albedo
    atlas, layout = _pack_textures(scene.surfaces)
    uv = np.concatenate([
        np.zeros((len(surface.triangles), 3, 2)) if surface.uv is None else surface.uv
        for surface in scene.surfaces
    ])  # fmt: skip
    mask = textured[owner]
    at = np.einsum("nk,nkc->nc", weights[mask].astype(np.float64), uv[triangle[mask]])
    albedo[mask] = sample_textures(atlas, layout[owner[mask]], at)
    return albedo


def _pack_textures(
    surfaces: Sequence[Surface],
) -> tuple[UInt8[np.ndarray, "M 3"], Int[np.ndarray, "S 4"]]:
    rows: list[np.ndarray] = []
    first_of: dict[int, int] = {}
    layout = np.ones((len(surfaces), 4), dtype=np.int64)
    used = 0
    for index, surface in enumerate(surfaces):
        if surface.texture is None or surface.uv is None:
            continue
        height, width = surface.texture.shape[:2]
        if id(surface.texture) not in first_of:
            first_of[id(surface.texture)] = used
            rows.append(surface.texture.reshape(-1, 3))
            used += height * width
        repeats = len(surface.uv) > 0 and (surface.uv.min() < -1e-3 or surface.uv.max() > 1.0 + 1e-3)
        layout[index] = first_of[id(surface.texture)], width, height, repeats
    return np.concatenate(rows), layout
