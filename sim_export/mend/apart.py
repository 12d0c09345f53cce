"""Moves a part out of its neighbour if a short translation suffices."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float

from artigen.transforms import shift
from sim_export.checks.config import CheckConfig
from sim_export.mend.source import Source, leading_part, move_part
from sim_export.source_faults import Shown, surfaces_diagonal

FARTHEST = 0.02
"""Longest translation relative to the object's diagonal."""
STEPS = 8
"""Shares of the longest translation that are tried, in ascending order."""
FREE = 0.5
"""Remaining overlap of a moved part as a share of the overlap allowed at rest."""


def pull_apart(source: Source, cfg: CheckConfig) -> Source:
    """Moves movable links out of the links that they overlap at rest, if that frees them.

    They move along an axis of the object, or else across the axis of their joint, as a laptop's hinge must.
    """
    surfaces = source.links
    body = next(reversed(surfaces))
    for name in surfaces:
        if name == body:
            continue
        shown = source.shown
        depths = {
            other: max(_depths(shown[name], link, np.zeros(3)))
            for other, link in shown.items()
            if other != name
        }
        before = max(depths.values())
        if before <= cfg.max_rest_overlap_parent:
            continue
        deepest_first = [shown[other] for other in sorted(depths, key=lambda other: -depths[other])]
        part = leading_part(source, name)
        shifts = FARTHEST * surfaces_diagonal(surfaces) * _shifts(source.asset.parts[part].joint.axis)
        allowed = FREE * cfg.max_rest_overlap_parent
        found = next((s for s in shifts if _is_free(shown[name], deepest_first, s, allowed)), None)
        if found is None:
            continue
        label = source.asset.parts[part].name
        far = 1e3 * float(np.linalg.norm(found))
        source = move_part(
            source,
            part,
            found,
            f"{label}: {1e3 * before:.1f} mm inside its neighbour, was moved by {far:.1f} mm",
        )
    return source


def _shifts(axis: Float[np.ndarray, "3"]) -> Float[np.ndarray, "N 3"]:
    """Translations no longer than 1: first those along the axes of the object, then those along two of them
    at once, across the one that is nearest to a joint's ``axis``; each group in ascending order."""
    steps = np.arange(-STEPS, STEPS + 1) / STEPS
    along, across = np.eye(3), np.delete(np.eye(3), int(np.abs(axis).argmax()), axis=0)
    straight = (steps[:, None, None] * along).reshape(-1, 3)
    slanted = (steps[:, None, None] * across[0] + steps[None, :, None] * across[1]).reshape(-1, 3)
    groups = []
    for group, directions in ((straight, 1), (slanted, 2)):
        lengths = np.linalg.norm(group, axis=1)
        kept = (np.count_nonzero(group, axis=1) == directions) & (lengths <= 1.0 + 1e-9)
        groups.append(group[kept][np.argsort(lengths[kept], kind="stable")])
    return np.concatenate(groups)


def _is_free(link: Shown, others: Sequence[Shown], offset: Float[np.ndarray, "3"], allowed: float) -> bool:
    """Whether a link, moved by ``offset`` (m), overlaps no other by more than is allowed (m)."""
    return all(depth <= allowed for other in others for depth in _depths(link, other, offset))


def _depths(link: Shown, other: Shown, offset: Float[np.ndarray, "3"]) -> Iterator[float]:
    """Depths (m) to which a link, moved by ``offset`` (m), enters another one, and this one enters it."""
    for into, moved, way in ((other, link, offset), (link, other, -offset)):
        yield into.entered(moved, shift(way))[0]
