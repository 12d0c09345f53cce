"""Tables: forms of storage furniture and styles of fronts, with sizes in metres and relative weights."""

from dataclasses import dataclass

from artigen.kind import NONE, Spans
from artigen.shapes.fittings.feet import PLAIN_LEGS, StandKind
from artigen.shapes.fittings.fronts import FrontStyle
from artigen.shapes.fittings.handles import HandleKind, HandleTrim
from artigen.shapes.fittings.legs import LegKind
from artigen.shapes.furniture.splits import Fill, Taste


@dataclass(frozen=True, kw_only=True)
class Style:
    """A style: fronts, handles and relative frequency."""

    weight: float
    doors: tuple[FrontStyle, ...]
    drawers: tuple[FrontStyle, ...]
    handles: tuple[HandleKind, ...]
    inset: float
    """Probability of fronts within the body."""
    frame: float = 0.0
    """Probability of a face frame before the body."""
    closed: bool = False
    """Whether the style needs a door to be recognisable."""
    legs: tuple[LegKind, ...] = PLAIN_LEGS
    moulded: float = 0.0
    """Probability of moulded tops and cornices."""
    arched: float = 0.0
    """Probability of arched panels in doors."""
    trims: tuple[HandleTrim, ...] = ("plain",)


STYLES: dict[str, Style] = {
    "flat": Style(
        weight=5,
        doors=("flat",),
        drawers=("flat",),
        handles=("bar", "pull", "knob", "edge", "arch"),
        inset=0.15,
        frame=0.4,
    ),
    "handleless": Style(
        weight=1.6, doors=("flat",), drawers=("flat",), handles=("edge", "recessed"), inset=0.1
    ),
    "shaker": Style(
        weight=3,
        doors=("shaker",),
        drawers=("shaker", "flat"),
        handles=("knob", "cup", "bar", "pull"),
        inset=0.3,
        frame=0.6,
        legs=("square", "tapered", "tapered", "turned"),
        moulded=0.25,
        trims=("plain", "plain", "plate"),
    ),
    "framed_glass": Style(
        weight=1.6,
        doors=("framed_glass",),
        drawers=("flat", "shaker"),
        handles=("knob", "bar", "pull"),
        inset=0.2,
        frame=0.5,
        closed=True,
        legs=("square", "tapered", "round", "turned"),
        moulded=0.3,
        trims=("plain", "plate"),
    ),
    "classic": Style(
        weight=2.4,
        doors=("raised",),
        drawers=("raised", "flat"),
        handles=("knob", "arch", "cup"),
        inset=0.4,
        frame=0.6,
        legs=("turned", "turned", "cabriole", "tapered"),
        moulded=0.75,
        arched=0.5,
        trims=("plate", "drop", "drop", "plain"),
    ),
    "country": Style(
        weight=1.1,
        doors=("plank",),
        drawers=("flat", "plank"),
        handles=("knob", "arch", "block", "pull"),
        inset=0.4,
        frame=0.6,
        legs=("turned", "square", "tapered"),
        moulded=0.35,
        trims=("plain", "plate", "drop"),
    ),
    "louvre": Style(
        weight=0.7,
        doors=("louvre",),
        drawers=("flat",),
        handles=("knob", "pull"),
        inset=0.3,
        frame=0.5,
        closed=True,
    ),
    "industrial": Style(
        weight=0.8, doors=("flat",), drawers=("flat",), handles=("bar", "pull"), inset=0.3, frame=0.2
    ),
}


@dataclass(frozen=True, kw_only=True)
class Mounting:
    """What a cabinet stands on, what covers it, and how high its handles are."""

    stands: tuple[tuple[StandKind, float], ...]
    """Stands and their weights."""
    worktop: float = 0.0
    """Probability of a top that covers the sides and overhangs."""
    rails: float = 0.0
    """Probability that a top without overhang is two rails for a later worktop."""
    hand: float = 1.05
    """Height (m) at which a hand takes a tall door."""


STYLE_WORDS = {
    "corner": NONE, "l shaped": NONE, "tambour": NONE, "roller shutter": NONE,
    "modern": "flat", "contemporary": "flat", "mid century": "flat",
    "scandinavian": "flat", "minimalist": "handleless", "rustic": "country",
    "farmhouse": "country", "traditional": "classic", "vintage": "classic", "antique": "classic",
    "victorian": "classic",
}  # fmt: skip
"""Further words for these styles."""


@dataclass(frozen=True, kw_only=True)
class Form(Mounting):
    """A form of furniture: its sizes, its mounting, and the division of its front."""

    weight: float
    spans: Spans
    taste: Taste


