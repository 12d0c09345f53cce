"""Values of single rows of a table: converts finishes, pieces and joints to fields and back."""

from collections.abc import Sequence
from dataclasses import replace
from typing import get_args

from artigen.shapes.surfaces.finishes import FinishKind
from artigen.shapes.surfaces.palette import ROLES
from artigen.sketch.joints import build_joint, number_joint
from artigen.sketch.piece import NUMBERS, Piece, PieceKind
from artigen.sketch.sketch import (
    MAX_NEEDS,
    Sketch,
    SketchError,
    SketchFinish,
    SketchPart,
)
from artigen.types import Joint

MATERIALS: tuple[FinishKind, ...] = get_args(FinishKind)


def find_word(known: Sequence[str], name: str, what: str) -> int:
    """Index of a word in a vocabulary list.

    Raises:
        SketchError: If the list does not contain it.
    """
    if name not in known:
        raise SketchError(f"{what} {name!r}, expected one of {', '.join(known)}")
    return known.index(name)


def list_finish(finish: SketchFinish) -> list[int]:
    """The values of a finish."""
    return [
        find_word(ROLES, finish.role, "role"),
        MATERIALS.index(finish.kind),
        *finish.color,
        *finish.accent,
        finish.gloss,
        finish.opacity,
        finish.period,
    ]


def list_piece(piece: Piece, fields: Sequence[str]) -> list[int]:
    """The values of a piece, in the order of its field names."""
    values: dict[str, int] = {
        "finish": find_word(ROLES, piece.finish, "role"),
        "lined": 0 if piece.lined is None else piece.lined + 1,
        "lining": 0 if piece.lining is None else find_word(ROLES, piece.lining, "role"),
        "axis": piece.axis,
        "sides": piece.sides,
        "phase": piece.phase,
        "corners": piece.corners,
        **{name: int(number) for name, number in zip(NUMBERS[piece.kind], piece.numbers, strict=True)},
    }
    return [values[name] for name in fields]


def list_joint(sketch: Sketch, index: int) -> list[int]:
    """The values of a part's joint; empty without a joint.

    If one of two parts requires the other to be open, the later part's row states it.

    Raises:
        SketchError: If more than one earlier part requires it to be open.
    """
    own = sketch.parts[index]
    if own.joint is None:
        return []
    early = [need + 1 for need in own.needs if need < index]
    held = [k for k, part in enumerate(sketch.parts[:index]) if index in part.needs]
    if len(held) > 1:
        raise SketchError(f"a {sketch.category}: part {index} holds parts {held}, expected at most one")
    kind, axis, *rest = number_joint(own.joint)
    return [
        kind,
        axis,
        *[*early, 0, 0][:2],
        own.fraction if early else 0,
        *rest,
        *((held[0] + 1, sketch.parts[held[0]].fraction) if held else (0, 0)),
    ]


def hold_part(part: SketchPart, holder: int, fraction: int) -> SketchPart:
    """Adds a requirement to a part: a later part must be open before it moves.

    Raises:
        SketchError: If the part does not move, or already has `MAX_NEEDS` requirements.
    """
    if part.joint is None or len(part.needs) >= MAX_NEEDS:
        raise SketchError(f"part {holder} holds a {part.label} that does not move or is held by {MAX_NEEDS}")
    return replace(part, needs=(*part.needs, holder), fraction=fraction)


def read_finish(row: Sequence[int]) -> SketchFinish:
    """Decodes a finish."""
    return SketchFinish(
        role=ROLES[row[0]],
        kind=MATERIALS[row[1]],
        color=(row[2], row[3], row[4]),
        accent=(row[5], row[6], row[7]),
        gloss=row[8],
        opacity=row[9],
        period=row[10],
    )


def read_piece(kind: PieceKind, fields: Sequence[str], row: Sequence[int]) -> Piece:
    """Decodes a piece, given the names of its fields."""
    values = dict(zip(fields, row, strict=False))
    lined = values["lined"]
    return Piece(
        kind=kind,
        finish=ROLES[values["finish"]],
        numbers=tuple(values[name] for name in NUMBERS[kind]),
        lining=ROLES[values["lining"]] if lined else None,
        lined=lined - 1 if lined else None,
        axis=values.get("axis", 0),
        sides=values.get("sides", 0),
        phase=values.get("phase", 0),
        corners=values.get("corners", 0),
    )


def read_joint(row: Sequence[int]) -> Joint | None:
    """Decodes a joint; its needs and its ``holds`` field are not part of it."""
    return build_joint((*row[:2], *row[5:10])) if row[0] else None
