"""`Parse`: words of a sentence, which of them are read, and what they say so far."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from artigen.conditioning.measures import AXES, Axis
from artigen.conditioning.numbers import Length, read_length
from artigen.conditioning.sentence import Sentence, TextError
from artigen.conditioning.vocabulary import FILLERS, Feature
from artigen.kind import Kind, kinds
from artigen.types import PartLabel

BETWEEN = 3
"""Largest number of words between a number or an adjective and its part: "three wide white oak drawers"."""


@dataclass(frozen=True, kw_only=True)
class Parse:
    """Words of a sentence, those that are read, and what they say so far."""

    words: tuple[str, ...]
    used: frozenset[int] = frozenset()
    lost: frozenset[int] = frozenset()
    """Words that are read and not understood."""
    whole: bool = True
    """Whether the sentence must name a kind."""
    head: range = range(0)
    """Words of the noun that names the kind."""
    product: tuple[float, ...] = ()
    """Lengths (m) of "60 x 55 x 85 cm"."""
    found: Sentence = field(default_factory=Sentence)

    def take(self, at: int, count: int = 1) -> "Parse":
        """The parse with words marked as read."""
        return replace(self, used=self.used | set(range(at, at + count)))

    def lose(self, at: int, count: int) -> "Parse":
        """The parse with words marked as not understood, which nothing else reads."""
        return replace(self.take(at, count), lost=self.lost | set(range(at, at + count)))

    def say(self, **said: object) -> "Parse":
        """The parse with more content."""
        return replace(self, found=replace(self.found, **said))


def kind_of(parse: Parse) -> Kind | None:
    return None if parse.found.kind is None else kinds()[parse.found.kind]


def say_length(parse: Parse, axis: Axis, length: float) -> Parse:
    known = dict(parse.found.size)
    if abs(known.get(axis, length) - length) > 1e-9:
        raise TextError(f"{axis} is {known[axis]:g} m and {length:g} m; give it once")
    if length <= 0:
        raise TextError(f"{axis} is {length:g} m, expected more than 0")
    sizes = {**known, axis: length}
    return parse.say(size=tuple((axis, sizes[axis]) for axis in AXES if axis in sizes))


def say_range(parse: Parse, axis: Axis, length: Length) -> Parse:
    """Says a length, or the range in which it is."""
    if length.low == length.high:
        return say_length(parse, axis, length.low)
    known = {name: ends for name, *ends in parse.found.ranges}
    low, high = known.get(axis, (0.0, math.inf))
    low, high = max(low, length.low), min(high, length.high)
    if low > high:
        raise TextError(f"{axis} is at least {low:g} m and at most {high:g} m; give a range")
    known[axis] = [low, high]
    return parse.say(ranges=tuple((axis, *known[axis]) for axis in AXES if axis in known))


def say_count(parse: Parse, label: PartLabel, count: int) -> Parse:
    known = dict(parse.found.counts)
    if known.get(label, count) != count:
        raise TextError(f"{known[label]} and {count} parts called {label} are asked for; give one number")
    return parse.say(counts=tuple(sorted({**known, label: count}.items())))


def say_features(parse: Parse, features: Sequence[Feature]) -> Parse:
    return parse.say(features=tuple(dict.fromkeys((*parse.found.features, *features))))


def list_ignored(parse: Parse) -> tuple[str, ...]:
    """Words that say something which is not understood; neighbours form a phrase with a number and a unit."""
    lost: list[str] = []
    at, words = 0, parse.words
    while at < len(words):
        read = at in parse.used and at not in parse.lost
        length = None if read else read_length(words, at)
        if length is not None and words[at] not in FILLERS:
            lost.append(" ".join(words[at : at + length.words]))
            at += length.words
            continue
        known = read or words[at] in FILLERS or words[at] == ","
        lost += [] if known else [words[at]]
        at += 1
    return tuple(lost)
