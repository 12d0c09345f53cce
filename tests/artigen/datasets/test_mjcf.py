"""An MJCF is read as the URDF that moves alike; what is no tree of hinges and slides is refused."""

# mujoco is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

from pathlib import Path

import mujoco
import numpy as np
import pytest

from artigen.datasets.mjcf import is_mjcf, write_urdf
from artigen.datasets.sources import find_sources, name_source, read_source
from artigen.datasets.urdf_file import read_urdf
from artigen.errors import SourceError
from artigen.shapes.draw import draw_shape
from artigen.transforms import rotation_about
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.reference import ReferenceConfig, build_reference

MACHINE = """
<mujoco>
  <compiler angle="degree"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="object" pos="0.1 0.2 0.3" quat="0.8 0 0.6 0">
      <geom name="body" type="box" size="0.2 0.3 0.4" rgba="0.8 0.1 0.1 1"/>
      <geom name="felt" type="box" size="0.2 0.3 0.4" contype="1" conaffinity="1" group="3"/>
      <body name="door" pos="-0.2 0 0" euler="10 20 30">
        <joint name="hinge" type="hinge" axis="0 0 1" pos="0 -0.3 0.05" range="20 110" ref="20"/>
        <geom name="panel" type="box" size="0.01 0.3 0.4" pos="0 0 0.02"/>
        <body name="holder" pos="0 0.1 0">
          <body name="handle" pos="-0.04 0.1 0" euler="0 90 40">
            <geom name="bar" type="capsule" size="0.01 0.1"/>
            <joint name="slide" type="slide" axis="1 0 0" range="0 0.02"/>
            <joint name="twist" type="hinge" axis="0 1 0" pos="0.01 0.02 0"/>
          </body>
        </body>
      </body>
      <body name="lid" pos="0 0 0.4">
        <joint name="lid_hinge" type="hinge" axis="0 1 0" pos="0.2 0 0" range="-90 0"/>
        <geom name="cover" type="cylinder" size="0.2 0.01"/>
      </body>
    </body>
  </worldbody>
  <equality><joint joint1="lid_hinge" joint2="hinge" polycoef="0.1 -0.5 0 0 0"/></equality>
</mujoco>
"""


def write(tmp_path: Path, text: str, name: str = "machine.xml") -> Path:
    path = tmp_path / name
    path.write_text(text)
    return path


def place_urdf(urdf, q: dict[str, float]) -> dict[str, np.ndarray]:
    """Placements of all visuals at joint values."""
    moved: dict[str, np.ndarray] = {}
    for joint in urdf.joints:  # parents come first
        T = moved.get(joint.parent, np.eye(4))
        at, value = urdf.T_base_link[joint.child], q.get(joint.name, 0.0)
        step = np.eye(4)
        if joint.type == "prismatic":
            step[:3, 3] = value * np.array(joint.axis)
        elif joint.type != "fixed":
            step[:3, :3] = rotation_about(np.array(joint.axis), np.array([value]))[0]
        moved[joint.child] = T @ at @ step @ np.linalg.inv(at)
    return {s.name: moved.get(s.link, np.eye(4)) @ urdf.place(s) for s in urdf.visuals}


def test_the_urdf_moves_as_mujoco_does(tmp_path):
    """Chains on one body, joints beside the body's frame, coordinates that begin elsewhere, bodies that are
    mere frames: at any joint values, everything is where MuJoCo has it."""
    path = write(tmp_path, MACHINE)
    urdf = read_urdf(write_urdf(path, tmp_path))
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    base = [model.geom("body").id]
    rng = np.random.default_rng(0)
    names = [model.joint(k).name for k in range(model.njnt)]
    assert {joint.name for joint in urdf.joints} == set(names)
    for _ in range(5):
        q = rng.uniform(-0.5, 0.5, model.njnt)
        data.qpos[:] = model.qpos0 + q
        mujoco.mj_kinematics(model, data)
        placed = place_urdf(urdf, dict(zip(names, q, strict=True)))
        T_world_base = np.eye(4)
        T_world_base[:3, :3], T_world_base[:3, 3] = (
            data.geom_xmat[base].reshape(3, 3),
            data.geom_xpos[base][0],
        )
        for geom in range(model.ngeom):
            name = model.geom(geom).name
            if name == "felt":
                assert name not in placed
                continue
            T = np.eye(4)
            T[:3, :3], T[:3, 3] = data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom]
            expected = np.linalg.inv(T_world_base) @ T
            np.testing.assert_allclose(placed[name], expected, atol=1e-6)


