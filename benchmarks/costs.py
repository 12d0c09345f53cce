"""What objects cost: seconds, triangles and bytes of packages, and memory of a process that validates many.

    python benchmarks/costs.py --seeds 130000 130001 130002 [--validations 300]

One object of every kind and seed is drawn and written, and they are validated in turn in this process.
Run it on an idle core. A first object, not counted, loads everything.
"""

import resource
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import torch
import tyro

import artigen
from artigen.kind import kinds
from sim_export.package import Mesh


def measure_objects(seeds: tuple[int, ...], out: Path) -> list[Path]:
    """Prints medians over all kinds and seeds; gives the folders of the packages."""
    folders, seconds, triangles, sizes = [], [], [], []
    artigen.sample("StorageFurniture", 0).export(out / "first")
    for kind in kinds():
        for seed in seeds:
            started = time.process_time()
            made = artigen.sample(kind, seed).export(out / f"{kind}_{seed}")
            seconds.append(time.process_time() - started)
            package = made.package
            meshes = [visual.mesh for link in package.links for visual in link.visuals]
            triangles.append(sum(len(mesh.faces) for mesh in meshes if isinstance(mesh, Mesh)))
            folders.append(out / f"{kind}_{seed}")
            sizes.append(sum(path.stat().st_size for path in folders[-1].rglob("*") if path.is_file()))
    print(
        f"{len(folders)} objects, medians: {np.median(seconds):.2f} s of one core, "
        f"{np.median(triangles):.0f} triangles, {np.median(sizes) / 1e6:.2f} MB"
    )
    return folders


def measure_memory(folders: list[Path], validations: int) -> None:
    """Prints the peak memory of this process after a tenth of the validations, and after all."""
    peaks = []
    for number in range(validations):
        artigen.load(folders[number % len(folders)]).validate()
        peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
    early, last = peaks[validations // 10], peaks[-1]
    print(f"{validations} validations: {early:.0f} MB after a tenth, {last:.0f} MB after all")


def main(seeds: tuple[int, ...] = (130000, 130001, 130002), validations: int = 0) -> int:
    """Measures objects, and memory if there are validations."""
    torch.set_num_threads(1)
    with TemporaryDirectory() as scratch:
        folders = measure_objects(seeds, Path(scratch))
        if validations:
            measure_memory(folders, validations)
    return 0


if __name__ == "__main__":
    sys.exit(tyro.cli(main))
