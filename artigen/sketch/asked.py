"""`ask` and `draw_asked`: words, numbers and a photograph become one condition, and the condition an object.

What people say overrules what a photograph shows; what neither says comes from the seed.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float

from artigen.conditioning.image import is_cut_out, open_picture
from artigen.conditioning.measures import AXES, Axis
from artigen.conditioning.read import check_size
from artigen.errors import ArtigenError
from artigen.kind import kinds
from artigen.reader.correct import correct_reading
from artigen.reader.layout.build import build_from_reading
from artigen.reader.layout.colours import match_finish
from artigen.reader.layout.fronts import view_fronts
from artigen.reader.open_reading import open_reading
from artigen.reader.read import read_photo
from artigen.reader.reading import Reading
from artigen.shapes.draw import Wish, check_known
from artigen.shapes.shape import Shape
from artigen.sketch import model
from artigen.sketch.arrange import MOST_DOORS, NARROW_DOOR
from artigen.sketch.draw import DrawConfig
from artigen.sketch.extents import settle_extents
from artigen.sketch.model import Drawn, SketchConfig
from artigen.sketch.network import SketchNetwork
from artigen.sketch.request import FinishRequest, SketchRequest, encode_request
from artigen.sketch.told import Told, draw_told, list_unworn
from artigen.sketch.understand import Request, Understood, understand
from artigen.sketch.words import CATEGORIES

BATCHES = 24
"""Batches of the sketch network, some 8 s of one core, before the grammar draws what words ask for.

Of 60 draws, two of each kind, 52 are sound by then and 53 after twice as many. Pictures have twice as many,
because the grammar cannot draw by them.
"""
HELD = 0.8
"""Share of its box that an object holds."""
POLISHED = ("lacquer", "wood", "plastic")
"""Kinds of finishes whose gloss words change."""
NAMED = ("door", "drawer", "handle")
"""Parts whose number a reading takes from words."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Asked:
    """Everything that is asked for.

    With a reading, the grammar draws: ``reading`` is what was read, corrected by what was said, ``wish`` has
    lengths, style and handles, and finishes of the request overrule colours. Without, the sketch network
    draws ``request``, a cut-out ``picture`` beside it, and the grammar what of ``told`` that does not meet.
    """

    request: SketchRequest
    notes: tuple[str, ...] = ()
    told: Told = field(default_factory=Told)
    reading: Reading | None = None
    wish: Wish = field(default_factory=Wish)
    picture: Float[np.ndarray, "4 S S"] | None = None


def ask(
    request: Request,
    network: Callable[[], SketchNetwork],
    seed: int = 0,
    learned: Sequence[str] = CATEGORIES,
) -> Asked:
    """Reads words and picture of a request, and merges them.

    Args:
        request: What a user gave.
        network: Loads the sketch network, which a photograph does not need.
        seed: Of the usual sizes that adjectives such as "tall" refer to.
        learned: Kinds that the sketch network draws.

    Raises:
        ArtigenError: If the picture cannot be read, or the request cannot be met.
    """
    understood = understand(request, learned)
    if request.reading is not None:
        if request.box is not None:
            raise ArtigenError(
                f"{request.reading} and a box: the reading is of one object already; give one of them"
            )
        return merge_reading(understood, open_reading(request.reading))
    if request.image is None:
        return _ask_sketch(understood, network, seed, None)
    image = open_picture(request.image)
    if is_cut_out(image):  # cut-outs are what the sketch network itself has learned to read
        shown = model.read_object_picture(network(), request.image)
        asked = _ask_sketch(understood, network, seed, shown.rgba)
        return replace(asked, notes=(*asked.notes, *shown.notes))
    return merge_reading(understood, _read_once(request.image, _stamp(request.image), request.box))


def _stamp(path: Path) -> tuple[int, int] | None:
    """When a file was written, and its size; None where there is none, which its reader reports."""
    try:
        held = path.stat()
    except OSError:
        return None
    return held.st_mtime_ns, held.st_size


@lru_cache(maxsize=4)
def _read_once(
    image: Path,
    stamp: tuple[int, int] | None,
    box: tuple[float, float, float, float] | None,
) -> Reading:
    """A photograph is read once for all checks and draws of a process, until the file changes."""
    return read_photo(image, box=box)


