"""Compares MuJoCo batches of different objects of one topology with batches of equal ones.

    python benchmarks/topology_batch.py --category StorageFurniture --like 0 --count 64

`mujoco.rollout` steps many worlds in one call and takes a model for each, as long as all have the same sizes.
Both batches are run in turns in this process; the ratio of their medians is what counts.
"""

import tempfile
import time
from pathlib import Path

import numpy as np
import tyro

from artigen.shapes.draw import draw_shape, draw_variant
from sim_export.files.write import write_package
from sim_export.package import SimPackage
from sim_export.reference import build_reference, describe_build
from sim_export.topology import find_topology

SOME = 8
"""Objects of which a batch of equal ones is stepped; different ones are compared with the mean of these."""

# mujoco is a compiled module whose stubs name nothing.
# pyright: reportAttributeAccessIssue=false


def compile_model(package: SimPackage, scratch: Path):
    """The package's MJCF as a model."""
    import mujoco

    folder = write_package(package, scratch / "package", "replace")
    return mujoco.MjModel.from_xml_path(str(folder / "mobility.mjcf.xml"))


def step_worlds(models: list, steps: int, threads: int) -> float:
    """World steps per second, all joints pushed open and pulled shut."""
    import mujoco
    from mujoco import rollout

    data = [mujoco.MjData(models[0]) for _ in range(threads)]
    start = np.zeros((len(models), mujoco.mj_stateSize(models[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    push = 20.0 * np.sin(np.linspace(0.0, 4.0 * np.pi, steps))[None, :, None]
    force = np.broadcast_to(push, (len(models), steps, models[0].nv)).copy()
    with rollout.Rollout(nthread=threads) as runner:
        before = time.perf_counter()
        states, _ = runner.rollout(
            models, data, start, force, control_spec=int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)
        )
        seconds = time.perf_counter() - before
    if not np.isfinite(np.asarray(states, dtype=float)).all():
        raise FloatingPointError("a world left finite numbers")
    return len(models) * steps / seconds


def main(
    category: str = "StorageFurniture",
    like: int = 0,
    count: int = 64,
    steps: int = 500,
    rounds: int = 5,
    threads: int = 1,
) -> None:
    """Prints the two speeds and their ratio.

    Args:
        category: of the objects.
        like: seed of the object that all are built as.
        count: worlds of each batch.
        steps: of each world and round.
        rounds: measurements, in turns.
        threads: of the engine.
    """
    build = describe_build(draw_shape(category, like))
    packages = [
        build_reference(draw_variant(category, like, seed, lambda shape: describe_build(shape) == build))
        for seed in range(count)
    ]
    if len({find_topology(package) for package in packages}) != 1:
        raise AssertionError("variants of one object have different topologies")
    with tempfile.TemporaryDirectory() as scratch:
        models = [compile_model(package, Path(scratch)) for package in packages]
    some = models[:: max(1, count // SOME)]
    measured: dict[str, list[float]] = {"equal": [], "different": []}
    for _ in range(rounds):
        measured["different"].append(step_worlds(models, steps, threads))
        seconds = [1.0 / step_worlds([one] * count, steps, threads) for one in some]
        measured["equal"].append(1.0 / float(np.mean(seconds)))
    medians = {name: float(np.median(speeds)) for name, speeds in measured.items()}
    for name, speed in medians.items():
        print(f"{count} {name} objects: {speed:,.0f} world steps a second")
    print(f"different against equal: {medians['different'] / medians['equal']:.3f}")


if __name__ == "__main__":
    tyro.cli(main)
