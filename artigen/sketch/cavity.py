"""Cavities that bodies enclose on all sides."""

import numpy as np
from jaxtyping import Float

from artigen.sketch.contact import Bodies
from artigen.sketch.opening import Opener

BEHIND = 0.05
"""Largest thickness (m) of a wall between a panel and a cavity that the panel seems to close."""
_LEVEL = 6
"""Decimals (metres) to which corners are rounded, so that solids that touch are joined."""


def find_cavities(bodies: Bodies, link: int) -> Float[np.ndarray, "C 2 3"]:
    """Bounds of the cavities that the union of a body's solids encloses; empty for most bodies."""
    import manifold3d

    rows = np.flatnonzero(bodies.links == link)
    solids = [manifold3d.Manifold.hull_points(np.round(bodies.vertices[row], _LEVEL)) for row in rows]
    shells = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add).decompose()
    # The wall of a cavity is a surface by itself that faces inwards.
    return np.array([shell.bounding_box() for shell in shells if shell.volume() < 0.0]).reshape(-1, 2, 3)


def measure_sealed(bodies: Bodies, opener: Opener, cavities: Float[np.ndarray, "C 2 3"]) -> float:
    """Largest share of a panel's area that has one of the cavities behind or before it, within `BEHIND`."""
    points = bodies.vertices[opener.panel if len(opener.panel) else opener.body].reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    shared = np.minimum(high, cavities[:, 1]) - np.maximum(low, cavities[:, 0])
    thin = int((high - low).argmin())
    plane = np.arange(3) != thin
    shares = (shared[:, plane].clip(min=0.0) / (high - low)[plane]).prod(axis=1)
    return float(shares[shared[:, thin] > -BEHIND].max(initial=0.0))
