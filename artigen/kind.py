"""`Kind`: every fact about a kind of object, in one record, and how records are found.

Each module of `artigen.kinds` with a ``KIND`` adds a kind; ``CATEGORIES`` of `artigen.kinds.foreign` are the
categories that only sources have. All other code asks here. Records are imported on first use, because they
hold the functions that draw, which belong to a layer above.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import Any, Literal

import numpy as np

from artigen.plugins import PluginError, find_plugins

Range = tuple[float, float]
Size = tuple[float, float, float]
"""Three extents (m)."""
Spans = tuple[Range, Range, Range]
"""Ranges of width, depth and height (m)."""
Extent = Literal["height", "width", "longest"]
MaterialName = Literal[
    "wood_board",
    "steel_sheet",
    "steel",
    "glass",
    "insulating_glass",
    "plastic",
    "rubber",
    "stone",
    "foam_panel",
]
Build = Literal["board", "sheet", "foam", "plastic", "metal", "weighted"]
"""What walls are: wood board; sheet metal, with racks of steel; the same with thick walls of foam; mouldings;
tubes and folded sheet; board on a base of china, concrete or cast iron."""
Stands = Literal["free", "mounted", "held"]
"""``free``: on a floor or a worktop, by itself. ``mounted``: fixed to a building. ``held``: in a hand."""
Trade = Literal["furniture", "joinery", "appliance", "fittings"]
"""Kinds of one trade match in a suite."""
Holds = Literal["things", "food"]
Board = Literal["top", "side", "back", "plate"]
"""Faces of a body that may be whole boards; the plate is in front, around the door."""
EVERY, NONE = "every", "none"
"""In place of a style: a word is true of every object of a kind, or of none."""
PHYSICAL_OBJECT = "Q223557"
"""Wikidata's item of physical objects in general."""


@dataclass(frozen=True, kw_only=True)
class SizeRule:
    """``extent`` is ``metres`` long when height over the larger footprint edge is at most ``up_to``."""

    extent: Extent
    metres: float
    up_to: float = np.inf
    note: str = ""


def by_height(metres: float, up_to: float = np.inf, note: str = "") -> SizeRule:
    """A rule for the height."""
    return SizeRule(extent="height", metres=metres, up_to=up_to, note=note)


def by_width(metres: float, up_to: float = np.inf, note: str = "") -> SizeRule:
    """A rule for the width."""
    return SizeRule(extent="width", metres=metres, up_to=up_to, note=note)


def by_longest(metres: float, up_to: float = np.inf, note: str = "") -> SizeRule:
    """A rule for the longest edge."""
    return SizeRule(extent="longest", metres=metres, up_to=up_to, note=note)


def plurals(*nouns: str) -> dict[str, str]:
    """Nouns with their plurals; an irregular plural follows its noun after a stroke: ``shelf/shelves``."""
    return {noun.split("/")[0]: noun.split("/")[-1] if "/" in noun else _plural(noun) for noun in nouns}


def _plural(noun: str) -> str:
    if noun.endswith("shelf"):
        return noun.removesuffix("f") + "ves"
    if noun.endswith("y") and noun[-2] not in "aeiou":
        return noun.removesuffix("y") + "ies"
    hissing = noun.endswith(("s", "x", "z", "ch", "sh"))
    return noun + ("es" if hissing else "s")


@dataclass(frozen=True, kw_only=True)
class Make:
    """Differences from the materials' usual walls, and hidden mass of the base."""

    density: Mapping[MaterialName, float]
    """Mean density of walls as drawn (kg/m^3), in place of that of the material."""
    wall: Mapping[MaterialName, float]
    """Real wall thickness (m); thicker drawn walls have the mass of this thickness."""
    hidden: float
    """Hidden mass in the base (kg)."""
    filled: float
    """Hidden mass by the volume of the box around the base (kg/m^3)."""


def make(
    density: Mapping[MaterialName, float] | None = None,
    wall: Mapping[MaterialName, float] | None = None,
    hidden: float = 0.0,
    filled: float = 0.0,
) -> Make:
    """A make that differs from the usual walls in what is given."""
    return Make(density=density or {}, wall=wall or {}, hidden=hidden, filled=filled)


