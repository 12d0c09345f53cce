"""Boundaries of what a hull is made of."""

import numpy as np
import pytest

from sim_export.geometry.hulls import box_hull
from sim_export.package import Link, Mesh, SimPackage, Visual
from sim_export.usd.stage import gather_pieces, hull_material


@pytest.mark.parametrize(("beyond", "material"), [(0.0038, "glass"), (0.0042, "wood_board")])
def test_a_hull_is_of_the_piece_beyond_which_it_reaches_by_up_to_four_millimetres(beyond, material):
    """A pane in a door of wood, and a hull that is a little higher than the pane."""
    pane = box_hull(np.zeros(3), np.array([0.01, 0.4, 0.5]))
    visual = Visual(
        name="pane", part="pane", label="door", mesh=Mesh(vertices=pane.vertices, faces=pane.faces)
    )
    hull = box_hull(np.zeros(3), np.array([0.01, 0.4, 0.5 + beyond]))
    door = Link(name="link_0", label="door", parts=("door",), visuals=(visual,), hulls=(hull,), inertial=None)
    package = SimPackage(
        name="a", category="Oven", visual="voxels", links=(door,), joints=(),
        materials=(("door", "wood_board"), ("pane", "glass")),
    )  # fmt: skip
    assert hull_material(package, door, hull, gather_pieces(package)) == material
