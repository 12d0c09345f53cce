"""Journals: one JSON object per line, appended as work completes, so that a killed run can resume."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def read_lines(path: Path) -> list[dict[str, Any]]:
    """Lines of a journal in order; none if there is no file.

    A line truncated by a killed run is skipped, so that its work is repeated.
    """
    out = []
    for text in path.read_text().splitlines() if path.is_file() else []:
        try:
            out.append(json.loads(text))
        except json.JSONDecodeError:
            continue
    return out


def append_line(path: Path, line: Mapping[str, object]) -> None:
    """Appends a line to a journal; a truncated line before it is terminated first."""
    with path.open("a+b") as file:
        whole = file.seek(0, os.SEEK_END) == 0
        if not whole:
            file.seek(-1, os.SEEK_END)
            whole = file.read(1) == b"\n"
        file.write((b"" if whole else b"\n") + json.dumps(dict(line)).encode() + b"\n")
