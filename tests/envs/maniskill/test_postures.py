"""Which arm postures are kept, and which base is preferred for a goal of the hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from artigen.types import Joint
from envs.maniskill.objects import TaskObject, TaskPart
from envs.maniskill.placement import Stand
from envs.maniskill.postures import Goal, Postures, find_putting_stand, sample_postures
from envs.maniskill.robots import ROBOTS
from envs.maniskill.solver.body import Body
from envs.maniskill.solver.chain import Chain
from envs.maniskill.solver.field import Field
from sim_export.package import SimPackage

FETCH, PANDA = ROBOTS["fetch"], ROBOTS["panda"]
ALONG_X, ALONG_Y, ALONG_Z = np.eye(3), np.eye(3)[:, [1, 2, 0]], np.eye(3)[:, [2, 0, 1]]
"""Frames whose x axis is that of the world."""


def arm(*pitches: tuple[float, float, float], height: float = 0.3, hand: float = 0.0) -> Chain:
    """A joint about z, joints about y with (length before, lower, upper), and a roll of the hand about x."""
    frames, at = [ALONG_Z], [np.array([0.0, 0.0, height])]
    for length, _, _ in pitches:
        frames.append(ALONG_Y)
        at.append(np.array([length, 0.0, 0.0]))
    frames.append(ALONG_X)
    at.append(np.array([hand, 0.0, 0.0]))
    before = np.tile(np.eye(4), (len(frames), 1, 1))
    last = np.eye(3)
    for k, (R, offset) in enumerate(zip(frames, at, strict=True)):
        before[k, :3, :3], before[k, :3, 3] = last.T @ R, last.T @ offset
        last = R
    limits = np.array([(-3.0, 3.0), *(pitch[1:] for pitch in pitches), (-3.0, 3.0)])
    return Chain(
        before=before, tool=np.eye(4), lower=limits[:, 0], upper=limits[:, 1],
        columns=tuple(range(len(frames))),
    )  # fmt: skip


def sampled(chain: Chain, carrier: int = 2, point: tuple[float, float, float] = (9.0, 0.0, 0.0)) -> Postures:
    """Postures of an arm with one point in the frame of a joint, by default far off."""
    body = Body(points=np.array([point]), carrier=np.array([carrier]), gap=np.zeros(1))
    return sample_postures(chain, body, FETCH)


def test_the_middle_92_hundredths_of_a_range_are_used_and_hands_point_up_by_a_tenth_of_a_radian():
    slope = sampled(arm((0.0, -1.0, 1.0), hand=0.75)).slope
    assert 0.91 < slope.max() <= 0.92
    assert -0.1 <= slope.min() < -0.095


def test_a_hand_is_forty_to_eighty_centimetres_away_and_at_a_height_in_reach():
    """From 45 cm below the base to 85 cm above."""
    tool = sampled(arm((0.0, -1.6, 1.6), (0.6, 0.0, 3.0), hand=0.6)).tool
    away = np.linalg.norm(tool[:, :2], axis=1)
    assert 0.4 <= away.min() < 0.41
    assert 0.79 < away.max() <= 0.8
    assert -0.45 <= tool[:, 2].min() < -0.44
    assert 0.84 < tool[:, 2].max() <= 0.85


def test_forearm_and_hand_keep_off_the_base():
    """It is 12 cm around and 45 cm high; what the first three joints carry may be there."""
    chain = arm((0.0, -1.6, 1.6), (0.17, 0.0, 3.0), hand=0.6)
    elbow = sampled(chain, 3, (-0.6, 0.0, 0.0)).points[:, 0]
    away, height = np.linalg.norm(elbow[:, :2], axis=1), elbow[:, 2]
    assert 0.12 <= away[height < 0.44].min() < 0.122
    assert 0.45 <= height[away < 0.11].min() < 0.452
    lower = sampled(chain, 2, (0.0, 0.0, 0.0)).points[:, 0]
    assert ((np.linalg.norm(lower[:, :2], axis=1) < 0.1) & (lower[:, 2] < 0.44)).any()


def place(
    slopes: list[float], rooms: list[float], bearings: list[float], *, down: bool = False
) -> Stand | None:
    """The base for a goal at a height of 1 m, from postures of given slope, clearance and bearing.

    Each posture is there several times, so that the directions that are drawn for it are much alike. Its hand
    is at 60 cm, and a distance tells it.
    """
    package = SimPackage(name="a", category="Table", visual="voxels", links=(), joints=())
    entry = TaskObject(
        folder=Path(), package=package, parts=(), left_out=(),
        bounds=np.array([[9.0, -9.0, 0.0], [9.1, 9.0, 9.0]]),
    )  # fmt: skip
    joint = Joint(
        name="j", type="prismatic", parent="a", child="b", origin=np.zeros(3),
        axis=np.array([-1.0, 0.0, 0.0]), upper=0.1,
    )  # fmt: skip
    part = TaskPart(
        kind="drawer", verb="open", joint=joint, handle=None, grip=np.zeros(3), moved=entry.bounds, own=(),
        held=(), needs=(),
    )  # fmt: skip
    count = 16
    away, bearing = np.repeat(0.6 + 0.1 * np.arange(len(slopes)), count), np.repeat(bearings, count)
    points = np.zeros((len(away), 1, 3))
    points[:, 0, 2] = np.repeat(rooms, count)
    tool = np.stack([away * np.cos(bearing), away * np.sin(bearing), np.ones(len(away))], axis=1)
    postures = Postures(
        tool=tool, heading=bearing, slope=np.repeat(slopes, count), points=points, gap=np.zeros(1)
    )
    far = Field(low=np.full(3, 1e3), cell=0.01, distance=np.full((1, 1, 1), 0.12, dtype=np.float32))
    return find_putting_stand(
        entry, part, replace(PANDA, heights=(0.0,)), postures=postures, field=far, opened=0.0,
        goal=Goal(places=np.array([[0.0, 0.0, 1.0]]), inwards=np.array([1.0, 0.0, 0.0]), down=down),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("slope", "down", "some"),
    [(-0.101, False, False), (-0.099, False, True), (0.849, False, True), (0.851, False, False),
     (0.899, True, False), (0.901, True, True), (1.579, True, True), (1.581, True, False)],
)  # fmt: skip
def test_a_hand_is_almost_level_in_a_compartment_and_steep_in_a_drawer(slope, down, some):
    assert (place([slope], [0.1], [0.0], down=down) is not None) == some


@pytest.mark.parametrize(("room", "some"), [(5e-4, True), (-5e-4, False)])
def test_an_arm_that_collides_is_nowhere(room, some):
    assert (place([0.0], [room], [0.0]) is not None) == some


@pytest.mark.parametrize(
    ("straight", "skew", "chosen"),
    [
        (0.05, 0.0519, 0.6),  # a radian costs a centimetre of clearance, and the second is 0.2 rad askew
        (0.05, 0.0521, 0.7),
        (0.061, 0.09, 0.6),  # more than 6 cm are no better
        (0.057, 0.0615, 0.7),
    ],
)
def test_clearance_counts_up_to_six_centimetres_and_what_is_askew_costs_some(straight, skew, chosen):
    found = place([0.0, 0.0], [straight, skew], [0.0, 0.2])
    assert found is not None
    assert np.hypot(found.x, found.y) == pytest.approx(chosen)
