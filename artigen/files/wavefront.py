"""Wavefront OBJ files as arrays: fast on triangles, strict on everything else.

Only the data of a coloured surface are read: positions, faces, texture coordinates, and the material of each
face. Files are untrusted: every index is checked, and an image outside the object's folder is rejected.
"""

import warnings
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int, Shaped

from artigen.errors import SourceError
from artigen.files.inside import inside
from artigen.files.mtl import Material, clean_name, read_mtl


@dataclass(frozen=True, kw_only=True, eq=False)
class ObjText:
    """Triangles and names of one file, zero-based; missing texture coordinates are -1.

    ``material_ids`` indexes ``names``, in which "" stands for no material.
    """

    vertices: Float[np.ndarray, "V 3"]
    coords: Float[np.ndarray, "T 2"]
    faces: Int[np.ndarray, "F 3"]
    uv_faces: Int[np.ndarray, "F 3"]
    names: tuple[str, ...]
    material_ids: Int[np.ndarray, "F"]
    libraries: tuple[str, ...]
    colors: Float[np.ndarray, "V 3"] | None = None
    """Colours of the vertices in [0, 1], if every vertex has one."""
    groups: tuple[tuple[str, ...], ...] = ((),)
    """Names of the group (``g``) and object (``o``) of faces, as ``group_ids`` index them."""
    group_ids: Int[np.ndarray, "F"] | None = None

    @property
    def face_materials(self) -> Shaped[np.ndarray, "F"]:
        """Name of the material of every face."""
        return np.array(self.names, dtype=object)[self.material_ids]


@dataclass(frozen=True, kw_only=True, eq=False)
class ObjMesh:
    """Triangles of one file, in file coordinates.

    ``uv`` holds the texture coordinates of each corner (zero where the file has none) and
    ``material_ids`` indexes ``materials``.
    """

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    uv: Float[np.ndarray, "F 3 2"]
    material_ids: Int[np.ndarray, "F"]
    materials: tuple[Material, ...]


def read_obj(path: Path, root: Path) -> ObjMesh:
    """Reads one OBJ with its materials; polygons become fans of triangles.

    Args:
        root: Folder that materials and images must not leave.

    Raises:
        SourceError: If the file is missing or malformed, holds NaN, or has an index out of range.
    """
    said = parse_obj(path)
    uv = np.zeros((len(said.faces), 3, 2))
    textured = said.uv_faces[:, 0] >= 0
    uv[textured] = said.coords[said.uv_faces[textured]]
    known: dict[str, Material] = {}
    for name in said.libraries:
        library = inside(root, path.parent, name, str(path))
        if library.is_file():
            known |= read_mtl(library, root)
    return ObjMesh(
        vertices=said.vertices,
        faces=said.faces,
        uv=uv,
        material_ids=said.material_ids,
        materials=tuple(known.get(name, Material()) for name in said.names),
    )


def parse_obj(path: Path) -> ObjText:
    """Reads one OBJ without its materials; polygons become fans of triangles.

    Raises:
        SourceError: If the file is missing or malformed, holds NaN, or has an index out of range.
    """
    try:
        data = path.read_bytes()
    except OSError as err:
        raise SourceError(f"{path}: mesh cannot be read: {err.strerror}") from err
    return _parse(path, data)


@lru_cache(maxsize=256)
def _parse(path: Path, data: bytes) -> ObjText:
    """Parses the content of a file; kept, as conversion, drafts and checks read each file several times."""
    lines = _split_lines(data)
    vertices = _parse_numbers([line[2:] for line in lines if line[:2] == b"v "], 3, path, "v")
    coords = _parse_numbers([line[3:] for line in lines if line[:3] == b"vt "], 2, path, "vt")
    faces, uv_faces, names, material_ids, owners = _parse_faces(lines, len(vertices), len(coords), path)
    groups, group_ids = _parse_groups(lines, owners)
    for array in (vertices, coords, faces, uv_faces, material_ids, group_ids):
        array.flags.writeable = False
    return ObjText(
        vertices=vertices,
        coords=coords,
        faces=faces,
        uv_faces=uv_faces,
        names=tuple(names),
        material_ids=material_ids,
        libraries=_list_libraries([_name(line[7:]) for line in lines if line[:7] == b"mtllib "], path.parent),
        colors=_parse_colors([line[2:] for line in lines if line[:2] == b"v "]),
        groups=groups,
        group_ids=group_ids,
    )


