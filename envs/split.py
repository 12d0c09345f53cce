"""Divides objects into those to learn from and unseen ones."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from artigen.brief import Brief
from artigen.errors import ArtigenError
from sim_export.files.folders import find_packages, name_folders


@dataclass(frozen=True, kw_only=True, repr=False)
class Split(Brief):
    """Packages to train on, and others that are not seen in training."""

    train: tuple[Path, ...]
    unseen: tuple[Path, ...]


def split_objects(packages: str | Path | Sequence[str | Path], unseen: float = 0.2, seed: int = 0) -> Split:
    """Divides packages by object; the same names and seed give the same halves in any order and place.

    Args:
        packages: A folder of packages, one package, or a list of either.
        unseen: Share of the objects to hold out.
        seed: Another seed holds out other objects.

    Raises:
        ArtigenError: If one of the two would be empty.
    """
    folders = find_packages(packages)
    count = round(unseen * len(folders))
    if not 0 < count < len(folders):
        raise ArtigenError(
            f"{unseen} of {len(folders)} objects is {count}: expected one to hold out and one to keep"
        )
    named = dict(zip(folders, name_folders(folders), strict=True))
    mixed = sorted(folders, key=lambda folder: hashlib.sha256(f"{seed} {named[folder]}".encode()).digest())
    held = set(mixed[:count])
    return Split(
        train=tuple(folder for folder in folders if folder not in held),
        unseen=tuple(folder for folder in folders if folder in held),
    )
