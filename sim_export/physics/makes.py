"""Mass of walls and hidden mass of objects, from the makes of their kinds.

Walls are drawn as thick as collision requires, bodies are solid where the inside is invisible, and motors,
compressors and batteries are not drawn. A `Make` corrects the masses; its numbers are engineering estimates,
which `benchmarks/catalogue_masses.py` compares with catalogues.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.kind import PLAIN, Make, MaterialName, find_kind
from artigen.types import PartLabel
from sim_export.package import Inertial
from sim_export.physics.materials import MATERIALS


def find_make(category: str, style: str | None = None) -> Make:
    """The make of a category, or of one of its styles."""
    kind = find_kind(category)
    return PLAIN if kind is None else kind.find_make(style)


def wall_density(make: Make, material: MaterialName, thickness: float | None = None) -> float:
    """Mean density (kg/m^3) of walls drawn with a thickness (m); without one, that of real walls."""
    own = make.density.get(material, MATERIALS[material].bulk)
    return own if thickness is None else own * min(1.0, make.wall.get(material, thickness) / thickness)


def fill_base(make: Make, drawn: Inertial, box: Float[np.ndarray, "2 3"]) -> Inertial:
    """Mass properties of a base in a box (m) plus its hidden mass, distributed like the base."""
    hidden = make.hidden + make.filled * float(np.prod(box[1] - box[0]))
    share = 1.0 + hidden / drawn.mass
    return replace(drawn, mass=share * drawn.mass, inertia=share * drawn.inertia)


def is_hardware(label: PartLabel, *, moves: bool) -> bool:
    """Whether a part has the density of its material in every category.

    A handle on a joint of its own is no fitting but a body that is taken by hand: the arm or shade of a lamp.
    """
    return label == "knob" or (label == "handle" and not moves)
