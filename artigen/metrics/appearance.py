"""Compares pictures of autoencoded and sampled objects with true ones, in every joint state.

Newly exposed surface, which is hidden while an object is closed, is scored separately.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Int, UInt8
from torch import Tensor

from artigen.appearance.features import FeatureExtractor
from artigen.appearance.photographs import NOTHING
from artigen.appearance.vae import AppearanceVae
from artigen.examples.appearance import AppearanceExample
from artigen.examples.appearance_batches import (
    PictureBatch,
    draw_pictures,
    picture_batch,
    raster_config,
    voxel_batch,
)
from artigen.metrics.clouds import chamfer
from artigen.metrics.pictures import frechet_distance, kernel_distance, measure_psnr, measure_ssim
from artigen.splats.render.splats import Splats
from artigen.types import SurfaceSamples

Scores = dict[str, float]
Colors = dict[int, Float[np.ndarray, "3"]]
"""Mean colour (sRGB in [0, 1]) by part."""

MIN_PIXELS = 12
"""Least number of pixels of a part, over all pictures, for it to count."""
POINTS = 4096
"""Points of each cloud."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison:
    """Pictures of one object beside the true ones."""

    drawn: Float[Tensor, "V H W 3"]
    truth: Float[Tensor, "V H W 3"]
    mask: Bool[Tensor, "V H W"]
    exposed: Bool[Tensor, "V H W"]
    fractions: Float[Tensor, "V"]
    """Share of their ranges by which joints are open, which identifies the state of a picture."""


@torch.no_grad()
def reconstruct_splats(vae: AppearanceVae, example: AppearanceExample) -> Splats:
    """Gaussians that a VAE decodes from the posterior means of an object's features."""
    device = next(vae.parameters()).device
    coords, feats, facings = (value.to(device) for value in voxel_batch([example]))
    noise = torch.zeros(len(coords), vae.encoder.cfg.latent_channels, device=device)
    return vae(coords, feats, noise, facings).splats


@torch.no_grad()
def compare_pictures(vae: AppearanceVae, splats: Splats, example: AppearanceExample) -> Comparison:
    """Renders Gaussians of an object's voxels from the cameras of its pictures, in their joint states."""
    pictures = example.pictures
    device = splats.means.device
    batch: PictureBatch = picture_batch([example], [np.arange(len(pictures.rgb))]).to(device)
    drawn = draw_pictures(splats, batch, raster_config(vae, device))[0]
    states = len(pictures.displacements)
    shares = pictures.state / max(states - 1, 1)
    return Comparison(
        drawn=drawn.clamp(0.0, 1.0).cpu(),
        truth=batch.rgb[0].cpu(),
        mask=torch.from_numpy(pictures.mask),
        exposed=torch.from_numpy(pictures.exposed),
        fractions=torch.from_numpy(shares).float(),
    )


def score_comparisons(comparisons: Sequence[Comparison]) -> Scores:
    """PSNR (dB; mean over objects) and SSIM.

    ``psnr`` is over whole pictures, ``object`` over the pixels that show the object, ``exposed`` over those
    whose surface is hidden in the closed state, ``rest`` over the other pixels that show the object;
    ``exposed_share`` is the share of the object's pixels that are newly exposed. A score without a finite
    value is left out.
    """
    rows: dict[str, list[float]] = {}
    for one in comparisons:
        regions = {
            "psnr": None,
            "object": one.mask,
            "exposed": one.exposed & one.mask,
            "rest": one.mask & ~one.exposed,
        }
        for name, region in regions.items():
            rows.setdefault(name, []).append(measure_psnr(one.drawn, one.truth, region))
        rows.setdefault("ssim", []).append(measure_ssim(one.drawn, one.truth))
        rows.setdefault("exposed_share", []).append(
            float((one.exposed & one.mask).sum() / one.mask.sum().clamp(min=1))
        )
    means = {name: [value for value in values if np.isfinite(value)] for name, values in rows.items()}
    return {name: float(np.mean(values)) for name, values in means.items() if values}


def split_states(comparisons: Sequence[Comparison]) -> dict[float, list[Comparison]]:
    """The pictures of each joint state, object by object."""
    states = sorted({round(float(share), 6) for one in comparisons for share in one.fractions})
    return {
        share: [_select(one, (one.fractions - share).abs() < 1e-4) for one in comparisons] for share in states
    }


@torch.no_grad()
def score_sets(comparisons: Sequence[Comparison], extractor: FeatureExtractor) -> Scores:
    """Fréchet and kernel distance between all drawn and all true pictures, in pooled features.

    Features of a picture are the means and standard deviations of its maps. Neither number is comparable
    with one of another extractor, or of another number of pictures.
    """
    drawn, truth = (
        np.concatenate([pool_features(getattr(one, name), extractor) for one in comparisons])
        for name in ("drawn", "truth")
    )
    return {"frechet": frechet_distance(drawn, truth), "kernel": kernel_distance(drawn, truth)}


