"""Faucet: basin and kitchen mixers and pillar taps on a piece of worktop, with levers and swivelling spouts.

Basin mixers extend 110 to 160 mm forward, kitchen mixers 180 to 240 mm forward and 300 to 420 mm up; taps of
bridge faucets are 203 mm (8 inches) apart. A pillar tap has water of one temperature. A lever is cold in the
middle and turns one way, to warm.
"""

import numpy as np

from artigen.kind import PLAIN, Kind, by_longest, plurals
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Spans, Wish, choose_size
from artigen.shapes.fittings.hardware import rotate
from artigen.shapes.fittings.taps import PIVOT, make_cross_handle, make_mixer
from artigen.shapes.fittings.tubes import bend_elbow, lay_pipe, lean_rod
from artigen.shapes.primitives import FRONT, LEFT, RIGHT, ROUND, UP, Primitive, block, cylinder
from artigen.shapes.ranges import Range, around
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.materials import make_polished
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Faucet"
STYLES = {"single": 0.3, "kitchen": 0.3, "bridge": 0.25, "pillar": 0.15}
SIZES: dict[str, Spans] = {
    "single": ((0.16, 0.22), (0.17, 0.22), (0.16, 0.22)),
    "kitchen": ((0.18, 0.24), (0.24, 0.3), (0.32, 0.44)),
    "bridge": ((0.29, 0.34), (0.2, 0.26), (0.26, 0.34)),
    "pillar": ((0.14, 0.18), (0.16, 0.2), (0.15, 0.2)),
}
"""Width and depth, including the piece of worktop, and height."""
METALS = ("chrome", "chrome", "steel", "black", "brass", "bronze")
DECK = 0.03


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a faucet."""
    style = choose_style(rng, STYLES, wish.style)
    width, depth, height = choose_size(rng, CATEGORY, wish, SIZES[style])
    back = depth / 2 - 0.06  # x of the faucet's axis
    deck = block((0.3 * depth - depth / 2, depth / 2), around(0.0, width / 2), (0.0, DECK), "top", 0.002)
    draw_metal = {
        "single": _draw_single, "kitchen": _draw_kitchen, "bridge": _draw_bridge, "pillar": _draw_pillar
    }[style]  # fmt: skip
    built = Assembly((deck,)) + draw_metal(rng, back, back + depth / 2, height)
    finishes = draw_palette(rng, "furniture", choose_one(rng, ("oak", "white", "walnut", "anthracite")))
    metal = make_polished(choose_one(rng, METALS), int(rng.integers(2**30)))
    return Draft(style, built.close(), finishes | {"handle": metal, "accent": metal})


def _rod(at: tuple[float, float], z: Range, radius: float) -> Primitive:
    """An upright rod at (x, y)."""
    return cylinder((*at, z[0]), (*at, z[1]), radius, "handle")


def _build_aerator(x: float, z: float, radius: float) -> Primitive:
    """The aerator on the end of a tube that points down."""
    return _rod((x, 0.0), (z - 0.008, z + 0.012), 1.12 * radius)


def _make_spout(
    x: Range, neck: float, collar: tuple[float, float], z: Range, top: float, *, bend: float, radius: float
) -> ShapePart:
    """A spout that swivels about its foot: a collar, and a tube up, across and down to its aerator.

    Args:
        x: x of the foot and of the aerator (m).
        neck: Height of what it turns on.
        collar: Height and radius of the collar.
        z: Height of the tube's foot and of the aerator.
        top: Highest point of the tube's middle.
        bend: Radius of its bends.
        radius: Radius of the tube.
    """
    path = [(x[0], 0.0, z[0]), (x[0], 0.0, top), (x[1], 0.0, top), (x[1], 0.0, z[1])]
    bow = abs(x[1] - x[0]) < 2 * bend + 1e-9
    pieces = (
        _rod((x[0], 0.0), (neck + 0.0015, neck + collar[0]), collar[1]),
        *lay_pipe(path, radius, bend, "handle", pieces=4 if bow else 2),
        _build_aerator(x[1], z[1], radius),
    )
    return ShapePart("spout", "handle", pieces, rotate(UP, (x[0], 0.0, neck)))


def _draw_single(rng: np.random.Generator, x: float, reach: float, height: float) -> Assembly:
    """A pillar with a fixed spout, and the cartridge with its lever on top."""
    radius, cap = choose(rng, 0.021, 0.026), 0.02
    top = height - cap - 0.0015 - 2 * PIVOT - (0.013 - PIVOT)
    pieces = _build_pillar(rng, (x - reach, x), radius, top)
    long = choose(rng, 0.6, 0.8) * reach
    at = (x, 0.0, top)
    lever = make_mixer(at, UP, FRONT, radius=radius, height=cap, length=long)
    return Assembly(pieces, lever)


def _draw_pillar(rng: np.random.Generator, x: float, reach: float, height: float) -> Assembly:
    """A pillar with a fixed spout and one tap on top: a cross, or a lever that turns by a quarter."""
    radius, tall = choose(rng, 0.017, 0.021), 0.045
    pieces = _build_pillar(rng, (x - reach, x), radius, height - tall)
    arms, long, upper = (4, 0.032, np.pi) if rng.random() < 0.6 else (1, 0.06, np.pi / 2)
    tap = make_cross_handle(
        (x, 0.0, height - tall), UP, FRONT, name="tap", reach=long, height=tall, arms=arms, upper=upper
    )
    return Assembly(pieces, (tap,))


def _build_pillar(rng: np.random.Generator, x: Range, radius: float, top: float) -> tuple[Primitive, ...]:
    """A pillar up to ``top`` with a fixed spout that bends down; ``x`` is that of the spout's end and of the
    pillar's axis (m)."""
    tube, bend = 0.0135, 0.02
    foot, end = DECK + 0.6 * (top - DECK), x[0] + 1.12 * tube * ROUND
    level = foot + choose(rng, 0.0, 0.02)
    return (
        _rod((x[1], 0.0), (DECK, DECK + 0.006), 1.25 * radius),
        _rod((x[1], 0.0), (DECK, top), radius),
        lean_rod((x[1], 0.0, foot), (end + bend, 0.0, level), tube, "handle"),
        *bend_elbow((end + bend, 0.0, level - bend), (UP, FRONT), bend, tube, "handle"),
        cylinder((end, 0.0, level - bend), (end, 0.0, level - 0.03), tube, "handle"),
        _build_aerator(end, level - 0.03, tube),
    )


