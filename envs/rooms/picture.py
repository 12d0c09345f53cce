"""Renders rooms on the CPU: a dollhouse view, the views of its cameras, quickly or by daylight, and a plan of
the free space.

The walls towards the camera are removed, with their door and windows. In the plan bodies are grey, the swept
space of doors and drawers is orange, the robot's standing places are blue, and contents of drawers and
cupboards are outlined in green.
"""

import io
import json
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8, UInt16

from artigen.camera import pixel_rays
from artigen.io import write_whole
from artigen.transforms import transform_points
from sim_export.files.read import read_package
from sim_export.geometry.normals import CREASE
from sim_export.motion.kinematics import link_displacements
from sim_export.package import Mesh, SimPackage
from sim_export.picture.daylight import render_daylight
from sim_export.picture.draw import package_surfaces
from sim_export.picture.lighting import RenderConfig
from sim_export.picture.raycast import Surface, build_scene, cast_rays, surface_ids_at
from sim_export.picture.render import move_surface, render_scene, surface_from_mesh, surface_points
from sim_export.picture.tracing import TraceConfig
from sim_export.picture.viewpoint import Viewpoint, place_camera

from .covers import fixture_mesh
from .decor import ON_WALLS
from .footprints import cached_package, outline_of, read_footprint
from .room import SIDES, Fixture, Item, Placement, Room, Side, from_wall, pose_matrix_of
from .solids import item_hulls, item_motion, item_solids, place_solid
from .sweeps import find_sweeps
from .things import thing_solids
from .views import HEIGHT, PENDANT, WIDTH, View, find_lamps, find_views

AZIMUTH = 62.0
"""Degrees from the left (or right) wall towards the wall with the entrance: 90 looks straight in."""
ELEVATION = 34.0
"""Degrees above the horizon."""
BEHIND = 0.1
"""Distance (m) from a wall within which a camera does not show it."""
SCALE = 120.0
"""Pixels per metre of the plan."""
MARGIN = 0.3
"""Distance (m) around the room in the plan."""
PIECE = re.compile(r"^(wall_.*)_\d+$")
"""Names of pieces of walls."""
RENDER = RenderConfig(
    ground=False, occlusion_reach=0.12, light_direction=(-0.35, -0.55, 0.9), light_radius=0.25
)
EYE_RENDER = RenderConfig(
    ground=False, occlusion_reach=0.12, light_direction=(0.25, -0.8, 0.35), light_radius=0.5,
    background=(206, 226, 244), sky=(0.52, 0.54, 0.56), bounce=(0.60, 0.58, 0.56),
)  # fmt: skip
"""Light that comes from behind the eye, as the ceiling shuts out any other."""


def draw_room(room: Room) -> UInt8[np.ndarray, "H W 3"]:
    """The room seen from above its entrance, without the front walls and the ceiling."""
    side = _emptier_side(room)
    azimuth = -AZIMUTH if side == "left" else AZIMUTH - 180.0
    shown = [place for place in room.placements if not _hangs_in(room, place, ("front", side))]
    left_out = ("sky", PENDANT)
    fixtures = [
        each
        for each in room.fixtures
        if not each.name.startswith(left_out) and not _belongs_to(each, ("front", side))
    ]
    surfaces = _join_walls(*_room_surfaces(room, shown, fixtures))
    viewpoint = Viewpoint(
        azimuth=azimuth, elevation=ELEVATION, fov=30.0, margin=0.02, width=WIDTH, height=HEIGHT
    )
    camera = place_camera(surface_points(surfaces), viewpoint)
    return render_scene(surfaces, camera, RENDER)


def draw_view(room: Room, view: View) -> UInt8[np.ndarray, "H W 3"]:
    """The room as a camera in it sees it, with the ceiling and all walls but those that it stands before; the
    background is the sky."""
    eye = view.camera.position[None, None].repeat(2, axis=1)
    away: list[Side] = [side for side in SIDES if from_wall(side, room.size, eye)[0, 0, 1] < BEHIND]
    shown = [place for place in room.placements if not _hangs_in(room, place, away)]
    kept = (each for each in room.fixtures if not each.name.startswith("sky"))
    fixtures = [*(each for each in kept if not _belongs_to(each, away)), _ceiling(room)]
    forward = view.camera.axes[2]
    light = replace(EYE_RENDER, light_direction=(0.35 - 0.8 * forward[0], -0.8 * forward[1], 0.35))
    return render_scene(_join_walls(*_room_surfaces(room, shown, fixtures)), view.camera, light)


