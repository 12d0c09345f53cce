"""Doors of appliances: insulated leaves and leaves with a window, and the handles that suit them."""

import numpy as np

from artigen.shapes.appliances.cavity import SIDES, build_frame
from artigen.shapes.appliances.racks import SLENDER
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.fittings.handles import HandleDesign, HandleKind, make_handle
from artigen.shapes.fittings.hardware import Edge, Panel
from artigen.shapes.primitives import Primitive, block, line
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart

INSET, BULGE = 0.036, 0.012
"""Distance (m) of the liner of an insulated leaf from its edges, and how far it stands out behind."""


def build_leaf(
    panel: Panel,
    opening: tuple[Range, Range],
    finish: str,
    lining: str,
    *,
    bevel: float = 0.0,
    niche: tuple[Range, Range] | None = None,
) -> tuple[Primitive, ...]:
    """An insulated leaf that fills its panel: outer skin, gasket and a liner that enters the opening.

    Gasket and liner extend through the skin, because separate thin layers would be too oblong for engines.

    Args:
        panel: Front, including the gasket in its thickness.
        opening: Free ranges of y and z behind it.
        finish: Role of the finish of the outside.
        lining: Role of the finish of the rear side.
        bevel: Chamfer of the skin's edges (m).
        niche: (y, z) ranges of a dispenser: a dark recess with a spout and a drip tray.
    """
    seal, inset = 0.009, 0.006
    y, z = narrow(panel.y, INSET), narrow(panel.z, INSET)
    free_y, free_z = narrow(opening[0], 0.014), narrow(opening[1], 0.014)
    y, z = (max(y[0], free_y[0]), min(y[1], free_y[1])), (max(z[0], free_z[0]), min(z[1], free_z[1]))
    core = panel.x + (0.3 if niche is None else 0.68) * panel.thickness
    gasket = narrow(panel.y, inset), narrow(panel.z, inset)
    liner = block((core, panel.back + BULGE), y, z, lining)
    skin = panel.back - seal
    if niche is None:
        rubber = block((core, panel.back), gasket[0], gasket[1], "rubber")
        slab = block((panel.x, skin), panel.y, panel.z, finish, bevel)
        return slab, line(rubber, "plastic", SIDES["front"]), liner
    start = panel.x + 0.35 * panel.thickness
    rubbers = build_frame((start, panel.back), gasket, niche, "rubber")
    boards = build_frame((panel.x, skin), (panel.y, panel.z), niche, finish)
    rubbers = tuple(line(rubber, "plastic", SIDES["front"]) for rubber in rubbers)
    return (*boards, *rubbers, liner, *_build_recess((panel.x, core), *niche))


def build_window_leaf(
    panel: Panel,
    window: tuple[Range, Range],
    finish: str,
    lining: str,
    *,
    glass: str = "glass",
    border: float = 0.0,
) -> tuple[Primitive, ...]:
    """A leaf with a window: four boards, and glass slightly behind the face, printed black over ``border``
    metres from its edge."""
    frame = build_frame((panel.x, panel.back), (panel.y, panel.z), window, finish)
    if border:
        inner = narrow(window[0], border), narrow(window[1], border)
        frame += build_frame((panel.x + 0.001, panel.back), window, inner, "panel")
        window = inner
    size = max(window[0][1] - window[0][0], window[1][1] - window[1][0])
    thickness = max(0.006, size / SLENDER)
    depth = min(0.003, (panel.thickness - thickness) / 2)
    pane = block((panel.x + depth, panel.x + depth + thickness), window[0], window[1], glass)
    return (*(line(board, lining, SIDES["front"]) for board in frame), pane)


def draw_border(rng: np.random.Generator, width: Range) -> float:
    """Width (m) of the black print around a window, 0 for none; other draws do not depend on it."""
    (own,) = rng.spawn(1)
    return choose(own, *width) if own.random() < 0.4 else 0.0


def draw_grip(
    rng: np.random.Generator, kinds: tuple[HandleKind, ...], *, length: float, longest: float
) -> HandleDesign:
    """Draws a handle for an appliance whose longest edge is ``longest`` metres."""
    kind = choose_one(rng, kinds)
    thickness = float(np.clip(rng.uniform(0.016, 0.021) * longest, 0.012, 0.032))
    return HandleDesign(kind=kind, length=max(length, 0.1), thickness=thickness)


def mount_grip(
    panel: Panel,
    design: HandleDesign,
    *,
    parent: str,
    edge: Edge | None,
    inset: float,
    level: float | None = None,
) -> ShapePart:
    """A handle opposite the hinged ``edge`` of a panel, or along the top of a sliding one (None).

    It is ``inset`` metres from the rim, centred or at height ``level``.
    """
    y, z = panel.center
    half = design.thickness / 2 + inset
    upright = edge in ("left", "right")
    if upright:
        at = (panel.y[0] + half if edge == "left" else panel.y[1] - half, z if level is None else level)
    else:
        at = (y, panel.z[1] - half)
    return make_handle(panel, design, name=f"{parent}_handle", parent=parent, upright=upright, at=at)


def _build_recess(x: Range, y: Range, z: Range) -> tuple[Primitive, ...]:
    """Rear plate, head with a spout, and drip tray of a dispenser that fills a hole."""
    back = x[1] - 0.002
    middle, head = (y[0] + y[1]) / 2, z[1] - 0.35 * (z[1] - z[0])
    return (
        block((back, back + 0.008), y, z, "panel"),
        block((x[0] - 0.002, back), y, (head, z[1]), "panel"),
        block((x[0] + 0.012, back), around(middle, 0.02), (head - 0.03, head), "plastic"),
        block((x[0] + 0.003, back), y, (z[0], z[0] + 0.012), "steel"),
    )
