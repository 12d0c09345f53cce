"""Both sides of the thresholds of masses, materials, joints and handles, or the laws they stand in."""

from collections.abc import Callable

import numpy as np
import pytest

from artigen.transforms import rotation_about
from artigen.types import FIXED, Asset, Joint, Part, PartLabel
from sim_export.errors import InvalidInertia, InvalidKinematics
from sim_export.geometry.hulls import box_hull, convex_hull
from sim_export.mend.stand import stand_on_side
from sim_export.package import Hull, Inertial, Link, SimPackage
from sim_export.physics import annotations
from sim_export.physics.annotations import gapart_class
from sim_export.physics.inertia import check_inertial, least_mass, raise_light_mass
from sim_export.physics.links import LinkTree, PartGeometry, build_links
from sim_export.physics.materials import (
    GRAVITY,
    finish_material,
    joint_load,
    joint_resistance,
    rolling_resistance,
)
from sim_export.physics.resistance import greatest_moment, opening_pull
from sim_export.physics.standing import depth_of_mass

UNIT = np.array([np.zeros(3), np.ones(3)])
BODY = Part(name="body", label="base", parent=-1, joint=FIXED, box=UNIT)


def body_of(mass: float, *moments: float) -> Inertial:
    return Inertial(mass=mass, com=np.zeros(3), inertia=np.diag(moments or (mass, mass, mass)))


def is_valid(inertia: np.ndarray) -> bool:
    try:
        check_inertial(Inertial(mass=1.0, com=np.zeros(3), inertia=inertia), "link")
    except InvalidInertia:
        return False
    return True


def link_drawers(count: int, mass: float = 1.0) -> LinkTree | None:
    """The links of so many drawers and their body, if they can be linked."""
    slide = Joint(type="prismatic", axis=np.array([-1.0, 0, 0]), origin=np.zeros(3), upper=0.3)
    drawers = [
        Part(name=f"drawer_{k}", label="drawer", parent=0, joint=slide, box=UNIT) for k in range(count)
    ]
    asset = Asset(name="a", category="Table", scale=1.0, parts=(BODY, *drawers))
    try:
        return build_links(asset, [PartGeometry(inertial=body_of(mass))] * (count + 1))
    except InvalidKinematics:
        return None


def plane(tilt: float, low: float, high: float) -> np.ndarray:
    """A square behind the origin (-x), so tilted (degrees), between two heights."""
    corners = np.array([(0.0, y, z) for y, z in ((-1, low), (1, low), (1, high), (-1, high))])
    turned = corners @ rotation_about(np.array([0.0, 0.0, 1.0]), np.array(np.radians(tilt))).T - [2.0, 0, 0]
    return turned[np.array([[0, 1, 2], [0, 2, 3]])]


def laid_along(*planes: np.ndarray) -> float:
    """Angle (degrees) of a handle's normal, for what lies behind it, to where it looked first."""
    grid = np.array([(0.0, y, z) for y in (-0.2, 0.1) for z in (np.arange(50) + 0.5) / 50])
    normal = annotations._lay_along(np.array([1.0, 0.0, 0.0]), grid, np.concatenate(planes))
    return float(np.degrees(np.arccos(np.clip(normal[0], -1.0, 1.0))))


def grip(share: float, depth: float = 0.04) -> float:
    """Clearance of a bar of which such a share, at one end, is free; behind the rest is a leg."""
    bar = box_hull(np.array([0.0, -0.15, -0.01]), np.array([0.01, 0.15, 0.01]))
    edge = 0.15 - 0.3 * share
    legs = box_hull(np.array([-depth, -0.15, -0.01]), np.array([0.0, edge, 0.01]))
    wall = box_hull(np.array([-depth - 0.1, -1.0, -1.0]), np.array([-depth, 1.0, 1.0]))
    frame = annotations._box_along(bar.vertices, np.array([1.0, 0.0, 0.0]))
    behind = np.concatenate([hull.vertices[hull.faces] for hull in (legs, wall)])
    return annotations._grip(frame, triangles_of(bar), behind)[0]


