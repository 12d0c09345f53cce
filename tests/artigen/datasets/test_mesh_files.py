"""Meshes written anew as OBJ keep what their materials say of colour and transparency."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from trimesh import Scene, Trimesh, creation
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from artigen.datasets.mesh_files import load_shape
from artigen.datasets.sources import read_source
from artigen.errors import SourceError
from artigen.files.mtl import MtlMaterial, parse_mtl
from artigen.files.urdf import UrdfShape


def paint(alpha: float, mode: str | None, image: Image.Image | None = None) -> Trimesh:
    box = creation.box((1.0, 2.0, 3.0))
    material = PBRMaterial(baseColorFactor=[0.2, 0.4, 0.6, alpha], baseColorTexture=image, alphaMode=mode)
    box.visual = TextureVisuals(uv=np.zeros((len(box.vertices), 2)), material=material)
    return box


def load_material(folder: Path, mesh: Trimesh) -> MtlMaterial:
    """The only material of the OBJ that a GLB is turned into."""
    source, scratch = folder / "box.glb", folder / "scratch"
    Scene([mesh]).export(source)
    scratch.mkdir()
    shape = UrdfShape(link="box", name="box", kind="mesh", T_link_shape=np.eye(4), file="box.glb")
    placed = load_shape(shape, source, folder, scratch)
    assert placed is not None
    (material,) = parse_mtl(placed.path.with_suffix(".mtl")).values()
    return material


@pytest.mark.parametrize(
    ("alpha", "mode", "opacity"),
    [(0.4, "BLEND", 0.4), (1.0, "BLEND", 1.0), (0.4, "OPAQUE", 1.0), (0.4, None, 1.0)],
)
@pytest.mark.parametrize("pictured", [False, True])
def test_a_material_is_transparent_if_it_blends(tmp_path: Path, alpha, mode, opacity, *, pictured: bool):
    image = Image.new("RGB", (2, 2), (200, 100, 50)) if pictured else None
    material = load_material(tmp_path, paint(alpha, mode, image))
    assert material.opacity == pytest.approx(opacity, abs=1 / 255)
    assert bool(material.image) == pictured
    assert material.color == pytest.approx((1.0, 1.0, 1.0) if pictured else (0.2, 0.4, 0.6), abs=1 / 255)


def test_glass_of_an_mjcf_stays_glass(tmp_path: Path):
    path = tmp_path / "lamp.xml"
    path.write_text(
        """<mujoco><worldbody><body name="lamp">
        <geom name="foot" type="box" size="0.1 0.1 0.02" rgba="0.5 0.5 0.5 1"/>
        <body name="shade" pos="0 0 0.2">
        <joint name="turn" type="hinge" axis="0 0 1" range="0 1" limited="true"/>
        <geom name="pane" type="box" size="0.1 0.1 0.05" rgba="0.2 0.4 0.6 0.3"/>
        </body></body></worldbody></mujoco>"""
    )
    source = read_source(path, tmp_path / "scratch")
    found = {
        visual.name: material.opacity
        for visual in source.visuals
        for material in parse_mtl(visual.path.with_suffix(".mtl")).values()
    }
    assert sorted(found.values()) == pytest.approx([0.3, 1.0], abs=1 / 255)


@pytest.mark.parametrize("library", ["", "mtllib lost.mtl\n"])
@pytest.mark.parametrize("coords", [False, True])
@pytest.mark.parametrize("opacity", [0.3, 1.0])
def test_a_mesh_without_materials_takes_colour_and_opacity_of_its_link(
    tmp_path: Path, library: str, opacity: float, *, coords: bool
):
    source, scratch = tmp_path / "leaf.obj", tmp_path / "scratch"
    corner = "{0}/{0}" if coords else "{0}"
    face = " ".join(corner.format(number) for number in (1, 2, 3))
    rows = "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + ("vt 0 0\nvt 1 0\nvt 0 1\n" if coords else "")
    source.write_text(f"{library}{rows}f {face}\n")
    scratch.mkdir()
    shape = UrdfShape(
        link="leaf", name="", kind="mesh", T_link_shape=np.eye(4), color=(0.8, 0.1, 0.1), opacity=opacity
    )
    placed = load_shape(shape, source, tmp_path, scratch)
    assert placed is not None
    (material,) = parse_mtl(placed.path.with_suffix(".mtl")).values()
    assert material == MtlMaterial(color=(0.8, 0.1, 0.1), image="", opacity=opacity)


@pytest.mark.parametrize("name", ["tex/wood.png", "tex\\wood.png", "-clamp on tex\\wood.png"])
def test_an_image_is_found_however_its_path_is_written(tmp_path: Path, name: str):
    folder = tmp_path / "object"
    (folder / "tex").mkdir(parents=True)
    Image.new("RGB", (2, 2)).save(folder / "tex" / "wood.png")
    (folder / "leaf.mtl").write_text(f"newmtl wood\nmap_Kd {name}\n")
    (folder / "leaf.obj").write_text("mtllib leaf.mtl\nusemtl wood\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    shape = UrdfShape(link="leaf", name="", kind="mesh", T_link_shape=np.eye(4))
    placed = load_shape(shape, folder / "leaf.obj", folder, tmp_path)
    assert placed is not None
    assert placed.path == folder / "leaf.obj"  # kept as it is
    assert placed.mesh.materials[0].image == folder / "tex" / "wood.png"


ROOF = """v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 1 1 0 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n"""
HALVES = np.array([[[200, 0, 0], [0, 0, 100]]] * 2, dtype=np.uint8)


def load(folder: Path, text: str, texture: Path | None = None, **look):
    """The materials of an OBJ as it is loaded, and what it lacks."""
    path = folder / "object" / "roof.obj"
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    shape = UrdfShape(link="roof", name="", kind="mesh", T_link_shape=np.eye(4), **look)
    placed = load_shape(shape, path, path.parent, folder / "scratch", texture)
    assert placed is not None
    return list(parse_mtl(placed.path.with_suffix(".mtl")).values()), placed


@pytest.mark.parametrize(
    "corners",
    [("1/1 2/2 3/3", "2/2 4/4 3/3"), ("-4/-4 -3/-3 -2/-2", "-3/-3 -1/-1 -2/-2"), ("1 2 3", "2 4 3")],
)
def test_vertex_colours_are_kept_whatever_else_a_file_has(tmp_path: Path, corners: tuple[str, str]):
    """They count more than the colour of the link; each face has the mean of its corners."""
    faces = "".join(f"f {row}\n" for row in corners)
    materials, placed = load(tmp_path, ROOF + faces, color=(0.0, 1.0, 0.0))
    found = sorted(material.color for material in materials)
    np.testing.assert_allclose(found, [(2 / 3, 0, 1 / 3), (1, 0, 0)], atol=1 / 255)
    assert len(placed.mesh.faces) == 2


@pytest.mark.parametrize("coords", [True, False])
def test_the_image_of_a_link_colours_meshes_without_materials(tmp_path: Path, *, coords: bool):
    """By texture coordinates if there are any, else by its mean; times the link's colour."""
    Image.fromarray(HALVES).save(tmp_path / "two.png")
    plain = "\n".join(row[:7] if row[:2] == "v " else row for row in ROOF.splitlines())
    faces = "\nf 1/1 2/2 3/3\n" if coords else "\nf 1 2 3\n"
    (material,), placed = load(tmp_path, plain + faces, tmp_path / "two.png", color=(1.0, 1.0, 0.5))
    if coords:
        pixels = np.asarray(Image.open(placed.path.parent / material.image))
        np.testing.assert_array_equal(pixels, np.round(HALVES * [1.0, 1.0, 0.5]))
    else:
        assert material.color == pytest.approx((100 / 255, 0, 25 / 255), abs=1e-4)


