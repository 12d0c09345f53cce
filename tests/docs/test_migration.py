import importlib
import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs/how-to/migrate.md"
ROWS = re.findall(r"^\| (`.*) \| (`.*) \|$", PAGE.read_text().split("## Python")[1], re.MULTILINE)


def _exists(name: str) -> bool:
    """Whether a dotted name is a module, or an attribute of one."""
    words = name.split(".")
    for length in range(len(words), 0, -1):
        try:
            found = importlib.import_module(".".join(words[:length]))
        except ModuleNotFoundError:
            continue
        for word in words[length:]:
            if not hasattr(found, word):
                return False
            found = getattr(found, word)
        return True
    return False


@pytest.mark.parametrize(("before", "now"), ROWS)
def test_names_before_are_gone_and_names_now_are_there(before: str, now: str):
    pattern = r"`((?:artigen|envs|sim_export)\.[\w.]+)`"
    gone, there = re.findall(pattern, before), re.findall(pattern, now)
    assert there
    assert all(_exists(name) for name in there)
    assert not any(_exists(name) for name in gone)
