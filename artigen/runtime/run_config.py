"""Ties a folder to the settings it was started with; others are refused."""

import json
from collections.abc import Mapping
from pathlib import Path

from artigen.errors import SourceError
from artigen.io import write_whole

Setting = str | int | float | bool | None


def claim_folder(path: Path, settings: Mapping[str, Setting]) -> None:
    """Writes the settings of a new folder, or compares them with those it has.

    Args:
        path: File for the settings; its folder is made.
        settings: What may not change from one start to the next.

    Raises:
        SourceError: If the folder was started with other settings or cannot be written; says which.
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
                "ask for the same, or take another folder"
            )
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, json.dumps(dict(settings), indent=1, sort_keys=True) + "\n")
    except OSError as error:
        raise SourceError(f"{path.parent}: cannot be written ({error.strerror})") from error
