"""Gaussians on a sampled surface: flat, opaque discs, one per sample, without a network.

They give an object whose surface is known (procedural, scanned, from PartNet-Mobility) an appearance in the
same form as a generated one: for rendering, motion, baking of textures, and as ground truth for a model's
Gaussians. They are not fitted to pictures. They hold one colour per sample, no lighting, no translucency, and
no detail finer than the distance between samples.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from artigen.splats.colors import linear_from_srgb
from artigen.transforms import matrix_from_quat, quat_multiply
from artigen.types import Gaussians, SurfaceSamples


@dataclass(frozen=True, kw_only=True)
class SurfaceSplatConfig:
    """Sizes of the discs, as multiples of the distance between samples where not stated otherwise."""

    spread: float = 0.7
    """Standard deviation of a disc; less leaves holes, more blurs."""
    flatness: float = 0.1
    """Standard deviation along the normal."""
    neighbours: int = 10
    """Number of samples of one part and facing from which spacing and edges of the surface are measured."""
    edge: float = 0.3
    """Distance that the surface reaches beyond its outermost samples; discs there are narrow, so that they do
    not protrude."""
    widest: float = 1.0
    """Largest distance to other samples that a disc fills: 1 for even samples, more for random ones, which
    leave gaps."""
    apart: float = 0.5
    """Distance by which discs move outward where a disc of the opposite facing lies in their place: the two
    sides of a sheet without thickness would otherwise both show."""


RANDOM = SurfaceSplatConfig(spread=1.0, widest=2.0, apart=1.0)
"""For samples drawn at random, such as those of PartNet-Mobility objects: closed, and softer."""


def splat_surface(surface: SurfaceSamples, cfg: SurfaceSplatConfig | None = None) -> Gaussians:
    """One opaque disc per sample, in order: at its point (or lifted off it), with its colour and part.

    The third axis of each disc is its thin one and points along the sample's normal, outward.

    Raises:
        ValueError: If there is no sample, or a normal has no direction.
    """
    cfg = cfg or SurfaceSplatConfig()
    if not len(surface.points):
        raise ValueError("discs on a surface: no samples, expected at least 1")
    lengths = np.linalg.norm(surface.normals, axis=1)
    if not (lengths > 0).all():
        raise ValueError(f"discs on a surface: {int((lengths == 0).sum())} normals of length 0")
    quats = _quats_from_normals(surface.normals / lengths[:, None])
    frames = matrix_from_quat(quats)
    reach, turn = np.full((len(quats), 2), np.inf), np.zeros(len(quats))
    distance = np.full(len(quats), np.inf)
    for rows in _group_rows(surface):
        count = min(cfg.neighbours, len(rows) - 1)
        if count < 1:
            continue
        points = surface.points[rows]
        tree = KDTree(points, leafsize=16, balanced_tree=False, compact_nodes=False)
        far, index = (np.asarray(found) for found in tree.query(points, k=count + 1))
        offset = points[index[:, 1:].T] - points  # K M 3
        first, second = (np.einsum("kmc,mc->km", offset, frames[rows, :, axis]) for axis in range(2))
        reach[rows], turn[rows] = _measure_reach(first, second)
        distance[rows] = far[:, -1] * np.sqrt(np.pi / count)
    spacing = float(np.median(distance))
    if not np.isfinite(spacing):
        raise ValueError(
            f"discs on a surface: most of {len(quats)} samples have no other sample of their part that faces "
            "their way; sample the surface more densely"
        )
    usual = np.clip(distance, spacing, cfg.widest * spacing)
    across = np.clip(reach + cfg.edge * spacing, cfg.edge * spacing, usual[:, None])
    lift = cfg.apart * spacing * _find_backed(surface, frames[:, :, 2], cfg.apart * spacing)
    half = turn / 2.0
    about = np.stack([np.cos(half), np.zeros_like(half), np.zeros_like(half), np.sin(half)], axis=1)
    return Gaussians(
        means=surface.points + lift[:, None] * frames[:, :, 2],
        quats=quat_multiply(quats, about),
        scales=cfg.spread * np.column_stack([across, np.full(len(across), cfg.flatness * spacing)]),
        opacities=np.ones(len(across)),
        colors=linear_from_srgb(surface.colors / 255.0),
        part_ids=surface.part_ids,
    )


def thin_samples(surface: SurfaceSamples, most: int) -> SurfaceSamples:
    """Every n-th sample, with the least n that leaves at most ``most``."""
    rows = slice(None, None, max(1, -(-len(surface.points) // most)))
    return SurfaceSamples(**{name: value[rows] for name, value in vars(surface).items()})


def _group_rows(surface: SurfaceSamples) -> list[Int[np.ndarray, "M"]]:
    """Rows of the samples of one part that face the same of six directions, group by group."""
    axis = np.abs(surface.normals).argmax(axis=1)
    ahead = np.take_along_axis(surface.normals, axis[:, None], axis=1)[:, 0] > 0
    groups = surface.part_ids.astype(np.int64) * 6 + 2 * axis + ahead
    order = np.argsort(groups, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(groups[order])) + 1)


def _find_backed(
    surface: SurfaceSamples, normals: Float[np.ndarray, "N 3"], reach: float
) -> Bool[np.ndarray, "N"]:
    """Mask of samples with one of the same part, facing the opposite way, within ``reach`` in height."""
    backed = np.zeros(len(normals), dtype=bool)
    if reach <= 0:
        return backed
    for part in np.unique(surface.part_ids):
        rows = np.flatnonzero(surface.part_ids == part)
        points, facing = surface.points[rows], normals[rows]
        tree = KDTree(points, balanced_tree=False, compact_nodes=False)
        index = np.reshape(np.asarray(tree.query(points, k=min(8, len(rows)))[1]), (len(rows), -1))
        opposite = np.einsum("mc,mkc->mk", facing, facing[index]) < -0.5
        height = np.einsum("mkc,mc->mk", points[index] - points[:, None], facing)
        backed[rows] = (opposite & (np.abs(height) < reach)).any(axis=1)
    return backed


def _measure_reach(
    first: Float[np.ndarray, "K M"], second: Float[np.ndarray, "K M"]
) -> tuple[Float[np.ndarray, "M 2"], Float[np.ndarray, "M"]]:
    """Extent of the surface along each axis of a rotated frame, the lesser of both ways, and the rotation.

    The rotated axes are the principal directions of the neighbours: at the edge of a panel or on a narrow
    strip, they lie across and along it.

    Args:
        first: Positions of the K neighbours along the first axis of each frame.
        second: Positions along the second axis.
    """
    x, y = first - first.mean(axis=0), second - second.mean(axis=0)
    turn = 0.5 * np.arctan2(2.0 * (x * y).mean(axis=0), (x * x).mean(axis=0) - (y * y).mean(axis=0))
    cos, sin = np.cos(turn), np.sin(turn)
    sides = [
        np.minimum(along.max(axis=0), -along.min(axis=0))
        for along in (first * cos + second * sin, second * cos - first * sin)
    ]
    return np.stack(sides, axis=1), turn


def _quats_from_normals(normals: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "N 4"]:
    """The smallest rotations (wxyz) that map +z to unit normals."""
    x, y, z = normals.T
    quats = np.stack([1.0 + z, -y, x, np.zeros_like(x)], axis=1)
    quats[1.0 + z < 1e-6] = [0.0, 1.0, 0.0, 0.0]
    return quats / np.linalg.norm(quats, axis=1, keepdims=True)
