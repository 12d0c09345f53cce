"""The example extension, as an installed distribution without an installation."""

import tomllib
from pathlib import Path

import pytest
from project import ROOT

EXTENSION = ROOT / "examples" / "extension"


def install_extension(
    monkeypatch: pytest.MonkeyPatch, scratch: Path, changed: dict[str, dict[str, str]] | None = None
) -> None:
    """Puts the extension and a description of its distribution on the path until the test ends.

    Args:
        changed: Entry points by group, instead of those of its ``pyproject.toml``.
    """
    project = tomllib.loads((EXTENSION / "pyproject.toml").read_text())["project"]
    info = scratch / "installed" / "artigen_card_index-0.1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.4\nName: {project['name']}\nVersion: 0.1.0\n")
    lines = []
    for group, entries in (changed or project["entry-points"]).items():
        lines += [f"[{group}]", *(f"{name} = {value}" for name, value in entries.items())]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    monkeypatch.syspath_prepend(str(EXTENSION))
    monkeypatch.syspath_prepend(str(info.parent))
