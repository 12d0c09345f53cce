"""Share of pulls with proven grasps, and seconds of one core, over kinds of objects.

    python benchmarks/grasps.py --seeds 8100 8101 --out grasps.json

Prints one line per gripper: pulls with at least three grasps that both engines prove, of all pulls with a
handle; then each pull without, with the reason. Parts without a handle are counted apart.
"""

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import artigen
from artigen.api.grasps import ENGINES
from envs.grasps.prove import prove_grasps
from sim_export.files.write import write_package
from sim_export.grasps.find import ENOUGH, find_grasps
from sim_export.grasps.gripper import find_gripper


def measure(kind: str, seed: int, grippers: Sequence[str]) -> list[dict]:
    """One row per gripper, target and stroke of one object."""
    package = artigen.sample(kind, seed=seed).package
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        folder = write_package(package, Path(scratch) / package.name)
        for name in grippers:
            gripper, begin = find_gripper(name), time.process_time()
            found = find_grasps(package, gripper)
            middle = time.process_time()
            tried = prove_grasps(package, found, gripper, ENGINES, folder)
            end = time.process_time()
            for before, after in zip(found, tried, strict=True):
                rows.append(
                    {
                        "kind": kind,
                        "seed": seed,
                        "gripper": name,
                        "part": before.target.part,
                        "handle": before.target.region is not None,
                        "joint": "" if before.target.joint is None else before.target.joint.type,
                        "stroke": before.stroke,
                        "found": len(before.grasps),
                        "tried": len(after.grasps),
                        "proven": sum(grasp.proven for grasp in after.grasps),
                        "failed": [[(p.engine, round(p.opened, 2), p.held) for p in grasp.proofs]
                                   for grasp in after.grasps if not grasp.proven],
                        "reason": before.reason,
                        "find_seconds": middle - begin,
                        "prove_seconds": end - middle,
                    }
                )  # fmt: skip
    return rows


def summarize(rows: Sequence[dict]) -> list[str]:
    """Lines of the report. A pull counts by that one of its strokes that has the fewest proven grasps."""
    lines, pulls = [], {}
    for row in rows:
        pulls.setdefault((row["gripper"], row["kind"], row["seed"], row["part"]), []).append(row)
    for gripper in dict.fromkeys(row["gripper"] for row in rows):
        own = [row for row in rows if row["gripper"] == gripper]
        for handle, what in ((True, "pulls with a handle"), (False, "parts without")):
            some = [each for key, each in pulls.items() if key[0] == gripper and each[0]["handle"] == handle]
            least = [min(row["proven"] for row in each) for each in some]
            good = sum(count >= ENOUGH for count in least)
            again = sum(count >= ENOUGH and len(each) > 1 for count, each in zip(least, some, strict=True))
            any_ = sum(count > 0 for count in least)
            share = 100.0 * good / max(len(some), 1)
            lines.append(
                f"{gripper}: {good} of {len(some)} {what} ({share:.1f} %) have {ENOUGH} grasps that both "
                f"engines prove, {again} of them by grasping anew; {any_} have one"
            )
        objects = {(row["kind"], row["seed"]): row for row in own}
        for stage in ("find", "prove"):
            spent = sorted(row[f"{stage}_seconds"] for row in objects.values())
            lines.append(
                f"{gripper}: {stage} {sum(spent) / len(spent):.2f} s an object in the mean, "
                f"{spent[len(spent) // 2]:.2f} s in the median, {spent[-1]:.2f} s at most"
            )
    for row in rows:
        if row["handle"] and row["proven"] < ENOUGH:
            why = row["reason"] or f"{row['proven']} proven of {row['found']} found, {row['failed'][:3]}"
            begin, end = row["stroke"]
            lines.append(
                f"{row['gripper']} {row['kind']} {row['seed']} {row['part']} {begin:.2f} to {end:.2f}: {why}"
            )
    return lines


def main() -> None:
    """Measures kinds one after the other, and prints the report."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kinds", nargs="*", default=list(artigen.kinds()))
    parser.add_argument("--seeds", nargs="*", type=int, default=[8100, 8101])
    parser.add_argument("--grippers", nargs="*", default=["franka", "robotiq_2f85"])
    parser.add_argument("--out", type=Path, help="also write all rows as JSON")
    args = parser.parse_args()
    rows: list[dict] = []
    for kind in args.kinds:
        for seed in args.seeds:
            rows += measure(kind, seed, args.grippers)
            sys.stderr.write(f"{kind} {seed}\n")
            if args.out is not None:
                args.out.write_text(json.dumps(rows, indent=1) + "\n")
    sys.stdout.write("\n".join(summarize(rows)) + "\n")


if __name__ == "__main__":
    main()
