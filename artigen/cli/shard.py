"""Independent parts of a run: ``--shard 3/64``."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from artigen.errors import ArtigenError

Item = TypeVar("Item")


@dataclass(frozen=True, kw_only=True)
class Part:
    """The ``number``-th of ``total`` parts, counted from 1."""

    number: int
    total: int


def read_shard(text: str | None) -> Part | None:
    """The part that ``3/64`` names; None for the whole.

    Raises:
        ArtigenError: If the text is not of that form, or there is no such part.
    """
    if text is None:
        return None
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    part = Part(number=int(found[1]), total=int(found[2])) if found else None
    if part is None or not 1 <= part.number <= part.total:
        raise ArtigenError(f"shard {text!r}: expected K/N with K from 1 to N, such as 3/64")
    return part


def take_part(items: Sequence[Item], part: Part | None) -> Sequence[Item]:
    """Every ``total``-th item; the parts have no item in common and together are the whole."""
    return items if part is None else items[part.number - 1 :: part.total]


def name_part(path: Path, part: Part | None) -> Path:
    """The file of a part beside the file of the whole: ``run.jsonl`` becomes ``run.03-of-64.jsonl``."""
    if part is None:
        return path
    width = len(str(part.total))
    return path.with_name(f"{path.stem}.{part.number:0{width}d}-of-{part.total}{path.suffix}")
