"""A sketch as a table of integers, one row per statement in a fixed order.

``object`` (category, style, counts, extents), one ``finish`` for every role, then part after part: ``part``,
its pieces, and its ``joint``; ``end`` closes. A network reads and writes rows, field by field from the left.
Fields implied by earlier ones (the second edge of a square) are stored but not predicted.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Bool, Int

from artigen.shapes.surfaces.palette import ROLES
from artigen.sketch.piece import (
    CORNERS,
    INWARD,
    NUMBERS,
    PIECE_KINDS,
    SQUARE_KINDS,
    Piece,
    PieceKind,
    number_axes,
)
from artigen.sketch.row_values import (
    MATERIALS,
    find_word,
    hold_part,
    list_finish,
    list_joint,
    list_piece,
    read_finish,
    read_joint,
    read_piece,
)
from artigen.sketch.sketch import FRACTIONS, LEVELS, OPACITIES, PERIODS, Sketch, SketchError, SketchPart
from artigen.sketch.words import CATEGORIES, OTHER_STYLE, STYLES
from artigen.types import JOINT_TYPES, PART_LABELS

ROW_KINDS = ("object", "finish", "part", *PIECE_KINDS, "joint", "end")
COUNTED = PART_LABELS[1:]
MAX_COUNT = 31
MAX_PARTS = 62
MAX_SIDES = 31
REACH = 8192
"""Largest magnitude (steps) of coordinates and lengths: 4.096 m from the middle."""
LENGTH = 3
"""Pseudo-axis of numbers that are lengths."""
SQUARE = 4
"""Sides of a frustum whose edges may differ; with more it is round."""


@dataclass(frozen=True, kw_only=True)
class Field:
    """One field of a row: a symbol of ``size`` values, or a number where it is 0."""

    name: str
    size: int = 0


def _symbols(**sizes: int) -> tuple[Field, ...]:
    return tuple(Field(name=name, size=size) for name, size in sizes.items())


def _piece_fields(kind: PieceKind) -> tuple[Field, ...]:
    fields = _symbols(finish=len(ROLES), lined=INWARD + 2, lining=len(ROLES))
    if kind not in ("box", "plate"):
        fields += _symbols(axis=3)
    if kind in ("frustum", "ring", "spokes", "slab", "shell", "elbow"):
        fields += _symbols(sides=MAX_SIDES + 1)
    if kind == "spokes":
        fields += _symbols(phase=2)
    if kind in ("slab", "elbow"):
        fields += _symbols(corners=2**CORNERS if kind == "slab" else CORNERS)
    return fields + tuple(Field(name=name) for name in NUMBERS[kind])


_LEVEL = dict.fromkeys(("r", "g", "b", "accent_r", "accent_g", "accent_b", "gloss"), LEVELS + 1)
FIELDS: dict[str, tuple[Field, ...]] = {
    "object": (
        *_symbols(category=len(CATEGORIES), style=len(STYLES)),
        *_symbols(**dict.fromkeys(COUNTED, MAX_COUNT + 1)),
        *(Field(name=name) for name in ("depth", "width", "height")),
    ),
    "finish": (
        *_symbols(role=len(ROLES), material=len(MATERIALS), **_LEVEL),
        *_symbols(opacity=len(OPACITIES), period=len(PERIODS)),
    ),
    "part": _symbols(label=len(PART_LABELS), parent=MAX_PARTS + 1),
    **{kind: _piece_fields(kind) for kind in PIECE_KINDS},
    "joint": (
        *_symbols(type=len(JOINT_TYPES), axis=6, need0=MAX_PARTS + 1, need1=MAX_PARTS + 1),
        *_symbols(fraction=len(FRACTIONS)),
        *(Field(name=name) for name in ("x", "y", "z", "upper", "travel")),
        *_symbols(holds=MAX_PARTS + 1, released=len(FRACTIONS)),
    ),
    "end": (),
}
WIDTH = 1 + max(len(fields) for fields in FIELDS.values())
"""Columns of a table: the kind of the row, then its fields."""


def sketch_to_rows(sketch: Sketch) -> Int[np.ndarray, "T W"]:
    """The table of a sketch; columns that a row lacks are 0.

    Raises:
        SketchError: If a count, a part or a length exceeds the range of rows.
    """
    counts = sketch.counts
    rows = [
        _row(
            "object",
            find_word(CATEGORIES, sketch.category, "category"),
            STYLES.index(sketch.style) if sketch.style in STYLES else OTHER_STYLE,
            *(counts.get(label, 0) for label in COUNTED),
            *sketch.extents,
        ),
        *(_row("finish", *list_finish(finish)) for finish in sketch.finishes),
    ]
    for index, part in enumerate(sketch.parts):
        rows.append(_row("part", PART_LABELS.index(part.label), part.parent + 1))
        rows += [_row(piece.kind, *list_piece(piece, field_names(piece.kind))) for piece in part.pieces]
        rows.append(_row("joint", *list_joint(sketch, index)))
    table = np.array([*rows, _row("end")])
    _check_rows(table, sketch)
    return table


def rows_to_sketch(rows: Int[np.ndarray, "T W"]) -> Sketch:
    """Decodes a table; implied fields may be missing.

    Raises:
        SketchError: If rows are missing or out of order.
    """
    kinds = [ROW_KINDS[kind] for kind in rows[:, 0]]
    if kinds[0] != "object" or kinds[-1] != "end":
        raise SketchError(f"a table from {kinds[0]!r} to {kinds[-1]!r}, expected from 'object' to 'end'")
    finishes, parts = [], []
    header = rows[0, 1:].tolist()
    holds: list[tuple[int, int, int]] = []
    pieces: list[Piece] = []
    opened: tuple[int, int] | None = None
    for at, (kind, row) in enumerate(zip(kinds[1:-1], rows[1:-1, 1:].tolist(), strict=True), start=1):
        if kind == "finish" and not parts and opened is None:
            finishes.append(read_finish(row))
        elif kind == "part" and opened is None:
            opened = (row[0], row[1] - 1)
        elif kind in PIECE_KINDS and opened is not None:
            pieces.append(read_piece(_PIECE_KIND[kind], field_names(kind), row))
        elif kind == "joint" and opened is not None and pieces:
            label, parent = opened
            held, fraction = (row[column("joint", name) - 1] for name in ("holds", "released"))
            if held:
                holds.append((held - 1, len(parts), fraction))
            needs = tuple(need - 1 for need in row[2:4] if need and row[0])
            parts.append(
                SketchPart(
                    label=PART_LABELS[label],
                    parent=parent,
                    pieces=tuple(pieces),
                    joint=read_joint(row),
                    needs=needs,
                    fraction=row[4],
                )
            )
            pieces, opened = [], None
        else:
            raise SketchError(f"row {at} of a table is a {kind!r}, which cannot follow {kinds[at - 1]!r}")
    if opened is not None:
        raise SketchError("a table ends within a part")
    for held, holder, fraction in holds:
        parts[held] = hold_part(parts[held], holder, fraction)
    extents = header[len(FIELDS["object"]) - 3 : len(FIELDS["object"])]
    return Sketch(
        category=CATEGORIES[header[0]],
        style=STYLES[header[1]],
        extents=(extents[0], extents[1], extents[2]),
        finishes=tuple(finishes),
        parts=tuple(parts),
    )


def read_row_piece(row: Sequence[int]) -> Piece:
    """The piece of a row (kind first)."""
    kind = ROW_KINDS[row[0]]
    return read_piece(_PIECE_KIND[kind], field_names(kind), list(row[1:]))


@cache
def field_names(kind: str) -> tuple[str, ...]:
    """Field names of a row, in order."""
    return tuple(field.name for field in FIELDS[kind])


@cache
def column(kind: str, name: str) -> int:
    """The column of a field in the table."""
    return 1 + field_names(kind).index(name)


def find_predicted(rows: Int[np.ndarray, "T W"]) -> Bool[np.ndarray, "T W"]:
    """Cells of rows that are predicted, not implied by earlier fields."""
    columns = _key_columns()[rows[:, 0]]
    keys = np.where(columns > 0, np.take_along_axis(rows, columns, axis=1), 0)
    codes = np.ravel_multi_index((rows[:, 0], *keys.T), (len(ROW_KINDS), *[MAX_PARTS + 1] * 3))
    _, first, inverse = np.unique(codes, return_index=True, return_inverse=True)
    cells = np.zeros((len(first), WIDTH), dtype=bool)
    for at, row in enumerate(first):
        cells[at] = _predicted_cells(ROW_KINDS[rows[row, 0]], tuple(keys[row].tolist()))
    return cells[inverse]


def find_implied(row: Sequence[int]) -> frozenset[str]:
    """Names of the fields of a row (kind first) that are implied by earlier ones."""
    key = tuple(row[at] if at else 0 for at in _key_columns()[row[0]].tolist())
    return _implied(ROW_KINDS[row[0]], key)


def fill_implied(row: list[int]) -> None:
    """Fills in implied edge ends of a row (kind first), in place."""
    kind, follows = ROW_KINDS[row[0]], find_implied(row)
    if "v1" in follows:
        u0, v0, u1, v1 = (column(kind, name) for name in ("u0", "v0", "u1", "v1"))
        row[v1] = row[v0] + row[u1] - row[u0]
    for name in sorted(follows & {"x1", "y1", "z1"}):
        axis = "xyz".index(name[0])
        other = 3 - axis - row[column(kind, "axis")]
        low, high = column(kind, "x0"), column(kind, "x1")
        row[high + axis] = row[low + axis] + row[high + other] - row[low + other]


def number_axis(rows: Int[np.ndarray, "*T W"]) -> Int[np.ndarray, "*T W"]:
    """For every cell the axis of its coordinate, `LENGTH` for a length, -1 for a symbol."""
    table, own = number_axes_by_kind()
    kind = rows[..., 0]
    along = np.take_along_axis(rows, own[kind][..., None], axis=-1)[..., 0]
    return table[kind, np.where(own[kind] > 0, along, 0)]


@cache
def number_axes_by_kind() -> tuple[Int[np.ndarray, "K 3 W"], Int[np.ndarray, "K"]]:
    """Axes of the cells by kind of row and own axis, and the column of the own axis (0 for none)."""
    table = np.full((len(ROW_KINDS), 3, WIDTH), -1)
    own = np.zeros(len(ROW_KINDS), dtype=int)
    for index, kind in enumerate(ROW_KINDS):
        for axis in range(3) if kind in PIECE_KINDS else ():
            axes = [LENGTH if a is None else a for a in number_axes(_PIECE_KIND[kind], axis)]
            first = column(kind, "x0")
            table[index, axis, first : first + len(axes)] = axes
        if kind in PIECE_KINDS and "axis" in field_names(kind):
            own[index] = column(kind, "axis")
    joint, header = ROW_KINDS.index("joint"), ROW_KINDS.index("object")
    first = column("joint", "x")
    table[joint, :, first : first + 5] = (0, 1, 2, LENGTH, LENGTH)
    first = column("object", "depth")
    table[header, :, first : first + 3] = LENGTH
    return table, own


MAY_FOLLOW = frozenset(
    (
        *("lining", "x1", "y1", "z1", "v1", "axis", "need0", "need1", "fraction", "x", "y", "z", "upper"),
        *("travel", "holds", "released"),
    )
)
"""Names of all fields that may be implied."""


@cache
def _key_columns() -> Int[np.ndarray, "K 3"]:
    """Columns of the fields that determine the implied ones, by kind of row; 0 for none."""
    names = dict.fromkeys(PIECE_KINDS, ("lined", "axis", "sides")) | {"joint": ("type", "need0", "holds")}
    return np.array(
        [
            [column(kind, name) if name in field_names(kind) else 0 for name in names.get(kind, ("",) * 3)]
            for kind in ROW_KINDS
        ]
    )


@cache
def _implied(kind: str, key: tuple[int, ...]) -> frozenset[str]:
    """Implied fields of rows with a key."""
    if kind == "joint":
        joint, need, hold = JOINT_TYPES[key[0]], key[1], key[2]
        names: tuple[str, ...] = ("need1", "fraction") if joint == "fixed" or not need else ()
        names += ("released",) if joint == "fixed" or not hold else ()
        names += ("axis", "need0", "holds") if joint == "fixed" else ()
        names += ("x", "y", "z") if joint in ("fixed", "prismatic") else ()
        names += ("upper",) if joint in ("fixed", "continuous") else ()
        return frozenset(names if joint == "screw" else (*names, "travel"))
    if kind not in PIECE_KINDS:
        return frozenset()
    lined, axis, sides = key
    follows = set() if lined else {"lining"}
    if kind in SQUARE_KINDS or (kind == "frustum" and sides > SQUARE):
        # Of the two edges across the axis, the one that ends later is implied.
        follows.add(("x1", "y1", "z1")[max((axis + 1) % 3, (axis + 2) % 3)])
        follows |= {"v1"} if kind == "frustum" else set()
    return frozenset(follows)


@cache
def _predicted_cells(kind: str, key: tuple[int, ...]) -> Bool[np.ndarray, "W"]:
    """Predicted cells of rows with a key."""
    predicted = np.zeros(WIDTH, dtype=bool)
    predicted[: 1 + len(FIELDS[kind])] = True
    for name in _implied(kind, key):
        predicted[column(kind, name)] = False
    return predicted


_PIECE_KIND: dict[str, PieceKind] = {kind: kind for kind in PIECE_KINDS}


def _row(kind: str, *values: int) -> list[int]:
    return [ROW_KINDS.index(kind), *values, *[0] * (WIDTH - 1 - len(values))]


def _check_rows(table: Int[np.ndarray, "T W"], sketch: Sketch) -> None:
    if len(sketch.parts) > MAX_PARTS or max(sketch.counts.values()) > MAX_COUNT:
        raise SketchError(
            f"a {sketch.category} of {len(sketch.parts)} parts, at most {max(sketch.counts.values())} of one "
            f"label: expected at most {MAX_PARTS}, and {MAX_COUNT} of one"
        )
    if np.abs(table[number_axis(table) >= 0]).max() >= REACH:
        raise SketchError(f"a {sketch.category} with extents of {sketch.extents} steps: at most {REACH}")
