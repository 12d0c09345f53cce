"""A handle inside its panel, or flat on it, moves out until it can be grasped."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.types import Joint
from sim_export.checks.config import CheckConfig
from sim_export.checks.handles import handle_joints, handle_shapes, judge_grip, measure_grip, way_out
from sim_export.checks.subject import Shape, Subject
from sim_export.mend.source import Source, move_part, source_package

FARTHEST = 0.05
"""Longest way out (m)."""
STEP = 0.0025
"""Distances (m) that are tried, the shortest first."""


def move_handles(source: Source, cfg: CheckConfig) -> Source:
    """Moves handles that V204 finds out of reach along the way on which a hand comes, as far as it takes."""
    parts = {link.name: [visual.part for visual in link.visuals] for link in source_package(source).links}
    moves = list(_find_moves(source.subject, cfg, parts))
    names = [part.name for part in source.asset.parts]
    for name, shift in moves:
        far = 1e3 * float(np.linalg.norm(shift))
        source = move_part(
            source, names.index(name), shift, f"{name}: was moved out by {far:.1f} mm, to be grasped"
        )
    return source


def _find_moves(
    subject: Subject, cfg: CheckConfig, parts: dict[str, list[str]]
) -> Iterator[tuple[str, Float[np.ndarray, "3"]]]:
    """Part and shift (m) of one handle for each door or drawer none of whose handles can be grasped."""
    for joint in handle_joints(subject):
        shapes = handle_shapes(subject, joint.child)
        if not shapes or any(_can_grasp(subject, joint, shape, cfg) for shape in shapes):
            continue
        shown = [shape.name for shape in subject.visuals if shape.link == joint.child]
        for shape in shapes:
            shift = _find_shift(subject, joint, shape, cfg)
            if shift is not None:
                yield parts[joint.child][shown.index(shape.name)], shift
                break


def _find_shift(
    subject: Subject, joint: Joint, shape: Shape, cfg: CheckConfig
) -> Float[np.ndarray, "3"] | None:
    """The shortest shift (m) after which a handle can be grasped, or None."""
    center = (shape.vertices.min(axis=0) + shape.vertices.max(axis=0)) / 2.0
    way = way_out(subject, joint, center)
    way = way / np.linalg.norm(way)
    for length in np.arange(STEP, FARTHEST + STEP / 2.0, STEP):
        moved = replace(shape, vertices=shape.vertices + length * way)
        if _can_grasp(subject, joint, moved, cfg):
            return length * way
    return None


def _can_grasp(subject: Subject, joint: Joint, shape: Shape, cfg: CheckConfig) -> bool:
    return judge_grip(measure_grip(subject, joint, shape), joint.child, cfg)[0] <= 1.0