def triangles_of(hull: Hull) -> np.ndarray:
    return hull.vertices[hull.faces]


def stands_on(height: float) -> bool:
    """Whether a table with two feet on the floor stands, because a third one is only so high (m) above it."""
    feet = np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, height]])
    return depth_of_mass(feet, np.array([0.5, 0.0, 1.0])) > 0.0


def lies_down(inside: float) -> bool:
    """Whether a plate on its edge is turned onto its side, with its mass so far (m) within its rim."""
    R = rotation_about(np.array([0.0, 1.0, 0.0]), np.array(np.radians(20.0)))
    plate = box_hull(np.array([-0.5, -0.5, -0.05]), np.array([0.5, 0.5, 0.05]))
    link = Link(
        name="link_0", label="base", parts=("body",), visuals=(), hulls=(convex_hull(plate.vertices @ R.T),),
        inertial=Inertial(mass=1.0, com=R @ np.array([inside - 0.5, 0.0, 0.0]), inertia=np.eye(3)),
    )  # fmt: skip
    package = SimPackage(name="a", category="Cart", visual="source", links=(link,), joints=())
    return stand_on_side(package) is not package


def shaft(label: PartLabel, inertia: float) -> float:
    """Inertia about its joint of a turning part that has so much (kg m^2) by itself."""
    turn = Joint(type="continuous", axis=np.array([0.0, 1.0, 0.0]), origin=np.zeros(3), upper=2.0 * np.pi)
    part = Part(name="part", label=label, parent=0, joint=turn, box=UNIT)
    asset = Asset(name="a", category="Cart", scale=1.0, parts=(BODY, part))
    geometry = [PartGeometry(inertial=body) for body in (body_of(1.0), body_of(1.0, *[inertia] * 3))]
    found = build_links(asset, geometry).links[0].inertial
    assert found is not None
    return float(found.inertia[1, 1])


