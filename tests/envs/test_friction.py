"""What friction, chains of doors and followers give way by, in SAPIEN."""

from pathlib import Path

import numpy as np
import pytest

from artigen.types import Joint
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull
from sim_export.package import Inertial, Link, SimPackage

sapien = pytest.importorskip("sapien")
from envs.sim.loaded import LoadedPackage, set_open_fraction  # noqa: E402
from envs.sim.sapien import LoadConfig, load_package  # noqa: E402
from envs.sim.scene import create_scene  # noqa: E402

pytestmark = pytest.mark.sim
G = 9.81


def block(name: str, label: str, low: object, high: object, mass: float) -> Link:
    """A box with a mass."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    inertial = Inertial(mass=mass, com=(low + high) / 2.0, inertia=0.2 * mass * np.eye(3))
    return Link(
        name=name, label=label, parts=(name,), visuals=(), hulls=(box_hull(low, high),), inertial=inertial
    )  # fmt: skip


def joint(number: int, kind: str, parent: str, at: object, axis: object, **given: object) -> Joint:
    """A joint that moves the link of the same number."""
    return Joint(
        name=f"joint_{number}", type=kind, parent=parent, child=f"link_{number}", upper=1.0,
        origin=np.array(at, dtype=float), axis=np.array(axis, dtype=float), velocity=10.0, **given,
    )  # fmt: skip


def load(folder: Path, links: tuple[Link, ...], joints: tuple[Joint, ...]) -> LoadedPackage:
    """The links, of which the last one stands fast, in a scene with steps of a hundredth of a second."""
    package = SimPackage(name="a", category="Table", visual="voxels", links=links, joints=joints)
    write_package(package, folder / "a")
    return load_package(create_scene(0.01), folder / "a", LoadConfig(base="fixed"), package)


BODY = block("link_2", "base", (-1.0, 0.1, 0.0), (0.0, 1.0, 1.0), 50.0)


@pytest.mark.parametrize("share", [0.5, 0.98])
def test_a_joint_creeps_by_a_hundredth_of_a_millimetre_a_second_at_its_friction(tmp_path, share):
    """And by a share of it under a load that is such a share of its friction."""
    slide = joint(0, "prismatic", "link_2", (0, 0, 0), (0, 0, -1), friction=2.0 * G / share)
    loaded = load(
        tmp_path, (block("link_0", "drawer", (0.1, 0.2, 0.0), (0.2, 0.4, 0.2), 2.0), BODY), (slide,)
    )
    for _ in range(20):
        loaded.step()
    assert loaded.articulation.qpos[0] == pytest.approx(share * 1e-5 * 0.2, rel=0.1)


def test_the_first_leaf_of_a_folding_door_gives_way_a_fourth_as_far_as_with_ten_iterations(tmp_path):
    """On a slope of 5 degrees; the friction of both hinges exceeds their load by a fifth, and both creep."""
    load_of_leaf = 5.0 * G * np.sin(np.radians(5.0)) * 0.25
    hinges = (
        joint(0, "revolute", "link_2", (0, 0, 0), (0, 0, 1), friction=1.2 * 4.0 * load_of_leaf),
        joint(1, "revolute", "link_0", (0.5, 0, 0), (0, 0, 1), friction=1.2 * load_of_leaf),
    )
    leaves = (
        block("link_0", "door", (0.01, -0.02, 0.0), (0.49, 0.0, 1.0), 5.0),
        block("link_1", "door", (0.51, -0.02, 0.0), (0.99, 0.0, 1.0), 5.0),
    )
    half = np.radians(5.0) / 2.0

    def give_way(iterations: int | None) -> float:
        loaded = load(tmp_path / str(iterations), (*leaves, BODY), hinges)
        if iterations is not None:
            loaded.articulation.set_solver_position_iterations(iterations)
        slope = sapien.Pose(q=[float(np.cos(half)), -float(np.sin(half)), 0.0, 0.0])
        loaded.articulation.set_root_pose(slope)
        for _ in range(30):
            loaded.step()
        first, second = loaded.articulation.qpos
        return float(first - second)

    assert give_way(10) / give_way(None) == pytest.approx(4.0, abs=0.05)


def test_a_follower_sags_by_a_hundredth_of_a_millimetre(tmp_path):
    """By gravity over the square of its frequency of 1000 rad/s; with longer steps it sags by less."""
    joints = (
        joint(0, "prismatic", "link_2", (0, 0, 0), (-1, 0, 0), friction=5.0),
        joint(1, "prismatic", "link_2", (0, 0, 0), (0, 0, -1), follows="joint_0", ratio=1.0),
    )
    blocks = (
        block("link_0", "drawer", (0.1, -0.4, 0.0), (0.2, -0.2, 0.2), 1.0),
        block("link_1", "drawer", (0.5, -0.4, 0.0), (0.6, -0.2, 0.2), 3.0),
    )
    loaded = load(tmp_path, (*blocks, BODY), joints)
    loaded.scene.set_timestep(1e-3)
    set_open_fraction(loaded, 0.5)
    for _ in range(50):
        loaded.step()
    leader, follower = loaded.articulation.qpos
    assert follower - leader == pytest.approx(G / 1000.0**2, rel=0.2)
