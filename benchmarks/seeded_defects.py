"""Seeds defects into sound packages and reports which checks catch them.

Breaks a package that passes everything in one way at a time and prints a Markdown table:
``python benchmarks/seeded_defects.py [--out table.md]``. Ends with 1 if any defect goes unnoticed.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from defects import Defect, seed_defect
from sample_packages import write_samples
from static_defects import STATIC_DEFECTS

from sim_export.checks.suite import run_checks
from sim_export.report import CheckResult


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What the checks said about one defect."""

    defect: Defect
    meant: CheckResult
    others: tuple[str, ...]

    @property
    def caught(self) -> bool:
        """Whether the check meant for the defect failed."""
        return self.meant.verdict == "fail"


def try_defect(defect: Defect, good: dict[str, Path], folder: Path) -> Outcome:
    """Seeds one defect and runs all static checks."""
    results = run_checks(seed_defect(defect, good[defect.base], folder))
    meant = next(result for result in results if result.id == defect.check)
    others = tuple(r.id for r in results if r.verdict == "fail" and r.id != defect.check)
    return Outcome(defect=defect, meant=meant, others=others)


def table(outcomes: Sequence[Outcome]) -> str:
    """Markdown, one row per defect."""
    rows = ["| defect | check | caught | what it says | others that fail |", "|---|---|---|---|---|"]
    for outcome in outcomes:
        said = outcome.meant.message.replace("|", "/")
        caught = "yes" if outcome.caught else "**NO**"
        others = ", ".join(outcome.others)
        rows.append(f"| {outcome.defect.name} | {outcome.defect.check} | {caught} | {said} | {others} |")
    count = sum(outcome.caught for outcome in outcomes)
    return "\n".join(rows) + f"\n\n{count} of {len(outcomes)} defects caught by the check meant for them.\n"


def main() -> int:
    """Prints the table; 0 if every defect is caught and the good packages pass."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="also write the table to this file")
    out: Path | None = parser.parse_args().out
    with tempfile.TemporaryDirectory() as scratch:
        good = write_samples(Path(scratch) / "good")
        for name, folder in good.items():
            for result in run_checks(folder):
                if result.verdict == "fail":
                    print(f"{name}: {result.id} fails on the good package: {result.message}", file=sys.stderr)
                    return 1
        outcomes = []
        for index, defect in enumerate(STATIC_DEFECTS):
            outcomes.append(try_defect(defect, good, Path(scratch) / str(index)))
            if sys.stderr.isatty():
                print(f"\r{index + 1}/{len(STATIC_DEFECTS)}", end="", file=sys.stderr)
    text = table(outcomes)
    print(text)
    if out is not None:
        out.write_text(text)
    return 0 if all(outcome.caught for outcome in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