DOORS: tuple[tuple[Fill, float], ...] = (
    ("door", 3.0),
    ("double", 3.0),
    ("fold", 0.5),
    ("drop", 1.6),
    ("slide", 0.6),
)
LOW: tuple[tuple[Fill, float], ...] = (
    ("door", 3.0),
    ("double", 2.5),
    ("drop", 2.4),
    ("slide", 1.0),
    ("lift", 0.15),
)
FORMS: dict[str, Form] = {
    "base_cabinet": Form(
        weight=6.5,
        spans=((0.3, 1.25), (0.56, 0.66), (0.78, 0.94)),
        stands=(("toe_kick", 4), ("plinth", 1.5), ("screw_feet", 0.9), ("legs", 0.3)),
        worktop=0.4,
        rails=0.85,
        taste=Taste(
            module=(0.36, 0.75),
            rules=(
                ("columns", 0.4),
                ("stack", 0.4),
                ("drawer_row", 0.5),
                ("closed", 2.6),
                ("open_row", 0.1),
                ("blank", 1.0),
            ),
            fills=DOORS,
            trays=0.3,
        ),
    ),
    "wall_cabinet": Form(
        weight=3.6,
        spans=((0.3, 1.2), (0.28, 0.42), (0.34, 0.95)),
        stands=(("floor", 1.0),),
        hand=-1.0,
        taste=Taste(
            module=(0.34, 0.75),
            rules=(("columns", 0.4), ("closed", 3.0), ("open_row", 0.3), ("open", 0.1), ("blank", 0.7)),
            fills=(("door", 3.0), ("double", 3.0), ("lift", 3.0), ("fold", 0.4), ("slide", 0.6)),
            trays=0.0,
        ),
    ),
    "dresser": Form(
        weight=0.7,
        spans=((0.4, 1.65), (0.38, 0.54), (0.7, 1.3)),
        stands=(("legs", 2), ("plinth", 1.5), ("toe_kick", 1), ("floor", 0.6), ("sled", 0.3)),
        worktop=0.45,
        taste=Taste(
            module=(0.36, 0.9),
            drawer=(0.13, 0.26),
            rules=(("columns", 0.5), ("stack", 4.0), ("drawer_row", 0.7), ("closed", 0.25)),
            fills=DOORS,
            symmetry=0.95,
        ),
    ),
    "wardrobe": Form(
        weight=1.0,
        spans=((0.5, 1.7), (0.5, 0.66), (1.75, 2.25)),
        stands=(("plinth", 2), ("toe_kick", 1.5), ("floor", 1), ("legs", 0.5)),
        taste=Taste(
            module=(0.45, 0.75),
            drawer=(0.15, 0.26),
            rules=(("columns", 0.5), ("rows", 0.5), ("closed", 2.4), ("open", 0.05)),
            fills=(("door", 3.0), ("double", 3.5), ("fold", 0.6), ("slide", 2.2), ("drawer", 0.2)),
            shelf_pitch=(0.3, 0.5),
            rod=0.7,
            trays=0.1,
        ),
    ),
    "sideboard": Form(
        weight=1.2,
        spans=((1.0, 2.0), (0.36, 0.5), (0.6, 0.95)),
        stands=(("legs", 3), ("plinth", 1), ("sled", 1), ("floor", 0.3)),
        worktop=0.4,
        taste=Taste(
            module=(0.42, 0.8),
            rules=(("columns", 3.0), ("stack", 0.8), ("drawer_row", 0.7), ("closed", 1.6), ("open", 0.25)),
            fills=LOW,
            symmetry=0.9,
        ),
    ),
    "nightstand": Form(
        weight=2.6,
        spans=((0.34, 0.6), (0.32, 0.46), (0.42, 0.7)),
        stands=(("legs", 3), ("plinth", 0.6), ("floor", 0.6), ("castors", 0.8), ("sled", 0.4)),
        worktop=0.45,
        taste=Taste(
            module=(0.3, 0.6),
            drawer=(0.12, 0.22),
            rules=(("stack", 0.6), ("drawer_row", 0.6), ("open_row", 0.8), ("closed", 1.6)),
            fills=(("door", 3.0), ("drop", 0.4)),
            trays=0.0,
        ),
    ),
    "bookcase": Form(
        weight=0.8,
        spans=((0.4, 1.3), (0.26, 0.4), (1.0, 2.1)),
        stands=(("toe_kick", 1), ("floor", 2), ("legs", 0.6), ("plinth", 0.6)),
        taste=Taste(
            module=(0.34, 0.8),
            rules=(("columns", 0.7), ("rows", 1.3), ("open", 1.5), ("closed", 0.7), ("stack", 0.25)),
            fills=(("door", 2.0), ("double", 3.0), ("drop", 0.4)),
            trays=0.0,
        ),
    ),
    "tv_stand": Form(
        weight=1.2,
        spans=((1.0, 2.0), (0.36, 0.48), (0.36, 0.62)),
        stands=(("legs", 2), ("plinth", 1), ("sled", 1), ("castors", 0.7), ("floor", 0.5)),
        worktop=0.35,
        taste=Taste(
            module=(0.42, 0.95),
            drawer=(0.12, 0.22),
            rules=(("columns", 4.0), ("open_row", 0.5), ("stack", 0.5), ("closed", 1.2), ("open", 0.7)),
            fills=LOW,
            symmetry=0.95,
        ),
    ),
    "drawer_unit": Form(
        weight=0.5,
        spans=((0.3, 0.9), (0.4, 0.58), (0.5, 1.35)),
        stands=(("castors", 1.5), ("floor", 1.0), ("legs", 0.6), ("toe_kick", 0.6)),
        worktop=0.2,
        taste=Taste(
            module=(0.26, 0.9),
            drawer=(0.07, 0.16),
            rules=(("columns", 0.35), ("stack", 5.0)),
            fills=(("door", 1.0),),
        ),
    ),
}
