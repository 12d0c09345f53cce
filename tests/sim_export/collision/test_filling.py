"""Laws of filling: thin gaps that hulls fill are filled in the mesh, wide ones and small ones stay."""

import numpy as np
import pytest
from hull_link import link, solid

from sim_export.collision.trimming import fill_meshes
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.solids import as_solid
from sim_export.package import Mesh

VOXEL = 0.015
HULL = ((-0.3, -0.4, 0.0), (0.3, 0.4, 0.4))


def slab_with_gap(depth: float) -> Mesh:
    """A slab on two rails, ``depth`` metres high and 0.1 m wide, within ``HULL``."""
    return solid(
        ((-0.3, -0.4, depth), (0.3, 0.4, 0.4)),
        ((-0.3, -0.4, 0.0), (-0.2, 0.4, depth)),
        ((0.2, -0.4, 0.0), (0.3, 0.4, depth)),
    )


def fill(mesh: Mesh, voxel: float = VOXEL):
    hull = box_hull(np.array(HULL[0]), np.array(HULL[1]))
    return fill_meshes((link("body", hull),), {"body": mesh}, voxel)


def test_a_gap_below_the_reach_is_filled_and_said_so():
    new, records = fill(slab_with_gap(0.05), voxel=0.04)
    assert as_solid(new["body"]).volume() == pytest.approx(0.6 * 0.8 * 0.4, rel=1e-6)
    assert records[0].startswith("body: its mesh fills gaps")


@pytest.mark.parametrize(("cells", "filled"), [(1.58, True), (1.68, False)])
def test_gaps_are_filled_if_they_are_less_than_1_6_cells_deep(cells: float, filled: object):
    """The deepest point at which that is measured lies a fiftieth of the depth before the end of the gap."""
    _, records = fill(slab_with_gap(0.05), voxel=0.05 / cells)
    assert (len(records) == 1) == filled


@pytest.mark.parametrize(("depth", "why"), [(0.05, "deeper than the reach"), (0.02, "a small share")])
def test_other_gaps_stay_open(depth: float, why: str):
    mesh = slab_with_gap(depth)
    new, records = fill(mesh)
    assert new["body"] is mesh, why
    assert records == ()
