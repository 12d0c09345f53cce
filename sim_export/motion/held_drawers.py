"""Limits of drawers that keep a part of each in what carries it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.types import Joint
from sim_export.package import Link

HELD_LABELS = ("drawer", "tray")
HELD_SHARE = 0.12
"""Share of a drawer's depth that must stay inside what carries it."""
MIN_HELD_RANGE = 0.5
"""A limit is not lowered below this share of its range; such a drawer is reported instead."""


def held_length(own: Float[np.ndarray, "N"], carrier: Float[np.ndarray, "M"], travel: float) -> float:
    """Length over which a body, moved by ``travel`` along a line, overlaps its carrier.

    ``own`` and ``carrier`` are coordinates of points along that line, at rest. Negative: a gap.
    """
    return float(min(own.max() + travel, carrier.max()) - max(own.min() + travel, carrier.min()))


def keep_drawers_held(
    links: Sequence[Link], joints: Sequence[Joint], panels: Mapping[str, Float[np.ndarray, "N 3"]]
) -> tuple[tuple[Joint, ...], tuple[str, ...]]:
    """Lowers the limits of drawers that would leave their carrier; one sentence per change.

    Args:
        links: Links with hulls, object frame at rest.
        panels: Points of each drawer without its handles, by link.
    """
    by_name = {link.name: link for link in links}
    parent = {joint.child: joint.parent for joint in joints}
    out, records = [], []
    for joint in joints:
        slides = joint.type == "prismatic" and joint.follows is None and joint.child in panels
        if not slides or by_name[joint.child].label not in HELD_LABELS:
            out.append(joint)
            continue
        above, at = [], joint.parent
        while at in by_name:
            above += [hull.vertices for hull in by_name[at].hulls]
            at = parent.get(at, "")
        own = panels[joint.child] @ joint.axis
        carrier = np.concatenate(above) @ joint.axis if above else np.zeros(0)
        wanted = HELD_SHARE * float(np.ptp(own))
        if not len(carrier) or held_length(own, carrier, joint.upper) >= wanted:
            out.append(joint)
            continue
        upper = float(carrier.max() - own.min()) - wanted
        if upper < joint.lower + MIN_HELD_RANGE * (joint.upper - joint.lower):
            out.append(joint)
            records.append(
                f"{joint.name}: {held_length(own, carrier, joint.upper) / np.ptp(own):.0%} of the drawer "
                f"stays inside at {joint.upper:.4g} m, and too little range would be left to hold it"
            )
            continue
        out.append(replace(joint, upper=upper))
        records.append(
            f"{joint.name}: upper limit {joint.upper:.4g} lowered to {upper:.4g} m, so that "
            f"{HELD_SHARE:.0%} of the drawer's depth stay inside"
        )
    return tuple(out), tuple(records)
