"""Solids of procedural objects as hulls, and joints that run into something on their way."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from artigen.shapes.poses import pose_parts
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape
from artigen.transforms import transform_points
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.package import Hull

OVERLAP = 1e-4
"""Depth (m) to which solids may enter each other."""


def make_hulls(shape: Shape, parts: Iterable[int], T: np.ndarray | None = None) -> HullSet:
    """The solids of some parts as one set, displaced by ``T`` (one per part of the shape)."""
    hulls = []
    for part in parts:
        for solid in shape.parts[part].primitives:
            vertices = place_vertices(solid)
            vertices = vertices if T is None else transform_points(T[part], vertices)
            hulls.append(Hull(vertices=vertices, faces=solid.faces))
    return HullSet(hulls=tuple(hulls))


def links_of(shape: Shape) -> list[int]:
    """For each part the part whose motion carries it."""
    names = [part.name for part in shape.parts]
    owners: list[int] = []
    for index, part in enumerate(shape.parts):
        fixed = part.joint is None and part.parent is not None
        owners.append(owners[names.index(str(part.parent))] if fixed else index)
    return owners


def find_overlaps(shape: Shape, poses: int) -> list[str]:
    """Joints that run into something while what they need is open and all else is closed."""
    names = [part.name for part in shape.parts]
    alone = [replace(part, joint=part.joint and replace(part.joint, follows=None)) for part in shape.parts]
    shape = replace(shape, parts=tuple(alone))
    found = []
    for leader, part in enumerate(shape.parts):
        if part.joint is None:
            continue
        qpos = np.zeros((poses, len(names)))
        for need in part.needs:
            other = names.index(need.part)
            motion = shape.parts[other].joint
            assert motion is not None
            qpos[:, other] = need.fraction * motion.upper
        qpos[:, leader] = np.linspace(0.0, part.joint.upper, poses)
        T = pose_parts(shape, qpos)
        moved = {leader}
        for index, child in enumerate(shape.parts):
            if child.parent is not None and names.index(child.parent) in moved:
                moved.add(index)
        still = make_hulls(shape, [k for k in range(len(names)) if k not in moved], T[0])
        distances = signed_distances(
            make_hulls(shape, sorted(moved)), still, T[:, leader], np.eye(4), -OVERLAP
        ).distance
        if len(distances):
            found.append(f"{part.name} runs {-distances.min():.5f} m into something")
    return found
