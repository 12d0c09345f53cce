"""Runs every example in a process of its own; fails if one does."""

import subprocess
import sys
from pathlib import Path


def main() -> int:
    """Exit code: how many failed."""
    failed = 0
    for example in sorted(Path(__file__).parent.glob("[0-9]*.py")):
        done = subprocess.run([sys.executable, example], capture_output=True, text=True, check=False)
        print(f"{'ok    ' if done.returncode == 0 else 'FAILED'} {example.name}")
        if done.returncode != 0:
            print(done.stdout, done.stderr, sep="\n")
            failed += 1
    return failed


if __name__ == "__main__":
    sys.exit(main())
