"""The Gaussians of every link of a simulation package, in the link's frame and metres, one PLY each.

Links are those of exported packages: a movable part with everything that is fixed to it is ``link_0`` and so
on, in the order of the parts, and the body is the last. A link's frame has the joint's origin and the
object's axes, that of the body the object's own origin.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from artigen.io import whole_folder
from artigen.kinematics import movable_parts
from artigen.splats.motion import scale_gaussians, transform_gaussians
from artigen.splats.parts import merge_gaussians, select_gaussians
from artigen.splats.ply import write_ply
from artigen.types import Asset, Gaussians


@dataclass(frozen=True, kw_only=True, eq=False)
class LinkGaussians:
    """What one link looks like."""

    name: str
    """``link_0`` and so on."""
    origin: Float[np.ndarray, "3"]
    """Of the link's frame, in the object frame at rest (m)."""
    gaussians: Gaussians
    """In the link's frame (m); part ids are those of the asset."""


def split_links(asset: Asset) -> tuple[LinkGaussians, ...]:
    """The asset's Gaussians link by link; links without any have an empty set.

    Raises:
        ValueError: If the asset has no Gaussians, or its root part has a joint.
    """
    if asset.gaussians is None:
        raise ValueError(f"asset {asset.name!r} has no Gaussians")
    if asset.parts[asset.root].joint.type != "fixed":
        raise ValueError(f"asset {asset.name!r}: its root part has a joint, expected it fixed")
    metres = scale_gaussians(asset.gaussians, asset.scale)
    leaders = _leaders(asset)
    links = []
    for k, leader in enumerate([*movable_parts(asset), asset.root]):
        joint = asset.parts[leader].joint
        origin = np.zeros(3) if leader == asset.root else joint.origin * asset.scale
        T_link_object = np.eye(4)
        T_link_object[:3, 3] = -origin
        own = select_gaussians(metres, leaders[metres.part_ids] == leader)
        links.append(
            LinkGaussians(name=f"link_{k}", origin=origin, gaussians=transform_gaussians(own, T_link_object))
        )
    return tuple(links)


def join_links(links: tuple[LinkGaussians, ...], scale: float) -> Gaussians:
    """The inverse of `split_links` but for the order of the rows: unit cube, object frame at rest.

    ``scale`` is metres per unit-cube length. Raises `ValueError` without links.
    """
    placed = []
    for link in links:
        T_object_link = np.eye(4)
        T_object_link[:3, 3] = link.origin
        placed.append(transform_gaussians(link.gaussians, T_object_link))
    return scale_gaussians(merge_gaussians(placed), 1.0 / scale)


def write_links(asset: Asset, folder: Path) -> tuple[Path, ...]:
    """Writes ``link_0.ply`` and so on into ``folder``, which replaces an older one; raises as `split_links`.

    Links without Gaussians have no file.
    """
    links = [link for link in split_links(asset) if len(link.gaussians.means)]
    with whole_folder(folder) as scratch:
        for link in links:
            write_ply(link.gaussians, scratch / f"{link.name}.ply")
    return tuple(folder / f"{link.name}.ply" for link in links)


def _leaders(asset: Asset) -> np.ndarray:
    """For every part, the part that leads its link: its nearest movable ancestor or the root."""
    leaders = np.arange(len(asset.parts))
    for index in range(len(leaders)):
        at = index
        while asset.parts[at].parent != -1 and asset.parts[at].joint.type == "fixed":
            at = asset.parts[at].parent
        leaders[index] = at
    return leaders
