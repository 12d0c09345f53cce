"""Reads and writes OBJ, MTL and PNG for meshes and hulls.

Everything is in metres in the object frame. Coordinates have six decimals (a micrometre); equal meshes give
equal bytes.
"""

import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int, UInt8

from sim_export.errors import PackageError
from sim_export.package import Hull, Mesh

DECIMALS = 6
CREASE_DEGREES = 35.0
PALETTE = 256


@dataclass(frozen=True, kw_only=True, eq=False)
class ObjGroup:
    """The faces of an OBJ that share one material."""

    material: str | None
    faces: Int[np.ndarray, "F 3"]
    uv_faces: Int[np.ndarray, "F 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class ObjData:
    """An OBJ file as arrays: triangulated, zero-based; missing texture indices are -1."""

    vertices: Float[np.ndarray, "V 3"]
    uv: Float[np.ndarray, "T 2"]
    groups: tuple[ObjGroup, ...]
    mtllib: str | None

    @property
    def faces(self) -> Int[np.ndarray, "F 3"]:
        """All triangles, group after group."""
        return np.concatenate([np.zeros((0, 3), np.int64), *(group.faces for group in self.groups)])


@dataclass(frozen=True, kw_only=True)
class Material:
    """One entry of an MTL file."""

    color: tuple[float, float, float] = (0.7, 0.7, 0.7)
    image: str | None = None


def face_normals(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]) -> np.ndarray:
    """Normals with the length of twice the area of each triangle."""
    a, b, c = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    return np.cross(b - a, c - a)


