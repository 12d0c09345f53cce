"""Families: looks across kinds, so that the objects of a room match.

A `Family` lists styles, handles and materials; a `Suite` is one choice of each. An object gets the first
style of the family that its category has and the first handles that it offers. Finishes change by role:
wood, paint and stone of furniture, enamel and sheet of appliances, metal of fittings. Other materials, such
as glass, rubber or mirrors, stay.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from artigen.errors import name_options
from artigen.kind import Trade, find_kind, kinds
from artigen.shapes.choices import choose_one
from artigen.shapes.draw import ShapeError, Wish
from artigen.shapes.fittings.handles import HandleKind
from artigen.shapes.shape import Shape
from artigen.shapes.surfaces.finishes import Finish, FinishKind
from artigen.shapes.surfaces.materials import (
    LACQUERS,
    WOODS,
    make_lacquer,
    make_metal,
    make_polished,
    make_stone,
    make_wood,
)


@dataclass(frozen=True, kw_only=True)
class Scheme:
    """Matching materials, by their names in `WOODS`, `LACQUERS`, `STONES` and `METALS`."""

    front: str
    top: str
    metal: str
    """Material of handles, taps and fittings."""
    appliance: str
    """Key of `APPLIANCES`."""
    body: str = ""
    """Default: that of the front."""
    leg: str = ""
    """Default: that of the body."""
    frame: str = "white"
    """Material of doors, windows and their frames."""


@dataclass(frozen=True, kw_only=True)
class Family:
    """A look across kinds."""

    styles: tuple[str, ...]
    """Styles of the categories, in order of preference."""
    handles: tuple[tuple[HandleKind, ...], ...]
    """Lists of handles in order of preference; a suite uses one of the lists."""
    schemes: tuple[Scheme, ...]


@dataclass(frozen=True, kw_only=True)
class Suite:
    """One choice of a family; objects of one suite match."""

    family: str
    seed: int
    styles: tuple[str, ...]
    handles: tuple[HandleKind, ...]
    finishes: Mapping[str, Mapping[str, Finish]]
    """Finishes by trade and role."""


@dataclass(frozen=True, kw_only=True)
class Appliance:
    """Design of the appliances of a suite: style, housing and front."""

    style: str
    body: Finish
    front: Finish


def _enamel(style: str, color: tuple[float, float, float]) -> Appliance:
    paint = make_lacquer(color, gloss=0.45)
    return Appliance(style=style, body=paint, front=paint)


APPLIANCES: dict[str, Appliance] = {
    "steel": Appliance(
        style="steel", body=make_lacquer((0.50, 0.50, 0.51), gloss=0.3), front=make_metal("steel", 0)
    ),
    "dark": Appliance(
        style="steel", body=make_lacquer((0.20, 0.20, 0.21), gloss=0.3), front=make_metal("dark", 0)
    ),
    "white": _enamel("white", (0.94, 0.94, 0.935)),
    "black": _enamel("black", LACQUERS["black"]),
    "cream": _enamel("retro", (0.90, 0.86, 0.76)),
    "mint": _enamel("retro", (0.62, 0.74, 0.70)),
    "sky": _enamel("retro", (0.62, 0.73, 0.80)),
    "red": _enamel("retro", (0.68, 0.20, 0.18)),
}

FAMILIES: dict[str, Family] = {
    "shaker": Family(
        styles=(
            "shaker", "panelled", "sash", "bridge", "wooden", "drop", "kitchen", "toggle", "dome",
            "close_coupled", "pedal", "saucepan",
        ),
        handles=(("cup", "arch", "knob"), ("knob", "arch"), ("bar",)),
        schemes=(
            Scheme(front="sage", top="oak", metal="brass", appliance="cream"),
            Scheme(front="navy", top="quartz", metal="brass", appliance="steel"),
            Scheme(front="white", top="oak", metal="black", appliance="white"),
            Scheme(front="light_grey", top="quartz", metal="steel", appliance="steel"),
            Scheme(front="cream", top="walnut", metal="bronze", appliance="mint"),
        ),
    ),
    "slab": Family(
        styles=(
            "handleless", "modern", "flat", "flush", "casement", "single", "lateral", "curved", "kitchen",
            "rocker", "led", "wall_hung", "pedal",
        ),
        handles=(("edge",), ("recessed", "edge")),
        schemes=(
            Scheme(front="white", top="concrete", leg="black", metal="steel", appliance="steel"),
            Scheme(front="anthracite", top="oak", leg="black", metal="black", appliance="black"),
            Scheme(front="grey_oak", body="white", top="quartz", metal="steel", appliance="steel"),
            Scheme(front="black", top="walnut", metal="brass", appliance="dark", frame="black"),
        ),
    ),
    "rustic": Family(
        styles=(
            "country", "classic", "panelled", "casement", "bridge", "wooden", "drop", "kitchen", "toggle",
            "dome", "close_coupled", "pedal", "casserole",
        ),
        handles=(("knob", "arch"), ("block", "pull", "arch")),
        schemes=(
            Scheme(front="pine", top="pine", metal="black", appliance="cream", frame="pine"),
            Scheme(front="oak", top="slate", metal="bronze", appliance="black", frame="oak"),
            Scheme(front="blue", top="pine", metal="black", appliance="white"),
            Scheme(front="cream", top="oak", metal="bronze", appliance="red"),
        ),
    ),
    "industrial": Family(
        styles=(
            "industrial", "modern", "glazed", "casement", "vertical", "bridge", "service", "architect",
            "toggle", "drop", "sliding", "skirted", "pedal", "stockpot",
        ),
        handles=(("bar",), ("pull", "bar")),
        schemes=(
            Scheme(front="black", top="oak", metal="black", appliance="dark", frame="black"),
            Scheme(front="walnut", body="black", top="concrete", metal="dark", appliance="steel",
                   frame="anthracite"),
            Scheme(front="anthracite", top="pine", leg="black", metal="bronze", appliance="black",
                   frame="black"),
        ),
    ),
    "midcentury": Family(
        styles=(
            "midcentury", "flat", "flush", "casement", "single", "wooden", "curved", "kitchen", "rocker",
            "dome", "skirted", "pedal",
        ),
        handles=(("bar",), ("knob", "arch"), ("pull", "bar")),
        schemes=(
            Scheme(front="walnut", top="walnut", metal="brass", appliance="cream"),
            Scheme(front="teak", top="teak", metal="black", appliance="sky"),
            Scheme(front="white", body="walnut", top="walnut", metal="brass", appliance="white"),
            Scheme(front="cherry", top="terrazzo", metal="brass", appliance="cream"),
        ),
    ),
    "laboratory": Family(
        styles=(
            "flat", "modern", "flush", "casement", "single", "lateral", "service", "led", "rocker",
            "skirted", "pedal", "stockpot",
        ),
        handles=(("pull", "bar"), ("bar",)),
        schemes=(
            Scheme(front="white", top="quartz", leg="light_grey", metal="steel", appliance="white"),
            Scheme(front="light_grey", body="white", top="slate", leg="grey", metal="steel",
                   appliance="steel"),
            Scheme(front="blue", body="white", top="quartz", leg="light_grey", metal="steel",
                   appliance="white"),
        ),
    ),
    "nursery": Family(
        styles=(
            "flat", "modern", "panelled", "casement", "single", "wooden", "kitchen", "dome", "rocker",
            "close_coupled", "pedal",
        ),
        handles=(("knob", "arch"),),
        schemes=(
            Scheme(front="sage", body="birch", top="birch", metal="steel", appliance="white"),
            Scheme(front="terracotta", body="white", top="birch", leg="birch", metal="brass",
                   appliance="white"),
            Scheme(front="blue", body="birch", top="birch", metal="steel", appliance="sky"),
        ),
    ),
}  # fmt: skip

WORN: dict[Trade, frozenset[FinishKind]] = {
    "furniture": frozenset({"wood", "lacquer", "stone"}),
    "joinery": frozenset({"wood", "lacquer", "stone"}),
    "appliance": frozenset({"lacquer", "steel"}),
    "fittings": frozenset({"wood", "lacquer", "stone"}),
}
"""Materials that a suite changes by trade, in addition to the metal of `METAL_ROLES`."""
METAL_ROLES = frozenset({"handle", "accent", "arm"})


def choose_suite(family: str, seed: int) -> Suite:
    """One suite of a family, a pure function of its arguments.

    Raises:
        ShapeError: If the family is not known.
    """
    if family not in FAMILIES:
        raise ShapeError(f"family {family!r} is not known, expected {name_options(family, FAMILIES)}")
    own, rng = FAMILIES[family], np.random.default_rng(seed)
    scheme = choose_one(rng, own.schemes)
    handles = choose_one(rng, own.handles)
    look = APPLIANCES[scheme.appliance]
    metal, frame = make_metal(scheme.metal, 0), _make(scheme.frame)
    polished = metal if scheme.metal == "black" else make_polished(scheme.metal, 0)
    white = make_lacquer(LACQUERS["white"], gloss=0.15)
    body = _make(scheme.body or scheme.front)
    metals = dict.fromkeys(METAL_ROLES, metal)
    finishes = {
        "furniture": metals
        | {
            "front": _make(scheme.front),
            "body": body,
            "top": _make(scheme.top),
            "leg": _make(scheme.leg or scheme.body or scheme.front),
            "inside": body if body.kind == "wood" else white,
        },
        "joinery": metals | dict.fromkeys(("front", "body", "top"), frame),
        "appliance": metals | dict.fromkeys(("body", "top", "panel"), look.body) | {"front": look.front},
        "fittings": dict.fromkeys(METAL_ROLES, polished) | {"top": _make(scheme.top)},
    }
    return Suite(
        family=family, seed=seed, styles=(look.style, *own.styles), handles=handles, finishes=finishes
    )


def wish_suite(category: str, suite: Suite, wish: Wish | None = None) -> Wish:
    """The wish with the suite's hardware and with its style if the category has one of its styles."""
    wish = wish or Wish()
    known = kinds()[category].styles if category in kinds() else ()
    style = wish.style or next((style for style in suite.styles if style in known), None)
    return replace(wish, style=style, handles=wish.handles or suite.handles, suite=suite.seed)


def dress_shape(shape: Shape, suite: Suite) -> Shape:
    """The object in the materials of the suite."""
    kind = find_kind(shape.category)
    trade = kind and kind.trade
    if trade is None:
        return shape
    offered, changed = suite.finishes[trade], WORN[trade]
    worn: list[tuple[str, Finish]] = []
    for role, own in shape.finishes:
        metal = role in METAL_ROLES and (own.kind == "steel" or role == "handle")
        new = offered.get(role) if metal or (own.kind in changed and role not in METAL_ROLES) else None
        worn.append((role, own if new is None else replace(new, seed=own.seed)))
    return replace(shape, finishes=tuple(worn))


def _make(name: str) -> Finish:
    """The lacquer, wood or stone with that name."""
    if name in LACQUERS:
        return make_lacquer(LACQUERS[name])
    return make_wood(name, 0) if name in WOODS else make_stone(name, 0)
