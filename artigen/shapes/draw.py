"""`draw_shape`: a procedural object of any category, a pure function of category, seed and wish.

A category is the name of an `artigen.kind.Kind`. Its record has the styles that a wish may name, and
``draw(rng, wish) -> Draft``.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal
from zlib import crc32

import numpy as np

from artigen.errors import ArtigenError, name_options
from artigen.kind import Size, Spans, kinds, list_nouns
from artigen.shapes.choices import Word, choose, pick
from artigen.shapes.fittings.handles import HandleKind
from artigen.shapes.fittings.legs import LegKind
from artigen.shapes.furniture.layouts import Layout
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.types import PartLabel

if TYPE_CHECKING:
    from artigen.shapes.fittings.feet import StandKind

MAX_DRAWS = 1000
FEW_DRAWS = 100
"""Draws after which a count of more than twice the largest one seen, and one more, or of less than the least,
is given up."""
CROWDED_DRAWS = 10
"""Draws with other lengths of an object with free lengths before it is given up as too large."""
VARIANTS = 100
"""Draws of a variant of a template; the last one has the template's lengths."""
SHARED_DRAWS = 20
"""Draws of an object with one set of choices of its suite before the next set."""
SEARCHED = 500
"""Seeds that are searched for an object with given counts."""
SIZE_MARGIN = 0.2
"""Share by which a wished length may exceed the usual range of categories without arbitrary sizes."""
LENGTHS = (0.02, 10.0)
"""Range of wished lengths (m)."""


class ShapeError(ArtigenError):
    """No object of the category meets the wish, or there is no such category."""


class CrowdedError(ShapeError):
    """Every layout drawn at these lengths exceeds the limits of engines on parts or hulls."""


Outline = Literal["round", "oval", "square", "rectangle"]


