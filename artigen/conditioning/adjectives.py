"""Reads "tall", "large" and "round" where they describe the whole object."""

from artigen.conditioning.colors import is_noun
from artigen.conditioning.measures import ADJECTIVES, AXES, SCALES
from artigen.conditioning.parse import BETWEEN, Parse, say_features
from artigen.conditioning.places import starts_spot
from artigen.conditioning.sentence import TextError
from artigen.conditioning.vocabulary import FILLERS, GLOSSES, LEGS, OUTLINES, PARTS, PIECES

COPULAS = frozenset({"is", "are", "be", "should", "must", "very", "quite"})
"""Words between a noun and an adjective after it."""


def read_adjectives(parse: Parse) -> Parse:
    """Reads "tall" and the like where they describe the whole object."""
    parse = _read_gloss(parse)
    for at, word in enumerate(parse.words):
        counted = at > 0 and parse.words[at - 1][0].isdigit()
        compared = at > 0 and parse.words[at - 1] in ("than", "as")
        if word not in ADJECTIVES or at in parse.used or counted or compared or _describes_part(parse, at):
            continue
        axis, factor = ADJECTIVES[word]
        known = dict(parse.found.stretch)
        if known.get(axis, factor) != factor:
            raise TextError(f"{word!r} contradicts an earlier word about the {axis}")
        parse = parse.take(at).say(stretch=tuple(sorted({**known, axis: factor}.items())))
    for at, word in enumerate(parse.words):
        if word in SCALES and at not in parse.used and not _describes_part(parse, at):
            stretch = {**dict.fromkeys(AXES, SCALES[word]), **dict(parse.found.stretch)}
            parse = parse.take(at).say(stretch=tuple(sorted(stretch.items())))
        elif word in OUTLINES and at not in parse.used and not _describes_part(parse, at):
            parse = say_features(parse.take(at), (OUTLINES[word],))
    return parse


def _read_gloss(parse: Parse) -> Parse:
    """Reads "matte" and "high gloss", except of a part: "matte handles"."""
    for at in range(len(parse.words)):
        for count in (2, 1):
            gloss = GLOSSES.get(" ".join(parse.words[at : at + count]))
            if gloss is not None and at not in parse.used and not _describes_part(parse, at + count - 1):
                parse = say_features(parse.take(at, count), (gloss,))
                break
    return parse


def _describes_part(parse: Parse, at: int) -> bool:
    """Whether an adjective is of a part, or of what is not known: "an oval seat", "a window big", and
    "for a small flat I need a fridge"."""
    words = parse.words
    noun = next((place for place in range(at - 1, -1, -1) if words[place] not in COPULAS), 0)
    ends = words[at + 1 : at + 2] in ((), (",",), ("and",)) or noun < at - 1 or words[at] == "high"
    if ends and noun not in parse.head:
        return words[noun] in {*PARTS, *PIECES, *LEGS} or is_noun(words, noun)
    nouns = [place for place in range(at + 1, parse.head.start) if is_noun(words, place)]
    if nouns and {*words[nouns[0] + 1 : parse.head.start]} & FILLERS:
        return True
    if at > parse.head.start and is_noun(parse.words, at + 1):
        return True
    for place in range(at + 1, min(at + 2 + BETWEEN, len(parse.words))):
        if place in parse.head or parse.words[place] in (",", "with", "without"):
            return False
        if parse.words[place] in {*PARTS, *PIECES, *LEGS} or starts_spot(parse.words, place):
            return True
    return False
