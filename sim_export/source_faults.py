"""Failed checks of a conversion that the source object fails as well.

V107, V203 and V204 are measured again on the source's meshes and joints. For V201, V202 and V308, evidence is
a point of one link's surface inside a closed surface of another, or an edge that pierces another surface, at
rest or along the joints. A failure of V103 counts as the source's if links overlap by more than V103 allows
hulls to be off the surface.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from artigen.types import Joint
from sim_export.checks.config import CheckConfig
from sim_export.checks.draft import read_draft
from sim_export.checks.suite import run_checks
from sim_export.collision.cover.free_space import FreeSpace, find_free_space, find_inside
from sim_export.geometry.hulls import wrap_surface
from sim_export.geometry.islands import visual_islands
from sim_export.geometry.piercing import PiercedSurface, find_edges, piercing_depth
from sim_export.geometry.rows import all_three
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import diagonal_of
from sim_export.motion.kinematics import (
    driven_joints,
    link_displacements,
    moved_links,
    required_openings,
    sweep_coordinates,
)
from sim_export.motion.requirements import POSES
from sim_export.package import SimPackage

SAMPLES = 4000
"""Number of points on the surface of each link."""
NOTHING = np.zeros((0, 3, 3))
Surfaces = Mapping[str, Float[np.ndarray, "F 3 3"]]


def find_source_faults(package: SimPackage, surfaces: Surfaces, failed: Collection[str]) -> dict[str, str]:
    """The evidence, one sentence, for each failed check that the source fails as well.

    Args:
        package: The object with its own meshes as visuals.
        surfaces: Triangles of the visuals by link (m, object frame at rest).
    """
    cfg = CheckConfig()
    out = {}
    if {"V203", "V204"} & set(failed):
        around = tuple(
            replace(link, hulls=wrap_surface(surfaces.get(link.name, NOTHING))) for link in package.links
        )
        draft = read_draft(replace(package, links=around))
        found = {check.id: check for check in run_checks(draft, cfg=cfg, only=("V203", "V204"))}
        for name in ("V203", "V204"):
            if name in failed and found[name].verdict == "fail":
                out[name] = f"as in the source, by its own meshes: {found[name].message}"
    if "V107" in failed:
        out |= _farthest_island(surfaces, cfg.max_island)
    if not {"V103", "V201", "V202", "V308"} & set(failed):
        return out
    shown = show_links(surfaces)
    at_rest = max(overlaps_at_rest(shown), default=(0.0, ""))
    for name in ("V202", "V308"):
        if name in failed:
            out |= _explain(name, at_rest, cfg.max_rest_overlap_parent)
    if {"V103", "V201"} & set(failed):
        on_the_way = max(overlaps_on_the_way(package, shown), default=(0.0, ""))
        if "V201" in failed:
            out |= _explain("V201", on_the_way, cfg.max_penetration)
        if "V103" in failed:  # hulls of one of two links that overlap this much must shrink
            out |= _explain("V103", max(at_rest, on_the_way), cfg.max_hausdorff * surfaces_diagonal(surfaces))
    return out


def _farthest_island(surfaces: Surfaces, reach: float) -> dict[str, str]:
    """The visible piece that is farthest from the rest of its link, if it is too far."""
    found = [(gap, name) for name, surface in surfaces.items() for gap, _ in visual_islands(surface, reach)]
    gap, name = max(found, default=(0.0, ""))
    if not found:
        return {}
    return {"V107": f"as in the source: a piece of {name} is {1000 * gap:.0f} mm from the rest of it"}


def surfaces_diagonal(surfaces: Surfaces) -> float:
    """Diagonal (m) of the box around all surfaces."""
    corners = np.concatenate([triangles.reshape(-1, 3) for triangles in surfaces.values()])
    return diagonal_of(corners)


def _explain(check: str, found: tuple[float, str], least: float) -> dict[str, str]:
    """An overlap in words, if it is deeper than a check allows."""
    depth, where = found
    return {check: f"as in the source: {where}, {1000 * depth:.0f} mm deep"} if depth > least else {}


@dataclass(frozen=True, kw_only=True, eq=False)
class Shown:
    """A link's surface in an object of a ``diagonal`` (m): its triangles, sample points, edges, and triangles
    for intersection tests."""

    triangles: Float[np.ndarray, "F 3 3"]
    diagonal: float
    points: Float[np.ndarray, "N 3"]
    edges: Float[np.ndarray, "E 2 3"]
    surface: PiercedSurface

    @cached_property
    def space(self) -> FreeSpace:
        """What the surface encloses."""
        return find_free_space(self.triangles, self.diagonal)

    def entered(self, other: "Shown", T: Float[np.ndarray, "4 4"]) -> tuple[float, str]:
        """Depth (m) to which another surface, moved by ``T``, is inside or pierces this one, and the kind."""
        box = transform_points(
            T, np.array(list(product(*zip(other.surface.low, other.surface.high, strict=True))))
        )
        if (box.max(axis=0) < self.surface.low).any() or (box.min(axis=0) > self.surface.high).any():
            return 0.0, "lies inside"
        points = transform_points(T, other.points)
        points = points[all_three((points >= self.surface.low) & (points <= self.surface.high))]
        inside = float(find_inside(points, self.space).max()) if len(points) else 0.0
        pierced = piercing_depth((self.surface, self.edges), (other.surface, other.edges), T)
        return (inside, "lies inside") if inside >= pierced else (pierced, "pierces")


def show_links(
    surfaces: Surfaces, known: "tuple[Surfaces, Mapping[str, Shown]] | None" = None
) -> dict[str, Shown]:
    """The surfaces of all links that have one.

    Args:
        surfaces: Triangles (m) by link.
        known: Such triangles and what was made of them; used where they are the same in an object of the same
            size.
    """
    shown = {name: triangles for name, triangles in surfaces.items() if len(triangles)}
    diagonal = surfaces_diagonal(shown)
    before, made = known or ({}, {})
    same = bool(before) and surfaces_diagonal(before) == diagonal
    return {
        name: made[name]
        if same and name in made and np.array_equal(before[name], triangles)
        else Shown(
            triangles=triangles,
            diagonal=diagonal,
            points=sample_triangles(triangles, SAMPLES)[0],
            edges=find_edges(triangles),
            surface=PiercedSurface(triangles),
        )
        for name, triangles in shown.items()
    }


def overlaps_at_rest(shown: Mapping[str, Shown]) -> Iterator[tuple[float, str]]:
    """Depth (m) to which one link's surface is inside or pierces another's at rest, with a description."""
    for name, link in shown.items():
        for other in shown.keys() - {name}:
            depth, how = link.entered(shown[other], np.eye(4))
            yield depth, f"the surface of {other} {how} {name}"


def overlaps_on_the_way(package: SimPackage, shown: Mapping[str, Shown]) -> Iterator[tuple[float, str]]:
    """The same along every joint, minus the depth at rest."""
    for joint in driven_joints(package.joints):
        opened = required_openings(joint, package.joints, package.requires_open)
        moved = {package.links[index].name for index in moved_links(package.links, package.joints, joint)}
        for name in shown:
            for other in (o for o in shown if (o in moved) != (name in moved)):
                depths = overlap_along(package, shown, joint, (name, other), opened)
                yield float(depths.max() - depths[0]), f"{other} enters {name} along {joint.name}"


def overlap_along(
    package: SimPackage,
    shown: Mapping[str, Shown],
    joint: Joint,
    pair: tuple[str, str],
    opened: Mapping[str, float],
) -> Float[np.ndarray, "P"]:
    """Depth (m) of the second link of a pair in the first at `POSES` positions of a joint."""
    slot = {link.name: index for index, link in enumerate(package.links)}
    T = link_displacements(
        package.links, package.joints, {**opened, joint.name: sweep_coordinates(joint, POSES)}
    )
    relative = inverse(T[:, slot[pair[0]]]) @ T[:, slot[pair[1]]]
    return np.array([shown[pair[0]].entered(shown[pair[1]], pose)[0] for pose in relative])
