"""`read_shape`: what a reader without error would say of a shape that it sees from somewhere."""

from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.camera import Camera, look_at, project_points
from artigen.reader.layout.relief import find_field
from artigen.reader.reading import Label, Reading, ReadPart
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish

READ: dict[str, Label] = {
    "door": "door", "drawer": "drawer", "handle": "handle", "knob": "knob", "shelf": "shelf", "tray": "shelf",
    "wheel": "wheel",
}  # fmt: skip
LONG = 1.55
"""Ratio of a handle's sides from which it is a bar: the geometric mean of those of a knob and of a cup, which
is the shortest of the others."""
FAR = 1e-3
"""Half the object's diagonal over its distance."""
ABOVE = 0.2
"""Least pitch (radians) from which the sides of hinges are told, so that those of lids have one."""
AHEAD = (0.0, 0.0, FAR)
"""Yaw, pitch (radians) and half the object's diagonal over its distance of a view from straight ahead."""


def read_shape(shape: Shape, *, view: tuple[float, float, float] = AHEAD) -> Reading:
    """The reading of a closed shape; the picture ends at its outline.

    Shelves are left out, as if they were behind doors.

    Args:
        shape: What is seen.
        view: As in `Reading.view`; default: from straight ahead and far away.
    """
    low, high = shape.bounds()
    depth, width, height = (float(length) for length in high - low)
    camera, above = (
        place_camera(low, high, (view[0], pitch, view[2])) for pitch in (view[1], max(view[1], ABOVE))
    )
    corners = [project_points(camera, list_outline(part))[:, :2] for part in shape.parts]
    ends = np.stack([(points.min(axis=0), points.max(axis=0)) for points in corners])
    first, last = ends[:, 0].min(axis=0), ends[:, 1].max(axis=0)
    boxes = ((ends - first) / (last - first)).reshape(-1, 4)
    finishes = dict(shape.finishes)
    parts = [
        _read_part(part, box, finishes, above)
        for part, box in zip(shape.parts, boxes, strict=True)
        if READ.get(part.label, "shelf") != "shelf"
    ]
    fronts = [part for part in parts if part.label in ("door", "drawer")]
    others = [part for part in parts if part.label not in ("door", "drawer")]
    solids = [solid for part in shape.parts for solid in part.primitives]
    largest = max(solids, key=lambda solid: float(np.prod(solid.size))).finish
    red, green, blue = (round(255 * value) for value in finishes.get("body", finishes[largest]).color)
    wide, tall = (last - first) / float((last - first).max()) * 1000.0
    return Reading(
        kind=shape.category,
        kinds=((shape.category, 1.0),),
        box=np.array([0.0, 0.0, 1.0, 1.0]),
        parts=(*fronts, *others),
        size=(width, depth, height),
        view=view,
        stand="flat",
        color=(red, green, blue),
        extent=(max(1, round(float(wide))), max(1, round(float(tall)))),
    )


def place_camera(
    low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"], view: tuple[float, float, float]
) -> Camera:
    """A camera that sees a box (m) as in `Reading.view`."""
    yaw, pitch, near = view
    far = float(np.linalg.norm(high - low)) / 2 / max(near, FAR)
    away = far * np.array([-np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), np.sin(pitch)])
    middle = (low + high) / 2
    return look_at(middle + away, middle)


def list_outline(part: ShapePart) -> Float[np.ndarray, "N 3"]:
    """Points around what is seen of a closed part: of a drawer the corners of its face, from the upper left
    clockwise, since its box is hidden."""
    if part.label == "drawer":
        return find_face(part)
    return np.concatenate([place_vertices(solid) for solid in part.primitives])


def find_face(part: ShapePart) -> Float[np.ndarray, "4 3"]:
    """Corners of the face of a part that looks forward, from the upper left clockwise as seen."""
    (x, y0, z0), (_, y1, z1) = part.bounds()
    return np.array([(x, y1, z1), (x, y0, z1), (x, y0, z0), (x, y1, z0)])


def _read_part(
    part: ShapePart, box: Float[np.ndarray, "4"], finishes: dict[str, Finish], above: Camera
) -> ReadPart:
    """A part as it is seen; left in the picture is +y."""
    ends = part.bounds()
    wide, tall = float(ends[1, 1] - ends[0, 1]), float(ends[1, 2] - ends[0, 2])
    largest = max(part.primitives, key=lambda solid: float(solid.size[1] * solid.size[2]))
    finish = finishes[largest.finish]
    red, green, blue = (round(255 * value) for value in finish.color)
    front = part.label in ("door", "drawer")
    return ReadPart(
        label=READ[part.label],
        score=1.0,
        box=box,
        hinge=_find_hinge(part, above) if part.label == "door" else None,
        pane=finish.kind == "glass",
        field=find_field(part) if front else None,
        material=finish.kind if front else None,
        form=("bar" if max(wide, tall) > LONG * min(wide, tall) else "knob")
        if part.label == "handle"
        else None,
        color=(red, green, blue),
    )


def _find_hinge(part: ShapePart, above: Camera) -> Literal["left", "right", "top", "bottom"] | None:
    """The side of a door that its axis is at; None for a door that slides."""
    if part.joint is None or part.joint.type != "revolute":
        return None
    middle, axis = part.bounds().mean(axis=0), np.array(part.joint.axis)
    origin = np.array(part.joint.origin)
    ends = np.stack([middle, origin + axis * float((middle - origin) @ axis)])
    right, down = np.diff(project_points(above, ends)[:, :2], axis=0)[0]
    if abs(right) > abs(down):
        return "right" if right > 0 else "left"
    return "bottom" if down > 0 else "top"
