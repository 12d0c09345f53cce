"""MTL files: the materials of OBJ files. They are untrusted, as those are."""

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from artigen.errors import SourceError
from artigen.files.inside import lies_inside

NO_MATERIAL = (0.7, 0.7, 0.7)
_PHYSICAL = {"Pr": "roughness", "Pm": "metallic", "Pc": "coat", "Pcr": "coat_roughness"}
"""Words of the extension of MTL for physically based rendering."""
_NUMBERS = {1: "a number", 3: "three numbers"}


class MtlMaterial(NamedTuple):
    """A material as written in an MTL file; its image is named relative to the file, "" for none."""

    color: tuple[float, float, float] = NO_MATERIAL
    image: str = ""
    opacity: float = 1.0
    """1 hides what is behind, 0 hides nothing."""
    roughness: float = 0.8
    metallic: float = 0.0
    ior: float = 1.5
    coat: float = 0.0
    coat_roughness: float = 0.0
    normal_map: str = ""
    """Image of normals, named as ``image``."""


@dataclass(frozen=True, kw_only=True)
class Material:
    """Diffuse colour in [0, 1] and, where there is one, the image that replaces it.

    ``missing`` is the name of an image that the file refers to and that does not exist.
    """

    color: tuple[float, float, float] = NO_MATERIAL
    image: Path | None = None
    missing: str = ""


def clean_name(value: str) -> str:
    """The path that follows ``mtllib`` or ``map_Kd``, without options and with ``/`` for ``\\``."""
    value = value.strip()
    return (value.split()[-1] if value.startswith("-") else value).replace("\\", "/")


def read_mtl(path: Path, root: Path) -> dict[str, Material]:
    """Reads diffuse colours and images of the materials of one file.

    An image outside of ``root``, as absolute paths of the author's machine are, counts as missing.

    Raises:
        SourceError: If a colour is not three numbers.
    """
    known = {}
    for name, said in parse_mtl(path).items():
        color, image = said.color, said.image
        found = path.parent / image if image and lies_inside(root, path.parent, image) else None
        found = found if found is not None and found.is_file() else None
        known[name] = Material(color=color, image=found, missing="" if found else image)
    return known


def parse_mtl(path: Path) -> dict[str, MtlMaterial]:
    """The materials of one file: colour, image, opacity, and what the physically based extension says.

    The opacity is ``d``, or else one minus ``Tr``, which some programs write the other way round.

    Raises:
        SourceError: If the file cannot be read, or a colour or opacity is not made of finite numbers.
    """
    try:
        lines = path.read_text(errors="replace").splitlines()
    except OSError as err:
        raise SourceError(f"{path}: cannot be read ({err.strerror})") from err
    known: dict[str, MtlMaterial] = {}
    dissolved = set[str]()
    name = ""
    for line in lines:
        tag, _, value = line.strip().partition(" ")
        value = value.strip()
        material = known.get(name, MtlMaterial())
        if tag == "newmtl":
            name, known[value] = value, MtlMaterial()
        elif tag == "Kd":
            red, green, blue = _parse_shares(value, 3, f"{path}: material {name!r} has Kd")
            known[name] = material._replace(color=(red, green, blue))
        elif tag == "map_Kd" and value:
            known[name] = material._replace(image=clean_name(value))
        elif tag == "norm" and value:
            known[name] = material._replace(normal_map=clean_name(value))
        elif tag in _PHYSICAL:
            (share,) = _parse_shares(value, 1, f"{path}: material {name!r} has {tag}")
            known[name] = material._replace(**{_PHYSICAL[tag]: share})
        elif tag == "Ni":
            (ior,) = _parse_values(value, 1, f"{path}: material {name!r} has Ni")
            known[name] = material._replace(ior=ior)
        elif tag in ("d", "Tr"):
            (share,) = _parse_shares(value.removeprefix("-halo"), 1, f"{path}: material {name!r} has {tag}")
            if tag == "d":
                dissolved.add(name)
                known[name] = material._replace(opacity=share)
            elif name not in dissolved:
                known[name] = material._replace(opacity=1.0 - share)
    return known


def _parse_shares(value: str, count: int, what: str) -> list[float]:
    """`_parse_values`, clipped to [0, 1]."""
    return [min(max(share, 0.0), 1.0) for share in _parse_values(value, count, what)]


def _parse_values(value: str, count: int, what: str) -> list[float]:
    """The first numbers of a line; ``what`` begins the error message."""
    try:
        values = [float(word) for word in value.split()[:count]]
    except ValueError as err:
        raise SourceError(f"{what} {value!r}, expected {_NUMBERS[count]}") from err
    if len(values) != count:
        raise SourceError(f"{what} {value!r}, expected {_NUMBERS[count]}")
    if not np.isfinite(values).all():
        raise SourceError(f"{what} {value!r}, expected finite numbers")
    return values
