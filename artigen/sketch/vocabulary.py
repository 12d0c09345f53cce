"""The vocabulary of sketches by name, which keeps network weights valid when words are added.

Every symbol has a name, such as ``object.category=Table``, and so has every slot (``object.category``). A
model folder records its vocabulary; weights are matched to symbols and slots by name.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import torch
from torch import Tensor

from artigen.errors import ArtigenError
from artigen.shapes.surfaces.palette import ROLES
from artigen.sketch.rows import FIELDS, MATERIALS, ROW_KINDS
from artigen.sketch.words import CATEGORIES, STYLES
from artigen.types import JOINT_TYPES, PART_LABELS

Vocabulary = Mapping[str, Any]
WORDS = {
    "category": "categories",
    "style": "styles",
    "role": "roles",
    "finish": "roles",
    "lining": "roles",
    "material": "materials",
    "label": "labels",
    "type": "joints",
}
"""Lists of words that the symbols of a field stand for; symbols of other fields are numbered."""
BY_SYMBOL = ("symbols.weight", "biases.weight")
BY_SLOT = ("unknown.weight", "gates.weight", "slots.weight")
GUESSED = ("picture.weigh.2.weight", "picture.weigh.2.bias", "picture.guess_token.weight")
"""Weights whose last rows (last columns for the last one) belong to the categories."""


class VocabularyError(ArtigenError):
    """A vocabulary that lacks words or fields that a network has learned."""


def describe_vocabulary() -> dict[str, Any]:
    """The vocabulary of this version as JSON values: lists of words, and the rows.

    A row is its kind and its fields, such as ``part label:9 parent:63``: each field with its number of
    symbols, 0 for a number.
    """
    fields = {kind: [f"{field.name}:{field.size}" for field in FIELDS[kind]] for kind in ROW_KINDS}
    return {
        "categories": list(CATEGORIES),
        "styles": list(STYLES),
        "roles": list(ROLES),
        "materials": list(MATERIALS),
        "labels": list(PART_LABELS),
        "joints": list(JOINT_TYPES),
        "rows": [" ".join([kind, *named]) for kind, named in fields.items()],
    }


def name_slots(vocabulary: Vocabulary) -> list[str]:
    """Names of the slots, in the order of `artigen.sketch.slots.slots`."""
    return ["kind", *(f"{kind}.{name}" for kind, fields in _read_rows(vocabulary) for name, _ in fields)]


def name_symbols(vocabulary: Vocabulary) -> list[str]:
    """Names of the symbols, in the order of `artigen.sketch.slots.slots`."""
    rows = _read_rows(vocabulary)
    names = [f"kind={kind}" for kind, _ in rows]
    for kind, fields in rows:
        for name, size in fields:
            words = vocabulary[WORDS[name]] if name in WORDS else range(size)
            names += [f"{kind}.{name}={word}" for word in words] if size else []
    return names


def carry_weights(
    weights: Mapping[str, Tensor], before: Vocabulary, fresh: Mapping[str, Tensor]
) -> dict[str, Tensor]:
    """Transfers the weights of a trained network to the vocabulary of this version.

    Args:
        weights: Weights of the trained network, by name.
        before: Its vocabulary.
        fresh: Initial weights of a network of this version, kept for new words and fields. Symbols of new
            fields of known rows are set to zero, so that rows embed as before.

    Raises:
        VocabularyError: If a learned symbol or slot no longer exists; the message names it.
    """
    now = describe_vocabulary()
    tables = [
        *((name, name_symbols(before), name_symbols(now), 0) for name in BY_SYMBOL),
        *((name, name_slots(before), name_slots(now), 0) for name in BY_SLOT),
        *((name, before["categories"], now["categories"], int(name == GUESSED[-1])) for name in GUESSED),
    ]
    out = dict(weights)
    for name, old, new, axis in tables:
        if name in weights:
            out[name] = _carry(weights[name], old, fresh[name], new, axis)
    if BY_SYMBOL[0] in out:
        added = _list_added(before)
        out[BY_SYMBOL[0]][[index for index, name in enumerate(name_symbols(now)) if name in added]] = 0.0
    return out


def find_new_symbols(before: Vocabulary, categories: Sequence[str]) -> list[int]:
    """Indices of the symbols that a network has not learned: new words, and categories it never drew.

    The first symbol of a new field is excluded, because it means that the field does not apply.
    """
    known = set(name_symbols(before)) - {f"object.category={name}" for name in before["categories"]}
    known |= {f"object.category={name}" for name in categories}
    names = name_symbols(describe_vocabulary())
    known |= {name for name in _list_added(before) if name.endswith("=0")}
    return [index for index, name in enumerate(names) if name not in known]


def _list_added(before: Vocabulary) -> set[str]:
    """Symbols of new fields in rows that a vocabulary already has."""
    kinds = {kind for kind, _ in _read_rows(before)}
    slots = {slot for slot in name_slots(describe_vocabulary()) if slot.partition(".")[0] in kinds}
    slots -= set(name_slots(before))
    return {name for name in name_symbols(describe_vocabulary()) if name.partition("=")[0] in slots}


def _read_rows(vocabulary: Vocabulary) -> list[tuple[str, list[tuple[str, int]]]]:
    """Kind of every row, with names and sizes of its fields."""
    rows = []
    for row in vocabulary["rows"]:
        kind, *fields = row.split()
        pairs = [field.split(":") for field in fields]
        rows.append((kind, [(name, int(size)) for name, size in pairs]))
    return rows


def _carry(weight: Tensor, old: Sequence[str], fresh: Tensor, new: Sequence[str], axis: int) -> Tensor:
    """Moves entries to the positions of their names in the new vocabulary; entries before them stay in front.

    Weights of another width are returned unchanged; loading them reports the mismatch.
    """
    if lost := set(old) - set(new):
        raise VocabularyError(
            f"the network's vocabulary has {', '.join(sorted(lost))}, which this version lacks: words and "
            "fields can be added, not removed"
        )
    ahead = fresh.shape[axis] - len(new)
    if weight.shape != (*fresh.shape[:axis], ahead + len(old), *fresh.shape[axis + 1 :]):
        return weight
    where = torch.tensor([*range(ahead), *(ahead + new.index(name) for name in old)], device=weight.device)
    return fresh.to(weight).index_copy(axis, where, weight)
