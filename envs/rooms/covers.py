"""What fixtures look like: meshes with texture coordinates in metres, one image per pattern and colour.

Pictures and all engines take the same mesh and the same image, so that cameras see the same room.
"""

from pathlib import Path

import numpy as np

from artigen.io import write_whole
from artigen.shapes.surfaces.physical import Material
from sim_export.files.obj import mtl_text, obj_text, png_bytes
from sim_export.geometry.primitives import primitive_hull
from sim_export.geometry.triangles import area_normals
from sim_export.package import Mesh

from .patterns import PERIODS, paint_pattern
from .room import Fixture
from .solids import fixture_shape

TEXTURES = "textures"
"""Subfolder of a room for the images of patterns."""
_ACROSS_UP = np.array([[1, 2], [0, 2], [0, 1]])
"""Axes along which a pattern lies on a face, by the axis that the face is most perpendicular to."""


def fixture_mesh(fixture: Fixture) -> Mesh:
    """A fixture in the room in its colour or pattern, which runs on over neighbours: texture coordinates are
    the place in the room in periods of the pattern."""
    hull = primitive_hull(fixture_shape(fixture))
    look = Material(name=look_name(fixture))
    if fixture.pattern == "plain":
        return Mesh(vertices=hull.vertices, faces=hull.faces, color=fixture.color, material=look)
    corners = hull.vertices[hull.faces]
    axes = _ACROSS_UP[np.abs(area_normals(corners)).argmax(axis=1)]
    uv = np.take_along_axis(corners, axes[:, None], axis=2) / PERIODS[fixture.pattern]
    texture = paint_pattern(fixture.pattern, fixture.color)
    return Mesh(vertices=hull.vertices, faces=hull.faces, uv=uv, texture=texture, material=look)


def look_name(fixture: Fixture) -> str:
    """Name of a pattern in a colour, equal for fixtures that look the same."""
    red, green, blue = (round(255.0 * value) for value in fixture.color)
    return f"{fixture.pattern}_{red:02x}{green:02x}{blue:02x}"


def write_cover(fixture: Fixture, folder: Path) -> Path:
    """Writes the image of a fixture's pattern below a folder, once for all that look the same, and returns
    its path."""
    path = folder / TEXTURES / f"{look_name(fixture)}.png"
    if not path.is_file():
        write_whole(path, png_bytes(paint_pattern(fixture.pattern, fixture.color)))
    return path


def write_cover_obj(fixture: Fixture, folder: Path) -> Path:
    """Writes a fixture with its image as OBJ, for engines that read files, and returns its path."""
    mesh, look = fixture_mesh(fixture), look_name(fixture)
    image = write_cover(fixture, folder).relative_to(folder).as_posix()
    write_whole(folder / f"{look}.mtl", mtl_text(look, mesh, image))
    return write_whole(folder / f"{fixture.name}.obj", obj_text(mesh, fixture.name, look))
