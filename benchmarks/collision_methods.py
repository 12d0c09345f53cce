"""Compares who makes the collision hulls: our search, CoACD and V-HACD at their defaults.

    python benchmarks/collision_methods.py OBJECT ... --methods auto coacd --budget 30

Each object is a file or folder that `artigen convert` reads. Per method: hulls; the largest and the 99 %
distance between collision and visual in percent of the diagonal (V103); seconds of one core for hulls,
clearance and checks; and the checks of collision that fail. Prints a markdown table.
"""

import re
from pathlib import Path
from tempfile import TemporaryDirectory

import tyro

from artigen.api.convert import ConvertJob, ConvertSettings, export_source, plan_hulls, voxelize_object
from artigen.errors import ArtigenError
from artigen.runtime.budget import Budget, core_seconds
from sim_export.checks.draft import read_draft
from sim_export.checks.suite import run_checks
from sim_export.search import COLLISION_CHECKS, Collision


def try_method(source: Path, method: Collision, budget: float, coacd: str) -> str:
    """What one method makes of an object, as a cell of a table."""
    cfg = ConvertSettings(collision=method, coacd=coacd if method == "coacd" else "", mend=True)
    with TemporaryDirectory() as scratch:
        found = ConvertJob(source=source, out=Path(scratch), cfg=cfg).read(Path(scratch))
        asset, begin = voxelize_object(found.asset), core_seconds()
        try:
            package = export_source(found, asset, {}, budget=Budget(budget), first=plan_hulls(cfg)).package
        except ArtigenError as err:
            return f"{core_seconds() - begin:.0f} s: {err}"
        spent = core_seconds() - begin
        checks = run_checks(read_draft(package), only=COLLISION_CHECKS)
    said = next(check.message for check in checks if check.id == "V103")
    far = re.findall(r"([0-9.e-]+) % of the diagonal|less than ([0-9.e-]+) %", said)
    failed = ", ".join(check.id for check in checks if check.verdict == "fail") or "pass"
    hulls = sum(len(link.hulls) for link in package.links)
    return f"{hulls}; {far[0][0]}, {far[1][1]}; {spent:.1f} s; {failed}"


def main(
    objects: tyro.conf.Positional[tuple[Path, ...]],
    methods: tuple[Collision, ...] = ("auto", "coacd", "vhacd"),
    budget: float = 30.0,
    coacd: str = "",
) -> None:
    """Prints the table, one line per object as it is done."""
    print("| object | " + " | ".join(methods) + " |\n|---" + "|---" * len(methods) + "|")
    for source in objects:
        cells = (try_method(source, method, budget, coacd) for method in methods)
        print(f"| {source.stem} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    tyro.cli(main)
