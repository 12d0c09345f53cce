"""Materials of parts and resistance of joints: densities, friction, damping.

The tables contain handbook values. The material of a part follows from its label and the object's category
(`part_material`). The resistance of a joint follows from its label, its type and the mass it moves
(`joint_resistance`).
"""

from dataclasses import dataclass

import numpy as np

from artigen.kind import MaterialName, find_category
from artigen.shapes.surfaces.finishes import FinishKind
from artigen.types import Joint, JointType, PartLabel

GRAVITY = 9.81
ROLLING = 0.02
"""Resistance of a castor with a rubber tyre on a hard floor, over its load."""
MAX_DRAG = 12.0
"""Damping (N s/m) of sliding panels, at most: rollers of a heavy drawer hardly brake it."""
PLATE_SLENDERNESS = 6.0
"""Smaller in-plane extent over thickness from which a piece is a plate."""
THICKEST_GLASS = 0.012
"""Thickness (m) above which a plate of glass is insulating glass."""
PANELS: dict[str | None, MaterialName] = {"sheet": "steel_sheet", "foam": "foam_panel"}
"""Material of carcass and doors by build."""
PHYSX_COEFFICIENTS = (0.01, 0.05, 0.2, 1.0)
PHYSX_SLIDING_HOLD = (0.0108, 0.0336, 0.0706, 0.173)
PHYSX_TURNING_HOLD = (0.0178, 0.0430, 0.0980, 0.292)
"""Holding force over `joint_load` for these coefficients in SAPIEN 3.0.3 at 100 Hz with 15 position
iterations (ManiSkill's settings), measured on horizontal drawers of 1 to 20 kg and doors of 0.3 to 1.2 m."""


@dataclass(frozen=True, kw_only=True)
class Material:
    """Density of the solid in kg/m^3, and coefficients of static and sliding friction on a common surface.

    ``thickest`` (m) is the largest wall thickness in practice; thicker parts are hollow. ``filled`` is the
    share of a drawn piece that the solid fills, where pieces are drawn thicker than they are; air fills the
    rest.
    """

    density: float
    static_friction: float
    sliding_friction: float
    thickest: float = np.inf
    filled: float = 1.0

    @property
    def bulk(self) -> float:
        """Mean density of a drawn piece in kg/m^3."""
        return self.density * self.filled


STEEL = 7850.0
"""Density of mild steel in kg/m^3."""
MATERIALS: dict[MaterialName, Material] = {
    "wood_board": Material(density=650.0, static_friction=0.5, sliding_friction=0.4),
    "steel_sheet": Material(density=STEEL, static_friction=0.4, sliding_friction=0.3, filled=350.0 / STEEL),
    "steel": Material(
        density=STEEL, static_friction=0.4, sliding_friction=0.3, thickest=0.004, filled=2700.0 / STEEL
    ),
    "glass": Material(density=2500.0, static_friction=0.5, sliding_friction=0.4, thickest=0.012),
    "insulating_glass": Material(density=2500.0, static_friction=0.5, sliding_friction=0.4, filled=0.32),
    "plastic": Material(density=1050.0, static_friction=0.4, sliding_friction=0.3, thickest=0.004),
    "rubber": Material(density=1150.0, static_friction=0.9, sliding_friction=0.8),
    "foam_panel": Material(density=125.0, static_friction=0.4, sliding_friction=0.3),
    "stone": Material(density=2700.0, static_friction=0.6, sliding_friction=0.5),
}
"""``steel_sheet`` is a folded or foamed panel: a millimetre of steel on 22 drawn ones, because walls are
panels one voxel thick. ``steel`` is a hollow bar or rack, of which a third is steel: a rack of half a
square metre weighs five kilograms regardless of the thickness of its voxels. ``foam_panel`` is the insulation
of a refrigerator, at least five centimetres thick, with its skins: 10 kg a door. ``insulating_glass`` is two
panes of four millimetres with gas between them."""


def part_material(label: PartLabel, category: str) -> MaterialName:
    """Material of a part: by label for hardware, else by the object's category."""
    if label == "wheel":
        return "rubber"
    if label == "knob":
        return "plastic"
    if label == "handle":
        return "steel"
    known = find_category(category)
    build = None if known is None else known.build
    if build in PANELS:
        return "steel" if label in ("tray", "shelf") else PANELS[build]
    if build == "plastic":
        return "plastic"
    if build == "metal":
        return "steel"
    return "stone" if label == "base" and build == "weighted" else "wood_board"


