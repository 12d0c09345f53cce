"""The sketch network with its weights, and sampling of objects until one has no fault."""

from collections import Counter
from collections.abc import Hashable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float

from artigen.conditioning.image import Picture, read_picture
from artigen.errors import SourceError
from artigen.models.description import read_description
from artigen.models.store import load_model, save_model
from artigen.shapes.shape import Shape
from artigen.sketch.blocks import PictureMemory
from artigen.sketch.decoder import Decoder
from artigen.sketch.draft import Draft, begin_draft
from artigen.sketch.draw import DrawConfig, continue_draft
from artigen.sketch.fault import Fault
from artigen.sketch.faults import find_extent_faults, find_faults
from artigen.sketch.front import find_front_faults
from artigen.sketch.growth import Grower
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.overlay import View
from artigen.sketch.part_counts import describe_part_counts, parse_part_counts, read_part_counts
from artigen.sketch.picture import PictureConfig, PicturePrediction
from artigen.sketch.picture_colors import read_colors
from artigen.sketch.request import NETWORK, SketchRequest, check_category, encode_request
from artigen.sketch.rows import COUNTED, column, rows_to_sketch
from artigen.sketch.sketch import STEP, read_sketch
from artigen.sketch.vocabulary import carry_weights, describe_vocabulary, find_new_symbols
from artigen.sketch.words import CATEGORIES, STYLES

PICTURE_EDGE = 256
"""Edge length (pixels) of the picture for camera fitting and colours."""
PICTURED, HEADERS = DrawConfig(temperature=0.5), 12
"""Sampling and number of headers for a picture, of which one is chosen (`choose_header`)."""
COOLEST = 0.1
"""Temperature of the first continuations for a picture: the likeliest object is the one that it shows."""


@dataclass(frozen=True, kw_only=True)
class SketchConfig:
    """Sampling of an object."""

    draw: DrawConfig = field(default_factory=DrawConfig)
    """Temperature and nucleus of the parts."""
    coolest: float = np.inf
    """Temperature of the first continuation of each batch, where it is lower than that of ``draw``. It rises
    by as much with every dead end."""
    header: DrawConfig = field(default_factory=lambda: DrawConfig(temperature=1.0))
    """Sampling of the header: category, style, counts and extents."""
    candidates: int = 8
    """Continuations per batch: one is drawn first, the others in parallel if it has a fault."""
    batches: int = 240
    """Largest number of batches: as many as an object and its redraws would take."""

    def __post_init__(self) -> None:
        if min(self.candidates, self.batches) < 1:
            raise ValueError(
                f"{self.candidates} candidates in {self.batches} batches, expected at least one of each"
            )


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawn:
    """An object, its faults and notes on the search."""

    shape: Shape
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]


def save_sketch_network(network: SketchNetwork, folder: Path, described: dict[str, object]) -> None:
    """Writes the weights and their vocabulary into a model folder."""
    contents = {
        "sizes": asdict(network.cfg),
        "categories": list(network.categories),
        "part_counts": describe_part_counts(network.part_counts),
        "vocabulary": describe_vocabulary(),
    }
    save_model(network, folder, {**contents, **described}, NETWORK)


def load_sketch_network(folder: Path) -> SketchNetwork:
    """Loads a sketch network; it draws only the categories and words that it has learned.

    Raises:
        SourceError: If the folder holds no sketch network.
        VocabularyError: If the network was trained with words or fields that this version lacks.
    """
    stored: Any = read_description(folder).get(NETWORK)
    if stored is None:
        raise SourceError(f"{folder}: holds no sketch network; train one with artigen train")
    vocabulary, categories = stored.get("vocabulary"), stored.get("categories")
    if not isinstance(vocabulary, dict) or not isinstance(categories, list):
        raise SourceError(
            f"{folder}: a sketch network whose vocabulary and categories are not described; train it again"
        )
    try:
        network = SketchNetwork(_read_sizes(stored.get("sizes")))
    except (TypeError, ValueError) as error:
        raise SourceError(
            f"{folder}: sizes {stored.get('sizes')} of a sketch network ({error}), expected such as "
            f"{SketchNetworkConfig()}"
        ) from error
    fresh = network.state_dict()
    load_model(network, folder, NETWORK, lambda weights: carry_weights(weights, vocabulary, fresh))
    network.categories = tuple(categories)
    try:  # older models have none
        network.part_counts = parse_part_counts(stored.get("part_counts", {}))
    except (AttributeError, TypeError, ValueError) as error:
        raise SourceError(f"{folder}: a sketch network with unreadable part counts ({error})") from error
    network.unlearned[find_new_symbols(vocabulary, categories)] = True
    return network


