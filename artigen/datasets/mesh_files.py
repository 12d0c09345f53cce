"""Meshes of any format and primitives as OBJ files with their materials.

An OBJ that a package can hold as it is stays as it is. All others (STL, GLB, DAE, PLY, what trimesh reads,
primitives, OBJ without materials or with missing images, meshes scaled by unequal factors) are written anew
into a scratch folder, so that everything behind this module knows one format.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from artigen.datasets.mesh_obj import write_obj
from artigen.datasets.mesh_size import check_file, check_size
from artigen.errors import SourceError
from artigen.files.mtl import NO_MATERIAL, MtlMaterial, clean_name, parse_mtl
from artigen.files.urdf import UrdfShape
from artigen.files.wavefront import ObjMesh, parse_obj, read_obj

if TYPE_CHECKING:
    from PIL.Image import Image
    from trimesh import Trimesh

FORMATS = ("obj", "stl", "glb", "gltf", "dae", "ply", "off")
UNIT = re.compile(r"([-+.\deE]+) \* meters")
"""How trimesh states the unit of a DAE file."""
IMAGES = re.compile(rb"""(?:<init_from>|"uri"\s*:\s*")\s*([^<"]+?\.(?:png|jpe?g|bmp|tga))\s*[<"]""", re.I)
"""An image in a DAE or glTF file."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlacedMesh:
    """An OBJ file, the uniform factor on its coordinates, and its triangles with that factor applied."""

    path: Path
    scale: float
    mesh: ObjMesh
    missing: tuple[str, ...] = ()
    """Images and material libraries that the file names and that are not there."""


def load_shape(
    shape: UrdfShape, path: Path | None, root: Path, scratch: Path, texture: Path | None = None
) -> PlacedMesh | None:
    """The triangles of one visual or collision element; None where its file holds none.

    Args:
        path: Its mesh file; None for primitives.
        root: Folder that materials and images must not leave.
        scratch: Where meshes are written that cannot stay as they are.
        texture: Image of its material, for meshes without materials of their own.

    Raises:
        SourceError: names the file and why it cannot be read.
    """
    if path is not None:
        check_file(path)
    if path is not None and min(shape.scale) == max(shape.scale) > 0 and _is_self_contained(path):
        mesh, scale = read_obj(path, root), shape.scale[0]
        check_size(path, len(mesh.faces))
        if not len(mesh.faces):
            return None
        return PlacedMesh(path=path, scale=scale, mesh=replace(mesh, vertices=scale * mesh.vertices))
    missing: tuple[str, ...] = ()
    if path is None:
        pieces = _primitive(shape)
    elif path.suffix.lower() == ".obj":
        pieces, missing = read_obj_pieces(path, root)
    else:
        named, missing = _load(path)
        pieces = [piece for _, piece in named]
    for piece in pieces:
        piece.apply_transform(np.diag([*shape.scale, 1.0]))
    color = (*(shape.color or (NO_MATERIAL if texture is None else (1.0, 1.0, 1.0))), shape.opacity)
    placed = load_pieces(
        pieces, scratch, color, None if texture is None else open_image(texture, str(texture))
    )
    return None if placed is None else replace(placed, missing=missing)


def load_pieces(
    pieces: Sequence["Trimesh"],
    scratch: Path,
    color: tuple[float, float, float, float] = (*NO_MATERIAL, 1.0),
    image: "Image | None" = None,
) -> PlacedMesh | None:
    """Meshes written as one OBJ into ``scratch``; None if there are none.

    Args:
        color: RGBA of those that have no colour of their own.
        image: What colours these, times ``color``: by texture coordinates, or by its mean.
    """
    if not pieces:
        return None
    scratch.mkdir(parents=True, exist_ok=True)
    target = scratch / f"mesh_{len(list(scratch.glob('*.obj')))}.obj"
    write_obj(pieces, color, target, image)
    return PlacedMesh(path=target, scale=1.0, mesh=read_obj(target, scratch))


def _is_self_contained(path: Path) -> bool:
    """Whether an OBJ has materials, and all their files are there, in its object's folder."""
    if path.suffix.lower() != ".obj" or not path.is_file():
        return False
    said = parse_obj(path)
    libraries = [path.parent / name for name in said.libraries]
    folder = path.parent.parent.resolve()
    if len(libraries) != 1 or not _are_inside(libraries, folder):
        return False
    return _are_inside(_list_images(libraries[0]), folder) and not parse_mtl(libraries[0]).keys().isdisjoint(
        said.names
    )


def _are_inside(files: Iterable[Path], folder: Path) -> bool:
    return all(file.is_file() and file.resolve().is_relative_to(folder) for file in files)


def _list_images(library: Path) -> list[Path]:
    rows = [line.strip() for line in library.read_text(errors="replace").splitlines()]
    said = [row.split(maxsplit=1) for row in rows if row.startswith(("map_", "bump", "norm"))]
    return [library.parent / clean_name(row[1]) for row in said if len(row) == 2]


Named = tuple[tuple[str, ...], "Trimesh"]
"""A mesh with the names of its node and of those above it, inner ones first."""


def read_named(path: Path, root: Path) -> tuple[list[Named], tuple[str, ...]]:
    """The meshes of a file by its nodes (GLB) or its groups and objects (OBJ), and what it lacks.

    Args:
        root: Folder that materials and images must not leave.

    Raises:
        SourceError: names the file and why it cannot be read.
    """
    check_file(path)
    if path.suffix.lower() != ".obj":
        return _load(path)
    said = parse_obj(path)
    assert said.group_ids is not None
    named, missing = list[Named](), dict[str, None]()
    for number in np.unique(said.group_ids).tolist():
        pieces, gone = read_obj_pieces(path, root, group=number)
        named += [(said.groups[number], piece) for piece in pieces]
        missing |= dict.fromkeys(gone)
    return named, tuple(missing)


