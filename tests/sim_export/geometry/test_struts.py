"""Pieces of a link within reach are one after bracing, and nothing else changes."""

import manifold3d
import numpy as np
import pytest
from hull_link import as_mesh, block

from sim_export.geometry.solids import as_solid, solid_arrays
from sim_export.geometry.struts import brace_links, make_struts
from sim_export.package import Inertial, Link

CELL = 0.016
BODY = ((0.0, 0.0, 0.0), (0.4, 0.3, 0.02))


def brace(*parts: manifold3d.Manifold):
    names = tuple(f"part_{k}" for k in range(len(parts)))
    inertial = Inertial(mass=1.0, com=np.zeros(3), inertia=np.eye(3))
    link = Link(name="link_0", label="base", parts=names, visuals=(), hulls=(), inertial=inertial)
    meshes = {name: as_mesh(solid) for name, solid in zip(names, parts, strict=True)}
    new, records = brace_links([link], meshes, CELL)
    whole = manifold3d.Manifold.batch_boolean(
        [as_solid(mesh) for mesh in new.values()], manifold3d.OpType.Add
    )
    return new, records, whole, meshes


def above(gap: float, size=(0.09, 0.06, 0.01)) -> manifold3d.Manifold:
    low = np.array([0.15, 0.1, 0.02 + gap])
    return block(low, low + size)


@pytest.mark.parametrize("gap", [0.0021, 0.02, 2.49 * CELL])
@pytest.mark.parametrize("together", [True, False], ids=["one part", "two parts"])
def test_pieces_within_reach_become_one_by_a_strut_as_narrow_as_a_cell(gap, together):
    parts = (block(*BODY) + above(gap),) if together else (block(*BODY), above(gap))
    before = sum(part.volume() for part in parts)
    _, records, whole, _ = brace(*parts)
    assert len(whole.decompose()) == 1
    assert 0.0 < whole.volume() - before <= gap * CELL**2 * (1.0 + 1e-6)
    assert len(records) == 1


@pytest.mark.parametrize("gap", [0.0, 0.0019, 2.51 * CELL])
def test_what_is_near_enough_or_too_far_stays_as_it_is(gap):
    new, records, _, meshes = brace(block(*BODY), above(gap))
    assert records == ()
    assert new == meshes


@pytest.mark.parametrize(("share", "left"), [(0.49, 1), (0.51, 2)])
def test_a_speck_out_of_reach_is_left_out_and_more_is_not(share, left):
    edge = share ** (1 / 3) * CELL
    _, _, whole, _ = brace(block(*BODY) + above(0.2, (edge, edge, edge)))
    assert len(whole.decompose()) == left


def test_a_row_of_pieces_is_joined_one_to_the_next():
    gaps = 0.02 + np.arange(3) * 0.04
    _, records, whole, _ = brace(block(*BODY), *(above(gap) for gap in gaps))
    assert len(whole.decompose()) == 1
    assert len(records) == 3


def test_the_wall_of_a_void_is_no_piece():
    hollow = block((0, 0, 0), (0.3, 0.3, 0.3)) - block((0.05, 0.05, 0.05), (0.25, 0.25, 0.25))
    assert brace(hollow)[1] == ()


@pytest.mark.parametrize(("length", "count"), [(0.029, 1), (0.0315, 2), (0.2, 2)])
def test_a_bar_of_three_times_its_width_is_held_near_its_ends(length, count):
    bar = block((0.1, 0.1, 0.05), (0.1 + length, 0.11, 0.06))
    _, _, whole, _ = brace(block(*BODY) + bar)
    struts = (whole ^ block((0.0, 0.0, 0.03), (0.4, 0.3, 0.04))).decompose()
    middles = sorted(float(np.mean(solid_arrays(strut)[0][:, 0])) for strut in struts)
    assert len(middles) == count
    if count == 2:
        assert middles[0] < 0.1 + 0.2 * length
        assert middles[1] > 0.1 + 0.8 * length


def test_a_strut_stands_half_its_width_in_what_it_connects():
    """Plates of 3 mm, 20 mm apart, through which a strut as wide as a cell of 16 mm reaches."""
    plates = [block((0.0, 0.0, low), (0.2, 0.2, low + 0.003)) for low in (0.0, 0.023)]
    _, _, whole, _ = brace(*plates)
    assert np.ptp(solid_arrays(whole)[0][:, 2]) == pytest.approx(0.02 + 2 * 0.5 * CELL, rel=1e-6)


@pytest.mark.parametrize("thickness", [0.0005, 0.0009, 0.0011, 0.003])
def test_a_bar_as_thin_as_a_sheet_is_held_near_its_ends_as_well(thickness: float):
    sheet = block((0.0, 0.0, 0.0), (0.2, 0.1, thickness))
    bar = block((0.0, 0.04, thickness + 0.005), (0.2, 0.06, 2.0 * thickness + 0.005))
    ends = np.array([[0.1, 0.05, thickness + 0.005], [0.1, 0.05, thickness]])
    assert len(make_struts(bar, sheet, ends, 0.004).decompose()) == 2
