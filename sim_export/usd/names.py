"""Valid names for USD and SimReady: prim identifiers, and lower-case file names."""

import re
from collections.abc import Collection, Iterable

from sim_export.errors import PackageError


def prim_names(names: Iterable[str], taken: Iterable[str] = ()) -> tuple[str, ...]:
    """A unique identifier for each name: letters, digits and ``_``, none in ``taken``.

    Unique names that are already identifiers are kept.
    """
    used = set(taken)
    found = []
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", name) or "_"
        plain = f"_{plain}" if plain[0].isdigit() else plain
        unique, count = plain, 1
        while unique in used:
            count += 1
            unique = f"{plain}_{count}"
        used.add(unique)
        found.append(unique)
    return tuple(found)


def free_name(name: str, used: Collection[str]) -> str:
    """The name, or the first of ``name_2``, ``name_3`` ..., whose asset name is not in ``used``."""
    tried, count = name, 1
    while asset_name(tried) in used:
        count += 1
        tried = f"{name}_{count}"
    return tried


def asset_name(name: str) -> str:
    """The lower-case name of an asset's folder and file.

    Raises:
        PackageError: If the name has no letter or digit.
    """
    plain = re.sub(r"[^a-z0-9_]+", "_", name.lower()).strip("_")
    if not plain:
        raise PackageError(
            f"package {name!r}: no letter or digit to name a USD file after; give the package another name"
        )
    return plain
