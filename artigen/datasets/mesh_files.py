"""Meshes of any format and primitives as OBJ files with their materials.

An OBJ that a package can hold as it is stays as it is. All others (STL, GLB, DAE, PLY, what trimesh reads,
primitives, OBJ without materials, meshes scaled by unequal factors) are written anew into a scratch folder,
so that everything behind this module knows one format.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from artigen.errors import SourceError
from artigen.files.urdf import UrdfShape
from artigen.files.wavefront import NO_MATERIAL, ObjMesh, clean_name, read_obj

if TYPE_CHECKING:
    from PIL.Image import Image
    from trimesh import Trimesh

FORMATS = ("obj", "stl", "glb", "gltf", "dae", "ply", "off")
COLORS = 64
"""Most plain colours that one mesh keeps; more are averaged."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlacedMesh:
    """An OBJ file, the uniform factor on its coordinates, and its triangles with that factor applied."""

    path: Path
    scale: float
    mesh: ObjMesh


def load_shape(shape: UrdfShape, path: Path | None, root: Path, scratch: Path) -> PlacedMesh | None:
    """The triangles of one visual or collision element; None where its file holds none.

    Args:
        path: Its mesh file; None for primitives.
        root: Folder that materials and images must not leave.
        scratch: Where meshes are written that cannot stay as they are.

    Raises:
        SourceError: names the file and why it cannot be read.
    """
    if path is not None and min(shape.scale) == max(shape.scale) > 0 and _is_self_contained(path):
        mesh, scale = read_obj(path, root), shape.scale[0]
        if not len(mesh.faces):
            return None
        return PlacedMesh(path=path, scale=scale, mesh=replace(mesh, vertices=scale * mesh.vertices))
    pieces = _primitive(shape) if path is None else _load(path)
    for piece in pieces:
        piece.apply_transform(np.diag([*shape.scale, 1.0]))
    return load_pieces(pieces, scratch, (*(shape.color or NO_MATERIAL), shape.opacity))


def load_pieces(
    pieces: Sequence["Trimesh"],
    scratch: Path,
    color: tuple[float, float, float, float] = (*NO_MATERIAL, 1.0),
) -> PlacedMesh | None:
    """Meshes written as one OBJ into ``scratch``; None if there are none.

    Args:
        color: RGBA of those that have no colour of their own.
    """
    if not pieces:
        return None
    scratch.mkdir(parents=True, exist_ok=True)
    target = scratch / f"mesh_{len(list(scratch.glob('*.obj')))}.obj"
    write_obj(pieces, color, target)
    return PlacedMesh(path=target, scale=1.0, mesh=read_obj(target, scratch))


def _is_self_contained(path: Path) -> bool:
    """Whether an OBJ has materials, and all their files are there, in its object's folder."""
    if path.suffix.lower() != ".obj":
        return False
    libraries = _named_files(path, ("mtllib",))
    images = [image for library in libraries for image in _named_files(library, ("map_", "bump", "norm"))]
    folder = path.parent.parent.resolve()
    return bool(libraries) and all(
        file.is_file() and file.resolve().is_relative_to(folder) for file in (*libraries, *images)
    )


def _named_files(path: Path, keys: Sequence[str]) -> list[Path]:
    if not path.is_file():
        return []
    rows = [line.strip() for line in path.read_text(errors="replace").splitlines()]
    said = [row.split(maxsplit=1) for row in rows if row.startswith(tuple(keys))]
    return [path.parent / clean_name(row[1]) for row in said if len(row) == 2]


def _primitive(shape: UrdfShape) -> list["Trimesh"]:
    from trimesh import creation

    match shape.kind:
        case "box":
            return [creation.box(shape.sizes)]
        case "cylinder":
            return [creation.cylinder(radius=shape.sizes[0], height=shape.sizes[1], sections=48)]
        case _:
            return [creation.icosphere(subdivisions=3, radius=shape.sizes[0])]


