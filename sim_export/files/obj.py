"""Reads and writes OBJ, MTL and PNG for meshes and hulls.

Everything is in metres in the object frame. Coordinates have six decimals (a micrometre); equal meshes give
equal bytes.
"""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from artigen.errors import SourceError, explain
from artigen.files import mtl, urdf, wavefront
from artigen.files.mtl import MtlMaterial
from artigen.files.wavefront import ObjText
from artigen.shapes.surfaces.physical import Material, mirrored_head_on
from sim_export.errors import PackageError
from sim_export.geometry.hulls import convex_hull
from sim_export.geometry.normals import corner_normals
from sim_export.geometry.rows import number_rows
from sim_export.geometry.triangles import area_normals
from sim_export.package import Hull, Mesh

DECIMALS = 6
PALETTE = 256


def format_rows(prefix: str, values: np.ndarray, decimals: int) -> str:
    """One line per row: ``prefix`` and the numbers with fixed decimals, without negative zeros."""
    rows = np.round(np.asarray(values, np.float64), decimals) + 0.0
    line = prefix + f" %.{decimals}f" * rows.shape[1] + "\n"
    return (line * len(rows)) % tuple(rows.ravel().tolist())


def _unique_rows(values: np.ndarray, decimals: int) -> tuple[np.ndarray, np.ndarray]:
    """Unique rows after rounding, in ascending order, and the index of each row among them."""
    first, where = number_rows(np.round(values * 10**decimals).astype(np.int64))
    return values[first], where


def obj_text(mesh: Mesh, name: str, material: str | None = None) -> str:
    """A mesh as OBJ: one object ``name`` of one material, which is in an MTL file of its name."""
    vertices = np.round(mesh.vertices, DECIMALS)
    normals, normal_of = _unique_rows(corner_normals(vertices[mesh.faces]).reshape(-1, 3), 4)
    head = f"mtllib {material}.mtl\n" if material else ""
    chunks = [head, f"o {name}\n", format_rows("v", vertices, DECIMALS)]
    columns = [mesh.faces.ravel() + 1]
    corner = "%d//%d"
    if mesh.uv is not None:
        uv, uv_of = _unique_rows(mesh.uv.reshape(-1, 2), DECIMALS)
        chunks.append(format_rows("vt", uv, DECIMALS))
        columns.append(uv_of + 1)
        corner = "%d/%d/%d"
    columns.append(normal_of + 1)
    chunks.append(format_rows("vn", normals, 4))
    if material:
        chunks.append(f"usemtl {material}\n")
    line = f"f {corner} {corner} {corner}\n"
    chunks.append((line * len(mesh.faces)) % tuple(np.stack(columns, axis=1).ravel().tolist()))
    return "".join(chunks)


def hull_obj_text(hull: Hull, name: str) -> str:
    """A collision hull as OBJ with one normal per face and no material."""
    hull = round_hull(hull)
    vertices = hull.vertices
    weighted = area_normals(vertices[hull.faces])
    lengths = np.linalg.norm(weighted, axis=1, keepdims=True)
    normals, normal_of = _unique_rows(weighted / np.where(lengths > 0, lengths, 1.0), 4)
    corners = np.stack([hull.faces + 1, np.repeat(normal_of[:, None] + 1, 3, axis=1)], axis=2)
    faces = ("f %d//%d %d//%d %d//%d\n" * len(hull.faces)) % tuple(corners.ravel().tolist())
    return "".join(
        [f"o {name}\n", format_rows("v", vertices, DECIMALS), format_rows("vn", normals, 4), faces]
    )


def round_hull(hull: Hull) -> Hull:
    """A hull as files hold it.

    Its faces are those of the rounded corners' hull: of hulls of a few millimetres, rounding dents some.
    """
    return convex_hull(np.round(hull.vertices, DECIMALS))


def mtl_text(name: str, mesh: Mesh, image: str, normal_map: str = "") -> str:
    """The material of a mesh: its image (over white) if it has one, else its colour; and its normal map.

    Besides the words of the physically based extension (``Pr``, ``Pm``, ``Pc``, ``Pcr``) there are those of
    the first MTL: what is mirrored head-on, and the exponent of Blinn and Phong that is as wide as the
    roughness.
    """
    look = mesh.material
    color = np.ones(3) if image else np.array(mesh.color)
    mirrored = color if look.metallic else np.full(3, mirrored_head_on(look))
    values = {
        "Ka": "0 0 0",
        "Kd": format_rows("", color[None], 6).strip(),
        "Ks": format_rows("", mirrored[None], 6).strip(),
        "Ns": f"{shininess(look):.6g}",
        "Ni": f"{look.ior:.6g}",
        "d": f"{look.opacity:.6g}",
        "illum": "2",
        "Pr": f"{look.roughness:.6g}",
        "Pm": f"{look.metallic:.6g}",
        "Pc": f"{look.coat:.6g}",
        "Pcr": f"{look.coat_roughness:.6g}",
    }
    values |= {word: file for word, file in (("map_Kd", image), ("norm", normal_map)) if file}
    return "\n".join([f"newmtl {name}", *(f"{key} {value}" for key, value in values.items())]) + "\n"