def draw_daylight(room: Room, view: View, cfg: TraceConfig | None = None) -> UInt8[np.ndarray, "H W 3"]:
    """As `draw_view`, with all walls, lit by the sky behind the windows and by the lamps; needs Mitsuba 3,
    and a minute or more."""
    surfaces, names = _room_surfaces(room, room.placements, [*room.fixtures, _ceiling(room)])
    sky = {number for number, name in enumerate(names) if name.startswith("sky")}
    lamps = [lamp.position for lamp in find_lamps(room)]
    return render_daylight(surfaces, view.camera, sky, lamps, cfg or TraceConfig(samples=12, depth=8))


def _ceiling(room: Room) -> Fixture:
    width, depth, height = room.size
    return Fixture(
        name="ceiling", low=(0.0, 0.0, height), high=(width, depth, height + 0.1), color=(0.95, 0.95, 0.94)
    )


def draw_masks(room: Room, view: View) -> tuple[UInt16[np.ndarray, "H W"], tuple[str, ...]]:
    """What each pixel of a view shows: one more than its index in the names, 0 for nothing.

    Names are those of links (``fridge_1/link_0``), loose things and fixtures, as in ``scene.xml``.
    """
    surfaces, names = _room_surfaces(room, room.placements, room.fixtures)
    scene, camera = build_scene(surfaces), view.camera
    hits = cast_rays(scene, camera.position, pixel_rays(camera).reshape(-1, 3))
    mask = np.zeros((camera.height, camera.width), np.uint16)
    mask.flat[hits.place] = surface_ids_at(scene, hits) + 1
    return mask, names


def _room_surfaces(
    room: Room, shown: Sequence[Placement], fixtures: Sequence[Fixture]
) -> tuple[list[Surface], tuple[str, ...]]:
    """Surfaces of objects, of everything loose, and of fixtures; their ids are the places of their names."""
    packages = {place.package: read_package(place.package) for place in shown}
    surfaces: list[Surface] = []
    names: list[str] = []
    for place in shown:
        package = packages[place.package]
        own = placement_surfaces(place, package)
        surfaces += [replace(surface, id=surface.id + len(names)) for surface in own]
        names += [f"{place.id}/{link.name}" for link in package.links]
    for item in room.contents:
        surfaces += [replace(surface, id=len(names)) for surface in item_surfaces(room, item)]
        names.append(item.id)
    for fixture in fixtures:
        crease = 0.0 if fixture.shape == "box" else CREASE
        surfaces.append(surface_from_mesh(fixture_mesh(fixture), surface_id=len(names), crease=crease))
        names.append(fixture.name)
    return surfaces, tuple(names)


def _join_walls(surfaces: Sequence[Surface], names: Sequence[str]) -> list[Surface]:
    """Surfaces with one id for all pieces of a wall: light is averaged within an id, and seams would show."""
    first: dict[str, int] = {}
    walls = [PIECE.sub(r"\1", name) for name in names]
    return [replace(each, id=first.setdefault(walls[each.id], each.id)) for each in surfaces]


def _emptier_side(room: Room) -> Side:
    """The side wall whose removal shows more: tall objects count most."""
    hidden = {"left": 0.0, "right": 0.0}
    for placement in room.placements:
        side = "left" if placement.position[0] < room.size[0] / 2.0 else "right"
        from_wall = min(placement.position[0], room.size[0] - placement.position[0])
        top = placement.position[2] + placement.size[2] / 2.0
        hidden[side] += placement.size[1] * top**3 if from_wall < 0.8 else 0.0
    return "left" if hidden["left"] <= hidden["right"] else "right"


def _belongs_to(fixture: Fixture, sides: Sequence[Side]) -> bool:
    """Whether a fixture is part of one of the walls, or on it."""
    parts = ("wall", "skirting", "tiles", *ON_WALLS)
    return fixture.name.startswith(tuple(f"{part}_{side}" for part in parts for side in sides))


def _hangs_in(room: Room, placement: Placement, sides: Sequence[Side]) -> bool:
    """Whether an object hangs in an opening of one of the walls, into which nothing else reaches."""
    boxes = place_solid(placement).boxes
    return any(from_wall(side, room.size, boxes)[:, 0, 1].min() < -0.01 for side in sides)


def placement_surfaces(placement: Placement, package: SimPackage) -> tuple[Surface, ...]:
    """An object's visuals in the room, with the joints at the room's coordinates."""
    T = pose_matrix_of(placement) @ link_displacements(package.links, package.joints, dict(placement.joints))
    return tuple(move_surface(surface, T[surface.id]) for surface in package_surfaces(package))


def item_surfaces(room: Room, item: Item) -> tuple[Surface, ...]:
    """A loose thing in its colours, where the joints of its holder put it."""
    T = item_motion(room, item)
    return tuple(
        surface_from_mesh(
            Mesh(vertices=transform_points(T, hull.vertices), faces=hull.faces, color=item.colors[color])
        )
        for hull, (_, color) in zip(item_hulls(item), thing_solids(item.thing, item.size), strict=True)
    )


