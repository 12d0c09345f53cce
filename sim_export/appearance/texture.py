"""Carries colours from surface samples or Gaussians over to part meshes as textures.

Vertex colours are ignored by the engines we write for, so every mesh gets an image. Each texel takes
the colour of the nearest sample of its part, where possible of one that faces the same way: the
inside of a thin wall does not show the outside's colour.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, UInt8
from scipy import ndimage
from scipy.spatial import KDTree

from artigen.types import Asset
from sim_export.appearance.atlas import Atlas, make_atlas
from sim_export.package import Mesh

DARKEST = 4
"""Darkest level of a texel: pure black means that nobody coloured it."""


@dataclass(frozen=True, kw_only=True)
class TextureConfig:
    """Resolution of textures and how samples are looked up."""

    texels_per_voxel: float = 2.5
    """Texels along the edge of a voxel; samples are seldom dense enough for more than three."""
    max_size: int = 512
    """Longest side of an image, texels; larger parts get larger texels."""
    uniform_range: int = 3
    """A part whose colours span at most this many of 255 levels gets a plain colour, no image."""
    facing_reach: float = 2.5
    """Texels; beyond this a sample that faces the texel's way gives way to the nearest of any facing."""
    beside: float = 1.5
    """Texels; of samples that lie so much further aside than the nearest none hides a lower sheet."""
    speck: int = 24
    """Levels by which a texel may differ from those around it before it counts as a speck."""
    sheet: float = 0.1
    """Texels; sheets further apart are told apart, and the outer one is shown; raise it when curved
    surfaces look ragged."""
    neighbours: int = 8
    """Samples looked at per texel; more make textures softer and slower."""
    least_facing: float = 0.2
    """Least cosine between a sample's normal and the axis that the texel faces."""
    max_samples: int = 300_000
    """Samples used per object; more cost time and are finer than the texels."""

    def __post_init__(self) -> None:
        if not self.texels_per_voxel > 0:
            raise ValueError(f"texture: texels_per_voxel is {self.texels_per_voxel}, expected above 0")
        if not 16 <= self.max_size <= 8192:
            raise ValueError(f"texture: max_size is {self.max_size} texels, expected 16 to 8192")


def bake_texture(
    mesh: Mesh,
    points: Float[np.ndarray, "N 3"],
    colors: UInt8[np.ndarray, "N 3"],
    *,
    texel_size: float,
    normals: Float[np.ndarray, "N 3"] | None = None,
    cfg: TextureConfig | None = None,
) -> Mesh:
    """The mesh with texture coordinates and an image, or with a plain colour if that is all there is.

    ``points`` (and ``texel_size``) are in the mesh's unit; colours are sRGB. Every texel of the image
    is filled, also between charts. Raises `ValueError` without samples.
    """
    cfg = cfg or TextureConfig()
    if len(points) == 0:
        raise ValueError("texture: no colour samples, expected at least 1")
    columns = np.ascontiguousarray(colors.T)
    mean = columns.mean(axis=1) / 255.0
    plain = replace(mesh, color=(float(mean[0]), float(mean[1]), float(mean[2])), uv=None, texture=None)
    if int(np.ptp(columns, axis=1).max()) <= cfg.uniform_range:
        return plain
    atlas = make_atlas(mesh, texel_size, cfg.max_size)
    filled = color_atlas(plain, atlas, _texel_colors(mesh, atlas, points, colors, normals, texel_size, cfg))
    return (
        filled
        if filled.texture is None
        else replace(filled, texture=_without_specks(filled.texture, cfg.speck))
    )


def _without_specks(image: UInt8[np.ndarray, "H W 3"], least: int) -> UInt8[np.ndarray, "H W 3"]:
    """Texels that differ from the median of the nine around them by more than ``least`` levels get that.

    Where sheets of different colours lie close together, the odd texel has no sample of the outer one.
    """
    median = ndimage.median_filter(image, size=(3, 3, 1), mode="nearest")
    odd = np.abs(image.astype(np.int16) - median).max(axis=2) > least
    return np.where(odd[:, :, None], median, image)


def color_atlas(mesh: Mesh, atlas: Atlas, colors: UInt8[np.ndarray, "T 3"]) -> Mesh:
    """The mesh with an image in which every covered texel has its colour, and others that of the nearest."""
    image = np.zeros((*atlas.shape, 3), dtype=np.uint8)
    image[tuple(atlas.texels.T)] = np.maximum(colors, DARKEST)
    covered = np.zeros(atlas.shape, dtype=bool)
    covered[tuple(atlas.texels.T)] = True
    nearest = np.zeros((2, *atlas.shape), dtype=np.int32)
    ndimage.distance_transform_edt(~covered, return_distances=False, return_indices=True, indices=nearest)
    height, width = atlas.shape
    uv = (atlas.corners + 0.5) / (width, height)
    uv[:, :, 1] = 1.0 - uv[:, :, 1]
    return replace(mesh, uv=uv, texture=image[tuple(nearest)])


