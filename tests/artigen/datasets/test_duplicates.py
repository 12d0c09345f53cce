"""Duplicates: equal geometry whatever its colours, and near ones up to exactly the threshold."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.datasets.duplicates import EXTENTS, LEVELS, Duplicates, Fingerprint
from artigen.shapes.draw import draw_shape
from artigen.types import Joint
from sim_export.fingerprint import CELLS, describe_surface, hash_geometry, quantise
from sim_export.package import Link, Mesh, SimPackage, Visual
from sim_export.reference import build_reference


def fingerprint(name: str, shares: np.ndarray, **other) -> Fingerprint:
    values = {
        "category": "Safe",
        "joints": ("revolute",),
        "extents": (0.5, 0.5, 0.5),
        "geometry": name,
        "descriptor": shares.astype("<u2").tobytes(),
    }
    return Fingerprint(id=name, **(values | other))


def moved(steps: int) -> np.ndarray:
    """All of the surface in one cell but for so many steps."""
    shares = np.zeros(2 * CELLS**3)
    shares[0], shares[700] = LEVELS - steps, steps
    return shares


def test_near_duplicates_are_found_up_to_the_threshold_and_not_beyond():
    near = 1000 / LEVELS
    for steps, found in ((999, True), (1000, True), (1001, False)):
        known = Duplicates(near)
        assert known.add(fingerprint("first", moved(0))) is None
        duplicate = known.add(fingerprint("second", moved(steps)))
        assert (duplicate is not None) == found
        if duplicate is not None:
            assert (duplicate.of, duplicate.distance) == ("first", steps / LEVELS)


@pytest.mark.parametrize(("factor", "found"), [(0.999, True), (1.001, False)])
def test_boxes_of_near_duplicates_agree_up_to_their_threshold(*, factor: float, found: bool):
    known = Duplicates(0.02)
    known.add(fingerprint("first", moved(0)))
    longer = (0.5, 0.5, 0.5 / (1.0 - factor * EXTENTS))
    assert (known.add(fingerprint("second", moved(0), extents=longer)) is not None) == found


def test_other_joints_or_another_category_is_another_object():
    known = Duplicates(0.02)
    known.add(fingerprint("first", moved(0)))
    assert known.add(fingerprint("second", moved(0), joints=("prismatic",))) is None
    assert known.add(fingerprint("third", moved(0), category="Oven")) is None


def test_without_a_threshold_only_equal_geometry_is_left_out():
    known = Duplicates(0.0)
    known.add(fingerprint("first", moved(0)))
    assert known.add(fingerprint("second", moved(0))) is None
    again = known.add(fingerprint("third", moved(5), geometry="second"))
    assert again is not None
    assert (again.of, again.distance) == ("second", 0.0)


def test_the_nearest_of_many_is_named():
    known = Duplicates(0.02)
    for number in range(40):
        assert known.add(fingerprint(f"object-{number}", moved(1500 * number))) is None
    found = known.add(fingerprint("another", moved(1500 * 33 + 100)))
    assert found is not None
    assert found.of == "object-33"


def box_package(*boxes: tuple[tuple[float, float, float], tuple[float, float, float]]) -> SimPackage:
    """Boxes (lowest and highest corner) as one body, each a visual."""
    visuals = tuple(
        Visual(name=f"box_{index}", part="base", label="base", mesh=box_mesh(low, high))
        for index, (low, high) in enumerate(boxes)
    )
    body = Link(name="body", label="base", parts=("base",), visuals=visuals, hulls=(), inertial=None)
    return SimPackage(name="boxes", category="Safe", visual="voxels", links=(body,), joints=())


def box_mesh(low, high) -> Mesh:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([(a, b, c) for a, b, c, _ in quads] + [(a, c, d) for a, _, c, d in quads])
    return Mesh(vertices=np.array(low) + corners * (np.array(high) - np.array(low)), faces=faces)


def test_the_distance_is_the_share_of_the_surface_that_lies_elsewhere():
    frame = [((0, 0, 0), (0.1, 0.1, 0.1)), ((0.9, 0.9, 0.9), (1.0, 1.0, 1.0))]
    small = 0.1
    here = box_package(*frame, ((0.45, 0.1, 0.1), (0.45 + small, 0.1 + small, 0.1 + small)))
    there = box_package(*frame, ((0.45, 0.8, 0.8), (0.45 + small, 0.8 + small, 0.8 + small)))
    known = Duplicates(0.5)
    first, second = (np.frombuffer(quantise(describe_surface(one)), "<u2") for one in (here, there))
    known.add(fingerprint("here", first))
    duplicate = known.add(fingerprint("there", second))
    assert duplicate is not None
    assert duplicate.distance == pytest.approx(1 / 3, abs=0.01)


def test_a_descriptor_sums_to_one_and_does_not_change_with_size_place_or_triangles():
    package = box_package(((0, 0, 0), (1, 2, 3)), ((0.2, 0.3, 1.0), (0.4, 1.7, 1.1)))
    shares = describe_surface(package)
    assert shares.sum() == pytest.approx(1.0)
    mesh = package.links[0].visuals[0].mesh
    placed = change(package, lambda one: replace(one, vertices=2.0 * one.vertices + [5.0, -3.0, 1.0]))
    np.testing.assert_allclose(describe_surface(placed), shares, atol=1e-12)
    middle = mesh.vertices[mesh.faces].mean(axis=1)
    count = len(mesh.vertices)
    fan = [
        (face[k], face[(k + 1) % 3], count + index) for index, face in enumerate(mesh.faces) for k in range(3)
    ]
    finer = Mesh(vertices=np.concatenate([mesh.vertices, middle]), faces=np.array(fan))
    again = box_package(((0, 0, 0), (1, 1, 1)), ((0.2, 0.3, 1.0), (0.4, 1.7, 1.1)))
    visuals = (replace(again.links[0].visuals[0], mesh=finer), package.links[0].visuals[1])
    retriangulated = replace(again, links=(replace(again.links[0], visuals=visuals),))
    assert 0.5 * np.abs(describe_surface(retriangulated) - shares).sum() < 0.002


def change(package: SimPackage, edit) -> SimPackage:
    """The package with every mesh changed."""
    links = tuple(
        replace(link, visuals=tuple(replace(one, mesh=edit(one.mesh)) for one in link.visuals))
        for link in package.links
    )
    return replace(package, links=links)


def test_equal_geometry_is_found_under_other_colours_and_orders_and_not_a_hair_off():
    shape = draw_shape("Safe", 3)
    package = build_reference(shape)
    own = hash_geometry(package)

    def reorder(mesh: Mesh) -> Mesh:
        faces = np.roll(mesh.faces[::-1], 1, axis=1)
        return Mesh(vertices=mesh.vertices, faces=faces, color=(1.0, 0.0, 0.0))

    assert hash_geometry(change(package, reorder)) == own
    assert hash_geometry(build_reference(shape)) == own
    assert hash_geometry(replace(package, name="other")) == own
    assert hash_geometry(change(package, lambda one: replace(one, vertices=one.vertices + 0.001))) != own
    joint = next(one for one in package.joints if one.type == "revolute")
    wider = replace(joint, upper=joint.upper + 0.01)
    joints = tuple(wider if one is joint else one for one in package.joints)
    assert hash_geometry(replace(package, joints=joints)) != own


def test_what_moves_counts_apart_from_what_is_fixed():
    body, lid = box_mesh((0, 0, 0), (1, 1, 1)), box_mesh((0, 0, 1), (1, 1, 1.1))
    links = tuple(
        Link(
            name=name,
            label="base",
            parts=(name,),
            visuals=(Visual(name=name, part=name, label="base", mesh=mesh),),
            hulls=(),
            inertial=None,
        )
        for name, mesh in (("lid", lid), ("body", body))
    )
    hinge = Joint(
        name="hinge",
        type="revolute",
        parent="body",
        child="lid",
        origin=np.zeros(3),
        axis=np.array([0.0, 1.0, 0.0]),
        upper=1.0,
    )
    package = SimPackage(name="box", category="Safe", visual="voxels", links=links, joints=(hinge,))
    fixed, moving = describe_surface(package).sum(axis=(1, 2, 3))
    assert moving / fixed == pytest.approx(2.4 / 6.0)
