"""Reads the parts of a sentence one after the other: lengths, the kind, features, style, counts, colours."""

from dataclasses import dataclass, replace

from artigen.conditioning.adjectives import read_adjectives
from artigen.conditioning.colors import is_compound, read_finishes
from artigen.conditioning.counts import read_counts, read_objects
from artigen.conditioning.measures import SCALES
from artigen.conditioning.nouns import find_head
from artigen.conditioning.numbers import read_number
from artigen.conditioning.paints import MATERIALS, PAINTS, PANES, SHADES
from artigen.conditioning.parse import Parse, kind_of, list_ignored, say_count, say_features
from artigen.conditioning.proportions import read_proportions
from artigen.conditioning.sentence import OBJECT, Sentence, TextError
from artigen.conditioning.sizes import order_product, read_bare_sizes, read_sizes, read_volume
from artigen.conditioning.vocabulary import (
    APART,
    BARE,
    EXCLUSIVE,
    FEATURES,
    GLAZED,
    LEGS,
    LEVEL,
    PARTS,
    PIECES,
    ROOMS,
    STACKED,
    STYLES,
    Feature,
    count_longest,
)
from artigen.conditioning.wording import plain_words
from artigen.kind import EVERY, NONE, find_noun
from artigen.types import PartLabel

LONGEST = count_longest(FEATURES)
"""Words of the longest phrase of features."""
FEATURES_OF = {style: feature for feature, style in STYLES.items()}
"""Features that are styles of some kinds, by those."""
NEXT = frozenset({",", "but", "and", "with"})
"""Words before which a denial ends."""


@dataclass(frozen=True, kw_only=True)
class StyleMention:
    """Words that say a style: the first of them, and how many they are."""

    at: int
    count: int
    style: str
    """One of the kind's, or `EVERY`."""
    clearness: int
    """2 for a word of its own, 1 for one of the noun, 0 for one that may be a size, a material or a pane."""


def read_clauses(text: str, *, whole: bool = True) -> Sentence:
    """Everything that a sentence says, without a check of sizes; if it is not ``whole``, a door is a part.

    Raises:
        TextError: If it names two kinds, or gives a number, length, style or colour twice.
    """
    parse = Parse(words=plain_words(text), whole=whole)
    for read in (_lose_negated, read_sizes, read_volume, _read_kind, order_product, _read_style,
                 _read_features, read_counts, _place_panes, read_objects, read_bare_sizes, read_proportions,
                 _read_colors, read_adjectives, _read_parts, _agree):  # fmt: skip
        parse = read(parse)
    return replace(parse.found, ignored=list_ignored(parse))


def _lose_negated(parse: Parse) -> Parse:
    """What "not" denies, to the end of its clause, is not understood: "not white", "not too big"."""
    for at, word in enumerate(parse.words):
        if word == "not":
            ends = (end for end in range(at, len(parse.words)) if parse.words[end] in NEXT)
            parse = parse.lose(at, next(ends, len(parse.words)) - at)
    return parse


def _read_kind(parse: Parse) -> Parse:
    head = find_head(parse.words, parse.used, whole=parse.whole)
    if head is None:
        return parse
    spelled = " ".join(parse.words[head.at : head.at + head.count])
    singular = {many: one for one, many in head.kind.nouns.items()}
    noun, start = singular.get(spelled, spelled), head.at
    for count in range(start, 0, -1):
        before = " ".join(parse.words[start - count : start])
        if find_noun(before) is head.kind and noun not in head.kind.forms:  # "a pantry cupboard"
            noun, start = before, start - count
            break
    end = head.at + head.count
    return replace(parse.take(start, end - start), head=range(start, end)).say(kind=head.kind.name, noun=noun)


