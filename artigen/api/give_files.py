"""Gives mesh files that lie far from the rest of their link to the link that they touch.

Annotators of real objects name some files wrongly: slivers of a table's legs as the bottom of its drawer.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from jaxtyping import Float, Int

from artigen.datasets.source_object import SourceObject
from artigen.types import SurfaceSamples

FAR = 0.05
"""Distance (m) from the rest of its link above which a file that touches another link belongs to that one.
Fronts and handles that float before their drawer are nearer; posts hold them (`sim_export.mend.bridge`)."""
SMALL = 0.1
"""Most of the area of its link that such files may be; the second leaf of a door is no error."""
TOUCHING = 1e-3
"""Distance (m) at which a file touches another link."""
ON = 1e-4
"""Distance (unit cube) at which a sample lies on a file; the rest of its part is much farther away."""
SAMPLES = 2000
"""Points by which triangles near a sample are found."""


@dataclass(frozen=True, kw_only=True)
class Gift:
    """Files of one part that belong to another part, and their distance (m) from the rest of their link."""

    files: tuple[int, ...]
    giver: int
    taker: int
    gap: float


def give_files(source: SourceObject) -> SourceObject:
    """The object with misplaced mesh files moved to the links they touch, each noted."""
    for gift in find_gifts(source):
        source = _give(source, gift)
    return source


def find_gifts(source: SourceObject) -> list[Gift]:
    """Small mesh files of moving links farther than `FAR` from the largest one, and the link they touch."""
    from sim_export.geometry.islands import find_islands, join_near, nearest_points, surface_shape
    from sim_export.geometry.triangles import triangle_areas
    from sim_export.physics.links import link_owners

    corners = [source.asset.scale * table.corners for table in source.tables]
    leader = np.array(link_owners(source.asset))
    links = leader[[visual.part for visual in source.visuals]] if corners else np.zeros(0, dtype=int)

    @cache
    def shape(*files: int) -> object:
        return surface_shape(np.concatenate([corners[file] for file in files]))

    def distance(some: Int[np.ndarray, "N"], others: Int[np.ndarray, "M"]) -> float:
        return nearest_points(shape(*some.tolist()), shape(*others.tolist()))[0]

    gifts = []
    for link in np.unique(links[links != leader[source.asset.root]]).tolist():
        own = np.flatnonzero(links == link)
        counts = [len(corners[file]) for file in own]
        joined = join_near(
            np.concatenate([corners[file] for file in own]), np.repeat(np.arange(len(own)), counts), FAR
        )[np.cumsum([0, *counts])[:-1]]
        groups = [own[joined == number] for number in np.unique(joined)]
        if len(groups) == 1:  # as nearly always, and quick to tell
            continue
        surfaces = [np.concatenate([corners[file] for file in group]) for group in groups]
        areas = np.array([float(triangle_areas(surface).sum()) for surface in surfaces])
        bounds = np.array([[s.min(axis=(0, 1)), s.max(axis=(0, 1))] for s in surfaces])
        islands = find_islands(
            bounds, lambda one, other, groups=groups: distance(groups[one], groups[other]), areas, FAR
        )
        for island in islands:
            if areas[island.members].sum() > SMALL * areas.sum():
                continue
            files = np.concatenate([groups[member] for member in island.members])
            for other in np.unique(links[links != link]).tolist():
                if distance(files, np.flatnonzero(links == other)) <= TOUCHING:
                    gifts.append(Gift(files=tuple(files.tolist()), giver=link, taker=other, gap=island.gap))
                    break
    return gifts


def _give(source: SourceObject, gift: Gift) -> SourceObject:
    """The object with the files of one gift at the part that takes them."""
    asset, ends = source.asset, np.cumsum([0, *(len(table.faces) for table in source.tables)])
    faces = np.concatenate([np.arange(ends[file], ends[file + 1]) for file in gift.files])
    losers = np.unique(source.triangles.part_ids[faces])
    part_ids = np.array(source.triangles.part_ids)
    part_ids[faces] = gift.taker
    parts = list(asset.parts)
    corners = np.concatenate([table.corners for table in source.tables])
    for part in (*losers.tolist(), gift.taker):
        own = corners[part_ids == part].reshape(-1, 3)
        if len(own):
            low, high = own.min(axis=0), own.max(axis=0)
            parts[part] = replace(parts[part], box=np.stack([(low + high) / 2, high - low]))
    note = (
        f"mend give (V107): {', '.join(source.visuals[file].path.name for file in gift.files)}, "
        f"{1e3 * gift.gap:.0f} mm from the rest of {parts[gift.giver].name}, became part of "
        f"{parts[gift.taker].name}"
    )
    return replace(
        source,
        asset=replace(
            asset,
            parts=tuple(parts),
            surface=asset.surface and _give_samples(asset.surface, corners[faces], losers, gift.taker),
            notes=(*asset.notes, note),
        ),
        visuals=tuple(
            replace(visual, part=gift.taker) if index in gift.files else visual
            for index, visual in enumerate(source.visuals)
        ),
        triangles=replace(source.triangles, part_ids=part_ids),
    )


def _give_samples(
    surface: SurfaceSamples, triangles: Float[np.ndarray, "F 3 3"], losers: Int[np.ndarray, "L"], taker: int
) -> SurfaceSamples:
    """Samples with those of the parts ``losers`` on some triangles (unit cube) given to ``taker``."""
    from sim_export.geometry.distances import surface_distances

    ids = np.array(surface.part_ids)
    asked = np.flatnonzero(np.isin(ids, losers))
    on = surface_distances(surface.points[asked], triangles, SAMPLES) < ON
    ids[asked[on]] = taker
    return replace(surface, part_ids=ids)
