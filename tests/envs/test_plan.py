"""What a hand is expected to carry while it opens and closes a joint."""

from pathlib import Path

import numpy as np
import pytest

from artigen.transforms import rotation_about
from artigen.types import Joint
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull
from sim_export.package import Inertial, Link, SimPackage

pytest.importorskip("sapien")
from envs.hand import hand_effort, measure_moved
from envs.plan import plan_trials
from envs.sim.sapien import LoadConfig, load_package
from envs.sim.scene import create_scene

pytestmark = pytest.mark.sim
G = 9.81
HALF = np.array([0.2, 0.2, 0.01])
ACROSS = np.array([0.0, -1.0, 0.0])


def carried_of_lid(folder: Path, twelfths: float) -> float:
    """What a hand carries of a lid of 2 kg that opens by 2.4 rad, and lies level after so many twelfths of
    them."""
    hinge = np.array([0.0, 0.0, 1.0])
    com = hinge + rotation_about(ACROSS, np.array(-0.2 * twelfths)) @ [0.25, 0.0, 0.0]
    lid = Link(
        name="link_0", label="door", parts=("lid",), visuals=(),
        hulls=(box_hull(com - HALF, com + HALF),),
        inertial=Inertial(mass=2.0, com=com, inertia=0.1 * np.eye(3)),
    )  # fmt: skip
    body = Link(
        name="link_1", label="base", parts=("body",), visuals=(),
        hulls=(box_hull(np.array([-1.0, -0.5, 0.0]), np.array([-0.5, 0.5, 1.0])),),
        inertial=Inertial(mass=50.0, com=np.zeros(3), inertia=np.eye(3)),
    )  # fmt: skip
    joint = Joint(
        name="joint_0", type="revolute", parent="link_1", child="link_0", origin=hinge,
        axis=ACROSS, upper=2.4,
    )  # fmt: skip
    package = SimPackage(name="box", category="Box", visual="voxels", links=(lid, body), joints=(joint,))
    write_package(package, folder / "box")
    loaded = load_package(create_scene(0.01), folder / "box", LoadConfig(), package)
    joint = loaded.joints[0]
    return plan_trials(loaded).joints[0].opening - hand_effort(joint, measure_moved(joint))


@pytest.mark.parametrize(("twelfths", "share"), [(0, 1.0), (5, 1.0), (5.5, np.cos(0.1)), (12, 1.0)])
def test_a_hand_carries_the_weight_that_a_lid_has_at_every_twelfth_of_its_way(tmp_path, twelfths, share):
    """Between two of them the greatest moment is missed by the cosine of half a twelfth."""
    assert carried_of_lid(tmp_path, twelfths) == pytest.approx(share * 2.0 * G * 0.25, rel=1e-4)