def corner_normals(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]
) -> Float[np.ndarray, "F 3 3"]:
    """Unit normals per face corner: smooth across edges flatter than `CREASE_DEGREES`, sharp elsewhere.

    Every corner averages, weighted by area, the faces around its vertex whose normal is close to
    its own face's. A degenerate face gets the direction +z.
    """
    from scipy.sparse import csr_matrix

    weighted = face_normals(vertices, faces)
    lengths = np.linalg.norm(weighted, axis=1, keepdims=True)
    unit = np.where(lengths > 0, weighted / np.where(lengths > 0, lengths, 1.0), [0.0, 0.0, 1.0])
    count = faces.size
    touches = csr_matrix((np.ones(count, np.int8), (np.arange(count), faces.ravel())), (count, len(vertices)))
    pairs = (touches @ touches.T).tocoo()  # corners that share a vertex
    near = np.einsum("ij,ij->i", unit[pairs.row // 3], unit[pairs.col // 3]) > np.cos(
        np.radians(CREASE_DEGREES)
    )
    row, col = pairs.row[near], pairs.col[near] // 3
    total = np.stack([np.bincount(row, weighted[col, k], count) for k in range(3)], axis=1)
    size = np.linalg.norm(total, axis=1, keepdims=True)
    total = np.where(size > 0, total / np.where(size > 0, size, 1.0), np.repeat(unit, 3, axis=0))
    return total.reshape(-1, 3, 3)


def format_rows(prefix: str, values: np.ndarray, decimals: int) -> str:
    """One line per row: ``prefix`` and the numbers with fixed decimals, without negative zeros."""
    rows = np.round(np.asarray(values, np.float64), decimals) + 0.0
    line = prefix + f" %.{decimals}f" * rows.shape[1] + "\n"
    return (line * len(rows)) % tuple(rows.ravel().tolist())


def _unique_rows(values: np.ndarray, decimals: int) -> tuple[np.ndarray, np.ndarray]:
    """Unique rows after rounding, in ascending order, and the index of each row among them."""
    keys = np.round(values * 10**decimals).astype(np.int64)
    if not len(keys):
        return values, np.zeros(0, np.int64)
    low = keys.min(axis=0)
    spans = keys.max(axis=0) - low + 1
    if np.prod(spans.astype(np.float64)) < 2**62:  # integers sort ten times faster than rows
        packed = np.zeros(len(keys), np.int64)
        for column, span in zip((keys - low).T, spans, strict=True):
            packed = packed * span + column
        _, first, where = np.unique(packed, return_index=True, return_inverse=True)
    else:
        _, first, where = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return values[first], where.ravel()


def obj_text(mesh: Mesh, name: str, mtllib: str | None = None) -> str:
    """A mesh as OBJ: one object ``name``, one material of the same name where there is an MTL."""
    vertices = np.round(mesh.vertices, DECIMALS)
    normals, normal_of = _unique_rows(corner_normals(vertices, mesh.faces).reshape(-1, 3), 4)
    head = f"mtllib {mtllib}\n" if mtllib else ""
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
    if mtllib:
        chunks.append(f"usemtl {name}\n")
    line = f"f {corner} {corner} {corner}\n"
    chunks.append((line * len(mesh.faces)) % tuple(np.stack(columns, axis=1).ravel().tolist()))
    return "".join(chunks)


def hull_obj_text(hull: Hull, name: str) -> str:
    """A collision hull as OBJ with one normal per face and no material."""
    vertices = np.round(hull.vertices, DECIMALS)
    weighted = face_normals(vertices, hull.faces)
    lengths = np.linalg.norm(weighted, axis=1, keepdims=True)
    normals, normal_of = _unique_rows(weighted / np.where(lengths > 0, lengths, 1.0), 4)
    corners = np.stack([hull.faces + 1, np.repeat(normal_of[:, None] + 1, 3, axis=1)], axis=2)
    faces = ("f %d//%d %d//%d %d//%d\n" * len(hull.faces)) % tuple(corners.ravel().tolist())
    return "".join(
        [f"o {name}\n", format_rows("v", vertices, DECIMALS), format_rows("vn", normals, 4), faces]
    )


def mtl_text(name: str, material: Material) -> str:
    """One material: its image (over white) if it has one, else its colour."""
    color = (1.0, 1.0, 1.0) if material.image else material.color
    red, green, blue = color
    text = f"newmtl {name}\nKa 0 0 0\nKd {red:.6f} {green:.6f} {blue:.6f}\nKs 0 0 0\nNs 10\nd 1\nillum 1\n"
    return text + (f"map_Kd {material.image}\n" if material.image else "")


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
    from PIL import Image

    stream = io.BytesIO()
    if texture.shape[2] == 3 and (few := _few_colors(texture)) is not None:
        image = Image.fromarray(few.index, "P")
        image.putpalette(few.colors.tobytes())
        image.save(stream, "PNG", compress_level=9)
        return stream.getvalue()
    Image.fromarray(np.ascontiguousarray(texture)).save(stream, "PNG", compress_level=1)
    return stream.getvalue()


def read_image(path: Path) -> UInt8[np.ndarray, "H W C"]:
    """An image file as RGB rows, or RGBA if any pixel is transparent; raises `PackageError` if it is not an
    image."""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            pixels = np.asarray(image.convert("RGBA"))
    except (OSError, UnidentifiedImageError, Image.DecompressionBombError) as err:
        raise PackageError(f"{path}: not a readable image ({err})") from err
    return pixels if pixels[..., 3].min() < 255 else pixels[..., :3]


def _numbers(lines: list[bytes], width: int, path: Path, element: str) -> np.ndarray:
    """The first ``width`` numbers of each line."""
    if not lines:
        return np.zeros((0, width))
    try:
        flat = np.array(b" ".join(lines).split(), dtype=np.float64)
        if flat.size != width * len(lines):  # further values per line: colours or a third texture coordinate
            flat = np.array([line.split()[:width] for line in lines], dtype=np.float64)
    except ValueError as err:
        raise PackageError(f"{path}: '{element}' lines hold something else than numbers ({err})") from err
    rows = flat.reshape(-1, width)
    if not np.isfinite(rows).all():
        row = int(np.flatnonzero(~np.isfinite(rows).all(axis=1))[0])
        raise PackageError(f"{path}: '{element}' number {row + 1} is {rows[row].tolist()}, expected finite")
    return rows


def _corner(token: bytes) -> tuple[int, int]:
    """Zero-based vertex and texture index of ``v``, ``v/t``, ``v//n`` or ``v/t/n``."""
    fields = token.split(b"/")
    uv = int(fields[1]) if len(fields) > 1 and fields[1] else 0
    return int(fields[0]) - 1, uv - 1


_TRIANGLE = {3: (1, 0), 6: (2, 1), 9: (3, 1)}


def _triangles(lines: list[bytes], path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertex and texture indices of face lines; polygons become fans."""
    joined = b" ".join(lines)
    if joined.count(b"//") in (0, 3 * len(lines)):
        width = joined.replace(b"//", b" ").replace(b"/", b" ").split()
        per_face = len(width) / len(lines)
        uniform = all(len(line.split()) == 3 for line in lines)
        if uniform and per_face in _TRIANGLE:
            per_corner, has_uv = _TRIANGLE[int(per_face)]
            try:
                table = np.array(width, dtype=np.int64).reshape(-1, 3, per_corner) - 1
            except ValueError as err:
                raise PackageError(f"{path}: 'f' lines hold something else than indices ({err})") from err
            uv = table[:, :, 1] if has_uv and b"//" not in joined else np.full(table.shape[:2], -1)
            return table[:, :, 0], uv
    triangles = []
    for line in lines:
        try:
            corners = [_corner(token) for token in line.split()]
        except ValueError as err:
            raise PackageError(f"{path}: face 'f {line.decode(errors='replace')}' is no face") from err
        triangles += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    table = np.array(triangles, dtype=np.int64).reshape(-1, 3, 2)
    return table[:, :, 0], table[:, :, 1]


_LINE = re.compile(rb"^[ \t]*(v|vt|f|usemtl|mtllib)[ \t]+([^\r\n]+)", re.MULTILINE)


def parse_obj(path: Path) -> ObjData:
    """Reads an OBJ with absolute indices; polygons become fans.

    Raises `PackageError` with the file and the content of the line if it cannot be parsed.
    """
    try:
        data = path.read_bytes()
    except OSError as err:
        raise PackageError(f"{path}: cannot be read ({err.strerror})") from err
    vertices: list[bytes] = []
    uv: list[bytes] = []
    faces: dict[bytes | None, list[bytes]] = {}
    material: bytes | None = None
    mtllib: str | None = None
    for key, value in _LINE.findall(data.replace(b"\\\n", b" ")):
        match key:
            case b"v":
                vertices.append(value)
            case b"vt":
                uv.append(value)
            case b"f":
                faces.setdefault(material, []).append(value)
            case b"usemtl":
                material = value.strip()
            case _:
                mtllib = value.strip().decode(errors="replace")
    points = _numbers(vertices, 3, path, "v")
    coordinates = _numbers(uv, 2, path, "vt")
    groups = []
    for name, lines in faces.items():
        triangles, uv_triangles = _triangles(lines, path)
        for indices, size, kind, low in (
            (triangles, len(points), "v", 0),
            (uv_triangles, len(coordinates), "vt", -1),
        ):
            if indices.size and (indices.min() < low or indices.max() >= size):
                raise PackageError(
                    f"{path}: faces use '{kind}' {indices.min() + 1}..{indices.max() + 1}, "
                    f"allowed are absolute indices 1..{size}"
                )
        groups.append(
            ObjGroup(
                material=None if name is None else name.decode(errors="replace"),
                faces=triangles,
                uv_faces=uv_triangles,
            )
        )
    return ObjData(vertices=points, uv=coordinates, groups=tuple(groups), mtllib=mtllib)


def parse_mtl(path: Path) -> dict[str, Material]:
    """Materials of an MTL file: diffuse colour, and image name as written in the file."""
    try:
        text = path.read_text(errors="replace")
    except OSError as err:
        raise PackageError(f"{path}: cannot be read ({err.strerror})") from err
    colors: dict[str, tuple[float, float, float]] = {}
    images: dict[str, str] = {}
    name = ""
    for line in text.splitlines():
        key, _, value = line.strip().partition(" ")
        value = value.strip()
        if key == "newmtl":
            name = value
            colors[name] = (0.7, 0.7, 0.7)
        elif key == "Kd" and name:
            try:
                red, green, blue = (float(field) for field in value.split()[:3])
            except ValueError as err:
                raise PackageError(f"{path}: material {name!r} has 'Kd {value}', expected 3 numbers") from err
            colors[name] = (red, green, blue)
        elif key == "map_Kd" and name:
            images[name] = value.split()[-1] if value.startswith("-") else value
    return {name: Material(color=color, image=images.get(name)) for name, color in colors.items()}


def read_mesh(path: Path) -> Mesh:
    """Reads an OBJ with one material into a `Mesh`, with its texture or colour."""
    data = parse_obj(path)
    material = Material()
    if data.mtllib is not None and data.groups and data.groups[0].material is not None:
        material = parse_mtl(path.parent / data.mtllib).get(data.groups[0].material, material)
    uv_faces = np.concatenate([np.zeros((0, 3), np.int64), *(group.uv_faces for group in data.groups)])
    if material.image is None or not len(data.uv) or (uv_faces < 0).any():
        return Mesh(vertices=data.vertices, faces=data.faces, color=material.color)
    return Mesh(
        vertices=data.vertices,
        faces=data.faces,
        uv=data.uv[uv_faces],
        texture=read_image(path.parent / material.image),
        color=material.color,
    )
