"""Conversion between sRGB and linear light (IEC 61966-2-1), extended beyond [0, 1]."""

import math

import numpy as np
from jaxtyping import Float

HARMONIC = 1.0 / math.sqrt(4.0 * math.pi)
"""The spherical harmonic of degree 0, by which files and decoders multiply colours."""


def srgb_from_linear(light: Float[np.ndarray, "*S"]) -> Float[np.ndarray, "*S"]:
    """Display values of linear light (float64)."""
    light = np.asarray(light, dtype=np.float64)
    curved = 1.055 * np.maximum(light, 0.0031308) ** (1.0 / 2.4) - 0.055
    return np.where(light <= 0.0031308, 12.92 * light, curved)


def linear_from_srgb(values: Float[np.ndarray, "*S"]) -> Float[np.ndarray, "*S"]:
    """Linear light of display values (float64)."""
    values = np.asarray(values, dtype=np.float64)
    curved = ((np.maximum(values, 0.04045) + 0.055) / 1.055) ** 2.4
    return np.where(values <= 12.92 * 0.0031308, values / 12.92, curved)
