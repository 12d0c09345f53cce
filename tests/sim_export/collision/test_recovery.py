"""Laws of recovery: what is shown is felt again, within the limits, and whatever was free stays free."""

import manifold3d
import numpy as np

from sim_export.collision.hull_limits import MOST_OF_LINK
from sim_export.collision.recovery import recover_surface
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import box_hull
from sim_export.package import Link, Mesh

BODY = ((-0.3, -0.4, 0.0), (0.3, 0.4, 0.8))
LEDGE = ((-0.3, 0.4, 0.5), (0.3, 0.5, 0.52))
STILL = np.eye(4)


def solid(*boxes: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Mesh:
    whole = manifold3d.Manifold()
    for low, high in boxes:
        whole += manifold3d.Manifold.cube(tuple(np.subtract(high, low))).translate(low)
    mesh = whole.to_mesh64()
    return Mesh(
        vertices=np.array(mesh.vert_properties)[:, :3], faces=np.array(mesh.tri_verts, dtype=np.int64)
    )


def link(name: str, *hulls) -> Link:
    return Link(name=name, label=None, parts=(name,), visuals=(), hulls=hulls, inertial=None)


def box(item) -> object:
    return box_hull(np.array(item[0]), np.array(item[1]))


def test_a_ledge_that_no_hull_stands_for_is_put_back():
    links = (link("body", box(BODY)),)
    new, records = recover_surface(links, [], [], {"body": solid(BODY, LEDGE)})
    assert len(new[0].hulls) == 2
    ledge = new[0].hulls[1]
    np.testing.assert_allclose(ledge.vertices.max(axis=0), LEDGE[1], atol=1e-6)
    assert "body: 1 hulls put back" in records[0]
    assert "left" not in records[0]


def test_a_link_that_lacks_nothing_is_the_same_object():
    links = (link("body", box(BODY)),)
    new, records = recover_surface(links, [], [], {"body": solid(BODY)})
    assert new[0] is links[0]
    assert records == ()


def test_a_hull_that_is_put_back_keeps_clear_of_others():
    neighbour = ((-0.3, 0.46, 0.3), (0.3, 0.6, 0.7))
    links = (link("body", box(BODY)), link("other", box(neighbour)))
    meshes = {"body": solid(BODY, LEDGE), "other": solid(neighbour)}
    new, records = recover_surface(links, [], [], meshes)
    assert len(new[0].hulls) == 2
    apart = signed_distances(HullSet(hulls=new[0].hulls), HullSet(hulls=new[1].hulls), STILL, STILL, 1.0)
    assert apart.distance.min() >= 2e-4
    assert "mm are left" in records[0]


def test_what_lies_inside_of_another_link_is_only_reported():
    neighbour = ((-0.4, 0.401, 0.3), (0.4, 0.6, 0.7))
    links = (link("body", box(BODY)), link("other", box(neighbour)))
    new, records = recover_surface(links, [], [], {"body": solid(BODY, LEDGE), "other": solid(neighbour)})
    assert new[0] is links[0]
    assert "body: 0 hulls put back" in records[0]


def test_a_full_link_gets_no_more_hulls():
    step = 0.8 / MOST_OF_LINK
    slices = [((-0.3, -0.4, z * step), (0.3, 0.4, (z + 1) * step)) for z in range(MOST_OF_LINK)]
    links = (link("body", *(box(item) for item in slices)),)
    new, records = recover_surface(links, [], [], {"body": solid(BODY, LEDGE)})
    assert new[0] is links[0]
    assert "mm are left" in records[0]
