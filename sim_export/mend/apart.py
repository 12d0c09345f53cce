"""Moves a part out of its neighbour if a short translation suffices."""

import numpy as np

from sim_export.checks.config import CheckConfig
from sim_export.mend.source import Source, leading_part, link_surfaces, move_part
from sim_export.source_faults import Shown, show_links

FARTHEST = 0.02
"""Longest translation relative to the object's diagonal."""
STEPS = 8
"""Shares of the longest translation that are tried, in ascending order."""
FREE = 0.5
"""Remaining overlap of a moved part as a share of the overlap allowed at rest."""


def pull_apart(source: Source, cfg: CheckConfig) -> Source:
    """Moves movable links along an axis out of the links that they overlap at rest, if that frees them."""
    surfaces = link_surfaces(source)
    shown = show_links(surfaces)
    corners = np.concatenate([triangles.reshape(-1, 3) for triangles in surfaces.values()])
    diagonal = float(np.linalg.norm(np.ptp(corners, axis=0)))
    lengths = FARTHEST * diagonal * np.arange(1, STEPS + 1) / STEPS
    ways = np.concatenate([np.eye(3), -np.eye(3)])
    body = next(reversed(surfaces))
    for name in surfaces:
        if name == body:
            continue
        before = _depth(shown, name, np.zeros(3))
        if before <= cfg.max_rest_overlap_parent:
            continue
        shifts = [length * way for length in lengths for way in ways]
        allowed = FREE * cfg.max_rest_overlap_parent
        found = next((shift for shift in shifts if _depth(shown, name, shift) <= allowed), None)
        if found is None:
            continue
        part = leading_part(source, name)
        label = source.asset.parts[part].name
        far = 1e3 * float(np.linalg.norm(found))
        source = move_part(
            source,
            part,
            found,
            f"{label}: {1e3 * before:.1f} mm inside its neighbour, was moved by {far:.1f} mm",
        )
        shown = show_links(link_surfaces(source))
    return source


def _depth(shown: dict[str, Shown], name: str, shift: np.ndarray) -> float:
    """Depth (m) to which a link, moved by ``shift`` (m), overlaps any other link."""
    T = np.eye(4)
    T[:3, 3] = shift
    back = np.eye(4)
    back[:3, 3] = -shift
    return max(
        max(link.entered(shown[name], T)[0], shown[name].entered(link, back)[0])
        for other, link in shown.items()
        if other != name
    )
