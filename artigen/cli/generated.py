"""The package of a generated shape: exact meshes, hulls and joints, and Gaussians that a network decodes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from artigen.appearance.exact import ShapeAppearanceModel
    from artigen.shapes.shape import Shape
    from artigen.types import Asset
    from sim_export.package import SimPackage


@dataclass(frozen=True, kw_only=True, eq=False)
class Generated:
    """A generated object in both of its forms."""

    package: "SimPackage"
    """What simulators read."""
    asset: "Asset"
    """Parts, joints, exact articulated voxels (64^3) and, where there is a decoder, Gaussians;
    `artigen.voxels.fields.encode` makes the 35 channels of it."""


def make_generated_package(
    shape: "Shape",
    appearance: "ShapeAppearanceModel | None" = None,
    *,
    provenance: Mapping[str, str] | None = None,
    notes: Sequence[str] = (),
    textures: Literal["own", "shared"] = "own",
) -> Generated:
    """The exact package of a shape, with the Gaussians of its parts link by link.

    Args:
        shape: The object.
        appearance: Decodes Gaussians; without, packages have none.
        provenance: Where the object comes from, for ``provenance.json``.
        notes: What was repaired or left open before; they come first among the records.
        textures: Whether every part has an image of its own, or shares one with parts of its finishes.

    Raises:
        ExportError: If parts cannot be links or have no mass; names the part.
    """
    from artigen.appearance.exact import decode_gaussians, voxelize_shape
    from sim_export.appearance.splats import attach_splats
    from sim_export.reference import ReferenceConfig, build_reference

    package = build_reference(shape, ReferenceConfig(textures=textures), provenance=provenance)
    if appearance is None:
        asset = voxelize_shape(shape)
        return Generated(package=_note(package, (*notes, *asset.notes)), asset=asset)
    asset = decode_gaussians(appearance, shape)
    assert asset.gaussians is not None
    said = f"{len(asset.gaussians.means)} Gaussians are decoded from the exact surfaces and their colours"
    shown = replace(package, links=attach_splats(package.links, asset))
    return Generated(package=_note(shown, (*notes, *asset.notes, said)), asset=asset)


def _note(package: "SimPackage", notes: Sequence[str]) -> "SimPackage":
    return replace(package, records=(*notes, *package.records))
