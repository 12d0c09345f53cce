"""Files that MuJoCo refuses for what no package needs are read, and each repair is said."""

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh

from artigen.datasets.mjcf import compile_mjcf, list_mjcf_objects
from artigen.datasets.mjcf_scene import list_roots
from artigen.datasets.source_object import ReaderConfig
from artigen.datasets.sources import read_source
from artigen.errors import SourceError

ASSETS = """<asset><texture name="wood" type="2d" builtin="flat" rgb1="1 0 0" width="1" height="1"/>
<material name="oak" texture="wood"/>{assets}<mesh name="cube" file="cube.stl"/></asset>"""
BODY = """<worldbody><body name="case"><geom type="mesh" mesh="cube" material="oak"/>{inside}
<body name="door" pos="-0.6 0 0"><joint name="hinge" range="0 90" axis="0 0 1"/>
<geom type="box" size="0.05 0.5 0.5" {geom}/></body></body></worldbody>"""


def write(folder: Path, *, assets: str = "", inside: str = "", geom: str = "", more: str = "") -> Path:
    trimesh.creation.box((1, 1, 1)).export(folder / "cube.stl")
    path = folder / "chest.xml"
    text = ASSETS.format(assets=assets) + BODY.format(inside=inside, geom=geom)
    path.write_text(f"<mujoco>{text}{more}</mujoco>")
    return path


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ({"inside": '<region name="r" pos="0 0 0"/>'}, r"elements <region> .* left out \(1\)"),
        ({"geom": 'shine="1"'}, r"attributes 'shine' of <geom> .* left out \(1\)"),
        (
            {"assets": '<texture name="wood" type="2d" builtin="flat" rgb1="0 1 0" width="1" height="1"/>'},
            "texture 'wood' is defined 2 times; the first counts",
        ),
        ({"geom": 'material="robot0_steel"'}, "material 'robot0_steel' is missing"),
        ({"more": '<sensor><touch site="gone"/></sensor>'}, r"sections that no package needs .* \(1\)"),
        ({"more": '<contact><pair geom1="a" geom2="b"/></contact>'}, "sections that no package needs"),
    ],
)
def test_what_no_package_needs_does_not_refuse_a_file(tmp_path: Path, fault: dict[str, str], said: str):
    want = read_source(write(tmp_path), tmp_path / "s", ReaderConfig(samples=2000)).asset
    found = read_source(write(tmp_path, **fault), tmp_path / "s", ReaderConfig(samples=2000)).asset
    notes = [note for note in found.notes if note not in want.notes]
    assert len(notes) == 1
    assert re.search(said, notes[0])
    for one, other in zip(found.parts, want.parts, strict=True):
        np.testing.assert_array_equal(one.box, other.box)
        assert one.joint.upper == other.joint.upper
    colors = [asset.surface.colors.mean(axis=0) for asset in (found, want) if asset.surface is not None]
    np.testing.assert_allclose(colors[0], colors[1], atol=1)


@pytest.mark.parametrize(("unit", "end"), [("degree", "90"), ("radian", "1.5707963")])
def test_a_range_counts_also_where_a_joint_is_not_limited_by_it(tmp_path: Path, unit: str, end: str):
    path = write(tmp_path)
    text = path.read_text().replace('range="0 90"', f'range="0 {end}" limited="false"')
    path.write_text(text.replace("<mujoco>", f'<mujoco><compiler angle="{unit}"/>'))
    found = read_source(path, tmp_path / "s", ReaderConfig(samples=2000)).asset
    assert found.parts[1].joint.type == "revolute"
    assert found.parts[1].joint.upper == pytest.approx(np.pi / 2)
    assert any("'hinge'" in note and "ranges without being limited" in note for note in found.notes)


def test_what_a_package_needs_is_not_taken_away(tmp_path: Path):
    path = write(tmp_path, inside='<body name="door"/>')
    with pytest.raises(SourceError, match="repeated name 'door'"):
        compile_mjcf(path)


def test_an_outline_has_the_objects_of_the_file(tmp_path: Path):
    scene = (
        '<body name="b"><joint type="slide" range="0 1"/><geom type="box" mesh="cube"/></body></worldbody>'
    )
    path = write(tmp_path, inside='<site name="s" type="mesh" mesh="cube"/>')
    path.write_text(path.read_text().replace("</worldbody>", scene))
    whole, outline = (compile_mjcf(path, outline=outline)[0] for outline in (False, True))
    assert list_roots(whole) == list_roots(outline) == [1, 3]
    assert outline.nmesh == outline.ntex == 0 < whole.nmesh
    assert list_mjcf_objects(path) == ("case", "b")
