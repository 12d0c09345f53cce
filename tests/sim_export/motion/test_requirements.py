"""A joint needs another open where a thin link passes through another one, by the share that passes."""

from collections.abc import Sequence

import numpy as np
import pytest
from hull_link import box, link, make_joint

from artigen.types import Joint
from sim_export.motion.requirements import find_crossings, find_requirements
from sim_export.package import Link, Requirement


def make_link(name: str, *boxes) -> Link:
    return link(name, *(box(*ends) for ends in boxes))


def as_rows(found: Sequence[Requirement]) -> list[tuple[str, str, float]]:
    return [(item.joint, item.needs, item.fraction) for item in found]


def toilet() -> tuple[list[Link], list[Joint]]:
    """A seat of slats, 2 cm thick, below a lid of 2 cm, beside a wall of 1.2 m, hinged at the rear edge."""
    slats = [((x, -0.2, 0.405), (x + 0.03, 0.2, 0.425)) for x in np.arange(-0.5, -0.03, 0.03)]
    links = [
        make_link("body", ((0.0, -0.3, 0.0), (0.1, 0.3, 1.2))),
        make_link("lid", ((-0.5, -0.2, 0.43), (-0.02, 0.2, 0.45))),
        make_link("seat", *slats),
    ]
    origin = (-0.03, 0.0, 0.427)
    joints = [
        make_joint("lid", "revolute", (0, 1, 0), origin, 1.55),
        make_joint("seat", "revolute", (0, 1, 0), origin, 1.5),
    ]
    return links, joints


def test_a_seat_needs_its_lid_open_though_it_is_nowhere_deep_in_it():
    links, joints = toilet()
    assert as_rows(find_requirements(links, joints)) == []
    assert as_rows(find_crossings(links, joints, ())) == [("joint_seat", "joint_lid", 1.0)]


def test_what_is_known_stays_and_is_not_turned_around():
    links, joints = toilet()
    known = (Requirement(joint="joint_lid", needs="joint_seat", fraction=0.5),)
    assert find_crossings(links, joints, known) == known
    same = (Requirement(joint="joint_seat", needs="joint_lid", fraction=0.5),)
    assert find_crossings(links, joints, same) == same


@pytest.mark.parametrize(("share", "needed"), [(0.13, False), (0.17, True)])
def test_a_link_is_blocked_from_a_share_of_its_volume(share: float, *, needed: bool):
    """A bar of 1 m slides under a flap so far that ``share`` of its length is in the flap's way."""
    links = [
        make_link("body", ((0.0, 0.0, -0.2), (3.0, 0.1, -0.1))),
        make_link("bar", ((0.0, 0.0, 0.0), (1.0, 0.1, 0.02))),
        make_link("flap", ((1.2, 0.0, 0.0), (1.3, 0.1, 0.02))),
    ]
    joints = [
        make_joint("bar", "prismatic", (1, 0, 0), (0, 0, 0), 0.2 + share),
        make_joint("flap", "prismatic", (0, 0, 1), (0, 0, 0), 0.1),
    ]
    found = find_crossings(links, joints, ())
    assert as_rows(found) == ([("joint_bar", "joint_flap", 0.25)] if needed else [])


@pytest.mark.parametrize(("left", "fraction"), [(0.015, 0.25), (0.025, 0.5)])
def test_a_way_is_free_where_two_percent_of_a_link_are_left_in_it(left: float, fraction: float):
    """A bar slides below a flap which, a quarter open, still takes in ``left`` of the bar's thickness."""
    links = [
        make_link("body", ((0.0, 0.0, -0.2), (3.0, 0.1, -0.1))),
        make_link("bar", ((0.0, 0.0, 0.0), (1.0, 0.1, 0.02))),
        make_link("flap", ((1.2, -0.1, 0.0), (2.6, 0.2, 0.02))),
    ]
    joints = [
        make_joint("bar", "prismatic", (1, 0, 0), (0, 0, 0), 1.4),
        make_joint("flap", "prismatic", (0, 0, 1), (0, 0, 0), 4 * 0.02 * (1 - left)),
    ]
    assert as_rows(find_crossings(links, joints, ())) == [("joint_bar", "joint_flap", fraction)]


def ram(travel: float, gap: float, lift: float) -> tuple[list[Link], list[Joint]]:
    """A block of 0.1 m that slides towards a gate of the same height, in an object that is 1 m high."""
    links = [
        make_link("body", ((0.0, 0.0, -0.9), (0.1, 0.1, -0.1))),
        make_link("ram", ((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))),
        make_link("gate", ((0.1 + gap, 0.0, 0.0), (0.2 + gap, 0.1, 0.1))),
    ]
    joints = [
        make_joint("ram", "prismatic", (1, 0, 0), (0, 0, 0), travel),
        make_joint("gate", "prismatic", (0, 0, 1), (0, 0, 0), lift),
    ]
    return links, joints


@pytest.mark.parametrize(("depth", "needed"), [(0.024, False), (0.026, True)])
def test_a_link_is_blocked_where_it_gets_deeper_than_a_fortieth_of_the_object(depth: float, *, needed: bool):
    found = find_requirements(*ram(0.2 + depth, 0.2, 1.0))
    assert as_rows(found) == ([("joint_ram", "joint_gate", 0.25)] if needed else [])


@pytest.mark.parametrize(("left", "fraction"), [(0.009, 0.25), (0.011, 0.5)])
def test_a_way_is_free_where_a_hundredth_of_the_object_is_left_in_it(left: float, fraction: float):
    """A gate which, a quarter open, is still so deep (m) in the way."""
    found = find_requirements(*ram(0.25, 0.2, 4 * (0.1 - left)))
    assert as_rows(found) == [("joint_ram", "joint_gate", fraction)]


@pytest.mark.parametrize(("twentieths", "needed"), [(10.0, True), (10.5, False)])
def test_a_link_is_blocked_by_what_is_in_its_way_at_a_twentieth_of_its_range(
    twentieths: float, *, needed: bool
):
    """A block that moves by its double length from pose to pose, and jumps over a gate between poses."""
    found = find_requirements(*ram(4.0, twentieths * 0.2 - 0.1, 1.0))
    assert as_rows(found) == ([("joint_ram", "joint_gate", 0.25)] if needed else [])
