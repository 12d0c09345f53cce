"""Finds holes in the front of objects that are closed all over when their doors and drawers are."""

import numpy as np

from artigen.camera import frame_points
from artigen.kind import find_kind
from artigen.shapes.poses import place_posed
from artigen.shapes.render import RenderConfig, batch_cameras, build_scene, render
from artigen.shapes.shape import Shape
from artigen.sketch.fault import Fault

INSIDE = 0.35
"""Depth behind the front, over that of the object, from which on a point is inside."""
EDGE = 96
"""Pixels of the picture's edge."""
ANGLE = 1.0
"""Angle of view (degrees): nearly parallel rays."""
PLAIN = RenderConfig(shadow_rays=0, openness=False)


def find_front_faults(shape: Shape) -> tuple[Fault, ...]:
    """A fault if more of the front is open than in any object of the grammar of this kind."""
    kind = find_kind(shape.category)
    allowed = None if kind is None else kind.open_front
    if allowed is None or (share := measure_open_front(shape)) <= allowed:
        return ()
    return (Fault(id="open", part=shape.parts[0].name, value=share, allowed=allowed),)


def measure_open_front(shape: Shape) -> float:
    """Share of the silhouette from the front at which the closed object is seen to its inside."""
    closed = np.zeros(len(shape.parts))
    points = place_posed(shape, closed)
    camera = frame_points(points, (-1.0, 0.0, 0.0), fov=ANGLE, width=EDGE, height=EDGE)
    seen = render(build_scene([shape]), batch_cameras([camera]), [closed], cfg=PLAIN)
    shown = seen.depth[0][seen.mask[0]].numpy()
    front = points[:, 0].min() - float(camera.position[0])
    return float((shown - front > INSIDE * np.ptp(points[:, 0])).mean())
