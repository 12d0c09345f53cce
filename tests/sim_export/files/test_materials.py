"""One material, the same in every format: read back by trimesh, MuJoCo and OpenUSD."""

import json
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh
from yourdfpy import URDF

from artigen.shapes.draw import draw_shape
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import make_lacquer, make_metal, make_polished, make_wood
from artigen.shapes.surfaces.physical import describe_finish
from artigen.splats.colors import linear_from_srgb
from sim_export.appearance.prints import FINISHES
from sim_export.checks.config import CheckConfig
from sim_export.checks.files import check_paths, check_tree
from sim_export.checks.subject import Subject
from sim_export.files.glb import glb_bytes
from sim_export.files.obj import read_image
from sim_export.files.read import read_package
from sim_export.files.urdf import GLB_URDF, glb_path, link_origins
from sim_export.files.write import write_package
from sim_export.package import Mesh
from sim_export.reference import build_reference


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    package = build_reference(draw_shape("Oven", 2))
    return package, write_package(package, tmp_path_factory.mktemp("looks") / package.name)


def meshes(package) -> dict[str, Mesh]:
    return {visual.name: visual.mesh for link in package.links for visual in link.visuals}


def rgb(image) -> np.ndarray:
    return np.asarray(image.convert("RGB"))


def test_a_package_that_is_read_has_the_materials_and_finishes_that_were_written(made):
    package, folder = made
    again = read_package(folder)
    for name, mesh in meshes(package).items():
        read = meshes(again)[name]
        assert read.material == mesh.material
        if mesh.texture is None:
            np.testing.assert_allclose(read.color, mesh.color, atol=1e-6)
        else:
            np.testing.assert_array_equal(read.texture, mesh.texture)
        assert np.array_equal(read.normal_map, mesh.normal_map)
    assert any(mesh.normal_map is not None for mesh in meshes(package).values())
    assert [v.finish for link in again.links for v in link.visuals] == [
        v.finish for link in package.links for v in link.visuals
    ]


def test_trimesh_reads_the_colours_of_obj_and_all_of_glb(made):
    package, folder = made
    scene = trimesh.load_scene(trimesh.util.wrap_as_stream(glb_bytes(package)), file_type="glb")
    for name, mesh in meshes(package).items():
        material = scene.geometry[name].visual.material
        assert material.name == mesh.material.name
        assert material.metallicFactor == mesh.material.metallic
        assert material.roughnessFactor == pytest.approx(mesh.material.roughness)
        plain = trimesh.load_mesh(folder / "visual" / f"{name}.obj").visual.material
        assert float(plain.kwargs["pr"][0]) == pytest.approx(mesh.material.roughness)
        assert float(plain.kwargs["pm"][0]) == mesh.material.metallic
        assert ("norm" in plain.kwargs) == (mesh.normal_map is not None)
        if mesh.texture is None:
            levels = np.rint(255 * np.array(mesh.color))
            np.testing.assert_allclose(plain.diffuse[:3], levels, atol=1.0)
            np.testing.assert_allclose(material.baseColorFactor[:3], levels, atol=1.0)


def test_a_package_with_one_glb_per_link_shows_the_same_surfaces_and_materials_at_the_same_place(
    made, tmp_path
):
    package = replace(made[0], visual_format="glb")
    folder = write_package(package, tmp_path / "glb")
    assert read_package(folder).visual_format == "glb"
    for check in (check_paths, check_tree):
        assert check(Subject(folder), CheckConfig()).passed, "every file is named by another one"
    robot = URDF.load(str(folder / GLB_URDF))
    corners = np.concatenate([mesh.vertices for mesh in meshes(package).values()])
    np.testing.assert_allclose(robot.scene.bounds, [corners.min(axis=0), corners.max(axis=0)], atol=1e-5)
    for link in package.links:
        assert b"\x89PNG" not in (folder / glb_path(link.name)).read_bytes(), "images are those of the OBJ"
        scene = trimesh.load_scene(folder / glb_path(link.name))
        assert len(scene.geometry) == len(link.visuals)
        for visual in link.visuals:
            shown, mesh = scene.geometry[visual.name], visual.mesh
            placed = mesh.vertices[mesh.faces] - link_origins(package)[link.name]
            np.testing.assert_allclose(shown.triangles, placed, atol=1e-6)
            material = shown.visual.material
            assert (material.name, material.metallicFactor) == (mesh.material.name, mesh.material.metallic)
            assert material.roughnessFactor == pytest.approx(mesh.material.roughness)
            if mesh.texture is not None:
                np.testing.assert_array_equal(rgb(material.baseColorTexture), mesh.texture)
            assert (material.normalTexture is None) == (mesh.normal_map is None)
            if mesh.normal_map is not None:
                np.testing.assert_array_equal(rgb(material.normalTexture), mesh.normal_map)


