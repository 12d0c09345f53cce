"""Journals: a JSON object per line, appended as work is done, so that a killed run can go on."""

import json
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