def shininess(look: Material) -> float:
    """Exponent of Blinn and Phong whose lobe is as wide as that of the roughness, at most 1,000."""
    return min(2.0 / max(look.roughness, 0.01) ** 4 - 2.0, 1000.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Palette:
    """An image with a palette: an index per texel, and the colour of each index."""

    colors: UInt8[np.ndarray, "C 3"]
    index: UInt8[np.ndarray, "H W"]


def _few_colors(texture: UInt8[np.ndarray, "H W 3"]) -> _Palette | None:
    """An RGB image with its palette; None if it has more than 256 colours."""
    code = (texture.astype(np.int32) << np.array([16, 8, 0])).sum(axis=2)
    if len(np.unique(code.ravel()[:: max(1, code.size // 4096)])) > PALETTE:
        return None
    values, index = np.unique(code, return_inverse=True)
    if len(values) > PALETTE:
        return None
    colors = ((values[:, None] >> np.array([16, 8, 0])) & 255).astype(np.uint8)
    return _Palette(colors=colors, index=index.reshape(code.shape).astype(np.uint8))


def png_bytes(texture: UInt8[np.ndarray, "H W C"]) -> bytes:
    """Encodes RGB or RGBA as PNG without metadata; uses a palette for opaque images of at most 256
    colours."""
    return _encode_png(texture.shape, texture.tobytes())


@lru_cache(maxsize=16)
def _encode_png(shape: tuple[int, ...], texels: bytes) -> bytes:
    """Kept, because objects share tiles."""
    from PIL import Image

    stream, texture = io.BytesIO(), np.frombuffer(texels, np.uint8).reshape(shape)
    if texture.shape[2] == 3 and (few := _few_colors(texture)) is not None:
        image = Image.fromarray(few.index, "P")
        image.putpalette(few.colors.tobytes())
        image.save(stream, "PNG", compress_level=6)
        return stream.getvalue()
    Image.fromarray(texture).save(stream, "PNG", compress_level=1)
    return stream.getvalue()


def read_image(path: Path) -> UInt8[np.ndarray, "H W C"]:
    """An image file as RGB rows, or RGBA if any pixel is transparent; raises `PackageError` if it is not an
    image."""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            pixels = np.asarray(image.convert("RGBA"))
    except (OSError, UnidentifiedImageError, Image.DecompressionBombError) as err:
        raise PackageError(f"{path}: not a readable image ({explain(err)})") from err
    return pixels if pixels[..., 3].min() < 255 else pixels[..., :3]


def parse_obj(path: Path) -> ObjText:
    """Reads an OBJ; raises `PackageError` with the file and what is wrong in it."""
    with _as_package():
        return wavefront.parse_obj(path)


def parse_mtl(path: Path) -> dict[str, MtlMaterial]:
    """The materials of an MTL file."""
    with _as_package():
        return mtl.parse_mtl(path)


def parse_urdf(path: Path, text: str | None = None) -> urdf.UrdfFile:
    """Reads a URDF without validating it: the file, or a ``text`` that stands for it."""
    with _as_package():
        return urdf.parse_urdf(path, path.name, text=text)


@contextmanager
def _as_package() -> Iterator[None]:
    """Makes errors of files those of packages."""
    try:
        yield
    except SourceError as err:
        raise PackageError(str(err)) from err


def read_mesh(path: Path) -> Mesh:
    """Reads an OBJ with one material into a `Mesh`, with its texture or colour."""
    data = parse_obj(path)
    name, said = "", MtlMaterial()
    if data.libraries and len(data.faces):
        name = str(data.face_materials[0])
        said = parse_mtl(path.parent / data.libraries[-1]).get(name, said)
    placed = len(data.coords) > 0 and not (data.uv_faces < 0).any()
    return Mesh(
        vertices=data.vertices,
        faces=data.faces,
        uv=data.coords[data.uv_faces] if placed else None,
        texture=read_image(path.parent / said.image) if placed and said.image else None,
        normal_map=read_image(path.parent / said.normal_map)[..., :3] if placed and said.normal_map else None,
        color=said.color,
        material=material_of(said, "" if name == path.stem else name),
    )


def material_of(said: MtlMaterial, name: str = "") -> Material:
    """What an MTL file says about a material, besides its colour and image."""
    return Material(
        name=name,
        roughness=said.roughness,
        metallic=said.metallic,
        ior=said.ior,
        opacity=said.opacity,
        coat=said.coat,
        coat_roughness=said.coat_roughness,
    )
