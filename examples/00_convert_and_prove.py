"""From an object folder to a proven package, in code.

You will see the stages' timings, what was noted on the way, and the verdict of the checks.
"""

import tempfile
from pathlib import Path

from artigen.cli.convert import ConvertJob, convert_object
from artigen.datasets.sample_partnet import write_sample
from envs.validate import validate


def main(folder: Path) -> None:
    """Converts the embedded cabinet inside ``folder``."""
    source = folder / "source" / "sample_cabinet"
    write_sample(source)
    converted = convert_object(ConvertJob(source=source, out=folder / "packages"))
    for stage, seconds in converted.seconds:
        print(f"{stage:>12} {seconds:6.2f} s")
    for note in converted.notes:
        print(f"   noted: {note}")
    report = validate(folder / "packages" / "sample_cabinet")
    for check in report.checks:
        print(f"{check.id} {check.verdict:>14}  {check.message}")
    assert report.passed, [check.message for check in report.failures]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
