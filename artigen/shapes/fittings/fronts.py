"""Doors and the faces of drawers: slabs, frames and panels, glass in frames, planks.

A `FrontDesign` is chosen once for an object; `make_front` fits it to a panel, `make_door` hangs it.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, get_args

import numpy as np

from artigen.shapes.choices import choose
from artigen.shapes.fittings.handles import HandleDesign, make_handle, place_handle
from artigen.shapes.fittings.hardware import Edge, Panel, hinge
from artigen.shapes.fittings.outlines import trace_corners
from artigen.shapes.primitives import Primitive, polytope
from artigen.shapes.ranges import narrow
from artigen.shapes.shape import ShapePart

FrontStyle = Literal["flat", "shaker", "framed_glass", "raised", "plank", "louvre"]
FRONT_STYLES: tuple[FrontStyle, ...] = get_args(FrontStyle)
ARCH, ARCH_PIECES = 0.22, 6
"""Rise of an arched panel relative to its width, and straight pieces of each half."""
PANE = 0.005
"""Thickness (m) of glass."""


@dataclass(frozen=True, kw_only=True)
class FrontDesign:
    """Design of an object's fronts (lengths in metres)."""

    style: FrontStyle
    frame: float
    """Width of stiles and rails of a frame."""
    handle: HandleDesign | None
    """None for fronts without handles."""
    hand: float = 1.05
    """Height (m, object frame) at which a hand takes a tall door."""
    glass: str = "glass"
    arched: bool = False
    """Whether raised panels of doors have an arched top."""
    pair: bool | None = None
    """Whether drawers have two handles side by side; None for the usual."""


def design_front(
    rng: np.random.Generator,
    style: FrontStyle | None = None,
    *,
    handle: HandleDesign | None = None,
) -> FrontDesign:
    """Draws a design with frames of 45 to 75 mm, wide enough for the handles; the style if not given."""
    drawn = FRONT_STYLES[int(rng.choice(len(FRONT_STYLES), p=(0.5, 0.2, 0.1, 0.1, 0.06, 0.04)))]
    stile = 0.0 if handle is None else min(handle.height, 0.05) + 0.012
    frame = max(choose(rng, 0.045, 0.075), stile)
    return FrontDesign(style=style or drawn, frame=frame, handle=handle)


def suit_drawer(panel: Panel, design: FrontDesign) -> FrontDesign:
    """The design for a drawer: a slab if a frame would hold glass or slats, or could carry no handle."""
    field = _find_field(panel, design)
    if field is None:
        return design
    handle = design.handle
    needed = (0.0, 0.0) if handle is None else (handle.length + 0.02, handle.height + 0.012)
    small = field.width < needed[0] or field.height < needed[1]
    return replace(design, style="flat") if small or design.style in ("framed_glass", "louvre") else design


def make_front(panel: Panel, design: FrontDesign) -> tuple[Primitive, ...]:
    """The solids of one front; a panel too small for a frame gets a slab."""
    frame = _frame_width(panel, design)
    if design.style == "plank":
        return _make_planks(panel)
    if not frame:
        return (panel.fill("front", 0.0015),)
    field = _inside_frame(panel, frame)
    spans = (
        (panel.z, (panel.y[0], field.y[0])),
        (panel.z, (field.y[1], panel.y[1])),
        ((panel.z[0], field.z[0]), field.y),
        ((field.z[1], panel.z[1]), field.y),
    )
    stiles_and_rails = [replace(panel, y=y, z=z).fill("front") for z, y in spans]
    return (*stiles_and_rails, *_make_field(field, design))


def _frame_width(panel: Panel, design: FrontDesign) -> float:
    """Width of stiles and rails (m); 0 for a slab."""
    frame = min(design.frame, 0.3 * panel.height, 0.3 * panel.width)
    framed = design.style in ("shaker", "framed_glass", "raised", "louvre")
    return frame if framed and frame >= 0.02 and min(panel.width, panel.height) >= 0.11 else 0.0


def _inside_frame(panel: Panel, frame: float) -> Panel:
    return replace(panel, y=narrow(panel.y, frame), z=narrow(panel.z, frame))


def _find_field(panel: Panel, design: FrontDesign) -> Panel | None:
    """The field within the frame, from the face of the front on; None for a slab."""
    frame = _frame_width(panel, design)
    if not frame:
        return None
    field = _inside_frame(panel, frame)
    if design.style == "framed_glass":
        return _find_pane(field)
    return _raise_field(field) if design.style == "raised" and _can_rise(field) else _sink_field(field)


def _find_pane(field: Panel) -> Panel:
    return replace(field, x=field.x + (field.thickness - PANE) / 2, thickness=PANE)


def _sink_field(field: Panel) -> Panel:
    deep = min(0.008, 0.45 * field.thickness)
    return replace(field, x=field.x + deep, thickness=field.thickness - deep)


