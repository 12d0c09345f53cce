"""Cameras and lamps of a room, which pictures and all engines share."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.camera import Camera, look_at

from .room import Room
from .solids import fixture_solids, place_solid, standing_solids

EYE_LEVEL, LOOK_AT, FIELD_OF_VIEW = 1.6, 0.85, 58.0
"""Height of an eye and of what it looks at (m), and its vertical angle of view (degrees)."""
INSET = 0.22
"""Distance (m) of an eye in a corner from both walls."""
NEAR, TALL = 0.5, 1.2
"""What is nearer (m) to an eye in a corner and higher (m) than this hides the room from it."""
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
    """The lamps below the pendants of a room, or one below the middle of the ceiling if it has none."""
    shades = [each for each in room.fixtures if each.name.startswith(f"{PENDANT}_shade")]
    points = [
        ((one.low[0] + one.high[0]) / 2.0, (one.low[1] + one.high[1]) / 2.0, one.low[2] - 0.02)
        for one in shades
    ] or [(room.size[0] / 2.0, room.size[1] / 2.0, room.size[2] - 0.1)]
    return tuple(
        Lamp(name=f"lamp_{index}", position=point, share=max(len(room.zones), 1) / len(points))
        for index, point in enumerate(points)
    )


def find_views(room: Room) -> tuple[View, View]:
    """What somebody sees who stands in the entrance, and from the corner that shows most, both at eye
    level."""
    width, depth, _ = room.size
    middle = (room.entrance.start + room.entrance.stop) / 2.0
    door = np.array([np.clip(middle, 0.3, width - 0.3), 0.05, EYE_LEVEL])
    entrance = _look(door, np.array([width / 2.0, depth, LOOK_AT]))
    corners = [(x, y) for x in (INSET, width - INSET) for y in (INSET, depth - INSET)]
    aims = [(width - x, depth - y) for x, y in corners]
    cameras = [
        _look(np.array([*eye, EYE_LEVEL]), np.array([*aim, LOOK_AT]))
        for eye, aim in zip(corners, aims, strict=True)
    ]
    solids = [place_solid(placement) for placement in room.placements]
    furniture = [each for each in fixture_solids(room) if not each.id.startswith(("wall", "floor", "sky"))]
    everything = (*solids, *furniture, *standing_solids(room))
    boxes = np.concatenate([np.zeros((0, 2, 3)), *(solid.boxes for solid in everything)])
    best = max(cameras, key=lambda camera: _shown(camera, boxes))
    return View(name="entrance", camera=entrance), View(name="corner", camera=best)


def _look(eye: Float[np.ndarray, "3"], aim: Float[np.ndarray, "3"]) -> Camera:
    return look_at(eye, aim, fov=FIELD_OF_VIEW, width=WIDTH, height=HEIGHT)


def _shown(camera: Camera, boxes: Float[np.ndarray, "B 2 3"]) -> float:
    """Volume (m^3) of boxes whose centres are in the picture, or -1 if one hides the room."""
    gap = np.maximum(boxes[:, 0] - camera.position, camera.position - boxes[:, 1])[:, :2].max(axis=1)
    if ((gap < NEAR) & (boxes[:, 1, 2] > TALL)).any():
        return -1.0
    seen = (boxes.mean(axis=1) - camera.position) @ camera.axes.T
    reach = np.array([camera.width, camera.height]) * camera.pixel / 2.0
    inside = (seen[:, 2] > 0.0) & (np.abs(seen[:, :2]) < reach * seen[:, 2:]).all(axis=1)
    return float(np.prod(boxes[inside, 1] - boxes[inside, 0], axis=1).sum())
