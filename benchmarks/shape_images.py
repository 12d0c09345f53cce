"""Times pictures of procedural objects: one on a CPU core, and pictures per second in batches.

    python benchmarks/shape_images.py                    # CPU, one thread
    python benchmarks/shape_images.py --device cuda      # batches on a GPU; single pictures stay on the CPU

Every object is half open and seen from the front left, with 128 x 128 pixels, shadows and soft corners.
Single pictures include everything from the shape to the tensors; batches have one shape in many views and
states. The time of one picture is the best of three in CPU time, which is robust against other load. Prints a
Markdown table.
"""

import statistics
import time
from collections.abc import Sequence

import numpy as np
import torch
import tyro

from artigen.camera import frame_points
from artigen.kind import kinds
from artigen.shapes.draw import draw_shape
from artigen.shapes.poses import open_parts
from artigen.shapes.primitives import place_vertices
from artigen.shapes.render import Cameras, batch_cameras, build_scene, render
from artigen.shapes.shape import Shape


def frame_shape(shape: Shape, size: int) -> Cameras:
    """A camera in front of the closed object."""
    points = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
    camera = frame_points(points, (-0.8, 0.45, 0.35), width=size, height=size, margin=0.12)
    return batch_cameras([camera])


def time_picture(shape: Shape, size: int) -> float:
    """CPU time (ms) of one picture, including the conversion of the shape."""
    cameras, qpos = frame_shape(shape, size), open_parts(shape, 0.5)
    spent = []
    for _ in range(3):
        start = time.process_time()
        render(build_scene([shape]), cameras, [qpos])
        spent.append(time.process_time() - start)
    return 1e3 * min(spent)


def rate_batch(shape: Shape, size: int, batch: int, device: str) -> float:
    """Pictures per second in a batch of one opening shape."""
    scene, one = build_scene([shape], device), frame_shape(shape, size)
    cameras = Cameras(
        position=one.position.repeat(batch, 1).to(device),
        target=one.target.repeat(batch, 1).to(device),
        fov=one.fov.repeat(batch).to(device),
        width=size,
        height=size,
    )
    states = [open_parts(shape, fraction) for fraction in np.linspace(0, 1, batch)]
    best = float("inf")
    for _ in range(3):
        start = time.perf_counter()
        float(render(scene, cameras, states).rgb.sum())  # waits for the device
        best = min(best, time.perf_counter() - start)
    return batch / best


def count_primitives(shapes: Sequence[Shape]) -> float:
    """Median number of primitives."""
    return statistics.median(sum(len(part.primitives) for part in shape.parts) for shape in shapes)


def main(*, objects: int = 8, size: int = 128, batch: int = 16, device: str = "cpu") -> None:
    """Times pictures of every category.

    Args:
        objects: Per category.
        size: Pixels of a picture's edge.
        batch: Pictures at once.
        device: Where batches are rendered.
    """
    torch.set_num_threads(1)
    print(f"| category | primitives | one picture, median (ms) | most (ms) | {device}, pictures / s |")
    print("|---|---|---|---|---|")
    for category in kinds():
        shapes = [draw_shape(category, seed) for seed in range(objects)]
        spent = [time_picture(shape, size) for shape in shapes]
        rate = statistics.median(rate_batch(shape, size, batch, device) for shape in shapes[:3])
        print(
            f"| {category} | {count_primitives(shapes):.0f} | {statistics.median(spent):.0f} "
            f"| {max(spent):.0f} | {rate:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    tyro.cli(main)
