"""Instantiation distance between articulated objects, over the poses that they can take.

After NAP (``eval/instantiation_distance.py``): both objects are posed at random several times, and every
pose is compared with the nearest pose of the other object. NAP also tries every part as the frame of
reference; here all objects share one frame (front to -x, base at rest), so this is not needed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from artigen.kinematics import articulate_points, qlimits
from artigen.metrics.clouds import sample_cells
from artigen.types import Asset


@dataclass(frozen=True, kw_only=True)
class InstantiationConfig:
    """Density of the comparison; NAP uses 10 poses of 2,048 points."""

    poses: int = 4
    """Random poses of each object."""
    points: int = 512
    """Points in each pose."""
    seed: int = 0
    """Seed of poses and points; equal objects get equal poses."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PosedObject:
    """An object in its random poses, unit-cube lengths, with a search tree for each."""

    points: Float[np.ndarray, "K N 3"]
    trees: tuple[KDTree, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class PosedSet:
    """Posed objects and their instantiation distances from each other."""

    objects: tuple[PosedObject, ...]
    distances: Float[np.ndarray, "R R"]


def pose_object(asset: Asset, cfg: InstantiationConfig) -> PosedObject:
    """Poses an object: every joint at a uniform share of its range, independently."""
    rng = np.random.default_rng(cfg.seed)
    cloud = sample_cells(asset, cfg.points, cfg.seed)
    upper = qlimits(asset)[:, 1]
    points = np.stack(
        [
            articulate_points(asset, rng.random(len(upper)) * upper, cloud.points, cloud.part_ids)
            for _ in range(cfg.poses)
        ]
    )
    return PosedObject(points=points, trees=tuple(KDTree(pose) for pose in points))


def instantiation_distance(first: PosedObject, second: PosedObject) -> float:
    """Mean over poses of the first of the nearest pose of the second, plus the same back.

    Poses are compared by `artigen.metrics.clouds`: squared unit-cube lengths.
    """
    there = _mean_squares(first.points, second.trees)  # K L
    back = _mean_squares(second.points, first.trees).T
    chamfers = there + back
    return float(chamfers.min(axis=1).mean() + chamfers.min(axis=0).mean())


def pairwise_distances(
    first: Sequence[PosedObject], second: Sequence[PosedObject]
) -> Float[np.ndarray, "G R"]:
    """Instantiation distances of all pairs; each is computed once if both arguments are the same list."""
    out = np.zeros((len(first), len(second)))
    for row, one in enumerate(first):
        for column, other in enumerate(second):
            if first is second and column <= row:
                out[row, column] = out[column, row]
            else:
                out[row, column] = instantiation_distance(one, other)
    return out


def pose_set(assets: Sequence[Asset], cfg: InstantiationConfig) -> PosedSet:
    """Poses objects and measures their pairwise distances, once for all comparisons with them."""
    objects = tuple(pose_object(asset, cfg) for asset in assets)
    return PosedSet(objects=objects, distances=pairwise_distances(objects, objects))


def _mean_squares(points: Float[np.ndarray, "K N 3"], trees: tuple[KDTree, ...]) -> np.ndarray:
    """Mean squared distance of every pose to every tree's points, ``[K, trees]``."""
    flat = points.reshape(-1, 3)
    found = [tree.query(flat)[0].reshape(len(points), -1) for tree in trees]
    return np.stack([(distance**2).mean(axis=1) for distance in found], axis=1)
