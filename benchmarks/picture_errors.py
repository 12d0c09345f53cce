"""Sorts the errors of autoencoded pictures by what the pixels show, newly exposed and others.

    python benchmarks/picture_errors.py --out out/picture_errors

takes the pictures of `artigen eval appearance` and sorts their pixels by what they show: glass; surface that
lies in no voxel of its part (bare); surface that faces along neither side of its voxel (ends); pixels beside
another part, a fold or a step in depth (edges); and all others (faces). For every sort: its share of pixels,
its PSNR, and the mean PSNR of the region if the sort were as good as faces are. Writes ``picture_errors.md``.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
import tyro
from jaxtyping import Bool, Float, Int

from artigen.appearance.exposure import rest_surface
from artigen.appearance.photographs import State, look_at_surface, photograph
from artigen.appearance.states import plan_fractions
from artigen.appearance.views import ViewConfig
from artigen.examples.appearance import AppearanceExample
from artigen.metrics.appearance import compare_pictures, reconstruct_splats
from artigen.metrics.evaluate_appearance import (
    EvaluateAppearanceConfig,
    TrainedAppearance,
    draw_subject,
    load_trained,
)
from artigen.metrics.report import format_table
from artigen.shapes.asset import frame_shape
from artigen.shapes.draw import draw_shape
from artigen.shapes.render import Images, build_scene
from artigen.shapes.render.scene import Scene
from artigen.types import SurfaceSamples, VoxelGrid
from artigen.voxels.frames import facing_frames
from artigen.voxels.surface import AHEAD, find_voxels
from artigen.weights import SHIPPED

SORTS = ("glass", "bare", "ends", "edges", "faces")
CLEAR = 0.05
"""Share of what is behind from which a pixel shows glass."""
FOLD, STEP = 0.9, 0.05
"""Cosine below which neighbouring pixels show a fold, and step in depth (unit-cube length) between them."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    model: Path = SHIPPED
    """Folder of the trained appearance model."""
    out: Path = Path("out/picture_errors")
    """Folder for the table."""
    objects: int = 14
    """Held-out objects, categories in turn."""


def sort_pixels(
    scene: Scene, state: State, example: AppearanceExample, frame: tuple[Float[np.ndarray, "3"], float]
) -> Int[np.ndarray, "V H W"]:
    """Which of `SORTS` every pixel of the pictures of a state shows; -1 where the object is not."""
    images, (center, scale) = state.images, frame
    mask = images.mask.numpy()
    points, normals = (one.double().numpy() for one in rest_surface(scene, state.cameras, images, state.qpos))
    surface = SurfaceSamples(
        points=(points - center) / scale,
        normals=normals,
        colors=np.zeros(points.shape, dtype=np.uint8),
        part_ids=state.owners[images.part_ids[images.mask].numpy()],
    )
    voxels = VoxelGrid(resolution=example.resolution, coords=example.coords, part_ids=example.part_ids)
    rows, own = find_voxels(surface, voxels)
    ends = own.copy()
    axes = facing_frames()[example.facings[rows]][:, :, 0]
    ends[own] = np.abs(np.einsum("ki,ki->k", axes, normals[own])) <= AHEAD
    out = np.full(mask.shape, -1)
    out[mask] = np.select([~own, ends], [SORTS.index("bare"), SORTS.index("ends")], SORTS.index("faces"))
    out[(out == SORTS.index("faces")) & find_borders(images, STEP * scale)] = SORTS.index("edges")
    clear = look_at_surface(scene, state)[1].numpy()
    out[mask & (clear > CLEAR)] = SORTS.index("glass")
    return out


def find_borders(images: Images, step: float) -> Bool[np.ndarray, "V H W"]:
    """Pixels that show another part, another direction or another depth than one beside them."""
    mask = images.mask.numpy()
    part, normal = np.where(mask, images.part_ids.numpy(), -1), images.normals.numpy()
    depth = np.where(mask, images.depth.numpy(), 0.0)
    out = np.zeros(mask.shape, dtype=bool)
    for axis in (1, 2):
        one, other = (
            tuple(cut if number == axis else slice(None) for number in range(3))
            for cut in (slice(1, None), slice(None, -1))
        )
        differ = (part[one] != part[other]) | ((normal[one] * normal[other]).sum(axis=-1) < FOLD)
        differ |= np.abs(depth[one] - depth[other]) > step
        out[one] |= differ
        out[other] |= differ
    return out


def measure_object(model: TrainedAppearance, number: int) -> dict[str, Float[np.ndarray, "K 2"]]:
    """Pixels of each sort and the sum of their squared errors, by region."""
    cfg = EvaluateAppearanceConfig()
    asset, example = draw_subject(model, number, cfg)
    compared = compare_pictures(model.vae, reconstruct_splats(model.vae, example), example)
    category, seed = asset.name.rsplit("_", 1)
    shape = draw_shape(category, int(seed))
    scene, frame = build_scene([shape]), frame_shape(shape)
    fractions = plan_fractions(shape, cfg.states, staggered=False)
    states = photograph(scene, asset, fractions, ViewConfig(count=cfg.views, size=cfg.size))
    sorts = np.concatenate([sort_pixels(scene, state, example, frame) for state in states])
    squared = ((compared.drawn - compared.truth) ** 2).mean(dim=-1).double().numpy()
    exposed = compared.exposed.numpy()
    regions = {"newly exposed": exposed, "the object's others": ~exposed}
    return {
        name: np.array(
            [
                (np.count_nonzero(rows), squared[rows].sum())
                for rows in (region & (sorts == sort) for sort in range(len(SORTS)))
            ]
        )
        for name, region in regions.items()
    }


def tabulate(name: str, found: Float[np.ndarray, "N K 2"]) -> list[tuple[str, ...]]:
    """Rows of a region: one for all pixels, one for every sort."""
    counts, errors = found[..., 0], found[..., 1]
    faces = SORTS.index("faces")
    plain = errors[:, faces] / np.maximum(counts[:, faces], 1)
    rows = [(name, "all", "100 %", f"{_mean_psnr(errors, counts):.2f}", "")]
    for number, sort in enumerate(SORTS):
        count, error = counts[:, number].sum(), errors[:, number].sum()
        better = errors.copy()
        better[:, number] = np.minimum(errors[:, number], counts[:, number] * plain)
        share, psnr = f"{100 * count / counts.sum():.1f} %", f"{-10 * np.log10(error / max(count, 1)):.1f}"
        rows.append((name, sort, share, psnr, f"{_mean_psnr(better, counts):.2f}"))
    return rows


def _mean_psnr(errors: Float[np.ndarray, "N K"], counts: Float[np.ndarray, "N K"]) -> float:
    """Over objects, of those that show anything."""
    shown = counts.sum(axis=1) > 0
    return float((-10.0 * np.log10(errors[shown].sum(axis=1) / counts[shown].sum(axis=1))).mean())


def main(options: Options) -> int:
    """Runs all objects and writes the table."""
    model = load_trained(options.model, torch.device("cpu"))
    found: list[dict[str, Float[np.ndarray, "K 2"]]] = []
    for number in range(options.objects):
        with torch.no_grad():
            found.append(measure_object(model, number))
        print(f"{number + 1} of {options.objects}", file=sys.stderr)
    head = ("pixels", "that show", "share", "PSNR, dB", "all, if these were as faces are")
    rows = [row for name in found[0] for row in tabulate(name, np.stack([one[name] for one in found]))]
    text = "\n".join(format_table(head, rows)) + "\n"
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "picture_errors.md").write_text(text)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
