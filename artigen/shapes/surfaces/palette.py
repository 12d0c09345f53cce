"""Palettes: finishes by role that are sold together, for furniture and for household appliances.

A role says what a surface is for; a category asks for roles only and never for colours:

body        carcass or housing            front     doors and drawer fronts, in furniture
inside      lining of carcass or cabinet  top       worktop, table top
handle      handles and knobs             leg       legs, feet, frames
glass       panes in doors                panel     control panels, opaque dark glass
steel       drums, racks, sinks, rods     plastic   trays, bins, mouldings
rubber      gaskets, tyres, feet          accent    trim, the odd thing out
drawer      drawer boxes                  cavity    enamel inside ovens
clear       pale glass: portholes, shelves of refrigerators

Palettes have all of these. Some categories add finishes of their own:

trim        mouldings, bezels, tape       paper     labels, sheets of paper
folder      hanging files                 tray      loose trays, inner buckets
mirror      mirrors                       screen    displays
key         keys, small buttons           lamp      what shines
lid         lids of another material      wall      the piece of wall behind
metal       fittings                      mark      logos, flags, what stands out
foot        weighted feet, bases          arm       arms of lamps
first, second, third, fourth   one of several alike that differ by colour
"""

from dataclasses import replace
from typing import Literal

import numpy as np

from artigen.shapes.choices import choose_one, pick
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import (
    LACQUERS,
    STONES,
    WOODS,
    make_glass,
    make_lacquer,
    make_metal,
    make_stone,
    make_wood,
    varnish,
)

Theme = Literal["furniture", "appliance"]
PANES = (((0.012, 0.03), (0.7, 0.95)), ((0.03, 0.1), (0.3, 0.6)), ((0.3, 0.6), (0.45, 0.8)))
"""Shade (sRGB) and opacity of panes in doors."""
PALETTE_ROLES = (
    "body", "front", "inside", "top", "handle", "glass", "rubber", "steel", "accent", "panel", "plastic",
    "leg", "drawer", "cavity", "clear",
)  # fmt: skip
ROLES = (
    *PALETTE_ROLES,
    "trim", "paper", "folder", "tray", "mirror", "screen", "key", "lamp", "lid", "wall", "metal", "mark",
    "foot", "arm", "first", "second", "third", "fourth",
)  # fmt: skip

# Compatible combinations: fronts that suit a body, and metals that suit a front.
FRONTS_ON_WOOD = {
    "oak": ("white", "anthracite", "forest", "navy"),
    "white_oak": ("white", "cream", "sage", "light_grey", "black"),
    "walnut": ("white", "cream", "anthracite", "black"),
    "birch": ("white", "light_grey", "blue", "terracotta"),
    "pine": ("white", "cream", "sage", "blue"),
    "cherry": ("cream", "white"),
    "teak": ("white", "black", "cream"),
    "grey_oak": ("white", "anthracite", "light_grey"),
    "maple": ("white", "cream", "light_grey"),
    "mahogany": ("cream", "white"),
    "wenge": ("white", "cream", "black"),
    "black_ash": ("black", "white"),
}
WOODS_WITH_LACQUER = {
    "white": ("oak", "maple", "walnut", "wenge"),
    "cream": ("pine", "walnut", "cherry", "mahogany"),
    "light_grey": ("white_oak", "birch", "maple"),
    "grey": ("oak", "walnut"),
    "anthracite": ("oak", "grey_oak"),
    "sage": ("oak", "white_oak"),
    "navy": ("oak", "walnut"),
    "forest": ("oak", "walnut"),
    "blue": ("birch", "pine"),
    "terracotta": ("oak", "birch"),
    "black": ("oak", "walnut"),
}
BOUGHT_LACQUERS = {
    "white": 0.34, "light_grey": 0.13, "anthracite": 0.1, "grey": 0.09, "black": 0.09, "cream": 0.08,
    "sage": 0.05, "navy": 0.05, "forest": 0.03, "blue": 0.02, "terracotta": 0.02,
}  # fmt: skip
BOUGHT_WOODS = {
    "maple": 0.22, "cherry": 0.18, "walnut": 0.13, "oak": 0.1, "wenge": 0.09, "mahogany": 0.08,
    "white_oak": 0.08, "birch": 0.06, "pine": 0.01, "grey_oak": 0.02, "teak": 0.02, "black_ash": 0.01,
}  # fmt: skip
"""How often each is bought, judged by what shops show first and by web models of furniture: white, greys and
black; maple, cherry, oak, walnut, and wood stained dark or red."""
LININGS = {"veneer": 0.35, "maple": 0.4, "white": 0.25}
"""How the inside of a carcass is finished: as the outside where that is wood, as pale plywood, or white."""
PAINTED = 0.2
"""Probability that furniture is painted outside, on all of it but its top."""
FIGURES = (1.5, 1.0, 0.6)
"""Contrast of grain, 1 for the two colours of `WOODS`: figured boards, plain boards, and prints, which are
more even."""
VARNISHED = 0.75
"""Probability that wood is varnished, and not oiled."""
WARM = frozenset(
    {"navy", "forest", "sage", "cream", "terracotta", "walnut", "cherry", "teak", "mahogany", "wenge"}
)
"""Fronts that are combined with brass."""
PASTELS = ((0.90, 0.86, 0.76), (0.62, 0.74, 0.70), (0.62, 0.73, 0.80), (0.68, 0.20, 0.18), (0.88, 0.70, 0.66))
DARK = frozenset({"anthracite", "black", "navy", "forest", "black_ash"})


