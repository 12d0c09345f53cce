"""Cameras and lamps of a room, which pictures and all engines share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.camera import Camera, look_at, rays_through

from .room import Room, Zone
from .solids import Solid, fixture_solids, place_solid, standing_solids

EYE_LEVEL, LOOK_AT, FIELD_OF_VIEW = 1.6, 0.85, 58.0
"""Height of an eye and of what it looks at (m), and its vertical angle of view (degrees)."""
INSET = 0.22
"""Distance (m) of an eye in a corner from both walls."""
NEAR = 1.0
"""What is nearer (m) to an eye in a corner hides the room from it."""
RAYS = (25, 17)
"""Columns and rows of rays by which views are compared."""
SHELL = ("wall", "floor", "sky")
"""Beginnings of the names of fixtures around a room."""
WIDTH, HEIGHT = 1100, 760
"""Size of views in pixels."""
PENDANT = "pendant"
"""Beginning of the names of fixtures that give light."""


@dataclass(frozen=True, kw_only=True)
class Lamp:
    """A lamp that shines down from ``position`` (m), with its share of the light of a room."""

    name: str
    position: tuple[float, float, float]
    share: float


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """A camera with a name."""

    name: str
    camera: Camera


def find_lamps(room: Room) -> tuple[Lamp, ...]:
    """The lamps below the pendants of a room, or one below the middle of the ceiling if it has none; so in
    every room of a flat."""
    shades = [each for each in room.fixtures if each.name.startswith(PENDANT) and "shade" in each.name]
    below = np.array([((*each.low, *each.high)) for each in shades]).reshape(-1, 2, 3)
    points = np.c_[below.mean(axis=1)[:, :2], below[:, 0, 2] - 0.02]
    lamps: list[Lamp] = []
    for zone in _zones(room):
        own = points[((points[:, :2] > zone.low) & (points[:, :2] < zone.high)).all(axis=1)].tolist()
        own = own or [[*(np.add(zone.low, zone.high) / 2.0).tolist(), room.size[2] - 0.1]]
        lamps += [
            Lamp(name=f"lamp_{len(lamps) + index}", position=(x, y, z), share=1.0 / len(own))
            for index, (x, y, z) in enumerate(own)
        ]
    return tuple(lamps)


def find_views(room: Room) -> tuple[View, ...]:
    """What somebody sees who stands in the entrance, and from the corner that shows most, both at eye level;
    of a flat, from a corner of each room, ``corner_kitchen``."""
    middle, width = (room.entrance.start + room.entrance.stop) / 2.0, room.size[0]
    door = np.array([np.clip(middle, 0.3, width - 0.3), 0.05, EYE_LEVEL])
    zones, front = _zones(room), np.array([door[0], 0.3])
    first = next((zone for zone in zones if (front > zone.low).all() and (front < zone.high).all()), zones[0])
    aim = np.array([(first.low[0] + first.high[0]) / 2.0, first.high[1], LOOK_AT])
    fixed = [each for each in fixture_solids(room) if not each.id.startswith(SHELL)]
    solids = [*map(place_solid, room.placements), *fixed, *standing_solids(room)]
    return View(name="entrance", camera=_look(door, aim)), *(_corner(zone, solids) for zone in zones)


def _zones(room: Room) -> tuple[Zone, ...]:
    """The rooms of a flat, or a room by itself, without a name."""
    if room.zones or room.kind == "flat":
        return room.zones
    width, depth, _ = room.size
    return (Zone(name="", kind=room.kind, low=(0.0, 0.0), high=(width, depth)),)


def _corner(zone: Zone, solids: Sequence[Solid]) -> View:
    """The view from the corner of a room that shows most."""
    low, high = np.array(zone.low), np.array(zone.high)
    ends = np.stack([low + INSET, high - INSET])
    cameras = [
        _look(
            np.array([ends[i, 0], ends[j, 1], EYE_LEVEL]), np.array([ends[1 - i, 0], ends[1 - j, 1], LOOK_AT])
        )
        for i in (0, 1)
        for j in (0, 1)
    ]
    inside = [
        solid
        for solid in solids
        if (solid.boxes[:, 0, :2].min(axis=0) < high).all()
        and (solid.boxes[:, 1, :2].max(axis=0) > low).all()
    ]
    best = max(cameras, key=lambda camera: _shown(camera, inside))
    return View(name="_".join(filter(None, ("corner", zone.name))), camera=best)


def _look(eye: Float[np.ndarray, "3"], aim: Float[np.ndarray, "3"]) -> Camera:
    return look_at(eye, aim, fov=FIELD_OF_VIEW, width=WIDTH, height=HEIGHT)


def _shown(camera: Camera, solids: Sequence[Solid]) -> float:
    """Number of solids that rays through the picture meet first, less the share of rays that end near the
    eye, in hundreds."""
    if not solids:
        return 0.0
    boxes = np.concatenate([solid.boxes for solid in solids])
    owners = np.repeat(np.arange(len(solids)), [len(solid.boxes) for solid in solids])
    columns, rows = np.meshgrid(np.linspace(0, camera.width, RAYS[0]), np.linspace(0, camera.height, RAYS[1]))
    rays = rays_through(camera, columns.ravel(), rows.ravel())[:, None]  # R 1 3
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = (boxes - camera.position)[None] / rays[:, :, None]  # R B 2 3
    enter, leave = np.nanmin(ends, axis=2).max(axis=2), np.nanmax(ends, axis=2).min(axis=2)
    far = np.where((leave > np.maximum(enter, 0.0)), np.maximum(enter, 0.0), np.inf)
    first, depth = far.argmin(axis=1), far.min(axis=1)
    return len(set(owners[first[(depth > NEAR) & (depth < np.inf)]].tolist())) - 100.0 * float(
        (depth < NEAR).mean()
    )