HANDLE = Part(name="handle", label="handle", parent=0, joint=FIXED, box=UNIT)
ROWS: dict[str, tuple[Callable[[float], object], float, object, float, object]] = {
    "light": (lambda x: raise_light_mass(body_of(x), "a")[0].mass, 0.0101, 0.0101, 0.0099, 0.01),
    "size": (lambda x: least_mass(0.1, x), 0.249, 0.004, 0.251, 0.01),
    "share": (lambda x: least_mass(x, 0.1), 0.24, 0.0096, 0.26, 0.01),
    "lightest": (lambda x: least_mass(x, 0.1), 0.026, 0.00104, 0.024, 0.001),
    "triangle": (lambda x: is_valid(np.diag([1.0, 1.0, 2.0 + 2.0 * x])), 0.9e-6, True, 1.1e-6, False),
    "symmetry": (lambda x: is_valid(np.array([[1, x, 0], [0, 1, 0], [0, 0, 1.0]])), 0.9e-6, True,
                 1.1e-6, False),
    "foot": (stands_on, 0.0019, True, 0.0021, False),
    "rim": (lies_down, 0.0101, True, 0.0099, False),
    "knob": (lambda x: shaft("knob", x), 1.01e-4, 1.01e-4, 0.99e-4, 1e-4),
    "wheel": (lambda x: shaft("wheel", x), 6.01e-4, 6.01e-4, 5.99e-4, 6e-4),
    "links": (lambda x: link_drawers(int(x)) is not None, 63, True, 64, False),
    "plate": (lambda x: finish_material("steel", "tray", "Table", (0.01, 0.01 * x, 1)), 5.9, "steel", 6.1,
              "steel_sheet"),
    "pane": (lambda x: finish_material("glass", "door", "Oven", (x, 1, 1)), 0.0119, "glass", 0.0121,
             "insulating_glass"),
    "rolling": (lambda x: 7.0 * GRAVITY * 0.04 * x > rolling_resistance(7.0, 0.04), 0.0199, False, 0.0201,
                True),
    "drag": (lambda x: joint_resistance("drawer", "prismatic", x, 0.0).damping, 9.9, 11.9, 10.1, 12.0),
    "bar": (lambda x: gapart_class(HANDLE, x), 1.99, "round_fixed_handle", 2.01, "line_fixed_handle"),
    "fingers": (lambda x: round(grip(x), 6), 0.17, 0.04, 0.163, 0.0),
    "reach": (lambda x: round(grip(1.0, x), 6), 0.149, 0.149, 0.151, 0.15),
    "snap": (lambda x: round(laid_along(plane(x, -1, 2)), 6), 4.9, 0.0, 5.1, 5.1),
    "tilt": (lambda x: round(laid_along(plane(x, -1, 2)), 6), 34.9, 34.9, 35.1, 0.0),
    "agreement": (lambda x: round(laid_along(plane(20, -1, x), plane(-20, x, 2)), 6), 0.62, 20.0, 0.58, 0.0),
    "alike": (lambda x: laid_along(plane(20 + x, -1, 0.5), plane(20, 0.5, 2)) > 0.0, 4.9, True, 5.1, False),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_what_is_within_is_one_thing_and_what_is_beyond_another(name):
    measure, within, here, beyond, there = ROWS[name]
    assert (measure(within), measure(beyond)) == (pytest.approx(here), pytest.approx(there))


def test_weight_is_that_on_earth_and_friction_holds_on_a_slope_of_nine_hundredths():
    slide = Joint(
        name="joint_0", type="prismatic", parent="a", child="b",
        origin=np.zeros(3), axis=np.array([-1.0, 0.0, 0.0]), upper=1.0,
    )  # fmt: skip
    assert joint_load(slide, 2.0, 0.0) == pytest.approx(19.62)
    assert opening_pull(slide, body_of(2.0)) == pytest.approx(0.09 * 19.62)


def test_damping_stops_nothing_within_a_tenth_of_a_second():
    """A light drawer has the damping of its mass, not that of its label."""
    tree = link_drawers(1, 0.05)
    assert tree is not None
    assert tree.joints[0].damping == pytest.approx(0.05 / 0.1)


def test_a_latch_holds_twice_the_moment_of_its_lever():
    hinge = Joint(type="revolute", axis=np.array([0, 0, 1.0]), origin=np.zeros(3), upper=1.5)
    turn = Joint(type="revolute", axis=np.array([-1.0, 0, 0]), origin=np.array([0, 0.1, 0]), upper=0.8)
    parts = (
        BODY,
        Part(name="door", label="door", parent=0, joint=hinge, box=UNIT),
        Part(name="lever", label="handle", parent=1, joint=turn, box=UNIT),
    )
    asset = Asset(name="a", category="Door", scale=1.0, parts=parts)
    free, held = (
        build_links(asset, [PartGeometry(inertial=body_of(1.0))] * 3, latched).joints
        for latched in ((), ("door",))
    )
    assert free[1].friction == pytest.approx(1.09 * 1.0 * GRAVITY * 0.1)
    assert held[1].friction == pytest.approx(2.0 * free[1].friction)
    assert held[0].friction <= free[0].friction


def test_a_screw_turns_on_a_link_of_ten_grams_and_four_centimetres():
    turn = Joint(type="screw", axis=np.array([0, 0, 1.0]), origin=np.zeros(3), upper=1.0, pitch=0.01)
    knob = Part(name="knob", label="knob", parent=0, joint=turn, box=UNIT)
    asset = Asset(name="a", category="Bottle", scale=1.0, parts=(BODY, knob))
    tree = build_links(asset, [PartGeometry(inertial=body_of(1.0))] * 2)
    carrier = next(link.inertial for link in tree.links if link.name.endswith("_carrier"))
    assert carrier is not None
    ball = 0.4 * 0.01 * 0.02**2
    assert carrier.mass == pytest.approx(0.01)
    np.testing.assert_allclose(carrier.inertia, ball * np.eye(3))


def test_stays_resist_a_hand_at_the_far_edge_of_a_lid_with_15_newtons():
    """A lid that reaches 0.6 m from its hinge; springs carry what its friction does not."""
    hinge = Joint(type="revolute", axis=np.array([0.0, 1.0, 0.0]), origin=np.zeros(3), upper=1.5)
    lid = Part(name="lid", label="door", parent=0, joint=hinge, box=UNIT)
    asset = Asset(name="a", category="Box", scale=1.0, parts=(BODY, lid))
    leaf = box_hull(np.array([-0.6, -0.4, 0.0]), np.array([0.0, 0.4, 0.0001]))
    half = np.array([-0.3, 0.0, 0.0])

    def held(mass: float) -> Joint:
        inertial = Inertial(mass=mass, com=half, inertia=mass * np.eye(3))
        geometry = [PartGeometry(inertial=body_of(50.0)), PartGeometry(hulls=(leaf,), inertial=inertial)]
        return build_links(asset, geometry, stays=("lid",)).joints[0]

    load = 1.09 * GRAVITY * 0.3
    light, heavy = held(0.99 * 9.0 / load), held(2.0 * 9.0 / load)
    assert (light.friction, light.spring) == (pytest.approx(0.99 * 9.0), 0.0)
    assert (heavy.friction, heavy.spring) == (pytest.approx(15.0 * 0.6), pytest.approx(-9.0))


def test_the_greatest_moment_of_a_chain_is_sought_at_every_eighth_of_its_ranges():
    """Two arms of 0.5 m and 0.3 m that are in line when the second has gone an eighth of its way."""
    upper, axis = 2.0, np.array([0.0, 1.0, 0.0])
    bend = rotation_about(axis, np.array(-upper / 8.0))
    elbow = np.array([0.5, 0.0, 0.0])
    links = [
        Link(name=name, label="handle", parts=(name,), visuals=(), hulls=(), inertial=inertial)
        for name, inertial in (
            ("base", body_of(1.0)),
            ("upper", Inertial(mass=1.0, com=0.5 * elbow, inertia=np.eye(3))),
            ("lower", Inertial(mass=1.0, com=elbow + bend @ [0.3, 0.0, 0.0], inertia=np.eye(3))),
        )
    ]
    joints = [
        Joint(
            name=f"joint_{child}", type="revolute", parent=parent, child=child,
            origin=origin, axis=axis, upper=upper,
        )
        for parent, child, origin in (("base", "upper", np.zeros(3)), ("upper", "lower", elbow))
    ]  # fmt: skip
    assert greatest_moment(links, joints, joints[0]) == pytest.approx(GRAVITY * (0.25 + 0.8), rel=1e-6)


@pytest.mark.parametrize(("mass", "share"), [(1.52, 0.0), (1.54, 2.0 / 3.0)])
def test_a_spring_carries_two_thirds_of_a_sash_that_weighs_more_than_15_newtons(mass, share):
    """Half way down it carries all, and friction holds the rest everywhere."""
    slide = Joint(type="prismatic", axis=np.array([0.0, 0.0, -1.0]), origin=np.zeros(3), upper=0.4)
    sash = Part(name="sash", label="door", parent=0, joint=slide, box=UNIT)
    asset = Asset(name="a", category="Window", scale=1.0, parts=(BODY, sash))
    tree = build_links(asset, [PartGeometry(inertial=body_of(x)) for x in (50.0, mass)])
    joint, weight = tree.joints[0], mass * GRAVITY
    assert joint.spring == pytest.approx(share * weight)
    assert any("counterbalances" in record for record in tree.records) == (share > 0.0)
    assert (np.abs(weight + joint.pull(np.linspace(0.0, 0.4, 9))) < 1.05 * joint.friction).all()
    if share:
        assert weight + joint.pull(0.2) == pytest.approx(0.0, abs=1e-9)
