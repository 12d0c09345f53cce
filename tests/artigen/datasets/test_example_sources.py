"""The same cabinet in every layout that is read is the same object."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from project import ROOT

from artigen.api.suggest import suggest_files
from artigen.datasets.joints_file import JointsFile, NodeJoint, joints_path, read_joints, write_joints
from artigen.datasets.mesh_files import read_named
from artigen.datasets.source_object import ReaderConfig
from artigen.datasets.sources import find_layout, find_sources, list_objects, name_source, read_source
from artigen.errors import SourceError
from artigen.types import Asset

FILES = sorted(file for file in (ROOT / "examples" / "sources").iterdir() if file.suffix != ".mtl")
NEEDS = {".usda": "pxr", ".xacro": "xacro"}


def read(path: Path, scratch: Path, **cfg) -> Asset:
    pytest.importorskip(NEEDS.get(path.suffix, "numpy"))
    return read_source(path, scratch, ReaderConfig(samples=2000, **cfg)).asset


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of the files, with proposed joints for the mesh."""
    copy = shutil.copytree(ROOT / "examples" / "sources", tmp_path / "sources")
    assert len(list(suggest_files([copy / "cabinet_mesh.obj"]))) == 3
    return copy


@pytest.mark.parametrize("name", [file.name for file in FILES])
def test_every_layout_gives_the_same_cabinet(folder: Path, name: str):
    want = read(folder / "cabinet_urdf.urdf", folder / "scratch")
    found = read(folder / name, folder / "scratch")
    assert list_objects(folder / name) == ()
    for part, other in zip(found.parts, want.parts, strict=True):
        assert (part.label, part.parent, part.joint.type) == (other.label, other.parent, other.joint.type)
        np.testing.assert_allclose(part.box, other.box, atol=1e-5)
        if part.joint.type == "fixed":
            continue
        np.testing.assert_allclose(part.joint.axis, other.joint.axis, atol=1e-6)
        if part.joint.type == "revolute":  # the mesh's proposal stands where its makers put the hinge
            np.testing.assert_allclose(part.joint.origin[:2], other.joint.origin[:2], atol=1e-5)
        assert part.joint.upper == pytest.approx(other.joint.upper, rel=0.15 if ".obj" in name else 1e-4)
    assert found.surface is not None
    assert want.surface is not None
    np.testing.assert_allclose(found.surface.colors.mean(axis=0), want.surface.colors.mean(axis=0), atol=4)


def test_a_mesh_with_joints_is_an_object_of_its_folder_and_one_without_is_none(folder: Path, tmp_path: Path):
    for file in folder.glob("cabinet_mesh*"):
        (tmp_path / "more" / "one").mkdir(parents=True, exist_ok=True)
        shutil.copy(file, tmp_path / "more" / "one")
    assert find_sources((tmp_path / "more",)) == [tmp_path / "more" / "one"]
    assert find_layout(tmp_path / "more" / "one") == "mesh with joints"
    joints_path(tmp_path / "more" / "one" / "cabinet_mesh.obj").unlink()
    assert find_layout(tmp_path / "more" / "one") is None
    assert name_source(folder / "cabinet_xacro.urdf.xacro") == "cabinet_xacro"


def test_a_xacro_takes_arguments_and_finds_packages_above(folder: Path):
    path = folder / "cabinet_xacro.urdf.xacro"
    short = read(path, folder / "scratch", arguments=("travel:=0.15",))
    assert short.parts[3].joint.upper * short.scale == pytest.approx(0.15)
    text = path.read_text().replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ', 1)
    (folder / "outer.xacro").write_text(
        '<robot name="o" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="$(find sources)/cabinet_xacro.urdf.xacro"/></robot>'
    )
    assert len(read(folder / "outer.xacro", folder / "scratch").parts) == len(short.parts)
    for said, argument, content in (
        ("expected name:=value", "travel=1", text),
        (
            "xacro cannot expand it: .*gone",
            "travel:=1",
            path.read_text().replace("$(arg travel)", "$(arg gone)"),
        ),
        ("argument 'travl', expected one of travel .did you mean travel", "travl:=1", path.read_text()),
        ("argument 'travel', expected none", "travel:=1", "<robot name='still'/>"),
        (
            "xacro cannot expand it: .*nowhere",
            "travel:=1",
            path.read_text().replace("(arg", "(find nowhere)(arg"),
        ),
        (
            "xacro cannot expand it",
            "travel:=1",
            path.read_text().replace("${travel}", "${open('/etc/passwd')}"),
        ),
    ):
        bad = folder / "bad.xacro"
        bad.write_text(content)
        with pytest.raises(SourceError, match=said) as error:
            read(bad, folder / "scratch", arguments=(argument,))
        assert "\n" not in str(error.value)


