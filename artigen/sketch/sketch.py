"""`Sketch`: an articulated object in integers, with conversion from and to a `Shape`.

Lengths are steps of `STEP` metres, angles are half degrees, colours are levels of 0 to 63. x and y are
centred on the closed object, and the floor is z = 0. A shape survives conversion to within half a step;
converting the result again gives the same sketch.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from artigen.errors import ArtigenError
from artigen.kind import find_kind
from artigen.shapes.primitives import LEFT, Primitive
from artigen.shapes.shape import Need, Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish, FinishKind
from artigen.shapes.surfaces.palette import ROLES
from artigen.sketch.joints import build_joint, number_joint
from artigen.sketch.piece import Piece, UnknownSolid, across, number_axes
from artigen.sketch.pieces import build_piece, fit_pieces
from artigen.sketch.snap import STEP, snap_piece, to_metres
from artigen.types import Joint, PartLabel

LEVELS = 63
"""Highest level of a colour or gloss."""
OPACITIES = (1.0, 0.45, 0.22)
PERIODS = (0.4, 0.045, 0.012, 0.3, 0.05, 0.5, 0.006, 0.016)
"""Periods (m) of the patterns of finishes."""
FRACTIONS = (0.95, 1.0, 0.9, 0.5)
"""Shares of its range by which a required part must be open."""
MAX_NEEDS = 2


class SketchError(ArtigenError):
    """A shape that sketches cannot express, or a sketch that describes no shape."""


@dataclass(frozen=True, kw_only=True)
class SketchFinish:
    """A finish of a sketch's table: colours, gloss in levels, the rest as indices."""

    role: str
    kind: FinishKind
    color: tuple[int, int, int]
    accent: tuple[int, int, int]
    gloss: int
    opacity: int
    """Index into `OPACITIES`."""
    period: int
    """Index into `PERIODS`."""


@dataclass(frozen=True, kw_only=True)
class SketchPart:
    """A rigid part with a label; ``parent`` is an index, -1 for the base."""

    label: PartLabel
    parent: int
    pieces: tuple[Piece, ...]
    joint: Joint | None = None
    """In metres and radians, rounded to steps and half degrees."""
    needs: tuple[int, ...] = ()
    """Indices of the parts that must be open first."""
    fraction: int = 0
    """Index into `FRACTIONS`."""


@dataclass(frozen=True, kw_only=True)
class Sketch:
    """An articulated object in integers."""

    category: str
    style: str
    extents: tuple[int, int, int]
    """Depth, width and height of the closed object, in steps."""
    finishes: tuple[SketchFinish, ...]
    parts: tuple[SketchPart, ...]

    @property
    def counts(self) -> dict[str, int]:
        """Number of parts by label."""
        return dict(Counter(part.label for part in self.parts))


