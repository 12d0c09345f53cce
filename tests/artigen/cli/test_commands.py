"""Laws of the commands: thin, all there, and light while they only hand out work."""

import re
import subprocess
import sys

import pytest
from project import ROOT
from test_architecture import HEAVY

import artigen
from artigen.cli.main import COMMANDS, load_command, main

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


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ("shape", "Frdge", "-o", "out"),
            "category 'Frdge' is not known, expected one of .*did you mean fridge",
        ),
        (("shape", "Oven", "-n", "-3", "-o", "out"), "-3 objects: expected at least one"),
        (("validate",), "expected the folder of a package"),
        (("validate", "nothing"), "nothing: no such folder"),
        (("preview", "nothing", "-o", "a.jpg"), "a.jpg: expected a file that ends with .png"),
        (("export", "nothing", "-o", "out"), "nothing: no such folder"),
        (("dataset", "verfy", "out"), "'verfy': expected one of verify, .*did you mean verify"),
        (("dataset", "no.yaml", "-o", "out"), r"no.yaml: cannot be read \(No such file or directory\)"),
        (("scene", "hall", "--image", "a.png", "-o", "out"), "hall of a photograph: expected a kitchen"),
    ],
)
def test_a_wrong_value_is_one_sentence_and_leaves_nothing(monkeypatch, tmp_path, capsys, words, said):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["artigen", *words])
    with pytest.raises(SystemExit, match="1"):
        main()
    (line,) = capsys.readouterr().err.splitlines()
    assert re.search(said, line)
    assert list(tmp_path.iterdir()) == []


def test_what_the_disk_refuses_is_one_sentence(monkeypatch, tmp_path, capsys):
    (tmp_path / "groups.json").mkdir()
    monkeypatch.setattr("artigen.cli.sets.group_packages", lambda *_: [])
    monkeypatch.setattr(
        sys, "argv", ["artigen", "sets", str(tmp_path), "--json-file", str(tmp_path / "groups.json")]
    )
    with pytest.raises(SystemExit, match="1"):
        main()
    assert capsys.readouterr().err == f"artigen: {tmp_path / 'groups.json'}: Is a directory\n"


def test_the_version_is_that_of_the_package(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["artigen", "--version"])
    with pytest.raises(SystemExit, match="0"):
        main()
    assert capsys.readouterr().out == f"artigen {artigen.__version__}\n"


def test_the_list_of_commands_has_one_sentence_for_each(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["artigen", "--help"])
    with pytest.raises(SystemExit, match="0"):
        main()
    said = capsys.readouterr().out
    assert all(f"• {name} " in said for name in COMMANDS)
    assert "again" not in said
