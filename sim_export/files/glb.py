"""GLB of a package's textured meshes: one file for all of them, or one for every link."""

import io
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float, UInt8

from artigen.io import write_whole
from artigen.transforms import shift
from sim_export.errors import PackageError
from sim_export.files.obj import png_bytes
from sim_export.files.urdf import glb_path, image_path, link_origins, normal_path
from sim_export.geometry.normals import corner_normals
from sim_export.geometry.rows import number_rows
from sim_export.package import Link, Mesh, SimPackage

if TYPE_CHECKING:
    import trimesh
    from PIL.Image import Image

Y_UP = np.array([[0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""Rotation from the object frame (z up, front -x) to glTF's (y up, front +z)."""


def glb_bytes(package: SimPackage) -> bytes:
    """The content of one file: a node per link in the joint tree, closed, y up; deterministic.

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
        _add_visuals(scene, package.name, link, origins[link.name])
    if not scene.geometry:
        raise PackageError(f"package {package.name!r} has no visual meshes to write as GLB")
    return export_glb(scene)


def link_glbs(package: SimPackage) -> dict[str, bytes]:
    """One GLB for every link with visuals, in the link's frame (z up), by its path in the package; its images
    are those that the package has for OBJ.

    Raises:
        PackageError: If a visual is a source mesh, which stays in its own files.
    """
    import trimesh
    from trimesh.exchange.gltf import export_glb

    origins, files = link_origins(package), {}
    for link in package.links:
        if link.visuals:
            scene = trimesh.Scene(base_frame="world")
            scene.graph.update(link.name, frame_from="world")
            _add_visuals(scene, package.name, link, origins[link.name], embed=False)
            own = {one.look: one.mesh for one in link.visuals if isinstance(one.mesh, Mesh)}
            refer = partial(_refer_to_images, own)
            files[glb_path(link.name)] = export_glb(scene, tree_postprocessor=refer)
    return files


def _refer_to_images(meshes: Mapping[str, Mesh], tree: dict[str, Any]) -> None:
    """Gives the materials of a GLB, named by their looks, the images beside it."""
    names: list[str] = []
    for material in tree["materials"]:
        look = material["name"]
        mesh, shown = meshes[look], material["pbrMetallicRoughness"]
        for holder, key, image, path in (
            (shown, "baseColorTexture", mesh.texture, image_path(look)),
            (material, "normalTexture", mesh.normal_map, normal_path(look)),
        ):
            if image is not None and mesh.uv is not None:
                holder[key] = {"index": len(names)}
                names.append(Path(path).name)
    if names:
        tree["images"] = [{"uri": name} for name in names]
        tree["textures"] = [{"source": index} for index in range(len(names))]


def _add_visuals(
    scene: "trimesh.Scene", package: str, link: Link, origin: Float[np.ndarray, "3"], *, embed: bool = True
) -> None:
    """Adds the visuals of a link to its node, relative to its origin (m), with their images or with materials
    named by their looks."""
    for visual in link.visuals:
        if not isinstance(visual.mesh, Mesh):
            raise PackageError(
                f"package {package!r}: visual {visual.name!r} is a kept source file; a GLB holds "
                "meshes of our own (export with --visual voxels)"
            )
        corners = visual.mesh.vertices[visual.mesh.faces] - origin
        shown = textured_trimesh(corners, visual.mesh, corner_normals(corners))
        if not embed:
            look: Any = shown.visual
            look.material.name = visual.look
            look.material.baseColorTexture = look.material.normalTexture = None
        scene.add_geometry(
            shown,
            node_name=visual.name,
            geom_name=visual.name,
            parent_node_name=link.name,
        )


def write_glb(package: SimPackage, path: Path) -> None:
    """Writes `glb_bytes`; raises as it does."""
    write_whole(path, glb_bytes(package))


def textured_trimesh(
    corners: Float[np.ndarray, "F 3 3"],
    look: Mesh,
    normals: Float[np.ndarray, "F 3 3"] | None = None,
) -> "trimesh.Trimesh":
    """Triangles in the look of a mesh with as many faces; corners that look alike share a vertex."""
    import trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    said = look.material
    material = PBRMaterial(
        name=said.name or None, metallicFactor=said.metallic, roughnessFactor=said.roughness
    )
    uv = np.zeros((3 * len(corners), 2))
    if look.uv is not None and look.texture is not None:
        material.baseColorTexture = _as_png(look.texture)
        uv = look.uv.reshape(-1, 2)
    if look.uv is not None and look.normal_map is not None:
        material.normalTexture = _as_png(look.normal_map)
        uv = look.uv.reshape(-1, 2)
    color = (1.0, 1.0, 1.0) if look.texture is not None else look.color
    material.baseColorFactor = np.rint(255.0 * np.array([*color, said.opacity])).astype(np.uint8)
    clear = said.opacity < 1.0 or (look.texture is not None and look.texture.shape[2] == 4)
    material.alphaMode = "BLEND" if clear else "OPAQUE"
    flat = np.zeros((len(uv), 0)) if normals is None else normals.reshape(-1, 3)
    rows = np.hstack([corners.reshape(-1, 3), flat, uv]).astype(np.float32)
    first, number = number_rows((rows + np.float32(0.0)).view(np.int32))
    return trimesh.Trimesh(
        vertices=corners.reshape(-1, 3)[first],
        faces=number.reshape(-1, 3),
        vertex_normals=None if normals is None else flat[first],
        visual=TextureVisuals(uv=uv[first], material=material),
        process=False,
    )


def _as_png(texture: UInt8[np.ndarray, "H W C"]) -> "Image":
    """An image that is stored as the files of a package store it, by a palette where it has few colours."""
    from PIL import Image

    return Image.open(io.BytesIO(png_bytes(texture)))
