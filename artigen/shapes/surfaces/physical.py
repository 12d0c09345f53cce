"""Finishes as physically based materials, in the words of OpenPBR: what light does on a surface.

`describe_finish` names a finish as a shop would (``oak_oiled``, ``steel_brushed``) and says how rough, how
metallic and how clear it is. A finish's gloss selects the roughness between the two ends of its kind.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from artigen.shapes.surfaces.finishes import Color, Finish, FinishKind
from artigen.shapes.surfaces.materials import LACQUERS, METALS, STONES, WOODS, deepen_color


@dataclass(frozen=True, kw_only=True)
class Material:
    """How a surface reflects light, besides its base colour; all but ``ior`` in [0, 1]."""

    name: str = ""
    """What it is; "" where that is unknown, and then roughness and the rest are those of a plain surface."""
    roughness: float = 0.8
    metallic: float = 0.0
    ior: float = 1.5
    """Index of refraction, which determines how much a dielectric mirrors head-on."""
    opacity: float = 1.0
    """Share of light that does not pass."""
    coat: float = 0.0
    """Weight of a clear coat over the base."""
    coat_roughness: float = 0.0


PLAIN = Material()
"""A surface of which nothing is known."""


@dataclass(frozen=True, kw_only=True)
class _Grade:
    """A way to finish a kind of material, up to a gloss; roughness falls linearly from gloss 0 to it."""

    gloss: float
    word: str
    roughness: tuple[float, float]
    """At the end of the previous grade, and at ``gloss``."""
    coat: float = 0.0
    coat_roughness: float = 0.0
    relief: float = 0.0
    """Depth (m) of its pattern, of the slopes that open pores and brushing have."""


_GRADES: dict[FinishKind, tuple[_Grade, ...]] = {
    "wood": (
        _Grade(gloss=0.25, word="oiled", roughness=(0.62, 0.5), relief=2e-4),
        _Grade(gloss=1.0, word="varnished", roughness=(0.5, 0.35), coat=1.0, coat_roughness=0.12),
    ),
    "lacquer": (
        _Grade(gloss=0.15, word="matt", roughness=(0.75, 0.5)),
        _Grade(gloss=0.4, word="satin", roughness=(0.5, 0.28)),
        _Grade(gloss=1.0, word="gloss", roughness=(0.28, 0.12), coat=1.0, coat_roughness=0.04),
    ),
    "steel": (
        _Grade(gloss=0.55, word="brushed", roughness=(0.42, 0.26), relief=3e-4),
        _Grade(gloss=0.7, word="polished", roughness=(0.26, 0.12)),
        _Grade(gloss=1.0, word="mirror", roughness=(0.12, 0.04)),
    ),
    "plastic": (
        _Grade(gloss=0.3, word="matt", roughness=(0.65, 0.4)),
        _Grade(gloss=1.0, word="gloss", roughness=(0.4, 0.1)),
    ),
    "glass": (
        _Grade(gloss=0.5, word="frosted", roughness=(0.3, 0.08)),
        _Grade(gloss=1.0, word="clear", roughness=(0.08, 0.02)),
    ),
    "rubber": (
        _Grade(gloss=0.1, word="matt", roughness=(0.95, 0.85)),
        _Grade(gloss=1.0, word="smooth", roughness=(0.85, 0.3)),
    ),
    "stone": (
        _Grade(gloss=0.35, word="honed", roughness=(0.6, 0.38)),
        _Grade(gloss=1.0, word="glazed", roughness=(0.3, 0.1), coat=1.0, coat_roughness=0.05),
    ),
}  # fmt: skip
"""Estimates, not measurements: judged by eye against pictures of catalogues, oiled oak 0.55, satin lacquer
0.3 to 0.5, brushed steel 0.3, chrome 0.05, mouldings 0.4, rubber 0.9. Bare metal has metallic 1, all else
0."""
_IOR: dict[FinishKind, float] = {
    "wood": 1.53, "lacquer": 1.5, "steel": 2.76, "plastic": 1.53, "glass": 1.52, "rubber": 1.52, "stone": 1.5,
}  # fmt: skip
"""Handbook values: cellulose, alkyd resin, stainless steel, ABS, float glass, natural rubber, glaze."""
_NAMES: dict[FinishKind, Mapping[str, Color]] = {
    "wood": {name: color for name, (color, _) in WOODS.items()},
    "lacquer": LACQUERS,
    "steel": {name: color for name, (color, _) in METALS.items()},
    "stone": {name: color for name, (color, _) in STONES.items()},
}
"""Names by colour; plastics, glass and rubber have those of lacquers, and say what they are."""
_VARNISHED = {name: deepen_color(color) for name, (color, _) in WOODS.items()}


def describe_finish(finish: Finish) -> Material:
    """The material of a finish; equal finishes give equal materials."""
    grade = _find_grade(finish)
    below = max((one.gloss for one in _GRADES[finish.kind] if one.gloss < grade.gloss), default=0.0)
    share = float(np.clip((finish.gloss - below) / (grade.gloss - below), 0.0, 1.0))
    rough, smooth = grade.roughness
    names = _VARNISHED if grade.word == "varnished" else _NAMES.get(finish.kind, LACQUERS)
    color = _nearest(names, finish.color)
    what = {"wood": "", "steel": "", "stone": ""}.get(finish.kind, f"{finish.kind}_")
    return Material(
        name=f"{what}{color}_{grade.word}",
        roughness=round(rough + share * (smooth - rough), 4),
        metallic=1.0 if finish.kind == "steel" else 0.0,
        ior=_IOR[finish.kind],
        opacity=finish.opacity,
        coat=grade.coat,
        coat_roughness=grade.coat_roughness,
    )


def find_relief(finish: Finish) -> float:
    """Depth (m) between the highest and lowest points of a finish's pattern; 0 for a smooth one."""
    return _find_grade(finish).relief


def mirrored_head_on(material: Material) -> float:
    """Share of light that a dielectric mirrors head-on (Fresnel)."""
    return ((material.ior - 1.0) / (material.ior + 1.0)) ** 2


def _find_grade(finish: Finish) -> _Grade:
    grades = _GRADES[finish.kind]
    return next((one for one in grades if finish.gloss <= one.gloss), grades[-1])


def _nearest(names: Mapping[str, Color], color: Color) -> str:
    return min(names, key=lambda name: float(np.abs(np.subtract(names[name], color)).sum()))