def _draw_kitchen(rng: np.random.Generator, x: float, reach: float, height: float) -> Assembly:
    """A high swivelling spout on a body with a lever at its side."""
    radius, tube, neck, level = choose(rng, 0.022, 0.026), 0.0125, DECK + 0.11, DECK + 0.06
    side = (x, -radius - 0.006, level)
    pieces = (
        _rod((x, 0.0), (DECK, DECK + 0.006), 1.25 * radius),
        _rod((x, 0.0), (DECK, neck), radius),
        cylinder(side, (x, 0.0, level), 0.019, "handle"),
    )
    end = x - reach + 1.12 * tube * ROUND
    bend, top, drop = (x - end) / 2, height - tube * ROUND, 0.03  # a bow
    if rng.random() >= 0.6:  # square, with short bends
        bend, top, drop = 0.03, height - tube, 0.04
    collar, z = (0.03, 0.9 * radius), (neck + 0.02, top - bend - drop)
    spout = _make_spout((x, end), neck, collar, z, top, bend=bend, radius=tube)
    long = choose(rng, 0.08, 0.1)
    lever = make_mixer(side, RIGHT, UP, radius=0.018, height=0.02, length=long)
    return Assembly(pieces, (spout, *lever))


def _draw_bridge(rng: np.random.Generator, x: float, reach: float, height: float) -> Assembly:
    """Two taps on pillars joined by a bridge, with a swivelling spout on its middle."""
    apart, level, tube = 0.1015, DECK + 0.055, 0.0115
    neck, end = level + 0.022, x - reach + 1.12 * tube * ROUND
    pieces = [cylinder((x, -apart, level), (x, apart, level), 0.011, "handle")]
    for y in (-apart, apart):
        pieces += [_rod((x, y), (DECK, DECK + 0.007), 0.026), _rod((x, y), (DECK, neck), 0.0145)]
    pieces.append(_rod((x, 0.0), (level - 0.014, neck), 0.0165))
    bend, top = (x - end) / 2, height - tube * ROUND
    lowest = neck + 0.068  # above the taps, which it passes
    low = top - bend - 0.02
    if low <= lowest:
        bend, top = 0.02, height - tube
        low = min(lowest, top - 0.03)
    z = (neck + 0.01, low)
    spout = _make_spout((x, end), neck, (0.022, 0.0155), z, top, bend=bend, radius=tube)
    cross = rng.random() < 0.65
    arms, long, upper = (4, 0.034, np.pi) if cross else (1, 0.042, np.pi / 2)
    hot, cold = (
        make_cross_handle(
            (x, y, neck),
            UP,
            FRONT if cross else away,
            name=name,
            reach=long,
            height=0.05,
            arms=arms,
            upper=upper,
        )
        for name, y, away in (("hot", apart, LEFT), ("cold", -apart, RIGHT))
    )
    return Assembly(pieces, (spout, hot, cold))


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "faucet",
        "tap",
        "mixer tap",
        "water tap",
        "kitchen tap",
        "basin mixer",
        "bath mixer",
        "basin tap",
        "spigot",
    ),
    hints=("sink",),
    size=(by_longest(0.3),),
    deepest=np.inf,
    diagonal=(0.1, 1.0),
    build="metal",
    stands="mounted",
    styles=tuple(STYLES),
    style_words={"mixer": "single", "single lever": "single"},
    forms={},
    sizes=((0.05, 0.6), (0.08, 0.5), (0.08, 0.7)),
    bare="height",
    make=PLAIN,
    makes={},
    feet=False,
    trade="fittings",
    synset="faucet.n.01",
    wikidata=None,
    partnet=CATEGORY,
    body="faucet_body",
    places=(),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=16,
    draw=draw,
)
