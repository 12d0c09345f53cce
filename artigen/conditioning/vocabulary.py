"""Words of sentences that belong to no kind: parts, places, features of parts, and words without a meaning.

Nouns and styles of kinds are in their records (`artigen.kind`).
"""

from collections.abc import Iterable
from typing import Literal

from artigen.kind import plurals
from artigen.shapes.fittings.handles import HANDLE_KINDS
from artigen.shapes.fittings.legs import LegKind
from artigen.types import PartLabel

_PARTS: dict[str, PartLabel] = {
    "drawer": "drawer",
    "door": "door",
    "lid": "door",
    "handle": "handle",
    "knob": "knob",
    "button": "knob",
    "dial": "knob",
    "tray": "tray",
    "rack": "tray",
    "shelf": "shelf",
    "wheel": "wheel",
    "castor": "wheel",
    "caster": "wheel",
    "pull": "handle",
    "grip": "handle",
    "basket": "tray",
    "flap": "door",
    "rocker": "knob",
    "gang": "knob",
    "sash": "door",
    "roller": "wheel",
}
"""Labels by singular nouns; sentences use the first of each."""
_PIECES = {
    "top": "top", "worktop": "top", "tabletop": "top", "countertop": "top", "topped": "top", "leg": "leg",
    "front": "front", "body": "body", "carcass": "body",
}  # fmt: skip
"""Finishes by nouns of pieces that are no part of their own."""


def count_longest(phrases: Iterable[str]) -> int:
    """Words of the longest phrase."""
    return max(len(phrase.split()) for phrase in phrases)


def _with_plurals(nouns: dict[str, str]) -> dict[str, str]:
    irregular = {"body": "body/bodies"}
    more = plurals(*(irregular.get(noun, noun) for noun in nouns))
    return nouns | {more[noun]: named for noun, named in nouns.items()}


PART_NOUNS: dict[str, PartLabel] = dict(_PARTS)
PARTS: dict[str, PartLabel] = dict(zip(_with_plurals(dict(_PARTS)), (*_PARTS.values(),) * 2, strict=True))
"""Labels by nouns, singular and plural."""
RACKS = frozenset({"rack", "racks"})
"""Nouns of parts that name something else after another noun: a towel rack."""
PIECES = _with_plurals(_PIECES)
"""Finishes by nouns of pieces, singular and plural."""
LEGS = frozenset({"leg", "legs", "feet"})
"""Nouns of a stand; a foot is a length."""
AMBIGUOUS = frozenset({
    "door", "doors", "window", "windows", "switch", "switches", "freezer", "freezers", "box", "boxes",
    "lamp", "lamps", "tap", "taps", "bin", "bins", "hob", "hobs", "chest", "chests", "range", "ranges",
    "notebook", "french door", "french doors",
})  # fmt: skip
"""Nouns of kinds that also name a part of another kind, or something else."""
OTHERS = frozenset({
    "hair dryer", "hand dryer", "rice cooker", "slow cooker", "car door", "garage door", "dog door",
    "cat flap", "floor lamp", "ceiling lamp", "street lamp", "wall lamp", "lava lamp", "pool table",
    "billiard table", "ping pong table", "changing table", "flower pot", "plant pot", "tea pot",
    "coffee pot", "network switch", "lunch box", "juke box", "jewelry box", "jewellery box", "phone box",
    "window box", "music box", "shopping cart", "cooker hood", "range hood", "game console", "door mat",
    "door bell", "window sill", "toilet brush", "toilet paper", "toilet seat", "oven glove", "table cloth",
    "pot holder", "box spring", "switch board", "golf cart", "water cooler", "trap door", "toaster oven",
})  # fmt: skip
"""Nouns of things that end as the noun of a kind does, and are something else."""
CLAUSES = frozenset({
    "with", "without", "having", "has", "featuring", "containing", "holding", "including", "for",
    "under", "above",
})  # fmt: skip
"""Words after which nouns name parts or surroundings, not the object."""
ONES = frozenset({"one", "ones"})
"""Pronouns of parts that were named before."""

Feature = tuple[str, str, str]
"""Part, property, value."""
OUTLINES: dict[str, Feature] = {
    word: ("object", "outline", outline)
    for word, outline in (
        ("round", "round"), ("circular", "round"), ("oval", "oval"), ("elliptical", "oval"),
        ("square", "square"), ("rectangular", "rectangle"),
    )
}  # fmt: skip
"""Adjectives for the outline of an object from above."""

GLOSSES: dict[str, Feature] = {
    word: ("object", "surface", gloss)
    for gloss, words in {
        "matte": ("matte", "matt", "ultra matte"),
        "satin": ("satin", "semi gloss", "silky", "eggshell"),
        "glossy": ("gloss", "glossy", "high gloss", "deep gloss", "shiny", "high shine"),
    }.items()
    for word in words
}
"""Adjectives for how much the surface of an object mirrors."""

