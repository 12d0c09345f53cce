"""Packages of generated shapes: exact meshes, hulls and joints, and Gaussians decoded by a network."""

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
    """A generated object as a package and as an asset."""

    package: "SimPackage"
    """Package for simulators."""
    asset: "Asset"
    """Parts, joints, exact articulated voxels (64^3) and, with a decoder, Gaussians.
    `artigen.voxels.fields.encode` converts it to 35 channels."""


def make_generated_package(
    shape: "Shape",
    appearance: "ShapeAppearanceModel | None" = None,
    *,
    provenance: Mapping[str, str] | None = None,
    notes: Sequence[str] = (),
    textures: Literal["own", "shared"] = "own",
) -> Generated:
    """Makes the exact package of a shape, with Gaussians per link.

    Args:
        shape: The object.
        appearance: Decoder of Gaussians; without it the package has none.
        provenance: Origin of the object, for ``provenance.json``.
        notes: Repairs and open issues of earlier stages, prepended to the package's records.
        textures: ``own`` for one image per part, ``shared`` for one image per set of finishes.

    Raises:
        ExportError: If a part cannot become a link or has no mass; the message names the part.
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
