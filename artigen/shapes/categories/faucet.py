"""Faucet: basin and kitchen mixers on a piece of worktop, with levers, taps and swivelling spouts.

Basin mixers extend 110 to 160 mm forward, kitchen mixers 180 to 240 mm forward and 300 to 420 mm up; taps of
bridge faucets are 203 mm (8 inches) apart. A lever is cold in the middle and turns one way, to warm.
"""

from math import radians

import numpy as np

from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_size
from artigen.shapes.fittings.hardware import Range, around, rotate
from artigen.shapes.fittings.taps import PIVOT, make_cross_handle, make_mixer
from artigen.shapes.fittings.tubes import bend_elbow, lay_pipe, lean_rod
from artigen.shapes.primitives import FRONT, RIGHT, SEGMENTS, UP, Primitive, Vector, block, cylinder
from artigen.shapes.shape import ShapePart, make_base
from artigen.shapes.surfaces.materials import make_polished
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Faucet"
STYLES = {"single": 0.35, "kitchen": 0.35, "bridge": 0.3}
SIZES: dict[str, tuple[Range, Range, Range]] = {
    "single": ((0.16, 0.22), (0.17, 0.22), (0.16, 0.22)),
    "kitchen": ((0.18, 0.24), (0.24, 0.3), (0.32, 0.44)),
    "bridge": ((0.29, 0.34), (0.2, 0.26), (0.26, 0.34)),
}
"""Width and depth, including the piece of worktop, and height."""
METALS = ("chrome", "chrome", "steel", "black", "brass", "bronze")
DECK = 0.03
ROUND = float(np.cos(np.pi / SEGMENTS))
"""Ratio of the extent of the prism that approximates a cylinder to the cylinder's."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a faucet."""
    style = choose_style(rng, STYLES, wish.style)
    wide, deep, tall = SIZES[style]
    width, depth, height = choose_size(rng, CATEGORY, wish, (wide, deep, tall))
    back = depth / 2 - 0.06  # x of the faucet's axis
    low = -depth / 2 + 0.3 * depth
    deck = block((low, depth / 2), around(0.0, width / 2), (0.0, DECK), "top", 0.002)
    reach = back + depth / 2
    build = {"single": _draw_single, "kitchen": _draw_kitchen, "bridge": _draw_bridge}[style]
    pieces, parts = build(rng, back, reach, height)
    body = make_base((deck, *pieces))
    finishes = draw_palette(rng, "furniture", choose_one(rng, ("oak", "white", "walnut", "anthracite")))
    metal = make_polished(choose_one(rng, METALS), int(rng.integers(2**30)))
    finishes |= {"handle": metal, "accent": metal}
    return Draft(style, (body, *parts), finishes)


def _build_aerator(x: float, z: float, radius: float) -> Primitive:
    """The aerator on the end of a tube that points down."""
    return cylinder((x, 0.0, z - 0.008), (x, 0.0, z + 0.012), 1.12 * radius, "handle")


def _build_spout(x: Range, z: Range, top: float, bend: float, radius: float) -> tuple[Primitive, ...]:
    """A tube from its foot up, across and down to its aerator.

    Args:
        x: x of the foot and of the aerator (m).
        z: Height of the foot and of the aerator.
        top: Highest point of the tube's middle.
        bend: Radius of its bends.
        radius: Radius of the tube.
    """
    path = [(x[0], 0.0, z[0]), (x[0], 0.0, top), (x[1], 0.0, top), (x[1], 0.0, z[1])]
    bow = abs(x[1] - x[0]) < 2 * bend + 1e-9
    tube = lay_pipe(path, radius, bend, "handle", pieces=4 if bow else 2)
    return *tube, _build_aerator(x[1], z[1], radius)


def _draw_single(
    rng: np.random.Generator, x: float, reach: float, height: float
) -> tuple[tuple[Primitive, ...], tuple[ShapePart, ...]]:
    """A pillar with a fixed spout, and the cartridge with its lever on top."""
    radius = choose(rng, 0.021, 0.026)
    cap = 0.02
    top = height - cap - 0.0015 - 2 * PIVOT - (0.013 - PIVOT)
    spout, tube = DECK + 0.6 * (top - DECK), 0.0135
    end = x - reach + 1.12 * tube * ROUND
    rise = choose(rng, 0.0, 0.02)
    bend, level, low = 0.02, spout + rise, spout + rise - 0.03
    pieces = (
        cylinder((x, 0.0, DECK), (x, 0.0, DECK + 0.006), 1.25 * radius, "handle"),
        cylinder((x, 0.0, DECK), (x, 0.0, top), radius, "handle"),
        lean_rod((x, 0.0, spout), (end + bend, 0.0, level), tube, "handle"),
        *bend_elbow((end + bend, 0.0, level - bend), (UP, FRONT), bend, tube, "handle"),
        cylinder((end, 0.0, level - bend), (end, 0.0, low), tube, "handle"),
        _build_aerator(end, low, tube),
    )
    mixer = make_mixer(
        (x, 0.0, top),
        UP,
        FRONT,
        name="lever",
        parent="body",
        radius=radius,
        height=cap,
        length=choose(rng, 0.6, 0.8) * reach,
        turn=radians(50.0),
        finish="handle",
    )
    return pieces, mixer


