"""Laws of the commands: thin, all there, and light while they only hand out work."""

import subprocess
import sys

import pytest
from project import ROOT
from test_architecture import HEAVY

from artigen.cli.main import COMMANDS, load_command

MOST_LINES = 80
"""Lines of a command: arguments in, one call, text out."""
LATE = (*HEAVY, "scipy", "PIL", "matplotlib", "pandas", "sklearn", "lxml", "coal", "manifold3d")
"""Modules that the process which only hands out work does not need."""


@pytest.mark.parametrize("command", ["convert", "shape", "generate"])
def test_a_command_that_hands_out_work_loads_only_itself(command: str):
    code = (
        "import sys\n"
        "from artigen.cli.main import COMMANDS, load_command\n"
        f"load_command({command!r})\n"
        "import envs.config, envs.validate\n"
        f"print(*({set(LATE)!r} & set(sys.modules)))\n"
        "print(*(name for name in COMMANDS.values() if f'artigen.cli.{name}' in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    heavy, commands = done.stdout.split("\n")[:2]
    assert heavy.split() == []
    assert commands.split() == [command]


def test_every_subcommand_is_there():
    assert all(callable(load_command(name)) for name in COMMANDS)


@pytest.mark.parametrize("path", sorted((ROOT / "artigen" / "cli").glob("*.py")), ids=lambda path: path.stem)
def test_a_command_is_thin(path):
    assert len(path.read_text().splitlines()) < MOST_LINES