def read_obj_pieces(
    path: Path, root: Path, *, group: int | None = None
) -> "tuple[list[Trimesh], tuple[str, ...]]":
    """The triangles of an OBJ, one mesh per material, and the names of libraries and images that it lacks.

    Triangles without a known material have the colours of their vertices, or none of their own.

    Args:
        root: Folder that materials and images must not leave.
        group: The only group that is read; None for all.
    """
    from trimesh import Trimesh
    from trimesh.visual import ColorVisuals, TextureVisuals
    from trimesh.visual.material import PBRMaterial

    said = parse_obj(path)
    check_size(path, len(said.faces))
    known: dict[str, tuple[MtlMaterial, Path]] = {}
    missing = []
    for name in said.libraries:
        library = path.parent / name
        if _are_inside([library], root.resolve()):
            known |= {key: (material, library.parent) for key, material in parse_mtl(library).items()}
        else:
            missing.append(name)
    names = said.face_materials
    chosen = np.ones(len(names), dtype=bool) if group is None else said.group_ids == group
    pieces = []
    for name in dict.fromkeys(names[chosen].tolist()):
        own = (names == name) & chosen
        faces, uv_faces = said.faces[own], said.uv_faces[own]
        mapped = len(said.coords) > 0 and bool((uv_faces >= 0).all())
        corners = faces * max(len(said.coords), 1) + (uv_faces if mapped else 0)  # a number per corner
        _, first, numbers = np.unique(corners, return_index=True, return_inverse=True)
        mesh = Trimesh(said.vertices[faces.ravel()[first]], numbers.reshape(-1, 3), process=False)
        uv = said.coords[uv_faces.ravel()[first]] if mapped else None
        if name in known:
            material, folder = known[name]
            image = folder / material.image if material.image else None
            if image is not None and not _are_inside([image], root.resolve()):
                missing.append(material.image)
                image = None
            color = (1.0, 1.0, 1.0) if image is not None and uv is not None else material.color
            mesh.visual = TextureVisuals(
                uv=uv,
                material=PBRMaterial(
                    baseColorFactor=[*color, material.opacity],
                    baseColorTexture=None if image is None else open_image(image, str(image)),
                    alphaMode="OPAQUE" if material.opacity == 1.0 else "BLEND",
                ),
            )
        elif said.colors is not None:
            mesh.visual = ColorVisuals(mesh, face_colors=said.colors[faces].mean(axis=1))
        elif uv is not None:
            mesh.visual = TextureVisuals(uv=uv, material=PBRMaterial())
        pieces.append(mesh)
    return pieces, tuple(dict.fromkeys(missing))


def open_image(file: "Path | IO[bytes]", name: str) -> "Image":
    """A decoded image; errors call it ``name``.

    Raises:
        SourceError: If it cannot be decoded.
    """
    from PIL import Image

    try:
        with Image.open(file) as image:
            image.load()
            return image
    except (OSError, ValueError, Image.DecompressionBombError) as err:
        raise SourceError(f"{name}: image cannot be decoded: {err}") from err


def _primitive(shape: UrdfShape) -> list["Trimesh"]:
    from trimesh import creation

    match shape.kind:
        case "box":
            return [creation.box(shape.sizes)]
        case "capsule":
            mesh = creation.capsule(radius=shape.sizes[0], height=shape.sizes[1], count=(24, 48))
            mesh.apply_translation(-mesh.bounds.mean(axis=0))
            return [mesh]
        case "cylinder":
            return [creation.cylinder(radius=shape.sizes[0], height=shape.sizes[1], sections=48)]
        case _:
            return [creation.icosphere(subdivisions=3, radius=shape.sizes[0])]


def _load(path: Path) -> tuple[list[Named], tuple[str, ...]]:
    """Meshes of a file in metres, as trimesh reads them, and the images that it names and lacks."""
    import trimesh

    if path.suffix.lower().lstrip(".") not in FORMATS:
        raise SourceError(f"{path}: a {path.suffix or 'nameless'} mesh, expected one of {', '.join(FORMATS)}")
    try:
        scene = trimesh.load_scene(path, process=False)
        named = list(_list_meshes(scene))
    except Exception as err:  # every loader behind trimesh raises errors of its own
        raise SourceError(f"{path}: mesh cannot be read: {type(err).__name__}: {err}") from err
    check_size(path, sum(len(piece.faces) for _, piece in named))
    unit = UNIT.fullmatch(str(scene.units or ""))
    for _, piece in named:
        if not np.isfinite(piece.vertices).all():
            raise SourceError(f"{path}: a vertex is not finite")
        if unit is not None:
            piece.apply_scale(float(unit[1]))
    said = IMAGES.findall(path.read_bytes()) if path.suffix.lower() in (".dae", ".gltf") else []
    images = [name.decode(errors="replace").replace("\\", "/").removeprefix("file://") for name in said]
    gone = [name for name in images if name and not (path.parent / name).is_file() and "data:" not in name]
    return named, tuple(dict.fromkeys(gone))


def _list_meshes(scene: Any) -> Iterator[Named]:
    """Meshes of a scene of trimesh, placed, with the names of their nodes from the inside out."""
    import trimesh

    above = scene.graph.transforms.parents
    for node in scene.graph.nodes_geometry:
        T, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            names, at = list[str](), node
            while at is not None and at != scene.graph.base_frame:
                names.append(str(at))
                at = above.get(at)
            yield tuple(names), mesh.copy().apply_transform(T)