def forget_files() -> None:
    """Drops what is kept of files that were read."""
    _parse.cache_clear()


def _parse_groups(lines: list[bytes], owners: np.ndarray) -> tuple[tuple[tuple[str, ...], ...], np.ndarray]:
    """Names (group, object) of all groups, and the group of every triangle by the row that it came from."""
    names: list[tuple[str, ...]] = [()]
    starts, rows, inner, outer = [0], 0, "", ""
    for line in lines:
        if line[:2] == b"f ":
            rows += 1
        elif line[:2] in (b"o ", b"g "):
            inner, outer = (_name(line[2:]), outer) if line[:1] == b"g" else ("", _name(line[2:]))
            names.append(tuple(name for name in (inner, outer) if name))
            starts.append(rows)
    return tuple(names), np.searchsorted(np.array(starts), owners, side="right") - 1


def _list_libraries(rows: list[str], folder: Path) -> tuple[str, ...]:
    """Names after ``mtllib``: several in a row, unless the row as a whole is the name of a file."""
    found = []
    for row in rows:
        whole = clean_name(row)
        several = [clean_name(word) for word in row.split()]
        found += [whole] if (folder / whole).is_file() or len(several) < 2 else several
    return tuple(dict.fromkeys(found))


def _parse_colors(rows: list[bytes]) -> np.ndarray | None:
    """Red, green and blue after the positions of all vertices; None if one has none."""
    if not rows or len(rows[0].split()) < 6:
        return None
    try:
        colors = np.array([row.split()[3:6] for row in rows], dtype=np.float64)
    except ValueError:  # rows of other lengths, or no numbers
        return None
    return colors if colors.shape == (len(rows), 3) and ((colors >= 0) & (colors <= 1)).all() else None


def _split_lines(data: bytes) -> list[bytes]:
    if b"\\\n" in data:
        data = data.replace(b"\\\n", b" ")
    if b"\r" in data:
        data = data.replace(b"\r", b"")
    if b"\t" in data:
        data = data.replace(b"\t", b" ")
    return [line.strip() for line in data.split(b"\n")]


def _name(value: bytes) -> str:
    return value.decode(errors="replace").strip()


def _parse_numbers(rows: list[bytes], width: int, path: Path, tag: str) -> np.ndarray:
    """The first ``width`` numbers of every row; each row may append a colour or a weight of its own."""
    if not rows:
        return np.zeros((0, width))
    spaces = {row.count(b" ") for row in rows}
    flat = _parse_flat(rows, path, tag) if len(spaces) == 1 else np.zeros(0)
    if len(flat) != len(rows) * (min(spaces) + 1):  # rows of unequal length, or with double spaces
        words = [row.split() for row in rows]
        short = next((number for number, row in enumerate(words) if len(row) < width), None)
        if short is not None:
            raise SourceError(
                f"{path}: '{tag}' line {short + 1} is {rows[short].decode(errors='replace')!r}, "
                f"expected {width} numbers"
            )
        flat = _parse_flat([b" ".join(row[:width]) for row in words], path, tag)
    values = flat.reshape(len(rows), -1)[:, :width]
    if values.shape[1] < width or not np.isfinite(values).all():
        row = 0 if values.shape[1] < width else int(np.argwhere(~np.isfinite(values).all(axis=1))[0, 0])
        raise SourceError(
            f"{path}: '{tag}' line {row + 1} is {rows[row].decode(errors='replace')!r}, "
            f"expected {width} finite numbers"
        )
    return values


def _parse_flat(rows: list[bytes], path: Path, tag: str) -> np.ndarray:
    """The numbers of all rows, one after the other."""
    with warnings.catch_warnings():
        # For text that is no number, numpy only warns and stops reading.
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(b" ".join(rows), sep=" ", dtype=np.float64)
        except (ValueError, DeprecationWarning) as err:
            raise SourceError(f"{path}: a '{tag}' line holds something that is not a number") from err


