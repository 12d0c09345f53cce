"""Tops of furniture, on which other things stand, and what its doors pass."""

import numpy as np
import pytest
from box_furniture import solid_link

from artigen.types import Joint
from envs.rooms.footprints import measure_footprint
from envs.rooms.pieces import overlap
from sim_export.geometry.hulls import box_hull
from sim_export.package import Link, SimPackage


@pytest.mark.parametrize(("lower", "tops"), [(0.0039, 2), (0.0041, 1)])
def test_a_top_is_level_to_four_millimetres(lower: float, tops: int):
    halves = (
        box_hull(np.zeros(3), np.array([0.5, 0.5, 0.8])),
        box_hull(np.array([0.0, 0.5, 0.0]), np.array([0.5, 1.0, 0.8 - lower])),
    )
    link = Link(name="body", label="base", parts=("body",), visuals=(), inertial=None, hulls=halves)
    package = SimPackage(name="table", category="Table", visual="voxels", links=(link,), joints=())
    assert len(measure_footprint(package).tops) == tops


@pytest.mark.parametrize(("away", "free"), [(0.071, False), (0.074, True)])
def test_at_its_hinge_a_door_takes_as_much_room_as_a_sixth_of_it(away: float, free: object):
    """A door wider than high, 60 cm by 2 mm, which opens 45 degrees: 10 cm of it come 7.2 cm out."""
    links = tuple(
        Link(name=name, label=label, parts=(name,), visuals=(), inertial=None, hulls=(hull,))
        for name, label, hull in (
            ("leaf", "door", box_hull(np.array([-0.002, 0.0, 0.0]), np.array([0.0, 0.6, 0.5]))),
            ("body", "base", box_hull(np.zeros(3), np.array([0.5, 0.6, 0.5]))),
        )
    )
    joint = Joint(
        name="hinge", type="revolute", parent="body", child="leaf", origin=np.zeros(3),
        axis=np.array([0.0, 0.0, 1.0]), upper=np.pi / 4,
    )  # fmt: skip
    package = SimPackage(name="cabinet", category="Table", visual="voxels", links=links, joints=(joint,))
    post = np.array([[[-0.5, 0.0, 0.0], [-away, 0.05, 0.5]]])
    assert overlap(measure_footprint(package).sweeps, post) != free


def test_the_face_is_that_of_a_framed_front_and_not_of_its_handle_or_the_back_of_a_drawer():
    frame = [((-0.02, 0.0, z), (0.0, 0.6, z + 0.09)) for z in (0.1, 0.31)]
    boxes = [*frame, ((-0.01, 0.0, 0.19), (0.0, 0.6, 0.31)), ((0.4, 0.0, 0.1), (0.42, 0.6, 0.4))]
    bar = ((-0.05, 0.2, 0.2), (-0.02, 0.4, 0.22))
    drawer = solid_link("drawer", "drawer", [*boxes, bar])
    links = (drawer, solid_link("body", "base", [((0.0, 0.0, 0.0), (0.45, 0.6, 0.1))]))
    package = SimPackage(name="cabinet", category="Table", visual="voxels", links=links, joints=())
    assert measure_footprint(package).face == pytest.approx(-0.02)
