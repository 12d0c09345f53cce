"""`artigen demo`: procedural and generated objects, exported, validated and rendered."""

import sys
from pathlib import Path
from typing import Literal

from artigen.api.batch import Finished, run_batch
from artigen.cli.arguments import Out, Workers
from artigen.runtime.runner import choose_runner
from artigen.weights import SHIPPED

OBJECTS = (("cabinet", 3), ("oven", 2), ("fridge", 1), ("table", 4))
"""Noun and seed of the procedural objects."""
GENERATED = (("cabinet", 20), ("oven", 20))
"""Noun and seed of the generated objects."""


def demo(out: Out = Path("out/demo"), workers: Workers = None) -> int:
    """Sample four objects, export them exactly and from voxels, generate two with the model, validate all.

    Args:
        out: Output folder for packages, reports and pictures.
    """
    from artigen.api.generate import GenerateJob, generate_and_validate
    from artigen.api.sample import ShapeJob, ShapeSettings, export_and_validate, write_sheet
    from artigen.shapes.draw import draw_shape
    from sim_export.picture.preview import write_preview

    runner = choose_runner("local", workers)
    objects = _find_kinds(OBJECTS)
    shapes = [draw_shape(category, seed) for category, seed in objects]
    write_sheet(shapes, out / "shapes.png")
    ways: tuple[Literal["reference", "voxels"], ...] = ("reference", "voxels")
    good = True
    for way in ways:
        cfg = ShapeSettings(source=way)
        jobs = [ShapeJob(category=category, seed=seed, out=out / way, cfg=cfg) for category, seed in objects]
        results = run_batch(export_and_validate, jobs, out / way, runner=runner, on_done=_say)
        good &= all(finished.good for finished in results)
        write_preview(tuple(out / way / shape.name for shape in shapes), out / f"{way}.png")
    drawn = [
        GenerateJob(model=SHIPPED, category=category, seed=seed, out=out / "generated")
        for category, seed in _find_kinds(GENERATED)
    ]
    results = run_batch(generate_and_validate, drawn, out / "generated", runner=runner, on_done=_say)
    if any(finished.error for finished in results):  # a failed check is only reported
        good = False
    else:
        write_preview(tuple(job.out / job.key for job in drawn), out / "generated.png")
    sys.stdout.write(
        f"\npackages   {out}/reference (exact)  {out}/voxels (rebuilt from 64^3 voxels)  {out}/generated\n"
        f"reports    validation.json in each package\n"
        f"pictures   {out}/shapes.png  {out}/reference.png  {out}/voxels.png  {out}/generated.png\n"
        f"view       artigen view {out}/reference/{shapes[0].name}\n"
    )
    return 0 if good else 1


def _find_kinds(named: tuple[tuple[str, int], ...]) -> list[tuple[str, int]]:
    """The kinds that nouns name, with their seeds."""
    from artigen.kind import find_noun

    return [(kind.name, seed) for noun, seed in named if (kind := find_noun(noun)) is not None]


def _say(finished: Finished) -> None:
    verdict = finished.error or "; ".join(finished.failures) or "passed every check"
    sys.stdout.write(f"{finished.key}: {verdict}\n")