def _parse_faces(
    lines: list[bytes], num_vertices: int, num_coords: int, path: Path
) -> tuple[np.ndarray, np.ndarray, list[str], np.ndarray, np.ndarray]:
    """Faces, texture indices (-1: none), material names, and the material and row of every face."""
    rows: list[bytes] = []
    names: list[str] = []
    starts: list[int] = []
    for line in lines:
        if line[:2] == b"f ":
            rows.append(line[2:])
        elif line[:7] == b"usemtl ":
            names.append(_name(line[7:]))
            starts.append(len(rows))
    seen = _count_seen(lines) if any(b"-" in row for row in rows) else np.zeros((len(rows), 2), np.int64)
    corners, owners = _parse_corners(rows, seen, path)
    for column, limit, what in ((0, num_vertices, "vertex"), (1, num_coords, "texture coordinate")):
        bad = (corners[..., column] >= limit) | (corners[..., column] < -column)
        if bad.any():
            face = int(owners[np.argwhere(bad)[0, 0]])
            raise SourceError(
                f"{path}: face {rows[face].decode(errors='replace')!r} names a {what} that is not there, "
                f"allowed are 1..{limit}, or -1 for the last one before the face"
            )
    per_row = np.searchsorted(np.array(starts, dtype=np.int64), np.arange(len(rows)), side="right")
    if not starts or starts[0] > 0:
        names.insert(0, "")
    else:
        per_row = per_row - 1
    return corners[..., 0], corners[..., 1], names, per_row[owners], owners


def _count_seen(lines: list[bytes]) -> np.ndarray:
    """Vertices and texture coordinates [F, 2] above every face, from which relative indices count back."""
    tags = np.array([line[:2] for line in lines])
    above = np.stack([np.cumsum(tags == tag) for tag in (b"v ", b"vt")], axis=-1)
    return above[tags == b"f "]


def _parse_corners(rows: list[bytes], seen: np.ndarray, path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Corners [F, 3, 2] as zero-based (vertex, texture) indices, and the row each face came from.

    Rows of one shape (corners, slashes) are parsed together; there are two or three shapes in a file.

    Args:
        seen: Vertices and texture coordinates above each row [R, 2]; -1 names the last of them.
    """
    groups: dict[tuple[int, int, int], list[int]] = {}
    for index, row in enumerate(rows):
        shape = (row.count(b" "), row.count(b"/"), row.count(b"//"))
        groups.setdefault(shape, []).append(index)
    corners, owners = [np.zeros((0, 3, 2), dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for (_, slashes, doubles), members in groups.items():
        sides = len(rows[members[0]].split())
        if sides < 3 or slashes % sides or doubles not in (0, sides):
            raise SourceError(f"{path}: face {rows[members[0]].decode(errors='replace')!r} is malformed")
        width = 2 if doubles else 1 + slashes // sides
        table = _parse_indices([rows[index] for index in members], sides, width, path)
        coords = np.zeros_like(table[..., 0]) if doubles or width == 1 else table[..., 1]
        polygons = np.stack([table[..., 0], coords], axis=-1)  # N sides 2
        last = seen[members][:, None, :]
        # An index before the first one must not pass for "no texture coordinate" (-1).
        back = np.where(last + polygons < 0, -2, last + polygons)
        polygons = np.where(polygons < 0, back, polygons - 1)
        fan = np.array([[0, k, k + 1] for k in range(1, sides - 1)])
        corners.append(polygons[:, fan].reshape(-1, 3, 2))
        owners.append(np.repeat(members, sides - 2))
    return np.concatenate(corners), np.concatenate(owners)


def _parse_indices(rows: list[bytes], sides: int, width: int, path: Path) -> np.ndarray:
    """Indices [N, sides, width] of rows that all have that shape."""
    text = b" ".join(rows).replace(b"/", b" ")
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            flat = np.fromstring(text, sep=" ", dtype=np.int64)
        except (ValueError, DeprecationWarning) as err:
            raise SourceError(f"{path}: a face holds something that is not an index") from err
    if len(flat) != len(rows) * sides * width:
        raise SourceError(
            f"{path}: {len(rows)} faces of {sides} corners hold {len(flat)} indices, "
            f"expected {len(rows) * sides * width}"
        )
    return flat.reshape(len(rows), sides, width)
