"""`SketchRequest`: conditions on a sketch, and `RequestRows`, the rows that encode them for the network."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Int

from artigen.errors import name_options
from artigen.kind import kinds, list_nouns
from artigen.models.description import read_description
from artigen.shapes.surfaces.finishes import Color, FinishKind
from artigen.shapes.surfaces.palette import ROLES
from artigen.sketch.rows import COUNTED, MATERIALS, MAX_COUNT, REACH, ROW_KINDS, WIDTH, column
from artigen.sketch.sketch import LEVELS, STEP, SketchError
from artigen.sketch.words import CATEGORIES, STYLES
from artigen.types import PartLabel

NETWORK = "sketch"
"""Name of the sketch network in a model folder."""
LEAST_SIZE = 0.01
"""Smallest extent (m) that can be requested."""
ROLES_OF: Mapping[PartLabel, tuple[str, ...]] = {
    "base": ("body", "front"),
    "door": ("front",),
    "drawer": ("front",),
    "handle": ("handle",),
    "knob": ("handle",),
    "shelf": ("top",),
    "wheel": ("rubber",),
    "tray": ("steel",),
}
"""Finishes that a colour requested for a label applies to."""


@dataclass(frozen=True, kw_only=True)
class FinishRequest:
    """A requested finish, by its role; None leaves a property open."""

    role: str
    color: Color | None = None
    """sRGB in [0, 1]."""
    material: FinishKind | None = None
    part: str | None = None
    """The noun of which it is said; None where it is that of the whole object."""


@dataclass(frozen=True, kw_only=True)
class SketchRequest:
    """Conditions: any subset of category, style, counts, extents (m) and finishes."""

    category: str | None = None
    style: str | None = None
    counts: tuple[tuple[PartLabel, int], ...] = ()
    depth: float | None = None
    width: float | None = None
    height: float | None = None
    finishes: tuple[FinishRequest, ...] = ()
    some: tuple[PartLabel, ...] = ()
    """Labels with at least one part, where ``counts`` gives no number."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RequestRows:
    """A request as rows: one ``object`` and any number of ``finish`` rows, with some cells known."""

    rows: Int[np.ndarray, "A W"]
    known: Bool[np.ndarray, "A W"]
    some: tuple[PartLabel, ...] = ()
    """Labels whose count is not 0; enforced by the rules, not an input of the network."""


def empty_request() -> RequestRows:
    """The unconditional request."""
    return encode_request(SketchRequest())


def list_learned(model: Path) -> tuple[str, ...]:
    """Categories of the sketch network in a model folder, read without PyTorch; empty if it has no such
    network.

    Raises:
        SourceError: If the folder has no readable description.
    """
    learned = read_description(model).get(NETWORK, {}).get("categories")
    return tuple(learned) if isinstance(learned, list) else ()


def check_category(category: str, learned: Sequence[str] = CATEGORIES) -> None:
    """Checks that a sketch network has learned a category.

    Raises:
        SketchError: If it has not; the message lists the learned categories, and `artigen shape` where the
            grammar supports the category.
    """
    if category in learned:
        return
    if learned:
        known = name_options(category, learned, list_nouns())
        text = f"category {category!r}: expected a kind that the model draws, {known}"
    else:
        text = f"category {category!r}: the model has no sketch network; give the folder of one that has"
    if category in kinds():
        text += f"; `artigen shape {category}` draws it"
    raise SketchError(text)


def encode_request(request: SketchRequest) -> RequestRows:
    """Encodes a request as rows.

    Raises:
        SketchError: If sketches cannot express a category, style, role, count or length.
    """
    header, known = [ROW_KINDS.index("object")] + [0] * (WIDTH - 1), [True] + [False] * (WIDTH - 1)

    def put(name: str, value: int) -> None:
        header[column("object", name)] = value
        known[column("object", name)] = True

    if request.category is not None:
        check_category(request.category)
        put("category", CATEGORIES.index(request.category))
    if request.style is not None:
        if request.style not in STYLES:
            raise SketchError(f"style {request.style!r}: this model knows {', '.join(STYLES)}")
        put("style", STYLES.index(request.style))
    for label, count in request.counts:
        if label == "base":
            continue
        if not 0 <= count <= MAX_COUNT:
            raise SketchError(f"{count} parts called {label}: expected 0 to {MAX_COUNT}")
        put(COUNTED[COUNTED.index(label)], count)
    for name in ("depth", "width", "height"):
        length = getattr(request, name)
        if length is not None:
            if not LEAST_SIZE <= length < REACH * STEP:
                raise SketchError(
                    f"{name} {length:g} m: expected from {LEAST_SIZE:g} to {REACH * STEP:.3f} m"
                )
            put(name, round(length / STEP))
    rows, marks = [header], [known]
    for finish in sorted(request.finishes, key=lambda finish: _role(finish.role)):
        row, mark = [ROW_KINDS.index("finish")] + [0] * (WIDTH - 1), [True, True] + [False] * (WIDTH - 2)
        row[column("finish", "role")] = _role(finish.role)
        if finish.material is not None:
            row[column("finish", "material")] = MATERIALS.index(finish.material)
            mark[column("finish", "material")] = True
        if finish.color is not None:
            at = column("finish", "r")
            row[at : at + 3] = [round(LEVELS * min(max(value, 0.0), 1.0)) for value in finish.color]
            mark[at : at + 3] = [True] * 3
        rows.append(row)
        marks.append(mark)
    return RequestRows(rows=np.array(rows), known=np.array(marks), some=request.some)


def _role(name: str) -> int:
    if name not in ROLES:
        raise SketchError(f"finish {name!r}: expected one of {', '.join(ROLES)}")
    return ROLES.index(name)
