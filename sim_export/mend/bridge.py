"""A piece that floats beside the rest of its link is held by a post."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import frame_along
from artigen.types import SurfaceSamples
from sim_export.checks.config import CheckConfig
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.islands import find_surface_islands, nearest_points, surface_shape
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import triangle_normals
from sim_export.mend.source import Source, leading_part

LONGEST = 0.1
"""Longest post (m); a piece farther away is not what this link should hold, or is a link of its own."""
WIDTH = 0.006
"""Edge (m) of a post's square cross-section, and how far it stands in what it connects."""
POST_COLOR = (140, 140, 140)
SAMPLES = 500
"""Points on a post, which voxels and colours are made of."""


def bridge_islands(source: Source, cfg: CheckConfig) -> Source:
    """Adds a post between nearest points for every piece that V107 finds afloat, the nearest piece first."""
    for name, triangles in source.links.items():
        joined, islands = find_surface_islands(triangles, cfg.max_island)
        part = leading_part(source, name)
        for island in islands:
            gap, ends = nearest_points(surface_shape(island.triangles), surface_shape(joined))
            joined = np.concatenate([joined, island.triangles])
            if cfg.max_island < gap <= LONGEST:
                source = _add_post(source, part, make_post(ends), gap)
    return source


def make_post(ends: Float[np.ndarray, "2 3"]) -> Float[np.ndarray, "12 3 3"]:
    """Triangles of a box around the line between two points (m)."""
    way = ends[1] - ends[0]
    length = float(np.linalg.norm(way))
    half = np.array([WIDTH / 2, WIDTH / 2, length / 2 + WIDTH])
    box = box_hull(-half, half)
    return (ends.mean(axis=0) + box.vertices @ frame_along(way / length))[box.faces]


def _add_post(source: Source, part: int, post: Float[np.ndarray, "12 3 3"], gap: float) -> Source:
    asset, name = source.asset, source.asset.parts[part].name
    surface = asset.surface
    if surface is not None:
        points, face = sample_triangles(post, SAMPLES)
        added = SurfaceSamples(
            points=points / asset.scale,
            normals=triangle_normals(post)[face],
            colors=np.tile(np.array(POST_COLOR, dtype=np.uint8), (len(points), 1)),
            part_ids=np.full(len(points), part),
        )
        fields = vars(surface)
        surface = SurfaceSamples(**{key: np.concatenate([fields[key], vars(added)[key]]) for key in fields})
    surfaces = list(source.surfaces)
    surfaces[part] = np.concatenate([surfaces[part], post])
    return replace(
        source,
        asset=replace(asset, surface=surface),
        surfaces=tuple(surfaces),
        posts=(*source.posts, (part, post)),
        records=(*source.records, f"{name}: a post holds a piece that floated {1e3 * gap:.1f} mm beside it"),
    )
