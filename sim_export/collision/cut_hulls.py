"""State of the hulls of an object while they are cut: remainder and allowed loss."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from artigen.types import Joint
from sim_export.collision.cover.specks import drop_specks
from sim_export.collision.hull_limits import (
    MAX_POLYGONS,
    MAX_VERTICES,
    MIN_WIDTH,
    MOST_OF_LINK,
    compact_hull,
    trim_hull,
)
from sim_export.collision.relief import END, MAX_REMOVED, SLIVER, SLIVER_LENGTH, find_ends
from sim_export.geometry.contacts import HullSet
from sim_export.geometry.distances import MAX_P99, surface_distances
from sim_export.geometry.hulls import hull_triangles, hull_volume, hull_width, inside_hulls, reduce_hull
from sim_export.geometry.sampling import sample_triangles
from sim_export.motion.kinematics import box_sides
from sim_export.package import Hull, Link

MAX_GROWTH = 1.5
"""Most hulls over those that a link had, but for the first `SLOTS` for each joint that it has; what turns
inside of something is cut at every pose, and never free."""
SLOTS = 8
"""Hulls more that a link may get for each of its joints: a panel needs some around each of its buttons."""

SKIN_SAMPLES = 64
"""Points at which it is measured whether a hull that cuts cannot free stands out of the others of its link so
little that it may go: no farther than check V103 lets 99 % of a surface be from all hulls."""
SKIN_NEAREST = 4000
"""Points on the other hulls by which the nearest face is found."""


@dataclass(frozen=True, kw_only=True)
class LinkRelief:
    """What one link lost: number of cuts, share of its hulls' volume, deepest cut (m)."""

    link: str
    cuts: int
    dropped: int
    removed_share: float
    largest_depth: float


