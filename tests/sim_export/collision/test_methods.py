"""Hulls that are not our own: exact primitives, CoACD and V-HACD, of surfaces with closed forms."""

import manifold3d
import numpy as np
import pytest

from sim_export.collision.exact import find_solids
from sim_export.collision.tools import DecompositionFailed, decompose, read_options
from sim_export.errors import ExportError
from sim_export.geometry.hulls import hull_volume
from sim_export.geometry.primitives import find_primitive
from sim_export.geometry.solids import solid_triangles

Solid = manifold3d.Manifold
BLOCK = Solid.cube((0.3, 0.2, 0.1)).rotate((10, 20, 30))
ROD = Solid.cylinder(0.4, 0.05, 0.05, 40).rotate((30, 0, 70)).translate((1, 0, 0))
ELL = Solid.cube((0.3, 0.3, 0.1)) - Solid.cube((0.2, 0.2, 0.2)).translate((0.1, 0.1, -0.05))


def test_boxes_and_cylinders_are_found_exactly():
    box, rod = find_solids(np.concatenate([solid_triangles(BLOCK), solid_triangles(ROD)]), "door")
    shapes = find_primitive(box), find_primitive(rod)
    assert [shape.kind for shape in shapes if shape is not None] == ["box", "cylinder"]
    assert hull_volume(box) == pytest.approx(0.006, rel=1e-5)
    assert shapes[1] is not None
    assert shapes[1].sizes == pytest.approx((0.05, 0.4), rel=1e-5)


def test_boxes_that_share_edges_are_two():
    cube = Solid.cube((0.1, 0.1, 0.1))
    stairs = [solid_triangles(cube), solid_triangles(cube.translate((0.1, 0.0, 0.1)))]
    assert [hull_volume(hull) for hull in find_solids(np.concatenate(stairs), "stairs")] == pytest.approx(
        [1e-3, 1e-3]
    )


@pytest.mark.parametrize("solid", [ELL, Solid.sphere(0.1, 24), BLOCK.hull() + ROD.translate((-1, 0, 0))])
def test_what_is_no_primitive_is_named(solid):
    with pytest.raises(ExportError, match=r"door: its piece 1 of 1, of .* neither a box nor a cylinder"):
        find_solids(solid_triangles(solid), "door")


@pytest.mark.parametrize("tool", ["coacd", "vhacd"])
def test_the_tools_divide_what_is_not_convex(tool):
    hulls = decompose(tool, solid_triangles(ELL), {}, 60.0, "door")
    assert len(hulls) > 1
    assert sum(map(hull_volume, hulls)) == pytest.approx(0.005, rel=0.2)


def test_parameters_are_passed_on_and_unknown_ones_are_told():
    assert read_options("threshold=0.9, pca=true,apx_mode=box") == {
        "threshold": 0.9,
        "pca": True,
        "apx_mode": "box",
    }
    assert len(decompose("coacd", solid_triangles(ELL), {"threshold": 0.9}, 60.0, "door")) == 1
    with pytest.raises(DecompositionFailed, match=r"door: coacd ended.*treshold"):
        decompose("coacd", solid_triangles(ELL), {"treshold": 0.9}, 60.0, "door")
    with pytest.raises(ExportError, match="found 'threshold', expected NAME=VALUE"):
        read_options("threshold")


@pytest.mark.slow
def test_a_tool_that_takes_too_long_is_ended():
    fine = solid_triangles(Solid.sphere(0.1, 400) - Solid.sphere(0.09, 400) - Solid.cube((1, 1, 1)))
    with pytest.raises(DecompositionFailed, match=r"took more than .* raise --budget"):
        decompose("coacd", fine, {}, 2.0, "door")
