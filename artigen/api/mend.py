"""Mends a source object: its asset, its triangles and the placement of its mesh files."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.api.give_files import give_files
from artigen.datasets.mesh_obj import write_obj
from artigen.datasets.sizes import estimate_size
from artigen.datasets.source_object import SourceObject, SourceVisual, TriangleMesh
from artigen.kind import find_category
from artigen.types import Asset

if TYPE_CHECKING:
    from sim_export.mend.source import Source
    from sim_export.package import SourceMesh


def mend_object(source: SourceObject, scratch: Path, cell: float = 0.0) -> SourceObject:
    """The source object with its faults mended; unchanged if it has none.

    Args:
        source: The object.
        scratch: Folder for meshes of what is added, needed until the package is written.
        cell: Size (m) of the voxels from which the object is rebuilt, 0 if it is not. Gaps behind handles
            may get narrower by as much.
    """
    from sim_export.checks.config import CheckConfig
    from sim_export.mend.mends import mend_source
    from sim_export.mend.source import open_source

    source = give_files(source)
    asset, triangles = source.asset, source.triangles
    cfg = CheckConfig(min_clearance=CheckConfig.min_clearance + cell)
    mended = mend_source(open_source(asset, tuple(place_source_surfaces(source, asset))), cfg)
    if not mended.records:
        return source
    shifts = mended.shifts / asset.scale
    visuals = []
    for visual in source.visuals:
        T = np.array(visual.T_unit_file)
        T[:3, 3] += shifts[visual.part]
        visuals.append(replace(visual, T_unit_file=T))
    corners = triangles.vertices[triangles.faces] + shifts[triangles.part_ids][:, None]
    added = [post / asset.scale for _, post in mended.posts]
    owners = [np.full(len(post), part) for part, post in mended.posts]
    corners = np.concatenate([corners, *added])
    return replace(
        source,
        asset=replace(mended.asset, notes=asset.notes + mended.records),
        visuals=(*visuals, *_write_posts(mended, scratch)),
        triangles=TriangleMesh(
            vertices=corners.reshape(-1, 3),
            faces=np.arange(3 * len(corners)).reshape(-1, 3),
            part_ids=np.concatenate([triangles.part_ids, *owners]),
        ),
    )


def resize_object(source: SourceObject) -> SourceObject:
    """The object in the usual size of its kind where the file's is that of none (V009); else unchanged."""
    asset, kind = source.asset, find_category(source.asset.category)
    extents = asset.scale * np.ptp(source.triangles.vertices, axis=0)
    diagonal = float(np.linalg.norm(extents))
    if kind is None or kind.diagonal is None or kind.diagonal[0] <= diagonal <= kind.diagonal[1]:
        return source
    size, _ = estimate_size(asset.category, extents)
    record = (
        f"mend size (V009): a diagonal of {diagonal:.3g} m is that of no {asset.category} "
        f"({kind.diagonal[0]:g} to {kind.diagonal[1]:g} m); all lengths are {size / asset.scale:.3g} times "
        "those of the file (--size keeps others)"
    )
    return replace(source, asset=replace(asset, scale=size, notes=(*asset.notes, record)))


def _write_posts(mended: "Source", scratch: Path) -> list[SourceVisual]:
    """A mesh file (m) for every post."""
    from trimesh import Trimesh

    from sim_export.mend.bridge import POST_COLOR

    red, green, blue = (level / 255.0 for level in POST_COLOR)
    visuals = []
    for number, (part, post) in enumerate(mended.posts):
        faces = np.arange(3 * len(post)).reshape(-1, 3)
        path = scratch / f"post_{number}.obj"
        write_obj([Trimesh(post.reshape(-1, 3), faces)], (red, green, blue, 1.0), path)
        scale = 1.0 / mended.asset.scale
        visuals.append(SourceVisual(part=part, name=path.stem, path=path, T_unit_file=np.eye(4), scale=scale))
    return visuals


def place_source_meshes(source: SourceObject, asset: Asset) -> "dict[int, list[SourceMesh]]":
    """The object's own mesh files by part of ``asset``; visuals of merged parts follow these."""
    from sim_export.package import SourceMesh

    heirs = find_remaining(source.asset, asset)
    placed: dict[int, list[SourceMesh]] = {}
    for visual in source.visuals:
        T = np.array(visual.T_unit_file)
        T[:3, 3] *= asset.scale
        mesh = SourceMesh(path=visual.path, T_object_file=T, scale=visual.scale * asset.scale)
        placed.setdefault(heirs[visual.part], []).append(mesh)
    return placed


def place_source_surfaces(source: SourceObject, asset: Asset) -> list[Float[np.ndarray, "F 3 3"]]:
    """The object's own triangles (m) for every part of ``asset``; those of merged parts follow these."""
    triangles, heirs = source.triangles, np.array(find_remaining(source.asset, asset))
    corners = asset.scale * triangles.vertices[triangles.faces]
    owners = heirs[triangles.part_ids]
    return [corners[owners == index] for index in range(len(asset.parts))]


def find_remaining(before: Asset, after: Asset) -> list[int]:
    """For every part of an asset, the part of a later one that it is or that it was merged into."""
    names = {part.name: index for index, part in enumerate(after.parts)}
    out = []
    for part in before.parts:
        while part.name not in names:
            part = before.parts[part.parent]
        out.append(names[part.name])
    return out
