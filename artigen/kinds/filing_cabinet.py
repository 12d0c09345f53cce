"""FilingCabinet: drawers for hanging files: vertical, lateral, a pedestal on castors, or wooden.

A hanging file for A4 paper (ISO 216: 210 mm x 297 mm) is 346 mm wide and 245 mm high, so drawers are slightly
more than 300 mm apart. Catalogue sizes: vertical ones 0.47 m x 0.62 m and 0.71, 1.02, 1.32 or 1.62 m high,
lateral ones 0.8 to 1.07 m wide and 0.45 to 0.5 m deep, pedestals 0.4 m x 0.56 m.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from artigen.kind import Kind, Place, by_height, make, plurals
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, ShapeError, Wish
from artigen.shapes.fittings.drawers import BoxDesign, make_drawer
from artigen.shapes.fittings.feet import StandKind, design_stand, make_stand
from artigen.shapes.fittings.fronts import FrontDesign, FrontStyle
from artigen.shapes.fittings.handles import HandleKind, design_handle
from artigen.shapes.fittings.hardware import GAP, Panel, Space
from artigen.shapes.fittings.locks import make_lock
from artigen.shapes.furniture.cabinet import list_cells
from artigen.shapes.furniture.carcass import CarcassDesign, make_carcass, open_carcass
from artigen.shapes.furniture.cells import suit_cell
from artigen.shapes.furniture.splits import Cell, Node, stack_drawers
from artigen.shapes.primitives import Primitive, block
from artigen.shapes.ranges import Range, around, margins, narrow, share_down
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import LACQUERS, make_lacquer
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "FilingCabinet"
PAINTS = (
    "light_grey", "light_grey", "grey", "anthracite", "black", "cream", "white", "navy",
    "forest", "terracotta",
)  # fmt: skip
NEUTRAL = ("light_grey", "white", "grey", "anthracite")
"""Body colours that may have fronts of another colour."""
SEAM = 0.006
"""Gap (m) between two fronts."""
FOLDERS = ((0.80, 0.66, 0.42), (0.42, 0.52, 0.42), (0.36, 0.46, 0.60), (0.70, 0.36, 0.28))
FILE = (0.346, 0.245)
"""Width and height of a hanging file for A4 (m)."""
CROWN = 0.034
"""Height (m) of a rail with a lock above the drawers."""
KEY = 0.026
"""Protrusion (m) of a key."""
RUNNER = 0.0115
"""Thickness (m) of a telescopic runner."""


@dataclass(frozen=True, kw_only=True)
class _Kind:
    """Sizes of a style (m); ``rows`` are numbers of file drawers, 0.3 m of height each."""

    weight: float
    width: Range
    depth: Range
    rows: Sequence[int]
    low: int
    """Number of low drawers above the file drawers."""
    stands: tuple[StandKind, ...]
    handles: tuple[HandleKind, ...]
    fronts: tuple[FrontStyle, ...] = ("flat",)


STYLES = {
    "vertical": _Kind(
        weight=4, width=(0.42, 0.5), depth=(0.58, 0.7), rows=(2, 3, 4, 4, 5), low=0,
        stands=("floor", "plinth"), handles=("cup", "recessed", "pull", "bar"),
    ),
    "lateral": _Kind(
        weight=2.5, width=(0.76, 1.07), depth=(0.45, 0.52), rows=(2, 3, 4), low=0,
        stands=("floor", "plinth"), handles=("edge", "bar", "recessed", "pull"),
    ),
    "pedestal": _Kind(
        weight=2, width=(0.38, 0.43), depth=(0.5, 0.6), rows=(1, 1, 2), low=2,
        stands=("castors", "castors", "floor"), handles=("edge", "recessed", "arch", "bar"),
    ),
    "wooden": _Kind(
        weight=2, width=(0.42, 0.52), depth=(0.45, 0.6), rows=(2, 2, 3, 4), low=0,
        stands=("plinth", "toe_kick", "floor"), handles=("cup", "knob", "arch", "pull"),
        fronts=("flat", "shaker", "raised"),
    ),
}  # fmt: skip


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a filing cabinet that meets the wish."""
    style = choose_style(rng, {name: kind.weight for name, kind in STYLES.items()}, wish.style)
    kind = STYLES[style]
    width, depth = choose(rng, *kind.width, wish.width), choose(rng, *kind.depth, wish.depth)
    rows, pitch = int(rng.choice(kind.rows)), choose(rng, 0.295, 0.315)
    low = kind.low if rows == 1 else 0
    stand = design_stand(
        rng, choose_one(rng, kind.stands if wish.layout is None else wish.layout.stands or kind.stands), 1.0
    )
    drawn = stand.height + rows * pitch + low * choose(rng, 0.105, 0.14) + 0.06
    height = drawn if wish.height is None else wish.height
    if wish.height is not None:
        rows, low = _fit_rows(wish.height - stand.height - 0.06, pitch, kind.low)
    stack = stack_drawers((0.4,) * low + (1.0,) * rows) if wish.layout is None else wish.layout.node
    cells, shares = _read_stack(stack)
    handles = wish.choose_handles(kind.handles)
    handle = design_handle(rng, choose_one(rng, handles), longest=height)
    if style == "lateral" and handle.kind in ("edge", "bar"):
        handle = replace(handle, length=choose(rng, 0.3, 0.8) * width)
    front = FrontDesign(style=choose_one(rng, kind.fronts), frame=0.05, handle=handle)
    outer = Space(x=(handle.reach - depth / 2, depth / 2), y=around(0.0, width / 2), z=(stand.height, height))
    crown = CROWN if style != "wooden" and rng.random() < 0.6 else 0.0
    if crown:
        outer = replace(outer, x=(max(handle.reach, KEY) - depth / 2, depth / 2))
    built = _build(rng, outer, front, cells, shares, crown, wooden=style == "wooden")
    built += make_stand(stand, (outer.x[0] + 0.02, outer.x[1]), outer.y)
    return Draft(style, built.close(), _draw_finishes(rng, style))


