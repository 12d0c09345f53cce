"""A drawer of boxes in a frame, as a package."""

import numpy as np
from hull_link import box, make_joint

from sim_export.geometry.hulls import convex_hull
from sim_export.package import Link, SimPackage


def box_drawer(
    *, depth: float = 0.3, rim: float = 0.06, room: float = 0.1, dividers: int = 0, slope: float = 0.0
) -> SimPackage:
    """A drawer of 30 cm by ``depth``, divided along its depth.

    Args:
        rim: Height of its walls above the floor.
        room: Height of the space between its floor and the board above.
        slope: Fall of the floor towards its far end.
    """
    corners = [(x, y, z) for x in (0.0, depth) for y in (0.0, 0.3) for z in (0.0, 0.01)]
    floor = convex_hull(np.array([(x, y, z - slope * (z > 0.0 and x > 0.0)) for x, y, z in corners]))
    walls = [
        box((-0.01, -0.01, 0.0), (0.0, 0.31, 0.01 + rim)),
        box((depth, -0.01, 0.0), (depth + 0.01, 0.31, 0.01 + rim)),
        box((0.0, -0.01, 0.0), (depth, 0.0, 0.01 + rim)),
        box((0.0, 0.3, 0.0), (depth, 0.31, 0.01 + rim)),
    ]
    places = np.linspace(0.0, depth, dividers + 2)[1:-1]
    walls += [box((x - 0.002, 0.0, 0.01), (x + 0.002, 0.3, 0.01 + rim)) for x in places]
    roof = box((-0.02, -0.02, 0.01 + room), (depth + 0.02, 0.32, 0.03 + room))
    links = tuple(
        Link(name=name, label=label, parts=(name,), visuals=(), inertial=None, hulls=hulls)
        for name, label, hulls in (("slide", "drawer", (floor, *walls)), ("body", "base", (roof,)))
    )
    joint = make_joint("slide", "prismatic", (-1, 0, 0), (0, 0, 0), 0.25)
    return SimPackage(name="drawer", category="Box", visual="voxels", links=links, joints=(joint,))
