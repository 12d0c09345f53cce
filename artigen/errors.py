"""Errors a caller may want to handle; each message says what was found, where, and what is allowed."""

import difflib
from collections.abc import Iterable


def list_some(names: Iterable[str], most: int = 12) -> str:
    """The first of some names, and how many there are more."""
    names = list(names)
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def name_options(found: str, allowed: Iterable[str], spelt: Iterable[str] = ()) -> str:
    """What is allowed, and the most similar of it (or of its other spellings) as a question, if one is."""
    allowed = list(allowed)
    words = {word.lower(): word for word in (*spelt, *allowed)}
    near = difflib.get_close_matches(found.lower(), words, 1)
    return f"one of {', '.join(allowed)}" + (f" (did you mean {words[near[0]]}?)" if near else "")


class ArtigenError(Exception):
    """Base of every error this project raises on purpose."""


def explain(error: Exception) -> str:
    """What an error says, without the number and the file that an `OSError` repeats."""
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


def check_option(what: str, found: object, allowed: Iterable[str]) -> None:
    """Refuses a word that is none of those allowed.

    Raises:
        ArtigenError: If it is none of them.
    """
    allowed = list(allowed)
    if found not in allowed:
        raise ArtigenError(f"{what} {found!r}: expected {name_options(str(found), allowed)}")


class SourceError(ArtigenError):
    """An input object cannot be read: names the file, the element and the value."""


class SegmentationError(ArtigenError):
    """A voxel field does not describe an articulated object."""
