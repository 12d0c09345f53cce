"""What the pages name exists: options of commands, files, and what their blocks of Python import and call."""

import ast
import inspect
import re
from importlib import import_module

import pytest
from project import ROOT

BUILT = (".", "out", "dist", "build", "site")
"""Beginnings of folders of the project that hold what it made."""
FILES = {
    str(path.relative_to(ROOT))
    for top in ROOT.iterdir()
    if not top.name.startswith(BUILT)
    for path in (top.rglob("*") if top.is_dir() else [top])
    if path.is_file()
}
FOLDERS = {str(parent) for file in FILES for parent in (ROOT / file).relative_to(ROOT).parents}
PAGES = sorted(file for file in FILES if file.endswith(".md") and file != "CHANGELOG.md")
OWN = ("artigen", "envs", "sim_export")
OPTIONS = {
    section.split("\n", 1)[0]: {"-h", "--help", *re.findall(r"`(--?[a-z][\w-]*)`", section)}
    for section in (ROOT / "docs/reference/cli.md").read_text().split("\n## ")[1:]
}
"""Options of every command: the page is what the help texts say (`test_cli_reference.py`)."""


@pytest.mark.parametrize("page", PAGES)
def test_commands_have_the_options_that_a_page_gives_them(page: str):
    text = (ROOT / page).read_text()
    for command, rest in re.findall(rf"artigen ({'|'.join(OPTIONS)})\b([^`#\n|;]*)", text):
        given = set(re.findall(r"(?<=\s)(--[a-z][\w-]*|-[a-z](?=\s))", rest))
        assert given <= OPTIONS[command], f"artigen {command}{rest}"


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
