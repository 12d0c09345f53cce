"""The objects and fixtures of a room as placed collision hulls."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import shift
from sim_export.geometry.contacts import HullSet
from sim_export.geometry.hulls import move_hull
from sim_export.geometry.primitives import PrimitiveShape, primitive_hull
from sim_export.motion.kinematics import link_displacements
from sim_export.package import Hull

from .footprints import cached_package
from .room import Fixture, Item, Placement, Room, pose_matrix_of
from .things import thing_hulls


@dataclass(frozen=True, kw_only=True, eq=False)
class Solid:
    """Hulls of an object, or a box, in the room."""

    id: str
    hulls: HullSet

    @property
    def boxes(self) -> Float[np.ndarray, "H 2 3"]:
        """Bounds of each hull."""
        return self.hulls.rest_bounds


def object_solids(room: Room) -> list[Solid]:
    """All objects."""
    return [place_solid(placement) for placement in room.placements]


def fixture_solids(room: Room) -> list[Solid]:
    """Walls, floor and all other fixtures."""
    return [make_solid(fixture.name, [primitive_hull(fixture_shape(fixture))]) for fixture in room.fixtures]


def fixture_shape(fixture: Fixture) -> PrimitiveShape:
    """A fixture as a placed box or cylinder; the cylinder touches the sides of its box."""
    low, high = np.array(fixture.low), np.array(fixture.high)
    width, depth, height = (high - low).tolist()
    sizes = (width, depth, height) if fixture.shape == "box" else (min(width, depth) / 2.0, height)
    return PrimitiveShape(kind=fixture.shape, sizes=sizes, T_object_shape=shift((low + high) / 2.0))


def place_solid(placement: Placement) -> Solid:
    """An object's hulls in the room, with the joints at the room's coordinates."""
    package = cached_package(placement.package)
    T = pose_matrix_of(placement) @ link_displacements(package.links, package.joints, dict(placement.joints))
    hulls = [move_hull(hull, T[index]) for index, link in enumerate(package.links) for hull in link.hulls]
    return make_solid(placement.id, hulls)


def item_hulls(item: Item) -> tuple[Hull, ...]:
    """An item's hulls in its holder's frame with all joints at 0."""
    T = pose_matrix_of(item)
    return tuple(move_hull(hull, T) for hull in thing_hulls(item.thing, item.size))


def item_motion(room: Room, item: Item) -> Float[np.ndarray, "4 4"]:
    """Maps the holder's frame with all joints at 0 to the room, as the item moves with its link; the identity
    without a holder."""
    return _motions(replace(room, contents=(item,)))[0]


def item_poses(room: Room) -> dict[str, Float[np.ndarray, "4 4"]]:
    """Poses of all loose things in the room, by id."""
    motions = _motions(room)
    return {item.id: T @ pose_matrix_of(item) for item, T in zip(room.contents, motions, strict=True)}


def _motions(room: Room) -> list[Float[np.ndarray, "4 4"]]:
    links: dict[str, dict[str, np.ndarray]] = {}
    for name in {item.holder for item in room.contents if item.holder is not None}:
        holder = room.placement(name)
        package = cached_package(holder.package)
        moved = link_displacements(package.links, package.joints, dict(holder.joints))
        T = pose_matrix_of(holder) @ moved
        links[name] = {link.name: T[index] for index, link in enumerate(package.links)}
    return [np.eye(4) if item.holder is None else links[item.holder][item.link] for item in room.contents]


def item_solids(room: Room) -> list[Solid]:
    """All loose things."""
    return [item_solid(item, T) for item, T in zip(room.contents, _motions(room), strict=True)]


def standing_solids(room: Room) -> list[Solid]:
    """Loose things that no object holds: chairs, and what stands on worktops."""
    return [item_solid(item, np.eye(4)) for item in room.contents if item.holder is None]


def item_solid(item: Item, T: Float[np.ndarray, "4 4"]) -> Solid:
    """An item's hulls after a motion from its holder's frame."""
    return make_solid(item.id, [move_hull(hull, T) for hull in item_hulls(item)])


def make_solid(name: str, hulls: Sequence[Hull]) -> Solid:
    """Combines hulls in room coordinates to one solid."""
    return Solid(id=name, hulls=HullSet(hulls=tuple(hulls)))
