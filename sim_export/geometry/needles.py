"""Flips edges of needles, triangles much longer than high, where a surface is flat; no point moves."""

import numpy as np
from jaxtyping import Bool, Float, Int

from sim_export.geometry.triangles import area_normals, face_edges, find_slivers

NEEDLE = 2e-4
"""Height over longest edge below which a triangle is a needle; V101 allows half of it."""
FLAT = 2e-6
"""Distance (m) from a plane within which a point lies in it: twice the precision of files."""
PASSES = 20


def flip_needles(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], regions: Int[np.ndarray, "F"]
) -> Int[np.ndarray, "F 3"]:
    """Flips the longest edges of needles where both triangles lie in one plane and region.

    Args:
        vertices: Points (m).
        faces: A closed surface.
        regions: Region of each face; edges between regions stay.
    """
    out = faces.copy()
    for _ in range(PASSES):
        thin = np.flatnonzero(find_slivers(vertices[out], NEEDLE))
        if not len(thin):
            break
        edges = face_edges(out) @ (len(vertices), 1)  # a number for each
        order = np.argsort(edges)
        longest = np.linalg.norm(vertices[out[thin]] - vertices[np.roll(out[thin], -1, axis=1)], axis=2)
        turned = (longest.argmax(axis=1)[:, None] + np.arange(3)) % 3
        start, end, apex = np.take_along_axis(out[thin], turned, axis=1).T
        other = order[np.searchsorted(edges, end * len(vertices) + start, sorter=order)] % len(out)
        far = out[other].sum(axis=1) - start - end
        pair = np.stack([start, far, apex, far, end, apex], axis=1).reshape(-1, 2, 3)
        made = np.sort(np.stack([far, apex], axis=1), axis=1)
        # An edge that is there already would pinch the surface.
        free = ~np.isin(np.stack([made, made[:, ::-1]]) @ (len(vertices), 1), edges).any(axis=0)
        good = free & (far != apex) & (regions[thin] == regions[other])
        good &= _are_better(vertices[np.stack([out[thin], out[other]], axis=1)], vertices[pair])
        changed: set[object] = set()
        for k in np.flatnonzero(good).tolist():
            own = {int(thin[k]), int(other[k]), tuple(made[k].tolist())}
            if not own & changed:
                out[[thin[k], other[k]]] = pair[k]
                changed |= own
        if not changed:
            break
    return out


def _are_better(
    old: Float[np.ndarray, "N 2 3 3"], new: Float[np.ndarray, "N 2 3 3"]
) -> Bool[np.ndarray, "N"]:
    """Whether flipped pairs lie in the planes of the old ones, face where they did, and are less thin."""
    (before, areas), (after, flipped) = _thinnest(old), _thinnest(new)
    normals = np.where((_size(areas[:, 0]) > _size(areas[:, 1]))[:, None], areas[:, 0], areas[:, 1])
    normals = normals / np.maximum(_size(normals), 1e-30)[:, None]
    heights = np.einsum("nk,npk->np", normals, old.reshape(len(old), 6, 3))
    ahead = np.einsum("nk,npk->np", normals, flipped) > 0.0
    return (np.ptp(heights, axis=1) <= FLAT) & ahead.all(axis=1) & (after > before)


def _thinnest(pairs: Float[np.ndarray, "N 2 3 3"]) -> tuple[Float[np.ndarray, "N"], np.ndarray]:
    """Smallest height over longest edge of pairs of triangles, and their normals (twice their areas)."""
    areas = area_normals(pairs.reshape(-1, 3, 3)).reshape(-1, 2, 3)
    longest = _size(pairs - np.roll(pairs, -1, axis=2)).max(axis=2)
    return (_size(areas) / longest**2).min(axis=1), areas


def _size(vectors: np.ndarray) -> np.ndarray:
    return np.linalg.norm(vectors, axis=-1)
