"""SAPIEN sees the materials of a package, of OBJ and of GLB files alike."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.shapes.draw import draw_shape
from envs.sim.scene import has_render_device
from sim_export.files.urdf import GLB_URDF
from sim_export.files.write import write_package
from sim_export.reference import build_reference

sapien = pytest.importorskip("sapien")
pytestmark = [
    pytest.mark.sim,
    pytest.mark.skipif(not has_render_device(), reason="SAPIEN's renderer needs Vulkan"),
]


def describe(color, material, image, normals) -> tuple:
    shown = (1.0, 1.0, 1.0) if image is not None else color
    return (*shown, material.roughness, material.metallic, image is not None, normals is not None)


@pytest.mark.parametrize("urdf", ["mobility.urdf", GLB_URDF])
def test_sapien_reads_colours_roughness_metallic_and_images(urdf, tmp_path):
    package = replace(build_reference(draw_shape("Oven", 2)), visual_format="glb")
    scene = sapien.Scene()
    robot = scene.create_urdf_loader().load(str(write_package(package, tmp_path / "oven") / urdf))
    meshes = [visual.mesh for link in package.links for visual in link.visuals]
    made = np.array([describe(one.color, one.material, one.texture, one.normal_map) for one in meshes])
    bodies = [
        body
        for link in robot.links
        for body in link.entity.components
        if isinstance(body, sapien.render.RenderBodyComponent)
    ]
    materials = [part.material for body in bodies for shape in body.render_shapes for part in shape.parts]
    seen = np.array(
        [describe(one.base_color[:3], one, one.base_color_texture, one.normal_texture) for one in materials]
    )
    apart = np.abs(seen[:, None] - made[None]).max(axis=2)
    assert (apart.min(axis=0) < 0.01).all(), "every material is there; parts of one may be merged"
    assert (apart.min(axis=1) < 0.01).all(), "and no other one is"