def bake_parts(asset: Asset, meshes: Sequence[Mesh], cfg: TextureConfig | None = None) -> tuple[Mesh, ...]:
    """Textures for the meshes of all parts (metres) from the asset's surface samples or Gaussians.

    A part without a sample of its own keeps its mesh's plain colour. Raises `ValueError` when the
    asset has neither samples nor Gaussians.
    """
    cfg = cfg or TextureConfig()
    points, colors, normals, part_ids = _color_samples(asset)
    stride = max(1, -(-len(points) // cfg.max_samples))
    resolution = 64 if asset.voxels is None else asset.voxels.resolution
    texel_size = asset.scale / resolution / cfg.texels_per_voxel
    out = []
    for index, mesh in enumerate(meshes):
        rows = np.flatnonzero(part_ids == index)
        rows = rows[:: stride if len(rows) > 2000 * stride else 1]
        if not len(rows):
            out.append(mesh)
            continue
        facing = None if normals is None else normals[rows]
        out.append(
            bake_texture(
                mesh, points[rows] * asset.scale, colors[rows], texel_size=texel_size, normals=facing, cfg=cfg
            )
        )
    return tuple(out)


def _color_samples(asset: Asset) -> tuple[np.ndarray, np.ndarray, np.ndarray | None, np.ndarray]:
    """Points (unit cube), sRGB colours, normals if known, and part ids."""
    if asset.surface is not None:
        surface = asset.surface
        return surface.points.astype(np.float64), surface.colors, surface.normals, surface.part_ids
    if asset.gaussians is not None:
        gaussians = asset.gaussians
        linear = np.clip(gaussians.colors, 0.0, 1.0)
        srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        return (
            gaussians.means.astype(np.float64),
            np.rint(255 * srgb).astype(np.uint8),
            None,
            gaussians.part_ids,
        )
    raise ValueError(f"asset {asset.name!r} has neither surface samples nor Gaussians to take colours from")


def _texel_colors(
    mesh: Mesh,
    atlas: Atlas,
    points: np.ndarray,
    colors: np.ndarray,
    normals: np.ndarray | None,
    texel_size: float,
    cfg: TextureConfig,
) -> np.ndarray:
    """Colour of each covered texel: the mean of the samples that lie in it.

    Texels and samples are looked up by the axis they face, since sources hold coincident sheets of
    different colour that face opposite ways. Of several sheets that face the same way the outermost
    counts: it is the one that is seen, unless its nearest sample lies well aside of the texel.
    """
    if normals is None:
        return colors[_nearest(points, atlas.points, 1)[1][:, 0]]
    triangles = mesh.vertices[mesh.faces]
    facing = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])[atlas.faces]
    axis = np.abs(facing).argmax(axis=1)
    sign = np.sign(np.take_along_axis(facing, axis[:, None], axis=1)[:, 0])
    out = np.zeros((len(axis), 3), dtype=np.uint8)
    colored = np.zeros(len(axis), dtype=bool)
    for number, side in ((n, s) for n in range(3) for s in (-1.0, 1.0)):
        texels = np.flatnonzero((axis == number) & (sign == side))
        samples = np.flatnonzero(side * normals[:, number] > cfg.least_facing)
        if not len(texels) or not len(samples):
            continue
        reach = cfg.facing_reach * texel_size
        distance, index = _nearest(points[samples], atlas.points[texels], cfg.neighbours, reach)
        near = np.isfinite(distance)
        index[~near] = 0
        # Above the texel along the sample's own normal: equal for all samples of one sheet, slanted or not.
        above = points[samples[index]] - atlas.points[texels][:, None]
        beside = np.linalg.norm(np.delete(above, number, axis=2), axis=2)
        near &= beside <= beside.min(axis=1, keepdims=True) + cfg.beside * texel_size
        height = np.where(near, np.einsum("tkc,tkc->tk", above, normals[samples[index]]), -np.inf)
        near &= height >= height.max(axis=1, keepdims=True) - cfg.sheet * texel_size
        closest = np.where(near, distance, np.inf).min(axis=1, keepdims=True)
        near &= distance <= closest + 0.5 * texel_size
        weight = near / np.maximum(near.sum(axis=1, keepdims=True), 1)
        mean = np.einsum("tk,tkc->tc", weight, colors[samples[index]].astype(np.float32))
        found = near.any(axis=1)
        out[texels[found]] = np.rint(mean[found]).astype(np.uint8)
        colored[texels[found]] = True
    rest = np.flatnonzero(~colored)
    if len(rest):
        out[rest] = colors[_nearest(points, atlas.points[rest], 1)[1][:, 0]]
    return out


def _nearest(
    points: np.ndarray, queries: np.ndarray, count: int, reach: float = np.inf
) -> tuple[np.ndarray, np.ndarray]:
    """Distances to and indices of the nearest points, ``Q K``; beyond ``reach`` infinite and no index."""
    # Splitting in the middle builds several times faster, and box-tight trees gain nothing here.
    tree = KDTree(points, balanced_tree=False, compact_nodes=False, leafsize=16)
    shape = (len(queries), min(count, len(points)))
    distance, index = tree.query(queries, k=shape[1], distance_upper_bound=reach)
    return np.reshape(distance, shape), np.reshape(index, shape)
