"""Laws of pegs: gaps of some millimetres close, sweeps stay free, what cannot be closed is said."""

from dataclasses import replace

import numpy as np
import pytest
from hull_link import box, link, make_joint

from artigen.types import Joint
from sim_export.collision import attachment
from sim_export.collision.attachment import NEAR, add_hull, attach_links
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.motion.kinematics import link_displacements, read_sweeps
from sim_export.package import Hull, Mesh


def joint(kind: str, axis: tuple[float, float, float], upper: float, origin=(0.0, 0.0, 0.0)) -> Joint:
    return replace(make_joint("part", kind, axis, origin, upper), name="joint_0")


BODY = box((0.0, -0.3, -0.3), (0.5, 0.3, 0.3))
KNOB = box((-0.027, -0.02, -0.02), (-0.007, 0.02, 0.02))
TURN = joint("continuous", (1.0, 0.0, 0.0), 2 * np.pi)


def gap(links, pose: np.ndarray | None = None) -> float:
    still = np.eye(4)
    body, part = (HullSet(hulls=item.hulls) for item in links)
    T = still if pose is None else pose
    return float(signed_distances(part, body, T, still, 1.0).distance.min())


def sweep_gap(links, moving: Joint) -> float:
    T = link_displacements(links, [moving], {moving.name: np.linspace(0.0, moving.upper, 101)})
    return gap(links, T[:, 1])


def test_a_knob_off_its_panel_gets_a_peg_and_still_turns():
    links = (link("body", BODY), link("part", KNOB))
    done = attach_links(links, [TURN])
    assert gap(links) == pytest.approx(0.007)
    assert 0.0 < gap(done.links) <= 0.0011
    assert sweep_gap(done.links, TURN) >= 0.0
    assert len(done.pegs) == len(done.records) == 1
    assert "7.0 mm" in done.records[0]
    assert done.pegs[0].left == pytest.approx(gap(done.links))
    (seen,) = done.visuals
    assert isinstance(seen.mesh, Mesh)
    added = [
        hull for link in done.links for hull in link.hulls if hull not in (*links[0].hulls, *links[1].hulls)
    ]
    assert [hull.vertices.tolist() for hull in added] == [seen.mesh.vertices.tolist()]


def test_a_peg_is_where_the_shaft_of_a_knob_would_be():
    """A hub and a rim that is nearer by 0.2 mm."""
    rim = box((-0.027, 0.05, -0.02), (-0.0068, 0.06, 0.02))
    done = attach_links((link("body", BODY), link("part", rim, KNOB)), [TURN])
    assert abs(done.links[1].hulls[-1].vertices[:, 1:]).max() <= 0.006 + 1e-9


@pytest.mark.parametrize("offset", [0.0, 0.004, 0.05])
def test_near_and_far_links_are_left_alone(offset: float):
    knob = box((-0.02 - offset, -0.02, -0.02), (-offset, 0.02, 0.02))
    links = (link("body", BODY), link("part", knob))
    done = attach_links(links, [TURN])
    assert done.links[0] is links[0]
    assert done.links[1] is links[1]
    assert not done.pegs
    assert not done.apart


def test_a_button_that_needs_the_gap_gets_a_peg_beside_it():
    press = joint("prismatic", (1.0, 0.0, 0.0), 0.0069)
    links = (link("body", BODY), link("part", KNOB))
    done = attach_links(links, [press])
    assert [peg.link for peg in done.pegs] == ["body"]
    assert gap(done.links) <= 0.0011
    assert sweep_gap(done.links, press) >= 0.0
    assert done.links[1] is links[1]


def test_a_door_keeps_its_swing():
    door = box((-0.03, -0.3, -0.3), (-0.008, 0.3, 0.3))
    hinge = joint("revolute", (0.0, 0.0, 1.0), np.pi / 2, (-0.02, -0.3, 0.0))
    links = (link("body", BODY), link("part", door))
    before = sweep_gap(links, hinge)
    done = attach_links(links, [hinge])
    assert before > -2e-5
    assert gap(done.links) <= NEAR
    assert sweep_gap(done.links, hinge) > -2e-5


def test_a_gap_that_nothing_may_enter_is_said(monkeypatch):
    monkeypatch.setattr(attachment, "WIDTHS", (0.5,))
    blocks = [box((-0.0065, y, -0.3), (-0.0005, y + 0.1, 0.3)) for y in (-0.2, 0.1)]
    links = (link("body", BODY), link("part", KNOB), link("other", *blocks))
    slide = replace(joint("prismatic", (0.0, 1.0, 0.0), 0.3), name="joint_1", child="other")
    done = attach_links(links[:2] + links[2:], [TURN, slide])
    assert [row[:2] for row in done.apart] == [("part", "body")]
    assert "stays 7.0 mm" in done.records[0]
    assert done.links[1] is links[1]


def test_where_a_link_has_all_its_hulls_one_is_stretched(monkeypatch):
    monkeypatch.setattr(attachment, "MOST_OF_LINK", 1)
    links = (link("body", BODY), link("part", KNOB))
    done = attach_links(links, [TURN])
    assert [len(item.hulls) for item in done.links] == [1, 1]
    assert gap(done.links) <= 0.0011


def test_it_repeats_itself_and_is_done_once():
    links = (link("body", BODY), link("part", KNOB))
    first, second = attach_links(links, [TURN]), attach_links(links, [TURN])
    for one, two in zip(first.links, second.links, strict=True):
        for a, b in zip(one.hulls, two.hulls, strict=True):
            np.testing.assert_array_equal(a.vertices, b.vertices)
    assert not attach_links(first.links, [TURN]).pegs


