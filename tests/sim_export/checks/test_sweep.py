"""V201 between its poses: thin things that the edge of a door passes are met wherever they stand."""

from pathlib import Path

import numpy as np
import pytest

from sim_export.checks.config import CheckConfig
from sim_export.checks.subject import Subject
from sim_export.checks.sweep import check_sweep

WIDTH = 0.8


def write_door(folder: Path, angle: float, into: float) -> Subject:
    """A leaf of 0.8 m, and a plate that reaches ``into`` (m) the circle of its edge, both 4 mm thick."""
    out = WIDTH - into + 0.05
    x, y = -out * np.sin(angle), out * np.cos(angle)
    folder.joinpath("mobility.urdf").write_text(
        f"""<robot name="door">
<link name="base"/>
<link name="link_0"><collision><origin xyz="{x} {y} 0.5" rpy="0 0 {angle}"/>
<geometry><box size="0.004 0.1 0.1"/></geometry></collision></link>
<link name="link_1"><collision><origin xyz="-0.002 {WIDTH / 2} 0.5"/>
<geometry><box size="0.004 {WIDTH} 1"/></geometry></collision></link>
<joint name="joint_0" type="fixed"><parent link="base"/><child link="link_0"/></joint>
<joint name="joint_1" type="revolute"><parent link="base"/><child link="link_1"/>
<axis xyz="0 0 1"/><limit lower="0" upper="2.1" effort="10" velocity="1"/></joint>
</robot>"""
    )
    return Subject(folder)


@pytest.mark.parametrize("angle", np.linspace(0.4, 0.5, 5))
def test_a_plate_between_the_poses_is_met(angle: float, tmp_path: Path):
    """By 21 poses, 84 mm apart, four of the five were not."""
    found = check_sweep(write_door(tmp_path, angle, 0.006), CheckConfig())
    assert not found.passed
    assert 0.002 < found.value <= 0.006


def test_a_plate_beyond_the_edge_is_not(tmp_path: Path):
    assert check_sweep(write_door(tmp_path, 0.45, -0.002), CheckConfig()).passed