def _read_sizes(stored: Any) -> SketchNetworkConfig:
    """Sizes from a description; older models have no entry for the picture encoder or its attention."""
    picture = stored.get("picture")
    if picture is not None:
        picture = PictureConfig(
            **{
                "layers": 0,
                **picture,
                **{name: tuple(picture[name]) for name in ("widths", "blocks") if name in picture},
            }
        )
    return SketchNetworkConfig(**{**stored, "picture": picture})


def draw_object(
    network: SketchNetwork,
    request: SketchRequest,
    seed: int,
    cfg: SketchConfig | None = None,
    encoded: tuple[PicturePrediction, PictureMemory] | None = None,
) -> Drawn:
    """Samples an object that meets a request; deterministic for equal arguments on one machine.

    The header is drawn first; then the object grows part by part. Several continuations are drawn for every
    part, and the first without a new fault is kept. If all have one, the object is cut back to before the
    part that most of these faults involve (conflict-directed backjumping, Prosser 1993); repeated dead ends
    at the same number of parts cut back further. When the budget is exhausted without a complete object, the
    draft with the most parts is finished with the continuation of fewest faults in each batch, and its faults
    are returned with it.

    Args:
        network: A trained network.
        request: The condition.
        seed: Seed of all sampling.
        cfg: Sampling parameters and budget.
        encoded: What the network sees (`encode_picture`), if there is a picture.

    Raises:
        SketchError: If sketches cannot express the request, the network does not draw its category, or no
            valid object was drawn.
    """
    cfg = cfg or SketchConfig()
    seen, memory = encoded or (None, None)
    decoder = Decoder(network)
    grower = Grower(
        decoder=decoder,
        rng=np.random.default_rng(seed),
        draw=cfg.draw,
        candidates=cfg.candidates,
        coolest=cfg.coolest,
    )
    if request.category is not None:
        check_category(request.category, network.categories)
    grown = [begin_draft(decoder, encode_request(request), memory)]
    furthest, dead_ends = grown[0], Counter[int]()
    best: tuple[Shape, tuple[Fault, ...]] | None = None
    while grower.batches < cfg.batches:
        if len(grown) == 1:
            grown.append(_draw_header(decoder, grown[0], grower.rng, cfg.header, seen))
        found, blamed = grower.grow(grown[-1])
        if found is not None:
            grown.append(found)
            furthest = max(found, furthest, key=lambda draft: len(draft.writer.moving))
            if not found.writer.delivered:
                continue
            shape, faults = _judge(found.writer.table, seed, request, pictured=seen is not None)
            if best is None or len(faults) < len(best[1]):
                best = (shape, faults)
            if not faults:
                break
            grower.seen.update(fault.id for fault in faults)
            del grown[1:]
        else:
            dead_ends[len(grown)] += 1
            grower.coolest += cfg.coolest
            # The empty table and the header come before the first part.
            del grown[max(1, min(blamed + 2, len(grown) - dead_ends[len(grown)])) :]
    if best is None:
        best = _judge(grower.finish(furthest).writer.table, seed, request, pictured=seen is not None)
    why = ", ".join(f"{count} {name}" for name, count in grower.seen.most_common())
    note = f"sketch: {grower.batches} batches were drawn" + (f"; left out on the way: {why}" if why else "")
    return Drawn(shape=best[0], faults=best[1], notes=(note,))


def read_object_picture(network: SketchNetwork, path: Path) -> Picture:
    """Reads a picture at the size that the sketch model uses.

    Raises:
        SourceError: If the network reads no pictures, or the file is not an image.
    """
    if network.cfg.picture is None:
        raise SourceError(
            f"{path}: the sketch network of this model reads no pictures; describe the object in words, or "
            "give a model that was trained with pictures"
        )
    return read_picture(path, PICTURE_EDGE)


@torch.no_grad()
def encode_picture(
    network: SketchNetwork, picture: Float[np.ndarray, "4 S S"]
) -> tuple[PicturePrediction, PictureMemory]:
    """Encodes one picture (RGBA in [0, 1], premultiplied on black)."""
    return network.encode_pictures(torch.from_numpy(np.ascontiguousarray(picture, dtype=np.float32))[None])


