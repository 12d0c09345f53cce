"""L1, islands: no piece of a visual and no hull floats beside the rest of its link (V107)."""

import numpy as np

from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, always
from sim_export.checks.subject import Subject
from sim_export.geometry.islands import hull_islands, visual_islands


def check_islands(subject: Subject, cfg: CheckConfig) -> Finding:
    """V107: what is seen of a link holds together, and each of its hulls is at that or at other hulls."""
    gaps = [(0.0, "", "every link is of one piece")]
    for link in subject.links:
        shown = [shape.triangles for shape in subject.visuals if shape.link == link]
        triangles = np.concatenate([np.zeros((0, 3, 3)), *shown])
        for gap, size in visual_islands(triangles, cfg.max_island):
            said = f"a visible piece of {size} faces is {1e3 * gap:.3g} mm from the rest of link {link!r}"
            gaps.append((gap, link, said))
        for gap, size in hull_islands(subject.hull_sets[link], triangles, cfg.max_island):
            said = f"{size} hulls of link {link!r} are {1e3 * gap:.3g} mm from all else of it"
            gaps.append((gap, link, said))
    gap, where, said = max(gaps)
    return Finding(
        passed=gap <= cfg.max_island,
        value=gap,
        threshold=cfg.max_island,
        unit="m",
        where=where,
        message=f"{said}, allowed is {1e3 * cfg.max_island:g} mm",
    )


ISLAND_CHECKS = (
    CheckSpec(id="V107", level="L1", title="no islands", applies=always, function=check_islands),
)