def pool_features(rgb: Float[Tensor, "V H W 3"], extractor: FeatureExtractor) -> Float[np.ndarray, "V D"]:
    """Means and standard deviations of the feature maps of pictures."""
    pictures = rgb.permute(0, 3, 1, 2)
    maps = extractor(torch.cat([pictures, torch.ones_like(pictures[:, :1])], dim=1)).flatten(2)
    return torch.cat([maps.mean(dim=2), maps.std(dim=2)], dim=1).double().numpy()


def score_vae(vae: AppearanceVae, examples: Iterable[AppearanceExample]) -> Scores:
    """Autoencodes objects and scores the pictures that they hold."""
    return score_comparisons([compare_pictures(vae, reconstruct_splats(vae, one), one) for one in examples])


def _select(one: Comparison, rows: Bool[Tensor, "V"]) -> Comparison:
    return Comparison(**{name: value[rows] for name, value in vars(one).items()})


def mean_colors(rgb: Float[np.ndarray, "V H W 3"], parts: UInt8[np.ndarray, "V H W"]) -> Colors:
    """Mean colour of the pixels of each part that enough pixels show; ``parts`` is `NOTHING` elsewhere."""
    ids, counts = np.unique(parts[parts != NOTHING], return_counts=True)
    return {
        int(part): rgb[parts == part].mean(axis=0)
        for part, count in zip(ids, counts, strict=True)
        if count >= MIN_PIXELS
    }


def color_error(found: Mapping[int, np.ndarray], truth: Mapping[int, np.ndarray]) -> float:
    """Mean over the true parts of the mean absolute difference of their colours.

    Raises:
        ValueError: If there is no true part, or one has no counterpart.
    """
    if not truth or not truth.keys() <= found.keys():
        raise ValueError(f"colours of parts {sorted(found)}, expected those of {sorted(truth)}, at least one")
    return float(np.mean([np.abs(found[part] - color).mean() for part, color in truth.items()]))


def score_colors(
    examples: Sequence[AppearanceExample], answers: Mapping[str, Sequence[Comparison]]
) -> dict[str, float]:
    """Mean absolute error of the mean colour of each part that the closed object shows, over objects.

    Args:
        answers: Pictures of each of them, by method.
    """
    rows: dict[str, list[float]] = {name: [] for name in answers}
    for number, example in enumerate(examples):
        closed = example.pictures.state == 0
        parts = example.pictures.parts[closed]
        truth = mean_colors(example.pictures.rgb[closed] / 255.0, parts)
        for name, comparisons in answers.items():
            drawn = comparisons[number].drawn.double().numpy()[closed]
            rows[name].append(color_error(mean_colors(drawn, parts), truth))
    return {name: float(np.mean(values)) for name, values in rows.items()}


def score_distances(
    splats: Splats,
    part_ids: Int[np.ndarray, "N"],
    surface: SurfaceSamples,
    displacements: Float[np.ndarray, "S P 4 4"],
    *,
    points: int = POINTS,
) -> Scores:
    """``shape_rest`` in the first state, ``shape_articulated`` as a mean over all.

    Args:
        splats: Gaussians at rest, voxel after voxel.
        surface: True points at rest, with the same parts.
        displacements: Displacements of the parts, by state; the first is closed.

    Raises:
        ValueError: If the Gaussians do not divide evenly among the voxels.
    """
    means, opacities = (value.detach().double().cpu().numpy() for value in (splats.means, splats.opacities))
    if not len(part_ids) or len(means) % len(part_ids):
        raise ValueError(f"{len(means)} Gaussians for {len(part_ids)} voxels, expected as many for each")
    rng = np.random.default_rng(0)
    owners = np.repeat(part_ids, len(means) // len(part_ids))
    drawn = rng.choice(len(means), points, p=opacities / opacities.sum())
    true = rng.choice(len(surface.points), points, replace=len(surface.points) < points)
    distances = [
        chamfer(
            _move(means[drawn], D[owners[drawn]]),
            _move(surface.points[true].astype(np.float64), D[surface.part_ids[true]]),
        )
        for D in displacements
    ]
    return {"shape_rest": distances[0], "shape_articulated": float(np.mean(distances))}


def _move(points: Float[np.ndarray, "N 3"], D: Float[np.ndarray, "N 4 4"]) -> Float[np.ndarray, "N 3"]:
    return np.einsum("nij,nj->ni", D[:, :3, :3], points) + D[:, :3, 3]
