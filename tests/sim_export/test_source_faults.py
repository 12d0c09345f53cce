"""What a source fails itself is told with evidence, and what it does not fail is not."""

import numpy as np
import pytest

from sim_export.collision.hulls import box_hull
from sim_export.package import Link, PackageJoint, SimPackage
from sim_export.source_faults import find_source_faults


def box(low, high):
    hull = box_hull(np.array(low, dtype=float), np.array(high, dtype=float))
    return hull.vertices[hull.faces]


def make_package(upper=0.3):
    links = tuple(
        Link(name=name, label=label, parts=(name,), visuals=(), hulls=(), inertial=None)
        for name, label in (("drawer", "drawer"), ("body", "base"))
    )
    joint = PackageJoint(
        name="slide", type="prismatic", kind="prismatic", parent="body", child="drawer",
        origin=np.zeros(3), axis=np.array([-1.0, 0, 0]), lower=0.0, upper=upper,
    )  # fmt: skip
    return SimPackage(
        name="thing", category="Table", visual="source", links=links, joints=(joint,), requires_open=()
    )


@pytest.mark.parametrize(("low", "found"), [(0.41, set()), (0.30, {"V202"})])
def test_bodies_inside_each_other_at_rest_are_evidence(low, found):
    surfaces = {
        "body": box((0, 0, 0), (0.4, 0.4, 0.4)),
        "drawer": box((low, 0.1, 0.1), (low + 0.2, 0.3, 0.3)),
    }
    assert set(find_source_faults(make_package(), surfaces, {"V202"})) == found


def test_a_way_through_the_body_is_evidence_of_the_sweep_only():
    surfaces = {"body": box((0, 0, 0), (0.4, 0.4, 0.4)), "drawer": box((0.41, 0.1, 0.1), (0.6, 0.3, 0.3))}
    package = make_package(upper=0.2)  # it slides towards -x, into the body
    assert set(find_source_faults(package, surfaces, {"V201", "V202"})) == {"V201"}
    assert find_source_faults(package, surfaces, {"V103"}) == {}
