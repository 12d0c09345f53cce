"""Clearances of arm and hand."""

from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest
from one_joint import crank, ground, lifted, swinging

from envs.maniskill.solver import body
from envs.maniskill.solver.body import Obstacle, holding, is_free, read_body, surface_points
from sim_export.geometry.hulls import box_hull

BOX = box_hull(np.zeros(3), np.array([0.3, 0.2, 0.1])).vertices


@pytest.mark.parametrize(("height", "free"), [(0.0201, True), (0.0199, False)])
def test_an_arm_is_free_at_its_clearance_and_not_below(height, free):
    obstacle = Obstacle(field=ground(0.0), T_field_root=np.eye(4))
    assert is_free(crank(1.0), swinging(0.02), (obstacle,), lifted(height))[0] == free


def test_a_hand_comes_twice_as_close_as_an_arm_and_has_twice_as_many_points_each_way(monkeypatch):
    monkeypatch.setattr(body, "shape_vertices", lambda shape: shape)
    pose = MagicMock(to_transformation_matrix=lambda: np.eye(4))
    joints = [
        SimpleNamespace(name=name, type=kind, pose_in_child=pose, pose_in_parent=pose)
        for name, kind in (("turn", "revolute"), ("", "fixed"))
    ]
    links = [SimpleNamespace(name="root", parent=None, collision_shapes=[BOX])]
    for name, joint in zip(("arm", "panda_hand"), joints, strict=True):
        links.append(SimpleNamespace(name=name, parent=links[-1], joint=joint, collision_shapes=[BOX]))
    robot = MagicMock(active_joints=joints[:1], qpos=np.zeros(1), links=links)
    found = read_body(robot, crank(0.1), ("_hand",))
    coarse, fine = surface_points(BOX, 0.03), surface_points(BOX, 0.015)
    np.testing.assert_array_equal(found.points, np.concatenate([coarse, fine]))
    np.testing.assert_array_equal(found.gap, np.repeat([0.016, 0.008], [len(coarse), len(fine)]))


def test_what_is_held_has_as_many_points_as_the_hand():
    found = holding(swinging(0.01), crank(0.1), BOX, 0.003)
    assert len(found.points) == 1 + len(surface_points(BOX, 0.015))
    assert (found.gap[1:] == 0.003).all()
