"""Floors of drawers: how level they are, and how many compartments one has."""

import numpy as np
import pytest
from hull_link import box

from artigen.types import Joint
from envs.rooms.compartments import find_compartments
from sim_export.geometry.hulls import convex_hull
from sim_export.package import Link, SimPackage


def drawer(depth: float, *, dividers: int = 0, slope: float = 0.0) -> SimPackage:
    """A drawer of 30 cm by ``depth`` below a board, divided along its depth; its floor slopes by so much."""
    corners = [(x, y, z) for x in (0.0, depth) for y in (0.0, 0.3) for z in (0.0, 0.01)]
    floor = convex_hull(np.array([(x, y, z - slope * (z > 0.0 and x > 0.0)) for x, y, z in corners]))
    walls = [
        box((-0.01, -0.01, 0.0), (0.0, 0.31, 0.07)),
        box((depth, -0.01, 0.0), (depth + 0.01, 0.31, 0.07)),
        box((0.0, -0.01, 0.0), (depth, 0.0, 0.07)),
        box((0.0, 0.3, 0.0), (depth, 0.31, 0.07)),
    ]
    places = np.linspace(0.0, depth, dividers + 2)[1:-1]
    walls += [box((x - 0.002, 0.0, 0.01), (x + 0.002, 0.3, 0.07)) for x in places]
    links = tuple(
        Link(name=name, label=label, parts=(name,), visuals=(), inertial=None, hulls=hulls)
        for name, label, hulls in (
            ("slide", "drawer", (floor, *walls)),
            ("body", "base", (box((-0.02, -0.02, 0.11), (depth + 0.02, 0.32, 0.13)),)),
        )
    )
    joint = Joint(
        name="joint", type="prismatic", parent="body", child="slide", origin=np.zeros(3),
        axis=np.array([-1.0, 0.0, 0.0]), upper=0.25,
    )  # fmt: skip
    return SimPackage(name="drawer", category="Box", visual="voxels", links=links, joints=(joint,))


@pytest.mark.parametrize(("slope", "count"), [(0.9e-4, 1), (1.1e-4, 0)])
def test_a_floor_is_level_to_a_tenth_of_a_millimetre(slope: float, count: int):
    assert len(find_compartments(drawer(0.3, slope=slope))) == count


@pytest.mark.parametrize(("parts", "found"), [(2, 2), (3, 3), (4, 3), (5, 3)])
def test_a_floor_has_up_to_three_compartments(parts: int, found: int):
    assert len(find_compartments(drawer(0.2 * parts, dividers=parts - 1))) == found
