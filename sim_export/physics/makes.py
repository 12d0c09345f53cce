"""Real wall thickness, density and hidden mass of objects by category.

Walls are drawn as thick as collision requires, bodies are solid where the inside is invisible, and motors,
compressors and batteries are not drawn. A `Make` corrects the masses; its numbers are engineering estimates,
which `benchmarks/catalogue_masses.py` compares with catalogues.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from artigen.types import PartLabel
from sim_export.package import Inertial
from sim_export.physics.materials import MATERIALS, MaterialName


@dataclass(frozen=True, kw_only=True)
class Make:
    """Differences from `MATERIALS` in objects of a category, and hidden mass of their bases."""

    density: Mapping[MaterialName, float] = field(default_factory=dict)
    """Mean density of walls as drawn (kg/m^3), in place of `Material.bulk`."""
    wall: Mapping[MaterialName, float] = field(default_factory=dict)
    """Real wall thickness (m); thicker drawn walls have the mass of this thickness."""
    hidden: float = 0.0
    """Hidden mass in the base (kg)."""
    filled: float = 0.0
    """Hidden mass by the volume of the box around the base (kg/m^3)."""

    def wall_density(self, material: MaterialName, thickness: float | None = None) -> float:
        """Mean density (kg/m^3) of walls drawn with a thickness (m); without one, that of real walls."""
        own = self.density.get(material, MATERIALS[material].bulk)
        return own if thickness is None else own * min(1.0, self.wall.get(material, thickness) / thickness)

    def fill_base(self, drawn: Inertial, box: Float[np.ndarray, "2 3"]) -> Inertial:
        """Mass properties of a base in a box (m) plus its hidden mass, distributed like the base."""
        hidden = self.hidden + self.filled * float(np.prod(box[1] - box[0]))
        share = 1.0 + hidden / drawn.mass
        return replace(drawn, mass=share * drawn.mass, inertia=share * drawn.inertia)


PLAIN = Make()
MAKES: dict[str, Make] = {
    # Compressors; counterweights of concrete and motors; fans; pumps; transformers.
    "Refrigerator": Make(hidden=6.0, wall={"glass": 0.004}),
    "ChestFreezer": Make(hidden=6.0),
    "WashingMachine": Make(hidden=5.0, filled=100.0),
    "Dryer": Make(hidden=4.0, filled=30.0),
    "Dishwasher": Make(hidden=2.0, filled=25.0),
    "Microwave": Make(hidden=4.0, wall={"glass": 0.004}),
    # Sheet that is thinner or thicker than that of appliances.
    "Toaster": Make(density={"steel_sheet": 210.0}),
    "FilingCabinet": Make(density={"steel_sheet": 480.0}),
    # Counterweights keep them from tipping with a drawer open (EN 14073).
    "FilingCabinet pedestal": Make(density={"steel_sheet": 480.0}, hidden=5.0),
    "FilingCabinet lateral": Make(density={"steel_sheet": 480.0}, hidden=8.0),
    "ToolBox": Make(density={"steel_sheet": 1000.0}, wall={"plastic": 0.003}),
    "Cart": Make(density={"steel_sheet": 650.0}),
    "Cart kitchen": Make(density={"steel": 480.0, "steel_sheet": 480.0, "wood_board": 560.0}),  # softwood
    # Tubes and a thin tray; the tyre is full of air.
    "Cart wheelbarrow": Make(density={"steel_sheet": 800.0, "steel": 400.0, "rubber": 350.0}),
    "Pot": Make(density={"steel_sheet": 1100.0}),
    "BreadBox": Make(density={"steel_sheet": 500.0}),
    # Walls of a safe are plates around concrete.
    "Safe": Make(density={"steel_sheet": 1150.0}),
    # Mouldings, cardboard, vitreous china.
    "TrashCan": Make(density={"steel_sheet": 250.0}, wall={"plastic": 0.004}),
    "Suitcase": Make(wall={"plastic": 0.0022}),
    "Box": Make(density={"glass": 1050.0}, wall={"plastic": 0.0022, "glass": 0.0022}),
    "Box carton": Make(density={"plastic": 85.0}),
    "Printer": Make(wall={"plastic": 0.0025}, filled=110.0),
    "Laptop": Make(wall={"plastic": 0.0015}, filled=500.0),
    # Shades of plastic are as heavy as a millimetre of aluminium, feet are concrete in a cover.
    "DeskLamp": Make(density={"stone": 2000.0}, wall={"plastic": 0.0025}),
    "Toilet": Make(wall={"stone": 0.011}),
    # Particle board on thin backs, light tops, tubular board, softwood.
    "Wardrobe": Make(density={"wood_board": 580.0}, wall={"wood_board": 0.02}),
    "Dresser": Make(wall={"wood_board": 0.02}),
    "Table": Make(density={"wood_board": 580.0}),
    "Door": Make(density={"wood_board": 480.0}),
    "Door flush": Make(density={"wood_board": 400.0}),
    "Door service": Make(density={"wood_board": 300.0}),  # light boards on a honeycomb
    "Box chest": Make(density={"wood_board": 480.0, "plastic": 480.0}),
    "Box trunk": Make(density={"wood_board": 480.0, "plastic": 480.0}),
}
"""Makes by category, or by category and style."""


def find_make(category: str, style: str | None = None) -> Make:
    """The make of a category, or of one of its styles."""
    return MAKES.get(f"{category} {style}", MAKES.get(category, PLAIN))


def is_hardware(label: PartLabel, *, moves: bool) -> bool:
    """Whether a part has the density of its material in every category.

    A handle on a joint of its own is no fitting but a body that is taken by hand: the arm or shade of a lamp.
    """
    return label == "knob" or (label == "handle" and not moves)