Spot = Literal["top", "bottom", "left", "right", "sides", "middle"]
"""Where parts are on the front of an object."""
SIDEWAYS: tuple[Spot, Spot] = ("left", "right")
SPOTS: dict[str, Spot] = {
    "on top": "top", "at the top": "top", "on the top": "top", "at top": "top", "above": "top",
    "at the bottom": "bottom", "on the bottom": "bottom", "at bottom": "bottom", "below": "bottom",
    "underneath": "bottom", "beneath": "bottom", "under it": "bottom", "below it": "bottom",
    "above it": "top", "under them": "bottom", "below them": "bottom", "above them": "top",
    "on both sides": "sides", "on either side": "sides", "at both sides": "sides", "on each side": "sides",
    "both sides": "sides", "either side": "sides", "at each end": "sides", "at either end": "sides",
    "at both ends": "sides", "at either side": "sides", "at each side": "sides",
    "per side": "sides", "left and right": "sides",
    "on the left and right": "sides", "on the left and on the right": "sides", "next to it": "right",
    "beside it": "right", "next to them": "right", "beside them": "right", "between them": "middle",
    "in between": "middle", "between": "middle",
    "in the middle": "middle", "in the centre": "middle", "in the center": "middle",
}  # fmt: skip
"""Phrases after, or before, the parts that they place."""
UPRIGHT: tuple[tuple[str, Spot], ...] = (
    ("upper", "top"), ("top", "top"), ("lower", "bottom"), ("bottom", "bottom"),
)  # fmt: skip
SPOTS |= {
    text.format(side): side
    for side in SIDEWAYS
    for text in (
        "on the {}",
        "on the {} side",
        "on the {} hand side",
        "on its {}",
        "on its {} side",
        "at the {}",
        "on {}",
        "to the {}",
    )
}
SPOTS |= {
    f"in the {word} {noun}": spot for word, spot in UPRIGHT for noun in ("part", "half", "section", "row")
}
EDGES: dict[str, Spot] = {
    "top": "top", "upper": "top", "bottom": "bottom", "lower": "bottom", "left": "left", "right": "right",
    "middle": "middle", "central": "middle",
}  # fmt: skip
"""Adjectives of parts that place them."""
RELATIONS: dict[str, tuple[Spot, Spot]] = {
    **dict.fromkeys(("above", "over", "on top of", "atop"), ("top", "bottom")),
    **dict.fromkeys(("below", "under", "underneath", "beneath"), ("bottom", "top")),
    **dict.fromkeys(("left of", "to the left of", "on the left of"), ("left", "right")),
    **dict.fromkeys(("right of", "to the right of", "on the right of"), ("right", "left")),
    **dict.fromkeys(("beside", "next to", "alongside"), ("left", "right")),
}
"""Phrases between parts, and where the first and the second ones are."""
COMPARTMENTS = frozenset({"compartment", "niche", "section", "cubby", "cubbyhole", "space", "cell"})
"""Nouns that, after "open", name what an open shelf is, too."""
GRIDS = {"column": "columns", "columns": "columns", "row": "rows", "rows": "rows"}
"""How parts are divided: "in two columns"."""

APART: Feature = ("door", "hinged", "apart")
"""The feature of doors that are hinged at their outer sides."""
STACKED: Feature = ("door", "type", "stacked")
"""The feature of doors above each other."""
EXCLUSIVE = frozenset(
    {
        ("door", "hinged"),
        ("stand", "type"),
        ("freezer", "at"),
        ("leg", "type"),
        ("object", "outline"),
        ("object", "surface"),
    }
)
"""Properties that have one value."""
LEVEL: Feature = ("door", "type", "side by side")
"""The feature of doors beside each other."""


LEG_WORDS: dict[LegKind, tuple[str, ...]] = {
    "turned": ("turned",), "cabriole": ("cabriole",), "tapered": ("tapered",),
    "round": ("round", "cylindrical"), "square": ("square", "straight"), "splayed": ("splayed", "angled"),
}  # fmt: skip
"""Adjectives of legs."""