PLAIN = make()


@dataclass(frozen=True, kw_only=True)
class Place:
    """A role in a room that a kind can fill. Sizes are depth, width and height (m), handles included."""

    role: str
    low: Size
    high: Size
    draws: tuple[Size, ...] = ()
    """Objects to draw without a folder of packages, by desired size; 0 samples it from the seed."""
    joint: str | None = None
    """Kind of joint that a package must have."""
    along: Range = (0.2, 0.5)
    """In a run of units: weight, and share of the run's length at which the kind belongs."""


@dataclass(frozen=True, kw_only=True)
class Channel:
    """Number of a category's channel in the paper's grids, and how voxels of its objects are cleaned up."""

    number: int
    boards: tuple[Board, ...]
    """Faces of the body that are whole boards."""
    round_door: bool
    """Whether doors are round even where no drum is behind them."""


@dataclass(frozen=True, kw_only=True)
class Category:
    """What is known of objects by the name of their category, be it a kind or only known from sources."""

    name: str
    nouns: Mapping[str, str]
    """Singular and plural nouns, British and American; sentences name it by the first."""
    hints: tuple[str, ...]
    """Further words for it in names of files."""
    size: tuple[SizeRule, ...]
    """Sizes of sources that have no unit, by their proportions; the last rule has no limit."""
    deepest: float
    """Largest depth (m) of such sources."""
    diagonal: Range | None
    """Plausible diagonals (m) of the bounding box; None where any object's range applies."""
    build: Build | None
    """None where it is not known; board is assumed."""
    stands: Stands


@dataclass(frozen=True, kw_only=True, repr=False)
class Kind(Category):
    """A kind of object that the grammar draws. A record without one of the facts cannot be constructed."""

    styles: tuple[str, ...]
    style_words: Mapping[str, str]
    """Styles by words that name them, besides their own names; `EVERY` for words that are true of every
    object of the kind, `NONE` for those that are true of none."""
    forms: Mapping[str, Spans]
    """Usual widths, depths and heights (m) by nouns that say more than the kind: a desk among tables."""
    sizes: Spans
    """Plausible widths, depths and heights (m) of closed objects; a request outside of them is an error."""
    bare: Literal["width", "height"] | None
    """What a length without a direction measures: "a 60 cm dishwasher"; None for something else."""
    make: Make
    makes: Mapping[str, Make]
    """Makes of the styles that differ."""
    feet: bool
    """Whether levelling feet may be added under sources that would topple."""
    trade: Trade | None
    synset: str | None
    """WordNet 3.0."""
    wikidata: str | None
    partnet: str | None
    """Category of such objects in PartNet-Mobility."""
    body: str
    """Word for the body in ``semantics.txt``."""
    places: tuple[Place, ...]
    """Roles that it fills in rooms."""
    holds: Holds | None
    """What is put into compartments behind its doors and on its trays."""
    open_front: float | None
    """Share of the closed front through which the inside may show; None with open compartments."""
    lid_stays: bool
    """Whether lids stay wherever they are left."""
    colored: tuple[str, ...]
    """Finishes, besides body and front, that take the colour of the whole object."""
    laid_out: bool
    """Whether a wish may lay out its fronts."""
    channel: Channel | None
    word: int | None
    """Number of its word in shipped networks; None before one is trained with it."""
    draw: Callable[..., Any]
    """``draw(rng, wish) -> Draft``, as `artigen.shapes.draw` calls it."""

    def __post_init__(self) -> None:
        lost = sorted({*self.makes, *self.style_words.values()} - {*self.styles, EVERY, NONE})
        if lost:
            raise ValueError(
                f"kind {self.name}: styles {', '.join(lost)} are not listed, "
                f"expected {', '.join(self.styles)}"
            )
        strange = sorted(set(self.forms) - set(self.nouns))
        if strange:
            raise ValueError(f"kind {self.name}: sizes of {', '.join(strange)}, which are none of its nouns")
        if not self.nouns:
            raise ValueError(f"kind {self.name} has no noun; give singular and plural")

    def __repr__(self) -> str:
        return f"<{self.name}: {next(iter(self.nouns))}; styles {', '.join(self.styles)}>"

    def find_make(self, style: str | None = None) -> Make:
        """The make of the kind, or of one of its styles."""
        return self.makes.get(style or "", self.make)


