"""The mesh files and triangles of a source object, part by part, in metres."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.datasets.source_object import SourceObject
from artigen.types import Asset

if TYPE_CHECKING:
    from sim_export.package import SourceMesh


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