def test_mujoco_reads_colour_roughness_and_metallic(made):
    package, folder = made
    model = mujoco.MjModel.from_xml_path(str(folder / "mobility.mjcf.xml"))
    for name, mesh in meshes(package).items():
        index = int(model.geom(name).matid[0])
        assert model.material(index).name == mesh.material.name
        assert model.mat_metallic[index] == pytest.approx(mesh.material.metallic)
        assert model.mat_roughness[index] == pytest.approx(mesh.material.roughness, abs=1e-6)
        color = np.ones(3) if mesh.texture is not None else mesh.color
        np.testing.assert_allclose(model.mat_rgba[index], [*color, mesh.material.opacity], atol=1e-6)
    assert model.nmat == len({mesh.material.name for mesh in meshes(package).values()})


def test_usd_says_the_same_as_a_preview_surface_and_as_open_pbr(made, tmp_path):
    pxr = pytest.importorskip("pxr")
    from pxr import Usd, UsdShade

    from sim_export.usd.write import write_usd

    assert pxr
    package, _ = made
    stage = Usd.Stage.Open(str(write_usd(package, tmp_path / "usd")))
    seen = set()
    for prim in stage.Traverse():
        if not prim.IsA(UsdShade.Material):
            continue
        if not prim.GetChild("surface"):
            continue
        alike = [m for m in meshes(package).values() if prim.GetName().startswith(m.material.name)]
        mesh = max(alike, key=lambda one: len(one.material.name))  # what it is made of may follow its name
        seen.add(prim.GetName())
        inputs = {
            shader: {i.GetBaseName(): i.Get() for i in UsdShade.Shader(prim.GetChild(shader)).GetInputs()}
            for shader in ("surface", "open_pbr")
        }
        preview, open_pbr = inputs["surface"], inputs["open_pbr"]
        for one, other, value in (
            ("roughness", "specular_roughness", mesh.material.roughness),
            ("metallic", "base_metalness", mesh.material.metallic),
            ("ior", "specular_ior", mesh.material.ior),
            ("clearcoat", "coat_weight", mesh.material.coat),
        ):
            assert preview[one] == pytest.approx(value)
            assert open_pbr[other] == pytest.approx(value)
        if mesh.texture is None:
            np.testing.assert_allclose(
                preview["diffuseColor"], linear_from_srgb(np.array(mesh.color)), atol=1e-6
            )
            np.testing.assert_allclose(open_pbr["base_color"], preview["diffuseColor"])
        assert "normal" in preview if mesh.normal_map is not None else "normal" not in preview
        for sampler in ("normals", "mtlx_normals") if mesh.normal_map is not None else ():
            file = UsdShade.Shader(prim.GetChild(sampler)).GetInput("file").Get().resolvedPath
            np.testing.assert_array_equal(read_image(Path(file)), mesh.normal_map)
    assert len(seen) >= len({mesh.material.name for mesh in meshes(package).values()})


def test_materials_json_lists_every_visual_and_its_finish(made):
    package, folder = made
    said = json.loads((folder / "materials.json").read_text())
    shown = {entry["visual"]: entry for entry in said["visuals"]}
    assert shown.keys() == meshes(package).keys()
    for name, mesh in meshes(package).items():
        material = said["materials"][shown[name]["material"]]
        assert shown[name]["finish"] in dict(draw_shape("Oven", 2).finishes) | dict(FINISHES)
        assert material["roughness"] == mesh.material.roughness
        assert (material["image"] is None) == (mesh.texture is None)
        assert material["image"] is None or (folder / material["image"]).is_file()
        assert (material["normal_map"] is None) == (mesh.normal_map is None)


def test_finishes_reflect_as_what_they_are():
    oak, steel = describe_finish(make_wood("oak", 0)), describe_finish(make_metal("steel", 0))
    chrome, brass = describe_finish(make_metal("chrome", 0)), describe_finish(make_polished("brass", 0))
    names = [look.name for look in (oak, steel, chrome, brass)]
    assert names == ["oak_oiled", "steel_brushed", "chrome_mirror", "brass_polished"]
    assert (oak.metallic, steel.metallic) == (0.0, 1.0)
    assert oak.roughness > steel.roughness > brass.roughness > chrome.roughness
    assert describe_finish(make_lacquer((0.93, 0.925, 0.91), gloss=0.5)).coat == 1.0


@pytest.mark.parametrize("kind", ["wood", "lacquer", "steel", "plastic", "glass", "rubber", "stone"])
def test_more_gloss_is_never_rougher(kind):
    colors = {"color": (0.4, 0.4, 0.4), "accent": (0.3, 0.3, 0.3)}
    looks = [describe_finish(Finish(kind=kind, gloss=gloss, **colors)) for gloss in np.linspace(0, 1, 41)]
    rough = [look.roughness for look in looks]
    assert rough == sorted(rough, reverse=True)
    assert 0.0 < rough[-1] < rough[0] <= 1.0
