"""Laws of trimming: what no hull stands for is left out where others are or pass, and where it is fine."""

from dataclasses import replace

import manifold3d
import numpy as np
import pytest

from sim_export.collision.trimming import trim_meshes
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.solids import as_solid
from sim_export.package import Link, Mesh, PackageJoint

BODY = ((-0.3, -0.4, 0.0), (0.3, 0.4, 0.8))
LEDGE = ((-0.3, 0.4, 0.5), (0.3, 0.5, 0.52))
AROUND = ((-0.4, 0.401, 0.3), (0.4, 0.6, 0.7))
AWAY = ((-0.4, 0.7, 0.3), (0.4, 0.8, 0.7))


def solid(*boxes: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Mesh:
    whole = manifold3d.Manifold()
    for low, high in boxes:
        whole += manifold3d.Manifold.cube(tuple(np.subtract(high, low))).translate(low)
    mesh = whole.to_mesh64()
    return Mesh(
        vertices=np.array(mesh.vert_properties)[:, :3], faces=np.array(mesh.tri_verts, dtype=np.int64)
    )


def link(name: str, item) -> Link:
    hull = box_hull(np.array(item[0]), np.array(item[1]))
    return Link(name=f"link_{name}", label=None, parts=(name,), visuals=(), hulls=(hull,), inertial=None)


def test_a_ledge_inside_of_another_link_is_left_out():
    meshes = {"body": solid(BODY, LEDGE), "other": solid(AROUND)}
    new, records = trim_meshes((link("body", BODY), link("other", AROUND)), [], [], meshes)
    assert [record.split(":")[0] for record in records] == ["body"]
    assert new["other"] is meshes["other"]
    left = as_solid(new["body"]).volume()  # raises unless it is closed
    assert left == pytest.approx(0.6 * 0.8 * 0.8, rel=0.003)
    assert "body" in records[0]


def test_a_ledge_in_free_space_is_shown_whatever_is_felt():
    thick = ((-0.3, 0.4, 0.5), (0.3, 0.5, 0.56))
    meshes = {"body": solid(BODY, thick), "other": solid(AWAY)}
    new, records = trim_meshes((link("body", BODY), link("other", AWAY)), [], [], meshes)
    assert new == meshes
    assert records == ()


def test_a_ledge_in_the_way_of_a_door_is_left_out():
    meshes = {"body": solid(BODY, LEDGE), "other": solid(AWAY)}
    slide = PackageJoint(
        name="joint_0", type="prismatic", kind="prismatic", parent="link_body", child="link_other",
        origin=np.zeros(3), axis=np.array([0.0, -1.0, 0.0]), lower=0.0, upper=0.25,
    )  # fmt: skip
    new, records = trim_meshes((link("body", BODY), link("other", AWAY)), [slide], [], meshes)
    assert [record.split(":")[0] for record in records] == ["body"]
    assert as_solid(new["body"]).volume() == pytest.approx(0.6 * 0.8 * 0.8, rel=0.003)


def test_fine_detail_that_no_hull_stands_for_is_left_out():
    wire = ((-0.3, 0.4, 0.5), (0.3, 0.5, 0.503))
    _, records = trim_meshes((link("body", BODY),), [], [], {"body": solid(BODY, wire)})
    assert [record.split(":")[0] for record in records] == ["body"]


def test_what_is_felt_is_shown_even_inside_of_another_link():
    meshes = {"body": solid(BODY), "other": solid(AROUND)}
    within = ((-0.2, -0.2, 0.2), (0.2, 0.2, 0.4))
    _, records = trim_meshes(
        (link("body", BODY), link("other", within)), [], [], {**meshes, "other": solid(within)}
    )
    assert records == ()


@pytest.mark.parametrize("felt", [False, True])
def test_a_cut_never_leaves_a_loose_piece(felt: bool):  # noqa: FBT001
    """A thin wire carries a knot: both go, or both stay where a hull stands for the knot."""
    wire = ((-0.006, 0.4, 0.497), (0.006, 0.7, 0.509))
    knot = ((-0.01, 0.7, 0.493), (0.01, 0.72, 0.513))
    inside = knot if felt else ((-0.001, 0.709, 0.502), (0.001, 0.711, 0.504))
    body = link("body", BODY)
    body = replace(body, hulls=(*body.hulls, *link("body", inside).hulls))
    new, _ = trim_meshes((body,), [], [], {"body": solid(BODY, wire, knot)})
    assert len(as_solid(new["body"]).decompose()) == 1
    assert new["body"].vertices[:, 1].max() == pytest.approx(0.72 if felt else 0.418, abs=0.001)
