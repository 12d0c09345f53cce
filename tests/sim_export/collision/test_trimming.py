"""Laws of trimming: what no hull stands for is left out where others are or pass, and where it is fine."""

from dataclasses import replace

import manifold3d
import numpy as np
import pytest
from hull_link import solid

from artigen.types import Joint
from sim_export.collision.trimming import fill_meshes, trim_meshes
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.solids import as_solid
from sim_export.package import Link, Mesh

BODY = ((-0.3, -0.4, 0.0), (0.3, 0.4, 0.8))
LEDGE = ((-0.3, 0.4, 0.5), (0.3, 0.5, 0.52))
AROUND = ((-0.4, 0.401, 0.3), (0.4, 0.6, 0.7))
AWAY = ((-0.4, 0.7, 0.3), (0.4, 0.8, 0.7))


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
    slide = Joint(
        name="joint_0", type="prismatic", parent="link_body", child="link_other",
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


WIDE = 0.3
"""Half the width (m) of the body."""


def hair(length: float, thickness: float, *, wide: float = WIDE, at: float = 0.5, side: float = 1.0):
    """A ledge ``length`` (m) long on the body's right side, or on its left one, for which no hull stands."""
    ends = sorted((side * 0.4, side * (0.4 + length)))
    return (-wide, ends[0], at), (wide, ends[1], at + thickness)


def trimmed(*ledges, scale: float = 1.0) -> Mesh:
    """The mesh of a body with some ledges; a ``scale`` times as large object is trimmed."""
    mesh = solid(BODY, *ledges)
    mesh = replace(mesh, vertices=scale * mesh.vertices)
    body = link("body", tuple(scale * np.array(end) for end in BODY))
    return trim_meshes((body,), [], [], {"body": mesh})[0]["body"]


def is_trimmed(*ledges, scale: float = 1.0) -> bool:
    whole, left = as_solid(solid(BODY, *ledges)).volume(), as_solid(trimmed(*ledges, scale=scale)).volume()
    return left < scale**3 * whole * (1.0 - 1e-6)


def diagonal_with(length: float, sides: int = 1) -> float:
    """That of a body with a ledge (m)."""
    return float(np.linalg.norm([0.6, 0.8 + sides * length, 0.8]))


def test_what_is_left_out_begins_0_011_of_the_diagonal_from_the_hulls():
    """Surface is lost from 0.013 on, and is cut 0.002 before that."""
    left = trimmed(hair(0.1, 0.003)).vertices[:, 1].max() - 0.4
    assert left == pytest.approx((0.013 - 0.002) * diagonal_with(0.1), abs=4e-4)


@pytest.mark.parametrize(("share", "left_out"), [(0.025, False), (0.027, True)])
def test_little_is_left_out_if_it_is_0_026_of_the_diagonal_from_the_hulls(share, left_out):
    assert is_trimmed(hair(share * diagonal_with(0.034), 0.005)) is left_out


@pytest.mark.parametrize(("share", "left_out"), [(0.0074, False), (0.0086, True)])
def test_all_that_is_lost_is_left_out_if_it_is_0_008_of_the_surface(share, left_out):
    """Ledges 32 mm long, of which all but 17 mm is lost, on both sides of a body."""
    lost = 2.0 * (0.032 - 0.013 * diagonal_with(0.032, 2)) + 0.005
    wide = share * 2.0 * (0.6 * 0.8 + 0.6 * 0.8 + 0.8 * 0.8) / (2.0 * lost - 2.0 * share * (2.0 * 0.032))
    ledges = [hair(0.032, 0.005, wide=wide / 2.0, side=side) for side in (-1.0, 1.0)]
    assert is_trimmed(*ledges) is left_out


@pytest.mark.parametrize(("apart", "straight"), [(0.078, True), (0.082, False)])
def test_teeth_are_cut_off_straight_if_they_are_less_than_0_08_of_the_diagonal_apart(apart, straight):
    """Two teeth on a ledge, of which nothing is lost beside them."""
    size = diagonal_with(0.1)
    inner = apart * size / 2.0
    teeth = [((low, 0.4, 0.5), (high, 0.5, 0.503)) for low, high in ((-0.3, -inner), (inner, 0.3))]
    left = as_solid(trimmed(hair(0.0128 * size, 0.003), *teeth))
    between = manifold3d.Manifold.cube((0.02, 0.1, 0.1)).translate((-0.01, 0.4, 0.45))
    beyond = (left ^ between).bounding_box()[4] - 0.4
    assert beyond == pytest.approx((0.011 if straight else 0.0128) * size, abs=4e-4)


@pytest.mark.parametrize(("share", "left_out"), [(0.0048, True), (0.0052, False)])
def test_detail_is_fine_up_to_0_005_of_the_volume_of_a_part(share, left_out):
    """In free space; a ledge is lost but for 0.011 of the diagonal."""
    lost = 0.1 - 0.011 * diagonal_with(0.1)
    thickness = share * 0.384 / (0.2 * lost - share * 0.2 * 0.1)
    assert is_trimmed(hair(0.1, thickness, wide=0.1)) is left_out


@pytest.mark.parametrize(("growth", "left_out"), [(1.45, True), (1.55, False)])
def test_what_is_lost_is_the_skin_of_more_if_it_grows_by_half_where_it_is_cut_out_wider(growth, left_out):
    """By 0.004 of the diagonal; there is another ledge, of which enough is lost."""
    size = diagonal_with(0.12)
    length = (0.011 + 0.004 / (growth - 1.0)) * size
    left = trimmed(hair(0.1, 0.003, side=-1.0), hair(length, 0.003)).vertices[:, 1].max() - 0.4
    assert left == pytest.approx(0.011 * size if left_out else length, abs=5e-4)


@pytest.mark.parametrize(("share", "left_out"), [(0.9e-4, False), (1.1e-4, True)])
def test_less_than_a_ten_thousandth_of_a_part_is_not_left_out(share, left_out):
    lost = 0.06 - 0.011 * diagonal_with(0.06)
    assert is_trimmed(hair(0.06, share * 0.384 / (0.6 * lost))) is left_out


@pytest.mark.parametrize(("volume", "left_out"), [(0.9e-9, False), (1.1e-9, True)])
def test_pieces_smaller_than_a_cubic_millimetre_are_flat(volume, left_out):
    """A ledge of a body that is 8 mm high."""
    lost = 0.1 - 0.011 * diagonal_with(0.1)
    assert is_trimmed(hair(0.1, 1e6 * volume / (0.6 * lost)), scale=0.01) is left_out


@pytest.mark.parametrize(("volume", "felt"), [(0.9e-7, False), (1.1e-7, True)])
def test_a_wire_stays_that_carries_a_tenth_of_a_cubic_centimetre_that_is_felt(volume, felt):
    """A knot, whose volume (m^3) that is, hangs on a body that is 8 cm high."""
    edge = 10.0 * np.cbrt(volume)
    wire = (-0.01, 0.4, 0.5), (0.01, 0.7, 0.52)
    knot = (-edge / 2.0, 0.7, 0.5), (edge / 2.0, 0.7 + edge, 0.5 + edge)
    mesh = solid(BODY, wire, knot)
    mesh = replace(mesh, vertices=0.1 * mesh.vertices)
    body = link("body", tuple(0.1 * np.array(end) for end in BODY))
    body = replace(body, hulls=(*body.hulls, *link("body", tuple(0.1 * np.array(end) for end in knot)).hulls))
    new, _ = trim_meshes((body,), [], [], {"body": mesh})
    assert (new["body"] is mesh) is felt


def is_filled(mesh: Mesh, *hulls, voxel: float) -> bool:
    """Whether the mesh of a body takes in some of what its hulls fill."""
    body = replace(
        link("body", BODY), hulls=tuple(box_hull(np.array(low), np.array(high)) for low, high in hulls)
    )
    return len(fill_meshes((body,), {"body": mesh}, voxel)[1]) > 0


def slotted(*slots) -> Mesh:
    """A body with slots across its top, each from one y to another and so deep."""
    mesh = as_solid(solid(BODY))
    for low, high, depth in slots:
        mesh -= as_solid(solid(((-0.4, low, 0.8 - depth), (0.4, high, 0.9))))
    cut = mesh.to_mesh64()
    return Mesh(vertices=np.array(cut.vert_properties)[:, :3], faces=np.array(cut.tri_verts, dtype=np.int64))


@pytest.mark.parametrize(("share", "filled"), [(0.049, False), (0.051, True)])
def test_hulls_may_fill_a_twentieth_of_a_link_without_any_change(share, filled):
    width = 0.64 * share / (1.0 + share) / 0.2
    assert is_filled(slotted((0.0, width, 0.2)), BODY, voxel=0.2) is filled


@pytest.mark.parametrize(("share", "filled"), [(0.0009, False), (0.0011, True)])
def test_a_hull_is_left_alone_that_fills_less_than_a_thousandth_of_a_link(share, filled):
    """Hulls fill a slot that is too deep, and a share of the link in another one."""
    width = 0.64 * share * (1.0 - 0.2 * 0.5 / 0.64) / 0.02
    mesh = slotted((-0.3, -0.1, 0.5), (0.1, 0.1 + width, 0.02))
    hulls = ((-0.3, -0.4, 0.0), (0.3, 0.0, 0.8)), ((-0.3, 0.0, 0.0), (0.3, 0.4, 0.8))
    assert is_filled(mesh, *hulls, voxel=0.02) is filled