def _draw_kitchen(
    rng: np.random.Generator, x: float, reach: float, height: float
) -> tuple[tuple[Primitive, ...], tuple[ShapePart, ...]]:
    """A high swivelling spout on a body with a lever at its side."""
    radius, tube = choose(rng, 0.022, 0.026), 0.0125
    neck = DECK + 0.11
    pieces = (
        cylinder((x, 0.0, DECK), (x, 0.0, DECK + 0.006), 1.25 * radius, "handle"),
        cylinder((x, 0.0, DECK), (x, 0.0, neck), radius, "handle"),
        cylinder((x, -radius - 0.006, DECK + 0.06), (x, 0.0, DECK + 0.06), 0.019, "handle"),
    )
    end = x - reach + 1.12 * tube * ROUND
    collar = cylinder((x, 0.0, neck + 0.0015), (x, 0.0, neck + 0.03), 0.9 * radius, "handle")
    if rng.random() < 0.6:  # a bow
        bend, level = (x - end) / 2, height - tube * ROUND
        low = level - bend - 0.03
    else:  # square, with short bends
        bend, level = 0.03, height - tube
        low = level - 0.07
    tubes = _build_spout((x, end), (neck + 0.02, low), level, bend, tube)
    spout = _make_swivel((x, 0.0, neck), (collar, *tubes))
    mixer = make_mixer(
        (x, -radius - 0.006, DECK + 0.06),
        RIGHT,
        UP,
        name="lever",
        parent="body",
        radius=0.018,
        height=0.02,
        length=choose(rng, 0.08, 0.1),
        turn=radians(50.0),
        finish="handle",
    )
    return pieces, (spout, *mixer)


def _make_swivel(foot: Vector, pieces: tuple[Primitive, ...]) -> ShapePart:
    """A spout that turns about the vertical axis through its foot."""
    turn = rotate(UP, foot)
    return ShapePart("spout", "handle", pieces, turn)


def _draw_bridge(
    rng: np.random.Generator, x: float, reach: float, height: float
) -> tuple[tuple[Primitive, ...], tuple[ShapePart, ...]]:
    """Two taps on pillars joined by a bridge, with a swivelling spout on its middle."""
    apart, level, tube = 0.1015, DECK + 0.055, 0.0115
    pieces = [cylinder((x, -apart, level), (x, apart, level), 0.011, "handle")]
    for y in (-apart, apart):
        pieces.append(cylinder((x, y, DECK), (x, y, DECK + 0.007), 0.026, "handle"))
        pieces.append(cylinder((x, y, DECK), (x, y, level + 0.022), 0.0145, "handle"))
    pieces.append(cylinder((x, 0.0, level - 0.014), (x, 0.0, level + 0.022), 0.0165, "handle"))
    neck, end = level + 0.022, x - reach + 1.12 * tube * ROUND
    bend, top = (x - end) / 2, height - tube * ROUND
    lowest = neck + 0.068  # above the taps, which it passes
    low = top - bend - 0.02
    if low <= lowest:
        bend, top = 0.02, height - tube
        low = min(lowest, top - 0.03)
    tubes = _build_spout((x, end), (neck + 0.01, low), top, bend, tube)
    collar = cylinder((x, 0.0, neck + 0.0015), (x, 0.0, neck + 0.022), 0.0155, "handle")
    spout = _make_swivel((x, 0.0, neck), (collar, *tubes))
    arms = 4 if rng.random() < 0.65 else 1
    taps = [
        make_cross_handle(
            (x, y, neck),
            UP,
            FRONT if arms > 1 else (0.0, float(np.sign(y)), 0.0),
            name=name,
            parent="body",
            reach=0.034 if arms > 1 else 0.042,
            height=0.05,
            finish="handle",
            arms=arms,
            upper=float(np.pi if arms > 1 else np.pi / 2),
        )
        for name, y in (("hot", apart), ("cold", -apart))
    ]
    return tuple(pieces), (spout, *taps)
