"""Fingerprints tell objects apart by a tenth of a millimetre, and measure how much of a surface moves."""

import numpy as np
import pytest
from triangle_box import box

from sim_export.fingerprint import describe_surface, hash_geometry, quantise
from sim_export.package import Link, Mesh, SimPackage, Visual


def package_of(*triangles) -> SimPackage:
    corners = np.array(triangles, dtype=float).reshape(-1, 3)
    mesh = Mesh(vertices=corners, faces=np.arange(len(corners)).reshape(-1, 3))
    visual = Visual(name="base", part="base", label="base", mesh=mesh)
    link = Link(name="link_0", label="base", parts=("base",), visuals=(visual,), hulls=(), inertial=None)
    return SimPackage(name="a", category="Thing", visual="source", links=(link,), joints=())


@pytest.mark.parametrize(("height", "same"), [(0.4e-4, True), (0.6e-4, False)])
def test_geometry_is_rounded_to_tenths_of_a_millimetre(height: float, *, same: bool):
    level, raised = ([(0, 0, 0), (1, 0, 0), (0, 1, z)] for z in (0.0, height))
    assert (hash_geometry(package_of(level)) == hash_geometry(package_of(raised))) == same


def test_a_surface_is_described_by_eight_cells_along_each_side():
    """A cube: 16 of 64 cells of each of its faces lie at none of its edges, with 1 / 384 of its surface."""
    shares = describe_surface(package_of(*box((0, 0, 0), (1, 1, 1))))
    assert shares.shape == (2, 8, 8, 8)
    np.testing.assert_allclose(shares[0, 2:6, 2:6, 0], 1 / 384, rtol=0.05)
    assert shares[0, 1:7, 1:7, 1:7].sum() == 0.0


@pytest.mark.parametrize(("longest", "whole"), [(0.49, True), (0.51, False)])
def test_a_triangle_counts_in_its_middle_if_it_is_no_longer_than_half_a_cell(longest: float, *, whole: bool):
    """Cells of 1 m; a line between the corners of the object, without area, gives it its size."""
    side = longest / np.sqrt(2.0)
    triangle = np.array([(0, 0, 0), (side, 0, 0), (0, side, 0)])
    line = np.array([(0, 0, 0), (8, 8, 8), (8, 8, 8)])
    shares = describe_surface(package_of(triangle - triangle.mean(axis=0) + 4.5, line))
    assert (shares[0, 4, 4, 4] > 1.0 - 1e-9) == whole


def test_shares_are_stored_in_65535_steps():
    shares = np.zeros((2, 8, 8, 8))
    shares[0, 0, 0, :2] = 1.0, 0.5
    stored = np.frombuffer(quantise(shares), "<u2")
    assert stored[:2].tolist() == [65535, 32768]
