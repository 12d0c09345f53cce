"""Mass properties: closed forms, equivariance, additivity, and what is refused; material tables."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from artigen.kind import paper_kinds
from artigen.transforms import rotation_about
from artigen.types import JOINT_TYPES, PART_LABELS, Asset, Joint, Part
from sim_export.errors import DegeneratePart, InvalidInertia, OpenMesh
from sim_export.geometry.hulls import box_hull, convex_hull
from sim_export.package import Inertial, Mesh
from sim_export.physics.inertia import (
    check_inertial,
    combine,
    inertia_about,
    mesh_inertial,
    raise_light_mass,
)
from sim_export.physics.links import PartGeometry, build_links
from sim_export.physics.materials import (
    GRAVITY,
    MATERIALS,
    MaterialName,
    joint_resistance,
    part_material,
    physx_friction_coefficient,
)
from sim_export.physics.resistance import HOLD_SLOPE, opening_pull


def prism(sides: int, radius: float, height: float) -> Mesh:
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(sides)], axis=1)
    hull = convex_hull(np.concatenate([ring, ring + np.array([0.0, 0.0, height])]))
    return Mesh(vertices=hull.vertices, faces=hull.faces)


@given(
    size=st.tuples(*[st.floats(0.01, 3.0)] * 3),
    at=st.tuples(*[st.floats(-5.0, 5.0)] * 3),
    density=st.floats(1.0, 8000.0),
)
@settings(max_examples=30, deadline=None)
def test_box_has_its_closed_form(size, at, density):
    size, at = np.array(size), np.array(at)
    found = mesh_inertial(box_hull(at - size / 2, at + size / 2), density)
    mass = density * np.prod(size)
    square = size**2
    assert found.mass == pytest.approx(mass, rel=1e-9)
    np.testing.assert_allclose(found.com, at, atol=1e-9)
    np.testing.assert_allclose(
        found.inertia,
        np.diag(mass / 12 * (square.sum() - square)),
        rtol=1e-7,
        atol=1e-9 * found.inertia.max(),
    )


@pytest.mark.parametrize("sides", [6, 400])
def test_prism_and_cylinder_have_their_closed_form(sides):
    radius, height, density = 0.3, 0.8, 500.0
    found = mesh_inertial(prism(sides, radius, height), density)
    turn = 2 * np.pi / sides
    mass = density * height * sides / 2 * radius**2 * np.sin(turn)
    polar = mass * radius**2 * (2 + np.cos(turn)) / 6
    across = polar / 2 + mass * height**2 / 12
    assert found.mass == pytest.approx(mass, rel=1e-9)
    np.testing.assert_allclose(found.inertia, np.diag([across, across, polar]), rtol=1e-9, atol=1e-9)
    if sides == 400:
        assert found.mass == pytest.approx(density * np.pi * radius**2 * height, rel=1e-4)
        assert found.inertia[2, 2] == pytest.approx(found.mass * radius**2 / 2, rel=1e-4)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_inertia_moves_with_the_body(seed):
    rng = np.random.default_rng(seed)
    hull = convex_hull(rng.normal(size=(12, 3)))
    R, shift = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3)
    here = mesh_inertial(hull, 700.0)
    there = mesh_inertial(replace(hull, vertices=hull.vertices @ R.T + shift), 700.0)
    assert there.mass == pytest.approx(here.mass, rel=1e-9)
    np.testing.assert_allclose(there.com, R @ here.com + shift, atol=1e-9)
    np.testing.assert_allclose(there.inertia, R @ here.inertia @ R.T, rtol=1e-6, atol=1e-9 * here.mass)
    check_inertial(there, "body")


def test_mass_properties_add_up():
    low, high, cut = np.array([0.1, -0.2, 0.3]), np.array([0.9, 0.5, 0.7]), 0.4
    whole = mesh_inertial(box_hull(low, high), 300.0)
    left = mesh_inertial(box_hull(low, np.array([cut, *high[1:]])), 300.0)
    right = mesh_inertial(box_hull(np.array([cut, *low[1:]]), high), 300.0)
    both = combine([left, right])
    assert both.mass == pytest.approx(whole.mass)
    np.testing.assert_allclose(both.com, whole.com, atol=1e-12)
    np.testing.assert_allclose(both.inertia, whole.inertia, atol=1e-12)
    point = np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose(
        inertia_about(left, point) + inertia_about(right, point), inertia_about(whole, point), atol=1e-9
    )


def test_a_hollow_box_weighs_its_walls():
    outer, inner = box_hull(np.zeros(3), np.ones(3)), box_hull(np.full(3, 0.1), np.full(3, 0.9))
    shell = Mesh(
        vertices=np.concatenate([outer.vertices, inner.vertices]),
        faces=np.concatenate([outer.faces, inner.faces[:, ::-1] + len(outer.vertices)]),
    )
    assert mesh_inertial(shell, 1000.0).mass == pytest.approx(1000.0 * (1 - 0.8**3))


def test_what_encloses_nothing_has_no_mass():
    box = box_hull(np.zeros(3), np.ones(3))
    with pytest.raises(OpenMesh, match="not closed"):
        mesh_inertial(replace(box, faces=box.faces[1:]), 1.0)
    with pytest.raises(OpenMesh, match="inside out"):
        mesh_inertial(replace(box, faces=box.faces[:, ::-1]), 1.0)
    with pytest.raises(DegeneratePart):
        mesh_inertial(replace(box, vertices=box.vertices * [1.0, 1.0, 0.0]), 1.0)
    with pytest.raises(DegeneratePart):
        mesh_inertial(replace(box, faces=np.zeros((0, 3))), 1.0)
    for density in (0.0, -1.0, np.nan):
        with pytest.raises(InvalidInertia, match="density"):
            mesh_inertial(box, density)


@pytest.mark.parametrize(
    ("mass", "diagonal", "what"),
    [
        (0.0, (1.0, 1.0, 1.0), "mass"),
        (-1.0, (1.0, 1.0, 1.0), "mass"),
        (np.nan, (1.0, 1.0, 1.0), "NaN"),
        (1.0, (0.0, 0.0, 0.0), "moments"),
        (1.0, (1.0, 1.0, -0.1), "moments"),
        (1.0, (1.0, 0.1, 0.1), "triangle"),
        (1.0, (1.0, np.inf, 1.0), "infinite"),
    ],
)
def test_unphysical_inertia_is_refused(mass, diagonal, what):
    with pytest.raises(InvalidInertia, match=what):
        check_inertial(Inertial(mass=mass, com=np.zeros(3), inertia=np.diag(diagonal)), "link_0")


def test_triangle_inequality_is_relative():
    rod = np.diag([1.0, 1.0, 1e-9]) * 1e-6
    check_inertial(Inertial(mass=1.0, com=np.zeros(3), inertia=rod), "rod")
    plate = np.diag([0.5, 0.5, 1.0 + 1e-7]) * 1e-8
    check_inertial(Inertial(mass=1.0, com=np.zeros(3), inertia=plate), "plate")
    with pytest.raises(InvalidInertia, match="triangle"):
        check_inertial(Inertial(mass=1.0, com=np.zeros(3), inertia=plate + np.diag([0, 0, 1e-12])), "plate")
    skew = np.eye(3)
    skew[0, 1] = 0.1
    with pytest.raises(InvalidInertia, match="symmetric"):
        check_inertial(Inertial(mass=1.0, com=np.zeros(3), inertia=skew), "skew")


def test_light_links_are_raised_on_record():
    light = mesh_inertial(box_hull(np.zeros(3), np.full(3, 0.01)), 700.0)
    raised, record = raise_light_mass(light, "button")
    assert raised.mass == pytest.approx(0.01)
    assert record is not None
    assert "button" in record
    np.testing.assert_allclose(raised.inertia / raised.mass, light.inertia / light.mass)
    heavy = replace(light, mass=1.0)
    assert raise_light_mass(heavy, "box") == (heavy, None)


@pytest.mark.parametrize("half", [0.01, 0.2])
@pytest.mark.parametrize(("label", "least"), [("knob", 1e-4), ("wheel", 6e-4)])
def test_what_turns_turns_a_shaft_with_it(label, least, half):
    """Small knobs and wheels get the least inertia about their axis, on record; what is larger stays."""
    joint = Joint(type="continuous", axis=np.array([-1.0, 0.0, 0.0]), origin=np.full(3, 0.1), upper=2 * np.pi)
    still = Joint(type="fixed", axis=joint.axis, origin=np.zeros(3))
    unit = np.array([np.zeros(3), np.ones(3)])
    parts = (
        Part(name="body", label="base", parent=-1, joint=still, box=unit),
        Part(name="knob", label=label, parent=0, joint=joint, box=unit * half),
    )
    hull = box_hull(joint.origin - half, joint.origin + half)
    knob = mesh_inertial(hull, 1050.0)
    tree = build_links(
        Asset(name="a", category="Oven", scale=1.0, parts=parts),
        [
            PartGeometry(hulls=(hull,), inertial=replace(knob, mass=5.0, inertia=np.eye(3))),
            PartGeometry(hulls=(hull,), inertial=knob),
        ],
    )
    knob = raise_light_mass(knob, "knob")[0]
    made = next(link.inertial for link in tree.links if link.label == label)
    assert made is not None
    about = float(joint.axis @ made.inertia @ joint.axis)
    before = float(joint.axis @ knob.inertia @ joint.axis)
    assert about == pytest.approx(max(before, least))
    assert sum("shaft" in record for record in tree.records) == (before < least)
    check_inertial(made, "knob")


@pytest.mark.parametrize(("steep", "rolls"), [(0.49, True), (0.51, False)])
def test_a_wheel_resists_rolling_by_its_load_and_radius_and_a_swivel_does_not(steep, rolls):
    """Four wheels of 5 cm under 80 kg: two hundredths of the weight at each rim."""
    axis = np.array([0.0, np.sqrt(1.0 - steep**2), steep])
    still = Joint(type="fixed", axis=axis, origin=np.zeros(3))
    unit = np.array([np.zeros(3), np.ones(3)])
    rim = np.concatenate([rotation_about(axis, np.linspace(0.0, 5.0, 6)) @ np.cross(axis, [1.0, 0, 0])] * 2)
    rim = rim / np.linalg.norm(rim, axis=1, keepdims=True) * 0.05 + np.outer([0.0] * 6 + [0.01] * 6, axis)
    parts, geometry = [Part(name="body", label="base", parent=-1, joint=still, box=unit)], []
    geometry.append(PartGeometry(inertial=Inertial(mass=76.0, com=np.zeros(3), inertia=np.eye(3))))
    for k in range(4):
        at = np.array([k, 0.0, 0.0])
        joint = Joint(type="continuous", axis=axis, origin=at, upper=2 * np.pi)
        parts.append(Part(name=f"wheel_{k}", label="wheel", parent=0, joint=joint, box=unit))
        wheel = Inertial(mass=1.0, com=at, inertia=0.01 * np.eye(3))
        geometry.append(PartGeometry(hulls=(convex_hull(rim + at),), inertial=wheel))
    tree = build_links(Asset(name="a", category="Cart", scale=1.0, parts=tuple(parts)), geometry)
    expected = 0.02 * 80.0 / 4 * 9.81 * 0.05 if rolls else 0.005
    assert [joint.friction for joint in tree.joints] == pytest.approx([expected] * 4)


HANDBOOK = {
    "wood_board": (450, 800), "steel_sheet": (7700, 8050), "steel": (7700, 8050), "glass": (2400, 2600),
    "insulating_glass": (2400, 2600), "plastic": (900, 1450), "rubber": (900, 1300), "stone": (2300, 2900),
    "foam_panel": (30, 200),
}  # fmt: skip
"""Densities (kg/m^3) of the solids."""


@pytest.mark.parametrize("name", MATERIALS)
def test_a_density_is_that_of_the_solid_and_the_rest_of_a_piece_is_air(name: MaterialName):
    material = MATERIALS[name]
    low, high = HANDBOOK[name]
    assert low <= material.density <= high
    assert 0.0 < material.filled <= 1.0
    assert material.bulk == material.density * material.filled


def test_every_part_has_a_material_and_every_joint_resists():
    for category in (*paper_kinds(), "Bottle", "Faucet", "something new"):
        for label in PART_LABELS:
            material = MATERIALS[part_material(label, category)]
            assert 50 < material.bulk <= material.density < 8000
            assert 0 < material.sliding_friction <= material.static_friction <= 1
    for label in PART_LABELS:
        for kind in JOINT_TYPES:
            resist = joint_resistance(label, kind, 5.0, 0.0)
            assert resist.friction > 0
            assert min(resist.damping, resist.effort, resist.velocity) > 0
    assert 1 <= joint_resistance("drawer", "prismatic", 5.0, 5.0).friction < 8
    assert 0.3 <= joint_resistance("door", "revolute", 2.0, 0.0).friction <= 1
    assert 0.02 <= joint_resistance("knob", "continuous", 0.1, 0.0).friction <= 0.1


def closed_joint(kind: str, axis: list[float]) -> Joint:
    return Joint(
        name="joint_0", type=kind, parent="link_1", child="link_0",
        origin=np.zeros(3), axis=np.array(axis), upper=1.0,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "axis", "com"),
    [
        ("prismatic", [-1.0, 0.0, 0.0], [0.1, 0.0, 0.2]),
        ("revolute", [0.0, 0.0, 1.0], [0.0, 0.4, 0.3]),
        ("revolute", [0.0, -1.0, 0.0], [-0.05, 0.0, 0.4]),
    ],
)
def test_what_holds_a_joint_shut_holds_it_on_any_slope_of_five_degrees(kind, axis, com):
    joint = closed_joint(kind, axis)
    moved = Inertial(mass=7.0, com=np.array(com), inertia=np.eye(3))
    moving = joint.axis if kind == "prismatic" else np.cross(joint.axis, com)
    slope = np.radians(5.0)
    for heading in np.linspace(0, 2 * np.pi, 36):
        down = [np.sin(slope) * np.cos(heading), np.sin(slope) * np.sin(heading), -np.cos(slope)]
        assert opening_pull(joint, moved) > 7.0 * GRAVITY * float(moving @ down)


def test_a_lid_that_lies_on_its_rim_needs_no_friction():
    moved = Inertial(mass=0.2, com=np.array([0.0, 0.0, 1.0]), inertia=np.eye(3))
    assert opening_pull(closed_joint("prismatic", [0.0, 0.0, 1.0]), moved) == 0.0


def test_the_physx_coefficient_grows_with_friction_and_shrinks_with_load():
    door = Joint(
        name="joint_0", type="revolute", parent="a", child="b",
        origin=np.zeros(3), axis=np.array([0.0, 0.0, 1.0]), upper=1.5, friction=0.6,
    )  # fmt: skip
    drawer = replace(door, type="prismatic", friction=4.0)
    for joint in (door, drawer):
        rising = [
            physx_friction_coefficient(replace(joint, friction=f), 8.0, 0.3)
            for f in (0.0, 0.1, 1.0, 9.0, 30.0)
        ]
        assert rising[0] == 0.0
        assert (np.diff(rising) > 0.0).all()
        twice = physx_friction_coefficient(replace(joint, friction=2 * joint.friction), 16.0, 0.3)
        assert twice == pytest.approx(physx_friction_coefficient(joint, 8.0, 0.3))
    with pytest.raises(ValueError, match="joint_0"):
        physx_friction_coefficient(door, 0.0, 0.3)


def test_a_hand_opens_the_heaviest_drawer_that_friction_holds_on_a_slope_in_time():
    """30 N against the friction that holds 29 kg at 5 degrees, over 0.6 m, at the speed that drag allows."""
    mass = 29.0
    hold = mass * 9.81 * np.sin(np.radians(5.0))
    resist = joint_resistance("drawer", "prismatic", mass, hold)
    assert resist.friction == hold
    assert (30.0 - resist.friction) / resist.damping * 5.0 > 0.6
    assert joint_resistance("drawer", "prismatic", 6.0, 0.0).damping == 8.0  # light ones as before


@pytest.mark.parametrize("degrees", [0.0, 30.0, 90.0])
def test_a_turntable_resists_what_gravity_can_do_about_its_axle(degrees):
    """A level one, about an upright axle, only feels the slope of the floor."""
    axis = rotation_about(np.array([1.0, 0.0, 0.0]), np.array(np.radians(degrees))) @ [0.0, 0.0, 1.0]
    joint = Joint(
        name="joint_0", type="continuous", parent="link_1", child="link_0",
        origin=np.zeros(3), axis=axis,
    )  # fmt: skip
    plate = Inertial(mass=10.0, com=np.array([0.1, 0.0, 0.0]), inertia=np.eye(3))
    turns = rotation_about(axis, np.linspace(0.0, 2.0 * np.pi, 361))
    moments = np.cross(turns @ np.asarray(plate.com), [0.0, 0.0, -10.0 * GRAVITY]) @ axis
    slope = HOLD_SLOPE * 10.0 * GRAVITY * 0.1
    assert opening_pull(joint, plate) == pytest.approx(np.abs(moments).max() + slope, rel=1e-3)