def lowest_corner(extents: Int[np.ndarray, "*N 3"]) -> Int[np.ndarray, "*N 3"]:
    """Lowest corner (steps) of closed objects with these extents: x and y are centred, the floor is z = 0."""
    return -(extents // 2) * np.array([1, 1, 0])


def write_sketch(shape: Shape) -> Sketch:
    """Converts a shape to a sketch.

    Raises:
        SketchError: If sketches cannot express a solid, joint or finish, which the message names.
    """
    shape = _free_followers(shape)
    fitted = [_fit_part(part, shape.name) for part in shape.parts]
    low = _lowest_numbers(fitted)
    # Align the lowest corner of the closed object with the grid, then centre it by whole steps.
    snapped = [[snap_piece(move_piece(piece, -low)) for piece in pieces] for pieces in fitted]
    start, end = _bound_pieces(snapped)
    start, end = np.floor(start).astype(int), np.ceil(end).astype(int)
    extents = end - start
    shift = lowest_corner(extents) - start
    names = [part.name for part in shape.parts]
    parts = tuple(
        _write_part(
            part,
            tuple(move_piece(piece, shift) for piece in pieces),
            names,
            shift * STEP - low,
            shape.name,
        )
        for part, pieces in zip(shape.parts, snapped, strict=True)
    )
    used = {piece.finish for part in parts for piece in part.pieces}
    used |= {piece.lining for part in parts for piece in part.pieces if piece.lining is not None}
    given = dict(shape.finishes)
    if unknown := used - set(ROLES):
        raise SketchError(f"{shape.name}: finishes {sorted(unknown)}, expected roles of {', '.join(ROLES)}")
    return Sketch(
        category=shape.category,
        style=shape.style,
        extents=(int(extents[0]), int(extents[1]), int(extents[2])),
        finishes=tuple(_write_finish(role, given[role]) for role in ROLES if role in used),
        parts=parts,
    )


def _free_followers(shape: Shape) -> Shape:
    """Removes what sketches cannot express: springs, and followers, which become independent joints. A part
    that requires the leader to be open requires its follower instead."""
    followers = {part.joint.follows: part.name for part in shape.parts if part.joint is not None}
    return replace(
        shape,
        parts=tuple(
            replace(
                part,
                joint=part.joint and replace(part.joint, follows=None, spring=0.0),
                needs=tuple(replace(need, part=followers.get(need.part, need.part)) for need in part.needs),
            )
            for part in shape.parts
        ),
    )


def read_sketch(sketch: Sketch, seed: int = 0) -> Shape:
    """Converts a sketch to a shape.

    Args:
        seed: Seed of the shape's name and of the patterns of its finishes.

    Raises:
        SketchError: If the sketch describes no shape; the message names the part.
    """
    names, kind = _name_parts(sketch.parts), find_kind(sketch.category)
    stays = kind is not None and kind.lid_stays  # sketches do not state it
    try:
        return Shape(
            category=sketch.category,
            seed=seed,
            style=sketch.style,
            parts=tuple(
                _read_part(part, name, names, stays=stays)
                for part, name in zip(sketch.parts, names, strict=True)
            ),
            finishes=tuple(
                (finish.role, _read_finish(finish, seed, index))
                for index, finish in enumerate(sketch.finishes)
            ),
        )
    except ValueError as error:
        raise SketchError(f"the sketch of a {sketch.category} describes no shape: {error}") from error


def piece_bounds(piece: Piece) -> Float[np.ndarray, "2 3"]:
    """Lowest and highest corner of a piece's exact solid, in the unit of its numbers."""
    bounds = np.array(piece.numbers[:6], dtype=float).reshape(2, 3)
    u, v = across(piece.axis)
    if piece.kind in ("frustum", "prism"):
        more = np.array(piece.numbers[6:]).reshape(2, 2)
        bounds[:, [u, v]] = [
            np.minimum(bounds[:, [u, v]].min(axis=0), more.min(axis=0)),
            np.maximum(bounds[:, [u, v]].max(axis=0), more.max(axis=0)),
        ]
    if piece.kind == "ring":
        reach = max(piece.numbers[8], (bounds[1, u] - bounds[0, u]) / 2)
        middle = bounds.mean(axis=0)
        bounds[:, [u, v]] = [middle[[u, v]] - reach, middle[[u, v]] + reach]
    return bounds


def move_piece(piece: Piece, offset: np.ndarray) -> Piece:
    """The piece shifted by ``offset``, in the unit of its numbers."""
    return replace(
        piece,
        numbers=tuple(
            number if axis is None else number + offset[axis].item()
            for number, axis in zip(piece.numbers, number_axes(piece.kind, piece.axis), strict=True)
        ),
    )


def _bound_pieces(parts: Sequence[Sequence[Piece]]) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    bounds = np.array([piece_bounds(piece) for pieces in parts for piece in pieces])
    return bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)


def _lowest_numbers(parts: Sequence[Sequence[Piece]]) -> Float[np.ndarray, "3"]:
    """The lowest coordinate among the numbers of pieces on each axis; on the grid for pieces read from a
    sketch."""
    out = np.full(3, np.inf)
    for piece in (piece for pieces in parts for piece in pieces):
        for number, axis in zip(piece.numbers, number_axes(piece.kind, piece.axis), strict=True):
            if axis is not None:
                out[axis] = min(out[axis], number)
    return out


def _fit_part(part: ShapePart, owner: str) -> tuple[Piece, ...]:
    try:
        return fit_pieces(part.primitives)
    except UnknownSolid as error:
        raise SketchError(f"{owner}: part {part.name!r} holds {error}") from error


