"""Surfaces in one Intel Embree scene: hits with attributes, also behind panes, and occlusion."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from artigen.shapes.surfaces.physical import PLAIN, Material, mirrored_head_on
from artigen.splats.colors import linear_from_srgb
from artigen.types import freeze_field
from sim_export.geometry.triangles import bounds_of, triangle_areas, triangle_normals
from sim_export.picture.shading import blend_corners, halve_texture, sample_cover, sample_texture

# embreex is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

OPAQUE = 0.99
"""Opacity above which a surface hides what is behind it."""
MOST_LAYERS = 8
"""Largest number of transparent surfaces along a ray."""
LIFT = 1e-6
"""Distance between a triangle and its front, relative to the scene's extent."""
BEYOND = 1e-5
"""Offset behind a transparent surface from which the next one is searched, relative to the scene's
diagonal."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Surface:
    """Triangles with unshared corners, ready for drawing, and their number in an id image.

    ``uv``, ``texture`` and ``normal_map`` as in `Mesh`; coordinates outside [0, 1] repeat the images.
    ``color`` is sRGB in [0, 1].
    """

    triangles: Float[np.ndarray, "F 3 3"]
    normals: Float[np.ndarray, "F 3 3"]
    id: int
    uv: Float[np.ndarray, "F 3 2"] | None = None
    texture: UInt8[np.ndarray, "H W C"] | None = None
    normal_map: UInt8[np.ndarray, "H W 3"] | None = None
    color: tuple[float, float, float] = (0.7, 0.7, 0.7)
    material: Material = PLAIN

    def __post_init__(self) -> None:
        count = len(freeze_field(self, "triangles", np.float64, (None, 3, 3), "surface triangles"))
        freeze_field(self, "normals", np.float64, (count, 3, 3), "surface normals")
        if (self.uv is None) != (self.texture is None and self.normal_map is None):
            raise ValueError("a surface has texture coordinates and an image, or neither")
        if self.uv is not None:
            freeze_field(self, "uv", np.float64, (count, 3, 2), "surface uv")
        if self.id < 0:
            raise ValueError(f"surface id is {self.id}, allowed is 0 and above (-1 means background)")

    @property
    def clear(self) -> bool:
        """Whether any part of it is transparent."""
        return self.texture is not None and self.texture.shape[2] == 4

    @cached_property
    def texels(self) -> float:
        """Texels of its texture along a metre of its surface, on the average."""
        if self.uv is None or self.texture is None:
            return 0.0
        laid = triangle_areas(np.pad(self.uv, ((0, 0), (0, 0), (0, 1)))).sum()
        area = triangle_areas(self.triangles).sum()
        height, width = self.texture.shape[:2]
        return float(np.sqrt(laid * height * width / max(area, 1e-12)))

    @property
    def repeats(self) -> bool:
        """Whether texture coordinates exceed [0, 1]."""
        uv = self.uv
        return uv is not None and len(uv) > 0 and bool(uv.min() < -1e-3 or uv.max() > 1.0 + 1e-3)


@dataclass(frozen=True, kw_only=True, eq=False)
class Scene:
    """All triangles of some surfaces, with Embree's hierarchy.

    Drawing programs often store a face twice, with opposite windings and two materials. Every triangle is
    therefore moved ahead of its back by `LIFT`, so that a ray meets the one whose front it sees.
    """

    surfaces: tuple[Surface, ...]
    owner: Int[np.ndarray, "T"]
    """Index of each triangle's surface."""
    normals: Float[np.ndarray, "T 3"]
    """Unit normals of the triangles, float32."""
    corner_normals: Float[np.ndarray, "T 3 3"]
    """Shading normals of their corners, float32."""
    bounds: Float[np.ndarray, "2 3"]
    """Lowest and highest corner of all triangles."""
    tree: object | None
    """embreex scene; None if there are no triangles."""

    @cached_property
    def levels(self) -> dict[int, tuple[UInt8[np.ndarray, "H W C"], ...]]:
        """Every texture and its halves, by its ``id``: surfaces share textures."""
        textures = {id(one.texture): one.texture for one in self.surfaces if one.texture is not None}
        return {key: halve_texture(texture) for key, texture in textures.items()}

    @property
    def diagonal(self) -> float:
        """Length of the diagonal of the bounds."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))


@dataclass(frozen=True, kw_only=True, eq=False)
class Hits:
    """Rays that hit a triangle: index, position on the triangle, and depth.

    ``triangle`` indexes all triangles of all surfaces.
    """

    place: Int[np.ndarray, "N"]
    triangle: Int[np.ndarray, "N"]
    weights: Float[np.ndarray, "N 3"]
    depth: Float[np.ndarray, "N"]


def build_scene(surfaces: Sequence[Surface]) -> Scene:
    """Combines surfaces into one scene; embreex uses float32."""
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    empty = np.zeros((0, 3, 3))
    triangles = np.concatenate([empty, *(surface.triangles for surface in surfaces)])
    normals = triangle_normals(triangles)
    corners = triangles.reshape(-1, 3)
    bounds = bounds_of(corners) if len(corners) else np.zeros((2, 3))
    tree = None
    if len(triangles):
        tree = rtcore_scene.EmbreeScene(robust=True)
        lift = LIFT * float(np.ptp(bounds, axis=0).max())
        TriangleMesh(tree, (triangles + lift * normals[:, None]).astype(np.float32))
    return Scene(
        surfaces=tuple(surfaces),
        owner=np.repeat(np.arange(len(surfaces)), [len(surface.triangles) for surface in surfaces]),
        normals=normals.astype(np.float32),
        corner_normals=np.concatenate([empty, *(one.normals for one in surfaces)]).astype(np.float32),
        bounds=bounds,
        tree=tree,
    )


def cast_layers(
    scene: Scene, origin: Float[np.ndarray, "3"], rays: Float[np.ndarray, "N 3"]
) -> list[tuple[Hits, Float[np.ndarray, "M"]]]:
    """Hits of rays from one origin, layer by layer through transparent surfaces, and their opacity."""
    left, starts = np.arange(len(rays)), np.zeros(len(rays), dtype=np.float32)
    clear = any(surface.clear for surface in scene.surfaces)
    layers: list[tuple[Hits, np.ndarray]] = []
    while len(left) and (clear or not layers) and len(layers) < MOST_LAYERS:
        hits = cast_rays(scene, origin + rays[left] * starts[:, None], rays[left])
        cover = cover_at(scene, hits)
        depth = starts[hits.place] + hits.depth
        layers.append((replace(hits, place=left[hits.place], depth=depth), cover))
        through = cover < OPAQUE
        step = BEYOND * scene.diagonal / np.linalg.norm(rays[left[hits.place]], axis=1)
        left, starts = left[hits.place][through], (depth + step)[through].astype(np.float32)
    return layers


def cast_rays(scene: Scene, origin: Float[np.ndarray, "*N 3"], rays: Float[np.ndarray, "N 3"]) -> Hits:
    """First hit of every ray, from a common or individual origins; depth is in units of each ray's length."""
    if scene.tree is None:
        none, flat = np.zeros(0, dtype=np.int64), np.zeros((0, 3), dtype=np.float32)
        return Hits(place=none, triangle=none, weights=flat, depth=flat[:, 0])
    origins = np.ascontiguousarray(np.broadcast_to(origin.astype(np.float32), rays.shape))
    found = scene.tree.run(origins, rays, output=True)
    place = np.flatnonzero(found["primID"] >= 0)
    triangle, u, v, depth = (found[name][place] for name in ("primID", "u", "v", "tfar"))
    return Hits(place=place, triangle=triangle, weights=np.stack([1.0 - u - v, u, v], axis=1), depth=depth)