def draw_pictured(
    network: SketchNetwork,
    request: SketchRequest,
    seed: int,
    picture: Float[np.ndarray, "4 S S"],
    cfg: SketchConfig | None = None,
) -> Drawn:
    """Samples an object from a picture; it is coloured as in the picture.

    Args:
        network: A trained network that reads pictures.
        request: Explicit conditions, which override the picture.
        picture: RGBA in [0, 1], premultiplied on black.

    Raises:
        SketchError: As for `draw_object`.
        PictureError: If the picture shows no object.
    """
    encoded = encode_picture(network, picture)
    cfg = replace(cfg or SketchConfig(), header=PICTURED, coolest=COOLEST)
    drawn = draw_object(network, request, seed, cfg, encoded)
    view = View(*encoded[0].view[0].tolist())
    requested = {finish.role for finish in request.finishes if finish.color is not None}
    labels = encoded[0].labels[0].softmax(dim=0).numpy()
    shape = read_colors(drawn.shape, picture, view, keep=requested, labels=labels)
    return replace(drawn, shape=shape)


def draw_header(
    network: SketchNetwork,
    request: SketchRequest,
    seed: int,
    cfg: DrawConfig | None = None,
    encoded: tuple[PicturePrediction, PictureMemory] | None = None,
) -> SketchRequest:
    """Samples category, style, counts of every label and extents for a request.

    Args:
        cfg: Sampling parameters; by default those of an object's header.
        encoded: What the network sees (`encode_picture`), if there is a picture.

    Raises:
        SketchError: If sketches cannot express the request.
    """
    rng, (seen, memory) = np.random.default_rng(seed), encoded or (None, None)
    decoder = Decoder(network)
    empty = begin_draft(decoder, encode_request(request), memory)
    cfg = cfg or (SketchConfig().header if seen is None else PICTURED)
    row = _draw_header(decoder, empty, rng, cfg, seen).writer.rows[0]
    category, counts = read_part_counts(row)
    depth, width, height = (row[column("object", name)] * STEP for name in ("depth", "width", "height"))
    return SketchRequest(
        category=category,
        style=STYLES[row[column("object", "style")]],
        counts=tuple(zip(COUNTED, counts, strict=True)),
        depth=depth,
        width=width,
        height=height,
        finishes=request.finishes,
        some=request.some,
    )


def _draw_header(
    decoder: Decoder, empty: Draft, rng: np.random.Generator, cfg: DrawConfig, seen: PicturePrediction | None
) -> Draft:
    """Adds a header to an empty table; for a picture, the most plausible of `HEADERS`."""
    if seen is None:
        return _draw_known_header(decoder, empty, rng, cfg)
    drawn = continue_draft(decoder, empty, lambda _: True, rng.spawn(HEADERS), cfg)
    headers = [one for one in drawn if one is not None]
    said = [read_part_counts(one.writer.rows[0]) for one in headers]
    rates = [seen.rate(CATEGORIES.index(category), counts) for category, counts in said]
    return headers[choose_header(said, rates)]


def _draw_known_header(decoder: Decoder, empty: Draft, rng: np.random.Generator, cfg: DrawConfig) -> Draft:
    """Adds a header whose counts a training object has, if one of `HEADERS` is such, else the first."""
    headers = list[Draft]()
    for _ in range(HEADERS):
        (header,) = continue_draft(decoder, empty, lambda _: True, rng.spawn(1), cfg)
        assert header is not None  # a single row is never too long
        headers.append(header)
        if not decoder.part_counts or read_part_counts(header.writer.rows[0]) in decoder.part_counts:
            return header
    return headers[0]


def choose_header(said: Sequence[Hashable], rates: Sequence[float]) -> int:
    """Index of the most plausible header.

    Two estimates are multiplied: the encoder's probability of a header's category and counts, and the share
    of the sampled headers that say the same.

    Args:
        said: Category and counts of each header.
        rates: The encoder's log probability of each.
    """
    shares = Counter(said)
    return int(np.argmax([rate + np.log(shares[one]) for one, rate in zip(said, rates, strict=True)]))


def _judge(
    table: np.ndarray, seed: int, request: SketchRequest, *, pictured: bool
) -> tuple[Shape, tuple[Fault, ...]]:
    """The shape of a table and its faults; what a picture shows may have open compartments."""
    shape = read_sketch(rows_to_sketch(table), seed)
    front = () if pictured else find_front_faults(shape)
    return shape, (*find_faults(shape), *front, *find_extent_faults(shape, request))
