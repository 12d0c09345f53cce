"""`Reading`: what was read from a photograph."""

from collections import Counter
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

Label = Literal["door", "drawer", "handle", "knob", "shelf", "wheel"]
"""What a part is; handles include every fixed pull, knobs are dials and buttons that move, shelves include
trays and racks."""
Stand = Literal["flat", "legs", "wheels"]
"""What an object stands on: its base or a plinth, legs, or wheels."""
Field = Literal["flat", "framed", "slats", "planks"]
"""Of a front: a slab, a field in a frame, level slats, or upright planks and flutes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ReadPart:
    """A visible part. Boxes and corners are shares of the photograph's width and height, y down."""

    label: Label
    score: float
    """From 0 to 1."""
    box: Float[np.ndarray, "4"]
    """Left, top, right, bottom."""
    corners: Float[np.ndarray, "4 2"] | None = None
    """Of a front: from the upper left clockwise."""
    hinge: Literal["left", "right", "top", "bottom"] | None = None
    """Of a door: the side of its hinges as seen; None for a door that slides or whose side cannot be told."""
    open: bool = False
    pane: bool = False
    """Whether a front is glazed."""
    field: Field | None = None
    """Of a front that is not glazed; None where nobody has looked."""
    material: str | None = None
    """Of a front: wood, lacquer, steel, plastic, glass, rubber or stone."""
    form: Literal["bar", "knob"] | None = None
    """Of a handle: long, or about as wide as high."""
    color: tuple[int, int, int] | None = None
    """sRGB of the part as seen, with the light of the room."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Reading:
    """An object in a photograph."""

    kind: str
    kinds: tuple[tuple[str, float], ...]
    """All kinds with their probabilities, the likeliest first."""
    box: Float[np.ndarray, "4"]
    """Left, top, right, bottom of the object, as shares of width and height."""
    parts: tuple[ReadPart, ...]
    """Fronts in reading order, then the others."""
    size: tuple[float, float, float]
    """Width, depth and height (m), as usual for what is seen."""
    view: tuple[float, float, float]
    """Yaw and pitch of the camera (radians), and half the object's diagonal over its distance."""
    stand: Stand
    color: tuple[int, int, int]
    """sRGB of the body as seen."""
    extent: tuple[int, int]
    """Width and height of the photograph (pixels)."""
    notes: tuple[str, ...] = ()
    bare: bool = False
    """Whether its fronts are said to have no handles. Files of readings leave it out."""
    measured: bool = False
    """Whether lengths (but for their scale) and view are those of the object's outline."""
    surface: Bool[np.ndarray, "R C"] | None = None
    """Where the photograph, in equal cells, has the colour of the nearest front; None where nobody has
    looked. Files of readings leave it out."""

    @property
    def sure(self) -> bool:
        """Whether the kind is likelier than not."""
        return self.kinds[0][1] > SURE

    @property
    def counts(self) -> dict[str, int]:
        """Number of doors, drawers, handles and knobs in view."""
        found = Counter(part.label for part in self.parts)
        return {label: found[label] for label in ("door", "drawer", "handle", "knob")}

    @property
    def fronts(self) -> tuple[ReadPart, ...]:
        """Doors and drawers in reading order."""
        return tuple(part for part in self.parts if part.label in ("door", "drawer"))

    def to_json(self) -> dict[str, object]:
        """The reading as plain values, which `open_reading` reads back."""
        shown = {kind: round(share, 3) for kind, share in self.kinds if share >= 0.005}
        width, depth, height = self.size
        yaw, pitch, near = self.view
        return {
            "kind": self.kind,
            "extent": list(self.extent),
            "sure": self.sure,
            "kinds": shown,
            "counts": self.counts,
            "box": _round(self.box),
            "fronts": [_describe_front(part) for part in self.fronts],
            "parts": [
                {"label": part.label, "score": round(part.score, 3), "box": _round(part.box)}
                | ({} if part.form is None else {"form": part.form})
                | ({} if part.color is None else {"color": to_hex(part.color)})
                for part in self.parts
                if part.label not in ("door", "drawer")
            ],
            "measured": self.measured,
            "size": {"width": round(width, 2), "depth": round(depth, 2), "height": round(height, 2)},
            "camera": {
                "yaw": round(yaw, 3),
                "pitch": round(pitch, 3),
                "half_diagonal_over_distance": round(near, 3),
            },
            "stand": self.stand,
            "color": to_hex(self.color),
            "notes": list(self.notes),
        }


SURE = 0.5
"""Probability from which a kind counts as certain."""


def _describe_front(part: ReadPart) -> dict[str, object]:
    return {
        "label": part.label,
        "score": round(part.score, 3),
        "box": _round(part.box),
        "corners": None if part.corners is None else [_round(corner) for corner in part.corners],
        "hinge": part.hinge,
        "open": part.open,
        "pane": part.pane,
        "field": part.field,
        "material": part.material,
        "color": None if part.color is None else to_hex(part.color),
    }


def _round(values: Float[np.ndarray, "N"]) -> list[float]:
    return [round(float(value), 4) for value in values]


def to_hex(color: tuple[int, int, int]) -> str:
    """A colour such as ``#a0522d``."""
    return "#{:02x}{:02x}{:02x}".format(*color)
