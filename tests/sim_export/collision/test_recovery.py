"""Laws of recovery: what is shown is felt again, within the limits, and whatever was free stays free."""

import manifold3d
import numpy as np
import pytest
from hull_link import link, solid

from artigen.transforms import rotation_about
from sim_export.collision.hull_limits import MOST_OF_LINK
from sim_export.collision.recovery import recover_hulls, recover_surface
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import box_hull, convex_hull
from sim_export.package import Mesh

BODY = ((-0.3, -0.4, 0.0), (0.3, 0.4, 0.8))
LEDGE = ((-0.3, 0.4, 0.5), (0.3, 0.5, 0.52))
STILL = np.eye(4)


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


def test_what_a_cut_took_too_much_of_is_put_back_up_to_what_it_was_cut_for():
    """A shelf that went as a whole, because of a post before it."""
    kept, shelf = box(BODY), box(LEDGE)
    post = box(((-0.31, 0.43, 0.3), (0.28, 0.6, 0.7)))
    before = (link("body", kept, shelf), link("post", post))
    new, records = recover_hulls(before, (link("body", kept), before[1]), [], [])
    assert new[0].hulls[0] is kept
    assert new[1] is before[1]
    back = HullSet(hulls=new[0].hulls[1:])
    assert signed_distances(back, HullSet(hulls=(post,)), STILL, STILL, 1.0).distance.min() >= 2e-4
    assert back.vertices[:, 1].max() == pytest.approx(0.43 - 0.0025, abs=1e-6)
    assert "body:" in records[0]


def test_links_that_were_not_cut_stay_the_same_objects():
    links = (link("body", box(BODY)), link("other", box(FAR)))
    assert recover_hulls(links, links, [], []) == (links, ())


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


FAR = ((-0.3, 0.46, 0.3), (0.3, 0.6, 0.7))


def recover(mesh: Mesh, *others) -> tuple:
    """Hulls of a body that is shown as ``mesh`` and has one hull for its box, beside a link of others."""
    links = (link("body", box(BODY)), link("other", *others))
    return recover_surface(links, [], [], {"body": mesh, "other": solid(FAR)})[0][0].hulls


def test_a_hull_that_is_put_back_ends_two_and_a_half_millimetres_before_others():
    _, ledge = recover(solid(BODY, LEDGE), box(FAR))
    assert ledge.vertices[:, 1].max() == pytest.approx(0.46 - 0.0025, abs=1e-6)


@pytest.mark.parametrize(("teeth", "put_back"), [(12, 12), (13, 12)])
def test_hulls_are_put_back_in_twelve_places_at_most(teeth, put_back):
    """Teeth, 0.1 m apart in each row, that no hull stands for."""
    places = [(0.1 * (number % 6) - 0.28, 0.1 + 0.2 * (number // 6)) for number in range(teeth)]
    mesh = solid(BODY, *(((x, 0.4, z), (x + 0.04, 0.5, z + 0.04)) for x, z in places))
    assert len(recover(mesh)) == 1 + put_back


@pytest.mark.parametrize(("free", "put_back"), [(0.096, 1), (0.07, 0)])
def test_an_eighth_of_a_ledge_is_put_back_where_all_else_of_it_is_in_another_link(free, put_back):
    """A hull reaches 13 mm into what is left of a ledge 0.6 m long; so much (m) of it is free."""
    around = box(((-0.4, 0.401, 0.499), (0.3 - free, 0.6, 0.505)))
    assert len(recover(solid(BODY, ((-0.3, 0.4, 0.5), (0.3, 0.5, 0.503))), around)) == 1 + put_back


@pytest.mark.parametrize(("places", "pieces"), [(7, 1), (8, 2)])
def test_a_hull_that_is_put_back_is_cut_at_seven_places_or_in_halves(places, pieces):
    """A disc is pushed in from all sides; the last of eight rounds only finds that it is free."""
    turns = 2.0 * np.pi * (np.arange(16) + 0.5) / 16
    rim = np.array([[0.2 * np.cos(turn), 0.8 + 0.2 * np.sin(turn)] for turn in turns])
    disc = manifold3d.CrossSection([rim]).extrude(0.05).translate((0.0, 0.0, 0.4)).to_mesh64()
    body = solid(BODY)
    mesh = Mesh(
        vertices=np.concatenate([body.vertices, np.array(disc.vert_properties)[:, :3]]),
        faces=np.concatenate([body.faces, len(body.vertices) + np.array(disc.tri_verts, dtype=np.int64)]),
    )
    bar = box(((0.19, -0.01, 0.3), (0.3, 0.01, 0.6))).vertices
    bars = []
    for turn in 2.0 * np.pi * np.arange(places) / 8:
        T = rotation_about(np.array([0.0, 0.0, 1.0]), np.array(turn))
        bars.append(convex_hull(bar @ T.T + np.array([0.0, 0.8, 0.0])))
    assert len(recover(mesh, *bars)) == 1 + pieces


@pytest.mark.parametrize(("width", "put_back"), [(0.048, 1), (0.056, 2), (0.2, 6)])
def test_a_hull_that_is_put_back_fills_no_gap_deeper_than_a_fiftieth_of_the_diagonal(width, put_back):
    """A ledge with a notch so wide (m), whose middle is half as far from it; the diagonal is 1.35 m."""
    notched = solid(
        BODY,
        ((-0.3, 0.4, 0.5), (-width / 2, 0.5, 0.52)),
        ((width / 2, 0.4, 0.5), (0.3, 0.5, 0.52)),
        ((-0.3, 0.4, 0.5), (0.3, 0.43, 0.52)),
    )
    assert len(recover(notched)) == 1 + put_back
