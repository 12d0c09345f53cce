"""Geoms of a compiled MJCF: which are drawn, and their triangles with colour and image."""

# mujoco is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.transforms import transform_points

if TYPE_CHECKING:
    import mujoco
    from PIL.Image import Image
    from trimesh import Trimesh

VISIBLE_GROUPS = 3
"""Groups that MuJoCo's viewer shows, from 0."""
PLAIN = (0.5, 0.5, 0.5, 1.0)
"""Colour of a geom that states none; its material's counts then."""
SECTIONS = 48
COVERED = 0.5
"""Least extents of drawn geoms, as a share of those of the collision shapes that stand in for them."""


def find_drawn(
    model: "mujoco.MjModel", data: "mujoco.MjData", geoms: Sequence[int]
) -> tuple[list[int], Counter[str]]:
    """The geoms that show an object, and the numbers of all others by kind.

    Seen are groups 0 to 2, without what is transparent throughout. A group of which all geoms on a moving
    link collide is not drawn if geoms of the link in other groups do not collide and are about as large or
    larger: it stands in for them. A link of which nothing is seen shows all of its geoms but planes.
    """
    solid = [geom for geom in geoms if not _is_plane(model, geom)]
    spare = Counter({"planes": len(geoms) - len(solid)})
    links: dict[int, list[int]] = {}
    for geom in solid:
        links.setdefault(int(model.body_weldid[model.geom_bodyid[geom]]), []).append(geom)
    drawn: list[int] = []
    for own in links.values():
        seen = [geom for geom in own if is_seen(model, geom)]
        if not seen:
            drawn += [geom for geom in own if _collides(model, geom)]
            spare["geoms that are not seen"] += sum(not _collides(model, geom) for geom in own)
            continue
        spare["geoms that are not seen"] += len(own) - len(seen)
        shown = [geom for geom in seen if geom not in _find_proxies(model, data, seen)]
        spare["collision shapes"] += len(seen) - len(shown)
        drawn += shown
    return sorted(drawn), spare


def is_seen(model: "mujoco.MjModel", geom: int) -> bool:
    """Whether MuJoCo's viewer shows a geom, planes excepted."""
    shown = int(model.geom_group[geom]) < VISIBLE_GROUPS and _read_color(model, geom)[3] > 0.0
    return bool(shown and not _is_plane(model, geom))


def _is_plane(model: "mujoco.MjModel", geom: int) -> bool:
    import mujoco

    return int(model.geom_type[geom]) == int(mujoco.mjtGeom.mjGEOM_PLANE)


def geom_pose(data: "mujoco.MjData", geom: int) -> Float[np.ndarray, "4 4"]:
    """Pose of a geom in the world."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = np.asarray(data.geom_xmat[geom]).reshape(3, 3), data.geom_xpos[geom]
    return T


def _collides(model: "mujoco.MjModel", geom: int) -> bool:
    return bool(model.geom_contype[geom] or model.geom_conaffinity[geom])


def _find_proxies(model: "mujoco.MjModel", data: "mujoco.MjData", geoms: Sequence[int]) -> set[int]:
    """Of the geoms of one link, those in groups that stand in for geoms of other groups."""
    groups: dict[int, list[int]] = {}
    for geom in geoms:
        groups.setdefault(int(model.geom_group[geom]), []).append(geom)
    solid = {group for group, own in groups.items() if all(_collides(model, geom) for geom in own)}
    silent = [geom for geom in geoms if int(model.geom_group[geom]) not in solid]
    if not solid or not silent:
        return set()
    low, high = _find_box(model, data, silent)
    found: set[int] = set()
    for group in solid:
        start, end = _find_box(model, data, groups[group])
        if (high - low >= COVERED * (end - start)).all():
            found.update(groups[group])
    return found


def _find_box(
    model: "mujoco.MjModel", data: "mujoco.MjData", geoms: Sequence[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner in the world of the boxes of some geoms."""
    corners = []
    signs = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3), axis=-1).reshape(-1, 3)
    for geom in geoms:
        middle, half = np.split(np.asarray(model.geom_aabb[geom]), 2)
        corners.append(transform_points(geom_pose(data, geom), middle + signs * half))
    points = np.concatenate(corners)
    return points.min(axis=0), points.max(axis=0)