def _ask_sketch(
    understood: Understood,
    network: Callable[[], SketchNetwork],
    seed: int,
    picture: Float[np.ndarray, "4 S S"] | None,
) -> Asked:
    """What the sketch network is asked for: adjectives are resolved to extents."""
    request = understood.request
    encode_request(request)
    factors = dict(understood.stretch)
    rng = np.random.default_rng([seed, 79])
    told = Told(features=understood.features, places=understood.places)
    spans = {axis: _make_room(span, request) if axis == "width" else span for axis, span in understood.usual}
    usual = {axis: float(rng.uniform(*span)) * factors.pop(axis, 1.0) for axis, span in spans.items()}
    given, request, notes = request, replace(request, **usual), understood.notes
    if request.category is not None:
        request = settle_extents(request, given, understood.ranges, understood.ratios, factors, seed)
    elif understood.ranges or understood.ratios:
        notes = (*notes, "ranges and proportions are met of a kind that is named: name it")
    factors = {axis: factor for axis, factor in factors.items() if getattr(request, axis) is None}
    headed = bool(factors) or understood.volume is not None  # by usual extents, which a header has
    encoded = model.encode_picture(network(), picture) if picture is not None and headed else None
    if factors:
        drawn = model.draw_header(network(), request, seed, encoded=encoded)
        request = replace(
            request, **{axis: factor * getattr(drawn, axis) for axis, factor in factors.items()}
        )
    if understood.volume is not None:
        drawn = model.draw_header(network(), request, seed, encoded=encoded)
        request = _hold(request, drawn, understood)
    if headed:
        encode_request(request)
    return Asked(request=request, notes=notes, told=told, picture=picture)


def _hold(request: SketchRequest, drawn: SketchRequest, understood: Understood) -> SketchRequest:
    """The request with extents that are usual of each other and hold what is said.

    Raises:
        ArtigenError: If no object of the kind has them.
    """
    given = understood.request
    size = {axis: getattr(request, axis) or getattr(drawn, axis) for axis in AXES}
    ranged = {axis for axis, _, _ in understood.ranges}
    free: list[Axis] = [axis for axis in AXES if getattr(given, axis) is None and axis not in ranged]
    held = HELD * np.prod(list(size.values()))
    factor = float((understood.volume or held) / held) ** (1 / max(len(free), 1))
    scaled: dict[Axis, float] = {axis: factor * size[axis] for axis in free}
    kind = kinds()[str(drawn.category)]
    try:
        check_size(kind, scaled)
    except ArtigenError as error:
        raise ArtigenError(f"{1000 * (understood.volume or 0):g} litres: {error}") from error
    return replace(request, **scaled)


def _make_room(span: tuple[float, float], request: SketchRequest) -> tuple[float, float]:
    """The part of a range of widths (m) in which the doors of a request find room beside each other."""
    doors = min(dict(request.counts).get("door", 0), MOST_DOORS)
    return min(span[1], max(span[0], NARROW_DOOR * doors)), span[1]


def merge_reading(understood: Understood, reading: Reading) -> Asked:
    """What was read of a photograph, corrected by what was said.

    Kind, numbers of doors and drawers, hinges, panes, stand, handles, lengths, style and finishes that are
    said overrule what was read; all else stays as it was read.

    Raises:
        ArtigenError: If a number is out of bounds, or the kind has no such style.
    """
    request = understood.request
    shares = ", ".join(f"{kind} {share:.0%}" for kind, share in reading.kinds[:3])
    seen = " and ".join(_count(reading.counts[label], label) for label in ("door", "drawer"))
    left = {"litres": understood.volume, "ranges": understood.ranges, "proportions": understood.ratios}
    alone = [f"{what} are not asked for beside a photograph" for what, said in left.items() if said]
    notes = [*understood.notes, *alone, f"the photograph was read as {shares}; {seen} in view"]
    told = Told(features=understood.features, places=understood.places)
    corrected = correct_reading(
        reading,
        kind=request.category,
        counts={label: count for label, count in request.counts if label in NAMED},
        hinge=told.hinge,
        pane=told.pane,
        stand=told.stand,
    )
    width, depth, height = request.width, request.depth, request.height
    if understood.stretch:
        factors = dict(understood.stretch)
        usual = view_fronts(corrected, (width, depth, height)).size
        width, depth, height = (
            length * factors.get(axis, 1.0) for axis, length in zip(AXES, usual, strict=True)
        )
    wish = Wish(
        width=width, depth=depth, height=height, style=request.style, handles=told.handles, legs=told.legs
    )
    check_known(corrected.kind, wish)
    counts: dict[str, int] = dict(request.counts) | {
        label: corrected.counts[label] for label in ("door", "drawer")
    }
    merged = replace(request, category=corrected.kind, counts=tuple(sorted(counts.items())))  # type: ignore[arg-type]
    unmet = [f"{label}={count}" for label, count in request.counts if label not in NAMED]
    notes += [f"asked for beside a photograph, and left to chance: {', '.join(unmet)}"] if unmet else []
    return Asked(request=merged, notes=tuple(notes), told=told, reading=corrected, wish=wish)


