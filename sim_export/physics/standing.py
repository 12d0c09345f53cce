"""Which objects must stand on their own, and how well they do."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from artigen.kind import find_category
from artigen.shapes.support import measure_overhang
from sim_export.package import Link

TOUCHING = 2e-3
"""Height (m) above the floor up to which a point counts as standing on it."""
MARGIN = 0.01
"""Least distance (m) of the centre of mass from the edges of the area that an object stands on."""
MARGIN_SHARE = 0.02
"""The same over the smaller side of the object's floor plan, where this is less."""
DOWN = np.array([0.0, 0.0, -1.0])


def must_stand(category: str) -> bool:
    """Whether objects of this category must stand on their own; those of unknown categories must."""
    known = find_category(category)
    return known is None or known.stands == "free"


def stable_margin(points: Float[np.ndarray, "N 3"]) -> float:
    """How far (m) the centre of mass of an object of these points should lie inside of what it stands on."""
    return min(MARGIN, MARGIN_SHARE * float(np.ptp(points[:, :2], axis=0).min()))


def center_of_mass(links: Sequence[Link]) -> Float[np.ndarray, "3"]:
    """Centre of mass (m) of all links that have a mass, at rest."""
    bodies = [link.inertial for link in links if link.inertial is not None]
    return np.average([body.com for body in bodies], axis=0, weights=[body.mass for body in bodies])


def depth_of_mass(
    points: Float[np.ndarray, "N 3"], com: Float[np.ndarray, "3"], down: Float[np.ndarray, "3"] = DOWN
) -> float:
    """How far (m) a centre of mass lies inside of the lowest points along ``down``; negative outside."""
    down = down / np.linalg.norm(down)
    heights = points @ down
    axes = np.linalg.svd(down[None])[2][1:]
    return -measure_overhang(points[heights > heights.max() - TOUCHING] @ axes.T, axes @ com)