def are_occluded(
    scene: Scene,
    origins: Float[np.ndarray, "N 3"],
    directions: Float[np.ndarray, "N 3"],
    limits: Float[np.ndarray, "N"],
) -> Bool[np.ndarray, "N"]:
    """True if something lies within ``limits`` (in units of the direction) of the origin."""
    if scene.tree is None or len(origins) == 0:
        return np.zeros(len(origins), dtype=bool)
    return scene.tree.run(origins, directions, limits, query="OCCLUDED") >= 0


def corner_normals_at(scene: Scene, hits: Hits) -> Float[np.ndarray, "N 3"]:
    """Interpolated shading normals at hits, not normalised."""
    return blend_corners(scene.corner_normals[hits.triangle], hits.weights)


def surface_ids_at(scene: Scene, hits: Hits) -> Int[np.ndarray, "N"]:
    """Ids of the surfaces that were hit."""
    return np.array([surface.id for surface in scene.surfaces], dtype=np.int64)[scene.owner[hits.triangle]]


def albedo_at(scene: Scene, hits: Hits, footprint: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N 3"]:
    """Colour of the surface at hits as linear light: its texture, or its plain colour.

    Args:
        scene: The scene.
        hits: Where rays meet it.
        footprint: Extent (m) of what a ray stands for on the surface, within which textures are averaged.
    """
    plain = linear_from_srgb(np.array([surface.color for surface in scene.surfaces]))
    albedo = plain.astype(np.float32)[scene.owner[hits.triangle]]
    for surface, texture, seen, uv in _find_texels(scene, hits):
        levels = scene.levels[id(texture)]
        blur = np.log2(np.maximum(surface.texels * footprint[seen], 1.0))
        level = np.minimum(np.rint(blur).astype(np.int64), len(levels) - 1)
        for number in np.unique(level):
            here = level == number
            smaller = levels[number][..., :3]
            albedo[seen[here]] = sample_texture(smaller, uv[here], repeat=surface.repeats)
    return albedo


def gloss_at(scene: Scene, hits: Hits) -> Float[np.ndarray, "N 3"]:
    """Roughness, metallic and the share mirrored head-on of the surface at hits."""
    looks = [surface.material for surface in scene.surfaces]
    table = np.array([(look.roughness, look.metallic, mirrored_head_on(look)) for look in looks])
    return table.reshape(-1, 3).astype(np.float32)[scene.owner[hits.triangle]]


def cover_at(scene: Scene, hits: Hits) -> Float[np.ndarray, "N"]:
    """Opacity of the surface at hits, in [0, 1]."""
    cover = np.ones(len(hits.place), dtype=np.float32)
    if any(surface.clear for surface in scene.surfaces):
        for surface, texture, seen, uv in _find_texels(scene, hits):
            if surface.clear:
                cover[seen] = sample_cover(texture[..., 3], uv, repeat=surface.repeats)
    return cover


def _find_texels(
    scene: Scene, hits: Hits
) -> Iterator[tuple[Surface, UInt8[np.ndarray, "H W C"], Int[np.ndarray, "M"], Float[np.ndarray, "M 2"]]]:
    """Surfaces with a texture, the texture, the hits on each, and their texture coordinates."""
    owner = scene.owner[hits.triangle]
    by_owner = np.argsort(owner, kind="stable")
    bounds = np.searchsorted(owner[by_owner], np.arange(len(scene.surfaces) + 1))
    start = 0  # of the surface among all triangles
    for index, surface in enumerate(scene.surfaces):
        seen = by_owner[bounds[index] : bounds[index + 1]]
        if surface.uv is not None and surface.texture is not None and len(seen):
            uv = blend_corners(surface.uv[hits.triangle[seen] - start], hits.weights[seen].astype(np.float64))
            yield surface, surface.texture, seen, uv
        start += len(surface.triangles)