def _write_part(
    part: ShapePart,
    pieces: tuple[Piece, ...],
    names: Sequence[str],
    offset: Float[np.ndarray, "3"],
    owner: str,
) -> SketchPart:
    parent = -1 if part.parent is None else names.index(part.parent)
    if parent >= names.index(part.name):
        raise SketchError(f"{owner}: part {part.name!r} comes before its parent {part.parent!r}")
    if len(part.needs) > MAX_NEEDS or len({need.fraction for need in part.needs}) > 1:
        raise SketchError(
            f"{owner}: {part.name!r} needs {len(part.needs)} parts open, expected at most {MAX_NEEDS} alike"
        )
    joint = part.joint
    if joint is None:
        return SketchPart(label=part.label, parent=parent, pieces=pieces)
    try:
        snapped = build_joint(number_joint(replace(joint, origin=joint.origin + offset)))
    except ValueError as error:
        raise SketchError(f"{owner}: {part.name!r} {error}") from error
    needs, own = [names.index(need.part) for need in part.needs], names.index(part.name)
    fraction = part.needs[0].fraction if part.needs else FRACTIONS[0]
    return SketchPart(
        label=part.label,
        parent=parent,
        pieces=pieces,
        joint=snapped,
        needs=(*(need for need in needs if need < own), *sorted(need for need in needs if need > own)),
        fraction=int(np.abs(np.array(FRACTIONS) - fraction).argmin()),
    )


def _write_finish(role: str, finish: Finish) -> SketchFinish:
    def levels(values: Sequence[float]) -> tuple[int, int, int]:
        r, g, b = (round(LEVELS * min(max(value, 0.0), 1.0)) for value in values)
        return r, g, b

    return SketchFinish(
        role=role,
        kind=finish.kind,
        color=levels(finish.color),
        accent=levels(finish.accent),
        gloss=round(LEVELS * finish.gloss),
        opacity=int(np.abs(np.array(OPACITIES) - finish.opacity).argmin()),
        period=int(np.abs(np.array(PERIODS) - finish.period).argmin()),
    )


def _read_finish(finish: SketchFinish, seed: int, index: int) -> Finish:
    r, g, b = (level / LEVELS for level in finish.color)
    accent_r, accent_g, accent_b = (level / LEVELS for level in finish.accent)
    return Finish(
        kind=finish.kind,
        color=(r, g, b),
        accent=(accent_r, accent_g, accent_b),
        grain=(0.0, 1.0, 0.0) if finish.kind == "steel" else (0.0, 0.0, 1.0),
        period=PERIODS[finish.period],
        seed=16 * seed + index,
        gloss=finish.gloss / LEVELS,
        opacity=OPACITIES[finish.opacity],
    )


def _name_parts(parts: Sequence[SketchPart]) -> tuple[str, ...]:
    """Part names: the base is ``body``; others are numbered by label."""
    held: Counter[str] = Counter()
    names = []
    for part in parts:
        names.append("body" if part.label == "base" else f"{part.label}_{held[part.label]}")
        held[part.label] += 1
    return tuple(names)


def _read_part(part: SketchPart, name: str, names: Sequence[str], *, stays: bool) -> ShapePart:
    """The part; with ``stays``, a lid (a door that opens upwards and back) stays wherever it is left."""
    try:
        primitives = tuple(primitive for piece in part.pieces for primitive in build_primitives(piece))
    except ValueError as error:
        raise ValueError(f"part {name!r}: {error}") from error
    motion = part.joint
    lifts = motion is not None and (motion.type, tuple(motion.axis)) == ("revolute", LEFT)
    if motion is not None and lifts and stays and part.label == "door":
        motion = replace(motion, stays=True)
    return ShapePart(
        name=name,
        label=part.label,
        parent=None if part.parent < 0 else names[part.parent],
        primitives=primitives,
        joint=motion,
        needs=tuple(Need(part=names[index], fraction=FRACTIONS[part.fraction]) for index in part.needs),
    )


def build_primitives(piece: Piece) -> tuple[Primitive, ...]:
    """The convex primitives of a sketch's piece.

    Raises:
        ValueError: If the numbers describe no solid.
    """
    return build_piece(to_metres(piece))
