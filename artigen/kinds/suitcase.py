"""Suitcase: a standing hard shell on four wheels with a telescopic handle, or a lying case with a lid.

Most airlines allow cabin luggage of 0.55 m x 0.40 m x 0.20 m, including wheels and handles; medium and large
shells are 0.66 and 0.76 m high. Carried cases are 0.45 to 0.7 m wide and 0.13 to 0.2 m thick.
"""

from dataclasses import replace
from math import radians

import numpy as np

from artigen.kind import Kind, Place, by_longest, make, plurals
from artigen.shapes.assembly import Assembly, Build, draw_styled
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Spans, Wish
from artigen.shapes.fittings.bowls import build_bowl
from artigen.shapes.fittings.carrying import CHANNEL, build_channel, make_grip, make_pull_handle
from artigen.shapes.fittings.feet import make_castors
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import FINGER_ROOM, GAP, Edge, Panel, hinge
from artigen.shapes.fittings.lids import make_lid
from artigen.shapes.fittings.locks import make_latch
from artigen.shapes.fittings.outlines import Outline
from artigen.shapes.primitives import Primitive, block, polytope
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import make_metal, shade_color
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Suitcase"
STYLES = {"cabin": 3.0, "large": 2.5, "leather": 2.0, "aluminium": 1.5}
SIZES: dict[str, Spans] = {
    "cabin": ((0.35, 0.4), (0.19, 0.23), (0.5, 0.55)),
    "large": ((0.42, 0.52), (0.25, 0.32), (0.62, 0.78)),
    "leather": ((0.45, 0.7), (0.32, 0.46), (0.14, 0.21)),
    "aluminium": ((0.42, 0.6), (0.3, 0.42), (0.13, 0.2)),
}
"""Width, depth and height (m)."""
SHELLS: tuple[Color, ...] = (
    (0.15, 0.16, 0.18), (0.17, 0.23, 0.35), (0.62, 0.16, 0.16), (0.76, 0.77, 0.78),
    (0.80, 0.56, 0.52), (0.24, 0.42, 0.40), (0.88, 0.85, 0.78), (0.80, 0.58, 0.16),
)  # fmt: skip
LEATHERS: tuple[Color, ...] = ((0.42, 0.25, 0.14), (0.30, 0.18, 0.11), (0.55, 0.36, 0.20), (0.14, 0.12, 0.11),
                               (0.20, 0.27, 0.22))  # fmt: skip
LININGS: tuple[Color, ...] = ((0.22, 0.22, 0.24), (0.55, 0.55, 0.56), (0.66, 0.58, 0.46))
WALL = 0.007
"""Minimum thickness (m) of a shell with its lining."""
SLENDER = 57
"""Largest ratio of the longest edge of a plate or strap to its thickness."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a suitcase that meets the wish."""
    standing: dict[str, Build] = dict.fromkeys(("cabin", "large"), _build_standing)
    builders = standing | dict.fromkeys(("leather", "aluminium"), _build_lying)
    return draw_styled(rng, wish, STYLES, SIZES, builders, _draw_finishes)


