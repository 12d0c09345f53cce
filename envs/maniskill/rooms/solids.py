"""The objects and fixtures of a room as placed collision hulls."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.transforms import transform_points
from sim_export.collision.contacts import HullSet
from sim_export.collision.hulls import box_hull
from sim_export.collision.motion import link_displacements
from sim_export.package import Hull

from .footprints import cached_package
from .room import Placement, Room, pose_matrix_of


@dataclass(frozen=True, kw_only=True, eq=False)
class Solid:
    """Hulls of an object, or a box, in the room, with the bounds of each."""

    id: str
    hulls: HullSet
    boxes: Float[np.ndarray, "H 2 3"]


def fixture_solids(room: Room) -> list[Solid]:
    """Walls, floor and all other static boxes."""
    return [
        make_solid(fixture.name, [box_hull(np.array(fixture.low), np.array(fixture.high))])
        for fixture in room.fixtures
    ]


def place_solid(placement: Placement) -> Solid:
    """An object's hulls in the room, with the joints at the room's coordinates."""
    package = cached_package(placement.package)
    T = pose_matrix_of(placement) @ link_displacements(package.links, package.joints, dict(placement.joints))
    hulls = [
        Hull(vertices=transform_points(T[index], hull.vertices), faces=hull.faces)
        for index, link in enumerate(package.links)
        for hull in link.hulls
    ]
    return make_solid(placement.id, hulls)


def make_solid(name: str, hulls: Sequence[Hull]) -> Solid:
    """Combines hulls in room coordinates to one solid."""
    boxes = np.array([[hull.vertices.min(axis=0), hull.vertices.max(axis=0)] for hull in hulls])
    return Solid(id=name, hulls=HullSet(hulls=tuple(hulls)), boxes=boxes.reshape(-1, 2, 3))
