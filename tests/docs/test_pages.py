"""What the pages name exists: options of commands, files, and what their blocks of Python import and call."""

import ast
import inspect
import re
import runpy
import subprocess
import warnings
from functools import cache
from importlib import import_module

import pytest
import tyro
from project import ROOT

REFERENCE = runpy.run_path(str(ROOT / "docs" / "cli_reference.py"))
COMMANDS, load_command = REFERENCE["COMMANDS"], REFERENCE["load_command"]
FILES = set(subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True).split())
FOLDERS = {
    parent for file in FILES for parent in (str(path) for path in (ROOT / file).relative_to(ROOT).parents)
}
PAGES = sorted(file for file in FILES if file.endswith(".md") and file != "CHANGELOG.md")
OWN = ("artigen", "envs", "sim_export")


@cache
def list_options(command: str) -> frozenset[str]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # tyro has no other list of options
        actions = tyro.extras.get_parser(load_command(command))._actions
    return frozenset(option for action in actions for option in action.option_strings)


@pytest.mark.parametrize("page", PAGES)
def test_commands_have_the_options_that_a_page_gives_them(page: str):
    text = (ROOT / page).read_text()
    for command, rest in re.findall(rf"artigen ({'|'.join(COMMANDS)})\b([^`#\n|;]*)", text):
        given = set(re.findall(r"(?<=\s)(--[a-z][\w-]*|-[a-z](?=\s))", rest))
        assert given <= list_options(command), f"artigen {command}{rest}"


@pytest.mark.parametrize("page", PAGES)
def test_files_of_the_tree_that_a_page_names_are_there(page: str):
    folders = "artigen|sim_export|envs|benchmarks|tests|docs|examples"
    for path in re.findall(rf"(?:`|python )((?:{folders})/[\w./-]*\w)", (ROOT / page).read_text()):
        assert path in FILES | FOLDERS, path


@pytest.mark.parametrize("page", PAGES)
def test_blocks_of_python_import_and_call_what_there_is(page: str):
    for block in re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL):
        if ">>>" in block:
            continue
        nodes = list(ast.walk(ast.parse(block)))
        known: dict[str, object] = {}
        for node in nodes:
            if isinstance(node, ast.ImportFrom) and str(node.module).split(".")[0] in OWN:
                module = import_module(str(node.module))
                known |= {each.asname or each.name: getattr(module, each.name) for each in node.names}
        for node in nodes:
            if not isinstance(node, ast.Call):
                continue
            if isinstance(node.func, ast.Attribute) and ast.unparse(node.func.value) == "artigen":
                called = getattr(import_module("artigen"), node.func.attr)
            else:
                called = known.get(ast.unparse(node.func))
            if inspect.isfunction(called) or inspect.isclass(called):
                inspect.signature(called).bind_partial(**{each.arg: 0 for each in node.keywords if each.arg})
