"""Colours of finishes at any point: wood grain, brushed steel, speckled stone, all functions of position.

Works on numpy arrays and torch tensors with the same result; float32 inside. Positions are metres in the
object frame at rest. `paint` evaluates one finish, `paint_primitives` a whole object, where every primitive
is a separate board: its grain runs along it and no two boards are alike.

Patterns finer than ``footprint`` (the size in metres that one sample represents) are omitted, so that
pictures and voxels do not alias.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np
from array_api_compat import array_namespace, device
from jaxtyping import Float, Int

from artigen.shapes.primitives import LEFT, Primitive, Vector
from artigen.shapes.shape import Shape
from artigen.shapes.surfaces.finishes import Finish, FinishKind
from artigen.shapes.surfaces.noise import hash_unit, lattice_noise, smooth_step

KINDS: tuple[FinishKind, ...] = get_args(FinishKind)
OWN_GRAIN = 1.5
"""Ratio of length to width from which the grain of a board runs along it; of others it is upright, and level
on drawers, so that square fronts match wide ones."""
LINED = 0.5
"""Cosine between normal and lined side above which the lining shows."""
PATTERN_OF: dict[FinishKind, int] = {
    "wood": 1,
    "steel": 2,
    "stone": 3,
    "lacquer": 4,
    "plastic": 4,
    "rubber": 4,
    "glass": 0,
}
"""Pattern of each kind, counted from one; glass is uniform."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PaintTable:
    """Input of `apply_paint`, in rows: primitive i has row 2 i outside and row 2 i + 1 where lined.

    A lookup table of plain arrays, computed once per object, so that renderers can keep it on their device.
    """

    kind: Int[Any, "R"]
    """Index into `KINDS`."""
    pattern: Int[Any, "R"]
    """Index into `PATTERNS`, counted from one; zero is uniform."""
    color: Float[Any, "R 3"]
    accent: Float[Any, "R 3"]
    axes: Float[Any, "R 3 3"]
    """Rows: along the grain, and the two directions across it."""
    period: Float[Any, "R"]
    seed: Int[Any, "R"]
    """Differs from board to board for wood."""
    gloss: Float[Any, "R"]
    opacity: Float[Any, "R"]
    lined_side: Float[Any, "P 3"]
    """Zero where a primitive has no lining."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Spots:
    """Points of one kind of material with all inputs of patterns; arrays of equal length."""

    xp: Any
    along: Any
    across: Any
    """In the surface, perpendicular to the grain (m)."""
    depth: Any
    """Perpendicular to both (m)."""
    points: Any
    period: Any
    seed: Any
    footprint: Any


def paint(
    finish: Finish, points: Float[Any, "N 3"], normals: Float[Any, "N 3"], *, footprint: float = 0.0
) -> Float[Any, "N 3"]:
    """Colours (sRGB in [0, 1]) of one finish at points (m) with outward normals, in the frame at rest."""
    xp = array_namespace(points)
    rows = xp.zeros(points.shape[0], dtype=xp.int64, device=device(points))
    table = place_table(_table([finish], [finish.grain], [0]), points)
    return apply_paint(table, rows, points, normals, footprint=footprint)


def paint_primitives(
    shape: Shape,
    primitive_ids: Int[Any, "N"],
    points: Float[Any, "N 3"],
    normals: Float[Any, "N 3"],
    *,
    footprint: float = 0.0,
) -> Float[Any, "N 3"]:
    """Colours (sRGB in [0, 1]) of points on an object's surface.

    Args:
        shape: The object.
        primitive_ids: Primitive of each point, counted through all parts in order.
        points: Metres, object frame at rest.
        normals: Outward, object frame at rest; they choose between a primitive's finish and its lining.
        footprint: Patterns finer than this (m) are omitted.
    """
    table = place_table(make_paint(shape), points)
    rows = find_rows(table, primitive_ids, normals)
    return apply_paint(table, rows, points, normals, footprint=footprint)


def make_paint(shape: Shape) -> PaintTable:
    """The table of an object, as numpy arrays."""
    finishes = dict(shape.finishes)
    chosen: list[Finish] = []
    grains: list[Vector] = []
    sides: list[Vector] = []
    for part, primitive in ((one, primitive) for one in shape.parts for primitive in one.primitives):
        for name in (primitive.finish, primitive.lining or primitive.finish):
            finish = finishes[name]
            level = part.label == "drawer" and finish.kind == "wood"
            chosen.append(finish)
            grains.append(_grain_of(primitive, replace(finish, grain=LEFT) if level else finish))
        sides.append(primitive.lined_side or (0.0, 0.0, 0.0))
    boards = [index // 2 + 1 if finish.kind == "wood" else 0 for index, finish in enumerate(chosen)]
    return _table(chosen, grains, boards, sides)


def place_table(table: PaintTable, like: Any) -> PaintTable:
    """Converts the table to the array library and device of ``like``."""
    xp = array_namespace(like)
    values = {name: xp.asarray(value, device=device(like)) for name, value in vars(table).items()}
    return PaintTable(**values)


def find_rows(table: PaintTable, primitive_ids: Int[Any, "N"], normals: Float[Any, "N 3"]) -> Int[Any, "N"]:
    """The row of each point: its primitive's finish, or its lining where the normal faces the lined side."""
    xp = array_namespace(normals)
    facing = xp.sum(xp.take(table.lined_side, primitive_ids, axis=0) * normals, axis=1) > LINED
    return 2 * primitive_ids + xp.astype(facing, primitive_ids.dtype)