def test_ranges_begin_at_the_reference_and_followers_are_mimics(tmp_path):
    urdf = read_urdf(write_urdf(write(tmp_path, MACHINE), tmp_path))
    joints = {joint.name: joint for joint in urdf.joints}
    assert (joints["hinge"].lower, joints["hinge"].upper) == pytest.approx((0.0, np.pi / 2))
    assert (joints["slide"].lower, joints["slide"].upper) == pytest.approx((0.0, 0.02))
    assert joints["twist"].type == "continuous"
    assert (joints["lid_hinge"].mimic, joints["lid_hinge"].mimic_multiplier) == ("hinge", -0.5)


@pytest.mark.parametrize("category", ["Microwave", "StorageFurniture", "TrashCan"])
def test_an_mjcf_of_ours_is_read_as_the_object_that_it_was_written_from(tmp_path, category):
    package = build_reference(draw_shape(category, 3), ReferenceConfig(textures="shared"))
    written = read_package(write_package(package, tmp_path / "package"))
    source = read_source(tmp_path / "package" / "mobility.mjcf.xml", tmp_path / "scratch")
    moving = [part for part in source.asset.parts if part.joint.type != "fixed"]
    driven = [joint for joint in written.joints if joint.type != "fixed"]
    assert len(moving) == len(driven)
    spans = sorted(
        part.joint.upper * (source.asset.scale if part.joint.type == "prismatic" else 1.0) for part in moving
    )
    assert spans == pytest.approx(sorted(joint.upper - joint.lower for joint in driven), abs=1e-4)
    shown = np.concatenate([v.mesh.vertices for link in written.links for v in link.visuals])
    corners = source.triangles.vertices * source.asset.scale
    np.testing.assert_allclose(np.ptp(corners, axis=0), np.ptp(shown, axis=0), atol=2e-4)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<mujoco><worldbody><body><geom size='1'/><joint type='ball'/></bod", "MuJoCo cannot read it"),
        (
            "<mujoco><worldbody><geom size='1'/><body name='b'><geom size='1'/><joint type='ball'/></body>"
            "</worldbody></mujoco>",
            "body 'b' has a free or ball joint",
        ),
        (
            "<mujoco><worldbody><geom size='1'/><body name='b'><geom size='1'/><freejoint/></body>"
            "</worldbody></mujoco>",
            "body 'b' has a free or ball joint",
        ),
    ],
)
def test_what_is_no_tree_of_hinges_and_slides_is_refused(tmp_path, text, said):
    with pytest.raises(SourceError, match=said):
        write_urdf(write(tmp_path, text), tmp_path)


def test_mjcf_is_told_by_its_root_element(tmp_path):
    assert is_mjcf(write(tmp_path, MACHINE, "a.xml"))
    assert not is_mjcf(write(tmp_path, "<robot name='r'/>", "b.xml"))
    assert not is_mjcf(write(tmp_path, "text", "c.xml"))
    for name in ("mug_tree", "oven"):
        (tmp_path / "all" / name).mkdir(parents=True)
        write(tmp_path / "all" / name, MACHINE, "model.xml")
    assert find_sources((tmp_path / "all",)) == [tmp_path / "all" / "mug_tree", tmp_path / "all" / "oven"]
    assert name_source(tmp_path / "all" / "oven" / "model.xml") == "oven"
