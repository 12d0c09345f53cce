"""Materials of parts and resistance of joints: densities, friction, damping.

The tables are engineering handbook values. Which material a part gets follows from its label and
the object's category (`part_material`); how its joint resists follows from its label, its type and
the mass it moves (`joint_resistance`).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from artigen.shapes.surfaces.finishes import FinishKind
from artigen.types import JointType, PartLabel
from sim_export.package import PackageJoint

MaterialName = Literal[
    "wood_board",
    "steel_sheet",
    "steel",
    "glass",
    "insulating_glass",
    "plastic",
    "rubber",
    "stone",
    "foam_panel",
]
GRAVITY = 9.81


@dataclass(frozen=True, kw_only=True)
class Material:
    """Density in kg/m^3 and coefficients of static and sliding friction against a common surface.

    ``thickest`` (m) is what walls of it are at most; parts drawn or voxelized thicker are hollow.
    """

    density: float
    static_friction: float
    sliding_friction: float
    thickest: float = np.inf


MATERIALS: dict[MaterialName, Material] = {
    "wood_board": Material(density=650.0, static_friction=0.5, sliding_friction=0.4),
    "steel_sheet": Material(density=350.0, static_friction=0.4, sliding_friction=0.3),
    "steel": Material(density=2700.0, static_friction=0.4, sliding_friction=0.3, thickest=0.004),
    "glass": Material(density=2500.0, static_friction=0.5, sliding_friction=0.4, thickest=0.012),
    "insulating_glass": Material(density=800.0, static_friction=0.5, sliding_friction=0.4),
    "plastic": Material(density=1050.0, static_friction=0.4, sliding_friction=0.3, thickest=0.004),
    "rubber": Material(density=1150.0, static_friction=0.9, sliding_friction=0.8),
    "foam_panel": Material(density=125.0, static_friction=0.4, sliding_friction=0.3),
    "stone": Material(density=2700.0, static_friction=0.6, sliding_friction=0.5),
}
"""``steel_sheet`` is a folded or foamed panel: its density is the mean over the panel's thickness, as
`artigen` walls are panels one voxel thick and not solid sheets (7850). ``steel`` is a hollow bar or rack: a
rack of half a square metre weighs five kilograms however thick its voxels are.
``foam_panel`` is the insulation of a refrigerator, five centimetres or more, and its skins: 10 kg a door.
``insulating_glass`` is two panes of four millimetres, and gas between them."""

PLATE_SLENDERNESS = 6.0
"""A piece that is this many times longer both ways than it is thick is a plate."""
THICKEST_GLASS = 0.012
"""Metres; a plate of glass that is thicker has gas in it."""

APPLIANCES: frozenset[str] = frozenset(
    {
        "Refrigerator", "Dishwasher", "Oven", "WashingMachine", "Microwave", "Safe", "CoffeeMachine",
        "Toaster", "ChestFreezer", "Dryer", "FilingCabinet", "Mailbox",
    }
)  # fmt: skip
"""Categories whose carcass and moving parts are sheet metal; every other category is wood board."""

INSULATED: frozenset[str] = frozenset({"Refrigerator", "ChestFreezer"})
"""Appliances whose walls are thick and nearly all foam."""

PLASTIC_CATEGORIES: frozenset[str] = frozenset(
    {"Bottle", "Box", "Laptop", "Printer", "Phone", "Remote", "Suitcase", "Switch", "TrashCan", "Dispenser"}
)
METAL_CATEGORIES: frozenset[str] = frozenset({"Faucet", "Pot", "Cart", "Scissors", "Pliers", "ToolBox"})


def part_material(label: PartLabel, category: str) -> MaterialName:
    """The material of a part: hardware by its label, everything else by the object's category."""
    if label == "wheel":
        return "rubber"
    if label == "knob":
        return "plastic"
    if label == "handle":
        return "steel"
    if category in APPLIANCES:
        walls: MaterialName = "foam_panel" if category in INSULATED else "steel_sheet"
        return "steel" if label in ("tray", "shelf") else walls
    if category in PLASTIC_CATEGORIES:
        return "plastic"
    if category in METAL_CATEGORIES:
        return "steel"
    return "wood_board"


