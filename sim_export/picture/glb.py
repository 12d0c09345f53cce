"""Writes a package's textured meshes as one GLB: one node per link in the joint tree, closed, y up."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.transforms import shift
from sim_export.errors import PackageError
from sim_export.files.urdf import link_origins
from sim_export.package import Mesh, SimPackage
from sim_export.picture.raycast import Surface

if TYPE_CHECKING:
    import trimesh

Y_UP = np.array([[0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""Rotation from the object frame (z up, front -x) to glTF's (y up, front +z)."""


def glb_bytes(package: SimPackage) -> bytes:
    """The content of the file; deterministic.

    Node ``link_k`` lies at the origin of joint ``joint_k``: rotating it about the joint's axis opens it.

    Raises:
        PackageError: If a visual is a source mesh, which stays in its own files, or there is no visual.
    """
    import trimesh
    from trimesh.exchange.gltf import export_glb

    scene = trimesh.Scene(base_frame="world")
    scene.graph.update("object", frame_from="world", matrix=Y_UP)
    origins, parents = link_origins(package), {joint.child: joint.parent for joint in package.joints}
    for link in package.links:
        parent = parents.get(link.name)
        start = np.zeros(3) if parent is None else origins[parent]
        scene.graph.update(link.name, frame_from=parent or "object", matrix=shift(origins[link.name] - start))
        for visual in link.visuals:
            if not isinstance(visual.mesh, Mesh):
                raise PackageError(
                    f"package {package.name!r}: visual {visual.name!r} is a kept source file; a GLB holds "
                    "meshes of our own (export with --visual voxels)"
                )
            scene.add_geometry(
                textured_trimesh(visual.mesh.vertices[visual.mesh.faces] - origins[link.name], visual.mesh),
                node_name=visual.name,
                geom_name=visual.name,
                parent_node_name=link.name,
            )
    if not scene.geometry:
        raise PackageError(f"package {package.name!r} has no visual meshes to write as GLB")
    return export_glb(scene)


def write_glb(package: SimPackage, path: Path) -> None:
    """Writes `glb_bytes`; raises as it does."""
    path.write_bytes(glb_bytes(package))


def textured_trimesh(
    corners: Float[np.ndarray, "F 3 3"],
    look: Mesh | Surface,
    normals: Float[np.ndarray, "F 3 3"] | None = None,
) -> "trimesh.Trimesh":
    """Triangles with unshared vertices, in the colour or texture of ``look``."""
    import trimesh
    from PIL import Image
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    said = look.material
    material = PBRMaterial(
        name=said.name or None, metallicFactor=said.metallic, roughnessFactor=said.roughness
    )
    uv = np.zeros((3 * len(corners), 2))
    if look.uv is not None and look.texture is not None:
        material.baseColorTexture = Image.fromarray(look.texture)
        uv = look.uv.reshape(-1, 2)
    color = (1.0, 1.0, 1.0) if look.texture is not None else look.color
    material.baseColorFactor = np.rint(255.0 * np.array([*color, said.opacity])).astype(np.uint8)
    clear = said.opacity < 1.0 or (look.texture is not None and look.texture.shape[2] == 4)
    material.alphaMode = "BLEND" if clear else "OPAQUE"
    return trimesh.Trimesh(
        vertices=corners.reshape(-1, 3),
        faces=np.arange(3 * len(corners)).reshape(-1, 3),
        vertex_normals=None if normals is None else normals.reshape(-1, 3),
        visual=TextureVisuals(uv=uv, material=material),
        process=False,
    )
