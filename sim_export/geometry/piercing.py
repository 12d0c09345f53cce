"""Where the edges of one surface pierce another: evidence of an overlap, closed or not."""

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from sim_export.geometry.rows import all_three, number_rows
from sim_export.geometry.triangles import triangle_normals

# embreex is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

MOST_EDGES = 20_000
"""Edges that are followed, the longest first."""


def find_edges(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "E 2 3"]:
    """The edges of some triangles, each once, the longest of them."""
    edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2, 3)
    size = max(float(np.ptp(triangles.reshape(-1, 3), axis=0).max()), 1e-9)
    places = np.round(edges.reshape(-1, 3) / size * 1e6).astype(np.int64)
    ends = number_rows(places)[1].reshape(-1, 2)
    edges = edges[number_rows(np.sort(ends, axis=1))[0]]
    length = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    return edges[np.argsort(-length, kind="stable")[:MOST_EDGES]]


class PiercedSurface:
    """Triangles that edges are tested against."""

    def __init__(self, triangles: Float[np.ndarray, "F 3 3"]) -> None:
        from embreex import rtcore_scene
        from embreex.mesh_construction import TriangleMesh

        self._triangles = triangles
        self.low, self.high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
        self._tree = rtcore_scene.EmbreeScene(robust=True)
        TriangleMesh(self._tree, triangles.astype(np.float32))

    def depth(self, edges: Float[np.ndarray, "E 2 3"]) -> tuple[float, float]:
        """How far (m) an edge reaches through the surface, on the side where it reaches less; 0 if none does.

        The first triangle that an edge meets counts, and the distance of its ends from that one's plane. The
        second number is the same where edges meet triangles farther from their borders than they reach
        through: a corner that only touches another one's edge is not in it.
        """
        low, high = np.minimum(edges[:, 0], edges[:, 1]), np.maximum(edges[:, 0], edges[:, 1])
        near = all_three((high >= self.low) & (low <= self.high))
        start, way = edges[near, 0], edges[near, 1] - edges[near, 0]
        if not len(way):
            return 0.0, 0.0
        found = self._tree.run(start.astype(np.float32), way.astype(np.float32), output=1)
        at, index = np.asarray(found["tfar"], dtype=np.float64), np.asarray(found["primID"])
        hit = (index >= 0) & (at > 0.0) & (at < 1.0)
        at, way, corners = at[hit, None], way[hit], self._triangles[index[hit]]
        normal = triangle_normals(corners)
        reach = np.minimum(at, 1.0 - at)[:, 0] * np.abs(np.einsum("ij,ij->i", way, normal))
        sides = np.roll(corners, -1, axis=1) - corners
        offset = (start[hit] + at * way)[:, None] - corners
        length = np.maximum(np.linalg.norm(sides, axis=2), 1e-12)
        border = (np.linalg.norm(np.cross(sides, offset), axis=2) / length).min(axis=1)
        return float(reach.max(initial=0.0)), float(np.minimum(reach, border).max(initial=0.0))


def piercing_depth(
    first: tuple[PiercedSurface, Float[np.ndarray, "E 2 3"]],
    second: tuple[PiercedSurface, Float[np.ndarray, "E 2 3"]],
    T_first_second: Float[np.ndarray, "4 4"],
) -> float:
    """How far (m) two surfaces, each with its edges, pierce each other.

    Where edges of both do, the smaller depth counts: a plate that a millimetre of a block enters has edges
    that cross all of the block.
    """
    forth, forth_clear = first[0].depth(transform_points(T_first_second, second[1]))
    back, back_clear = second[0].depth(transform_points(inverse(T_first_second), first[1]))
    return min(forth, back) if forth and back else max(forth_clear, back_clear)
