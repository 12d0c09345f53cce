"""Pictures of flats: a plan with the names and sizes of rooms, a view from above, and one into each room."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from envs.rooms.covers import fixture_mesh
from envs.rooms.picture import (
    MARGIN,
    RENDER,
    SCALE,
    draw_plan,
    item_surfaces,
    placement_surfaces,
    write_picture,
)
from envs.rooms.recipes import WINDOW
from envs.rooms.room import Room
from envs.rooms.solids import place_solid
from envs.rooms.views import HEIGHT, PENDANT, WIDTH, View, find_views
from sim_export.files.read import read_package
from sim_export.geometry.normals import CREASE
from sim_export.picture.render import render_scene, surface_from_mesh, surface_points
from sim_export.picture.viewpoint import Viewpoint, place_camera

from .flat import Flat, with_neighbours

CUT = 1.3
"""Height (m) at which walls are cut; what hangs above, and windows, are left out."""


def draw_flat_plan(room: Room) -> UInt8[np.ndarray, "H W 3"]:
    """The floor plan of a flat with the name and the size of every room."""
    from PIL import Image, ImageDraw, ImageFont

    picture = Image.fromarray(draw_plan(room))
    draw = ImageDraw.Draw(picture)
    font = ImageFont.load_default(17)
    for zone in room.zones:
        (x0, y0), (x1, y1) = zone.low, zone.high
        text = f"{zone.name.replace('_', ' ')}  {x1 - x0:.2f} x {y1 - y0:.2f} m"
        at = (((x0 + x1) / 2.0 + MARGIN) * SCALE, picture.height - ((y0 + y1) / 2.0 + MARGIN) * SCALE)
        box = draw.textbbox(at, text, font=font, anchor="mm")
        draw.rectangle((box[0] - 4, box[1] - 3, box[2] + 4, box[3] + 3), fill=(255, 255, 255))
        draw.text(at, text, fill=(20, 60, 110), font=font, anchor="mm")
    return np.asarray(picture)


def draw_flat(room: Room) -> UInt8[np.ndarray, "H W 3"]:
    """The flat from above, its walls cut at chest height."""
    shown = [
        placement
        for placement in room.placements
        if placement.role != WINDOW.name and place_solid(placement).boxes[:, 0, 2].min() < CUT
    ]
    there = {placement.id for placement in shown}
    packages = {placement.package: read_package(placement.package) for placement in shown}
    surfaces = [surface for place in shown for surface in placement_surfaces(place, packages[place.package])]
    surfaces += [
        surface
        for item in room.contents
        if item.holder in (None, *there)
        for surface in item_surfaces(room, item)
    ]
    for fixture in room.fixtures:
        if fixture.low[2] < CUT and not fixture.name.startswith(("sky", PENDANT)):
            x, y, z = fixture.high
            mesh = fixture_mesh(replace(fixture, high=(x, y, min(z, CUT))))
            surfaces.append(surface_from_mesh(mesh, crease=0.0 if fixture.shape == "box" else CREASE))
    viewpoint = Viewpoint(azimuth=-75.0, elevation=55.0, fov=30.0, margin=0.02, width=WIDTH, height=HEIGHT)
    return render_scene(surfaces, place_camera(surface_points(surfaces), viewpoint), RENDER)


def write_flat_pictures(
    flat: Flat, room: Room, folder: Path, draw: Callable[[Room, View], np.ndarray] | None
) -> None:
    """Writes ``plan.png``; with what draws views, also ``room.png``, ``entrance_NAME.png`` and
    ``corner_NAME.png``."""
    write_picture(draw_flat_plan(room), folder / "plan.png")
    if draw is None:
        return
    write_picture(draw_flat(room), folder / "room.png")
    for index, cell in enumerate(flat.plan.cells):
        own = with_neighbours(flat, index)
        for view in find_views(own):
            write_picture(draw(own, view), folder / f"{view.name}_{cell.zone.name}.png")
