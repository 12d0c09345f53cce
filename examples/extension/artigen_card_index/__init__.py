"""CardIndex: a box with one drawer for cards."""

import numpy as np

from artigen.kind import Kind, Place, by_width, make, plurals
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose_style
from artigen.shapes.draw import Draft, choose_size
from artigen.shapes.fittings.hardware import slide
from artigen.shapes.primitives import block
from artigen.shapes.ranges import around, margins, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette

STYLES = {"desktop": 2.0, "library": 1.0}


def draw(rng, wish):
    style = choose_style(rng, STYLES, wish.style)
    width, depth, height = choose_size(rng, "CardIndex", wish, ((0.3, 0.45), (0.35, 0.48), (0.18, 0.3)))
    x, y, z, wall, gap = (0.02 - depth / 2, depth / 2), around(0.0, width / 2), (0.0, height), 0.015, 0.003
    inner, room = narrow(y, wall), (wall, height - wall)
    body = [
        *(block(x, side, z, "body") for side in margins(y, wall)),
        *(block(x, inner, level, "body") for level in margins(z, wall)),
        block((x[1] - wall, x[1]), inner, room, "body"),
    ]
    box, low = narrow(inner, gap), (room[0] + gap, room[0] + gap + 0.008)
    deep, high = (x[0], x[1] - wall - gap), (low[0], room[1] - 0.03)
    drawer = [
        block(deep, box, low, "drawer"),
        *(block(deep, side, high, "drawer") for side in margins(box, 0.008)),
        block((deep[1] - 0.008, deep[1]), narrow(box, 0.008), high, "drawer"),
        block((x[0], x[0] + 0.012), box, (low[0], room[1] - gap), "front"),
    ]
    pull = block((x[0] - 0.02, x[0]), around(0.0, 0.02), around(height / 2, 0.01), "handle")
    parts = [
        ShapePart("drawer", "drawer", drawer, slide(0.6 * depth)),
        ShapePart("pull", "handle", (pull,), parent="drawer"),
    ]
    return Draft(style, Assembly(body, parts).close(), draw_palette(rng, "furniture", style))


KIND = Kind(
    name="CardIndex",
    nouns=plurals("card index", "card catalogue"),
    hints=(),
    size=(by_width(0.4),),
    deepest=np.inf,
    diagonal=(0.3, 1.0),
    build="board",
    stands="free",
    styles=tuple(STYLES),
    style_words={"archive": "library"},
    forms={},
    sizes=((0.2, 0.6), (0.25, 0.6), (0.12, 0.4)),
    bare="width",
    make=make(density={"wood_board": 500.0}),
    makes={},
    feet=True,
    trade="furniture",
    synset=None,
    wikidata="Q14745",
    partnet=None,
    body="card_index_body",
    places=(Place(role="crate", low=(0.3, 0.25, 0.15), high=(0.5, 0.5, 0.35), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=None,
    draw=draw,
)