def _draw_finishes(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    seed = int(rng.integers(2**30))
    shell, hide = choose_one(rng, SHELLS), choose_one(rng, LEATHERS)
    lining = choose_one(rng, LININGS)
    body = {
        "leather": Finish(kind="rubber", color=hide, accent=shade_color(hide, 0.9), gloss=0.2),
        "aluminium": make_metal("steel" if rng.random() < 0.75 else "black", seed),
    }.get(style) or Finish(kind="plastic", color=shell, accent=shell, period=0.3, gloss=0.4)
    dark = Finish(kind="plastic", color=(0.12, 0.12, 0.13), accent=(0.12, 0.12, 0.13), gloss=0.3)
    belt = Finish(kind="rubber", color=shade_color(hide, 0.75), accent=hide, gloss=0.2)
    return draw_palette(rng, "appliance", "steel") | {
        "body": body,
        "inside": Finish(kind="rubber", color=lining, accent=lining, gloss=0.05),
        "trim": {"leather": belt, "aluminium": make_metal("dark", seed)}.get(style, dark),
        "handle": belt if style == "leather" else dark,
        "metal": make_metal("brass" if style == "leather" else "chrome", seed),
    }


def _build_standing(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """Two ribbed shells on four wheels that open like a book; a telescopic handle is behind the rear one."""
    grip, behind, wheel = FINGER_ROOM + 0.014, CHANNEL + 0.006, choose(rng, 0.018, 0.024)
    x, y = (0.004 - depth / 2, depth / 2 - behind), around(0.0, width / 2)
    castors = make_castors(narrow(x, 0.012), narrow(y, 0.03), wheel, swivel=False)
    z = (castors.height, height - grip)
    seam = x[0] + choose(rng, 0.42, 0.5) * (x[1] - x[0])
    radius, bevel = choose(rng, 0.035, 0.06), choose(rng, 0.012, 0.02)
    outline, wall = Outline(a=y, b=z, cuts=(radius, radius)), max(WALL, (z[1] - z[0]) / SLENDER)
    front = build_bowl(outline, (x[0], seam - GAP), wall, bevel=bevel)
    rear = build_bowl(outline, (x[1], seam), wall, bevel=bevel)
    edge: Edge = "left" if rng.random() < 0.5 else "right"
    ribs = _build_ribs(rng, x[0], narrow(y, radius), narrow(z, radius))
    swing = hinge(Panel(x=seam - GAP, thickness=0.01, y=y, z=z), edge, radians(choose(rng, 100, 170)))
    door = ShapePart("door", "door", (*front, *ribs, *castors.pieces[:6]), swing)
    wheels = [replace(part, parent="door" if k < 2 else "body") for k, part in enumerate(castors.parts)]
    spread, low = choose(rng, 0.38, 0.5) * width, z[0] + 0.06
    rods = make_pull_handle(x[1], spread, (low, z[1] + 0.022), 0.62 * (z[1] - z[0]))
    top = ((seam + x[1]) / 2, 0.0, z[1])
    carry = make_grip(top, 0.42 * width, name="grip", parent="body", thick=0.014)
    side = around(y[0] if edge == "left" else y[1], 0.002)
    pieces = (
        *rear,
        *castors.pieces[6:],
        *build_channel(x[1], spread, (low, z[1] - 0.05), "trim"),
        block((seam + 0.004, seam + 0.03), side, around(sum(z) / 2, 0.03), "trim"),
        *_cross_straps(seam + 0.012, y, z),
    )
    return Assembly(pieces, (door, carry, rods, *wheels))


def _build_ribs(rng: np.random.Generator, x: float, y: Range, z: Range) -> list[Primitive]:
    """Vertical or horizontal ribs on the front."""
    count, upright = int(rng.integers(4, 8)), rng.random() < 0.65
    low, high = y if upright else z
    pitch = (high - low) / count
    spans = [(low + (k + 0.2) * pitch, low + (k + 0.8) * pitch) for k in range(count)]
    face = (x - 0.004, x + 0.004)
    return [block(face, span, z, "body") if upright else block(face, y, span, "body") for span in spans]


def _cross_straps(x: float, y: Range, z: Range) -> list[Primitive]:
    """Two elastic straps across the rear shell."""
    rise, ends = 0.2 * (z[1] - z[0]), narrow(y, 0.5 * WALL)
    thick = float(np.hypot(y[1] - y[0], 3 * rise)) / SLENDER + 0.002
    levels = narrow(z, rise)
    straps = [tuple(zip(ends, order, strict=True)) for order in (levels, levels[::-1])]
    corners = [
        [(a, b, c + s) for a in (x, x + thick) for b, c in strap for s in (-0.012, 0.012)] for strap in straps
    ]
    return [polytope(np.array(strap), "trim") for strap in corners]


def _build_lying(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A case on its back, whose lid opens upwards after its latches; the handle is between these."""
    reach, band = 0.041, 0.004
    x, y, top = (reach - depth / 2, depth / 2), around(0.0, width / 2), height - band
    seam = choose(rng, 0.5, 0.62) * height
    radius, bevel = choose(rng, 0.02, 0.035), choose(rng, 0.006, 0.014)
    outline, high = Outline(a=x, b=y, cuts=(radius, radius)), seam + GAP
    low = build_bowl(outline, (0.0, seam), WALL, axis=2, bevel=bevel)
    cover = [*build_bowl(outline, (top, high), WALL, axis=2, bevel=bevel)]
    straps, face = [], (x[0] - band, x[0] + 0.003)
    for at in (-0.38 * width, 0.38 * width):
        belt = around(at, 0.016)
        straps.append(block(face, belt, (bevel, seam), "trim"))
        cover += [
            block(face, belt, (high, top - bevel), "trim"),
            block(narrow(x, bevel), belt, (top - 0.003, height), "trim"),
        ]
    half, z = choose(rng, 0.016, 0.024), (seam - 0.03, min(seam + 0.032, height - bevel - 0.012))
    latches = [
        make_latch(x[0], around(at, half), z, name=f"latch_{k}", upper=1.4, finish="metal")
        for k, at in enumerate((-0.22 * width, 0.22 * width))
    ]
    needs = require("latch_0", "latch_1")
    lid = make_lid(cover, x, y, high, radians(choose(rng, 95, 115)), needs=needs)
    panel = Panel(x=x[0], thickness=0.02, y=y, z=(0.0, seam))
    design = HandleDesign(kind="arch", length=0.13, thickness=0.014)
    handle = make_handle(panel, design, name="handle", parent="body", upright=False, at=(0.0, 0.55 * seam))
    return Assembly((*low, *straps), (lid, handle, *latches))


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "suitcase",
        "trolley case",
        "trolley suitcase",
        "travel case",
        "luggage/luggage",
        "carry on",
        "baggage/baggage",
        "cabin bag",
    ),
    hints=(),
    size=(by_longest(0.65),),
    deepest=np.inf,
    diagonal=(0.3, 1.5),
    build="plastic",
    stands="free",
    styles=tuple(STYLES),
    style_words={"carry on": "cabin", "aluminum": "aluminium"},
    forms={
        **dict.fromkeys(("carry on", "cabin bag"), ((0.34, 0.42), (0.2, 0.26), (0.5, 0.58))),
        **dict.fromkeys(("trolley suitcase", "trolley case"), ((0.34, 0.5), (0.2, 0.32), (0.5, 0.78))),
    },
    sizes=((0.25, 1.0), (0.12, 0.6), (0.12, 1.0)),
    bare="height",
    make=make(wall={"plastic": 0.0022}),
    makes={},
    feet=False,
    trade=None,
    synset="bag.n.06",
    wikidata="Q200814",
    partnet=CATEGORY,
    body="suitcase_body",
    places=(Place(role="suitcase", low=(0.2, 0.3, 0.45), high=(0.4, 0.6, 0.85), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=22,
    draw=draw,
)
