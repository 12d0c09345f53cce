"""Sweeps miss nothing: samples lie as close as they are said to, and plates between them are met."""

from typing import Literal

import numpy as np
import pytest

from artigen.types import Joint
from sim_export.collision.attachment import add_hull
from sim_export.geometry.contacts import HullSet
from sim_export.geometry.hulls import box_hull, convex_hull
from sim_export.motion.kinematics import farthest_travel, link_displacements, read_sweeps, sample_range
from sim_export.package import Hull, Link

LEAF = box_hull(np.array([0.0, 0.0, 0.0]), np.array([0.02, 0.8, 1.0]))
"""A door of 0.8 m that turns about its edge, or slides."""


def package(kind: Literal["revolute", "prismatic"], upper: float) -> tuple[list[Link], list[Joint]]:
    links = [
        Link(name=name, label=None, parts=(name,), visuals=(), hulls=hulls, inertial=None)
        for name, hulls in (("base", ()), ("door", (LEAF,)))
    ]
    axis = np.array([0.0, 0.0, 1.0]) if kind == "revolute" else np.array([-1.0, 0.0, 0.0])
    joint = Joint(
        name="joint", type=kind, parent="base", child="door",
        origin=np.zeros(3), axis=axis, upper=upper,
    )  # fmt: skip
    return links, [joint]


@pytest.mark.parametrize(("kind", "upper"), [("revolute", 2.1), ("revolute", 0.01), ("prismatic", 0.4)])
def test_no_point_moves_farther_than_a_step(kind: Literal["revolute", "prismatic"], upper: float):
    links, joints = package(kind, upper)
    q = sample_range(joints[0], [LEAF.vertices], 0.007, (41, 401))
    T = link_displacements(links, joints, {"joint": q})
    points = np.c_[LEAF.vertices, np.ones(len(LEAF.vertices))]
    moved = np.einsum("pij,vj->pvi", T[:, 1], points)[..., :3]
    steps = np.linalg.norm(np.diff(moved, axis=0), axis=2)
    assert steps.max() <= 0.007
    assert len(T) >= 41
    assert steps.sum(axis=0).max() == pytest.approx(farthest_travel(joints[0], [LEAF.vertices]), rel=1e-3)


@pytest.mark.parametrize("angle", np.linspace(0.5, 0.56, 7))
def test_a_plate_that_the_edge_of_a_door_passes_is_in_its_way(angle: float):
    """5 mm thick, 3 mm into the way of the corner: 41 samples, 41 mm apart, jump over two of the seven."""
    links, joints = package("revolute", 2.1)
    at = 0.8 * np.array([-np.sin(angle), np.cos(angle)])
    plate = _turned(box_hull(np.array([-0.0025, -0.003, 0.4]), np.array([0.0025, 0.02, 0.5])), angle, at)
    sets = [HullSet(hulls=link.hulls) for link in links]
    made = add_hull(sets, read_sweeps(links, joints, ()), 0, plate, plate)
    assert made is None
    beyond = Hull(vertices=plate.vertices + 0.01 * np.r_[at / 0.8, 0.0], faces=plate.faces)
    assert add_hull(sets, read_sweeps(links, joints, ()), 0, beyond, beyond)


def _turned(hull: Hull, angle: float, at: np.ndarray) -> Hull:
    """With its middle axes along the circle and outward at the place that the corner passes."""
    out, along = at / np.linalg.norm(at), np.array([-np.cos(angle), -np.sin(angle)])
    x, y, z = hull.vertices.T
    plane = at + x[:, None] * along + y[:, None] * out
    return convex_hull(np.c_[plane, z])