def _can_rise(field: Panel) -> bool:
    return min(field.width, field.height) > 0.09


def _raise_field(field: Panel) -> Panel:
    """A raised plate on the sunken field, clear of the frame."""
    raised = _inside_frame(field, 0.022)
    return replace(raised, x=field.x + 0.002, thickness=_sink_field(field).x - field.x - 0.002)


def make_door(
    panel: Panel, design: FrontDesign, *, name: str, parent: str = "body", edge: Edge, upper: float
) -> tuple[ShapePart, ...]:
    """A door hinged along ``edge`` of its panel that opens by ``upper`` radians, with its handle."""
    door = ShapePart(name, "door", make_front(panel, design), hinge(panel, edge, upper), parent=parent)
    return (door, *fit_handle(panel, design, parent=name, edge=edge))


def fit_handle(panel: Panel, design: FrontDesign, *, parent: str, edge: Edge | None) -> tuple[ShapePart, ...]:
    """The handles of a front in their usual place; wide drawers have two knobs or cups."""
    handle = design.handle
    if handle is None:
        return ()
    if edge in ("left", "right") and handle.kind == "cup":  # cups are for drawers, knobs for doors
        handle = replace(handle, kind="knob", length=0.36 * handle.length)
    if edge in ("left", "right") and handle.kind == "arch" and handle.hangs:  # upright, nothing would hang
        handle = replace(handle, trim="plate")
    upright, (y, z) = place_handle(panel, handle, edge, design.hand)
    field = None if handle.kind == "edge" else _find_field(panel, design)
    if field is not None and edge is None:  # on the field
        half = handle.height / 2
        panel, z = replace(panel, x=field.x), float(np.clip(z, field.z[0] + half, field.z[1] - half))
    elif field is not None and edge is not None:  # in the middle of the stile or rail
        half = _frame_width(panel, design) / 2
        middles: dict[Edge, tuple[float, float]] = {
            "left": (panel.y[0] + half, z),
            "right": (panel.y[1] - half, z),
            "top": (y, panel.z[0] + half),
            "bottom": (y, panel.z[1] - half),
        }
        y, z = middles[edge]
    pair = (
        handle.kind in ("knob", "cup", "arch") and panel.width > 0.62 if design.pair is None else design.pair
    )
    pair = pair and edge is None
    if pair and design.pair:
        handle = replace(handle, length=min(handle.length, 0.4 * panel.width))
    places = [(y - 0.25 * panel.width, z), (y + 0.25 * panel.width, z)] if pair else [(y, z)]
    return tuple(
        make_handle(
            panel,
            handle,
            name=f"{parent}_handle" if len(places) == 1 else f"{parent}_handle_{index}",
            parent=parent,
            upright=upright,
            at=at,
        )
        for index, at in enumerate(places)
    )


def _make_field(field: Panel, design: FrontDesign) -> list[Primitive]:
    """The filling of a frame, set back from its face."""
    if design.style == "framed_glass":
        return [_find_pane(field).fill(design.glass)]
    sheet = _sink_field(field)
    solids = [sheet.fill("front")]
    if design.style == "raised" and _can_rise(field):
        raised = _raise_field(field)
        arched = design.arched and field.height > 1.2 * field.width
        solids.append(_arch(raised) if arched else raised.fill("front", 0.4 * raised.thickness))
    elif design.style == "louvre" and field.height > 0.12:
        solids += _make_louvres(field, sheet.x)
    return solids


def _arch(panel: Panel) -> Primitive:
    """A plate with an arched top."""
    rise = min(ARCH * panel.width, panel.height / 3)
    half = panel.width / 2
    cuts = ((0.0, 0.0), (half, rise), (half, rise), (0.0, 0.0))
    flat = trace_corners(panel.z, panel.y, [(b, a) for a, b in cuts], ARCH_PIECES)
    corners = [(x, y, z) for x in (panel.x, panel.back) for z, y in flat.tolist()]
    return polytope(np.array(corners), "front")


def _make_louvres(field: Panel, back: float) -> list[Primitive]:
    """At most twelve slats up to ``back`` (x), a hand's width apart on tall doors."""
    count = int(np.clip(round(field.height / 0.06), 2, 12))
    pitch, slat = field.height / count, replace(field, x=field.x + 0.001, thickness=back - field.x - 0.001)
    spans = [(field.z[0] + (k + 0.22) * pitch, field.z[0] + (k + 0.78) * pitch) for k in range(count)]
    return [replace(slat, z=span).fill("front") for span in spans]


def _make_planks(panel: Panel) -> tuple[Primitive, ...]:
    """At most eight vertical boards with bevelled edges, side by side."""
    count = int(np.clip(round(panel.width / 0.1), 1, 8))
    edges = np.linspace(*panel.y, count + 1)
    return tuple(
        replace(panel, y=(float(low), float(high))).fill("front", min(0.003, 0.2 * panel.thickness))
        for low, high in pairwise(edges)
    )
