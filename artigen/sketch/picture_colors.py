"""Estimates the colours of finishes from a picture and a shape in the view that the encoder predicts.

A pixel shows its finish's colour under some illumination, which is modelled as that of the bright room in
which shapes are rendered. The colour of a finish is the median of its corrected pixels. A finish that is not
visible keeps its colour, or takes that of a visible finish with the same original colour. Handles are read
where the encoder sees them (`artigen.sketch.handle_color`).
"""

from collections import defaultdict
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.camera import Camera, look_at, project_points
from artigen.datasets.mesh_raster import SeenFaces
from artigen.shapes.shape import Shape
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.textures import paint_primitives
from artigen.sketch.handle_color import THIN, read_handle
from artigen.sketch.overlay import FRONT, SIDES, SOLID, Faces, View, find_visible, list_faces, place_camera
from artigen.splats.colors import linear_from_srgb, srgb_from_linear

MIN_PIXELS = 12
"""Smallest number of pixels away from edges for the colour of a finish."""
OPAQUE = 0.99
"""Opacity below which a finish keeps its colour."""
LARGE = 0.02
"""Share of the object's pixels that must show a finish, away from edges, for its colour to be read. Fewer are
mostly shadows, gaps or parts that lie elsewhere."""
LEAST = 0.15
"""Smallest share of a pixel's light that is attributed to its finish; the rest may be mirrored."""
SMALL = ("handle", "accent", "steel", "plastic")
"""Roles of small parts in front of others. A drawn shape rarely has them at the exact pixels where the
picture shows them, so their colours are not estimated; those of handles are, where the encoder sees them."""
SAME_LIGHTNESS, SAME_CHROMA = 40.0, 8.0
"""Differences (CIELAB) from the picture up to which a drawn colour is trusted. Lightness depends on
illumination, which is estimated; hue and chroma hardly do."""
EQUAL = 0.02
"""Difference (sRGB) below which the colours of two finishes count as equal."""
XYZ_OF_RGB = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
"""CIE XYZ of the linear sRGB primaries (IEC 61966-2-1)."""
LIGHT_EDGE, GREY, DARK = 96, 0.5, 0.03
"""Renderings of the room's light: edge in pixels, grey (sRGB), and lowest scattered share."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Spots:
    """Pixels that show the object, with the expected illumination and pattern."""

    light: Float[np.ndarray, "N 3"]
    """Linear light in the picture."""
    roles: Int[np.ndarray, "N"]
    """Index into the shape's finishes."""
    sides: Int[np.ndarray, "N"]
    clear: Bool[np.ndarray, "N"]
    """Whether the whole neighbourhood shows the same finish on the same side of the same part."""
    bright: Float[np.ndarray, "N"]
    """Diffusely reflected light as a factor of the linear colour."""
    mirrored: Float[np.ndarray, "N"]
    """Linear light reflected independently of the colour."""
    pattern: Float[np.ndarray, "N 3"]
    """Rendered colour over the finish's main colour (sRGB)."""


def read_colors(
    shape: Shape,
    picture: Float[np.ndarray, "4 S S"],
    view: View,
    *,
    keep: Collection[str] = (),
    labels: Float[np.ndarray, "L h w"] | None = None,
) -> Shape:
    """Colours a shape as in a picture; colours that agree with it stay, as a network's are more exact.

    Args:
        shape: The object, at rest.
        picture: RGBA in [0, 1], premultiplied on black.
        view: From where the picture shows it.
        keep: Roles of finishes whose colour is kept.
        labels: Probability of each part label by cell of the picture, for the colour of handles.

    Raises:
        PictureError: If the picture shows no object.
    """
    spots = find_spots(shape, picture, view)
    colors = srgb_from_linear(_undo_light(spots))
    read: dict[str, Float[np.ndarray, "3"]] = {}
    for index, (role, finish) in enumerate(shape.finishes):
        chosen = spots.clear & (spots.roles == index)
        if finish.opacity >= OPAQUE and chosen.sum() >= max(MIN_PIXELS, LARGE * len(spots.roles)):
            read[role] = np.median(colors[chosen], axis=0) / np.median(spots.pattern[chosen], axis=0)
    unread = {*SMALL, *keep}
    handle = find_handle(shape)
    shown = None if labels is None else read_handle(picture, labels)
    if handle is not None and handle not in keep and shown is not None and len(spots.roles):
        front = spots.sides == FRONT if (spots.sides == FRONT).any() else slice(None)  # most handles face it
        read[handle] = srgb_from_linear(linear_from_srgb(shown) / np.median(spots.bright[front]))
        unread.remove(handle)
    given = dict(shape.finishes)
    found = {role: _settle(color, given[role].color) for role, color in read.items()}
    return replace(
        shape,
        finishes=tuple(
            (role, finish if role in unread else _recolor(role, finish, shape, found))
            for role, finish in shape.finishes
        ),
    )


def find_handle(shape: Shape) -> str | None:
    """The role that most of the handles and knobs consist of, if it is one of `SMALL`."""
    volumes: dict[str, float] = defaultdict(float)
    for part in shape.parts:
        for primitive in part.primitives if part.label in THIN else ():
            volumes[primitive.finish] += float(np.prod(primitive.size))
    role = max(volumes, key=lambda name: volumes[name], default=None)
    return role if role in SMALL else None


