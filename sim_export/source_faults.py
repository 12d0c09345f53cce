"""Failed checks of a conversion that the source object fails as well.

V203 and V204 are measured again on the source's own meshes and joints. For V201 and V202 points of one link's
surface are looked for inside of closed surfaces of the other, at rest and along the joints.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from sim_export.checks.config import CheckConfig
from sim_export.checks.suite import run_checks
from sim_export.collision.free_space import FreeSpace, find_free_space, find_inside
from sim_export.collision.hulls import convex_hull
from sim_export.collision.motion import driven_joints, link_displacements, moved_links
from sim_export.collision.requirements import required_openings, sweep_coordinates
from sim_export.errors import DegeneratePart
from sim_export.files.write import write_package
from sim_export.geometry.sampling import sample_triangles
from sim_export.package import Hull, SimPackage

SAMPLES = 4000
"""Points on the surface of each link."""
POSES = 21
"""Poses of every joint."""
Surfaces = Mapping[str, Float[np.ndarray, "F 3 3"]]


def find_source_faults(
    package: SimPackage, surfaces: Surfaces, failed: Collection[str], cfg: CheckConfig | None = None
) -> dict[str, str]:
    """For each failed check that the source fails, too, one sentence with the evidence.

    Args:
        package: The object with its own meshes as visuals.
        surfaces: Triangles of these, by link (m, object frame at rest).
        failed: Ids of the checks.
        cfg: Thresholds of the checks.
    """
    cfg = cfg or CheckConfig()
    out = {}
    if {"V203", "V204"} & set(failed):
        around = tuple(replace(link, hulls=_wrap(surfaces.get(link.name))) for link in package.links)
        with TemporaryDirectory() as scratch:
            folder = write_package(replace(package, links=around), Path(scratch) / package.name)
            found = {check.id: check for check in run_checks(folder, ("L2",), cfg)}
        for name in ("V203", "V204"):
            if name in failed and found[name].verdict == "fail":
                out[name] = f"as in the source, by its own meshes: {found[name].message}"
    if "V202" in failed:
        out |= _deepest("V202", _overlaps_at_rest(surfaces), cfg.max_rest_overlap_parent)
    if "V201" in failed:
        out |= _deepest("V201", _overlaps_on_the_way(package, surfaces), cfg.max_penetration)
    return out


def _wrap(triangles: Float[np.ndarray, "F 3 3"] | None) -> tuple[Hull, ...]:
    """One convex hull of triangles, if they span a volume."""
    if triangles is None or not len(triangles):
        return ()
    try:
        return (convex_hull(triangles.reshape(-1, 3)),)
    except DegeneratePart:
        return ()


def _deepest(check: str, found: Iterator[tuple[float, str]], least: float) -> dict[str, str]:
    """The deepest overlap, where it is deeper than a check allows."""
    depth, where = max(found, default=(0.0, ""))
    if depth <= least:
        return {}
    return {check: f"as in the source: {where}, {1000 * depth:.0f} mm deep"}


def _overlaps_at_rest(surfaces: Surfaces) -> Iterator[tuple[float, str]]:
    """Depth (m) to which points of one link lie within closed surfaces of another, and which."""
    points, spaces = _prepare(surfaces)
    for name, inside in spaces.items():
        for other in points.keys() - {name}:
            depth = float(find_inside(points[other], inside).max(initial=0.0))
            yield depth, f"the surface of {other} lies inside {name}"


def _overlaps_on_the_way(package: SimPackage, surfaces: Surfaces) -> Iterator[tuple[float, str]]:
    """The same along every joint, less what it is at rest."""
    points, spaces = _prepare(surfaces)
    slot = {link.name: index for index, link in enumerate(package.links)}
    for joint in driven_joints(package.joints):
        opened = required_openings(joint, package.joints, package.requires_open)
        q = sweep_coordinates(joint, POSES)
        T = link_displacements(package.links, package.joints, {**opened, joint.name: q})
        moved = {package.links[index].name for index in moved_links(package.links, package.joints, joint)}
        for name, inside in spaces.items():
            for other in (o for o in points if (o in moved) != (name in moved)):
                relative = inverse(T[:, slot[name]]) @ T[:, slot[other]]
                depths = [
                    float(find_inside(transform_points(pose, points[other]), inside).max(initial=0.0))
                    for pose in relative
                ]
                yield max(depths) - depths[0], f"{other} enters {name} along {joint.name}"


def _prepare(surfaces: Surfaces) -> tuple[dict[str, np.ndarray], dict[str, FreeSpace]]:
    """Points on every link's surface, and the space around and inside it."""
    shown = {name: triangles for name, triangles in surfaces.items() if len(triangles)}
    corners = np.concatenate([triangles.reshape(-1, 3) for triangles in shown.values()])
    diagonal = float(np.linalg.norm(np.ptp(corners, axis=0)))
    points = {name: sample_triangles(triangles, SAMPLES)[0] for name, triangles in shown.items()}
    return points, {name: find_free_space(triangles, diagonal) for name, triangles in shown.items()}
