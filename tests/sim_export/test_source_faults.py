"""What a source fails itself is told with evidence, and what it does not fail is not."""

import numpy as np
import pytest
from triangle_box import box

from artigen.types import Joint
from sim_export.package import Link, SimPackage
from sim_export.source_faults import find_source_faults


def make_package(upper=0.3):
    links = tuple(
        Link(name=name, label=label, parts=(name,), visuals=(), hulls=(), inertial=None)
        for name, label in (("drawer", "drawer"), ("body", "base"))
    )
    joint = Joint(
        name="slide", type="prismatic", parent="body", child="drawer",
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


@pytest.mark.parametrize(("gap", "found"), [(0.0049, set()), (0.0051, {"V107"})])
def test_a_piece_that_floats_in_the_source_is_evidence(gap, found):
    pieces = [box((0, 0, 0), (0.4, 0.4, 0.4)), box((0, 0, 0.4 + gap), (0.4, 0.4, 0.5))]
    surfaces = {"body": np.concatenate(pieces), "drawer": box((-0.3, 0, 0), (-0.1, 0.1, 0.1))}
    assert set(find_source_faults(make_package(), surfaces, {"V107"})) == found


def test_a_way_through_the_body_is_evidence_of_the_sweep_only():
    surfaces = {"body": box((0, 0, 0), (0.4, 0.4, 0.4)), "drawer": box((0.41, 0.1, 0.1), (0.6, 0.3, 0.3))}
    package = make_package(upper=0.2)  # it slides towards -x, into the body
    assert set(find_source_faults(package, surfaces, {"V201", "V202"})) == {"V201"}
    assert find_source_faults(package, surfaces, {"V105"}) == {}


def test_open_surfaces_that_pierce_each_other_are_evidence():
    """A body without a lid encloses nothing; a board through its wall is in it all the same."""
    body = box((0, 0, 0), (0.4, 0.4, 0.4))
    body = body[(body[..., 2] < 0.4).any(axis=1)]
    for inside, found in ((0.05, {"V202", "V308"}), (0.001, set()), (-0.01, set())):
        surfaces = {"body": body, "drawer": box((0.4 - inside, 0.1, 0.1), (0.6, 0.3, 0.3))}
        assert set(find_source_faults(make_package(), surfaces, {"V202", "V308"})) == found


def test_an_open_front_that_a_drawer_goes_through_is_evidence_of_the_sweep():
    front = box((0, 0, 0), (0.4, 0.4, 0.4))
    front = front[(front[..., 0] > 0.399).all(axis=1)]  # a single sheet
    surfaces = {"body": front, "drawer": box((0.41, 0.1, 0.1), (0.6, 0.3, 0.3))}
    assert set(find_source_faults(make_package(upper=0.1), surfaces, {"V201", "V202"})) == {"V201"}


@pytest.mark.parametrize(("deep", "found"), [(0.1, {"V103"}), (0.01, set())])
def test_links_that_share_more_room_than_hulls_may_lose_explain_hulls_that_lost_it(deep, found):
    surfaces = {
        "body": box((0, 0, 0), (0.4, 0.4, 0.4)),
        "drawer": box((0.4 - deep, 0.05, 0.05), (0.7, 0.35, 0.35)),
    }
    assert set(find_source_faults(make_package(upper=0.0), surfaces, {"V103"})) == found
