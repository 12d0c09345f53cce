"""Journals: one JSON object per line, appended as work is done, so that a killed run can resume."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def read_lines(path: Path) -> list[dict[str, Any]]:
    """The lines of a journal, first to last; none where there is no file.

    A line cut short by a killed run is left out, so that what it stood for is done again.
    """
    out = []
    for text in path.read_text().splitlines() if path.is_file() else []:
        try:
            out.append(json.loads(text))
        except json.JSONDecodeError:
            continue
    return out


def append_line(path: Path, line: Mapping[str, object]) -> None:
    """Adds a line to a journal; one that a killed run has cut short before it stays a line of its own."""
    with path.open("a+b") as file:
        whole = file.seek(0, os.SEEK_END) == 0
        if not whole:
            file.seek(-1, os.SEEK_END)
            whole = file.read(1) == b"\n"
        file.write((b"" if whole else b"\n") + json.dumps(dict(line)).encode() + b"\n")
