"""`Sentence`: what a description in English asks for, as a plain value.

"A tall white cabinet with three drawers and two black handles, 80 cm wide" gives a StorageFurniture of 0.8 m,
higher than usual, with three drawers and two handles, and colours. Words without a meaning are listed as
ignored, never dropped.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from artigen.conditioning.measures import Axis
from artigen.conditioning.suggest import suggest
from artigen.conditioning.vocabulary import Spot
from artigen.errors import ArtigenError
from artigen.kind import kinds, plurals
from artigen.types import PartLabel

OBJECT = "object"
"""Target of colours and materials of the whole object."""


class TextError(ArtigenError):
    """A sentence that names no kind, contradicts itself, or asks for what cannot be."""


@dataclass(frozen=True, kw_only=True)
class Placing:
    """Where some parts of a label are on the front, as seen."""

    label: PartLabel
    count: int | None
    """How many; None for all of them."""
    at: Spot
    pane: bool = False
    """Whether they are glazed and others of the label are not."""


@dataclass(frozen=True, kw_only=True)
class Sentence:
    """Content of a sentence. Lengths in metres; pairs are sorted."""

    kind: str | None = None
    noun: str | None = None
    """Singular of the noun that names the kind."""
    objects: int = 1
    """Number of such objects."""
    style: str | None = None
    counts: tuple[tuple[PartLabel, int], ...] = ()
    some: tuple[PartLabel, ...] = ()
    """Parts that are named without a number: at least one."""
    articles: tuple[PartLabel, ...] = ()
    """Parts that are counted by an article alone: a door, where furniture has one and others at least one."""
    size: tuple[tuple[Axis, float], ...] = ()
    ranges: tuple[tuple[Axis, float, float], ...] = ()
    """Least and largest lengths; 0 and infinity where an end is open."""
    ratios: tuple[tuple[Axis, float, Axis], ...] = ()
    """Lengths as multiples of others: twice as tall as wide."""
    stretch: tuple[tuple[Axis, float], ...] = ()
    """Factors relative to the usual extents: a tall cabinet."""
    volume: float | None = None
    """What it holds (m^3)."""
    colors: tuple[tuple[str, str], ...] = ()
    """Colour words by target: `OBJECT`, a part label, or the finish of a piece."""
    materials: tuple[tuple[str, str], ...] = ()
    """Material words by target."""
    features: tuple[tuple[str, str, str], ...] = ()
    """Other properties: part, property, value, such as door, hinged, left."""
    places: tuple[Placing, ...] = ()
    """In the order of the words."""
    ignored: tuple[str, ...] = ()
    """Words and phrases without a known meaning, in their order."""

    def to_json(self) -> dict[str, object]:
        """A value for JSON: kind, style, counts, size (m), usual extents to scale, and properties by part."""
        parts: dict[str, dict[str, object]] = {label: {} for label in self.some}
        for what, pairs in (("color", self.colors), ("material", self.materials)):
            for target, word in pairs:
                parts.setdefault(target, {})[what] = word
        for part, what, value in self.features:
            parts.setdefault(part, {})[what] = value
        for label in dict.fromkeys(place.label for place in self.places):
            spots = {place.at: place.count for place in self.places if place.label == label}
            parts.setdefault(label, {})["at"] = spots if len(spots) > 1 else next(iter(spots))
            glazed = [place.at for place in self.places if place.label == label and place.pane]
            parts[label] |= {"glazed": glazed} if glazed else {}
        return {
            "kind": self.kind,
            "objects": self.objects,
            "style": self.style,
            "counts": dict(self.counts),
            "size": {axis: round(length, 6) for axis, length in self.size},
            "ranges": {
                axis: [round(low, 6) or None, None if high == math.inf else round(high, 6)]
                for axis, low, high in self.ranges
            },
            "ratios": [list(ratio) for ratio in self.ratios],
            "stretch": dict(self.stretch),
            "volume": self.volume,
            "parts": parts,
            "ignored": list(self.ignored),
        }

    def describe(self) -> str:
        """One line: what is understood, and what is not."""
        kind = None if self.kind is None else kinds()[self.kind]
        formed = kind is not None and self.noun in kind.forms
        said = [f"{self.kind} ({self.noun})" if formed else self.kind or "any kind"]
        said += [f"{self.objects} of them"] if self.objects > 1 else []
        said += [] if self.style is None else [f"style {self.style}"]
        said += [f"{length:g} m {_WORDS[axis]}" for axis, length in self.size]
        said += [f"{_span(low, high)} {_WORDS[axis]}" for axis, low, high in self.ranges]
        said += [
            f"{axis} {f'{factor:g} times' if factor != 1 else 'equal to'} the {other}"
            for axis, factor, other in self.ratios
        ]
        said += [f"{factor:g} times the usual {axis}" for axis, factor in self.stretch]
        said += [] if self.volume is None else [f"{1000 * self.volume:g} litres"]
        said += [f"{count} {label if count == 1 else plurals(label)[label]}" for label, count in self.counts]
        said += [f"at least one {label}" for label in self.some]
        said += [f"{target} {word}" for target, word in (*self.colors, *self.materials)]
        said += [f"{part} {what} {value}" for part, what, value in self.features]
        said += [f"{_count(place)} {_AT[place.at]}" for place in self.places]
        lost = f"; not understood: {', '.join(map(suggest, self.ignored))}" if self.ignored else ""
        return f"understood: {', '.join(said)}{lost}"


def _count(place: Placing) -> str:
    noun = place.label if place.count == 1 else plurals(place.label)[place.label]
    said = (str(place.count or ""), "glazed" if place.pane else "", noun)
    return " ".join(filter(None, said))


def _span(low: float, high: float) -> str:
    if low and high < math.inf:
        return f"{low:g} to {high:g} m"
    return f"at least {low:g} m" if low else f"at most {high:g} m"


_AT: Mapping[Spot, str] = {
    "top": "at the top", "bottom": "at the bottom", "left": "on the left", "right": "on the right",
    "sides": "on both sides", "middle": "in the middle",
}  # fmt: skip
_WORDS: Mapping[Axis, str] = {"width": "wide", "depth": "deep", "height": "high"}
