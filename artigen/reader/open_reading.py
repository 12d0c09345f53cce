"""`open_reading`: a reading from a file that ``artigen read --json`` wrote and somebody has edited."""

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

import numpy as np
from jaxtyping import Float

from artigen.errors import SourceError, explain, name_options
from artigen.kind import kinds
from artigen.reader.labels import HINGES, MATERIALS
from artigen.reader.reading import Field, Label, Reading, ReadPart, Stand

FRONTS = ("door", "drawer")
OTHERS = tuple(label for label in get_args(Label) if label not in FRONTS)
FORMS = ("bar", "knob")


def open_reading(path: Path) -> Reading:
    """Reads a reading back.

    Only ``kind``, ``extent``, ``box``, ``size`` and ``fronts``, each with ``label`` and ``box``, are needed;
    what else is missing is as if nobody had seen it. ``counts`` and ``sure`` follow from the rest.

    Raises:
        SourceError: If the file cannot be read, or a value is missing or not allowed; the message names it.
    """
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise SourceError(
            f"{path}: no reading: {explain(error)}; write one with artigen read PHOTO --json"
        ) from error
    try:
        return parse_reading(held)
    except _InvalidValueError as error:
        raise SourceError(f"{path}: {error}") from None


class _InvalidValueError(ValueError):
    """What is wrong with a value, and where."""


def parse_reading(held: object) -> Reading:
    """The reading of plain values; inverts `Reading.to_json` but for what that rounds off."""
    values = _Values(held, "the reading")
    kind = values.choose("kind", tuple(kinds()))
    assert kind is not None
    shares = {name: float(share) for name, share in values.mapping("kinds", {kind: 1.0}).items()}
    shares = {name: share for name, share in shares.items() if name in kinds()} if kind in shares else {}
    size, view = values.part("size"), values.part("camera", optional=True)
    width, height = values.numbers("extent", 2)
    fronts = [_parse_part(one, FRONTS) for one in values.parts("fronts")]
    others = [_parse_part(one, OTHERS) for one in values.parts("parts", optional=True)]
    first = (kind, shares.pop(kind, 1.0))
    return Reading(
        kind=kind,
        kinds=(first, *sorted(shares.items(), key=lambda one: -one[1])),
        box=np.array(values.numbers("box", 4)),
        parts=(*fronts, *others),
        size=(size.number("width"), size.number("depth"), size.number("height")),
        view=(
            view.number("yaw", 0.0),
            view.number("pitch", 0.0),
            view.number("half_diagonal_over_distance", 0.1),
        ),
        stand=values.choose("stand", get_args(Stand), optional=True) or "flat",  # type: ignore[arg-type]
        color=values.color("color") or (200, 200, 200),
        extent=(round(width), round(height)),
        measured=bool(values.held.get("measured", False)),
        notes=tuple(str(note) for note in values.held.get("notes") or ()),
    )


def _parse_part(values: "_Values", labels: Sequence[str]) -> ReadPart:
    corners = values.held.get("corners")
    return ReadPart(
        label=values.choose("label", labels),  # type: ignore[arg-type]
        score=values.number("score", 1.0),
        box=_check_box(np.array(values.numbers("box", 4)), values.where),
        corners=None if corners is None else _parse_corners(corners, values.where),
        hinge=values.choose("hinge", HINGES, optional=True),  # type: ignore[arg-type]
        open=bool(values.held.get("open", False)),
        pane=bool(values.held.get("pane", False)),
        field=values.choose("field", get_args(Field), optional=True),  # type: ignore[arg-type]
        material=values.choose("material", MATERIALS, optional=True),
        form=values.choose("form", FORMS, optional=True),  # type: ignore[arg-type]
        color=values.color("color"),
    )


def _check_box(box: Float[np.ndarray, "4"], where: str) -> Float[np.ndarray, "4"]:
    if not (box[:2] < box[2:]).all():
        raise _InvalidValueError(
            f"box of {where} is {box.tolist()}: expected left, top, right and bottom, the last two larger"
        )
    return box


def _parse_corners(held: object, where: str) -> Float[np.ndarray, "4 2"]:
    try:
        corners = np.array(held, dtype=np.float64)
    except (TypeError, ValueError):
        corners = np.zeros(0)
    if corners.shape != (4, 2) or not np.isfinite(corners).all():
        raise _InvalidValueError(
            f"corners of {where} are {held}: expected four pairs of shares, from the upper left clockwise, "
            "or null"
        )
    return corners


class _Values:
    """The values of one object of a file, and where it is."""

    def __init__(self, held: object, where: str) -> None:
        if not isinstance(held, Mapping):
            raise _InvalidValueError(f"{where} is {held!r}: expected an object with named values")
        self.held: Mapping[str, Any] = held
        self.where = where

    def take(self, name: str) -> Any:
        if self.held.get(name) is None:
            raise _InvalidValueError(f"{self.where} has no {name}")
        return self.held[name]

    def mapping(self, name: str, default: Mapping[str, Any]) -> Mapping[str, Any]:
        return _Values(self.held.get(name) or default, name).held

    def part(self, name: str, *, optional: bool = False) -> "_Values":
        return _Values(self.held.get(name, {}) if optional else self.take(name), name)

    def parts(self, name: str, *, optional: bool = False) -> list["_Values"]:
        held = self.held.get(name, []) if optional else self.take(name)
        if not isinstance(held, list):
            raise _InvalidValueError(f"{name} of {self.where} is {held!r}: expected a list")
        return [_Values(one, f"{name}[{index}]") for index, one in enumerate(held)]

    def number(self, name: str, default: float | None = None) -> float:
        held = self.take(name) if default is None else self.held.get(name, default)
        if isinstance(held, bool) or not isinstance(held, int | float) or not np.isfinite(held):
            raise _InvalidValueError(f"{name} of {self.where} is {held!r}: expected a number")
        return float(held)

    def numbers(self, name: str, count: int) -> list[float]:
        held = self.take(name)
        if not isinstance(held, list) or len(held) != count:
            raise _InvalidValueError(f"{name} of {self.where} is {held!r}: expected {count} numbers")
        return [_Values({name: one}, self.where).number(name) for one in held]

    def choose(self, name: str, allowed: Sequence[str], *, optional: bool = False) -> str | None:
        held = self.held.get(name) if optional else self.take(name)
        if held is not None and held not in allowed:
            raise _InvalidValueError(
                f"{name} of {self.where} is {held!r}: expected {name_options(str(held), allowed)}"
            )
        return held

    def color(self, name: str) -> tuple[int, int, int] | None:
        held = self.held.get(name)
        if held is None:
            return None
        if not isinstance(held, str) or not re.fullmatch("#[0-9a-fA-F]{6}", held):
            raise _InvalidValueError(f"{name} of {self.where} is {held!r}: expected one such as #a0522d")
        return int(held[1:3], 16), int(held[3:5], 16), int(held[5:], 16)
