"""The Gaussians of a package in any pose of its links; rendering is left to the caller, which avoids
importing torch."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float, UInt8

from artigen.camera import Camera
from artigen.splats.motion import transform_gaussians
from artigen.splats.parts import merge_gaussians
from artigen.types import Gaussians
from sim_export.package import SimPackage

DrawSplats = Callable[[Gaussians, Camera, tuple[int, int, int]], UInt8[np.ndarray, "H W 3"]]
"""Renders Gaussians (metres) with a camera over a plain background (sRGB levels)."""


def has_splats(package: SimPackage) -> bool:
    """Whether any link has Gaussians."""
    return any(link.splats is not None for link in package.links)


def pose_splats(package: SimPackage, T: Float[np.ndarray, "L 4 4"]) -> Gaussians:
    """The Gaussians of all links, moved by the displacements of their links from rest.

    Raises:
        ValueError: If no link has Gaussians.
    """
    moved = [
        transform_gaussians(link.splats, T[index])
        for index, link in enumerate(package.links)
        if link.splats is not None
    ]
    if not moved:
        raise ValueError(f"package {package.name!r} has no Gaussians")
    return merge_gaussians(moved)
