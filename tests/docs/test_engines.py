"""docs/how-to/engines.md: its blocks are Python, and run where their engine is installed."""

import importlib.util
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from project import ROOT

from artigen.api.demos import DemoSettings, make_demos
from artigen.api.formats import write_fixture
from artigen.runtime.runner import choose_runner
from artigen.shapes.draw import draw_shape, draw_variant, find_seed
from envs.validate import validate
from sim_export.files.folders import find_packages
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.reference import build_reference, describe_build

PAGE = ROOT / "docs" / "how-to" / "engines.md"
BLOCKS = {
    (section.splitlines()[0], number): block
    for section in PAGE.read_text().split("\n## ")[1:]
    for number, block in enumerate(re.findall(r"```python\n(.*?)```", section, re.DOTALL))
}
NEEDS = {
    "MuJoCo": "mujoco",
    "MJX": "mujoco.mjx",
    "mjlab": "mjlab",
    "dm_control": "dm_control",
    "Drake": "pydrake",
    "SAPIEN": "sapien",
    "ManiSkill": "mani_skill",
    "PyBullet": "pybullet",
    "Newton": "newton",
    "Genesis": "genesis",
    "robosuite": "robosuite",
    "RoboCasa": "robocasa",
    "LIBERO": "libero",
    "LeRobot": "lerobot",
}
"""What must be installed for a section's blocks; those of other sections are only compiled."""


@pytest.fixture(scope="module")
def cabinets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two cabinets of one topology in out/cabinets."""
    folder = tmp_path_factory.mktemp("how_to")
    seed = find_seed("StorageFurniture", (("drawer", 3), ("door", 0)))
    first = draw_shape("StorageFurniture", seed)
    build = describe_build(first)
    other = draw_variant("StorageFurniture", seed, 0, lambda shape: describe_build(shape) == build)
    for number, drawn in enumerate((first, other)):
        package = build_reference(drawn)
        write_package(package, folder / "out" / "cabinets" / f"StorageFurniture_{number}")
        if not number:
            write_fixture(package, folder / "out" / "cabinet", "refuse")
    return folder


def test_every_engine_has_ten_lines_or_so():
    assert len({section for section, _ in BLOCKS}) == 17
    assert set(NEEDS) < {section for section, _ in BLOCKS}
    for (section, _), block in BLOCKS.items():
        compile(block, section, "exec")
        assert len(block.splitlines()) <= 45, section


@pytest.mark.sim
@pytest.mark.parametrize(("section", "number"), [key for key in BLOCKS if key[0] in NEEDS])
def test_what_is_marked_so_runs(cabinets: Path, monkeypatch: pytest.MonkeyPatch, section: str, number: int):
    variable = f"{section.upper()}_PYTHON"
    other = os.environ.get(variable)
    if importlib.util.find_spec(NEEDS[section]) is None and other is None:
        pytest.skip(f"no module {NEEDS[section]} here, and no {variable}: a block of {PAGE.name} was not run")
    monkeypatch.chdir(cabinets)
    if section == "LeRobot":
        cfg = DemoSettings(part="drawer", pictures="none", validation="any")
        out = cabinets / "out"
        make_demos(
            "ArtiGen-OpenPart-v1",
            out / "cabinets",
            1,
            out / "demos",
            runner=choose_runner("local", 0),
            cfg=cfg,
        )
    if other is not None:
        command = [other, "-c", BLOCKS[section, number]]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr[-2000:]
        assert float(re.findall(r"open by ([0-9.]+)", done.stdout)[-1]) > 0.05
        return
    if section == "ManiSkill":  # takes packages that passed, and says so of others
        assert all(validate(folder).passed for folder in find_packages([cabinets / "out" / "cabinets"]))
    names: dict = {"__name__": "page"}
    exec(compile(BLOCKS[section, number], section, "exec"), names)
    opened = {
        ("MuJoCo", 0): lambda: names["data"].qpos[0],
        ("MuJoCo", 1): lambda: names["states"][:, -1, 1 : 1 + names["models"][0].nq].max(axis=1).min(),
        ("MJX", 0): lambda: names["data"].qpos[:, 0].min(),
        ("mjlab", 0): lambda: names["opened"].min().item(),
        ("dm_control", 0): lambda: names["drawer"].qpos.item(),
        ("Drake", 0): lambda: names["drawer"].get_translation(names["context"]),
        ("SAPIEN", 0): lambda: names["cabinet"].positions()["joint_0"],
        ("ManiSkill", 0): lambda: names["outcome"].open_fraction,
        ("PyBullet", 0): lambda: names["p"].getJointState(names["body"], 0)[0],
        ("Newton", 0): lambda: names["now"].joint_q.numpy().max(),
        ("Newton", 1): lambda: names["opened"][:, 0].min(),
        ("Genesis", 0): lambda: names["cabinet"].get_dofs_position(names["drawer"]).min().item(),
        ("robosuite", 0): lambda: names["data"].qpos[0],
        ("RoboCasa", 0): lambda: names["share"],
        ("LIBERO", 0): lambda: float(names["env"]._check_success()),
        ("LeRobot", 0): lambda: names["opened"],
    }
    assert opened[section, number]() > 0.05


def test_a_fixture_has_its_front_towards_minus_y_and_marks_its_box(cabinets: Path):
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(cabinets / "out" / "cabinet_robosuite" / "model.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    package = read_package(cabinets / "out" / "cabinets" / "StorageFurniture_0")
    deep, wide, high = np.ptp(
        [v for link in package.links for hull in link.hulls for v in hull.vertices], axis=0
    )
    np.testing.assert_allclose(2.0 * model.geom("reg_main").size, (wide, deep, high), atol=1e-5)
    assert data.site("top_site").xpos[2] - data.site("bottom_site").xpos[2] == pytest.approx(high, abs=1e-5)
    regions = {model.site(k).name for k in range(model.nsite) if model.site(k).name.endswith("_region")}
    assert regions == {f"{joint.child}_region" for joint in package.joints}
    before = data.body("link_0").xpos[1]
    data.joint("joint_0").qpos[0] = 0.1
    mujoco.mj_forward(model, data)
    assert before - data.body("link_0").xpos[1] == pytest.approx(0.1, abs=1e-6)


def test_cabinets_have_one_structure_in_usd(cabinets: Path):
    pytest.importorskip("pxr")
    from pxr import Usd, UsdGeom, UsdPhysics

    from sim_export.usd.write import write_usd

    structures = []
    for folder in find_packages([cabinets / "out" / "cabinets"]):
        main = write_usd(read_package(folder), cabinets / "out" / "usd")
        stage = Usd.Stage.Open(str(main))
        root = stage.GetDefaultPrim()
        prims = [prim for prim in Usd.PrimRange(root) if prim != root]
        structures.append(
            [
                (str(prim.GetPath().MakeRelativePath(root.GetPath())), prim.GetTypeName())
                for prim in prims
                if prim.HasAPI(UsdPhysics.CollisionAPI)
                or prim.IsA(UsdPhysics.Joint)
                or prim.IsA(UsdGeom.Xform)
            ]
        )
    assert len(structures) == 2
    assert structures[0] == structures[1]
