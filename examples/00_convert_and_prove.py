"""From any URDF to a proven package, in code.

You will see the object, what was noted on the way, and the verdict of the checks.
"""

import tempfile
from pathlib import Path

import artigen


def main(folder: Path) -> None:
    """Converts the URDF of a drawn cabinet inside ``folder``."""
    drawn = artigen.sample("StorageFurniture", counts={"drawer": 1, "door": 1}).export(folder / "cabinet")
    converted = artigen.convert(folder / "cabinet" / "mobility.urdf", kind=drawn.kind)
    print(drawn, converted, sep="\n")
    for note in converted.notes:
        print(f"   noted: {note}")
    report = converted.export(folder / "converted").report
    assert report is not None
    for check in report.checks:
        print(f"{check.id} {check.verdict:>14}  {check.message}")
    assert report.passed, [check.message for check in report.failures]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
