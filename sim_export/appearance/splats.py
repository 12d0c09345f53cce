"""Distributes the Gaussians of an asset to the links of its package."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from artigen.splats.motion import scale_gaussians
from artigen.splats.parts import select_gaussians
from artigen.splats.surface import SurfaceSplatConfig, splat_surface, thin_samples
from artigen.types import Asset
from sim_export.package import Link, SimPackage
from sim_export.physics.links import link_names, link_owners

MOST_DISCS = 200_000
"""Surface samples that become Gaussians of a package; as many take 14 MB."""


def splat_package(package: SimPackage, asset: Asset, cfg: SurfaceSplatConfig | None = None) -> SimPackage:
    """The package with discs on the asset's sampled surface as its Gaussians, on record.

    Raises:
        ValueError: If the asset has no surface samples, or too few to tell how far apart they are.
    """
    if asset.surface is None:
        raise ValueError(f"asset {asset.name!r} has no surface samples to make Gaussians of")
    discs = splat_surface(thin_samples(asset.surface, MOST_DISCS), cfg)
    said = f"{len(discs.means)} Gaussians are discs on the sampled surface, not fitted to pictures"
    links = attach_splats(package.links, replace(asset, gaussians=discs))
    return replace(package, links=links, records=(*package.records, said))


def attach_splats(links: Sequence[Link], asset: Asset) -> tuple[Link, ...]:
    """Links with the Gaussians of their parts, in metres in the object frame at rest.

    Raises:
        ValueError: If the asset has no Gaussians.
    """
    if asset.gaussians is None:
        raise ValueError(f"asset {asset.name!r} has no Gaussians to show")
    metres = scale_gaussians(asset.gaussians, asset.scale)
    names = link_names(asset)
    owner = np.array([names[leader] for leader in link_owners(asset)])[metres.part_ids]
    out = []
    for index, link in enumerate(links):
        rows = np.flatnonzero(owner == link.name)
        splats = replace(select_gaussians(metres, rows), part_ids=np.full(len(rows), index))
        out.append(replace(link, splats=splats if len(rows) else None))
    return tuple(out)