def test_missing_images_and_libraries_are_said_and_several_libraries_read(tmp_path: Path):
    folder = tmp_path / "object"
    folder.mkdir()
    (folder / "one.mtl").write_text("newmtl one\nKd 1 0 0\nmap_Kd lost.png\n")
    (folder / "two.mtl").write_text("newmtl two\nKd 0 0 1\nd 0.5\n")
    faces = "usemtl one\nf 1 2 3\nusemtl two\nf 2 4 3\n"
    materials, placed = load(tmp_path, "mtllib one.mtl two.mtl\nmtllib gone.mtl\n" + ROOF + faces)
    found = [(*m.color, m.opacity) for m in materials]
    np.testing.assert_allclose(found, [(1, 0, 0, 1), (0, 0, 1, 0.5)], atol=1 / 255)
    assert set(placed.missing) == {"lost.png", "gone.mtl"}


def test_a_mesh_in_another_unit_has_its_size(tmp_path: Path):
    """DAE states a unit; in metres and in inches, the same box is the same."""
    sizes = []
    for unit in (1.0, 0.0254):
        path = tmp_path / f"box_{unit}.dae"
        creation.box(np.array([1.0, 2.0, 3.0]) / unit).export(path)
        path.write_text(
            re.sub(r"<unit[^>]*/>", "", path.read_text()).replace(
                "<asset>", f'<asset><unit name="u" meter="{unit}"/>'
            )
        )
        shape = UrdfShape(link="box", name="", kind="mesh", T_link_shape=np.eye(4))
        placed = load_shape(shape, path, tmp_path, tmp_path / "scratch")
        assert placed is not None
        sizes.append(np.ptp(placed.mesh.vertices, axis=0))
    np.testing.assert_allclose(sizes, [[1.0, 2.0, 3.0]] * 2, rtol=1e-6)


def test_an_image_without_end_is_refused(tmp_path: Path):
    """A bomb of compressed pixels names its file, and nothing is written."""
    Image.new("1", (40_000, 10_000)).save(tmp_path / "bomb.png")
    with pytest.raises(SourceError, match=r"bomb\.png: image cannot be decoded"):
        load(tmp_path, ROOF + "f 1/1 2/2 3/3\n", tmp_path / "bomb.png")
    assert not (tmp_path / "scratch").exists()