def draw_plan(room: Room) -> UInt8[np.ndarray, "H W 3"]:
    """The floor plan: outlines of all hulls from above, sweeps, standing places and ids."""
    from PIL import Image, ImageDraw, ImageFont

    width, depth = (int((side + 2 * MARGIN) * SCALE) for side in room.size[:2])
    picture = Image.new("RGB", (width, depth), (250, 250, 248))
    draw = ImageDraw.Draw(picture, "RGBA")

    def pixel(points: Float[np.ndarray, "N 2"]) -> list[tuple[float, float]]:
        x, y = (points[:, 0] + MARGIN) * SCALE, depth - (points[:, 1] + MARGIN) * SCALE
        return list(zip(x.tolist(), y.tolist(), strict=True))

    for fixture in room.fixtures:
        if fixture.name.startswith(("floor", "sky")) or fixture.low[2] > 0.5:
            continue
        shade = (90, 92, 98, 255) if fixture.name.startswith("wall") else (214, 205, 192, 255)
        draw.polygon(pixel(_rectangle(fixture.low, fixture.high)), fill=shade)
    order = sorted(room.placements, key=lambda placement: placement.position[2])
    for placement in order:
        for outline in _sweep_outlines(placement):
            draw.polygon(pixel(outline), fill=(240, 150, 60, 26))
    for placement in order:
        for x, y in placement.standing:
            ends = pixel(np.array([[x, y], [x, y]]) + np.array([[-1, 1], [1, -1]]) * room.standing_radius)
            draw.ellipse([ends[0], ends[1]], outline=(60, 110, 190, 200), width=2)
    font = ImageFont.load_default(11)
    for placement in order:
        corners = _body_rectangle(placement)
        fill = (196, 214, 196, 255) if placement.support else (208, 210, 214, 255)
        lifted = placement.position[2] > 1.4 and placement.size[2] < 1.2
        draw.polygon(
            pixel(corners), fill=(0, 0, 0, 0) if lifted else fill, outline=(70, 74, 82, 255),
            width=1 if lifted else 2,
        )  # fmt: skip
        if not lifted:  # objects above others would cover their names
            name = placement.id.replace("_", " ")
            draw.text(pixel(corners.mean(axis=0)[None])[0], name, fill=(30, 32, 38), font=font, anchor="mm")
    for solid in item_solids(room):
        outline = outline_of(solid.hulls.vertices[:, :2])
        draw.polygon(pixel(outline), outline=(50, 120, 70, 160))
    return np.asarray(picture)


def _rectangle(low: Sequence[float], high: Sequence[float]) -> Float[np.ndarray, "4 2"]:
    return np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])


def _body_rectangle(placement: Placement) -> Float[np.ndarray, "4 2"]:
    body = read_footprint(placement.package).body
    points = _rectangle(body[0], body[1])
    T = pose_matrix_of(placement)
    return transform_points(T, np.column_stack([points, np.zeros(4)]))[:, :2]


def _sweep_outlines(placement: Placement) -> list[Float[np.ndarray, "V 2"]]:
    """Outlines from above of everything that opens, at several poses."""
    package = cached_package(placement.package)
    T = pose_matrix_of(placement)
    outlines = []
    for sweep in find_sweeps(package):
        for step in np.linspace(0, len(sweep.T) - 1, 7).astype(int):
            points = [
                transform_points(T @ sweep.T[step, index], hull.vertices)
                for index in sweep.links
                for hull in package.links[index].hulls
            ]
            if points:
                outlines.append(outline_of(np.concatenate(points)[:, :2]))
    return outlines


def write_view(room: Room, path: Path) -> None:
    """Writes the dollhouse view as a PNG, atomically."""
    write_picture(draw_room(room), path)


def write_views(room: Room, folder: Path, draw: Callable[[Room, View], np.ndarray] = draw_view) -> None:
    """Writes what each camera of the room sees as a PNG of its name, its links as one of 16 bits
    (``corner_links.png``), and their names in the order of its values from 1 (``links.json``), atomically."""
    for view in find_views(room):
        mask, names = draw_masks(room, view)
        write_picture(draw(room, view), folder / f"{view.name}.png")
        write_picture(mask, folder / f"{view.name}_links.png")
        write_whole(folder / "links.json", json.dumps(names, indent=1) + "\n")


def write_plan(room: Room, path: Path) -> None:
    """Writes the floor plan as a PNG, atomically."""
    write_picture(draw_plan(room), path)


def write_picture(image: UInt8[np.ndarray, "H W 3"] | UInt16[np.ndarray, "H W"], path: Path) -> None:
    """Writes a picture as a PNG, atomically."""
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(image).save(stream, format="png", optimize=True)
    write_whole(path, stream.getvalue())