class CutHulls:
    """The hulls of every link while they are cut; ``None`` where one was dropped.

    Where hulls may be ``sheets``, which have much surface and hardly any volume, only short ones may be
    dropped.
    """

    def __init__(
        self,
        links: Sequence[Link],
        joints: Sequence[Joint] = (),
        *,
        sheets: bool = False,
        shares: bool = False,
    ) -> None:
        self.links = links
        ends = Counter(name for joint in joints for name in (joint.parent, joint.child))
        self.slots = [SLOTS * max(ends[link.name], 1) for link in links]
        self.sheets, self.shares = sheets, shares
        self.hulls: list[list[Hull | None]] = [list(link.hulls) for link in links]
        self.volumes = [[hull_volume(hull) for hull in link.hulls] for link in links]
        self.totals = [sum(volumes) for volumes in self.volumes]
        sides = box_sides(links)
        self.size, self.diagonal = float(sides.max()), float(np.linalg.norm(sides))
        self.dropped = [0] * len(links)
        self.cuts = [0] * len(links)
        self.deepest = [0.0] * len(links)

    def prepared(self, link: int) -> tuple[HullSet, list[int]]:
        """The remaining hulls of a link, and their places in its list."""
        slots = [slot for slot, hull in enumerate(self.hulls[link]) if hull is not None]
        return HullSet(hulls=tuple(hull for hull in self.hulls[link] if hull is not None)), slots

    def put(self, link: int, slot: int, pieces: Sequence[Hull]) -> None:
        """Replaces a hull by what is left of it; each piece counts its own losses from now on."""
        if len(pieces) == 1:
            self.hulls[link][slot] = pieces[0]
            return
        self.hulls[link][slot] = None
        self.dropped[link] += not pieces
        self.hulls[link] += list(pieces)
        self.volumes[link] += [hull_volume(piece) for piece in pieces]

    def trim(self, link: int) -> None:
        """Brings what cuts have left of a link's hulls within the limits of physics engines.

        Oblong pieces are cut again, pieces thinner than allowed go, of sheets specks go (`drop_specks`), and
        where there are too many hulls the smallest go; counted with those that were dropped for clearance.
        """
        untouched = {id(hull) for hull in self.links[link].hulls}
        out: list[Hull] = []
        for hull in self.prepared(link)[0].hulls:
            out += [hull] if id(hull) in untouched else _trim(hull, sheets=self.sheets)
        thick = [h for h in out if id(h) in untouched or hull_width(h)[0] >= MIN_WIDTH]
        if self.sheets:
            thick = drop_specks(thick, self.diagonal)
        sizes = np.array([hull_volume(hull) for hull in thick])
        largest = set(np.argsort(-sizes, kind="stable")[:MOST_OF_LINK].tolist())
        kept = [hull for index, hull in enumerate(thick) if index in largest]
        self.dropped[link] += len(out) - len(kept)
        self.hulls[link] = list(kept)

    def count(self, link: int) -> int:
        return sum(hull is not None for hull in self.hulls[link])

    def room(self, link: int) -> int:
        """How many more hulls a link may get: up to `MOST_OF_LINK`, and so many over those that it had."""
        most = min(MOST_OF_LINK, self.slots[link] + int(MAX_GROWTH * len(self.links[link].hulls)))
        return max(most - self.count(link), 0)

    def allowance(self, link: int, slot: int, hidden: float = 0.0) -> float:
        """Volume (m^3) that cuts may take from a hull: much of it, or little of its link; none of a wheel.

        What is ``hidden`` (m^3) in another hull does not count.
        """
        if self._is_round(link):
            return 0.0
        least, volume = self.least(link) if self._is_small(link, slot) else 0.0, self.volumes[link][slot]
        return max(hidden + MAX_REMOVED * max(volume - hidden, 0.0), least)

    def least(self, link: int) -> float:
        """Volume (m^3) that cuts may take from a hull of a link however large it is: next to nothing."""
        return 0.0 if self._is_round(link) else SLIVER * self.totals[link]

    def end(self, link: int, slot: int) -> float:
        """Volume (m^3) that deep cuts may take from a hull: little of its link, or the end of a post."""
        least, hull = self.least(link), self.hulls[link][slot]
        slender = hull is not None and len(find_ends(hull)) > 0
        return max(least, END * self.volumes[link][slot]) if least and slender else least

    def _is_round(self, link: int) -> bool:
        """Whether a link is one cylinder that has to roll (`sim_export.geometry.wheels`)."""
        return self.links[link].label == "wheel" and len(self.links[link].hulls) == 1

    def is_sliver(self, link: int, slot: int) -> bool:
        """Whether a hull is so small against its link that it may go entirely."""
        return self._is_small(link, slot) and self.volumes[link][slot] < self.least(link)

    def _is_small(self, link: int, slot: int) -> bool:
        """Whether a hull is no longer than what may go: a sheet has hardly any volume, and is much to see."""
        hull = self.hulls[link][slot]
        return (
            not self.sheets
            or hull is None
            or float(np.ptp(hull.vertices, axis=0).max()) <= SLIVER_LENGTH * self.size
        )

    def is_skin(self, link: int, slot: int) -> bool:
        """Whether a hull of a sheet may go because all of it is close to other hulls of its link."""
        hull = self.hulls[link][slot]
        others = [other for k, other in enumerate(self.hulls[link]) if other is not None and k != slot]
        if not self.sheets or hull is None or not others:
            return False
        points = sample_triangles(hull.vertices[hull.faces], SKIN_SAMPLES)[0]
        outside = points[~inside_hulls(points, tuple(others))]
        away = surface_distances(outside, hull_triangles(others), SKIN_NEAREST)
        return bool((away <= MAX_P99 * self.diagonal).all())

    def sets(self) -> list[HullSet]:
        return [self.prepared(link)[0] for link in range(len(self.links))]

    def reliefs(self) -> tuple[LinkRelief, ...]:
        out = []
        for index, link in enumerate(self.links):
            if self.cuts[index]:
                before = self.totals[index]
                removed = before - sum(hull_volume(hull) for hull in self.hulls[index] if hull is not None)
                out.append(
                    LinkRelief(
                        link=link.name,
                        cuts=self.cuts[index],
                        dropped=self.dropped[index],
                        removed_share=removed / before,
                        largest_depth=self.deepest[index],
                    )
                )
        return tuple(out)


def _trim(hull: Hull, *, sheets: bool) -> Sequence[Hull]:
    """A hull within the limits without growing; of sheets as much as can be is kept."""
    if not sheets:
        return trim_hull(hull)
    return compact_hull(reduce_hull(hull, MAX_VERTICES, MAX_POLYGONS), 0.0, 1.0)
