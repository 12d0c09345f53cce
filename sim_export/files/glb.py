"""Writes a package's textured meshes as one GLB: one node per link in the joint tree, closed, y up."""

from pathlib import Path

import numpy as np

from artigen.transforms import shift
from sim_export.errors import PackageError
from sim_export.files.urdf import link_origins
from sim_export.package import Mesh, SimPackage

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
                _as_trimesh(visual.mesh, origins[link.name]),
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


def _as_trimesh(mesh: Mesh, origin: np.ndarray):
    """The mesh in its link's frame, with unshared vertices if it has texture coordinates."""
    import trimesh
    from PIL import Image
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    material = PBRMaterial(metallicFactor=0.0, roughnessFactor=0.8)
    corners = mesh.vertices[mesh.faces].reshape(-1, 3) - origin
    uv = np.zeros((len(corners), 2))
    if mesh.uv is not None and mesh.texture is not None:
        material.baseColorTexture = Image.fromarray(mesh.texture)
        material.alphaMode = "OPAQUE" if mesh.texture.shape[2] == 3 else "BLEND"
        uv = mesh.uv.reshape(-1, 2)
    else:
        material.baseColorFactor = np.array([*np.rint(255.0 * np.array(mesh.color)), 255], dtype=np.uint8)
    return trimesh.Trimesh(
        vertices=corners,
        faces=np.arange(len(corners)).reshape(-1, 3),
        visual=TextureVisuals(uv=uv, material=material),
        process=False,
    )
