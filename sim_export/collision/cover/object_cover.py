"""Hulls of all links of an object from their own triangles, kept out of the space that other links sweep."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from artigen.runtime.budget import Budget
from artigen.transforms import inverse, transform_points
from artigen.types import Joint
from sim_export.collision.cover.free_space import find_free_space
from sim_export.collision.cover.surface_hulls import (
    LEVELS,
    Cover,
    Fineness,
    cover_surface,
    join_again,
    refine_cover,
)
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import diagonal_of
from sim_export.motion.kinematics import (
    driven_joints,
    hanging_links,
    link_displacements,
    moved_links,
    sweep_coordinates,
)
from sim_export.motion.requirements import POSES
from sim_export.package import Hull, Link

COARSER = 1.5
"""Factor by which the bulge grows while there are too many hulls."""
COARSEST = 0.012
"""It grows no further than this, over the object's diagonal."""
FEWER = 0.75
"""Share of the hulls otherwise allowed that an object gets whose hulls became too many when they were cut."""
LINK_SHARE = 0.25
"""Share of the time that is left which one link of several may take."""
SAMPLES = 6000
"""Points on the surface of each link that are followed along its ways."""


class ObjectCover:
    """The hulls of an object, usual or finer by link; covers of links are kept for other combinations."""

    def __init__(
        self,
        surfaces: Mapping[str, Float[np.ndarray, "F 3 3"]],
        passing: Mapping[str, Float[np.ndarray, "N 3"]],
        *,
        solid: bool = False,
    ) -> None:
        """
        Args:
            surfaces: Triangles (m) of every link, or part of one, that has any.
            passing: Where other links are or pass, by the same names (`find_passing`).
            solid: Whether the surfaces are closed and apart from each other.
        """
        corners = np.concatenate([surface.reshape(-1, 3) for surface in surfaces.values()])
        self._surfaces, self._passing, self._solid = surfaces, passing, solid
        self._diagonal = diagonal_of(corners)
        self._covers: dict[tuple[str, Fineness], Cover] = {}
        self._coarser: dict[tuple[str, Fineness, float], Cover] = {}

    def make_hulls(
        self,
        levels: Mapping[str, int] | None = None,
        *,
        fewer: bool = False,
        budget: Budget | None = None,
    ) -> dict[str, tuple[Hull, ...]]:
        """Hulls of every link: ``levels`` are those of `LEVELS` by link, if not the first; ``fewer`` in all.

        Each link may take `LINK_SHARE` of what is left of the budget when its turn comes, the last one all.
        """
        levels, budget = levels or {}, budget or Budget()
        fineness = {name: LEVELS[levels.get(name, 0)] for name in self._surfaces}
        covers = {
            name: self._cover(name, each, budget.share(max(LINK_SHARE, 1.0 / (len(fineness) - place))))
            for place, (name, each) in enumerate(fineness.items())
        }
        most = max(each.most_of_object for each in fineness.values()) * (FEWER if fewer else 1.0)
        while True:
            everywhere = sum(len(cover.hulls) for cover in covers.values()) > most
            able = [
                name
                for name, cover in covers.items()
                if (everywhere or len(cover.hulls) > fineness[name].most)
                and len(cover.pieces) > 1
                and cover.least < COARSEST * self._diagonal
            ]
            if not able:
                return {name: cover.hulls for name, cover in covers.items()}
            name = max(able, key=lambda name: len(covers[name].pieces))
            least = COARSER * covers[name].least
            key = (name, fineness[name], least)
            if key not in self._coarser:
                self._coarser[key] = join_again(covers[name], least, self._diagonal)
            covers[name] = self._coarser[key]

    def _cover(self, name: str, fineness: Fineness, budget: Budget) -> Cover:
        """The cover of a link before coarsening."""
        if (name, fineness) not in self._covers:
            triangles = self._surfaces[name]
            if fineness is LEVELS[0]:
                others = self._passing.get(name)
                space = find_free_space(triangles, self._diagonal, others, solid=self._solid)
                cover = cover_surface(triangles, space, self._diagonal, budget=budget)
            else:
                usual = self._cover(name, LEVELS[0], budget)
                cover = refine_cover(usual, triangles, self._diagonal, fineness, budget)
            self._covers[name, fineness] = cover
        return self._covers[name, fineness]


def find_passing(
    links: Sequence[Link],
    joints: Sequence[Joint],
    surfaces: Mapping[str, Float[np.ndarray, "F 3 3"]],
    *,
    solid: bool = False,
) -> dict[str, Float[np.ndarray, "N 3"]]:
    """Points (m, object frame at rest) where other links are, by link.

    Only smaller links count, unless all are solids: a panel leaves room for its knob, and the knob stays
    whole. Links on one branch of the tree, like a drawer and its body, are followed along their joints. Those
    of different branches count at rest only: one may have to be opened before the other.

    Args:
        surfaces: Triangles of every link that has any, at rest.
        solid: Whether the surfaces are closed and apart from each other.
    """
    points = {name: sample_triangles(triangles, SAMPLES)[0] for name, triangles in surfaces.items()}
    below = {link.name: set(hanging_links(joints, link.name)) for link in links}
    slot = {link.name: index for index, link in enumerate(links)}
    size = {name: diagonal_of(found) for name, found in points.items()}
    rivals = {
        name: [o for o in points if o != name and (solid or (size[o], o) < (size[name], name))]
        for name in points
    }
    out = {name: [points[other] for other in others] for name, others in rivals.items()}
    for joint in driven_joints(joints):
        moved = {links[index].name for index in moved_links(links, joints, joint)}
        T = link_displacements(links, joints, {joint.name: sweep_coordinates(joint, POSES)[1:]})
        for name in points:
            for other in rivals[name]:
                related = other in below[name] or name in below[other]
                if related and (name in moved) != (other in moved):
                    relative = inverse(T[:, slot[name]]) @ T[:, slot[other]]
                    out[name].append(transform_points(relative, points[other]).reshape(-1, 3))
    return {name: np.concatenate(found) for name, found in out.items() if found}
