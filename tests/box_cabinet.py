"""The sample cabinet as boxes: visuals, hulls and a package of exact geometry."""

from dataclasses import replace

import numpy as np
from sample_cabinet import SAMPLE_PARTS, sample_box_arrays

from artigen.types import Asset
from sim_export.geometry.hulls import box_hull
from sim_export.package import Mesh, SimPackage
from sim_export.physics.inertia import combine, mesh_inertial
from sim_export.physics.links import PartGeometry, build_links

SCALE = 0.7


def scaled(asset: Asset) -> Asset:
    """The cabinet at 0.7 metres per unit, so that no factor is 1 by accident."""
    return replace(asset, scale=SCALE)


def box_geometry() -> list[PartGeometry]:
    """The sample cabinet's own boxes as visuals and hulls, in metres about its centre."""
    arrays = [sample_box_arrays(part) for part in SAMPLE_PARTS]
    every = np.concatenate(arrays).reshape(-1, 3)
    center = (every.min(axis=0) + every.max(axis=0)) / 2
    geometry = []
    for boxes in arrays:
        hulls = tuple(box_hull(SCALE * (low - center), SCALE * (high - center)) for low, high in boxes)
        mesh = Mesh(
            vertices=np.concatenate([hull.vertices for hull in hulls]),
            faces=np.concatenate([hull.faces + 8 * k for k, hull in enumerate(hulls)]),
        )
        inertial = combine([mesh_inertial(hull, 600.0) for hull in hulls])
        geometry.append(PartGeometry(visuals=(mesh,), hulls=hulls, inertial=inertial))
    return geometry


def as_package(asset: Asset, geometry: list[PartGeometry]) -> SimPackage:
    tree = build_links(asset, geometry)
    return SimPackage(
        name=asset.name,
        category=asset.category,
        visual="voxels",
        links=tree.links,
        joints=tree.joints,
        records=tree.records,
    )


def with_screw(asset: Asset) -> Asset:
    """The cabinet with a lock that moves 12 mm out of the door per turn."""
    parts = list(asset.parts)
    joint = replace(
        parts[6].joint, type="screw", lower=0.0, upper=2 * np.pi, pitch=-0.012 / (2 * np.pi) / asset.scale
    )
    parts[6] = replace(parts[6], joint=joint)
    return replace(asset, parts=tuple(parts))
