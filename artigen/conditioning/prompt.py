"""Writes the sentence of an object with a category and part counts; `read_sentence` is the inverse."""

from collections.abc import Mapping

from artigen.conditioning.measures import NUMBERS
from artigen.conditioning.vocabulary import PART_NOUNS
from artigen.kind import kinds
from artigen.types import PartLabel


def write_text(category: str, counts: Mapping[PartLabel, int]) -> str:
    """A sentence with a category and part counts; the inverse of `read_sentence`.

    Args:
        category: A kind.
        counts: Parts by label; the base and labels with a count of 0 are not named.
    """
    names = {label: noun for noun, label in reversed(PART_NOUNS.items())}
    numbers = {number: word for word, number in reversed(NUMBERS.items()) if number > 1}
    parts = []
    for label, count in counts.items():
        if count < 1 or label not in names:
            continue
        noun = "shelves" if count > 1 and label == "shelf" else names[label] + "s" * (count > 1)
        parts.append(f"{numbers.get(count, count) if count > 1 else 'one'} {noun}")
    noun = next(iter(kinds()[category].nouns))
    whole = f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"
    if not parts:
        return whole
    *first, last = parts
    return f"{whole} with {', '.join(first)}{' and ' if first else ''}{last}"
