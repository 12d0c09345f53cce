"""Description of a data set as a whole."""

from dataclasses import dataclass

from artigen.datasets.duplicates import Duplicate


@dataclass(frozen=True, kw_only=True)
class Failure:
    """An object that was drawn and left out of the data set."""

    id: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class About:
    """Name and origin of a data set, and the objects left out."""

    name: str
    title: str
    description: str
    license: str
    creator: str
    url: str
    date: str
    """Date of publication; nothing else in a data set depends on the time of its making."""
    generator: str
    recipes: tuple[tuple[str, str], ...]
    """File name and text of each."""
    digest: str
    """Digest of the recipe; an existing data set with the same digest is not made again."""
    duplicates: tuple[Duplicate, ...] = ()
    failures: tuple[Failure, ...] = ()
    near: float = 0.0
