"""Laws of feet: bodies stand as low as they look, on what the mesh has there, and sweeps stay free."""

import manifold3d
import numpy as np
import pytest

from sim_export.collision import attachment, feet
from sim_export.collision.feet import add_feet
from sim_export.geometry.hulls import box_hull
from sim_export.package import Link, Mesh, PackageJoint


def solid(*boxes: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Mesh:
    whole = manifold3d.Manifold()
    for low, high in boxes:
        size = tuple(float(b - a) for a, b in zip(low, high, strict=True))
        whole += manifold3d.Manifold.cube(size).translate(low)
    mesh = whole.to_mesh64()
    return Mesh(
        vertices=np.array(mesh.vert_properties)[:, :3], faces=np.array(mesh.tri_verts, dtype=np.int64)
    )


PLATE = ((-0.3, -0.4, 0.0), (0.3, 0.4, 0.8))
FEET = [
    ((x - 0.02, y - 0.02, -0.012), (x + 0.02, y + 0.02, 0.01)) for x in (-0.25, 0.25) for y in (-0.35, 0.35)
]
BODY = box_hull(np.array(PLATE[0]), np.array(PLATE[1]))


def link(name: str, *hulls) -> Link:
    return Link(name=name, label=None, parts=(name,), visuals=(), hulls=hulls, inertial=None)


def lowest(links) -> np.ndarray:
    points = np.concatenate([hull.vertices for item in links for hull in item.hulls])
    return points[points[:, 2] < points[:, 2].min() + 1e-6]


def test_four_feet_that_hulls_lack_are_added():
    links = (link("body", BODY),)
    new, records = add_feet(links, [], [], {"body": solid(PLATE, *FEET)})
    low = lowest(new)
    np.testing.assert_allclose(
        [low.min(axis=0), low.max(axis=0)], [[-0.27, -0.37, -0.012], [0.27, 0.37, -0.012]]
    )
    assert len(new[0].hulls) == 5
    assert "12.0 mm" in records[0]
    assert "4 of 4" in records[0]


@pytest.mark.parametrize("depth", [0.0, 0.004, 0.08])
def test_bodies_that_stand_or_lack_more_than_feet_are_left_alone(depth: float):
    links = (link("body", BODY),)
    mesh = solid(PLATE, ((-0.3, -0.4, -depth), (0.3, 0.4, 0.1)))
    new, records = add_feet(links, [], [], {"body": mesh})
    assert new[0] is links[0]
    assert not records


def test_a_frame_stands_on_its_corners():
    low, high = -0.012, 0.01
    frame = [
        ((-0.3, -0.4, low), (0.3, -0.38, high)),
        ((-0.3, 0.38, low), (0.3, 0.4, high)),
        ((-0.3, -0.4, low), (-0.28, 0.4, high)),
        ((0.28, -0.4, low), (0.3, 0.4, high)),
    ]
    new, _ = add_feet((link("body", BODY),), [], [], {"body": solid(PLATE, *frame)})
    points = lowest(new)
    np.testing.assert_allclose(points.min(axis=0)[:2], [-0.3, -0.4])
    np.testing.assert_allclose(points.max(axis=0)[:2], [0.3, 0.4])
    for hull in new[0].hulls[1:]:
        assert np.ptp(hull.vertices, axis=0).max() < 0.2


def test_feet_keep_out_of_the_way_of_what_moves(monkeypatch):
    tray = box_hull(np.array([-0.3, -0.4, -0.011]), np.array([-0.2, 0.4, -0.002]))
    slide = PackageJoint(
        name="joint_0", type="prismatic", kind="prismatic", parent="body", child="tray",
        axis=np.array([-1.0, 0.0, 0.0]), origin=np.zeros(3), lower=0.0, upper=0.3,
    )  # fmt: skip
    links = (link("body", BODY), link("tray", tray))
    meshes = {"body": solid(PLATE, *FEET), "tray": solid(((-0.3, -0.4, -0.011), (-0.2, 0.4, -0.002)))}
    monkeypatch.setattr(feet, "NEAR", 0.0005)
    new, records = add_feet(links, [slide], [], meshes)
    assert "2 of 4" in records[0]
    assert lowest(new)[:, 0].min() > 0.2


def test_a_foot_stays_short_where_something_passes_just_above_it():
    """The front of a drawer ends a little below the body, and slides out over two feet."""
    front = box_hull(np.array([-0.3, -0.4, -0.0015]), np.array([-0.2, 0.4, 0.3]))
    slide = PackageJoint(
        name="joint_0", type="prismatic", kind="prismatic", parent="body", child="front",
        axis=np.array([-1.0, 0.0, 0.0]), origin=np.zeros(3), lower=0.0, upper=0.3,
    )  # fmt: skip
    body = box_hull(np.array([-0.19, -0.4, 0.0]), np.array([0.3, 0.4, 0.8]))
    links = (link("body", body), link("front", front))
    meshes = {"body": solid(PLATE, *FEET), "front": solid(((-0.3, -0.4, -0.0015), (-0.2, 0.4, 0.3)))}
    new, records = add_feet(links, [slide], [], meshes)
    assert "4 of 4" in records[0]
    short = [hull for hull in new[0].hulls[1:] if hull.vertices[:, 0].max() < 0.0]
    assert len(short) == 2
    assert all(hull.vertices[:, 2].max() <= -0.0015 - 1e-3 for hull in short)


def test_where_a_link_has_all_its_hulls_one_is_stretched(monkeypatch):
    monkeypatch.setattr(attachment, "MOST_OF_LINK", 1)
    new, _ = add_feet((link("body", BODY),), [], [], {"body": solid(PLATE, *FEET)})
    assert len(new[0].hulls) == 1
    assert lowest(new)[0, 2] == pytest.approx(-0.012)
