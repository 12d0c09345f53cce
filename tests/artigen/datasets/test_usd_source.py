"""A stage is read as usd-core places it; objects are told from scenes, and what is not kept is said."""

# usd-core has no type stubs.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

from pathlib import Path

import numpy as np
import pytest

from artigen.datasets.source_object import ReaderConfig
from artigen.datasets.sources import list_objects, read_source
from artigen.datasets.usd import read_usd
from artigen.errors import SourceError
from artigen.shapes.draw import draw_shape
from sim_export.files.write import write_package
from sim_export.reference import build_reference
from sim_export.usd.write import write_usd

pytest.importorskip("pxr")

METRES = 'metersPerUnit = 1\nupAxis = "Z"'
CHEST = """
def Xform "chest" {{
  {frame}
  def Xform "case" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {{
    def Cube "box" {{
    double size = 1
      double3 xformOp:scale = (0.4, 0.4, 0.5)
      uniform token[] xformOpOrder = ["xformOp:scale"]
      color3f[] primvars:displayColor = [(0.5, 0.0, 0.0)]
}}
}}
  def Xform "door" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {{
    double3 xformOp:translate = (-0.21, -0.2, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Cube "panel" {{
    double size = 1
      double3 xformOp:translate = (0, 0.2, 0)
      double3 xformOp:scale = (0.02, 0.4, 0.5)
      uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]
}}
    def Cube "hull" {{
    double size = 9
      uniform token purpose = "guide"
}}
}}
  def PhysicsRevoluteJoint "hinge" {{
    uniform token physics:axis = "Z"
    rel physics:body0 = <{first}>
    rel physics:body1 = <{second}>
    point3f physics:localPos0 = {at0}
    point3f physics:localPos1 = {at1}
    float physics:lowerLimit = {low}
    float physics:upperLimit = {high}
}}
  {more}
}}
"""
ANCHOR = 'def PhysicsFixedJoint "anchor" {\n rel physics:body1 = </chest/case>\n}'
CASE = {"first": "/chest/case", "second": "/chest/door", "at0": "(-0.21, -0.2, 0)", "at1": "(0, 0, 0)"}
DOOR = {"first": "/chest/door", "second": "/chest/case", "at1": "(-0.21, -0.2, 0)", "at0": "(0, 0, 0)"}


def write(folder: Path, head: str = METRES, ends: dict[str, str] | None = None, **said: str) -> Path:
    """A stage with one chest, whose joint leads from ``first`` to ``second``."""
    path = folder / f"stage_{len(list(folder.glob('*.usda')))}.usda"
    values = {"frame": "", "more": "", "low": "0", "high": "90", **(ends or CASE), **said}
    path.write_text(f"#usda 1.0\n({head})\n" + CHEST.format(**values))
    return path


def read(path: Path, body: str | None = None):
    return read_source(path, path.parent / "scratch", ReaderConfig(samples=2000, body=body))


@pytest.mark.slow
@pytest.mark.parametrize("category", ["Microwave", "StorageFurniture", "TrashCan", "Toilet"])
def test_our_stages_are_read_as_our_urdfs(tmp_path, category):
    package = build_reference(draw_shape(category, 3))
    urdf = write_package(package, tmp_path / "package") / "mobility.urdf"
    stage = write_usd(package, tmp_path / "usd")
    one, other = read(urdf), read(stage)
    assert sorted(one.follows) == sorted(other.follows)
    for got, want in zip(other.asset.parts, one.asset.parts, strict=True):
        assert (got.label, got.joint.type, got.parent) == (want.label, want.joint.type, want.parent)
        np.testing.assert_allclose(got.box, want.box, atol=1e-5)
        assert got.joint.upper == pytest.approx(want.joint.upper, rel=1e-4, abs=1e-6)
        if got.joint.type != "fixed":
            np.testing.assert_allclose(got.joint.axis, want.joint.axis, atol=1e-6)
    means = [found.asset.surface.colors.mean(axis=0) for found in (one, other)]
    np.testing.assert_allclose(means[0], means[1], atol=6)