def read_geom(model: "mujoco.MjModel", geom: int) -> "Trimesh | None":
    """Triangles of a geom in its own frame with colour and image; None for planes, height fields and SDFs."""
    import mujoco
    from trimesh import Trimesh, creation
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    size, kinds = model.geom_size[geom], mujoco.mjtGeom
    uv, kind = None, kinds(int(model.geom_type[geom]))
    match kind:
        case kinds.mjGEOM_MESH:
            mesh, uv = _read_mesh(model, int(model.geom_dataid[geom]))
        case kinds.mjGEOM_BOX:
            mesh = creation.box(2.0 * size)
        case kinds.mjGEOM_CYLINDER:
            mesh = creation.cylinder(radius=size[0], height=2.0 * size[1], sections=SECTIONS)
        case kinds.mjGEOM_CAPSULE:
            mesh = creation.capsule(radius=size[0], height=2.0 * size[1], count=(24, SECTIONS))
            mesh.apply_translation(-mesh.bounds.mean(axis=0))
        case kinds.mjGEOM_SPHERE | kinds.mjGEOM_ELLIPSOID:
            radii = size if kind == kinds.mjGEOM_ELLIPSOID else np.full(3, size[0])
            mesh = creation.icosphere(subdivisions=3)
            mesh.apply_scale(radii)
        case _:
            return None
    color, image = _read_color(model, geom), _read_image(model, geom)
    if image is not None and uv is None:  # without texture coordinates, the image's mean colour
        color[:3] *= np.asarray(image).reshape(-1, 3).mean(axis=0) / 255.0
    material = PBRMaterial(
        baseColorFactor=color,
        baseColorTexture=image if uv is not None else None,
        alphaMode="OPAQUE" if color[3] == 1.0 else "BLEND",
    )
    return Trimesh(mesh.vertices, mesh.faces, process=False, visual=TextureVisuals(uv=uv, material=material))


def _read_mesh(model: "mujoco.MjModel", mesh: int) -> "tuple[Trimesh, Float[np.ndarray, 'V 2'] | None]":
    """A mesh, with texture coordinates and a vertex for every corner of a face if it has any."""
    from trimesh import Trimesh

    first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    start, size = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    vertices = np.asarray(model.mesh_vert)[start : start + size]
    faces = np.asarray(model.mesh_face)[first : first + count]
    if model.mesh_texcoordadr[mesh] < 0:
        return Trimesh(vertices, faces, process=False), None
    rows = int(model.mesh_texcoordadr[mesh]) + np.asarray(model.mesh_facetexcoord)[first : first + count]
    uv = np.asarray(model.mesh_texcoord)[rows.ravel()] * [1.0, -1.0] + [0.0, 1.0]
    return Trimesh(vertices[faces.ravel()], np.arange(3 * count).reshape(-1, 3), process=False), uv


def _read_color(model: "mujoco.MjModel", geom: int) -> Float[np.ndarray, "4"]:
    """RGBA in [0, 1]: that of the geom, or of its material where the geom states none."""
    color, material = np.array(model.geom_rgba[geom], dtype=float), int(model.geom_matid[geom])
    if material >= 0 and np.allclose(color, PLAIN):
        color = np.array(model.mat_rgba[material], dtype=float)
    return np.clip(color, 0.0, 1.0)


def _read_image(model: "mujoco.MjModel", geom: int) -> "Image | None":
    """The colours of the texture on a geom, of whatever type; the faces of a cube lie in a column."""
    import mujoco
    from PIL import Image

    material, roles = int(model.geom_matid[geom]), mujoco.mjtTextureRole
    if material < 0:
        return None
    said = [int(model.mat_texid[material][int(role)]) for role in (roles.mjTEXROLE_RGB, roles.mjTEXROLE_RGBA)]
    texture = max(said)
    if texture < 0:
        return None
    shape = (model.tex_height[texture], model.tex_width[texture], model.tex_nchannel[texture])
    start = int(model.tex_adr[texture])
    pixels = np.asarray(model.tex_data)[start : start + int(np.prod(shape))].reshape(shape)
    pixels = np.repeat(pixels, 3, axis=2) if shape[2] < 3 else pixels[..., :3]
    return Image.fromarray(np.ascontiguousarray(pixels))
