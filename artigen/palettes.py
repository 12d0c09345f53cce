"""Palettes: the colours of each part of an object as a few numbers.

Two colours say most about a part of furniture: a carcass and its lining, a pane and its frame, a handle.
`artigen.models.palette_flow` draws them for all parts at once, before the flow of structured latents puts
them where they belong.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.facings import AROUND, FACINGS, SIDES, find_covered, find_joined, find_middles
from artigen.fields import DEFAULT_LAYOUT, after_occupancy, name_rows
from artigen.types import PART_LABELS, PartLabel, SurfaceSamples

PALETTE = 7
"""Numbers per part: the colour of most of its outside, the other one, and the share of the other."""
PAINT = 3 * SIDES + 1
"""Numbers of a painted voxel: the colours of its outer and its inner side, and how clear it is."""
KIND = FACINGS + len(PART_LABELS) + SIDES + AROUND
"""Numbers that say what kind of voxel one is."""
FRONTS: tuple[PartLabel, ...] = ("drawer", "door")
"""Parts that have the colour of the object, where they are not said to have another."""
MATCHING: tuple[PartLabel, ...] = (*FRONTS, "handle", "shelf")
"""Parts that have the colours of all others of their label, whatever their sizes."""
SAME_SIZE = 1 / 64
"""Unit-cube length by which the edges of two parts may differ that are of one kind."""
MOST = 2000
"""Samples of a part that are looked at."""
THIN = 5 / 64
"""Share of the longest edge of an object up to which a part counts as thin along an axis."""
ALIKE = 1.0
"""Root mean square distance to the mean (steps of 8 bits) up to which all samples have one colour."""


def read_palettes(surface: SurfaceSamples, parts: int) -> Float[np.ndarray, "P 7"]:
    """Two colours (sRGB in [0, 1]) of each part and the share of its area that has the second.

    The first is that of most of the outside (`find_outside`): of a fridge its paint, not its lining. A part
    of one colour has it twice, with a share of 0; one without samples has the whole object's.

    Args:
        surface: Coloured samples, each standing for the same area.
        parts: How many parts there are.

    Raises:
        ValueError: If there is no sample at all.
    """
    if not len(surface.points):
        raise ValueError("a surface without samples has no colours, expected at least one")
    out, outside = np.zeros((parts, PALETTE)), find_outside(surface)
    for part in range(parts):
        own = surface.part_ids == part
        own = own if own.any() else np.ones_like(own)
        out[part] = _read_palette(surface.colors[own], outside[own])
    return out


def find_outside(surface: SurfaceSamples) -> Bool[np.ndarray, "N"]:
    """Which samples lie on the outside of their part: they face away from its middle, or from the object's
    where the part is thin, as in `artigen.facings`."""
    every = np.arange(len(surface.points))
    axis = np.abs(surface.normals).argmax(axis=1)
    thin = THIN * float(np.ptp(surface.points, axis=0).max())
    middle = find_middles(surface.points, surface.part_ids, thin)
    away = surface.points[every, axis] - middle[every, axis]
    return np.asarray(surface.normals[every, axis] * away > 0)


def ask_colors(
    labels: Sequence[PartLabel], colors: Mapping[PartLabel, Sequence[float]]
) -> Float[np.ndarray, "P 7"]:
    """Palettes of parts of which some colours are asked for; NaN is left open.

    A colour is the main one of its parts. That of the base is the object's: fronts share it, unless they have
    one of their own.

    Args:
        labels: Of the parts.
        colors: sRGB in [0, 1] by label.
    """
    out = np.full((len(labels), PALETTE), np.nan)
    for row, label in zip(out, labels, strict=True):
        color = colors.get(label, colors.get("base") if label in FRONTS else None)
        if color is not None:
            row[:3] = color
    return out


def find_twins(table: Float[np.ndarray, "P C"]) -> Int[np.ndarray, "P"]:
    """For each part the first one that has the same colours: doors match doors, and one button the next.

    Of 84 procedural objects, no two doors, drawers, handles or shelves of one differ in their main colour.
    Other parts match those of their label that are as large.

    Args:
        table: Channels after occupancy of each part, in the default layout.
    """
    sizes = np.sort(table[:, after_occupancy(DEFAULT_LAYOUT.box)][:, 3:], axis=1)
    labels = np.array(name_rows(table))
    alike = (labels[:, None] == labels) & (
        np.isin(labels, MATCHING) | (np.abs(sizes[:, None] - sizes).max(axis=2) <= SAME_SIZE)
    )
    return alike.argmax(axis=1)


def describe_kinds(
    table: Float[np.ndarray, "P C"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    covered: Bool[np.ndarray, "N 2"],
    joined: Bool[np.ndarray, "N 2 2"],
) -> Float[np.ndarray, "N 20"]:
    """What kind of voxel each is (float32).

    Which way its outer side faces (one of 6), the label of its part, whether something stands before its
    outer side and its inner one, and whether its part goes on around it.

    Args:
        table: Channels after occupancy of each part, in the default layout.
        part_ids: Part of each voxel.
        facings: Direction of each voxel's outer side.
        covered: Whether something stands before either side (`artigen.facings.find_covered`).
        joined: Whether the part goes on across them (`artigen.facings.find_joined`).
    """
    labels = table[:, after_occupancy(DEFAULT_LAYOUT.label)]
    told = (np.eye(FACINGS)[facings], labels[part_ids], covered, joined.reshape(len(joined), AROUND))
    return np.concatenate(told, axis=1).astype(np.float32)


def read_kinds(
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    table: Float[np.ndarray, "P C"],
    resolution: int,
) -> Float[np.ndarray, "N 20"]:
    """What kind of voxel each of an object is (`describe_kinds`), read off the voxels alone.

    Args:
        coords: Cells (x, y, z) of the grid.
        part_ids: Part of each.
        facings: Directions of their outer sides.
        table: Channels after occupancy of each part, in the default layout.
        resolution: Edge of the grid.
    """
    covered = find_covered(coords, facings, resolution)
    joined = find_joined(coords, part_ids, facings, resolution)
    return describe_kinds(table, part_ids, facings, covered, joined)


def describe_voxels(
    kinds: Float[np.ndarray, "N 20"],
    places: Float[np.ndarray, "N 6"],
    paint: Float[np.ndarray, "N 7"],
) -> Float[np.ndarray, "N A"]:
    """What the flow of structured latents is told of every voxel (float32).

    Args:
        kinds: Of the voxels (`describe_kinds`).
        places: Where their surface lies (`artigen.places.describe_places`).
        paint: Colours of both sides of each voxel, and how clear it is (`artigen.models.painter`).
    """
    return np.concatenate([kinds, places, paint], axis=1).astype(np.float32)


def _read_palette(colors: np.ndarray, outside: Bool[np.ndarray, "N"]) -> Float[np.ndarray, "7"]:
    from sklearn.cluster import KMeans  # takes seconds to load, and drawing does not need it

    step = -(-len(colors) // MOST)
    few, outer = colors[::step].astype(float), outside[::step]
    mean = few.mean(axis=0)
    if np.sqrt(((few - mean) ** 2).sum(axis=1).mean()) <= ALIKE:
        return np.concatenate([mean / 255.0, mean / 255.0, [0.0]])
    second = KMeans(n_clusters=2, random_state=0).fit_predict(few) == 1
    shown = second[outer] if outer.any() else second
    if shown.mean() > 0.5:
        second = ~second
    means = [few[~second].mean(axis=0), few[second].mean(axis=0)]
    return np.concatenate([*means, [255.0 * second.mean()]]) / 255.0
