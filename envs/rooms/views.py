"""Cameras and lamps of a room, which pictures and all engines share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.camera import Camera, look_at, rays_through

from .room import Room
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
    fixed = [each for each in fixture_solids(room) if not each.id.startswith(SHELL)]
    solids = [*map(place_solid, room.placements), *fixed, *standing_solids(room)]
    best = max(cameras, key=lambda camera: _shown(camera, solids))
    return View(name="entrance", camera=entrance), View(name="corner", camera=best)


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
