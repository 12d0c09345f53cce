"""Similarity of pictures (PSNR, SSIM) and of sets of pictures (Fréchet and kernel distance of features).

Distances of sets depend on the features and on the number of pictures. State both with a result, and compare
only results that agree in them.
"""

import numpy as np
import torch
from jaxtyping import Bool, Float
from torch import Tensor
from torch.nn import functional

WINDOW, SIGMA = 11, 1.5
"""Window size and standard deviation in pixels of the local means in SSIM (Wang et al., 2004)."""
CONSTANTS = (0.01**2, 0.03**2)
"""Constants of SSIM for values in [0, 1]."""


def measure_psnr(
    drawn: Float[Tensor, "*V H W 3"],
    truth: Float[Tensor, "*V H W 3"],
    mask: Bool[Tensor, "*V H W"] | None = None,
) -> float:
    """Peak signal-to-noise ratio (dB) of values in [0, 1], from the mean error of all pixels together.

    Args:
        drawn: Pictures; values are clipped to [0, 1].
        mask: Pixels that count; all when None.

    Returns:
        Infinity if nothing differs, NaN if no pixel counts.
    """
    squares = (drawn.clamp(0.0, 1.0) - truth) ** 2
    squares = squares if mask is None else squares[mask]
    if not squares.numel():
        return float("nan")
    return float(-10.0 * torch.log10(squares.double().mean()))


def ssim_map(first: Float[Tensor, "V 3 H W"], second: Float[Tensor, "V 3 H W"]) -> Float[Tensor, "V 3 h w"]:
    """Structural similarity of every window that lies inside of the pictures, per channel."""
    kernel = _window(first)

    def local(values: Tensor) -> Tensor:
        across = functional.conv2d(values.flatten(0, 1)[:, None], kernel[None, None, None, :])
        return functional.conv2d(across, kernel[None, None, :, None])[:, 0].unflatten(0, values.shape[:2])

    a, b = local(first), local(second)
    aa, bb, ab = local(first * first) - a * a, local(second * second) - b * b, local(first * second) - a * b
    low, high = CONSTANTS
    return (2 * a * b + low) * (2 * ab + high) / ((a * a + b * b + low) * (aa + bb + high))


def measure_ssim(drawn: Float[Tensor, "V H W 3"], truth: Float[Tensor, "V H W 3"]) -> float:
    """Mean structural similarity of pictures with values in [0, 1]; 1 is equality."""
    first, second = (values.permute(0, 3, 1, 2).double() for values in (drawn.clamp(0.0, 1.0), truth))
    return float(ssim_map(first, second).mean())


def frechet_distance(first: Float[np.ndarray, "N D"], second: Float[np.ndarray, "M D"]) -> float:
    """Fréchet distance of two sets of features as Gaussians; FID for Inception features.

    Raises:
        ValueError: If a set has fewer than two members.
    """
    _check_sets(first, second)
    a, b = (np.cov(values, rowvar=False).reshape(values.shape[1], -1) for values in (first, second))
    values, axes = np.linalg.eigh(a)
    half = (axes * np.sqrt(values.clip(min=0.0))) @ axes.T
    common = np.sqrt(np.linalg.eigvalsh(half @ b @ half).clip(min=0.0)).sum()  # trace of the root of a b
    apart = ((first.mean(axis=0) - second.mean(axis=0)) ** 2).sum()
    return float(apart + np.trace(a) + np.trace(b) - 2.0 * common)


def kernel_distance(first: Float[np.ndarray, "N D"], second: Float[np.ndarray, "M D"]) -> float:
    """Unbiased squared maximum mean discrepancy under ``(x . y / D + 1)^3``; KID for Inception features.

    For two sets from one distribution it is zero on average and can be negative.

    Raises:
        ValueError: If a set has fewer than two members.
    """
    _check_sets(first, second)
    width = first.shape[1]
    a, b, ab = ((x @ y.T / width + 1.0) ** 3 for x, y in ((first, first), (second, second), (first, second)))
    within = sum((k.sum() - np.trace(k)) / (len(k) * (len(k) - 1)) for k in (a, b))
    return float(within - 2.0 * ab.mean())


def _window(like: Tensor) -> Float[Tensor, "K"]:
    steps = torch.arange(WINDOW, dtype=like.dtype, device=like.device) - (WINDOW - 1) / 2
    weights = torch.exp(-0.5 * (steps / SIGMA) ** 2)
    return weights / weights.sum()


def _check_sets(first: np.ndarray, second: np.ndarray) -> None:
    if min(len(first), len(second)) < 2:
        raise ValueError(f"sets of {len(first)} and {len(second)} pictures, expected at least two in each")
