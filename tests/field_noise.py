"""Adds noise to true voxel fields, with the errors measured in the paper's Tables 3 and 4."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter

from artigen.voxels.fields import VoxelFields


@dataclass(frozen=True, kw_only=True)
class FieldNoise:
    """Standard deviations within a part (paper Table 4) and shares of wrong classes (Table 3).

    Where Table 4 gives one figure for each end of a range, the larger is used for the range.
    """

    center: tuple[float, float, float] = (0.0211, 0.0159, 0.0277)
    """Box centre, unit lengths."""
    size: tuple[float, float, float] = (0.0377, 0.0260, 0.0391)
    """Box size, unit lengths."""
    axis: tuple[float, float, float] = (0.1012, 0.0972, 0.0875)
    """Components of the joint axis."""
    origin: tuple[float, float, float] = (0.0392, 0.0233, 0.0384)
    """Joint origin, unit lengths."""
    rotation: float = float(np.radians(7.56))
    """Rotation range, radians."""
    travel: float = 0.0123
    """Translation range, unit lengths."""
    label_error: float = 0.0
    """Share of voxels that carry another part label (Table 3: 0.0373)."""
    joint_error: float = 0.0
    """Share of voxels that carry another joint type (Table 3: 0.0083)."""
    missing: float = 0.0
    """Share of occupied voxels that are lost (Table 3: 0.0106)."""
    correlation: float = 0.0
    """Voxels over which the noise is alike; 0 draws every voxel on its own, as Table 4 leaves open."""


TABLE_4 = FieldNoise()
TABLES_3_AND_4 = FieldNoise(label_error=0.0373, joint_error=0.0083, missing=0.0106)


def add_noise(fields: VoxelFields, noise: FieldNoise, rng: np.random.Generator) -> VoxelFields:
    """Fields with noise drawn from ``rng``; noise is added to movable and fixed parts alike.

    A fixed part states no axis and no range, but a network's output scatters there too.
    """
    if noise.missing:
        fields = _thinned(fields, rng.random(len(fields.coords)) >= noise.missing)
    scale = np.array([*noise.center, *noise.size, *noise.origin, *noise.axis, noise.rotation, noise.travel])
    drawn = _draw(fields, len(scale), noise.correlation, rng) * scale
    return replace(
        fields,
        box=fields.box + drawn[:, :6],
        origin=fields.origin + drawn[:, 6:9],
        axis=fields.axis + drawn[:, 9:12],
        ranges=fields.ranges + drawn[:, 12:],
        label_probs=_confused(fields.label_probs, noise.label_error, rng),
        joint_probs=_confused(fields.joint_probs, noise.joint_error, rng),
    )


def _thinned(fields: VoxelFields, kept: np.ndarray) -> VoxelFields:
    names = ("coords", "label_probs", "joint_probs", "axis", "origin", "ranges", "box", "category_probs")
    return replace(fields, **{name: getattr(fields, name)[kept] for name in names})


def _draw(
    fields: VoxelFields, width: int, correlation: float, rng: np.random.Generator
) -> Float[np.ndarray, "N W"]:
    """Unit-variance noise per voxel, smoothed over ``correlation`` voxels where that is above 0."""
    if correlation <= 0:
        return rng.standard_normal((len(fields.coords), width))
    shape = (fields.resolution,) * 3
    columns = []
    for _ in range(width):
        smooth = gaussian_filter(rng.standard_normal(shape, dtype=np.float32), correlation, mode="wrap")
        columns.append(smooth[tuple(fields.coords.T.astype(np.int64))] / smooth.std())
    return np.stack(columns, axis=1)


def _confused(probs: np.ndarray, share: float, rng: np.random.Generator) -> np.ndarray:
    """Moves the probabilities of ``share`` of the rows to another class, drawn evenly."""
    hit = np.flatnonzero(rng.random(len(probs)) < share)
    shift = rng.integers(1, probs.shape[1], size=len(hit))
    columns = (np.arange(probs.shape[1]) - shift[:, None]) % probs.shape[1]
    out = probs.copy()
    out[hit] = np.take_along_axis(probs[hit], columns, axis=1)
    return out
