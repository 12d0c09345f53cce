"""L1, collision against visual: same surface, same volume, same cavities (V103)."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from artigen.transforms import inverse, transform_points
from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, at_most
from sim_export.checks.subject import Subject
from sim_export.errors import PackageError
from sim_export.geometry.distances import surface_distances
from sim_export.geometry.grid import (
    Grid,
    fill_solid,
    find_cavity,
    find_outside,
    is_exposed,
    make_grid,
    mark_surface,
)
from sim_export.geometry.hulls import hull_triangles, inside_hulls
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import triangle_areas, triangle_normals

_LEAST_SAMPLES = 64
_DENSER = 4
"""The surface measured to has this many times the samples of the points measured from."""
_SKIN = 1e-3
"""A collision face covered by another hull of the link at this distance (m) is no outer surface."""


_POSES = 9
"""Places along the way of a child at which it is looked into."""
_MANY = 0.2
"""Share of the points beyond a distance from which on a link is named."""
_LEAST_CUBE = 3
"""Least edge (cells) of the cube that makes a cavity; in narrower ones rounding decides."""


@dataclass(frozen=True, kw_only=True)
class Measure:
    """One of the four quantities of V103, as a share of what is allowed (above 1 fails), and the links that
    make it so."""

    ratio: float
    links: tuple[str, ...]
    text: str


def has_both(subject: Subject) -> str:
    """Applies where a link has both visual and collision geometry."""
    both = any(link.visuals and link.collisions for link in subject.links.values())
    return "" if both else "no link has both visual and collision geometry"


def check_likeness(subject: Subject, cfg: CheckConfig) -> Finding:
    """V103: the collision geometry has the surface, the volume and the cavities of the visual."""
    if not subject.diagonal > 0.0:
        raise PackageError("the object's bounding box has no extent")
    links = [name for name, link in subject.links.items() if link.visuals and subject.hull_sets[name].hulls]
    visual = {
        name: np.concatenate([s.triangles for s in subject.visuals if s.link == name]) for name in links
    }
    solid = {name: hull_triangles(subject.hull_sets[name].hulls) for name in links}
    grid = make_grid(subject.bounds, cfg.grid_resolution)
    volumes = [_link_volumes(subject, grid, visual[name], solid[name]) for name in links]
    measures = _distances(subject, cfg, visual, solid, dict(zip(links, volumes, strict=True)))
    if subject.has_own_visuals:
        measures.append(_volume_overlap(cfg, grid, volumes))
    cavities = [
        measure
        for name, volume in zip(links, volumes, strict=True)
        if subject.labels.get(name) != "wheel"  # one cylinder, so that it rolls
        for measure in _kept_cavity(cfg, grid, name, volume)
    ]
    beyond = {link for one in (*measures, *cavities) if one.ratio > 1.0 for link in one.links}
    if cavities:
        measures.append(max(cavities, key=lambda measure: measure.ratio))
    worst = max(measures, key=lambda measure: measure.ratio)
    message, where = "; ".join(measure.text for measure in measures), ", ".join(worst.links)
    return at_most(worst.ratio, 1.0, "of the allowed", where=where, message=message, links=beyond)


def _distances(
    subject: Subject,
    cfg: CheckConfig,
    visual: dict[str, np.ndarray],
    solid: dict[str, np.ndarray],
    volumes: dict[str, "Volumes"],
) -> list[Measure]:
    """Two-sided distances of the surfaces, link by link, so that one link cannot stand in for another.

    Only surface counts that can be reached from outside of what the link shows, and that neither a child nor
    what carries it holds inside wherever that moves: what is in a button nothing else can touch.
    """
    areas = {name: triangle_areas(visual[name]).sum() + triangle_areas(solid[name]).sum() for name in visual}
    total = sum(areas.values())
    forth, back = {}, {}
    for name in visual:
        count = int(np.ceil(cfg.surface_samples * areas[name] / total)) + _LEAST_SAMPLES
        hulls = subject.hull_sets[name].hulls
        outside = volumes[name].outside
        seen, face = sample_triangles(visual[name], count)
        normals = triangle_normals(visual[name])[face]
        shown = is_exposed(seen, normals, *outside) | is_exposed(seen, -normals, *outside)
        seen = seen[shown]
        seen = seen[~_find_held(subject, name, seen)]
        free = seen[~inside_hulls(seen, hulls)]
        forth[name] = np.zeros(len(seen))
        forth[name][: len(free)] = surface_distances(free, solid[name], _DENSER * count)
        felt, face = sample_triangles(solid[name], count)
        normals = triangle_normals(solid[name])[face]
        touched = ~inside_hulls(felt + _SKIN * normals, hulls) & is_exposed(felt, normals, *outside)
        outer = felt[touched]
        back[name] = surface_distances(outer, visual[name], _DENSER * count)
    worst = {name: max(np.max(forth[name], initial=0.0), np.max(back[name], initial=0.0)) for name in visual}
    farthest, size = float(max(worst.values())), max(subject.diagonal, cfg.least_diagonal)
    of = "the diagonal" if size == subject.diagonal else f"{size:g} m"
    far = [name for name in worst if worst[name] >= min(farthest, cfg.max_hausdorff * size)]
    p99, way = max(
        ((float(np.percentile(np.concatenate(list(d.values())), 99)), d) for d in (forth, back)),
        key=lambda pair: pair[0],
    )
    beyond = {name: int((found >= min(p99, cfg.max_p99 * size)).sum()) for name, found in way.items()}
    many = [name for name in beyond if beyond[name] >= _MANY * sum(beyond.values())]
    return [
        Measure(
            ratio=farthest / (cfg.max_hausdorff * size),
            links=tuple(far),
            text=f"surfaces differ by at most {100 * farthest / size:.2g} % of {of} "
            f"(allowed {100 * cfg.max_hausdorff:g} %)",
        ),
        Measure(
            ratio=p99 / (cfg.max_p99 * size),
            links=tuple(many),
            text=f"99 % of them by less than {100 * p99 / size:.2g} % (allowed {100 * cfg.max_p99:g} %)",
        ),
    ]


def _find_held(subject: Subject, link: str, points: Float[np.ndarray, "N 3"]) -> Bool[np.ndarray, "N"]:
    """Points of a link (object frame at rest) that are in the hulls of a child of it, or of what carries it,
    all along the way: of a button, a pin in its bore, a ball in its socket."""
    held = np.zeros(len(points), dtype=bool)
    for joint in subject.driven:
        if link not in (joint.parent, joint.child):
            continue
        around = joint.child if link == joint.parent else joint.parent
        T = subject.displacements({joint.name: np.linspace(joint.lower, joint.upper, _POSES)})
        rows = np.flatnonzero(~held)
        for pose in np.broadcast_to(inverse(T[around]) @ T[link], (_POSES, 4, 4)):
            rows = rows[inside_hulls(transform_points(pose, points[rows]), subject.hull_sets[around].hulls)]
        held[rows] = True
    return held


@dataclass(frozen=True, kw_only=True, eq=False)
class Volumes:
    """Cells of one link that its visual and its hulls fill, in a window of the grid.

    ``outside`` holds the cells that a path from outside reaches without crossing the visual, and the grid of
    the window.
    """

    window: tuple[slice, slice, slice]
    visual: np.ndarray
    solid: np.ndarray
    outside: tuple[np.ndarray, Grid]


def _link_volumes(subject: Subject, grid: Grid, visual: np.ndarray, solid: np.ndarray) -> Volumes:
    corners = np.concatenate([visual, solid]).reshape(-1, 3)
    low = np.maximum(grid.cells_of(corners.min(axis=0)[None])[0] - 1, 0)
    high = np.minimum(grid.cells_of(corners.max(axis=0)[None])[0] + 2, grid.shape)
    size = high - low
    part = Grid(
        low=grid.low + low * grid.cell, cell=grid.cell, shape=(int(size[0]), int(size[1]), int(size[2]))
    )
    closed = subject.has_own_visuals
    seen = fill_solid(visual, part) if closed else mark_surface(visual, part)
    return Volumes(
        window=(slice(low[0], high[0]), slice(low[1], high[1]), slice(low[2], high[2])),
        visual=seen,
        solid=fill_solid(solid, part),
        outside=(find_outside(seen), part),
    )


def _volume_overlap(cfg: CheckConfig, grid: Grid, volumes: list[Volumes]) -> Measure:
    visual, solid = np.zeros((2, *grid.shape), dtype=bool)
    for volume in volumes:
        visual[volume.window] |= volume.visual
        solid[volume.window] |= volume.solid
    union = np.count_nonzero(visual | solid)
    iou = np.count_nonzero(visual & solid) / union if union else 0.0
    return Measure(
        ratio=(1.0 - iou) / (1.0 - cfg.min_iou),
        links=(),
        text=f"volumes overlap by {iou:.3f} of their union (at least {cfg.min_iou:g})",
    )


def _kept_cavity(cfg: CheckConfig, grid: Grid, name: str, volume: Volumes) -> list[Measure]:
    """Share of a link's cavities that its hulls leave free; nothing for a link without one."""
    longest = max(grid.shape) * grid.cell
    side = max(_LEAST_CUBE, round(min(cfg.cavity_cube, cfg.cavity_cube_ratio * longest) / grid.cell))
    cavity = find_cavity(volume.visual, side)
    cells = int(np.count_nonzero(cavity))
    if not cells:
        return []
    kept = 1.0 - np.count_nonzero(cavity & volume.solid) / cells
    litres = 1e3 * cells * grid.cell**3
    return [
        Measure(
            ratio=(1.0 - kept) / (1.0 - cfg.min_free_kept),
            links=(name,),
            text=f"{100 * kept:.3g} % of the {litres:.3g} litres inside {name!r} stay free "
            f"(at least {100 * cfg.min_free_kept:g} %)",
        )
    ]


LIKENESS_CHECKS = (
    CheckSpec(id="V103", level="L1", title="collision is visual", applies=has_both, function=check_likeness),
)