def find_spots(shape: Shape, picture: Float[np.ndarray, "4 S S"], view: View) -> Spots:
    """Pixels that lie on both the picture's object and the shape.

    Raises:
        PictureError: If the picture shows no object.
    """
    from scipy.ndimage import minimum_filter

    faces, alpha = list_faces(shape), picture[3]
    camera = place_camera(view, faces.vertices, alpha)
    visible = find_visible(faces, camera)
    solid = (alpha > SOLID).ravel()[visible.pixel]
    pixel, face = visible.pixel[solid], visible.face[solid]
    corners = faces.vertices[faces.corners[face]]
    points, normals = np.einsum("nk,nkd->nd", visible.weights[solid], corners), faces.normals[face]
    clear = _find_clear(faces, visible, alpha.shape) & minimum_filter(alpha > 0.5, 3, mode="constant")
    colors = np.array([finish.color for _, finish in shape.finishes])[faces.roles[face]]
    footprint, bright, mirrored = 0.0, np.ones(0), np.zeros(0)
    if len(face):
        footprint = camera.pixel * float(np.linalg.norm(points - camera.position, axis=1).mean())
        bright, mirrored = _light(shape, points, camera)
    painted = paint_primitives(shape, faces.primitives[face], points, normals, footprint=footprint)
    rgb = np.moveaxis(picture[:3] / np.maximum(alpha, 1e-3), 0, -1).reshape(-1, 3)
    return Spots(
        light=linear_from_srgb(rgb[pixel].astype(float)),
        roles=faces.roles[face],
        sides=faces.sides[face],
        clear=clear.ravel()[pixel],
        bright=bright,
        mirrored=mirrored,
        pattern=np.maximum(painted, 1e-3) / np.maximum(colors, 1e-3),
    )


def _undo_light(spots: Spots) -> Float[np.ndarray, "N 3"]:
    """Linear colours with the room's illumination removed."""
    scattered = np.maximum(spots.light - spots.mirrored[:, None], LEAST * spots.light)
    return np.maximum(scattered / spots.bright[:, None], 1e-5)


def _recolor(role: str, finish: Finish, shape: Shape, found: Mapping[str, Color]) -> Finish:
    """Recolours a finish as found for it, or for an equal finish; its accent changes in proportion."""
    color = found.get(role)
    if color is None:
        color = next((found[o] for o, other in shape.finishes if o in found and _equal(finish, other)), None)
    if color is None:
        return finish
    r, g, b = (
        float(np.clip(new * accent / max(old, 1e-3), 0.0, 1.0))
        for new, accent, old in zip(color, finish.accent, finish.color, strict=True)
    )
    return replace(finish, color=color, accent=(r, g, b))


def _equal(one: Finish, other: Finish) -> bool:
    apart = np.abs(np.array(one.color) - np.array(other.color)).max()
    return one.kind == other.kind and one.opacity == other.opacity and bool(apart < EQUAL)


def _settle(read: Float[np.ndarray, "3"], drawn: Color) -> Color:
    """The colour read, or the drawn one if that agrees."""
    r, g, b = np.minimum(read, 1.0).tolist()
    return drawn if _agree((r, g, b), drawn) else (r, g, b)


def _agree(read: Color, drawn: Color) -> bool:
    """Whether a drawn colour differs from the picture by no more than illumination could explain."""
    lightness, *chroma = np.abs(_lab(np.array(read)) - _lab(np.array(drawn)))
    return bool(lightness <= SAME_LIGHTNESS and np.hypot(*chroma) <= SAME_CHROMA)


def _find_clear(faces: Faces, visible: SeenFaces, size: tuple[int, ...]) -> Bool[np.ndarray, "S S"]:
    """Pixels whose neighbourhood shows the same finish on the same side of the same part."""
    from scipy.ndimage import maximum_filter, minimum_filter

    label = np.full(size, -1)
    kind = (faces.parts * 64 + faces.roles) * SIDES + faces.sides
    label.ravel()[visible.pixel] = kind[visible.face]
    return maximum_filter(label, 3) == minimum_filter(label, 3)


def _light(
    shape: Shape, points: Float[np.ndarray, "N 3"], camera: Camera
) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N"]]:
    """Illumination of visible points (m): diffuse factor and mirrored light.

    The shape is rendered twice, all black and all grey; the black rendering isolates the mirrored light, with
    shadows included in both.
    """
    from artigen.shapes.render import RenderConfig, batch_cameras, build_scene, render

    straight = look_at(camera.position, camera.target, width=LIGHT_EDGE, height=LIGHT_EDGE)
    off = np.abs(project_points(straight, points)[:, :2] - LIGHT_EDGE / 2).max()
    room = replace(straight, pixel=1.02 * straight.pixel * float(off) / (LIGHT_EDGE / 2))  # shows all of them
    scene = build_scene([_flatten(shape, 0.0), _flatten(shape, GREY)])
    still, cfg = [np.zeros(len(shape.parts))] * 2, RenderConfig(layers=1)
    seen = render(scene, batch_cameras([room] * 2), still, shape_ids=[0, 1], cfg=cfg)
    column, row = np.clip(project_points(room, points)[:, :2].astype(int), 0, LIGHT_EDGE - 1).T
    drawn = seen.rgb.double().numpy()
    black, grey = linear_from_srgb(drawn[:, row, column].mean(axis=2))
    return np.maximum((grey - black) / linear_from_srgb(np.array(GREY)), DARK), black


def _flatten(shape: Shape, level: float) -> Shape:
    """The shape with every finish opaque, without pattern and in one grey (sRGB)."""
    color = (level, level, level)
    return replace(
        shape,
        finishes=tuple(
            (role, replace(finish, color=color, accent=color, opacity=1.0)) for role, finish in shape.finishes
        ),
    )


def _lab(color: Float[np.ndarray, "*S 3"]) -> Float[np.ndarray, "*S 3"]:
    """CIELAB (white point D65) of sRGB colours."""
    xyz = linear_from_srgb(color) @ XYZ_OF_RGB.T / XYZ_OF_RGB.sum(axis=1)
    x, y, z = np.moveaxis(
        np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz * (29 / 6) ** 2 / 3 + 4 / 29), -1, 0
    )
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)
