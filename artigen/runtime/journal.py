"""Journals (a JSON object per line) and stored settings, from which a killed run resumes."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from artigen.errors import SourceError
from artigen.io import write_whole


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


Setting = str | int | float | bool | None


def claim_folder(path: Path, settings: Mapping[str, Setting]) -> None:
    """Writes the settings of a new folder, or compares them with the stored ones.

    Args:
        path: File for the settings; its folder is created.
        settings: Settings that may not change from one start to the next.

    Raises:
        SourceError: If the folder was started with other settings (lists them) or cannot be written.
    """
    if path.is_file():
        try:
            known = json.loads(path.read_text())
        except json.JSONDecodeError as error:
            raise SourceError(f"{path}: is no JSON ({error})") from error
        if not isinstance(known, dict):
            raise SourceError(f"{path}: expected the settings of an earlier start")
        changed = [
            f"{name} {known.get(name)!r} (now {settings.get(name)!r})"
            for name in sorted({*known, *settings})
            if known.get(name) != settings.get(name)
        ]
        if changed:
            raise SourceError(
                f"{path.parent}: was started with {', '.join(changed)}; "
                "use the same settings, or another folder"
            )
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, json.dumps(dict(settings), indent=1, sort_keys=True) + "\n")
    except OSError as error:
        raise SourceError(f"{path.parent}: cannot be written ({error.strerror})") from error
