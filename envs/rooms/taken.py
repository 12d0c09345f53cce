"""Boxes of a room that must stay free: what bodies fill, what joints sweep, where a robot stands."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from artigen.transforms import transform_points
from sim_export.geometry.triangles import bounds_of

from .arrange import DOORWAY
from .footprints import read_footprint
from .room import ROBOT_HEIGHT, Placement, Room, along_wall, pose_matrix_of
from .solids import fixture_solids, place_solid, standing_solids


@dataclass(frozen=True, kw_only=True, eq=False)
class Taken:
    """Boxes in the room (m): ``solid`` are bodies and sweeps, ``stands`` a robot's standing places."""

    solid: Float[np.ndarray, "N 2 3"]
    stands: Float[np.ndarray, "S 2 3"]

    def admits(self, boxes: Float[np.ndarray, "B 2 3"], gap: float, *, stands: bool = True) -> bool:
        """Whether boxes keep a distance (m) from all others."""
        around = bounds_of(boxes.reshape(-1, 3))[None]
        for others in (self.solid, self.stands) if stands else (self.solid,):
            near = others[_meet(around, others, gap)[0]]
            if len(near) and _meet(boxes, near, gap).any():
                return False
        return True

    def add(self, boxes: Float[np.ndarray, "B 2 3"]) -> "Taken":
        """With more bodies."""
        return Taken(solid=np.concatenate([self.solid, boxes]), stands=self.stands)


def find_taken(room: Room) -> Taken:
    """What is taken in a room, besides its floor and walls."""
    shell = ("floor", "wall_")
    fixed = [solid.boxes for solid in fixture_solids(room) if not solid.id.startswith(shell)]
    own = [box for placement in room.placements for box in kept_free(placement)]
    loose = [solid.boxes for solid in standing_solids(room)]
    own += [
        along_wall(hole.side, room.size, (hole.start, 0.0, 0.0), (hole.stop, DOORWAY, hole.top))
        for hole in room.doorways
    ]
    solid = np.concatenate([np.zeros((0, 2, 3)), np.array(own).reshape(-1, 2, 3), *fixed, *loose])
    stands = [np.zeros((0, 2, 3)), *(stand_boxes(each, room.standing_radius) for each in room.placements)]
    return Taken(solid=solid, stands=np.concatenate(stands))


def stand_boxes(placement: Placement, radius: float) -> Float[np.ndarray, "S 2 3"]:
    """Boxes around a robot at the standing places of an object."""
    low = np.array([(x - radius, y - radius, 0.01) for x, y in placement.standing]).reshape(-1, 1, 3)
    high = np.array([(x + radius, y + radius, ROBOT_HEIGHT) for x, y in placement.standing]).reshape(-1, 1, 3)
    return np.concatenate([low, high], axis=1)


def kept_free(placement: Placement) -> list[Float[np.ndarray, "2 3"]]:
    """Boxes in the room of what an object fills at rest and as its joints move."""
    T = pose_matrix_of(placement)
    swept = [bounds_of(transform_points(T, box)) for box in read_footprint(placement.package).sweeps]
    return [*place_solid(placement).boxes, *swept]


def _meet(first: np.ndarray, second: np.ndarray, gap: float) -> Bool[np.ndarray, "A B"]:
    low = np.maximum(first[:, None, 0], second[None, :, 0])
    high = np.minimum(first[:, None, 1], second[None, :, 1])
    return np.all(high - low > -gap, axis=2)