def apply_paint(
    table: PaintTable,
    rows: Int[Any, "N"],
    points: Float[Any, "N 3"],
    normals: Float[Any, "N 3"],
    *,
    footprint: Any = 0.0,
) -> Float[Any, "N 3"]:
    """Colours (sRGB in [0, 1]) of points by their rows of the table; ``footprint`` may be one per point."""
    xp = array_namespace(points)
    points, normals = xp.astype(points, xp.float32), xp.astype(normals, xp.float32)
    mix, tone = xp.zeros_like(points[:, 0]), xp.ones_like(points[:, 0])
    patterns = xp.take(table.pattern, rows, axis=0)
    for index, pattern in enumerate(PATTERNS, start=1):
        (found,) = xp.nonzero(patterns == index)
        if found.shape[0] == 0:
            continue
        coarse = footprint if isinstance(footprint, float) else xp.take(footprint, found, axis=0)
        chosen, places, facing = (xp.take(value, found, axis=0) for value in (rows, points, normals))
        spots = _find_spots(xp, table, chosen, places, facing, coarse)
        mix[found], tone[found] = pattern(spots)
    color, accent = (xp.take(value, rows, axis=0) for value in (table.color, table.accent))
    return xp.clip((color + (accent - color) * mix[:, None]) * tone[:, None], 0.0, 1.0)


def _wood(spots: _Spots) -> tuple[Any, Any]:
    """Boards sawn from a log: growth rings of uneven width about a wandering pith, pores in short dashes,
    blotches where fibres lean, and a tone per board."""
    xp, period = spots.xp, spots.period
    strip = xp.floor(spots.across / (6.0 * period))  # a wide panel is glued from several boards
    board = spots.seed + xp.astype(strip, xp.int32) * 7919
    lot = [hash_unit(xp, board + 101 * k) for k in range(3)]
    along, across = spots.along + 40.0 * lot[0], spots.across - (strip + 0.2 + 0.6 * lot[1]) * 6.0 * period
    wander = lattice_noise(xp, board + 11, along / (16.0 * period)) - 0.5
    tilt = lattice_noise(xp, board + 12, along / (3.0 * period), across / (1.2 * period)) - 0.5
    pith = (0.6 + 1.6 * lot[2] + 2.4 * wander) * period + spots.depth
    radius = xp.sqrt(across * across + pith * pith) + 0.3 * period * tilt
    spacing = 0.2 * period
    turn = radius / spacing
    turn = turn + 1.6 * lattice_noise(xp, board + 16, 0.31 * turn)  # wet years and dry ones
    late = 0.5 + 0.5 * xp.sin(6.2831853 * turn)
    strength = lattice_noise(xp, board + 13, 0.43 * turn)
    blotch = lattice_noise(xp, board + 14, across / (0.25 * period), along / (1.1 * period))
    pores = lattice_noise(xp, board + 15, (across + spots.depth) / (0.03 * period), along / (0.3 * period))
    mix = (
        0.2
        + 0.38 * late * late * strength * _kept(spots, spacing)
        + 0.55 * (blotch - 0.5)
        + 0.5 * (smooth_step(xp, 0.5, 0.85, pores) - 0.25) * _kept(spots, 0.06 * period)
    )
    return xp.clip(mix, -0.2, 1.2), 0.96 + 0.08 * lot[0]


def _steel(spots: _Spots) -> tuple[Any, Any]:
    """Brushing: long, fine lines in bundles. Sheets are never quite flat: broad bands across the lines are
    brighter."""
    xp, period = spots.xp, spots.period
    fine = lattice_noise(
        xp, spots.seed, (spots.across + spots.depth) / (0.06 * period), spots.along / (8 * period)
    )
    bundle = lattice_noise(xp, spots.seed + 1, spots.across / (0.5 * period), spots.along / (25 * period))
    sheet = lattice_noise(xp, spots.seed + 2, spots.along / (14.0 * period))
    bend = lattice_noise(xp, spots.seed + 3, spots.along / (4.0 * period))
    lines = 0.4 * (fine - 0.5) * _kept(spots, 0.12 * period) + 0.1 * (bundle - 0.5)
    return 0.5 + lines - 1.1 * (sheet - 0.5) - 0.4 * (bend - 0.5), 0.97 + 0.06 * sheet