def test_buttons_in_a_row_share_a_bar():
    knobs = [box((-0.027, y - 0.01, -0.01), (-0.007, y + 0.01, 0.01)) for y in (-0.06, -0.03, 0.0, 0.03)]
    names = [f"button_{index}" for index in range(len(knobs))]
    press = joint("prismatic", (1.0, 0.0, 0.0), 0.0069)
    presses = [replace(press, name=f"joint_{name}", child=name) for name in names]
    links = (link("body", BODY), *(link(name, knob) for name, knob in zip(names, knobs, strict=True)))
    done = attach_links(links, presses)
    assert len(done.pegs) == 1
    assert np.ptp(done.links[0].hulls[-1].vertices[:, 1]) == pytest.approx(0.11)
    for name, moving in zip(names, presses, strict=True):
        index = names.index(name) + 1
        pair = (done.links[0], done.links[index])
        assert gap(pair) <= NEAR
        assert sweep_gap(pair, replace(moving, child=name)) >= 0.0


def knob_at(distance: float) -> Hull:
    """A knob so far (m) from its panel."""
    return box((-0.02 - distance, -0.02, -0.02), (-distance, 0.02, 0.02))


@pytest.mark.parametrize(("distance", "closed"), [(0.0044, 0), (0.0046, 1), (0.0318, 1), (0.0322, 0)])
def test_gaps_of_four_and_a_half_to_thirty_two_millimetres_are_closed(distance, closed):
    done = attach_links((link("body", BODY), link("part", knob_at(distance))), [TURN])
    assert (len(done.pegs), len(done.apart)) == (closed, 0)


def test_a_peg_stands_a_millimetre_deep_in_its_own_link_and_ends_one_before_the_other():
    done = attach_links((link("body", BODY), link("part", knob_at(0.007))), [TURN])
    (peg,) = (hull for item in done.links for hull in item.hulls[1:])
    ends = peg.vertices[:, 0].min(), peg.vertices[:, 0].max()
    assert ends == pytest.approx((-0.008, -0.001), abs=1e-6)


@pytest.mark.parametrize(("left", "fits"), [(1.8e-4, False), (2.2e-4, True)])
def test_a_hull_that_is_added_stays_a_fifth_of_a_millimetre_from_others(left, fits):
    links = (link("body", BODY), link("part", KNOB))
    added = box((-0.01, -0.01, -0.01), (-left, 0.01, 0.01))
    sets = [HullSet(hulls=item.hulls) for item in links]
    assert (add_hull(sets, read_sweeps(links, [TURN], ()), 1, added, KNOB) is not None) == fits


@pytest.mark.parametrize(("depth", "fits"), [(1.8e-5, True), (2.2e-5, False)])
def test_a_hull_that_is_stretched_may_enter_others_by_a_fiftieth_of_a_millimetre(depth, fits):
    """A part that has 96 hulls, the most of a link; one of them reaches for its panel."""
    others = [box((-1.0, 0.01 * k, 0.0), (-0.99, 0.01 * k + 0.009, 0.01)) for k in range(95)]
    sets = [HullSet(hulls=(BODY,)), HullSet(hulls=(KNOB, *others))]
    done = add_hull(sets, (), 1, box((-0.01, -0.01, -0.01), (depth, 0.01, 0.01)), KNOB)
    assert (done is not None) == fits
    assert done is None or len(done.hulls) == 96


@pytest.mark.parametrize(("deeper", "pegs"), [(0.0009, 1), (0.0011, 2)])
def test_buttons_share_a_bar_if_they_end_within_a_millimetre_of_each_other(deeper, pegs):
    """Two of them, 20 mm wide and 10 mm apart; the second is nearer to the panel."""
    knobs = [
        box((-0.027, -0.01, -0.01), (-0.007, 0.01, 0.01)),
        box((-0.027, 0.02, -0.01), (-0.007 + deeper, 0.04, 0.01)),
    ]
    press = joint("prismatic", (1.0, 0.0, 0.0), 0.0069 - deeper)
    presses = [replace(press, name=f"joint_{k}", child=f"button_{k}") for k in range(2)]
    links = (link("body", BODY), *(link(f"button_{k}", knob) for k, knob in enumerate(knobs)))
    assert len(attach_links(links, presses).pegs) == pegs


@pytest.mark.parametrize(("blocked", "pegs"), [(3, 1), (4, 0)])
def test_a_peg_is_tried_at_the_four_nearest_places(blocked, pegs):
    """A part with five feet before a panel, each a little farther off; blocks fill the gaps of the first."""
    feet = [
        box((-0.02, y - 0.02, -0.02), (-0.006 - 2e-4 * k, y + 0.02, 0.02))
        for k, y in enumerate((-0.2, -0.1, 0.0, 0.1, 0.2))
    ]
    blocks = [
        box((-0.0055, y - 0.03, -0.03), (-0.0005, y + 0.03, 0.03)) for y in (-0.2, -0.1, 0.0, 0.1)[:blocked]
    ]
    links = (link("body", BODY), link("part", *feet), link("other", *blocks))
    slide = joint("prismatic", (0.0, 1.0, 0.0), 1e-4)
    still = replace(slide, name="joint_1", type="fixed", child="other", upper=0.0)
    assert len(attach_links(links, [slide, still]).pegs) == pegs
