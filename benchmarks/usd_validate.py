"""Counts USD assets that NVIDIA's SimReady validator accepts, and their missing features.

Usage: python benchmarks/usd_validate.py FOLDER [--profile Robotics-Prop] [--version 4.0.0]
FOLDER is what `artigen usd -o` wrote. The validator has its own USD: it is installed in an environment of
its own (pip install simready-validate simready-foundation-tier-core) and found by SIMREADY_VALIDATE or PATH.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path


def find_validator() -> str:
    """The executable; exits with a sentence where there is none."""
    found = os.environ.get("SIMREADY_VALIDATE") or shutil.which("simready-validate")
    if found is None:
        sys.exit("no simready-validate on PATH or in SIMREADY_VALIDATE; see the head of this file")
    return found


def validate(assets: list[Path], profile: str, version: str) -> str:
    """The validator's report over all assets."""
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as listed:
        listed.write("".join(f"{asset.resolve()}\n" for asset in assets))
        listed.flush()
        command = [find_validator(), "--profile", profile, "--version", version, "-v"]
        command += ["--asset_list", listed.name]
        return subprocess.run(command, capture_output=True, text=True, check=False).stdout


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--profile", default="Robotics-Prop")
    parser.add_argument("--version", default="4.0.0")
    args = parser.parse_args()
    assets = sorted(args.folder.glob("*/usd/*.usd"))
    if not assets:
        sys.exit(f"{args.folder}: no asset in it (looked for */usd/*.usd); write some with `artigen usd`")
    report = validate(assets, args.profile, args.version)
    verdicts = re.findall(r"^Asset: .*?(\w+)/usd/\S+\n\s+\[(\w+)\]", report, re.MULTILINE)
    passed = sum(verdict == "PASSED" for _, verdict in verdicts)
    print(f"| {args.profile} {args.version} | {passed} of {len(assets)} pass |\n|---|---|")
    for name, verdict in verdicts:
        if verdict != "PASSED":
            print(f"| {name} | {verdict} |")
    lacks = re.findall(r"(\w+): optional feature, unmet requirements: (\[.*?\])", report)
    for (feature, requirements), count in sorted(Counter(lacks).items()):
        print(f"| optional {feature} lacks {requirements} | {count} |")
    sys.exit(0 if passed == len(assets) else 1)


if __name__ == "__main__":
    main()
