"""Renders shapes by analytic ray casting, batched in torch: colour, mask, depth, normals, part ids.

    scene = build_scene([shape], device="cpu")
    images = render(scene, batch_cameras([camera]), [qpos])

Every surface is the exact one of its primitive: no meshes, no textures, the same code on every device.
"""

from artigen.shapes.render.cameras import Cameras, batch_cameras
from artigen.shapes.render.images import Images, render
from artigen.shapes.render.scene import Scene, build_scene
from artigen.shapes.render.shading import RenderConfig

__all__ = ["Cameras", "Images", "RenderConfig", "Scene", "batch_cameras", "build_scene", "render"]
