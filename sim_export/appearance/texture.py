"""Bakes the colours of Gaussians or surface samples into textures of part meshes.

The supported engines ignore vertex colours, so every mesh gets an image. Each texel shows the Gaussians of
its own part as seen along the surface normal (`sim_export.appearance.blending`), also inside drawers and
cabinets. Panes are as transparent as their Gaussians. Surface samples are converted to discs first. Uncovered
texels take the colour of the nearest covered texel of the part, and are counted.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, UInt8
from scipy import ndimage
from scipy.spatial import KDTree

from artigen.splats.colors import srgb_from_linear
from artigen.splats.motion import scale_gaussians
from artigen.splats.parts import select_gaussians
from artigen.splats.surface import SurfaceSplatConfig, splat_surface, thin_samples
from artigen.transforms import matrix_from_quat
from artigen.types import Asset, Gaussians
from sim_export.appearance.atlas import Atlas, make_atlas
from sim_export.appearance.blending import LEAST_COVER, SOLID, Places, blend_places
from sim_export.geometry.triangles import area_normals
from sim_export.package import Mesh

DARKEST = 4
"""Darkest level of a texel; pure black marks texels that were not painted."""


TEXELS = 2.5
"""Texels along the edge of a voxel; samples are rarely dense enough for more than three."""
MAX_SIZE = 512
"""Longest side of an image in texels; larger parts get larger texels."""
UNIFORM_RANGE = 3
"""Colour range (of 255 levels) up to which a part gets one colour instead of an image."""
MAX_SAMPLES = 300_000
"""Surface samples used per object; more take time without adding detail at texel size."""
SPECK = 24
"""Difference (levels) from the surrounding texels above which a texel counts as a speck."""
DISCS = SurfaceSplatConfig(spread=0.8, edge=1.0, neighbours=4, widest=2.0, apart=0.0)
"""Discs for surface samples; round also at edges, where their overhang lies beside the mesh."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BakedMesh:
    """A coloured mesh, with the number of texels and of those covered by Gaussians."""

    mesh: Mesh
    texels: int = 0
    covered: int = 0


@dataclass(frozen=True, kw_only=True, eq=False)
class BakedParts:
    """The coloured meshes of all parts; ``records`` states the coverage."""

    meshes: tuple[Mesh, ...]
    records: tuple[str, ...]


def bake_mesh(
    mesh: Mesh, gaussians: Gaussians, *, voxel: float, normals: Float[np.ndarray, "N 3"] | None = None
) -> BakedMesh:
    """Textures a mesh with an image, or gives it one colour if its Gaussians have only one.

    Every texel of the image is filled, also between charts.

    Args:
        gaussians: Gaussians of the part, in the mesh's frame and unit.
        voxel: Edge of a voxel, in the same unit; determines the texel size and the search radius.
        normals: Outward directions of the Gaussians, if they are one-sided.

    Raises:
        ValueError: If there are no Gaussians, or the charts of the mesh do not fit into an image.
    """
    if not len(gaussians.means):
        raise ValueError("texture: no Gaussians, expected at least 1")
    levels = np.rint(255.0 * np.clip(srgb_from_linear(gaussians.colors), 0.0, 1.0))
    red, green, blue = (levels.mean(axis=0) / 255.0).tolist()
    plain = replace(mesh, color=(red, green, blue), uv=None, texture=None)
    if np.ptp(levels, axis=0).max() <= UNIFORM_RANGE and gaussians.opacities.min() >= SOLID:
        return BakedMesh(mesh=plain)
    texel = voxel / TEXELS
    atlas = make_atlas(mesh, texel, MAX_SIZE)
    places = _texel_places(mesh, atlas)
    seen = blend_places(places, gaussians, voxel=voxel, texel=texel, normals=normals)
    pane = seen.find_panes()
    colors, covered = seen.colors.copy(), (seen.cover >= LEAST_COVER) | pane
    if normals is not None and not covered.all():
        # A single sheet colours both sides of its wall.
        rest = Places(points=places.points[~covered], normals=places.normals[~covered])
        behind = blend_places(rest, gaussians, voxel=voxel, texel=texel)
        colors[~covered], covered[~covered] = behind.colors, behind.cover >= LEAST_COVER
    if not covered.any():
        return BakedMesh(mesh=plain, texels=len(covered))
    filled = _fill(colors, covered, places.points)
    if pane.any():  # light passes two sides of a pane, so each side gets half of the optical depth
        cover = np.where(pane, 1.0 - np.sqrt(1.0 - seen.cover.clip(0.0, 1.0)), 1.0)
        filled = np.concatenate([filled, cover[:, None]], axis=1)
    image = np.rint(255.0 * np.clip(filled, 0.0, 1.0)).astype(np.uint8)
    painted = color_atlas(plain, atlas, image)
    if normals is not None and painted.texture is not None:
        painted = replace(painted, texture=_without_specks(painted.texture))
    return BakedMesh(mesh=painted, texels=len(covered), covered=int(np.count_nonzero(covered)))


