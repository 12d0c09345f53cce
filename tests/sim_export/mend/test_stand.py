"""What falls over is turned onto the nearest side on which it stands; all that is in it turns with it."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.transforms import rotation_about
from artigen.types import Joint
from sim_export.geometry.hulls import box_hull, convex_hull
from sim_export.mend.stand import stand_on_side
from sim_export.package import Inertial, Link, Mesh, SimPackage, Visual
from sim_export.physics.standing import stable_margin

TILT_AXIS = np.array([0.0, 1.0, 0.0])


def tilted(degrees: float, *, com=(0.0, 0.0, 0.0), category: str = "Cart") -> SimPackage:
    """A plate of 1 x 0.4 x 0.1 m that stands on an edge, so many degrees off its side, with a wheel."""
    R = rotation_about(TILT_AXIS, np.array(np.radians(degrees)))
    plate = box_hull(np.array([-0.5, -0.2, -0.05]), np.array([0.5, 0.2, 0.05]))
    hull = convex_hull(plate.vertices @ R.T)
    mesh = Mesh(vertices=hull.vertices, faces=hull.faces)
    body = Link(
        name="link_1", label="base", parts=("base",), hulls=(hull,),
        visuals=(Visual(name="base", part="base", label="base", mesh=mesh),),
        inertial=Inertial(mass=10.0, com=R @ np.array(com), inertia=R @ np.diag([1.0, 2.0, 3.0]) @ R.T),
    )  # fmt: skip
    hub = R @ np.array([0.3, 0.0, 0.1])
    wheel = Link(
        name="link_0", label="wheel", parts=("wheel",), visuals=(), hulls=(),
        inertial=Inertial(mass=1e-6, com=hub, inertia=1e-6 * np.eye(3)),
    )  # fmt: skip
    joint = Joint(
        name="joint_0", type="continuous", parent="link_1", child="link_0",
        origin=hub, axis=R @ np.array([0.0, 0.0, 1.0]),
    )  # fmt: skip
    return SimPackage(name="a", category=category, visual="source", links=(wheel, body), joints=(joint,))


def test_a_tilted_plate_comes_to_lie_with_its_visual_its_joint_and_its_inertia():
    done = stand_on_side(tilted(20.0))
    wheel, body = done.links
    mesh = body.visuals[0].mesh
    assert isinstance(mesh, Mesh)
    assert body.inertial is not None
    assert wheel.inertial is not None
    for points in (body.hulls[0].vertices, mesh.vertices):
        np.testing.assert_allclose(np.ptp(points, axis=0), (1.0, 0.4, 0.1), atol=1e-4)
    np.testing.assert_allclose(body.inertial.inertia, np.diag([1.0, 2.0, 3.0]), atol=1e-3)
    np.testing.assert_allclose(done.joints[0].axis, (0, 0, 1), atol=1e-4)
    np.testing.assert_allclose(done.joints[0].origin, wheel.inertial.com)
    np.testing.assert_allclose(done.joints[0].origin - body.inertial.com, (0.3, 0.0, 0.1), atol=1e-4)
    assert "20.0 degrees" in done.records[0]
    assert stand_on_side(done) is done


@pytest.mark.parametrize("at", [-0.2, 0.2])
def test_it_comes_to_stand_on_the_side_below_its_centre_of_mass(at):
    """The underside is bent by half a degree, so that the plate rocks; either half is within what counts as
    touching the floor."""
    R = rotation_about(TILT_AXIS, np.array(np.radians(20.0)))
    rise = 0.3 * np.tan(np.radians(0.25))
    corners = [(x, y, z) for x in (-0.3, 0.3) for y in (-0.2, 0.2) for z in (rise, 0.1)]
    hull = convex_hull(np.array([*corners, (0.0, -0.2, 0.0), (0.0, 0.2, 0.0)]) @ R.T)
    package = tilted(20.0)
    body = replace(
        package.links[1],
        hulls=(hull,),
        inertial=Inertial(mass=10.0, com=R @ (at, 0.0, 0.05), inertia=np.eye(3)),
    )
    done = stand_on_side(replace(package, links=(package.links[0], body)))
    points, inertial = done.links[1].hulls[0].vertices, done.links[1].inertial
    assert inertial is not None
    touching = points[points[:, 2] < points[:, 2].min() + 1e-6]
    assert len(touching) == 4
    assert touching[:, 0].min() < inertial.com[0] < touching[:, 0].max()


@pytest.mark.parametrize("turn", [-20.0, 20.0])
def test_a_door_on_a_turned_object_stays_where_it_is_left(turn):
    """The hinge was level; after the turn the door would swing by itself, one way or the other."""
    package = tilted(turn)
    door = replace(
        package.links[0],
        label="door",
        inertial=Inertial(mass=2.0, com=np.array([0.1, 0.5, 0.0]), inertia=np.eye(3)),
    )
    joint = replace(
        package.joints[0], type="revolute", upper=1.0, friction=0.3,
        origin=np.zeros(3), axis=np.array([0.0, 0.0, 1.0]),
    )  # fmt: skip
    done = stand_on_side(replace(package, links=(door, package.links[1]), joints=(joint,)))
    moved = done.links[0].inertial
    assert moved is not None
    arm = moved.com - done.joints[0].origin
    falling = -9.81 * 2.0 * np.cross(done.joints[0].axis, arm)[2]
    assert abs(falling) > 1.0
    assert (done.joints[0].friction > 0.3) == (falling > 0.0)
    assert done.joints[0].friction >= falling


@pytest.mark.parametrize(("degrees", "turns"), [(29.5, True), (30.5, False)])
def test_what_needs_more_than_thirty_degrees_stays(degrees, turns):
    before = tilted(degrees)
    assert (stand_on_side(before) is not before) == turns


@pytest.mark.parametrize(("beyond", "turns"), [(1e-3, True), (-1e-3, False)])
def test_it_comes_to_stand_on_no_side_that_hardly_carries_it(beyond, turns):
    corners = np.concatenate([hull.vertices for link in tilted(20.0).links for hull in link.hulls])
    before = tilted(20.0, com=(-0.5 + stable_margin(corners) + beyond, 0.0, 0.0))
    assert (stand_on_side(before) is not before) == turns


def test_what_stands_and_what_is_mounted_stay():
    for before in (tilted(0.0), tilted(20.0, category="Faucet")):
        assert stand_on_side(before) is before


@pytest.mark.parametrize(("height", "added"), [(0.004, False), (0.006, True)])
def test_what_is_lowest_after_the_turn_gets_a_hull(height, added):
    """A foot that is seen below the plate, as high (m) as it says, and that no hull stands for."""
    package = tilted(20.0)
    R = rotation_about(TILT_AXIS, np.array(np.radians(20.0)))
    foot = box_hull(np.array([-0.4, -0.02, -0.05 - height]), np.array([-0.36, 0.02, -0.05]))
    mesh = Mesh(vertices=foot.vertices @ R.T, faces=foot.faces[:-4])  # open, as drawn meshes are
    wheel, body = package.links
    body = replace(body, visuals=(*body.visuals, Visual(name="foot", part="base", label="base", mesh=mesh)))
    done = stand_on_side(replace(package, links=(wheel, body)))
    low = [
        min(points[:, 2].min() for points in chunks)
        for chunks in (
            [hull.vertices for hull in done.links[1].hulls],
            [visual.mesh.vertices for visual in done.links[1].visuals if isinstance(visual.mesh, Mesh)],
        )
    ]
    assert low[0] - low[1] == pytest.approx(0.0 if added else height, abs=1e-4)
    assert len(done.links[1].hulls) == (2 if added else 1)