def _features() -> dict[str, Feature]:
    found: dict[str, Feature] = {
        "freezer drawer": ("freezer", "type", "drawer"),
        "freezer drawers": ("freezer", "type", "drawer"),
        "side by side": LEVEL,
        "stacked": STACKED,
        "one above the other": STACKED,
        "on top of each other": STACKED,
        "push to open": ("handle", "type", "none"),
        "on legs": ("stand", "type", "legs"),
        "on feet": ("stand", "type", "feet"),
        "on a plinth": ("stand", "type", "plinth"),
        "lockable": ("lock", "type", "lock"),
        "with a lock": ("lock", "type", "lock"),
    }
    for where in ("top", "bottom"):
        for text in (
            "{} freezer",
            "{} mounted freezer",
            "{} mount freezer",
            "freezer at the {}",
            "freezer on the {}",
            "freezer on {}",
            "freezer at {}",
        ):
            found[text.format(where)] = ("freezer", "at", where)
    for word in ("above", "below", "underneath", "beneath"):
        found[f"freezer {word}"] = ("freezer", "at", SPOTS[word])
    for side in ("left", "right", "top", "bottom"):
        for link in ("on the", "at the", ""):
            for verb in ("hinged", "hinges", "hinge", "hinging"):
                found[" ".join(filter(None, (verb, link, side)))] = ("door", "hinged", side)
        for verb in ("hinged", "hinges", "hand hinge", "hand hinges", "hand hinged"):
            found[f"{side} {verb}"] = ("door", "hinged", side)
    for side in ("left", "right"):
        for verb in ("open to the", "opens to the", "opening to the"):
            found[f"{verb} {side}"] = ("door", "hinged", side)
    for verb in ("hinged", "hinges"):
        for text in ("on both sides", "on either side", "on the outside", "left and right", "apart"):
            found[f"{verb} {text}"] = APART
    for noun in ("door", "doors", "flap", "flaps"):
        for word in ("flap", "drop down", "pulldown", "drop front"):
            found[f"{word} {noun}"] = ("door", "hinged", "bottom")
        found[f"lift up {noun}"] = ("door", "hinged", "top")
        found[f"mirror {noun}"] = ("door", "type", "mirrored")
    for word, kind in (("glass", "glass"), ("glazed", "glass")):
        for noun in ("door", "doors", "front", "fronts", "fronted", "pane", "panes"):
            found[f"{word} {noun}"] = ("door", "material", kind)
    for kind in ("sliding", "folding", "french", "mirrored", "louvred"):
        for noun in ("door", "doors"):
            found[f"{kind} {noun}"] = ("door", "type", kind)
    for kind in HANDLE_KINDS:
        for noun in ("handle", "handles", "pull", "pulls"):
            found[f"{kind} {noun}"] = ("handle", "type", kind)
    for kind, words in LEG_WORDS.items():
        found |= {
            f"{word} {noun}": ("leg", "type", kind) for word in words for noun in ("legs", "leg", "feet")
        }
    for noun in ("castors", "casters", "wheels", "rollers"):
        found[f"on {noun}"] = ("wheel", "type", "castor" if noun != "wheels" else "wheel")
    for text, stand in (
        ("no legs", "floor"), ("without legs", "floor"), ("no feet", "floor"), ("without feet", "floor"),
        ("plinth", "plinth"), ("with a plinth", "plinth"), ("toe kick", "plinth"),
        ("with a toe kick", "plinth"),
    ):  # fmt: skip
        found[text] = ("stand", "type", stand)
    return found


FEATURES = _features()
"""Properties of parts by phrases."""
GLAZED: Feature = ("door", "material", "glass")
"""The feature of doors with panes."""
STYLES: dict[Feature, str] = {
    GLAZED: "framed_glass",
    ("door", "type", "sliding"): "sliding",
    ("door", "type", "mirrored"): "mirrored",
    ("door", "type", "louvred"): "louvre",
}
"""Styles that have a feature, for the kinds that have such a style."""
BARE: Feature = ("handle", "type", "none")
"""The feature of fronts without handles."""
CORRECTIONS = (
    ("no", ",", "make"), ("no", ","), ("actually", ","), ("actually",), ("sorry", ","), ("wait", ","),
    ("i", "mean"),
    ("scratch", "that"), ("or", "rather"), ("better",),
)  # fmt: skip
"""Phrases after which a value replaces the one that was given before."""
ROOMS = frozenset({
    "kitchen", "bathroom", "bedroom", "living", "hall", "hallway", "office", "laundry", "utility", "garage",
    "guest", "nursery", "home", "room", "entryway", "study",
})  # fmt: skip
"""Words for where an object is used; some nouns and styles of kinds begin with one."""
FILLERS = ROOMS | frozenset({
    "a", "an", "the", "and", "or", "of", "for", "in", "it", "its", "is", "are", "that", "which", "to",
    "on", "at", "by", "with", "has", "have", "having", "made", "painted", "finished", "coloured",
    "colored", "finish", "i", "we", "you", "want", "would", "like", "should", "must", "can", "could", "be",
    "please", "me", "one", "featuring", "piece", "from", "each",
    "all", "both", "some", "any", "about", "roughly", "approximately", "around", "x", "but", "make",
    "draw", "create", "generate", "give", "need", "my", "our", "new", "either", "nor", "neither",
    "hinged", "them", "different", "various", "several", "whose", "where", "there", "then", "plus", "only",
    "style", "styled", "pullout", "medium", "sized", "standard", "ordinary", "normal", "typical", "regular",
})  # fmt: skip
"""Words without a meaning of their own."""
