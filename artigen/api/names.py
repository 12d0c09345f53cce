"""Names of packages: given ones, and those made of kind, words and seed."""

import hashlib
import re
from pathlib import Path

from artigen.errors import ArtigenError

LONGEST = 60
"""Longest part of a name that is made of words; of longer sentences a hash stands for the rest."""
ARTICLES = {"a", "an", "the"}
VALID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")


def name_request(category: str | None, text: str | None, image: Path | None, seed: int) -> str:
    """Name of a generated package: its kind, its words or else its photo, and the seed.

    Requests with other words have other names: ``Oven_3``, ``white_fridge_with_black_handles_0``.
    """
    said = text if text or image is None else image.stem
    words = re.findall(r"[a-z0-9]+", (said or "").lower())
    slug = "_".join(word for word in words if word not in ARTICLES)
    if len(slug) > LONGEST:
        code = hashlib.sha256(slug.encode()).hexdigest()[:6]
        slug = f"{slug[:LONGEST].rpartition('_')[0] or slug[:LONGEST]}_{code}"
    return (
        "_".join(part for part in (category, slug, str(seed)) if part)
        if category or slug
        else f"object_{seed}"
    )


def choose_name(given: str | None, seed: int, count: int) -> str | None:
    """Name of one of ``count`` packages for the option ``--name``: with its seed if there are several.

    Raises:
        ArtigenError: If the name cannot be that of a folder.
    """
    if given is None:
        return None
    if not VALID.fullmatch(given):
        raise ArtigenError(
            f"name {given!r}: expected letters, digits, '_', '-' and '.', beginning with a letter or digit, "
            "such as white_fridge"
        )
    return given if count == 1 else f"{given}_{seed}"