@cache
def kinds() -> Mapping[str, Kind]:
    """The kinds of the grammar by name, sorted, with those that extensions add.

    Raises:
        PluginError: If an extension cannot be loaded or adds a name or a noun that exists.
    """
    package = import_module("artigen.kinds")
    modules = [import_module(f"{package.__name__}.{found.name}") for found in iter_modules(package.__path__)]
    records: list[Kind] = [module.KIND for module in modules if hasattr(module, "KIND")]
    for plugin in find_plugins("artigen.kinds", Kind):
        added: Kind = plugin.value
        taken = {word for kind in records for word in (kind.name, *kind.nouns)} & {added.name, *added.nouns}
        if taken or added.word is not None:
            said = f"{', '.join(sorted(taken))} exist" if taken else f"word {added.word} is not None"
            raise PluginError(f"{plugin.origin}: kind {added.name}: {said}; choose others")
        records.append(added)
    return {kind.name: kind for kind in sorted(records, key=lambda kind: kind.name)}


@cache
def _nouns() -> Mapping[str, str]:
    """Kinds by their nouns, singular and plural."""
    return {word: kind.name for kind in kinds().values() for pair in kind.nouns.items() for word in pair}


@cache
def _categories() -> Mapping[str, Category]:
    """Everything that is known by name: names of PartNet-Mobility lead to the kinds that they hold."""
    foreign = import_module("artigen.kinds.foreign").CATEGORIES
    known: dict[str, Category] = {category.name: category for category in foreign}
    known |= {kind.partnet: kind for kind in kinds().values() if kind.partnet is not None}
    return {**known, **kinds()}


def find_category(name: str) -> Category | None:
    """What is known of a category; None for an unknown one."""
    return _categories().get(name)


def find_kind(name: str) -> Kind | None:
    """The kind with a name, its own or that of PartNet-Mobility; None for other categories."""
    found = _categories().get(name)
    return found if isinstance(found, Kind) else None


def find_noun(noun: str) -> Kind | None:
    """The kind that a noun names, singular or plural; None for any other word."""
    name = _nouns().get(noun)
    return None if name is None else kinds()[name]


def name_kind(noun: str) -> str:
    """The name of the kind that a noun names.

    Raises:
        ValueError: If it names none.
    """
    kind = find_noun(noun)
    if kind is None:
        raise ValueError(f"{noun!r} names no kind, expected one of {', '.join(list_nouns())}")
    return kind.name


def spell_kind(word: str) -> str:
    """The name of the kind that a word says, a name or a noun in any case; unknown words are unchanged."""
    kind = find_kind(word) or find_noun(" ".join(word.lower().split()))
    return word if kind is None else kind.name


def list_nouns() -> tuple[str, ...]:
    """All nouns of kinds, singular and plural."""
    return tuple(_nouns())


def list_categories() -> tuple[Category, ...]:
    """All kinds, and the categories that only sources have, each once, sorted by name."""
    return tuple(sorted({known.name: known for known in _categories().values()}.values(), key=_name))


def list_words() -> tuple[str, ...]:
    """Names of all kinds in the order of the networks' words; kinds without one last, sorted by name."""
    order = sorted(kinds().values(), key=lambda kind: (kind.word is None, kind.word or 0, kind.name))
    return tuple(kind.name for kind in order)


@cache
def paper_kinds() -> tuple[str, ...]:
    """The seven categories of the paper, in the order of the category channels."""
    found = {kind.channel.number: name for name, kind in kinds().items() if kind.channel is not None}
    return tuple(found[number] for number in sorted(found))


def forget() -> None:
    """Makes the next look-up find kinds that were added or removed since the first."""
    for found in (kinds, _nouns, _categories, paper_kinds, find_plugins):
        found.cache_clear()


def _name(category: Category) -> str:
    return category.name