def _read_style(parse: Parse) -> Parse:
    """Reads the style of the kind: its name, or another word for it, that says it most clearly.

    Raises:
        TextError: If two words say two styles equally clearly, or one says what no object of the kind is.
    """
    mentions = _find_styles(parse)
    for mention in mentions:
        if mention.style == EVERY:
            parse = parse.take(mention.at, mention.count)
    styles = [mention for mention in mentions if mention.style != EVERY]
    if not styles:
        return parse
    chosen = max(styles, key=lambda mention: mention.clearness)  # the first of equal ones
    for mention in styles:
        if mention.style == chosen.style:
            parse = parse if mention.clearness < chosen.clearness else parse.take(mention.at, mention.count)
            continue
        feature = GLAZED if parse.words[mention.at] in PANES else FEATURES_OF.get(mention.style)
        if feature is not None:  # "a double door of glass", "mirrored sliding doors"
            parse = say_features(parse.take(mention.at, mention.count), (feature,))
        elif mention.clearness == chosen.clearness:
            raise TextError(f"styles {chosen.style} and {mention.style} are asked for; name one")
    return parse.say(style=chosen.style)


def _find_styles(parse: Parse) -> list[StyleMention]:
    """Styles of the kind by words, from the first on; colours are never styles.

    Raises:
        TextError: If a word says what no object of the kind is.
    """
    words, kind = parse.words, kind_of(parse)
    if kind is None:
        return []
    named = {style.replace("_", " "): style for style in kind.styles} | dict(kind.style_words)
    named = {word: style for word, style in named.items() if word not in PAINTS and word != "steel"}
    found: list[StyleMention] = []
    for at in range(len(words)):
        for count in range(min(3, len(words) - at), 0, -1):
            phrase = " ".join(words[at : at + count])
            style, inside = named.get(phrase), at in parse.head and at + count - 1 in parse.head
            shades = words[at] in SHADES and words[at + 1 : at + 2] != () and words[at + 1] in PAINTS
            if style is None or (at in parse.used and not inside) or shades:
                continue
            if style == NONE:
                noun = next(iter(kind.nouns))
                raise TextError(f"{phrase!r}: no {noun} ({kind.name}) of ours is that; leave it out")
            weak = any(words[at] in others for others in (SCALES, PANES, MATERIALS, ROOMS))
            clearness = 1 if inside else 0 if weak else 2
            found.append(StyleMention(at=at, count=count, style=style, clearness=clearness))
            break
    return found


def _read_features(parse: Parse) -> Parse:
    """Reads phrases such as "bottom freezer" and "hinged on the left"; some are styles of the kind."""
    words, kind = parse.words, kind_of(parse)
    for at in range(len(words)):
        for count in range(min(LONGEST, len(words) - at), 0, -1):
            feature = FEATURES.get(" ".join(words[at : at + count]))
            if feature is None or set(range(at, at + count)) <= parse.used:
                continue
            if feature in (LEVEL, STACKED) and _is_of_others(parse, at, at + count, feature):
                continue
            parse = parse.take(at, count)
            near = [
                PARTS[words[place]]
                for place in (at - 1, at + count)
                if words[place : place + 1] and words[place] in PARTS
            ]
            before = [PARTS[word] for word in words[:at] if word in PARTS]
            label = near[0] if at and near else before[-1] if feature == STACKED and before else "door"
            if feature == STACKED:
                feature = (label, "columns", "1")
            elif feature == LEVEL and label != "door":  # "two drawers side by side"
                feature = (label, "rows", "1")
            parse = say_features(parse, (feature,))
            style = STYLES.get(feature)
            if kind is not None and style in kind.styles and parse.found.style is None:
                parse = parse.say(style=style)
            break
    return parse


def _is_of_others(parse: Parse, at: int, end: int, feature: Feature) -> bool:
    """Whether "side by side" or "stacked" is of objects, or of some parts: "the top two side by side"."""
    number = read_number(parse.words, at - 1) if at else None
    return (
        (number is not None and number[0] != 1)
        or at - 1 in parse.head
        or (feature == STACKED and (end in parse.head or read_number(parse.words, end) is not None))
    )


