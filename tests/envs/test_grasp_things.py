"""Grasps of loose things: what is lifted in both engines, and what two fingers cannot hold."""

from dataclasses import replace

import numpy as np
import pytest

from envs.grasps.things import grasp_thing, thing_package
from envs.rooms.contents import draw_thing
from envs.rooms.room import Item
from envs.rooms.things import THINGS

pytestmark = pytest.mark.sim


def draw(name: str) -> Item:
    thing = next(each for each in THINGS if each.name == name)
    return draw_thing(thing, np.random.default_rng(0)).item(0, None, "", np.zeros(3))


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: thing.name)
def test_a_package_of_a_thing_has_its_mass_and_stands_on_the_ground(thing):
    item = draw(thing.name)
    package = thing_package(item.thing, item.size, item.mass)
    body = package.links[-1]
    assert body.inertial.mass == pytest.approx(item.mass)
    points = np.concatenate([hull.vertices for hull in body.hulls])
    assert points[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    assert np.all(np.abs(body.inertial.com - (points.min(axis=0) + points.max(axis=0)) / 2) < item.size)


def test_a_cup_is_lifted_in_both_engines_and_not_if_it_is_too_heavy():
    cup = draw("cup")
    grasps = grasp_thing(cup)
    assert sum(grasp.proven for grasp in grasps) == 3
    assert [proof.engine for proof in grasps[0].proofs] == ["sapien", "mujoco"]
    heavy = grasp_thing(replace(cup, mass=20.0))  # 2 x 70 N x 0.6 = 84 N hold 8.6 kg
    assert not any(grasp.proven for grasp in heavy)


def test_a_book_that_lies_flat_leaves_no_room_for_a_finger_below_it():
    assert grasp_thing(draw("book")) == ()
