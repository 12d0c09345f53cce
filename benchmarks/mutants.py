"""Changes thresholds one at a time and lists the changes that the tests of their modules miss.

    python benchmarks/mutants.py --packages sim_export/collision sim_export/checks -o out/mutants.json

A threshold is a number that a module gives a name in capitals, or the default of a dataclass field. A changed
one is 1.5 times as large, or two thirds; a whole number is one more or one less. The tests are those of the
module's own folder, `test_thresholds.py` first, and those that import the module, or else a module that does.
The result is written after every mutant, and the same command goes on with it.
"""

import argparse
import ast
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from artigen.io import write_whole

ROOT = Path(__file__).resolve().parents[1]
COPIED = ("artigen", "sim_export", "envs", "benchmarks", "tests", "docs", "examples")
SOURCES = ("artigen", "sim_export", "envs")
TIMEOUT = 600.0
"""Seconds after which the tests of a mutant are stopped; it does not count as killed."""


@dataclass(frozen=True, kw_only=True)
class Threshold:
    """A named number in a source file."""

    path: str
    name: str
    line: int
    start: int
    end: int
    value: float

    @property
    def key(self) -> str:
        """Names it over all files."""
        return f"{self.path}:{self.name}"


def find_thresholds(root: Path, packages: list[str]) -> list[Threshold]:
    """All thresholds of some folders and files, in the order of their files and lines."""
    return [
        one
        for package in packages
        for path in (sorted((root / package).rglob("*.py")) or [root / package])
        for one in read_thresholds(path.read_text(), path.relative_to(root).as_posix())
    ]


def read_thresholds(source: str, path: str) -> list[Threshold]:
    """Those of one file: names in capitals, and numbers that fields of classes begin with."""
    tree = ast.parse(source)
    found = []
    for owner in [tree, *(node for node in tree.body if isinstance(node, ast.ClassDef))]:
        for node in owner.body:
            if isinstance(node, ast.Assign) and len(node.targets) == 1:
                target, value = node.targets[0], node.value
            elif isinstance(node, ast.AnnAssign) and node.value is not None:
                target, value = node.target, node.value
            else:
                continue
            if not isinstance(target, ast.Name) or not isinstance(value, ast.Constant):
                continue
            number = value.value
            if (
                isinstance(number, bool)
                or not isinstance(number, int | float)
                or (owner is tree and not target.id.isupper())
            ):
                continue
            name = target.id if owner is tree else f"{owner.name}.{target.id}"
            found.append(
                Threshold(
                    path=path,
                    name=name,
                    line=value.lineno,
                    start=value.col_offset,
                    end=value.end_col_offset or value.col_offset,
                    value=number,
                )
            )
    return found


def change(source: str, threshold: Threshold, *, up: bool) -> str:
    """The source with another number in the threshold's place."""
    value = threshold.value
    if isinstance(value, int):
        new = repr(value + 1 if up or value == 0 else value - 1)
    else:
        new = repr(value * 1.5 if up else value / 1.5) if value else "0.1"
    lines = source.splitlines(keepends=True)
    line = lines[threshold.line - 1]
    lines[threshold.line - 1] = line[: threshold.start] + new + line[threshold.end :]
    return "".join(lines)


def find_tests(root: Path, path: str) -> list[str]:
    """Test files of a module's folder, and those that import it, or else a module that imports it."""
    tests = {test: _imports(test) for test in sorted((root / "tests").rglob("test_*.py"))}
    module = path.removesuffix(".py").replace("/", ".")

    def users(modules: set[str]) -> list[str]:
        return [test.relative_to(root).as_posix() for test, names in tests.items() if names & modules]

    found = users({module}) or users(
        {
            source.relative_to(root).with_suffix("").as_posix().replace("/", ".")
            for package in SOURCES
            for source in (root / package).rglob("*.py")
            if module in _imports(source)
        }
    )
    folder = root / "tests" / Path(path).parent
    own = [test.relative_to(root).as_posix() for test in sorted(folder.glob("test_*.py"))]
    return sorted({*own, *found}, key=lambda test: (test not in own, "thresholds" not in test, test))


def _imports(path: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    return names


def run_tests(folder: Path, tests: list[str]) -> str | None:
    """The first test that fails on the sources in a folder, or its file; None if none does in time."""
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-m", "not slow", *tests]
    environment = {
        **os.environ,
        "PYTHONPATH": str(folder),
        "PYTHONDONTWRITEBYTECODE": "1",
        "OMP_NUM_THREADS": "1",
    }
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, timeout=TIMEOUT, check=False, text=True
        )
    except subprocess.TimeoutExpired:
        return None
    if done.returncode == 0:
        return None
    named = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", done.stdout, re.MULTILINE)
    return named.group(1) if named else tests[0]


def main() -> None:
    """Runs the mutants of a sample, and prints which survived."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--packages", nargs="+", default=["sim_export", "envs", "artigen/sketch"])
    parser.add_argument("--sample", type=int, default=40, help="how many thresholds are changed")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "out" / "mutants.json")
    given = parser.parse_args()
    chance = random.Random(given.seed)
    thresholds = find_thresholds(ROOT, given.packages)
    chosen = chance.sample(thresholds, min(given.sample, len(thresholds)))
    ups = [chance.random() < 0.5 for _ in chosen]
    results: dict[str, str] = json.loads(given.out.read_text()) if given.out.is_file() else {}
    given.out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for name in COPIED:
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("pyproject.toml", "README.md", "CONVENTIONS.md"):
            shutil.copy(ROOT / name, folder)
        for number, (threshold, up) in enumerate(zip(chosen, ups, strict=True), start=1):
            key = f"{threshold.key} {'up' if up else 'down'}"
            if key not in results:
                path = folder / threshold.path
                source = path.read_text()
                tests = find_tests(folder, threshold.path)
                path.write_text(change(source, threshold, up=up))
                failed = run_tests(folder, tests) if tests else None
                path.write_text(source)
                if failed is not None and run_tests(folder, [failed]) is not None:
                    sys.exit(f"{failed} fails on unchanged sources: nothing can be learned from it")
                results[key] = "killed" if failed else "survived" if tests else "no tests"
                write_whole(given.out, json.dumps(results, indent=1))
            print(f"{number} of {len(chosen)}: {key} (was {threshold.value:g}): {results[key]}", flush=True)
    counted = [results[f"{one.key} {'up' if up else 'down'}"] for one, up in zip(chosen, ups, strict=True)]
    print(f"{counted.count('killed')} of {len(counted)} mutants were killed")


if __name__ == "__main__":
    main()
