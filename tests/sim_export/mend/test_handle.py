"""A handle moves out by as many steps as it takes to be grasped, if that is near."""

from dataclasses import replace

import numpy as np
import pytest
from triangle_box import box

from artigen.types import FIXED, Asset, Joint, Part
from sim_export.checks.config import CheckConfig
from sim_export.mend.handle import move_handles
from sim_export.mend.source import open_source

GAP = 0.01


def part_of(triangles: np.ndarray, name: str, label: str, parent: int, joint: Joint) -> Part:
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    at = np.stack([(low + high) / 2, high - low])
    return Part(name=name, label=label, parent=parent, joint=joint, box=at)


def moved_by(missing: float) -> float:
    """How far (m) a plate moves, too wide for a gripper, behind which fingers lack so much room (m)."""
    hinge = Joint(
        type="revolute", axis=np.array([0.0, 0.0, 1.0]), origin=np.array([-0.222, -0.25, 0.0]), upper=1.5
    )
    body, door, plate = surfaces = (
        box((-0.2, -0.25, -0.5), (0.3, 0.25, 0.5)),
        box((-0.222, -0.25, -0.5), (-0.202, 0.25, 0.5)),
        box((-0.232 - GAP, 0.05, -0.05), (-0.222 - GAP, 0.15, 0.05)),
    )
    parts = (
        part_of(body, "base", "base", -1, FIXED),
        part_of(door, "door_0", "door", 0, hinge),
        part_of(plate, "handle_0", "handle", 1, FIXED),
    )
    asset = Asset(name="cabinet", category="StorageFurniture", scale=1.0, parts=parts)
    cfg = replace(CheckConfig(), min_clearance=GAP + missing)
    return float(np.linalg.norm(move_handles(open_source(asset, surfaces), cfg).shifts[2]))


@pytest.mark.parametrize(
    ("missing", "shift"), [(0.0023, 0.0025), (0.0027, 0.005), (0.049, 0.05), (0.051, 0.0)]
)
def test_a_handle_moves_by_steps_of_2_5_millimetres_and_no_farther_than_five_centimetres(missing, shift):
    assert moved_by(missing) == pytest.approx(shift)
