"""Looks: the materials of an object's finishes with their images, and what puts them on meshes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import UInt8

from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.physical import Material, describe_finish
from sim_export.appearance.tiles import find_color, find_normal_map, find_tile
from sim_export.package import Mesh


@dataclass(frozen=True, kw_only=True, eq=False)
class Look:
    """A material, its mean colour (sRGB in [0, 1]), and images of a square metre: of its colour unless it is
    even, and of its normals unless it is smooth."""

    material: Material
    color: Color
    tile: UInt8[np.ndarray, "H W 3"] | None
    normal_map: UInt8[np.ndarray, "H W 3"] | None

    def put_on(self, mesh: Mesh) -> Mesh:
        """The mesh with this look; its geometry and texture coordinates (m) stay."""
        return replace(
            mesh,
            material=self.material,
            color=self.color,
            texture=self.tile,
            normal_map=self.normal_map,
        )


def find_looks(finishes: Mapping[str, Finish]) -> dict[str, Look]:
    """The look of every finish. Finishes that look alike share one; others have names that differ."""
    names: dict[str, list[object]] = {}
    looks = {}
    for role in sorted(finishes):
        finish = finishes[role]
        material, tile = describe_finish(finish), find_tile(finish)
        even = find_color(finish)
        seen = (material, even, None if tile is None else (finish.color, finish.accent, finish.period))
        alike = names.setdefault(material.name, [])
        if seen not in alike:
            alike.append(seen)
        number = alike.index(seen)
        name = material.name if number == 0 else f"{material.name}_{number + 1}"
        looks[role] = Look(
            material=replace(material, name=name),
            color=even,
            tile=tile,
            normal_map=find_normal_map(finish),
        )
    return looks
