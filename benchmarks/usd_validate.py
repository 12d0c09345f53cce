"""The public SimReady validator over folders that `artigen usd` wrote.

    python benchmarks/usd_validate.py FOLDER --validator /path/to/simready-validate

The validator lives in an environment of its own (simready-validate, simready-foundation-tier-core). A file
passes if no feature that the profile requires fails.
"""

import json
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

import tyro


def main(folder: tyro.conf.Positional[Path], validator: Path, profile: str = "Robotics-Prop") -> None:
    """Prints how many files pass, and what the others fail.

    Args:
        folder: as `artigen usd` wrote it.
        validator: the program.
        profile: whose newest version is asked for.
    """
    files = sorted(folder.rglob("*.usda"))
    if not files:
        raise SystemExit(f"{folder}: no .usda below it; write some with artigen usd")
    with tempfile.TemporaryDirectory() as scratch:
        listed, result = Path(scratch) / "files.txt", Path(scratch) / "result.json"
        listed.write_text("".join(f"{file.resolve()}\n" for file in files))
        command = [validator, "--asset_list", listed, "--profile", profile, "--output", result]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if not result.is_file():
            raise SystemExit(f"{validator} wrote no result: {done.stderr[-500:]}")
        failed: Counter[str] = Counter()
        good = 0
        for features in read_features(json.loads(result.read_text())):
            wrong = {name for name, said in features.items() if said.get("blocking_failure")}
            failed.update(wrong)
            good += not wrong
    print(f"{profile}: {good} of {len(files)} pass")
    for name, count in failed.most_common():
        print(f"{name}: {count}")


def read_features(value: object) -> list[dict[str, dict]]:
    """The summaries of features in a result, one for every file, however deep they lie."""
    if isinstance(value, dict):
        if any(isinstance(said, dict) and "blocking_failure" in said for said in value.values()):
            return [value]
        return [found for inner in value.values() for found in read_features(inner)]
    if isinstance(value, list):
        return [found for inner in value for found in read_features(inner)]
    return []


if __name__ == "__main__":
    tyro.cli(main)
