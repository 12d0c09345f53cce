"""Measures the clean-up of sampled cells with and without each stage: distance to the truth and roughness.

    python benchmarks/mending.py --out out/mending

takes held-out procedural objects with their true outlines (blurred as drawn ones are) a good part of the way
to noise, lets the flow bring them back, and measures the cells as decoded, with cells that agree along
lines, as boards, and with both; and what boards do to the truth itself. Writes ``mending.md``.
"""

import sys
from collections import defaultdict
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import torch
import tyro
from jaxtyping import Int
from roughness import measure_roughness
from scipy.ndimage import binary_dilation
from torch import Tensor

from artigen.examples.batches import condition_batch, outline_batch, patch_batch
from artigen.latent.draw import StructureModel, load_structure_model
from artigen.latent.outline import OutlineBatch, blur_outlines
from artigen.latent.structure_vae import decode_cells
from artigen.metrics.report import format_table
from artigen.metrics.subjects import Subject, draw_subjects
from artigen.models.rectified_flow import diffuse
from artigen.voxels.cleanup.boards import make_boards
from artigen.voxels.cleanup.rows import read_owners
from artigen.voxels.fields import decode, encode
from artigen.weights import SHIPPED

Owners = Int[np.ndarray, "X Y Z"]
CERTAIN = 6.0
"""Logit of a cell of the truth."""
SMALLEST = 60
"""Parts of fewer cells are not scored on their own."""
NEAR = np.ones((3, 3, 3), dtype=bool)
"""Cells at most one away."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    model: Path = SHIPPED
    """Folder of the trained model."""
    out: Path = Path("out/mending")
    """Folder for the table."""
    objects: int = 14
    """Held-out objects, categories in turn."""
    time: float = 0.85
    """How far towards noise, at most 1."""
    steps: int = 12
    """Steps back."""


def bring_back(
    model: StructureModel, subject: Subject, outlines: OutlineBatch, options: Options, seed: int
) -> Tensor:
    """The latent of an object after a way towards noise and back."""
    generator = torch.Generator().manual_seed(seed)
    mean, _ = model.vae.encode(patch_batch([subject.example]))
    clean, flow = model.flow.normalise(mean), model.flow
    tokens = flow.conditions(condition_batch([subject.example], model.preset.conditions))
    hint = flow.hint(outlines)
    times = torch.linspace(options.time, 0.0, options.steps + 1)
    x = diffuse(clean, torch.randn(clean.shape, generator=generator), times[:1])
    for time, following in pairwise(times):
        x = x - (time - following) * flow.velocity(x, time[None], tokens, hint)
    return flow.restore(x)


def score(drawn: Owners, truth: Owners) -> tuple[float, float, float, float]:
    """Intersection over union; F1 within a cell, of all cells and a mean over parts; bends."""
    some, true = drawn >= 0, truth >= 0
    parts = [part for part in np.unique(truth[true]) if (truth == part).sum() >= SMALLEST]
    return (
        float((some & true).sum() / (some | true).sum()),
        _near_f1(some, true),
        float(np.mean([_near_f1(drawn == part, truth == part) for part in parts])),
        measure_roughness(some),
    )


def _near_f1(one: np.ndarray, other: np.ndarray) -> float:
    precision = (one & binary_dilation(other, NEAR)).sum() / max(one.sum(), 1)
    recall = (other & binary_dilation(one, NEAR)).sum() / other.sum()
    return float(2 * precision * recall / max(precision + recall, 1e-9))


def main(options: Options) -> int:
    """Runs all objects and writes the table."""
    model = load_structure_model(options.model)
    preset = model.preset
    subjects = draw_subjects(
        preset.conditions.categories, 0, options.objects, resolution=preset.resolution, image_size=0
    )
    scores = defaultdict(list)
    for number, subject in enumerate(subjects):
        exact = outline_batch([subject.example])
        outlines = blur_outlines(exact, 0.0, torch.Generator().manual_seed(number))
        rows = outlines.rows[0].numpy()
        with torch.no_grad():
            latent = bring_back(model, subject, outlines, options, number)
        exact_rows = exact.rows[0].numpy()
        truth = read_owners(decode(encode(subject.asset)), exact_rows)
        scores["the truth"].append(score(truth, truth))
        for name, steady in (("as decoded", False), ("along lines", True)):
            fields, logits = decode_cells(model.vae, latent, outlines, steady=steady)
            owners = read_owners(fields[0], rows)
            made, _ = make_boards(owners, logits[0].numpy(), rows)
            scores[name].append(score(owners, truth))
            scores[f"{name}, boards"].append(score(made, truth))
        certain = np.where(truth >= 0, CERTAIN, -CERTAIN)
        remade, _ = make_boards(truth, certain, exact_rows)
        scores["the truth, boards"].append(score(remade, truth))
        print(f"{number + 1} of {options.objects}: {subject.asset.name}", file=sys.stderr)
    head = ("", "intersection over union", "F1 within a cell", "of parts", "bends per face")
    table = [(name, *(f"{value:.3f}" for value in np.mean(found, axis=0))) for name, found in scores.items()]
    options.out.mkdir(parents=True, exist_ok=True)
    text = "\n".join(format_table(head, table)) + "\n"
    (options.out / "mending.md").write_text(text)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
