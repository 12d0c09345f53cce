"""Errors a caller may want to handle; each message says what was found, where, and what is allowed."""

from collections.abc import Iterable


def list_some(names: Iterable[str], most: int = 12) -> str:
    """The first of some names, and how many there are more."""
    names = list(names)
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


class ArtigenError(Exception):
    """Base of every error this project raises on purpose."""


class SourceError(ArtigenError):
    """An input object cannot be read: names the file, the element and the value."""


class SegmentationError(ArtigenError):
    """A voxel field does not describe an articulated object."""