def _load(path: Path) -> list["Trimesh"]:
    import trimesh
    from trimesh.visual import ColorVisuals

    if path.suffix.lower().lstrip(".") not in FORMATS:
        raise SourceError(f"{path}: a {path.suffix or 'nameless'} mesh, expected one of {', '.join(FORMATS)}")
    try:
        scene = trimesh.load_scene(path, process=False)
        pieces = [piece for piece in scene.dump() if isinstance(piece, trimesh.Trimesh) and len(piece.faces)]
    except Exception as err:  # every loader behind trimesh raises errors of its own
        raise SourceError(f"{path}: mesh cannot be read: {type(err).__name__}: {err}") from err
    unnamed = path.suffix.lower() == ".obj" and not any(
        file.is_file() for file in _named_files(path, ("mtllib",))
    )
    for piece in pieces:
        if not np.isfinite(piece.vertices).all():
            raise SourceError(f"{path}: a vertex is not finite")
        visual: Any = piece.visual
        if unnamed and visual.kind == "texture":  # trimesh invents a material for texture coordinates
            piece.visual = ColorVisuals(piece)
    return pieces


def write_obj(pieces: Sequence["Trimesh"], color: tuple[float, float, float, float], target: Path) -> None:
    """Writes meshes as one OBJ, with plain colours and images; ``color`` (RGBA) is for those without any."""
    rows, materials, start, texture = [f"mtllib {target.stem}.mtl"], [], 1, 1
    for piece in pieces:
        uv, image, colors, numbers = _find_look(piece, color)
        rows += [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in piece.vertices.tolist()]
        rows += [f"vt {u:.7g} {v:.7g}" for u, v in ([] if uv is None else uv.tolist())]
        first = len(materials)
        for red, green, blue, opacity in colors:
            material = f"newmtl m{len(materials)}\nKd {red:.5g} {green:.5g} {blue:.5g}"
            if opacity < 1.0:
                material += f"\nd {opacity:.5g}"
            if image is not None:
                material += f"\nmap_Kd {_write_image(image, target.parent)}"
            materials.append(material)
        for number in range(len(colors)):
            rows.append(f"usemtl m{first + number}")
            for face in piece.faces[numbers == number].tolist():
                corners = [(start + k, "" if uv is None else f"/{texture + k}") for k in face]
                rows.append("f " + " ".join(f"{vertex}{coord}" for vertex, coord in corners))
        start += len(piece.vertices)
        texture += 0 if uv is None else len(uv)
    target.write_text("\n".join(rows) + "\n", encoding="utf-8")
    target.with_suffix(".mtl").write_text("\n".join(materials) + "\n", encoding="utf-8")


def _write_image(image: "Image", folder: Path) -> str:
    """Name of a PNG of an image, which is there once however often it is used."""
    pixels = image.convert("RGB")
    size = f"{pixels.width} {pixels.height} ".encode()
    name = f"image_{hashlib.sha256(size + pixels.tobytes()).hexdigest()[:16]}.png"
    if not (folder / name).exists():
        pixels.save(folder / name, compress_level=1)
    return name


def _find_look(
    piece: "Trimesh", color: tuple[float, float, float, float]
) -> tuple[np.ndarray | None, "Image | None", list[tuple[float, ...]], np.ndarray]:
    """Texture coordinates and image if there is one, plain colours (RGBA), and the colour of each face.

    A material of the mesh is transparent only if it says so: glTF ignores the alpha of others.
    """
    visual: Any = piece.visual
    one = np.zeros(len(piece.faces), dtype=np.int64)
    if visual.kind == "texture":
        material = visual.material
        image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
        said = getattr(material, "baseColorFactor", None) is not None or hasattr(material, "diffuse")
        main = np.asarray(material.main_color) / 255 if said else np.array(color)
        blends = not said or getattr(material, "alphaMode", None) == "BLEND"
        opacity = float(main[3]) if blends else 1.0
        if image is not None and visual.uv is not None:
            return np.asarray(visual.uv, dtype=np.float64), image, [(1.0, 1.0, 1.0, opacity)], one
        return None, None, [(*main[:3].tolist(), opacity)], one
    if visual.kind is None:
        return None, None, [color], one
    faces = np.asarray(visual.face_colors)[:, :3] / 255
    plain, numbers = np.unique(faces, axis=0, return_inverse=True)
    if len(plain) > COLORS:
        return None, None, [(*faces.mean(axis=0).tolist(), 1.0)], one
    return None, None, [(*row, 1.0) for row in plain.tolist()], numbers.ravel()
