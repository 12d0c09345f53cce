"""Measures time and memory of the splat rasteriser.

    python benchmarks/splats.py --out out/splats --threads 2

draws splats on the surface of the unit cube, as a decoder of structured latents places them, from cameras
around it: forward with gradients on, then backward. Writes ``splats.json`` and ``splats.md``. Every row runs
in a process of its own; times are the best of several rounds, on the wall and (busy) of the processor, and
memory is what the process grew by.
"""

import json
import multiprocessing
import resource
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import torch
import tyro
from torch import Tensor

from artigen.splats.render import Cameras, RasterConfig, Splats, rasterize


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    out: Path = Path("out/splats")
    """Folder for the results."""
    threads: int = 2
    """Threads of torch on the CPU."""
    rounds: int = 5
    """Repetitions; the best counts."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """Splats of one kind, and pictures of them."""

    name: str
    count: int = 100_000
    scale: float = 0.004
    """Median standard deviation (edge of the object: 1)."""
    opacity: float = 0.9
    size: int = 256
    """Pixels along each side."""
    device: str = "cpu"


@dataclass(frozen=True, kw_only=True)
class Timing:
    """One row."""

    case: Case
    forward: float
    """Seconds."""
    backward: float
    forward_busy: float
    """Seconds of processor time of all threads; less than the other where others use the machine, too."""
    backward_busy: float
    memory: float
    """MiB."""


CASES = (
    Case(name="decoder at its start (opacity 0.1)", opacity=0.1),
    Case(name="opaque surface"),
    Case(name="opaque surface", count=300_000),
    Case(name="opaque surface", size=512),
    Case(name="opaque surface", count=20_000, scale=0.01, size=128),
    Case(name="wide and faint: nothing ends early", scale=0.03, opacity=0.05),
)


def list_cases() -> Iterator[Case]:
    """All cases, on every device there is."""
    yield from CASES
    if torch.cuda.is_available():
        yield from (replace(case, device="cuda") for case in CASES)


def place_splats(case: Case) -> Splats:
    """Splats all over the surface of the unit cube, turned at random."""
    generator = torch.Generator().manual_seed(0)
    at = torch.rand(case.count, 3, generator=generator) - 0.5
    side = torch.randint(3, (case.count,), generator=generator)
    at[torch.arange(case.count), side] = at[torch.arange(case.count), side].sign() * 0.5
    stretch = torch.exp(0.3 * torch.randn(case.count, 3, generator=generator))
    values = {
        "means": at,
        "quats": torch.randn(case.count, 4, generator=generator),
        "scales": case.scale * stretch,
        "opacities": torch.full((case.count,), case.opacity),
        "colors": torch.rand(case.count, 3, generator=generator),
    }
    return Splats(**{name: value.to(case.device).requires_grad_() for name, value in values.items()})


def measure(case: Case, threads: int, rounds: int) -> Timing:
    """Forward and backward of one picture."""
    torch.set_num_threads(threads)
    fragments = RasterConfig().fragments * (32 if case.device == "cuda" else 1)
    cfg = RasterConfig(fragments=fragments)
    place = torch.tensor([[-1.6, -1.0, 0.9]], dtype=torch.float64, device=case.device)
    camera = Cameras(
        position=place,
        target=torch.zeros_like(place),
        fov=torch.full_like(place[:, 0], 40.0),
        width=case.size,
        height=case.size,
    )
    splats, before = place_splats(case), memory_used(case.device)
    rasterize(splats, camera, cfg=cfg).color.sum().backward()
    found = []
    for _ in range(rounds):
        marks = [(now(case.device), time.process_time())]
        color: Tensor = rasterize(splats, camera, cfg=cfg).color
        marks.append((now(case.device), time.process_time()))
        color.square().sum().backward()
        marks.append((now(case.device), time.process_time()))
        start, middle, end = marks
        found.append((middle[0] - start[0], end[0] - middle[0], middle[1] - start[1], end[1] - middle[1]))
    forward, backward, forward_busy, backward_busy = (min(column) for column in zip(*found, strict=True))
    return Timing(
        case=case,
        forward=forward,
        backward=backward,
        forward_busy=forward_busy,
        backward_busy=backward_busy,
        memory=memory_used(case.device) - before,
    )


def now(device: str) -> float:
    """Seconds, once the device has done all that it was given."""
    if device == "cuda":
        torch.cuda.synchronize()
    return time.perf_counter()


def memory_used(device: str) -> float:
    """MiB that the process (or the device) has held at most so far."""
    if device == "cuda":
        return torch.cuda.max_memory_allocated() / 2**20
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def write_table(timings: list[Timing]) -> str:
    """Markdown."""
    lines = [
        "| splats | on | number | sigma | pixels | forward, s (busy) | backward, s (busy) | memory, MiB |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in timings:
        case = row.case
        lines.append(
            f"| {case.name} | {case.device} | {case.count:,} | {case.scale:g} | "
            f"{case.size} x {case.size} | {row.forward:.2f} ({row.forward_busy:.2f}) | "
            f"{row.backward:.2f} ({row.backward_busy:.2f}) | {row.memory:.0f} |"
        )
    return "\n".join(lines) + "\n"


def main(options: Options) -> None:
    """Measures all cases, one after the other, and writes the table."""
    timings = []
    spawn = multiprocessing.get_context("spawn")
    for case in list_cases():
        with ProcessPoolExecutor(1, mp_context=spawn) as pool:
            timings.append(pool.submit(measure, case, options.threads, options.rounds).result())
        print(timings[-1], flush=True)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "splats.json").write_text(json.dumps([asdict(row) for row in timings], indent=1) + "\n")
    table = write_table(timings)
    (options.out / "splats.md").write_text(table)
    print(table)


if __name__ == "__main__":
    main(tyro.cli(Options))