def finish_material(
    kind: FinishKind, label: PartLabel, category: str, size: tuple[float, float, float] | None = None
) -> MaterialName:
    """Material of a piece with a known finish; lacquer implies board, or sheet metal in an appliance.

    Walls of appliances are panels regardless of their finish; other large pieces of steel are sheet.

    Args:
        size: Edges of the piece (m). Pieces are drawn as thick as collision requires: plates of pans and tubs
            are folded or enamelled sheet, and thick panes are insulating glass.
    """
    thickness, middle, _ = sorted(size or (1.0, 1.0, 1.0))
    plate = middle > PLATE_SLENDERNESS * thickness
    if plate and kind == "glass" and thickness > THICKEST_GLASS:
        return "insulating_glass"
    if plate and label in ("tray", "shelf") and kind in ("steel", "rubber", "lacquer"):
        return "steel_sheet"
    folded = plate or label in ("drawer", "door")
    known = find_category(category)
    build = None if known is None else known.build
    if folded and build == "metal" and label != "wheel" and kind in ("steel", "lacquer"):
        return "steel_sheet"
    hardware = label in ("handle", "knob", "wheel", "tray", "shelf")
    if kind == "wood":
        return "wood_board"
    if build in PANELS and not hardware and kind in ("lacquer", "steel", "plastic"):
        return part_material(label, category)
    if kind == "lacquer":
        return "steel" if hardware else part_material(label, category)
    if kind == "steel":
        return "steel" if hardware else "steel_sheet"
    return kind


@dataclass(frozen=True, kw_only=True)
class Resistance:
    """Resistance and drive limits of a joint.

    ``friction`` and ``effort`` are N (sliding) or N m (turning), ``damping`` N s/m or N m s/rad, ``velocity``
    m/s or rad/s.
    """

    friction: float
    damping: float
    effort: float
    velocity: float


def joint_resistance(label: PartLabel, joint: JointType, mass: float, hold: float) -> Resistance:
    """Friction and damping of a part's joint, from its label and its holding load.

    Drawers, trays and other sliding panels resist with 1 N of seals and rollers, doors with 0.3 N m of hinges
    and catch, knobs and lids of bottles with 0.04 N m, buttons with 0.5 N, and wheels with 0.005 N m; more if
    needed to hold the part, or to roll under its load.

    Args:
        mass: Mass of everything that moves with it (kg).
        hold: Load that pulls it open on a sloping floor (N or N m; `opening_pull` in `resistance.py`).
    """
    sliding = joint == "prismatic"
    if label == "wheel":
        return Resistance(friction=max(0.005, hold), damping=0.002, effort=20.0, velocity=20.0)
    if label in ("knob", "handle"):
        if sliding:
            return Resistance(friction=max(0.5, hold), damping=1.0, effort=20.0, velocity=0.5)
        return Resistance(friction=max(0.04, hold), damping=0.01, effort=5.0, velocity=6.0)
    if sliding:
        drag = min(2.0 + mass, MAX_DRAG)
        return Resistance(friction=max(1.0, hold), damping=drag, effort=100.0, velocity=1.0)
    if joint == "screw":
        return Resistance(friction=max(0.04, hold), damping=0.01, effort=5.0, velocity=6.0)
    return Resistance(friction=max(0.3, hold), damping=0.1 + 0.05 * mass, effort=50.0, velocity=3.0)


def rolling_resistance(mass: float, radius: float) -> float:
    """Torque (N m) that turns a wheel of a radius (m) which carries a mass (kg) on a hard floor."""
    return ROLLING * mass * GRAVITY * radius


def joint_load(joint: Joint, mass: float, lever: float) -> float:
    """Gravity load of a joint: the moved weight (N), or the moment of that weight (N m).

    Args:
        joint: The joint; sliding ones carry a force, turning ones a moment.
        lever: Distance of its centre of mass from the joint's origin (m); at least 1 cm is assumed.
    """
    weight = mass * GRAVITY
    return weight if joint.type == "prismatic" else weight * max(lever, 0.01)


def physx_friction_coefficient(joint: Joint, mass: float, lever: float) -> float:
    """PhysX joint friction coefficient that approximates ``joint.friction``, for loaders that set nothing
    else.

    PhysX takes no force or torque here. Its documented rule, resistance <= coefficient * load, holds for
    neither solver that SAPIEN can use: the holding force depends on the time step (at 240 Hz twice as much as
    at 100 Hz) and on the iterations. This interpolates measurements at 100 Hz, accurate to 5 % for drawers
    and to a third for doors. `envs.sim.friction` applies the friction itself, exactly.

    Raises:
        ValueError: If ``mass`` is not positive.
    """
    if not mass > 0.0:
        raise ValueError(f"joint {joint.name!r} moves {mass} kg, expected > 0")
    hold = joint.friction / joint_load(joint, mass, lever)
    if hold <= 0.0:
        return 0.0
    table = PHYSX_SLIDING_HOLD if joint.type == "prismatic" else PHYSX_TURNING_HOLD
    x, y = np.log(table), np.log(PHYSX_COEFFICIENTS)
    at = int(np.clip(np.searchsorted(x, np.log(hold)) - 1, 0, len(x) - 2))
    slope = (y[at + 1] - y[at]) / (x[at + 1] - x[at])
    return float(np.exp(y[at] + slope * (np.log(hold) - x[at])))
