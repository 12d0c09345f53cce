"""Other looks on an object that is in a SAPIEN scene, without loading it again."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import UInt8

from artigen.errors import explain
from sim_export.errors import PackageError

if TYPE_CHECKING:
    from sapien.physx import PhysxArticulationLinkComponent
    from sapien.render import RenderMaterial, RenderTexture2D

    from sim_export.appearance.dress import Look

_textures: "dict[int, tuple[np.ndarray, RenderTexture2D]]" = {}
"""Textures on the device by tile, which objects share."""


def wear_finishes(
    links: "Iterable[PhysxArticulationLinkComponent]", folder: Path, looks: "Mapping[str, Look]"
) -> int:
    """Gives the visuals of an articulation the looks of their finishes.

    Visuals of other finishes keep their look, and so do those of which only one look is clear.

    Args:
        links: The links of the articulation, loaded with visuals.
        folder: Its package, whose ``materials.json`` says which finish each visual shows.
        looks: Looks by finish, see `sim_export.appearance.dress.find_looks`.

    Returns:
        The number of visuals that changed.

    Raises:
        PackageError: If the package has no ``materials.json``.
    """
    said = _read(folder)
    changed = 0
    for name, material in find_materials(links):
        visual = said.get(name)
        look = None if visual is None else looks.get(visual["finish"])
        if look is None or (material.base_color[3] < 1.0) != (look.material.opacity < 1.0):
            continue
        _wear(material, look)
        changed += 1
    return changed


def find_materials(links: "Iterable[PhysxArticulationLinkComponent]") -> "list[tuple[str, RenderMaterial]]":
    """The material of every visual by its name."""
    import sapien

    found = []
    for link in links:
        body: Any = link.entity.find_component_by_type(sapien.render.RenderBodyComponent)
        shapes: list[Any] = [] if body is None else body.render_shapes
        found += [(Path(shape.filename).stem, part.material) for shape in shapes for part in shape.parts]
    return found


def _read(folder: Path) -> dict[str, dict]:
    """What a package says about its visuals, by their names."""
    path = folder / "materials.json"
    try:
        said = json.loads(path.read_text())
        return {entry["visual"]: entry for entry in said["visuals"]}
    except (OSError, ValueError, KeyError) as error:
        raise PackageError(f"{path}: cannot be read ({explain(error)}); export the object again") from error


def _wear(material: Any, look: "Look") -> None:
    """SAPIEN takes None for no texture, which its stubs do not say."""
    color = (1.0, 1.0, 1.0) if look.tile is not None else look.color
    material.base_color = [*color, look.material.opacity]
    material.roughness, material.metallic = look.material.roughness, look.material.metallic
    material.base_color_texture = None if look.tile is None else _texture(look.tile)


def _texture(tile: UInt8[np.ndarray, "H W 3"]) -> "RenderTexture2D":
    from sapien.render import RenderTexture2D

    if id(tile) not in _textures:  # the tile is kept, so that its id stays its own
        opaque = np.concatenate([tile, np.full((*tile.shape[:2], 1), 255, np.uint8)], axis=2)
        _textures[id(tile)] = tile, RenderTexture2D(opaque, "R8G8B8A8Unorm", 8, srgb=True)
    return _textures[id(tile)][1]