def _count(count: int, label: str) -> str:
    return f"{count} {label}{'s' * (count != 1)}"


def draw_asked(
    asked: Asked, seed: int, network: Callable[[], SketchNetwork], temperature: float = 0.6
) -> Drawn:
    """Draws an object that meets what is asked for.

    Args:
        asked: The condition.
        seed: Of what it leaves open.
        network: Loads the sketch network, which a photograph does not need.
        temperature: Of the sketch network.

    Raises:
        ArtigenError: If no object meets it.
    """
    drawn = _draw_unpolished(asked, seed, network, temperature)
    gloss = asked.told.gloss
    return drawn if gloss is None else replace(drawn, shape=polish_shape(drawn.shape, gloss))


def polish_shape(shape: Shape, gloss: float) -> Shape:
    """The object with another gloss of paint, wood and plastic."""
    worn = (
        (role, replace(finish, gloss=gloss) if finish.kind in POLISHED else finish)
        for role, finish in shape.finishes
    )
    return replace(shape, finishes=tuple(worn))


def _draw_unpolished(
    asked: Asked, seed: int, network: Callable[[], SketchNetwork], temperature: float
) -> Drawn:
    """Draws what is asked for in finishes of usual gloss."""
    if asked.reading is not None:
        shape, notes = build_from_reading(asked.reading, seed, asked.wish)
        notes = (*notes, *_list_unmet(asked, shape))
        return Drawn(shape=wear_requested(shape, asked.request.finishes, seed), faults=(), notes=notes)
    worded = asked.picture is None and asked.request.category in kinds()
    beyond = worded and asked.told.is_beyond(asked.request.style)
    described = _draw_worded(asked, seed) if beyond else None
    if described is not None:
        return described
    cfg = SketchConfig(draw=DrawConfig(temperature=temperature), batches=BATCHES if worded else 2 * BATCHES)
    drawn = (
        model.draw_object(network(), asked.request, seed, cfg)
        if asked.picture is None
        else model.draw_pictured(network(), asked.request, seed, asked.picture, cfg)
    )
    if drawn.faults and worded and not beyond:
        described = _draw_worded(asked, seed)
        if described is not None:
            said = f"the sketch network drew nothing sound in {BATCHES} batches: the grammar drew it"
            return replace(described, notes=(said, *described.notes))
    return replace(drawn, notes=(*drawn.notes, *_list_unmet(asked, drawn.shape)))


def _list_unmet(asked: Asked, shape: Shape) -> tuple[str, ...]:
    lost = asked.told.list_lost(shape) + list_unworn(shape, asked.request)
    return (f"understood, and not met: {', '.join(lost)}",) if lost else ()


def _draw_worded(asked: Asked, seed: int) -> Drawn | None:
    """What the grammar draws by words, in the finishes that are asked for; None if it has no such object."""
    described = draw_told(asked.told, asked.request, seed)
    if described is None:
        return None
    shape, notes = described
    return Drawn(shape=wear_requested(shape, asked.request.finishes, seed), faults=(), notes=notes)


def wear_requested(shape: Shape, finishes: Sequence[FinishRequest], seed: int) -> Shape:
    """The object with requested colours and materials; what is open in a request stays as it is."""
    worn = dict(shape.finishes)
    for finish in finishes:
        if finish.role in worn:
            own = worn[finish.role]
            worn[finish.role] = match_finish(finish.material or own.kind, finish.color or own.color, seed)
    return replace(shape, finishes=tuple(sorted(worn.items())))