def draw_palette(
    rng: np.random.Generator, theme: Theme, style: str, *, painted: float = PAINTED
) -> dict[str, Finish]:
    """Finishes for every role of `ROLES` that suit each other.

    Args:
        rng: Random generator.
        theme: Trade of the object: furniture or appliance.
        style: A category's style. A wood or lacquer named by it ("oak", "navy") is used; "shaker" and
            "classic" lean to wood and paint, "steel" and "industrial" to metal, "retro" to cream and pastel.
        painted: Probability that furniture is painted outside, where the style leaves it open.

    Raises:
        ValueError: If the theme is not known.
    """
    if theme == "furniture":
        return _draw_furniture(rng, style, painted)
    if theme == "appliance":
        return _draw_appliance(rng, style)
    raise ValueError(f"theme {theme!r}, expected furniture or appliance")


def _draw_furniture(rng: np.random.Generator, style: str, painted: float) -> dict[str, Finish]:
    seed = int(rng.integers(2**30))
    wood, lacquer, scheme = _draw_scheme(rng, style, painted)
    timber = make_wood(wood, seed, figure=FIGURES[seed % len(FIGURES)])
    if rng.random() < VARNISHED:
        timber = varnish(timber)
    paint = make_lacquer(LACQUERS[lacquer], gloss=float(rng.uniform(0.1, 0.35)))
    body, front, top = {
        "wood": (timber, timber, timber),
        "painted": (paint, paint, paint),
        "painted_wooden_top": (paint, paint, timber),
        "painted_stone_top": (paint, paint, make_stone(choose_one(rng, tuple(STONES)), seed + 1)),
        "wooden_body": (timber, paint, timber),
        "wooden_front": (paint, timber, paint),
    }[scheme]
    seen = wood if front.kind == "wood" else lacquer
    metal = _draw_metal(rng, seen, style)
    inside, drawer = make_lacquer(LACQUERS["white"], gloss=0.15), make_wood("birch", seed + 2)
    lined = pick(rng, LININGS)
    if lined == "maple" or (lined == "veneer" and body.kind == "wood"):  # veneered on both sides
        inside = make_wood("maple" if lined == "maple" else wood, seed + 3)
    if body.kind != "wood" and rng.random() < 0.35:
        drawer = make_lacquer(LACQUERS["light_grey"])
    leg = make_metal("black", seed) if rng.random() < 0.05 else (timber if top.kind == "wood" else body)
    return _common(seed) | {
        "body": body,
        "front": front,
        "inside": inside,
        "top": top,
        "handle": metal,
        "leg": leg,
        "drawer": drawer,
        "accent": metal if front.kind == "wood" else timber,
        "panel": make_lacquer(LACQUERS["black"], gloss=0.5),
    }


def _draw_scheme(rng: np.random.Generator, style: str, share: float) -> tuple[str, str, str]:
    """Wood, lacquer and their assignment; a material that the style names is always on the fronts."""
    if style in WOODS:
        scheme = "wood" if rng.random() < 0.7 else "wooden_front"
        return style, choose_one(rng, FRONTS_ON_WOOD[style]), scheme
    painted = ("painted", "painted_wooden_top", "painted_stone_top")
    if style in LACQUERS:
        return choose_one(rng, WOODS_WITH_LACQUER[style]), style, choose_one(rng, (*painted, "wooden_body"))
    if style in ("steel", "industrial", "metal"):
        return (
            choose_one(rng, ("oak", "walnut", "pine")),
            choose_one(rng, ("black", "anthracite", "grey")),
            "wooden_front",
        )
    mixed = 0.12 * (1.0 - share) / (1.0 - PAINTED)
    if style in ("shaker", "classic", "country", "cottage"):
        share, mixed = 1.6 * share, 0.0
    chances = {"wood": 1.0 - share - mixed, "wooden_body": mixed / 2, "wooden_front": mixed / 2}
    chances |= dict(zip(painted, (0.4 * share, 0.35 * share, 0.25 * share), strict=True))
    scheme = str(rng.choice(list(chances), p=list(chances.values())))
    if scheme.startswith("painted"):
        lacquer = pick(rng, BOUGHT_LACQUERS)
        return choose_one(rng, WOODS_WITH_LACQUER[lacquer]), lacquer, scheme
    wood = pick(rng, BOUGHT_WOODS)
    return wood, choose_one(rng, FRONTS_ON_WOOD[wood]), scheme


