"""Gaussians as PLY files in the layout of 3D Gaussian Splatting, which common viewers open.

Binary little-endian, one float32 property per number, colours as degree-0 spherical harmonics: position,
an unused normal, ``f_dc`` (``sRGB = 0.5 + f_dc / sqrt(4 pi)``), ``opacity`` as logit, ``scale`` as
natural logarithm, ``rot`` as wxyz (Kerbl et al., 3D Gaussian Splatting, 2023; the reference code's
``save_ply``). Harmonics of higher degree, ``f_rest``, are not written.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from artigen.errors import SourceError, explain
from artigen.splats.colors import HARMONIC, linear_from_srgb, srgb_from_linear
from artigen.types import Gaussians

FIELDS = (
    "x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2",
    "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3",
)  # fmt: skip
"""Properties of a vertex, in the order of the reference code."""
LARGEST_LOGIT = 20.0
"""Logit of opacity 1 in files; its sigmoid rounds to 1 in float32."""
LEAST_LOGIT = -104.0
"""Logit of opacity 0 in files; its sigmoid rounds to 0 in float32."""

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2",
    "ushort": "<u2", "uint16": "<u2", "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4",
    "float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8",
}  # fmt: skip


def encode_ply(gaussians: Gaussians) -> bytes:
    """Content of a PLY file; it has no part ids.

    Raises:
        ValueError: If a scale is not above 0 or an opacity is outside [0, 1]: neither has an encoding.
    """
    scales, opacities = gaussians.scales.astype(np.float64), gaussians.opacities.astype(np.float64)
    if not (scales > 0).all():
        raise ValueError(f"Gaussian scales: the least is {scales.min():.6g}, files hold only those above 0")
    if not ((opacities >= 0) & (opacities <= 1)).all():
        raise ValueError(
            f"Gaussian opacities span {opacities.min():.6g}..{opacities.max():.6g}, allowed is 0 to 1"
        )
    with np.errstate(divide="ignore"):
        logits = np.log(opacities) - np.log1p(-opacities)
    columns = [
        gaussians.means,
        np.zeros_like(gaussians.means),
        (srgb_from_linear(gaussians.colors) - 0.5) / HARMONIC,
        np.clip(logits, LEAST_LOGIT, LARGEST_LOGIT)[:, None],
        np.log(scales),
        gaussians.quats,
    ]
    table = np.concatenate([column.astype("<f4") for column in columns], axis=1)
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(table)}"]
    lines += [*(f"property float {name}" for name in FIELDS), "end_header", ""]
    return "\n".join(lines).encode("ascii") + table.tobytes()


def read_ply(path: Path, *, part_id: int = 0) -> Gaussians:
    """Gaussians of a file that `encode_ply` or the reference code made; all get ``part_id``.

    Quaternions are normalised, as in viewers. Properties that are not among `FIELDS` are skipped.

    Raises:
        SourceError: If the file has another layout, or its colours depend on the viewing direction.
    """
    try:
        data = path.read_bytes()
    except OSError as err:
        raise SourceError(f"{path}: cannot be read: {explain(err)}") from err
    try:
        return decode_ply(data, part_id=part_id)
    except ValueError as err:
        raise SourceError(f"{path}: {err}") from err


def decode_ply(data: bytes, *, part_id: int = 0) -> Gaussians:
    """Gaussians of the content of a file, as in `read_ply`; raises `ValueError`."""
    vertices = _read_vertices(data)
    names = vertices.dtype.names or ()
    absent = [name for name in FIELDS if name not in names and not name.startswith("n")]
    if absent:
        raise ValueError(f"properties {', '.join(absent)} are missing")
    turning = [name for name in names if name.startswith("f_rest_") and vertices[name].any()]
    if turning:
        raise ValueError(
            f"{len(turning)} properties from {turning[0]} on are not zero: colours depend on the viewing "
            "direction, which these Gaussians cannot represent"
        )
    logits = _columns(vertices, "opacity")[:, 0]
    return Gaussians(
        means=_columns(vertices, "x", "y", "z"),
        quats=_normalize(_columns(vertices, "rot_0", "rot_1", "rot_2", "rot_3")),
        scales=np.exp(_columns(vertices, "scale_0", "scale_1", "scale_2")),
        opacities=_sigmoid(logits),
        colors=linear_from_srgb(0.5 + HARMONIC * _columns(vertices, "f_dc_0", "f_dc_1", "f_dc_2")),
        part_ids=np.full(len(vertices), part_id),
    )


def _read_vertices(data: bytes) -> np.ndarray:
    """The vertices as a structured array."""
    end = data.find(b"end_header\n")
    if not data.startswith(b"ply\n") or end < 0:
        raise ValueError("is not a PLY file: it has no header")
    lines = [line.split() for line in data[:end].decode("ascii").splitlines()[1:]]
    lines = [words for words in lines if words and words[0] not in ("comment", "obj_info")]
    if lines[:1] != [["format", "binary_little_endian", "1.0"]]:
        found = " ".join(lines[0][1:]) if lines else "missing"
        raise ValueError(f"its format is {found!r}, expected 'binary_little_endian 1.0'")
    elements = [k for k, words in enumerate(lines) if words[0] == "element"]
    if elements[:1] != [1] or lines[1][1:2] != ["vertex"] or not lines[1][-1].isdigit():
        raise ValueError("its first element is not 'vertex COUNT'")
    count, last = int(lines[1][-1]), elements[1] if len(elements) > 1 else len(lines)
    kinds = []
    for words in lines[2:last]:
        if len(words) != 3 or words[0] != "property" or words[1] not in _TYPES:
            raise ValueError(f"header line {' '.join(words)!r}: expected 'property TYPE NAME'")
        kinds.append((words[2], _TYPES[words[1]]))
    dtype = np.dtype(kinds)
    start = end + len(b"end_header\n")
    if len(data) < start + count * dtype.itemsize:
        raise ValueError(
            f"{len(data) - start} bytes after the header, expected {count * dtype.itemsize} "
            f"for {count} vertices"
        )
    return np.frombuffer(data, dtype=dtype, count=count, offset=start)


def _columns(vertices: np.ndarray, *names: str) -> Float[np.ndarray, "N C"]:
    return np.stack([vertices[name].astype(np.float64) for name in names], axis=1)


def _sigmoid(logits: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N"]:
    """Logistic function without overflow, at full precision near 0."""
    falling = np.exp(-np.abs(logits))
    return np.where(logits < 0, falling, 1.0) / (1.0 + falling)


def _normalize(quats: Float[np.ndarray, "N 4"]) -> Float[np.ndarray, "N 4"]:
    """Unit quaternions; those of unit length within 1e-6 are returned unchanged."""
    lengths = np.linalg.norm(quats, axis=1, keepdims=True)
    if not (lengths > 0).all():
        raise ValueError("rotations of length 0 or NaN, expected quaternions")
    return np.where(np.abs(lengths - 1.0) < 1e-6, quats, quats / lengths)