def _stone(spots: _Spots) -> tuple[Any, Any]:
    """Chips of two sizes in a slightly uneven ground."""
    xp, seed = spots.xp, spots.seed
    noises = []
    for octave, share in enumerate((4.0, 1.0, 0.45)):
        x, y, z = (spots.points[:, k] / (share * spots.period) for k in range(3))
        noises.append(lattice_noise(xp, seed + octave, x, y, z))
    ground, chips, grains = noises
    kept = _kept(spots, spots.period)
    large, small = smooth_step(xp, 0.66, 0.72, chips), smooth_step(xp, 0.63, 0.7, grains)
    mix = (0.7 * large + 0.35 * small) * kept + 0.15 * (1.0 - kept)
    return xp.clip(mix + 0.12 * (ground - 0.5), 0.0, 1.0), 0.97 + 0.06 * ground


def _even(spots: _Spots) -> tuple[Any, Any]:
    """Paint, plastic, rubber: nearly uniform."""
    xp, turn = spots.xp, 6.2831853 / spots.period
    waves = [xp.sin(spots.points[:, k] * turn + k) for k in range(3)]
    cloud = 0.5 + (waves[0] + waves[1] + waves[2]) / 6.0
    return cloud, 0.995 + 0.01 * cloud


PATTERNS: tuple[Callable[[_Spots], tuple[Any, Any]], ...] = (_wood, _steel, _stone, _even)
"""Each returns the share of the accent, and the brightness."""


def _kept(spots: _Spots, wavelength: Any) -> Any:
    """Amplitude of a pattern after sampling with the footprint: zero from half a wavelength on."""
    return spots.xp.clip(2.0 - 4.0 * spots.footprint / wavelength, 0.0, 1.0)


def _find_spots(xp: Any, table: PaintTable, rows: Any, points: Any, normals: Any, footprint: Any) -> _Spots:
    axes = xp.take(table.axes, rows, axis=0)
    local = [_dot(points, axes[:, k, :]) for k in range(3)]
    facing = [xp.abs(_dot(normals, axes[:, k, :])) for k in (1, 2)]
    swap = facing[0] > 1.001 * facing[1]  # ties must not depend on rounding
    return _Spots(
        xp=xp,
        along=local[0],
        across=xp.where(swap, local[2], local[1]),
        depth=xp.where(swap, local[1], local[2]),
        points=points,
        period=xp.take(table.period, rows, axis=0),
        seed=xp.take(table.seed, rows, axis=0),
        footprint=footprint,
    )


def _dot(a: Any, b: Any) -> Any:
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]


def _grain_of(primitive: Primitive, finish: Finish) -> Vector:
    """Grain direction: along an elongated primitive, else as in the finish unless that is its thin side."""
    if finish.kind not in ("wood", "steel"):
        return finish.grain
    order = np.argsort(primitive.size)
    long, thin = primitive.rotation[:, order[2]], primitive.rotation[:, order[0]]
    stretched = primitive.size[order[2]] > OWN_GRAIN * primitive.size[order[1]]
    through = abs(float(np.dot(thin, finish.grain))) > 0.7
    wanted = stretched if finish.kind == "wood" else False
    return (float(long[0]), float(long[1]), float(long[2])) if wanted or through else finish.grain


def _table(
    finishes: Sequence[Finish],
    grains: Sequence[Vector],
    boards: Sequence[int],
    sides: Sequence[Vector] = ((0.0, 0.0, 0.0),),
) -> PaintTable:
    seeds = np.array([finish.seed for finish in finishes], np.int64) + np.array(boards, np.int64) * 104729
    return PaintTable(
        kind=np.array([KINDS.index(finish.kind) for finish in finishes], np.int32),
        pattern=np.array([PATTERN_OF[finish.kind] for finish in finishes], np.int32),
        color=np.array([finish.color for finish in finishes], np.float32),
        accent=np.array([finish.accent for finish in finishes], np.float32),
        axes=_frames(np.array(grains, np.float64)).astype(np.float32),
        period=np.array([finish.period for finish in finishes], np.float32),
        seed=(seeds % 2**31).astype(np.int32),
        gloss=np.array([finish.gloss for finish in finishes], np.float32),
        opacity=np.array([finish.opacity for finish in finishes], np.float32),
        lined_side=np.array(sides, np.float32),
    )


def _frames(grains: Float[np.ndarray, "R 3"]) -> Float[np.ndarray, "R 3 3"]:
    """Rows (grain, two directions across), for axis-aligned grain along the object's axes."""
    along = grains / np.linalg.norm(grains, axis=1, keepdims=True)
    helper = np.roll(np.eye(3), 1, axis=0)[np.argmax(np.abs(along), axis=1)]
    across = np.cross(along, helper)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.stack([along, across, np.cross(along, across)], axis=1)