def finish_material(
    kind: FinishKind, label: PartLabel, category: str, size: tuple[float, float, float] | None = None
) -> MaterialName:
    """The material of a piece whose finish is known; lacquer is on board, or on sheet in an appliance.

    Walls of appliances are panels whatever they are covered with; other large pieces of steel are sheet.

    Args:
        kind: What the finish is.
        label: What the part is.
        category: What the object is.
        size: Edges of the piece (m). Pieces are drawn as thick as collision wants them: plates of pans and
            tubs are sheet that was folded or enamelled, and thick panes are insulating glass.
    """
    thickness, middle, _ = sorted(size or (1.0, 1.0, 1.0))
    plate = middle > PLATE_SLENDERNESS * thickness
    if plate and kind == "glass" and thickness > THICKEST_GLASS:
        return "insulating_glass"
    if plate and label in ("tray", "shelf") and kind in ("steel", "rubber", "lacquer"):
        return "steel_sheet"
    folded = plate or label in ("drawer", "door")
    if folded and category in METAL_CATEGORIES and label != "wheel" and kind in ("steel", "lacquer"):
        return "steel_sheet"
    hardware = label in ("handle", "knob", "wheel", "tray", "shelf")
    if kind == "wood":
        return "wood_board"
    if category in APPLIANCES and not hardware and kind in ("lacquer", "steel", "plastic"):
        return part_material(label, category)
    if kind == "lacquer":
        return "steel" if hardware else part_material(label, category)
    if kind == "steel":
        return "steel" if hardware else "steel_sheet"
    return kind


@dataclass(frozen=True, kw_only=True)
class Resistance:
    """What opposes a joint's motion, and what may drive it.

    ``friction`` and ``effort`` are N (sliding) or N m (turning), ``damping`` N s/m or N m s/rad,
    ``velocity`` m/s or rad/s.
    """

    friction: float
    damping: float
    effort: float
    velocity: float


def joint_resistance(label: PartLabel, joint: JointType, mass: float, hold: float) -> Resistance:
    """Friction and damping of a part's joint, from what it is and what it must hold.

    Drawers, trays and other sliding panels resist with 1 N of seals and rollers, doors with 0.3 N m of
    hinges and catch, knobs and lids of bottles with 0.04 N m, buttons with 0.5 N, wheels with
    0.005 N m; all with more where that would not hold them.

    Args:
        label: What the moving part is.
        joint: Its joint's type.
        mass: Mass of everything that moves with it (kg).
        hold: What pulls it open on a floor out of level (N or N m; `sim_export.physics.links.opening_pull`).
    """
    sliding = joint == "prismatic"
    if label == "wheel":
        return Resistance(friction=max(0.005, hold), damping=0.002, effort=20.0, velocity=20.0)
    if label in ("knob", "handle"):
        if sliding:
            return Resistance(friction=max(0.5, hold), damping=1.0, effort=20.0, velocity=0.5)
        return Resistance(friction=max(0.04, hold), damping=0.01, effort=5.0, velocity=6.0)
    if sliding:
        return Resistance(friction=max(1.0, hold), damping=2.0 + 1.0 * mass, effort=100.0, velocity=1.0)
    if joint == "screw":
        return Resistance(friction=max(0.04, hold), damping=0.01, effort=5.0, velocity=6.0)
    return Resistance(friction=max(0.3, hold), damping=0.1 + 0.05 * mass, effort=50.0, velocity=3.0)


def joint_load(joint: PackageJoint, mass: float, lever: float) -> float:
    """What a joint carries under gravity: the moved weight (N), or the moment of that weight (N m).

    Args:
        joint: The joint; sliding ones carry a force, turning ones a moment.
        mass: Mass of everything that moves with the joint (kg).
        lever: Distance of its centre of mass from the joint's origin (m), at least 1 cm is assumed.
    """
    weight = mass * GRAVITY
    return weight if joint.type == "prismatic" else weight * max(lever, 0.01)


PHYSX_COEFFICIENTS = (0.01, 0.05, 0.2, 1.0)
PHYSX_SLIDING_HOLD = (0.0108, 0.0336, 0.0706, 0.173)
PHYSX_TURNING_HOLD = (0.0178, 0.0430, 0.0980, 0.292)
"""Holding force over `joint_load` that SAPIEN 3.0.3 gives these coefficients at 100 Hz with 15 position
iterations (ManiSkill's settings), measured on horizontal drawers of 1 to 20 kg and doors of 0.3 to 1.2 m."""


def physx_friction_coefficient(joint: PackageJoint, mass: float, lever: float) -> float:
    """PhysX's joint friction coefficient for ``joint.friction``, for loaders that set nothing else.

    PhysX takes no force or torque here. Its documented rule, resistance <= coefficient * load, holds for
    neither solver that SAPIEN can use: what a coefficient holds depends on the time step (at 240 Hz twice
    as much as at 100 Hz) and on the iterations. This interpolates measurements at 100 Hz, good to 5 % for
    drawers and a third for doors. `envs.friction` applies the friction itself, exactly.

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
