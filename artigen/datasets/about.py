"""Description of a data set besides its objects."""

from dataclasses import dataclass

from artigen.datasets.duplicates import Duplicate


@dataclass(frozen=True, kw_only=True)
class Failure:
    """An object that was drawn and is not in the data set."""

    id: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class About:
    """Its name and origin, and what was left out."""

    name: str
    title: str
    description: str
    license: str
    creator: str
    url: str
    date: str
    """Of publication; nothing else in a data set depends on when it was made."""
    generator: str
    recipes: tuple[tuple[str, str], ...]
    """File name and text of each."""
    digest: str
    """Of the recipe; a data set of the same is not made again."""
    duplicates: tuple[Duplicate, ...] = ()
    failures: tuple[Failure, ...] = ()
    near: float = 0.0
