"""Places triangles in the unit cube, separates components and samples coloured surfaces."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.errors import SourceError
from artigen.files.mtl import Material
from artigen.files.wavefront import ObjMesh
from artigen.types import SurfaceSamples


@dataclass(frozen=True, kw_only=True, eq=False)
class FaceTable:
    """One mesh file in the unit cube: triangles with texture coordinates and materials."""

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    corners: Float[np.ndarray, "F 3 3"]
    uv: Float[np.ndarray, "F 3 2"]
    material_ids: Int[np.ndarray, "F"]
    materials: tuple[Material, ...]


def make_face_table(mesh: ObjMesh, T_unit_file: Float[np.ndarray, "4 4"], scale: float) -> FaceTable:
    """Scales a mesh, then moves it rigidly."""
    vertices = (scale * mesh.vertices) @ T_unit_file[:3, :3].T + T_unit_file[:3, 3]
    return FaceTable(
        vertices=vertices,
        faces=mesh.faces,
        corners=vertices[mesh.faces],
        uv=mesh.uv,
        material_ids=mesh.material_ids,
        materials=mesh.materials,
    )


def split_pieces(tables: Sequence[FaceTable], gap: float) -> list[Int[np.ndarray, "F"]]:
    """Numbers of the spatially separate pieces of some meshes, face by face.

    Triangles with equal vertices belong together, and so do components whose boxes are within ``gap``.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    vertices, faces = join_tables(tables)
    welded, same = np.unique(vertices, axis=0, return_inverse=True)  # files repeat vertices along seams
    faces = same.reshape(-1)[faces]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_matrix((np.ones(len(edges)), edges.T), shape=(len(welded), len(welded)))
    component = connected_components(graph, directed=False)[1][faces[:, 0]]
    used, component = np.unique(component, return_inverse=True)
    corners = np.concatenate([table.corners for table in tables])
    low, high = np.full((len(used), 3), np.inf), np.full((len(used), 3), -np.inf)
    np.minimum.at(low, component, corners.min(axis=1))
    np.maximum.at(high, component, corners.max(axis=1))
    group = _merge_boxes(low, high, gap)
    return np.split(group[component], np.cumsum([len(table.faces) for table in tables])[:-1])


def _merge_boxes(low: np.ndarray, high: np.ndarray, gap: float) -> np.ndarray:
    """Groups boxes that are within ``gap`` of each other along every axis, directly or in a chain."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

    if len(low) > 2000:
        return np.zeros(len(low), dtype=np.int64)
    between = np.maximum(low[:, None] - high[None], low[None] - high[:, None]).max(axis=-1)
    return connected_components(csr_matrix(between <= gap), directed=False)[1].astype(np.int64)


def join_tables(tables: Sequence[FaceTable]) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "F 3"]]:
    """Vertices and faces of all tables."""
    starts = np.cumsum([0, *(len(table.vertices) for table in tables)])[:-1]
    faces = np.concatenate([table.faces + start for table, start in zip(tables, starts, strict=True)])
    return np.concatenate([table.vertices for table in tables]), faces


def sample_surface(
    tables: Sequence[FaceTable], owners: Sequence[Int[np.ndarray, "F"]], count: int, rng: np.random.Generator
) -> SurfaceSamples:
    """Draws ``count`` points uniformly by area, stratified, with normals and colours.

    Raises:
        SourceError: If an image cannot be decoded, or the surface has no area.
    """
    corners = np.concatenate([table.corners for table in tables])
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    ends = np.cumsum(area)
    if not ends[-1] > 0:
        raise SourceError(f"the {len(corners)} triangles of the object have no area")
    # One draw in each of `count` equal shares of the area: even coverage, sorted by face.
    drawn = (np.arange(count) + rng.random(count)) * (ends[-1] / count)
    face = np.minimum(np.searchsorted(ends, drawn, side="right"), len(corners) - 1)
    weights = _barycentric(count, rng)
    points = np.einsum("nk,nkd->nd", weights, corners[face])
    normals = cross / np.maximum(2 * area, 1e-30)[:, None]
    uv = np.einsum("nk,nkd->nd", weights, np.concatenate([table.uv for table in tables])[face])
    return SurfaceSamples(
        points=points,
        normals=normals[face],
        colors=look_up_colors(tables, face, uv),
        part_ids=np.concatenate(owners)[face],
    )


def _barycentric(count: int, rng: np.random.Generator) -> np.ndarray:
    root, other = np.sqrt(rng.random(count)), rng.random(count)
    return np.stack([1 - root, root * (1 - other), root * other], axis=1)


def look_up_colors(
    tables: Sequence[FaceTable], face: Int[np.ndarray, "N"], uv: Float[np.ndarray, "N 2"]
) -> UInt8[np.ndarray, "N 3"]:
    """Nearest texel of each point on a face, or the material's plain colour.

    Args:
        face: Index into the faces of all tables together.

    Raises:
        SourceError: If an image cannot be decoded.
    """
    materials = [material for table in tables for material in table.materials]
    offsets = np.cumsum([0, *(len(table.materials) for table in tables)])
    ids = np.concatenate(
        [table.material_ids + offset for table, offset in zip(tables, offsets[:-1], strict=True)]
    )[face]
    plain = np.array([material.color for material in materials])
    colors = np.round(255 * plain).astype(np.uint8)[ids]
    images = sorted({material.image for material in materials if material.image is not None})
    number = {image: index for index, image in enumerate(images)}
    image_of = np.array([-1 if m.image is None else number[m.image] for m in materials])[ids]
    for index, image in enumerate(images):
        here = np.flatnonzero(image_of == index)
        if len(here):
            texels = read_image(image)
            height, width = texels.shape[:2]
            column = np.floor(uv[here, 0] % 1.0 * width).astype(np.int64) % width
            row = np.floor((1.0 - uv[here, 1] % 1.0) * height).astype(np.int64) % height
            colors[here] = texels[row, column]
    return colors


def read_image(path: Path) -> np.ndarray:
    """An image as RGB bytes [H, W, 3], rows from top to bottom."""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            return np.asarray(image.convert("RGB"))
    except (UnidentifiedImageError, OSError) as err:
        raise SourceError(f"{path}: image cannot be decoded: {err}") from err
