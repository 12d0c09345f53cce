"""Flips edges to remove needle triangles from flat regions without moving points."""

import numpy as np
from jaxtyping import Bool, Float, Int

from sim_export.geometry.sampling import triangle_areas

NEEDLE = 2e-4
"""Height over longest edge below which a triangle is a needle; checks allow half of it."""
FLAT = 1e-9
"""Distance (m) from a plane up to which a point lies in it."""
_PASSES = 20


def find_needles(triangles: Float[np.ndarray, "F 3 3"], ratio: float = NEEDLE) -> Bool[np.ndarray, "F"]:
    """Which triangles are lower than ``ratio`` of their longest edge."""
    longest = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2).max(axis=1)
    return 2.0 * triangle_areas(triangles) <= ratio * longest**2


def flip_needles(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], regions: Int[np.ndarray, "F"]
) -> Int[np.ndarray, "F 3"]:
    """Faces with the longest edges of needles flipped, where both triangles lie in one plane and region.

    Args:
        vertices: Points (m).
        faces: A closed surface.
        regions: Faces of different regions do not exchange area.
    """
    out = faces.copy()
    for _ in range(_PASSES):
        needles = np.flatnonzero(find_needles(vertices[out]))
        opposite = {
            edge: face for face, (a, b, c) in enumerate(out.tolist()) for edge in ((a, b), (b, c), (c, a))
        }
        changed: set[int] = set()
        for needle in needles:
            row = out[needle]
            lengths = np.linalg.norm(vertices[row] - vertices[np.roll(row, -1)], axis=1)
            start, end, apex = np.roll(row, -int(lengths.argmax()))
            other = opposite.get((int(end), int(start)))
            if other is None or {int(needle), other} & changed or regions[needle] != regions[other]:
                continue
            far = next(int(v) for v in out[other] if v not in (start, end))
            pair = np.array([[start, far, apex], [far, end, apex]])
            # An edge that is there already would be there twice, and the surface pinched.
            joined = far == apex or bool({(far, int(apex)), (int(apex), far)} & opposite.keys())
            if not joined and _is_better(vertices, out[other], pair):
                out[needle], out[other] = pair
                changed |= {int(needle), other}
        if not changed:
            break
    return out


def _is_better(vertices: np.ndarray, neighbour: np.ndarray, pair: np.ndarray) -> bool:
    """Whether the flipped pair lies in the neighbour's plane, is wound like it, and holds fewer needles."""
    a, b, c = vertices[neighbour]
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal)
    if length == 0.0 or find_needles(vertices[neighbour][None])[0]:
        return False
    normal = normal / length
    triangles = vertices[pair]
    crosses = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) @ normal
    level = np.abs((triangles.reshape(-1, 3) - a) @ normal).max() <= FLAT
    return bool(level and (crosses > 0).all() and not find_needles(triangles).any())
