"""`SketchRequest`: what is asked of a sketch, and `Asked`, the rows that say it to the network."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Int

from artigen.models.description import read_description
from artigen.shapes.draw import categories
from artigen.shapes.surfaces.finishes import Color, FinishKind
from artigen.shapes.surfaces.palette import ROLES
from artigen.sketch.rows import (
    CATEGORIES,
    COUNTED,
    MATERIALS,
    MAX_COUNT,
    REACH,
    ROW_KINDS,
    STYLES,
    WIDTH,
    column,
)
from artigen.sketch.sketch import LEVELS, STEP, SketchError
from artigen.types import PartLabel

NETWORKS = ("sketch", "kinds")
"""Names that sketch networks have in a model folder; of two that draw a category, the first one does."""
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
"""The finishes that a colour asked of parts of a label means."""
ALSO_OF: Mapping[str, tuple[str, ...]] = {
    "StorageFurniture": ("top",),
    "Table": ("top", "leg"),
    "WashingMachine": ("top",),
}
"""Further finishes, by category, that the colour of a whole object means: a blue table has a blue top."""
MATERIAL_OF: Mapping[str, FinishKind] = {"oak": "wood", "walnut": "wood", "steel": "steel", "silver": "steel"}
"""Colour words that name a material too."""


@dataclass(frozen=True, kw_only=True)
class AskedFinish:
    """A finish that is asked for by its role; what is None is left open."""

    role: str
    color: Color | None = None
    """sRGB in [0, 1]."""
    material: FinishKind | None = None


@dataclass(frozen=True, kw_only=True)
class SketchRequest:
    """A condition: any subset of category, style, counts, extents (m) and finishes."""

    category: str | None = None
    style: str | None = None
    counts: tuple[tuple[PartLabel, int], ...] = ()
    depth: float | None = None
    width: float | None = None
    height: float | None = None
    finishes: tuple[AskedFinish, ...] = ()
    some: tuple[PartLabel, ...] = ()
    """Labels with at least one part, where ``counts`` gives no number."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Asked:
    """A request as rows: one ``object`` and any number of ``finish`` rows, of which some cells are known."""

    rows: Int[np.ndarray, "A W"]
    known: Bool[np.ndarray, "A W"]
    some: tuple[PartLabel, ...] = ()
    """Labels whose count is not 0; the network is not told, the rules see to it."""


def nothing_asked() -> Asked:
    """The request that leaves all to chance."""
    return ask(SketchRequest())


def list_networks(model: Path) -> dict[str, tuple[str, ...]]:
    """The sketch networks of a model folder, with the categories that each draws; read without PyTorch.

    Raises:
        SourceError: If the folder has no readable description.
    """
    described = read_description(model)
    learned = {name: described.get(name, {}).get("categories") for name in NETWORKS}
    return {name: tuple(words) for name, words in learned.items() if isinstance(words, list)}


def list_learned(model: Path) -> tuple[str, ...]:
    """The categories that the sketch networks of a model folder draw.

    Raises:
        SourceError: If the folder has no readable description.
    """
    return tuple(dict.fromkeys(word for words in list_networks(model).values() for word in words))


def choose_network(model: Path, category: str | None) -> str:
    """Name of the first sketch network of a model folder that draws a category; of the first, for none.

    Raises:
        SourceError: If the folder has no readable description.
    """
    found = list_networks(model)
    return next((name for name, words in found.items() if category in words), NETWORKS[0])


def check_category(category: str, learned: Sequence[str] = CATEGORIES) -> None:
    """Refuses a category that a sketch network has not learned.

    Raises:
        SketchError: Naming the categories it has learned, and `artigen shape` where the grammar draws it.
    """
    if category in learned:
        return
    text = f"category {category!r}: expected one of {', '.join(learned)}, which the model draws"
    if category in categories():
        text += f"; `artigen shape {category}` draws it"
    raise SketchError(text)


def ask(request: SketchRequest) -> Asked:
    """The rows of a request.

    Raises:
        SketchError: If a category, style, role, count or length is none that sketches can say.
    """
    header, known = [ROW_KINDS.index("object")] + [0] * (WIDTH - 1), [True] + [False] * (WIDTH - 1)

    def say(name: str, value: int) -> None:
        header[column("object", name)] = value
        known[column("object", name)] = True

    if request.category is not None:
        check_category(request.category)
        say("category", CATEGORIES.index(request.category))
    if request.style is not None:
        if request.style not in STYLES:
            raise SketchError(f"style {request.style!r}: this model knows {', '.join(STYLES)}")
        say("style", STYLES.index(request.style))
    for label, count in request.counts:
        if label == "base":
            continue
        if not 0 <= count <= MAX_COUNT:
            raise SketchError(f"{count} parts called {label}: expected 0 to {MAX_COUNT}")
        say(COUNTED[COUNTED.index(label)], count)
    for name in ("depth", "width", "height"):
        length = getattr(request, name)
        if length is not None:
            if not 0.02 <= length < REACH * STEP:
                raise SketchError(f"{name} {length:g} m: expected from 0.02 to {REACH * STEP:.3f} m")
            say(name, round(length / STEP))
    rows, marks = [header], [known]
    for finish in sorted(request.finishes, key=lambda asked: _role(asked.role)):
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
    return Asked(rows=np.array(rows), known=np.array(marks), some=request.some)


def _role(name: str) -> int:
    if name not in ROLES:
        raise SketchError(f"finish {name!r}: expected one of {', '.join(ROLES)}")
    return ROLES.index(name)
