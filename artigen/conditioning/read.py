"""`read_sentence`: a description in English to a `Sentence`, by rules, for every kind."""

from collections.abc import Mapping

from artigen.conditioning.clauses import read_clauses
from artigen.conditioning.measures import AXES, Axis
from artigen.conditioning.sentence import Sentence, TextError
from artigen.conditioning.suggest import suggest
from artigen.kind import Kind, kinds, list_words

SLACK = 1e-9
"""Rounding (m) of lengths that are given in other units."""


def read_sentence(text: str, *, whole: bool = True) -> Sentence:
    """Reads a sentence.

    Args:
        text: A description of one object in English, British or American.
        whole: Whether the sentence must name a kind; False where a category or a picture is given beside it.

    Raises:
        TextError: If no word is understood, no kind is named, two kinds are, a number or length is given
            twice, or no object of the kind has the size. The message says what was found and what to try.
    """
    found = read_clauses(text, whole=whole)
    if (whole and found.kind is None) or found == Sentence(ignored=found.ignored):
        lost = f"; {', '.join(map(suggest, found.ignored))} is not understood" if found.ignored else ""
        nouns = ", ".join(next(iter(kind.nouns)) for kind in map(kinds().__getitem__, list_words()))
        raise TextError(
            f"{text!r} names no kind of object that is known{lost}; expected one of {nouns}; for example "
            "'a cabinet with three drawers'"
        )
    if found.kind is not None:
        kind = kinds()[found.kind]
        spans = dict(zip(AXES, kind.sizes, strict=True))
        sizes = dict(found.size)
        sizes |= {axis: min(max(low, spans[axis][0]), high) for axis, low, high in found.ranges}
        check_size(kind, sizes)
    return found


def check_size(kind: Kind, size: Mapping[Axis, float]) -> None:
    """Refuses lengths (m) that no object of a kind has.

    Raises:
        TextError: If a length is outside `Kind.sizes`.
    """
    for axis, (low, high) in zip(AXES, kind.sizes, strict=True):
        length = size.get(axis)
        if length is not None and not low - SLACK <= length <= high + SLACK:
            noun = next(iter(kind.nouns))
            raise TextError(
                f"a {noun} ({kind.name}) with a {axis} of {length:g} m: expected {low:g} to {high:g} m; give "
                f"another {axis}, or leave it out"
            )
