"""Boundaries of reference packages: sizes of texels, and when pieces of a part stay apart."""

import pytest

from artigen.shapes.primitives import box
from artigen.shapes.shape import Shape, make_base
from artigen.shapes.surfaces.finishes import Finish
from sim_export.package import Mesh
from sim_export.reference import ReferenceConfig, build_reference

GREY = Finish(kind="lacquer", color=(0.5, 0.5, 0.5), accent=(0.5, 0.5, 0.5))


def show(*ends: tuple) -> Mesh:
    """The mesh of an object of boxes."""
    body = make_base([box(low, high, "grey") for low, high in ends])
    shape = Shape(category="Thing", seed=0, style="plain", parts=(body,), finishes=(("grey", GREY),))
    (visual,) = build_reference(shape, ReferenceConfig(detail="low")).links[-1].visuals
    assert isinstance(visual.mesh, Mesh)
    return visual.mesh


@pytest.mark.parametrize(("others", "faces"), [(21, 23 * 12), (22, 22 * 12 + 40)])
def test_pieces_stay_apart_if_more_than_a_hundredth_of_their_union_are_slivers(others, faces):
    """One of two boxes rises 50 micrometres above the other: the union of both has 40 triangles, and 4 of
    them are slivers. With 21 boxes beside them these are 4 of 292, with 22 they are 4 of 304.
    """
    pair = ((0.0, 0.0, 0.0), (1.0, 0.25, 0.25)), ((0.0, 0.0625, 0.125), (1.0, 0.1875, 0.25005))
    places = [0.5 * place for place in range(23 - others, 23)]
    beside = [((0.0, place, 0.0), (0.25, place + 0.25, 0.5)) for place in places]
    assert len(show(*pair, *beside).faces) == faces
