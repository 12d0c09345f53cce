"""Compares pictures of autoencoded and sampled objects with true ones, in every joint state.

Newly exposed surface, which is hidden while an object is closed, is scored separately.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float
from torch import Tensor

from artigen.appearance.features import FeatureExtractor
from artigen.appearance.vae import AppearanceVae
from artigen.examples.appearance import AppearanceExample
from artigen.examples.appearance_batches import (
    PictureBatch,
    draw_pictures,
    picture_batch,
    raster_config,
    voxel_batch,
)
from artigen.metrics.pictures import frechet_distance, kernel_distance, measure_psnr, measure_ssim
from artigen.splats.render.splats import Splats

Scores = dict[str, float]


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