@pytest.mark.parametrize("ends", [".glb", ".gltf"])
def test_nodes_below_named_nodes_move_with_them(folder: Path, ends: str):
    """Nodes of a scene in millimetres, each a step away from where the OBJ has it, in two levels."""
    scene, step = trimesh.Scene(), np.eye(4)
    step[:3, 3] = (0.0, 100.0, 0.0)
    named, _ = read_named(folder / "cabinet_mesh.obj", folder)
    for number, (names, mesh) in enumerate(named):
        mesh.apply_transform(np.diag([1000.0, 1000.0, 1000.0, 1.0]))
        mesh.apply_translation((0.0, -100.0, 0.0))
        outer = names[-1]
        if outer not in scene.graph.nodes:
            scene.graph.update(frame_from="world", frame_to=outer, matrix=step)
        scene.add_geometry(mesh, node_name=f"piece_{number}", geom_name=f"g{number}", parent_node_name=outer)
    path = folder / f"twin{ends}"
    if ends == ".gltf":
        for name, data in trimesh.exchange.gltf.export_gltf(scene).items():
            path.with_name(name if name != "model.gltf" else path.name).write_bytes(data)
    else:
        scene.export(path)
    list(suggest_files([path]))
    said = read_joints(joints_path(path))
    assert said.metres == 0.001
    want = read(folder / "cabinet_mesh.obj", folder / "scratch")
    found = read(path, folder / "scratch")
    assert found.scale == pytest.approx(want.scale, rel=1e-4)
    for label in ("door", "drawer"):
        part, other = (next(p for p in asset.parts if p.label == label) for asset in (found, want))
        np.testing.assert_allclose(part.box, other.box, atol=1e-4)
        np.testing.assert_allclose(part.joint.axis, other.joint.axis, atol=1e-6)
        assert part.joint.upper == pytest.approx(other.joint.upper, rel=1e-3)
    assert found.surface is not None
    assert want.surface is not None
    np.testing.assert_allclose(found.surface.colors.mean(axis=0), want.surface.colors.mean(axis=0), atol=5)


def test_a_mesh_without_joints_says_how_to_get_some(folder: Path):
    joints_path(folder / "cabinet_mesh.obj").unlink()
    with pytest.raises(SourceError, match=r"`artigen convert cabinet_mesh.obj --suggest-joints` writes one"):
        read(folder / "cabinet_mesh.obj", folder / "scratch")


DOOR = NodeJoint(part="door", nodes=("d",), label="door", type="revolute", upper=1.0)


def test_joints_files_come_back(tmp_path: Path):
    knob = replace(
        DOOR, part="knob", nodes=("k", "l"), label="knob", parent="door", mimic="door", multiplier=2.0
    )
    said = JointsFile(joints=(DOOR, knob), up="z", front="-y", metres=0.001)
    write_joints(tmp_path / "a.joints.json", said)
    assert read_joints(tmp_path / "a.joints.json") == said


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"type": "ball"}, "'type' is 'ball', expected one of fixed, revolute, continuous, prismatic"),
        ({"label": "flap"}, "'label' is 'flap', expected one of base, drawer"),
        ({"lower": 1.0}, r"limits \[1, 1\], expected lower below upper"),
        ({"upper": float("nan")}, "'upper' is nan, expected a finite number"),
        ({"upper": True}, "'upper' is True, expected a finite number"),
        ({"axis": [0, 0, 0]}, "'axis' is .*, expected a direction"),
        ({"axis": [0, 1]}, "'axis' is .*, expected three numbers"),
        ({"nodes": "d"}, "'nodes' is 'd', expected a list of names"),
        ({"parent": "shelf"}, "parent 'shelf' is none of body, door"),
        ({"parent": "door"}, "part 'door' carries itself"),
        ({"part": "body"}, "part 'body' occurs twice"),
        ({"angle": 1}, "key 'angle' is none of part, nodes"),
    ],
)
def test_a_wrong_joints_file_is_refused_in_one_sentence(tmp_path: Path, change: dict, said: str):
    path = tmp_path / "a.joints.json"
    write_joints(path, JointsFile(joints=(DOOR,)))
    value = json.loads(path.read_text())
    value["joints"][0] |= change
    path.write_text(json.dumps(value))
    with pytest.raises(SourceError, match=said) as error:
        read_joints(path)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)


def test_a_node_that_is_not_there_is_named(folder: Path):
    path = joints_path(folder / "cabinet_mesh.obj")
    path.write_text(path.read_text().replace('"door_handle"', '"flap"'))
    with pytest.raises(SourceError, match=r"node 'flap' is not in cabinet_mesh.obj, which has body, door, "):
        read(folder / "cabinet_mesh.obj", folder / "scratch")