def _draw_metal(rng: np.random.Generator, front: str, style: str) -> Finish:
    choices = ["steel", "steel", "black"]
    if front in WARM:
        choices += ["brass", "brass", "bronze"]
    if front in DARK:
        choices = ["steel", "brass", "chrome"]
    if style in ("steel", "industrial", "metal"):
        choices = ["black", "dark"]
    return make_metal(choose_one(rng, tuple(choices)), int(rng.integers(2**30)))


def _draw_appliance(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    seed = int(rng.integers(2**30))
    look = style if style in APPLIANCES else str(rng.choice(list(APPLIANCES), p=(0.55, 0.36, 0.06, 0.03)))
    body, front, handle = APPLIANCES[look](rng, seed)
    enamel = make_lacquer((0.20, 0.21, 0.23), gloss=0.3)
    black_glass = make_glass((0.012, 0.012, 0.013))
    inside = Finish(
        kind="plastic", color=(0.93, 0.935, 0.935), accent=(0.90, 0.905, 0.91), period=0.3, gloss=0.3
    )
    return _common(seed) | {
        "body": body,
        "front": front,
        "glass": _draw_pane(rng),
        "inside": inside,
        "top": body if rng.random() < 0.8 else black_glass,
        "handle": handle,
        "leg": make_lacquer(LACQUERS["black"]),
        "drawer": inside,
        "accent": make_metal("chrome", seed + 4),
        "panel": body if look == "white" and rng.random() < 0.5 else black_glass,
        "cavity": replace(enamel, accent=(0.27, 0.28, 0.30)),
    }


def _draw_pane(rng: np.random.Generator) -> Finish:
    """Glass of a door: a dark one, a smoked one, or a grey screen behind a clear one."""
    drawn = float(rng.uniform(0.0, 3.0))  # decides all three, so that the draws after it stay
    shade, opacity = PANES[int(drawn)]
    share = drawn % 1.0
    grey = round(shade[0] + (shade[1] - shade[0]) * ((7 * share) % 1.0), 3)
    return make_glass((grey, grey, grey), opacity=round(opacity[0] + (opacity[1] - opacity[0]) * share, 2))


def _steel_look(rng: np.random.Generator, seed: int) -> tuple[Finish, Finish, Finish]:
    """Grey housing, brushed front: sides of a steel appliance are painted, and cheap ones are all over."""
    metal = make_metal("dark" if rng.random() < 0.12 else "steel", seed)
    grey = round(0.3 + 0.05 * (seed % 11), 2)
    paint = make_lacquer((grey, grey, grey), gloss=0.3)
    return paint, paint if seed % 10 < 3 else metal, make_metal("steel", seed + 1)


def _white_look(rng: np.random.Generator, seed: int) -> tuple[Finish, Finish, Finish]:
    enamel = make_lacquer((0.965, 0.965, 0.96), gloss=0.45)
    handle = Finish(kind="plastic", color=(0.88, 0.88, 0.88), accent=(0.84, 0.84, 0.84), gloss=0.35)
    return enamel, enamel, handle if rng.random() < 0.6 else make_metal("steel", seed)


def _black_look(rng: np.random.Generator, seed: int) -> tuple[Finish, Finish, Finish]:
    enamel = make_lacquer((0.015, 0.015, 0.016), gloss=0.45)
    return enamel, enamel, make_metal("steel" if rng.random() < 0.6 else "black", seed)


def _retro_look(rng: np.random.Generator, seed: int) -> tuple[Finish, Finish, Finish]:
    """Pastel enamel with chrome."""
    enamel = make_lacquer(choose_one(rng, PASTELS), gloss=0.5)
    return enamel, enamel, make_metal("chrome", seed)


APPLIANCES = {"steel": _steel_look, "white": _white_look, "black": _black_look, "retro": _retro_look}
"""Looks of appliances: housing, front and handle."""


def _common(seed: int) -> dict[str, Finish]:
    """Finishes that are alike in every trade."""
    return {
        "glass": make_glass((0.72, 0.78, 0.78), opacity=0.22),
        "clear": make_glass((0.72, 0.78, 0.78), opacity=0.22),
        "rubber": Finish(kind="rubber", color=(0.05, 0.05, 0.052), accent=(0.07, 0.07, 0.07), gloss=0.05),
        "steel": make_metal("steel", seed + 5),
        "plastic": Finish(kind="plastic", color=(0.83, 0.83, 0.82), accent=(0.79, 0.79, 0.78), gloss=0.25),
        "cavity": make_lacquer((0.20, 0.21, 0.23), gloss=0.3),
    }
