"""`artigen grasps`: what it says, stores and writes."""

from pathlib import Path

import pytest
from pulled_drawer import pulled_drawer

from artigen.cli.grasps import grasps
from sim_export.files.read import read_package
from sim_export.files.write import write_package


@pytest.mark.sim
def test_the_command_stores_what_it_proves_and_says_what_has_no_grasp(tmp_path: Path, capsys):
    made = write_package(pulled_drawer(), tmp_path / "pulled")
    assert grasps((made,), gripper=("franka", "parallel:0.009"), engines=("mujoco",), out=tmp_path) == 1
    said = capsys.readouterr().out.splitlines()
    assert said[0].endswith("franka pull: 3 of 3 grasps proven")
    assert "opens to 9 mm" in said[1]
    assert [grasp.proven for grasp in read_package(made).grasps] == [True] * 3
    assert len((tmp_path / "grasps.csv").read_text().splitlines()) == 4