def test_units_axes_and_directions_of_joints_do_not_matter(tmp_path):
    """Centimetres, y up, a frame that scales, and a joint from door to case are the same chest."""
    want = read(write(tmp_path)).asset
    assert want.scale == pytest.approx(0.5)
    assert [part.joint.type for part in want.parts] == ["fixed", "revolute"]
    assert want.parts[1].joint.upper == pytest.approx(np.pi / 2)
    frame = "double3 xformOp:scale = (100, 100, 100)\nuniform token[] xformOpOrder = ["
    turned = "double xformOp:rotateX = -90\n" + frame + '"xformOp:rotateX", "xformOp:scale"]'
    for head, ends, said in (
        (METRES.replace("1", "0.01"), CASE, {"frame": frame + '"xformOp:scale"]'}),
        ('metersPerUnit = 0.01\nupAxis = "Y"', CASE, {"frame": turned}),
        (METRES, DOOR, {"low": "-90", "high": "0", "more": ANCHOR}),
    ):
        got = read(write(tmp_path, head, ends, **said)).asset
        assert got.scale == pytest.approx(want.scale, rel=1e-5)
        np.testing.assert_allclose(got.parts[1].box, want.parts[1].box, atol=1e-5)
        np.testing.assert_allclose(got.parts[1].joint.axis, want.parts[1].joint.axis, atol=1e-5)
        np.testing.assert_allclose(got.parts[1].joint.origin[:2], want.parts[1].joint.origin[:2], atol=1e-5)


def test_colours_of_a_stage_are_linear_and_hulls_are_not_drawn(tmp_path):
    found = read(write(tmp_path))
    surface = found.asset.surface
    case = surface.colors[surface.part_ids == 0]
    np.testing.assert_allclose(case.mean(axis=0), (188, 0, 0), atol=1)  # 0.5 in sRGB
    assert any("collision shapes (1)" in note for note in found.asset.notes)


def test_objects_of_a_scene_are_told_and_chosen(tmp_path):
    path = write(tmp_path)
    text = path.read_text()
    chest = text.partition("\n)\n")[2] or text.partition(")\n")[2]
    scene = tmp_path / "scene.usda"
    other = chest.replace('"chest"', '"second"').replace("/chest/", "/second/")
    floor = 'def Cube "floor" {\n double size = 9\n}\ndef SphereLight "lamp" {}\n'
    scene.write_text(f"#usda 1.0\n({METRES})\n" + chest + other + floor)
    assert list_objects(path) == ()
    assert list_objects(scene) == ("chest", "second")
    found = read(scene, "second")
    assert found.asset.scale == pytest.approx(0.5)
    assert any(
        "left out: door, case, floor" in n or "left out: case, door, floor" in n for n in found.asset.notes
    )
    assert any("SphereLight prims (1)" in note for note in found.asset.notes)
    for body, said in ((None, r"holds 2 objects \(chest, second\)"), ("third", "no object 'third'")):
        with pytest.raises(SourceError, match=said):
            read_usd(scene, body)


@pytest.mark.parametrize(
    ("found", "said"),
    [
        ("#usda 1.0\ndef Xform {", "OpenUSD cannot open it"),
        (
            CHEST.replace("PhysicsRevoluteJoint", "PhysicsSphericalJoint"),
            "is a PhysicsSphericalJoint, expected one of",
        ),
        (CHEST.replace("PhysicsRevoluteJoint", "PhysicsPrismaticJoint"), "slides without limits"),
    ],
)
def test_what_no_package_can_hold_is_refused_in_one_sentence(tmp_path, found, said):
    path = tmp_path / "bad.usda"
    values = {"frame": "", "more": "", "low": "-inf", "high": "inf", **CASE}
    path.write_text(found if "{frame}" not in found else "#usda 1.0\n" + found.format(**values))
    with pytest.raises(SourceError, match=said) as error:
        read(path)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)
