"""Runs packages in every installed engine: passed checks, and the accuracy of joint friction.

    python benchmarks/engines.py FOLDER... --engines mujoco,pybullet --engine-python pybullet=/path/to/python

Prints a line for every failed check and two tables: packages that pass each check, and the effort at which
joints give way as a part of their friction. ``--as-loaded`` leaves out what the runners restore after
loading, which shows what each engine makes of the file alone; ``--warp`` steps Newton by its own kernels.
"""

import argparse
import json
import sys
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np

from envs.engines.choose import choose_engines
from envs.engines.judge import judge
from envs.engines.plan import make_plan
from envs.engines.witness import FILES, WITNESSES, run_engine
from envs.titles import ENGINE_TITLES
from sim_export.files.read import read_package


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("packages", nargs="+", type=Path)
    parser.add_argument("--engines", default=",".join(WITNESSES))
    parser.add_argument("--engine-python", nargs="*", default=())
    parser.add_argument("--as-loaded", action="store_true")
    parser.add_argument("--bisect", action="store_true")
    parser.add_argument("--warp", action="store_true")
    parser.add_argument("--answers", type=Path, help="folder for what each engine answered")
    args = parser.parse_args()
    extra = {"as_loaded": args.as_loaded, "bisect": args.bisect, "warp": args.warp}
    passed: dict[str, Counter[str]] = defaultdict(Counter)
    holds: dict[str, list[float]] = defaultdict(list)
    for folder in args.packages:
        plan = make_plan(folder, read_package(folder, appearance=False))
        for engine in choose_engines(args.engines, tuple(args.engine_python)):
            if not (folder / FILES[WITNESSES[engine.name].file]).is_file():
                continue
            answer = run_engine(plan, engine, 600.0, extra)
            if args.answers is not None:
                args.answers.mkdir(parents=True, exist_ok=True)
                (args.answers / f"{folder.name}-{engine.name}.json").write_text(json.dumps(answer))
            if "rest" not in answer:
                print(f"{folder.name} {engine.name}: {answer}")
                passed[engine.name]["no answer"] += 1
                continue
            holds[engine.name] += answer.get("holds", {}).values()
            for check in judge(engine.name, plan, answer):
                passed[engine.name][check.id[:4]] += check.verdict != "fail"
                if check.verdict == "fail":
                    print(f"{folder.name} {check.id} {check.title}: {check.message} ({check.value:g})")
        sys.stdout.flush()
    print(f"\n{len(args.packages)} packages", *ENGINE_TITLES.values(), "no answer", sep=" | ")
    for engine, counts in passed.items():
        print(engine, *(counts[check] for check in ENGINE_TITLES), counts["no answer"], sep=" | ")
    for engine, values in holds.items():
        if values:
            off = np.abs(np.array(values) - 1.0)
            print(
                f"{engine}: {len(values)} joints give way at {min(values):.3f} to {max(values):.3f} times "
                f"their friction, median error {100 * np.median(off):.2g} %, {(off <= 0.05).sum()} within 5 %"
            )


if __name__ == "__main__":
    main()