def _read_stack(node: Node) -> tuple[tuple[Cell, ...], tuple[float, ...]]:
    """The drawers of a stack from top to bottom, and their heights."""
    cells = tuple(list_cells(node))
    shares = (1.0,) if isinstance(node, Cell) else node.shares
    if len(shares) != len(cells) or any(cell.fill != "drawer" for cell in cells):
        fills = ", ".join(cell.fill for cell in cells)
        raise ShapeError(f"{CATEGORY}: a layout with {fills}; expected one stack of drawers")
    return cells, shares


def _fit_rows(height: float, pitch: float, low: int) -> tuple[int, int]:
    """Numbers of file drawers and of low drawers above them that fit a height (m)."""
    rows = int(np.clip(round(height / pitch), 1, 6))
    if low and height < 2.5 * pitch:
        return 1, int(np.clip(round((height - pitch) / (0.4 * pitch)), 0, 3))
    return rows, 0


def _draw_finishes(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    """Painted steel, sometimes with fronts of another colour, or wood."""
    folder, paint, other = (int(rng.integers(len(of))) for of in (FOLDERS, PAINTS, NEUTRAL))
    gloss, same = choose(rng, 0.15, 0.35), bool(rng.random() < 0.75)
    wooden = draw_palette(rng, "furniture", "classic" if rng.random() < 0.6 else "oak")
    steel = draw_palette(rng, "furniture", "industrial" if rng.random() < 0.4 else PAINTS[paint])
    front = make_lacquer(LACQUERS[PAINTS[paint]], gloss=gloss)
    body = front if same else make_lacquer(LACQUERS[NEUTRAL[other]], gloss=gloss)
    painted = steel | {"body": body, "front": front, "top": body, "inside": body, "drawer": body}
    return (wooden if style == "wooden" else painted) | {
        "paper": make_lacquer((0.93, 0.92, 0.88)),
        "folder": make_lacquer(FOLDERS[folder], gloss=0.05),
    }


def _build(
    rng: np.random.Generator,
    outer: Space,
    front: FrontDesign,
    cells: Sequence[Cell],
    shares: Sequence[float],
    crown: float,
    *,
    wooden: bool,
) -> Assembly:
    """The body, and its drawers from top to bottom."""
    thick = choose(rng, 0.016, 0.022)
    board = max(0.018, outer.height / 56)
    design = CarcassDesign(board=board, back=max(0.012, outer.height / 56), lining=None)
    body = replace(outer, x=(outer.x[0] + thick + GAP, outer.x[1]))
    solids: list[Primitive] = []
    if wooden:  # the top overhangs the fronts
        lid = replace(outer, z=(outer.z[1] - 0.022, outer.z[1]))
        body = replace(body, z=(body.z[0], lid.z[0]))
        solids.append(lid.fill("top", 0.003))
    solids[:0] = make_carcass(body, design, ())
    y, z = open_carcass(body, design)
    rail = replace(body, z=(body.z[1] - board - crown, body.z[1]), x=(outer.x[0], body.x[0]))
    if crown:
        solids.append(rail.fill("body", 0.002))
    edge = 0.002 if wooden or rng.random() < 0.5 else 0.012
    top = rail.z[0] if crown else body.z[1] - (0.004 if wooden else 0.002)
    fronts = share_down((body.z[0] + 0.003, top), shares, SEAM)
    travel, filled, labelled = (choose(rng, 0.7, 0.85), choose(rng, 0.3, 1.0), rng.random() < 0.85)
    parts: list[ShapePart] = []
    for index, (span, cell) in enumerate(zip(fronts, cells, strict=True)):
        own = suit_cell(front, cell)
        panel = Panel(x=outer.x[0], thickness=thick, y=narrow(outer.y, edge), z=span)
        space = Space(
            x=(panel.back, body.x[1] - design.back), y=y, z=(max(span[0], z[0]), min(span[1], z[1]))
        )
        solids += _make_runners(space, body.x[0])
        style = BoxDesign(rim=0.62, wall=0.012, side_gap=RUNNER + GAP, finish="drawer")
        drawer, *handles = make_drawer(panel, space, own, box=style, name=f"drawer_{index}", travel=travel)
        more = _make_files(rng, space, filled) if space.height > 0.24 else []
        if labelled and panel.height > 0.2 and own.handle is not None and own.handle.kind != "edge":
            more += _make_label(panel)
        parts += [replace(drawer, primitives=(*drawer.primitives, *more)), *handles]
    if crown:
        at = (outer.x[0], outer.y[0] + 0.045, (rail.z[0] + rail.z[1]) / 2)
        parts.append(make_lock(at, name="lock"))
    return Assembly(solids, parts)


def _make_runners(space: Space, front: float) -> list[Primitive]:
    """A rail at each side of a drawer."""
    x, z = (front + 0.004, front + 0.004 + 0.9 * (space.x[1] - front)), sum(space.z) / 2 - 0.03
    return [block(x, side, around(z, 0.02), "steel") for side in margins(space.y, RUNNER)]


def _make_files(rng: np.random.Generator, space: Space, filled: float) -> list[Primitive]:
    """Hanging files: one behind the other in a narrow drawer, side by side in a wide one."""
    floor = space.z[0] + GAP + 0.006
    top = min(floor + FILE[1], space.z[1] - 0.012)
    along, across = (space.y, space.x) if space.width > 0.6 else (space.x, space.y)
    middle, half = sum(across) / 2, min(FILE[0], across[1] - across[0] - 0.07) / 2
    start, end = along[0] + 0.04, along[0] + 0.04 + filled * (along[1] - along[0] - 0.09)
    out = []
    for at in np.linspace(start, end, int(rng.integers(5, 10))).tolist():
        thick = choose(rng, 0.004, 0.012)
        near, far = (at, at + thick), around(middle, half)
        x, y = (far, near) if space.width > 0.6 else (near, far)
        span = Space(x=x, y=y, z=(floor, top - choose(rng, 0.0, 0.01)))
        out.append(span.fill("folder"))
    return out


def _make_label(panel: Panel) -> list[Primitive]:
    """A label frame above the handle."""
    y, z = panel.center[0], panel.z[1] - 0.033
    frame = block((panel.x - 0.0015, panel.x), around(y, 0.045), around(z, 0.017), "handle")
    card = block((panel.x - 0.0025, panel.x), around(y, 0.039), around(z, 0.012), "paper")
    return [frame, card]


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "filing cabinet",
        "file cabinet",
        "lateral file",
        "lateral file cabinet",
        "pedestal",
        "drawer pedestal",
    ),
    hints=(),
    size=(
        by_height(0.7, 1.3, "pedestal, lateral"),
        by_height(1.3),
    ),
    deepest=np.inf,
    diagonal=(0.4, 3.0),
    build="sheet",
    stands="free",
    styles=tuple(STYLES),
    style_words={"mobile": "pedestal", "wood": "wooden"},
    forms={},
    sizes=((0.3, 1.5), (0.35, 1.0), (0.4, 2.2)),
    bare="width",
    make=make(density={"steel_sheet": 480.0}),
    makes={  # counterweights keep them from tipping with a drawer open (EN 14073)
        "pedestal": make(density={"steel_sheet": 480.0}, hidden=5.0),
        "lateral": make(density={"steel_sheet": 480.0}, hidden=8.0),
    },
    feet=True,
    trade="furniture",
    synset=None,
    wikidata="Q14745",  # furniture
    partnet="StorageFurniture",
    body="filingcabinet_body",
    places=(
        Place(role="filing cabinet", low=(0.3, 0.3, 0.7), high=(0.7, 1.7, 1.7), draws=((0.0, 0.0, 1.3),)),
    ),
    holds="things",
    open_front=0.05,
    lid_stays=False,
    colored=(),
    laid_out=True,
    channel=None,
    word=17,
    draw=draw,
)
