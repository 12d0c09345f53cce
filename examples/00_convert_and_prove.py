"""From any URDF to a proven package, in code.

You will see the stages' timings, what was noted on the way, and the verdict of the checks.
"""

import tempfile
from pathlib import Path

from artigen.cli.convert import ConvertJob, ConvertSettings, convert_object
from artigen.shapes.draw import Wish, draw_shape
from envs.validate import validate
from sim_export.files.write import write_package
from sim_export.reference import build_reference


def main(folder: Path) -> None:
    """Converts the URDF of a drawn cabinet inside ``folder``."""
    wish = Wish(counts=(("drawer", 1), ("door", 1)))
    drawn = write_package(build_reference(draw_shape("StorageFurniture", 0, wish)), folder / "cabinet")
    settings = ConvertSettings(visual="source", category="StorageFurniture")
    job = ConvertJob(source=drawn / "mobility.urdf", out=folder / "packages", cfg=settings)
    converted = convert_object(job)
    for stage, seconds in converted.seconds:
        print(f"{stage:>12} {seconds:6.2f} s")
    for note in converted.notes:
        print(f"   noted: {note}")
    report = validate(folder / "packages" / job.key)
    for check in report.checks:
        print(f"{check.id} {check.verdict:>14}  {check.message}")
    assert report.passed, [check.message for check in report.failures]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
