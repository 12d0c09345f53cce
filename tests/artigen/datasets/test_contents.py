"""A source is told by its content: any change of a file that it reads counts, its place does not."""

import shutil
from pathlib import Path

import pytest

from artigen.datasets.contents import digest_source

ROBOT = '<robot><link name="a"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'
WORLD = (
    '<mujoco><compiler meshdir="parts"/><asset><mesh file="a.obj"/></asset>'
    '<include file="more.xml"/></mujoco>'
)


def write(folder: Path, **files: str) -> None:
    for name, text in files.items():
        path = folder / name.replace("__", "/").replace("_dot_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def meshes(folder: str) -> dict[str, str]:
    return {
        f"{folder}a_dot_obj": "mtllib a.mtl\nv 0 0 0\n",
        f"{folder}a_dot_mtl": "newmtl m\nmap_Kd tex\\wood.png\n",
        f"{folder}tex__wood_dot_png": "wood",
    }


CASES: dict[str, tuple[str, dict[str, str]]] = {
    "beside": ("kit/r.urdf", {"kit__r_dot_urdf": ROBOT.format("a.obj"), **meshes("kit__")}),
    "above": ("kit/urdf/r.urdf", {"kit__urdf__r_dot_urdf": ROBOT.format("../a.obj"), **meshes("kit__")}),
    "package": (
        "kit/urdf/r.urdf",
        {"kit__urdf__r_dot_urdf": ROBOT.format("package://kit/m/a.obj"), **meshes("kit__m__")},
    ),
    "mjcf": (
        "kit/r.xml",
        {"kit__r_dot_xml": WORLD, "kit__more_dot_xml": "<mujoco/>", **meshes("kit__parts__")},
    ),
    "folder": ("kit", {"kit__object_dot_json": "{}", **meshes("kit__objs__")}),
}


@pytest.mark.parametrize("case", CASES)
def test_every_file_that_is_read_counts_and_the_place_does_not(tmp_path: Path, case: str):
    name, files = CASES[case]
    write(tmp_path / "one", **files, other__r_dot_urdf="another robot")
    source = tmp_path / "one" / name
    before = digest_source(source)
    moved = Path(shutil.copytree(tmp_path / "one", tmp_path / "two" / "deep"))
    assert digest_source(moved / name) == before
    (tmp_path / "one" / "other" / "r.urdf").write_text("edited")
    assert digest_source(source) == before
    for path in sorted((tmp_path / "one" / "kit").rglob("*.*")):
        text = path.read_text()
        path.write_text(f"{text} ")
        assert digest_source(source) != before, path
        if path != source:
            path.unlink()
            assert digest_source(source) != before, path
        path.write_text(text)
        assert digest_source(source) == before
