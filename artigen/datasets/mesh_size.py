"""Limits of the size of mesh files."""

import re
from pathlib import Path
from typing import TYPE_CHECKING

from artigen.errors import SourceError

if TYPE_CHECKING:
    pass

MOST_FACES = 500_000
"""Most triangles of one mesh file; more are a scan, of which no simulator makes use."""
LEAST_FACE_BYTES = 6
"""Least bytes that a text file needs for a polygon."""
MOST_BYTES = 400_000_000
"""No mesh file with so few triangles is larger."""
FACES = {
    ".obj": re.compile(rb"^f ", re.M),
    ".dae": re.compile(rb"<(?:triangles|polylist|polygons)\b[^>]*?\bcount\s*=\s*\"(\d{1,12})\""),
}
"""What counts the polygons of a text file: a line each, or attributes."""


def check_size(path: Path, faces: int) -> None:
    """Refuses a mesh that is too large to be converted.

    Raises:
        SourceError: If it holds more than `MOST_FACES` triangles.
    """
    if faces > MOST_FACES:
        raise SourceError(
            f"{path}: holds {faces:,} triangles, at most {MOST_FACES:,} are kept: simplify it, in Blender by "
            "the modifier Decimate"
        )


def check_file(path: Path) -> None:
    """Refuses a text file with too many polygons before it is parsed, and any file that is too large.

    Raises:
        SourceError: As `check_size`.
    """
    size = path.stat().st_size if path.is_file() else 0
    if size > MOST_BYTES:
        raise SourceError(f"{path}: holds {size:,} bytes, at most {MOST_BYTES:,} are read: simplify the mesh")
    pattern = FACES.get(path.suffix.lower())
    if pattern is not None and size > LEAST_FACE_BYTES * MOST_FACES:
        found = pattern.findall(path.read_bytes())
        check_size(path, sum(int(count) for count in found) if pattern.groups else len(found))