@dataclass(frozen=True, kw_only=True)
class Wish:
    """Requested properties; None is sampled from the seed. Lengths in metres."""

    width: float | None = None
    depth: float | None = None
    height: float | None = None
    style: str | None = None
    counts: tuple[tuple[PartLabel, int], ...] = ()
    """Exact number of parts by label; labels that are not named are free."""
    handles: tuple[HandleKind, ...] = ()
    """Kinds of handles in order of preference; an object has the first one that its category offers."""
    legs: LegKind | None = None
    """Kind of legs, for what stands on legs and offers it."""
    outline: Outline | None = None
    """Of the top, from above, for kinds with tops of several outlines."""
    suite: int | None = None
    """Seed of the choices that objects of one suite share: handles, fitting of fronts, stands, worktops."""
    layout: Layout | None = None
    """The front as given, for kinds that can be laid out; handles are then of the first preferred kind."""

    def shared_stream(self, rng: np.random.Generator, attempt: int = 0) -> np.random.Generator:
        """The random stream of choices that objects of a suite share; ``rng`` without a suite.

        After `SHARED_DRAWS` unsuccessful draws, an object uses the suite's next choices.
        """
        return rng if self.suite is None else np.random.default_rng([self.suite, attempt // SHARED_DRAWS])

    def choose_handles(self, offered: tuple[HandleKind, ...]) -> tuple[HandleKind, ...]:
        """The kinds of handles to draw from: as many as offered, all equal to the preferred one."""
        if self.layout is not None and self.handles:  # they were seen
            return self.handles[:1] * len(offered)
        for kind in self.handles:
            if kind in offered:
                return (kind,) * len(offered)
        return offered

    def choose_legs(self, offered: Sequence[LegKind]) -> Sequence[LegKind]:
        """The kinds of legs to draw from: as many as offered, all equal to the wished one."""
        return offered if self.legs is None else (self.legs,) * len(offered)

    def choose_stands(self, offered: Mapping["StandKind", float]) -> dict["StandKind", float]:
        """Weights of the kinds of stands to draw from: legs where a kind of them is wished for, those of the
        layout, or all offered."""
        weights: dict[StandKind, float] = dict(offered)
        if self.legs is not None and "legs" in {*offered, *(self.layout.stands if self.layout else ())}:
            return {"legs": 1.0}
        if self.layout is None or not self.layout.stands:
            return weights
        wished: dict[StandKind, float] = {}
        wished |= {kind: weights.get(kind, 0.0) for kind in self.layout.stands}
        return wished if any(wished.values()) else dict.fromkeys(wished, 1.0)


@dataclass(frozen=True, eq=False)
class Draft:
    """Result of a category's draw function: a `Shape` without its name."""

    style: str
    parts: tuple[ShapePart, ...]
    finishes: Mapping[str, Finish]


def draw_shape(category: str, seed: int, wish: Wish | None = None) -> Shape:
    """Draws one object; the same arguments give the same object on every run.

    Counts are met by rejection: at most `MAX_DRAWS` draws from streams derived from the seed, and far fewer
    where the counts are unlikely to be met.

    Raises:
        ShapeError: If the category or its style is unknown, a length is out of bounds, or no draw has
            the requested counts.
    """
    wish = wish or Wish()
    draft, _ = _draw_draft(category, seed, wish)
    return _make_shape(category, seed, draft)


def draw_variant(
    category: str, like: int, seed: int, fits: Callable[[Shape], bool], wish: Wish | None = None
) -> Shape:
    """Draws an object with the topology of another one, in other sizes and materials.

    The choices of the template are repeated and its lengths drawn anew. Where that changes the topology,
    lengths nearer to those of the template are tried, in `VARIANTS` steps.

    Args:
        category: What to draw.
        like: Seed of the template object.
        seed: Seed of lengths and materials.
        fits: Decides whether an object has the topology of the template.
        wish: Requested properties of both.

    Raises:
        ShapeError: As `draw_shape`; and if nothing fits, not even the template itself.
    """
    wish = wish or Wish()
    _, attempt = _draw_draft(category, like, wish)
    looks = _draw_draft(category, seed, replace(wish, counts=()))[0].finishes
    key = crc32(category.encode())
    for step in range(VARIANTS):
        bits = np.random.PCG64(np.random.SeedSequence([key, like, attempt]))
        rng = _Varied(bits, np.random.default_rng([key, seed, step]), 1.0 - (step / (VARIANTS - 1)) ** 2)
        try:
            draft = kinds()[category].draw(rng, wish)
        except CrowdedError:
            continue
        worn = {role: wear(own, looks.get(role) or own) for role, own in draft.finishes.items()}
        shape = _make_shape(category, seed, replace(draft, finishes=worn))
        if fits(shape):
            return shape
    raise ShapeError(f"{category}: none of {VARIANTS} variants of seed {like} by seed {seed} fits it")


def find_seed(
    category: str, counts: tuple[tuple[PartLabel, int], ...], wish: Wish | None = None, most: int = SEARCHED
) -> int:
    """Finds the first seed whose object has these part counts; labels that are not named are free.

    Args:
        category: What to draw.
        counts: Exact number of parts by label.
        wish: Other requested properties.
        most: Number of seeds to try, from 0 on.

    Raises:
        ShapeError: As `draw_shape`; and if none of the seeds has the counts, with those that were most
            frequent.
    """
    seen: Counter[str] = Counter()
    for seed in range(most):
        try:
            held = dict(draw_shape(category, seed, wish).condition.counts)
        except CrowdedError:
            continue
        found = {label: held.get(label, 0) for label, _ in counts}
        if found == dict(counts):
            return seed
        seen[", ".join(f"{count} {label}" for label, count in found.items())] += 1
    wanted = ", ".join(f"{count} {label}" for label, count in counts)
    near = "; ".join(text for text, _ in seen.most_common(5))
    raise ShapeError(f"{category}: none of {most} seeds has {wanted}; most frequent were {near}")


class _Varied(np.random.Generator):
    """Decides as one stream does, and takes lengths from another: ``spread`` of the way to what it says."""

    def __init__(self, bits: np.random.BitGenerator, lengths: np.random.Generator, spread: float) -> None:
        super().__init__(bits)
        self._lengths, self._spread = lengths, spread

    def uniform(self, *args, **kwargs):
        """Between the two streams' numbers."""
        own = super().uniform(*args, **kwargs)
        return own + self._spread * (self._lengths.uniform(*args, **kwargs) - own)

    def dirichlet(self, *args, **kwargs):
        """Between the two streams' shares."""
        own = super().dirichlet(*args, **kwargs)
        return own + self._spread * (self._lengths.dirichlet(*args, **kwargs) - own)

    def spawn(self, n_children: int) -> list[np.random.Generator]:
        """Pairs of the two streams' children."""
        pairs = zip(self.bit_generator.spawn(n_children), self._lengths.spawn(n_children), strict=True)
        return [_Varied(bits, lengths, self._spread) for bits, lengths in pairs]


def wear(own: Finish, other: Finish) -> Finish:
    """The other finish, unless only one of the two can be seen through."""
    return other if (own.opacity < 1.0) == (other.opacity < 1.0) else own


def _make_shape(category: str, seed: int, draft: Draft) -> Shape:
    finishes = tuple(sorted(draft.finishes.items()))
    return Shape(category=category, seed=seed, style=draft.style, parts=draft.parts, finishes=finishes)


def _draw_draft(category: str, seed: int, wish: Wish) -> tuple[Draft, int]:
    """The first draft that has the counts wished for, and how many came before it."""
    check_known(category, wish)
    known = kinds()
    seen: Counter[str] = Counter()
    most: Counter[str] = Counter()
    least: dict[str, int] = {}
    free = None in (wish.width, wish.depth, wish.height)
    crowded = 0
    for attempt in range(MAX_DRAWS):
        if attempt == FEW_DRAWS and any(
            2 * most[label] + 1 < count or count < least.get(label, 0) for label, count in wish.counts
        ):
            break
        rng = np.random.default_rng([crc32(category.encode()), seed, attempt])
        try:
            draft = known[category].draw(rng, wish)
        except CrowdedError:
            crowded += 1
            if crowded == CROWDED_DRAWS or not free:
                raise
            continue
        held = Counter(part.label for part in draft.parts)
        if all(held[label] == count for label, count in wish.counts):
            return draft, attempt
        seen[", ".join(f"{held[label]} {label}" for label, _ in wish.counts)] += 1
        most |= held
        least = {label: min(held[label], least.get(label, held[label])) for label, _ in wish.counts}
    wanted = ", ".join(f"{count} {label}" for label, count in wish.counts)
    near = "; ".join(text for text, _ in seen.most_common(5))
    raise ShapeError(f"{category}: no draw of {seen.total()} has {wanted}; most frequent were {near}")


def check_known(category: str, wish: Wish) -> None:
    """Refuses what no object of a category can be.

    Raises:
        ShapeError: If the category or its style is unknown, or its fronts cannot be laid out as wished for;
            and as `check_wish`.
    """
    check_wish(wish)
    known = kinds()
    if category not in known:
        raise ShapeError(
            f"category {category!r} is not known, expected {name_options(category, known, list_nouns())}"
        )
    if wish.layout is not None and not known[category].laid_out:
        able = ", ".join(name for name, kind in known.items() if kind.laid_out)
        raise ShapeError(f"{category}: its fronts cannot be laid out; categories that can: {able}")
    if wish.style is not None and wish.style not in (styles := known[category].styles):
        raise ShapeError(
            f"{category}: style {wish.style!r} is not known, expected {name_options(wish.style, styles)}"
        )


def check_wish(wish: Wish) -> None:
    """Refuses what no object of any category can be.

    Raises:
        ShapeError: If a length is out of bounds, or more or less than one base is wished for.
    """
    for name in ("width", "depth", "height"):
        length = getattr(wish, name)
        if length is not None and not LENGTHS[0] <= length <= LENGTHS[1]:
            raise ShapeError(f"{name} {length:g} m: expected from {LENGTHS[0]:g} to {LENGTHS[1]:g} m")
    for label, count in wish.counts:
        if label == "base" and count != 1:
            raise ShapeError(f"{count} parts called base: every object has one")


def find_nearest(wish: Wish, sizes: Mapping[Word, Spans]) -> tuple[Word, ...]:
    """The words whose ranges of width, depth and height (m) hold the lengths wished for, or come nearest.

    All of them where no length is wished for.
    """
    wanted = (wish.width, wish.depth, wish.height)
    misses = {
        word: sum(
            max(low - length, length - high, 0.0)
            for length, (low, high) in zip(wanted, spans, strict=True)
            if length is not None
        )
        for word, spans in sizes.items()
    }
    least = min(misses.values())
    return tuple(word for word, miss in misses.items() if miss <= least)


def pick_nearest(
    rng: np.random.Generator, wish: Wish, weights: Mapping[Word, float], sizes: Mapping[Word, Spans]
) -> Word:
    """One of the words of ``sizes`` that `find_nearest` finds, as likely as its weight."""
    return pick(rng, {word: weights[word] for word in find_nearest(wish, sizes)})


def choose_size(rng: np.random.Generator, category: str, wish: Wish, spans: Spans) -> Size:
    """Width, depth and height (m): the wished ones, or uniform ones; every call takes three numbers.

    Raises:
        ShapeError: If a wish is less than the shortest usual length, or more than the longest, by over
            `SIZE_MARGIN`.
    """
    for name, (low, high) in zip(("width", "depth", "height"), spans, strict=True):
        wished = getattr(wish, name)
        least, most = low * (1.0 - SIZE_MARGIN), high * (1.0 + SIZE_MARGIN)
        if wished is not None and not least <= wished <= most:
            raise ShapeError(
                f"{category}: {name} {wished:g} m, expected from {least:.3g} to {most:.3g} m for this style"
            )
    return choose_lengths(rng, wish, spans)


def choose_lengths(rng: np.random.Generator, wish: Wish, spans: Spans) -> Size:
    """Width, depth and height (m), in this order: the wished ones, or uniform ones within their spans."""
    wished = (wish.width, wish.depth, wish.height)
    width, depth, height = (
        choose(rng, low, high, one) for (low, high), one in zip(spans, wished, strict=True)
    )
    return width, depth, height
