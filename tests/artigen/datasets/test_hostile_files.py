"""Files that nobody means well with are refused in one sentence, before they cost time or memory."""

import zipfile
from pathlib import Path

import pytest

from artigen.datasets import mesh_files, mesh_size
from artigen.datasets.contents import digest_source
from artigen.datasets.joints_file import joints_path
from artigen.datasets.source_object import ReaderConfig
from artigen.datasets.sources import read_source
from artigen.errors import SourceError

BOX = "<visual{}><geometry><box{}</geometry></visual>"
XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'


def row_of_sdf(links: int) -> str:
    shape = BOX.format(" name='v'", "><size>1 1 1</size></box>")
    rows = [f"<link name='l0'>{shape}</link>"]
    for k in range(1, links):
        rows.append(f"<link name='l{k}'><pose relative_to='l{k - 1}'>0 0 1 0 0 0</pose>{shape}</link>")
        rows.append(f"<joint name='j{k}' type='fixed'><parent>l{k - 1}</parent><child>l{k}</child></joint>")
    return f"<sdf version='1.9'><model name='row'>{''.join(rows)}</model></sdf>"


def bodies_of_mjcf(count: int) -> str:
    body = "<body><joint type='hinge' range='0 1'/><geom type='box' size='.1 .1 .1'/></body>"
    return f"<mujoco><worldbody>{count * body}</worldbody></mujoco>"


def bodies_of_usd(count: int) -> str:
    return "#usda 1.0\n" + "".join(f'def Cube "c{k}" {{\n}}\n' for k in range(count))


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("row.sdf", row_of_sdf(5001), "holds 0 moving joints and 5,001 visuals, at most 300 and 5,000"),
        ("row.xml", bodies_of_mjcf(5001), "holds 5,001 bodies and 5,001 geoms, at most 5,000"),
        ("many.xml", "<mujoco>" + 3 * "<replicate count='999'>", "asks for 997,002,999 copies of elements"),
        ("row.usda", bodies_of_usd(5001), "holds 0 joints and 5,001 shapes, at most 5,000"),
        ("empty.usda", "#usda 1.0\n", "holds neither shapes nor joints"),
        ("laugh.urdf", '<!DOCTYPE r [<!ENTITY a "aa">]><robot name="&a;"/>', "which are refused"),
        ("laugh.sdf", '<!DOCTYPE r [<!ENTITY a "aa">]><sdf name="&a;"/>', "which are refused"),
        ("deep.sdf", "<sdf>" + "<model>" * 50_000, "not valid XML"),
        ("deep.xml", bodies_of_mjcf(1).replace("<body>", "<body>" * 4999), "MuJoCo cannot read it|valid XML"),
        (
            "again.xacro",
            XACRO + '<xacro:macro name="a"><xacro:a/></xacro:macro><xacro:a/></robot>',
            "recursion",
        ),
    ],
)
def test_what_is_too_much_is_refused_in_one_sentence(tmp_path: Path, name: str, text: str, said: str):
    pytest.importorskip({"usda": "pxr", "xacro": "xacro"}.get(name.rpartition(".")[2], "numpy"))
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(SourceError, match=said) as error:
        read_source(path, tmp_path / "scratch", ReaderConfig(samples=1000))
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)
    assert {file.name for file in tmp_path.iterdir()} <= {name, "scratch"}


@pytest.mark.parametrize("ends", [".obj", ".dae"])
def test_large_text_meshes_are_counted_and_not_parsed(tmp_path: Path, monkeypatch, ends: str):
    def fail(*args: object) -> None:
        raise AssertionError("parsed")

    monkeypatch.setattr(mesh_size, "MOST_FACES", 1000)
    for name in ("parse_obj", "_load"):
        monkeypatch.setattr(mesh_files, name, fail)
    row = {".obj": "f 1 2 3\n" * 1001, ".dae": '<triangles material="m" count="1001">' + "0 " * 6000}[ends]
    (tmp_path / f"large{ends}").write_text("x\n" + row)
    path = tmp_path / "large.urdf"
    path.write_text(
        "<robot name='r'><link name='a'>"
        + BOX.format("", "/>").replace("<box", f"<mesh filename='large{ends}'")
        + "</link></robot>"
    )
    with pytest.raises(SourceError, match="holds 1,001 triangles, at most 1,000"):
        read_source(path, tmp_path / "scratch")
    monkeypatch.setattr(mesh_size, "MOST_BYTES", 1000)
    with pytest.raises(SourceError, match=r"holds [\d,]+ bytes, at most 1,000"):
        read_source(path, tmp_path / "scratch")


def test_archives_are_neither_unpacked_nor_followed(tmp_path: Path):
    pytest.importorskip("pxr")
    for name, how, inside in (
        ("bomb.usdz", zipfile.ZIP_DEFLATED, "a.usda"),
        ("out.usdz", zipfile.ZIP_STORED, "../a.usda"),
    ):
        with zipfile.ZipFile(tmp_path / name, "w", how) as archive:
            archive.writestr(inside, "#usda 1.0\n" + 10_000_000 * " ")
        with pytest.raises(SourceError, match=r"cannot open it|holds neither"):
            read_source(tmp_path / name, tmp_path / "scratch")
    assert {file.name for file in tmp_path.iterdir()} == {"bomb.usdz", "out.usdz"}


@pytest.mark.parametrize(
    "name", ["/etc/hostname", "../../secret.obj", "file:///etc/hostname", "http://a/b.stl"]
)
def test_no_file_outside_is_read(tmp_path: Path, name: str):
    folder = tmp_path / "a" / "b"
    folder.mkdir(parents=True)
    (tmp_path / "secret.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    texts = {
        "r.urdf": f"<robot name='r'><link name='a'><visual><geometry><mesh filename='{name}'/></geometry>"
        "</visual></link></robot>",
        "r.sdf": "<sdf><model name='m'><link name='a'><visual name='v'><geometry><mesh>"
        f"<uri>{name}</uri></mesh></geometry></visual></link></model></sdf>",
    }
    for file, text in texts.items():
        (folder / file).write_text(text)
        with pytest.raises(SourceError, match="expected a path inside of"):
            read_source(folder / file, tmp_path / "scratch")


@pytest.mark.parametrize("name", ["/dev/zero", "/dev/stdin", "."])
def test_what_is_no_file_is_not_read_to_its_end(tmp_path: Path, name: str):
    path = tmp_path / "r.urdf"
    mesh = f"<geometry><mesh filename='{name}'/></geometry>"
    path.write_text(f"<robot><link name='a'><visual>{mesh}</visual></link></robot>")
    assert digest_source(path) == digest_source(path)


def test_an_obj_names_no_library_outside(tmp_path: Path):
    folder = tmp_path / "a"
    folder.mkdir()
    (tmp_path / "secret.mtl").write_text("newmtl m\nKd 1 0 0\n")
    path = folder / "box.obj"
    path.write_text("mtllib ../secret.mtl\no door\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n")
    joints_path(path).write_text('{"format": "artigen-joints-1", "joints": []}')
    found = read_source(path, tmp_path / "scratch", ReaderConfig(samples=1000))
    assert any("secret.mtl" in note for note in found.asset.notes)
    assert found.asset.surface is not None
    assert (found.asset.surface.colors == found.asset.surface.colors[0, 0]).all()  # grey
