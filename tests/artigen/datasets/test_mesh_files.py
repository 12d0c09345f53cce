"""Meshes written anew as OBJ keep what their materials say of colour and transparency."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from trimesh import Scene, Trimesh, creation
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from artigen.datasets.mesh_files import load_shape
from artigen.datasets.sources import read_source
from artigen.files.urdf import UrdfShape
from artigen.files.wavefront import MtlMaterial, parse_mtl


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
