"""Paths that must not leave a folder."""

import os
from pathlib import Path

from artigen.errors import SourceError


def inside(root: Path, base: Path, name: str, owner: str) -> Path:
    """``base / name`` if it stays below ``root``; ``owner`` names the referring file in the error.

    Raises:
        SourceError: If the path is absolute or leaves ``root`` (links included).
    """
    if not lies_inside(root, base, name):
        raise SourceError(f"{owner}: names file {name!r}, which lies outside {root}")
    return base / name


def lies_inside(root: Path, base: Path, name: str) -> bool:
    """Whether ``name`` is relative and ``base / name`` lies below ``root``, links followed."""
    end = os.path.realpath(base / name)
    return not Path(name).is_absolute() and end.startswith(os.path.realpath(root) + os.sep)
