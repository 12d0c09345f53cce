"""Doors of appliances: insulated leaves and leaves with a window, and the handles that suit them."""

from typing import Literal

import numpy as np

from artigen.shapes.cavity import SIDES, build_frame
from artigen.shapes.handles import HandleDesign, HandleKind, make_handle
from artigen.shapes.hardware import Panel, Range
from artigen.shapes.primitives import Primitive, box, line, rounded_box
from artigen.shapes.racks import SLENDER
from artigen.shapes.shape import ShapePart


def build_leaf(
    panel: Panel, finish: str, lining: str, *, bevel: float = 0.0, gasket: Range = (0.02, 0.035)
) -> tuple[Primitive, ...]:
    """A closed leaf that fills its panel: a slab and a gasket around its rear side.

    Args:
        panel: Front, with the gasket in its thickness.
        finish: Outside.
        lining: Rear side.
        bevel: What is taken off the edges of the slab (m).
        gasket: Distance of the gasket's outer and inner outline from the edge of the slab (m).
    """
    seal = 0.008
    slab = rounded_box(
        (panel.x, panel.y[0], panel.z[0]), (panel.back - seal, panel.y[1], panel.z[1]), bevel, finish
    )
    near, far = gasket
    rubber = build_frame(
        (panel.back - seal, panel.back),
        (_shrink(panel.y, near), _shrink(panel.z, near)),
        (_shrink(panel.y, far), _shrink(panel.z, far)),
        "rubber",
    )
    return (line(slab, lining, SIDES["front"]), *rubber)


def build_window_leaf(
    panel: Panel, window: tuple[Range, Range], finish: str, lining: str, *, glass: str = "glass"
) -> tuple[Primitive, ...]:
    """A leaf with a pane: four boards around the window, the glass a little behind the face."""
    frame = build_frame((panel.x, panel.back), (panel.y, panel.z), window, finish)
    size = max(window[0][1] - window[0][0], window[1][1] - window[1][0])
    thickness = max(0.006, size / SLENDER)
    depth = min(0.003, (panel.thickness - thickness) / 2)
    pane = box(
        (panel.x + depth, window[0][0], window[1][0]),
        (panel.x + depth + thickness, window[0][1], window[1][1]),
        glass,
    )
    return (*(line(board, lining, SIDES["front"]) for board in frame), pane)


def draw_grip(
    rng: np.random.Generator,
    kinds: tuple[HandleKind, ...],
    *,
    length: float,
    longest: float,
    finish: str = "handle",
) -> HandleDesign:
    """A handle for an appliance whose longest edge measures ``longest`` metres."""
    kind = kinds[int(rng.integers(len(kinds)))]
    thickness = float(np.clip(rng.uniform(0.016, 0.021) * longest, 0.012, 0.032))
    return HandleDesign(kind=kind, length=max(length, 0.1), thickness=thickness, finish=finish)


def mount_grip(
    panel: Panel,
    design: HandleDesign,
    *,
    name: str,
    parent: str,
    side: Literal["left", "right", "top"],
    inset: float,
    level: float | None = None,
) -> ShapePart:
    """A handle along one side of a panel, ``inset`` metres from it, centred there or at height ``level``."""
    y, z = panel.center
    half = design.thickness / 2 + inset
    if side == "top":
        return make_handle(panel, design, name=name, parent=parent, upright=False, at=(y, panel.z[1] - half))
    y = panel.y[0] + half if side == "right" else panel.y[1] - half
    return make_handle(
        panel, design, name=name, parent=parent, upright=True, at=(y, z if level is None else level)
    )


def _shrink(span: Range, by: float) -> Range:
    return span[0] + by, span[1] - by