def bake_parts(asset: Asset, meshes: Sequence[Mesh]) -> BakedParts:
    """Textures for the meshes of all parts (metres), from the asset's Gaussians or else its surface samples.

    A part without either keeps its mesh's colour, and a record says so. Raises `ValueError` if the asset has
    neither.
    """
    gaussians, normals = _find_gaussians(asset)
    voxel = asset.scale / (64 if asset.voxels is None else asset.voxels.resolution)
    baked: list[BakedMesh] = []
    records: list[str] = []
    for index, (part, mesh) in enumerate(zip(asset.parts, meshes, strict=True)):
        rows = np.flatnonzero(gaussians.part_ids == index)
        if not len(rows):
            records.append(f"{part.name}: no colour samples; its default colour is kept")
            baked.append(BakedMesh(mesh=mesh))
            continue
        facing = None if normals is None else normals[rows]
        own = select_gaussians(gaussians, rows)
        baked.append(bake_mesh(mesh, own, voxel=voxel, normals=facing))
    texels, covered = sum(one.texels for one in baked), sum(one.covered for one in baked)
    if texels:
        source = "surface samples" if asset.gaussians is None else "Gaussians"
        records.append(
            f"textures: {source} of the own part cover {100.0 * covered / texels:.2f} % of {texels} texels; "
            "the others take the colour of the nearest"
        )
    return BakedParts(meshes=tuple(one.mesh for one in baked), records=tuple(records))


def color_atlas(mesh: Mesh, atlas: Atlas, colors: UInt8[np.ndarray, "T C"]) -> Mesh:
    """Adds an image with the colours of the covered texels; the others take the colour of the nearest.

    An optional fourth channel is the opacity; a median filter removes isolated values.
    """
    image = np.zeros((*atlas.shape, colors.shape[1]), dtype=np.uint8)
    image[tuple(atlas.texels.T)] = np.maximum(colors, DARKEST)
    covered = np.zeros(atlas.shape, dtype=bool)
    covered[tuple(atlas.texels.T)] = True
    nearest = np.zeros((2, *atlas.shape), dtype=np.int32)
    ndimage.distance_transform_edt(~covered, return_distances=False, return_indices=True, indices=nearest)
    height, width = atlas.shape
    uv = (atlas.corners + 0.5) / (width, height)
    uv[:, :, 1] = 1.0 - uv[:, :, 1]
    whole = image[tuple(nearest)]
    whole[..., 3:] = ndimage.median_filter(whole[..., 3:], size=(3, 3, 1), mode="nearest")
    return replace(mesh, uv=uv, texture=whole)


def _without_specks(image: UInt8[np.ndarray, "H W 3"]) -> UInt8[np.ndarray, "H W 3"]:
    """Replaces texels that differ from their 3x3 median by more than `SPECK` levels with the median.

    Where sheets of different colours lie close together, some texels have no sample of the outer one.
    """
    median = ndimage.median_filter(image, size=(3, 3, 1), mode="nearest")
    odd = np.abs(image.astype(np.int16) - median).max(axis=2) > SPECK
    return np.where(odd[:, :, None], median, image)


def _find_gaussians(asset: Asset) -> tuple[Gaussians, Float[np.ndarray, "N 3"] | None]:
    """Gaussians in metres, and their outward directions if they are one-sided."""
    if asset.gaussians is not None:
        return scale_gaussians(asset.gaussians, asset.scale), None
    if asset.surface is None:
        raise ValueError(
            f"asset {asset.name!r} has neither Gaussians nor surface samples to take colours from"
        )
    discs = splat_surface(thin_samples(asset.surface, MAX_SAMPLES), DISCS)
    return scale_gaussians(discs, asset.scale), matrix_from_quat(discs.quats)[:, :, 2]


def _texel_places(mesh: Mesh, atlas: Atlas) -> Places:
    """Positions of the texels on the mesh, and the normals of their faces."""
    normals = area_normals(mesh.vertices[mesh.faces])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return Places(points=atlas.points, normals=normals[atlas.faces])


def _fill(
    colors: Float[np.ndarray, "T 3"], covered: Bool[np.ndarray, "T"], points: Float[np.ndarray, "T 3"]
) -> Float[np.ndarray, "T 3"]:
    """Fills uncovered texels with the colour of the nearest covered one."""
    if covered.all():
        return colors
    filled = colors.copy()
    tree = KDTree(points[covered], balanced_tree=False, compact_nodes=False)
    filled[~covered] = colors[covered][np.asarray(tree.query(points[~covered])[1])]
    return filled
