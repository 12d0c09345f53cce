"""Opening packages: from folders and values, again after a change, and without leaving anything behind."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from sample_packages import SAMPLE_PARTS, build_package

from envs.dynamics import check_mujoco
from envs.sim.load import load
from sim_export.errors import PackageError
from sim_export.files.write import write_package
from sim_export.geometry.hulls import convex_hull
from sim_export.package import SimPackage

pytest.importorskip("mani_skill")
pytestmark = pytest.mark.sim
CPU = {"sim_backend": "physx_cpu", "render_backend": "none", "validation": "any"}


def with_drawer(height: float) -> SimPackage:
    """The sample cabinet with a pyramid of this height (m) as its drawer, which is stored as a mesh."""
    package = build_package(SAMPLE_PARTS)
    drawer, *others = package.links
    low, high = (np.concatenate([x.vertices for x in drawer.hulls]).min(axis=0) + step for step in (0.0, 0.1))
    corners = [[x, y, low[2]] for x in (low[0], high[0]) for y in (low[1], high[1])]
    hull = convex_hull(np.array([*corners, [*(low + high)[:2] / 2.0, low[2] + height]]))
    return replace(package, links=(replace(drawer, hulls=(hull,)), *others))


def height_of(articulation: Any) -> float:
    """Height (m) of the drawer's shape in an engine."""
    link = next(link for link in articulation.links if link.name.endswith("link_0"))
    low, high = link.get_global_aabb_fast()
    return float(high[2] - low[2])


@pytest.mark.parametrize("way", ["sapien", "ArtiGen-OpenPart-v1"])
def test_a_package_written_again_at_its_path_is_the_new_one(way: str, tmp_path: Path):
    for height in (0.1, 0.05, 0.08):
        folder = write_package(with_drawer(height), tmp_path / "cabinet", overwrite="replace")
        if way == "sapien":
            loaded = load(folder)
            assert height_of(loaded.articulation) == pytest.approx(height, abs=1e-3)
            continue
        env = gym.make(way, packages=str(folder), **CPU)  # type: ignore[arg-type]
        env.reset(seed=0)
        task: Any = env.unwrapped
        assert height_of(task.built[0]._objs[0]) == pytest.approx(height, abs=1e-3)
        entry, _ = task.drawn[0]
        assert np.ptp(entry.package.links[0].hulls[0].vertices[:, 2]) == pytest.approx(height, abs=1e-6)
        env.close()


@pytest.mark.parametrize("engine", ["sapien", "mujoco"])
def test_a_value_behaves_as_its_folder(engine: Any, tmp_path: Path):
    package = with_drawer(0.1)
    found = []
    for given in (package, write_package(package, tmp_path / "cabinet")):
        simulation = load(given, engine)
        simulation.reset({"joint_1": 0.3})
        for _ in range(20):
            simulation.step({"joint_0": 20.0})
        found.append(simulation.positions())
        assert simulation.package.name == package.name
    assert found[0] == pytest.approx(found[1], abs=1e-6)
    assert found[0]["joint_0"] > 0.005
    assert found[0]["joint_1"] == pytest.approx(0.3, abs=1e-3)


def test_a_scene_steps_on_without_an_object_that_was_taken_out(tmp_path: Path):
    package = with_drawer(0.1)
    sprung = replace(package, joints=(replace(package.joints[0], spring=5.0), *package.joints[1:]))
    simulation = load(sprung)
    simulation.scene.remove_articulation(simulation.articulation)
    simulation.scene.step()


@pytest.mark.parametrize("engine", ["sapien", "mujoco"])
def test_wrong_arguments_are_refused(engine: Any, tmp_path: Path):
    simulation = load(with_drawer(0.1), engine)
    with pytest.raises(ValueError, match="no joint 'lid'; it has joint_0, joint_1"):
        simulation.reset({"lid": 1.0})
    with pytest.raises(ValueError, match="timestep 0"):
        load(with_drawer(0.1), engine, timestep=0.0)
    with pytest.raises(ValueError, match="expected sapien or mujoco"):
        load(with_drawer(0.1), "bullet")  # type: ignore[call-overload]
    with pytest.raises(PackageError):
        load(tmp_path / "nothing", engine)


def test_mujoco_keeps_no_meshes_or_images_of_what_it_compiled(tmp_path: Path):
    """Half a gigabyte of them otherwise stays in a process that validates one package after the other."""
    import mujoco

    # mujoco is a compiled module with empty stubs.
    cache = mujoco.mj_getCache()  # type: ignore[attr-defined]
    folder = write_package(with_drawer(0.1), tmp_path / "cabinet")
    mujoco.MjModel.from_xml_path(str(folder / "mobility.mjcf.xml"))  # type: ignore[attr-defined]
    assert mujoco.mj_getCacheSize(cache) > 0  # type: ignore[attr-defined]
    assert check_mujoco(folder).verdict in ("pass", "fail")
    assert mujoco.mj_getCacheSize(cache) == 0  # type: ignore[attr-defined]
