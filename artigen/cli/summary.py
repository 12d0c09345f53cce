"""What a run over many objects says at its end."""

import sys
from collections.abc import Sequence
from pathlib import Path

from artigen.api.batch import Finished


def print_summary(results: Sequence[Finished], out: Path) -> int:
    """Prints how many packages were written, passed and were not checked; returns the exit code."""
    passed = sum(finished.passed is True for finished in results)
    checked = sum(finished.passed is not None for finished in results)
    lost = sum(finished.error is not None for finished in results)
    made = len(results) - lost
    said = [f"{len(results)} object{'s' * (len(results) != 1)}: {made} package{'s' * (made != 1)} in {out}"]
    said += [f"{passed} of them passed every check"] if checked else []
    said += [f"{made - checked} of them not checked"] if made > checked else []
    said += [f"{lost} not made"] if lost else []
    sys.stdout.write(", ".join(said) + "\n")
    return 0 if all(finished.good for finished in results) else 1