def _place_panes(parse: Parse) -> Parse:
    """Keeps panes to the doors of a place where others have none: "two glass doors over two solid doors"."""
    found, counted = parse.found, dict(parse.found.counts).get("door", 0)
    glazed = [place for place in found.places if place.pane]
    pairs = zip(parse.words, parse.words[1:], strict=False)
    solid = [at for at, pair in enumerate(pairs) if pair in (("solid", "door"), ("solid", "doors"))]
    mixed = bool(solid) or counted > sum(place.count or counted for place in glazed)
    if not glazed or not mixed:
        return parse.say(places=tuple(replace(place, pane=False) for place in found.places))
    for at in solid:
        parse = parse.take(at)
    style = None if found.style == STYLES[GLAZED] else found.style
    return parse.say(style=style, features=tuple(one for one in found.features if one != GLAZED))


def _read_colors(parse: Parse) -> Parse:
    colors, materials, used = read_finishes(parse.words, parse.used, parse.head)
    kind, glazed = kind_of(parse), STYLES[GLAZED]
    if kind is not None and dict(materials).get(OBJECT) == "glass" and glazed in kind.styles:
        others = dict(pair for pair in materials if pair[0] != OBJECT)
        materials = tuple(sorted(others.items()))
        if "leg" in kind.colored:  # a glass table has a glass top, a glass cabinet glass doors
            materials = tuple(sorted({"top": "glass", **others}.items()))
        else:
            parse = say_features(parse, (GLAZED,)).say(style=parse.found.style or glazed)
    return replace(parse, used=used).say(colors=colors, materials=materials)


def _read_parts(parse: Parse) -> Parse:
    """Parts that are named, coloured or described without a number."""
    counted = dict(parse.found.counts)
    labels: set[PartLabel] = {PARTS[part] for part, *_ in parse.found.features if part in PARTS}
    labels |= {
        PARTS[target] for target, _ in (*parse.found.colors, *parse.found.materials) if target in PARTS
    }
    for at, word in enumerate(parse.words):
        if word in PARTS and at not in parse.head and not is_compound(parse.words, at):
            opened = at > 0 and parse.words[at - 1] == "open" and PARTS[word] == "shelf"
            parse = parse.take(at - 1, 2) if opened else parse.take(at)
            labels.add(PARTS[word])
        elif PIECES.get(word) in dict((*parse.found.colors, *parse.found.materials)):
            parse = parse.take(at)
        if word in LEGS and at not in parse.head:
            parse = _say_legs(parse, at)
    bare = BARE in parse.found.features
    some = tuple(
        sorted(label for label in labels if label not in counted and not (bare and label == "handle"))
    )
    if bare and "handle" not in counted:
        parse = say_count(parse, "handle", 0)
    return parse.say(some=some)


def _say_legs(parse: Parse, at: int) -> Parse:
    """Legs or feet that are named, four if they are counted: the object stands on legs."""
    places = (place for place in (at - 1, at - 2) if place >= 0 and place not in parse.used)
    number = next((place for place in places if read_number(parse.words, place) == (4.0, 1)), None)
    parse = parse.take(at) if number is None else parse.take(at).take(number)
    if any(part == "stand" for part, *_ in parse.found.features):
        return parse
    return say_features(parse, (("stand", "type", "legs"),))


def _agree(parse: Parse) -> Parse:
    """Joins hinges that are said of the left and of the right doors; other properties have one value.

    Raises:
        TextError: If hinges, a stand or a freezer are said to be two things.
    """
    said: dict[tuple[str, str], list[str]] = {}
    for part, what, value in parse.found.features:
        said.setdefault((part, what), []).append(value)
    doors = {place.at for place in parse.found.places if place.label == "door"}
    if set(said.get(APART[:2], ())) == doors == {"left", "right"}:
        others = (one for one in parse.found.features if one[:2] != APART[:2])
        places = tuple(place for place in parse.found.places if place.label != "door")
        return say_features(parse.say(features=tuple(others), places=places), (APART,))
    for (part, what), values in said.items():
        if len(values) > 1 and (part, what) in EXCLUSIVE:
            raise TextError(f"{part} {what} {' and '.join(values)} are asked for; name one")
    return parse
