"""`plain_words`: words of a sentence, with corrections made and some phrases in plainer words."""

from dataclasses import dataclass

from artigen.conditioning.colors import measure_finish
from artigen.conditioning.measures import COMPARATIVES, DIRECTIONS, UNITS, Axis
from artigen.conditioning.numbers import read_count, read_length, split_words
from artigen.conditioning.places import starts_spot
from artigen.conditioning.vocabulary import COMPARTMENTS, CORRECTIONS, PARTS
from artigen.kind import plurals


@dataclass(frozen=True, kw_only=True)
class Value:
    """A number, length or finish: its first word, the first one after it, and that after what it is of."""

    start: int
    stop: int
    end: int
    of: str | None
    """What it is of: a label, an axis, "finish"; None for a number alone."""


def plain_words(text: str) -> tuple[str, ...]:
    """Words of a sentence as clauses are read from them."""
    return _name_shelves(_name_columns(_spell_out(_correct(_spell_letters(split_words(text))))))


def _spell_letters(words: tuple[str, ...]) -> tuple[str, ...]:
    """Words with "120 L x 60 W x 75 H" as width, depth and height; "40 L" is a volume."""
    ends = (("", *words), (*words[1:], ""))
    beside = {
        at: letter
        for at, (before, letter, after) in enumerate(zip(ends[0], words, ends[1], strict=False))
        if letter in ("l", "w", "d", "h") and (before in UNITS or after[:1].isdigit() or after in ("x", "by"))
    }
    if "l" not in beside.values() or len(beside) == 1:
        return words
    named = {"l": "w", "w": "w" if "d" in beside.values() else "d"}
    return tuple(named.get(word, word) if at in beside else word for at, word in enumerate(words))


def _correct(words: tuple[str, ...]) -> tuple[str, ...]:
    """Words with "five drawers, no, make it four" as "four drawers": what such a phrase is followed by
    replaces the last value of the same thing before it."""
    for at in range(len(words)):
        start = next((at + len(one) for one in CORRECTIONS if words[at : at + len(one)] == one), at)
        ends = [place for place in range(start, len(words)) if words[place] == ","]
        places = range(start, ends[0] if ends else len(words)) if start > at else ()
        new = next((value for place in places if (value := _read_value(words, place)) is not None), None)
        if new is None:
            continue
        old = [value for place in range(at) if (value := _read_value(words, place)) is not None]
        same = [value for value in old if value.of == new.of or (new.of is None and value.of in PARTS)]
        if same:
            kept = (*words[: same[-1].start], *words[new.start : new.stop], *words[same[-1].stop : at])
            return _correct((*kept, *words[new.end :]))
    return words


def _read_value(words: tuple[str, ...], at: int) -> Value | None:
    """The value that begins at a word; an article counts nothing here."""
    length, count, finish = read_length(words, at), read_count(words, at), measure_finish(words, at)
    if length is not None:
        stop = at + length.words
        axis = DIRECTIONS.get(words[stop]) if stop < len(words) else None
        return Value(start=at, stop=stop, end=stop + (axis is not None), of=axis or "width")
    if finish:
        return Value(start=at, stop=at + finish, end=at + finish, of="finish")
    if count is None or words[at] in ("a", "an", "no"):
        return None
    stop = at + count[1]
    part = PARTS.get(words[stop]) if stop < len(words) else None
    return Value(start=at, stop=stop, end=stop + (part is not None), of=part)


def _spell_out(words: tuple[str, ...]) -> tuple[str, ...]:
    """Words with "taller than a metre" as "more than a metre tall", "not taller than" as "no more than", and
    "not handles" as "no handles"."""
    spelled = list(words)
    for at in range(len(words) - 2, -1, -1):  # from the end, so that places before stay
        word, after = words[at : at + 2]
        if word == "not" and (after in PARTS or after in ("more", "less", "fewer")):
            spelled[at] = "no"
        length = read_length(words, at + 2) if word in COMPARATIVES and after == "than" else None
        if length is not None:
            spelled[at], direction = COMPARATIVES[word]
            spelled.insert(at + 2 + length.words, direction)
            start = at - (words[at - 1 : at] == ("be",))
            if words[start - 1 : start] in (("not",), ("nothing",), ("no",)):
                spelled[start - 1 : at] = ["no"]
    return tuple(spelled)


def _name_columns(words: tuple[str, ...]) -> tuple[str, ...]:
    """Words with "two drawers wide and three high" as "two columns of three drawers"."""
    for at in range(len(words)):
        first = _read_across(words, at)
        after = (
            0 if first is None else first[3] + (words[first[3] : first[3] + 1] in ((",",), ("and",), ("by",)))
        )
        second = None if first is None else _read_across(words, after)
        if first is None or second is None or {first[2], second[2]} != {"width", "height"}:
            continue
        wide, high = (first, second) if first[2] == "width" else (second, first)
        part = first[1] or second[1]
        if part:
            return (*words[:at], *wide[0], "columns", "of", *high[0], *part, *words[second[3] :])
    return words


def _read_across(
    words: tuple[str, ...], at: int
) -> tuple[tuple[str, ...], tuple[str, ...], Axis, int] | None:
    """A number, its part if that is named, and the axis along which there are so many, and the next word."""
    count = read_count(words, at)
    stop = at if count is None else at + count[1]
    end = stop + (stop < len(words) and words[stop] in PARTS)
    axis = DIRECTIONS.get(words[end]) if end < len(words) else None
    return None if count is None or axis is None else (words[at:stop], words[stop:end], axis, end + 1)


def _name_shelves(words: tuple[str, ...]) -> tuple[str, ...]:
    """Words with "open compartment" and the like as the open shelf that they are."""
    nouns = dict.fromkeys(COMPARTMENTS, "shelf") | dict.fromkeys(plurals(*COMPARTMENTS).values(), "shelves")
    named = list(words)
    for at, word in enumerate(words):
        if at and words[at - 1] == "open":
            named[at] = nouns.get(word, word)
        elif word == "open" and at and words[at - 1] in (",", "with", "and") and starts_spot(words, at + 1):
            named[at] = "shelf"  # "open in the middle"
    return tuple(named)
