"""How objects of a category are made, where what is drawn does not say it.

Walls are drawn as thick as collision wants them, bodies are drawn solid where nobody sees inside, and motors,
compressors and batteries are not drawn at all. A `Make` says what the parts really weigh; its numbers are
engineering estimates that `benchmarks/catalogue_masses.py` holds against catalogues.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from sim_export.package import Inertial
from sim_export.physics.materials import MATERIALS, MaterialName


@dataclass(frozen=True, kw_only=True)
class Make:
    """What differs from `MATERIALS` in objects of a category, and what is hidden in their bases."""

    density: Mapping[MaterialName, float] = field(default_factory=dict)
    """Of walls as they are drawn (kg/m^3)."""
    wall: Mapping[MaterialName, float] = field(default_factory=dict)
    """Thickness of real walls (m); thicker ones weigh what walls of this thickness do."""
    hidden: float = 0.0
    """Mass in the base that is not drawn (kg)."""
    filled: float = 0.0
    """The same, by the volume of the box around the base (kg/m^3)."""

    def wall_density(self, material: MaterialName, thickness: float | None = None) -> float:
        """Mean density (kg/m^3) of drawn walls; of real ones, where no thickness (m) is given."""
        own = self.density.get(material, MATERIALS[material].density)
        return own if thickness is None else own * min(1.0, self.wall.get(material, thickness) / thickness)

    def fill_base(self, drawn: Inertial, box: Float[np.ndarray, "2 3"]) -> Inertial:
        """The mass properties of a base within a box (m) with what is hidden in it, spread as the base is."""
        hidden = self.hidden + self.filled * float(np.prod(box[1] - box[0]))
        share = 1.0 + hidden / drawn.mass
        return replace(drawn, mass=share * drawn.mass, inertia=share * drawn.inertia)


HARDWARE = frozenset({"handle", "knob", "wheel"})
"""Labels of parts that weigh what their material does, whatever they belong to."""
PLAIN = Make()
MAKES: dict[str, Make] = {
    # Compressors; counterweights of concrete and motors; fans; pumps; transformers.
    "Refrigerator": Make(hidden=6.0, wall={"glass": 0.004}),
    "ChestFreezer": Make(hidden=6.0),
    "WashingMachine": Make(hidden=5.0, filled=100.0),
    "Dryer": Make(hidden=4.0, filled=30.0),
    "Dishwasher": Make(hidden=2.0, filled=25.0),
    "Microwave": Make(hidden=4.0, wall={"glass": 0.004}),
    # Thin sheet, and sheet that is thicker than that of appliances.
    "Toaster": Make(density={"steel_sheet": 210.0}),
    "FilingCabinet": Make(density={"steel_sheet": 480.0}),
    # Counterweights keep them from tipping with a drawer open (EN 14073).
    "FilingCabinet pedestal": Make(density={"steel_sheet": 480.0}, hidden=5.0),
    "FilingCabinet lateral": Make(density={"steel_sheet": 480.0}, hidden=8.0),
    "ToolBox": Make(density={"steel_sheet": 1000.0}, wall={"plastic": 0.003}),
    "Cart": Make(density={"steel_sheet": 650.0}),
    "Cart kitchen": Make(density={"steel": 480.0, "steel_sheet": 580.0}),  # painted wood
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
    "DeskLamp": Make(wall={"plastic": 0.0015}),
    "Toilet": Make(wall={"stone": 0.011}),
    # Particle board on thin backs, light tops, tubular board, softwood.
    "Wardrobe": Make(density={"wood_board": 580.0}),
    "Table": Make(density={"wood_board": 580.0}),
    "Door": Make(density={"wood_board": 480.0}),
    "Door flush": Make(density={"wood_board": 400.0}),
    "Box chest": Make(density={"wood_board": 480.0, "plastic": 480.0}),
    "Box trunk": Make(density={"wood_board": 480.0, "plastic": 480.0}),
}
"""By category, or by category and style."""


def find_make(category: str, style: str | None = None) -> Make:
    """The make of a category, or of one of its styles."""
    return MAKES.get(f"{category} {style}", MAKES.get(category, PLAIN))
