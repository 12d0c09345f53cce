"""Pieces: what is seen of a part, made of its primitives. Rounds are smooth, and seen edges are broken."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np
from jaxtyping import Float, Int

from artigen.shapes.primitives import SEGMENTS, Primitive, place_vertices
from artigen.shapes.surfaces.finishes import Finish
from sim_export.geometry.broken_edges import PROBE, Cover, break_edges, edge_width
from sim_export.geometry.rounds import (
    Tube,
    build_ring,
    build_tube,
    find_plate,
    find_ring,
    find_sagitta,
    find_tube,
)
from sim_export.geometry.solids import as_solid
from sim_export.package import Hull, Mesh

RIM_SPOTS = 12
"""Places around a rim where it is judged."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """A closed body that stands for some primitives of a part, by their numbers."""

    solid: manifold3d.Manifold
    primitives: tuple[int, ...]
    is_round: bool
    centers: Float[np.ndarray, "P 3"]
    """Of the primitives (m)."""
    deviation: float = 0.0
    """Largest distance (m) between its surface and that of the primitives, measured from either."""

    def owners(self, points: Float[np.ndarray, "N 3"]) -> Int[np.ndarray, "N"]:
        """The primitive for which each point (m) of the surface stands."""
        if len(self.primitives) == 1:
            return np.full(len(points), self.primitives[0])
        far = np.linalg.norm(points[:, None] - self.centers[None], axis=2)
        return np.array(self.primitives)[far.argmin(axis=1)]


def draw_pieces(primitives: Sequence[Primitive], center: Float[np.ndarray, "3"]) -> list[Piece]:
    """The primitives of a part as they collide, relative to ``center`` (m)."""
    return [
        _piece(primitives, [index], _solid(one), center, _drawn_deviation(one))
        for index, one in enumerate(primitives)
    ]


def _drawn_deviation(primitive: Primitive) -> float:
    """Distance (m) of the prism that is drawn for a cylinder from it."""
    return find_sagitta(primitive.size[0] / 2, SEGMENTS) if primitive.kind == "cylinder" else 0.0


def find_pieces(
    primitives: Sequence[Primitive],
    finishes: Mapping[str, Finish],
    center: Float[np.ndarray, "3"],
    *,
    boards: bool,
) -> list[Piece]:
    """The pieces of a part, relative to ``center`` (m); ``boards`` as in `break_edges`."""
    cover, broken = Cover(primitives), break_edges(primitives, finishes, boards=boards)
    out: list[Piece] = []
    at = 0
    while at < len(primitives):
        count, hole = 1, None
        wedges = find_ring(primitives[at:])
        ring = build_ring(primitives[at : at + wedges]) if wedges else None
        seen: Mesh | Hull
        if ring is not None:
            count, (seen, far) = wedges, ring
        elif (plate := find_plate(primitives[at:])) is not None:
            count, seen, hole, far = plate
        elif (tube := find_tube(primitives[at])) is not None:
            width = edge_width(primitives[at], finishes[primitives[at].finish])
            rims = _rims(tube, width, cover, at)
            seen = build_tube(tube, rims)
            far = max(rims) + tube.deviation
        else:
            seen, far = _solid(broken[at].primitive), broken[at].deviation
        out.append(_piece(primitives, range(at, at + count), seen, center, far, hole))
        at += count
    return out


def _solid(primitive: Primitive) -> Hull:
    return Hull(vertices=place_vertices(primitive), faces=primitive.faces)


def _piece(
    primitives: Sequence[Primitive],
    own: Sequence[int],
    seen: Mesh | Hull,
    center: Float[np.ndarray, "3"],
    deviation: float,
    hole: Mesh | None = None,
) -> Piece:
    solid = _level(seen, center)
    if hole is not None:
        solid = solid - _level(hole, center)
    return Piece(
        solid=solid.as_original(),
        primitives=tuple(own),
        is_round=primitives[own[0]].kind == "cylinder",
        centers=np.array([primitives[index].center - center for index in own]),
        deviation=deviation,
    )


def _level(mesh: Mesh | Hull, center: Float[np.ndarray, "3"]) -> manifold3d.Manifold:
    """The solid at the precision of files."""
    return as_solid(Hull(vertices=np.round(mesh.vertices - center, 6), faces=mesh.faces))


def _rims(tube: Tube, width: float, cover: Cover, index: int) -> tuple[float, float]:
    """Widths to which the rims of a tube are broken: 0 where most of one is covered."""
    turn = np.arange(RIM_SPOTS) * 2 * np.pi / RIM_SPOTS
    widths = []
    for end in (0, 1):
        arms = np.cos(turn)[:, None] * tube.first[end] + np.sin(turn)[:, None] * tube.second[end]
        out = arms / np.linalg.norm(arms, axis=1, keepdims=True)
        away = tube.centers[end] - tube.centers[1 - end]
        away = away / np.linalg.norm(away)
        rim = tube.centers[end] + arms
        probes = np.stack([out + away, out - 2 * away, away - 2 * out]) * PROBE + rim
        free = cover.free(probes.reshape(-1, 3), [index]).reshape(3, -1).all(axis=0)
        widths.append(width if free.mean() >= 0.5 else 0.0)
    return widths[0], widths[1]
