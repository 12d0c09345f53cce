"""The sketch network with its weights, and objects drawn from it until one has no fault."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch

from artigen.errors import SourceError
from artigen.models.store import load_model, read_description, save_model
from artigen.shapes.shape import Shape
from artigen.sketch.draw import Draft, DrawConfig, begin_drafts, continue_drafts
from artigen.sketch.faults import Fault, find_faults
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.request import SketchRequest, ask
from artigen.sketch.rows import CATEGORIES, STYLES, column, rows_to_sketch
from artigen.sketch.sketch import STEP, SketchError, read_sketch

NAME = "sketch"
"""Of the network in a model folder."""
WITHIN = 0.01
"""Share by which an extent may differ from what was asked or announced."""


DEFERRED = frozenset(("tipping", "extent"))
"""Faults that only a whole object can have."""


@dataclass(frozen=True, kw_only=True)
class SketchConfig:
    """How an object is drawn."""

    draw: DrawConfig = field(default_factory=DrawConfig)
    """Temperature."""
    candidates: int = 8
    """Continuations of an object that are drawn side by side for every part."""
    rounds: int = 3
    """Batches of continuations until one has no fault."""
    attempts: int = 6
    """Objects that are begun at most."""

    def __post_init__(self) -> None:
        if min(self.candidates, self.rounds, self.attempts) < 1:
            raise ValueError(
                f"{self.candidates} candidates in {self.rounds} rounds of {self.attempts} attempts, expected "
                "at least one of each"
            )


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawn:
    """An object, what is wrong with it, and how it came about."""

    shape: Shape
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]
    seen: Counter[str]
    """Faults of what was drawn and left out, by id."""


def save_sketch_network(network: SketchNetwork, folder: Path, described: dict[str, object]) -> None:
    """Writes the weights, and the vocabulary that they belong to, into a model folder."""
    said = {"sizes": vars(network.cfg), "categories": list(CATEGORIES), "styles": list(STYLES)}
    save_model(network, folder, {**said, **described}, NAME)


def load_sketch_network(folder: Path) -> SketchNetwork:
    """Loads the network of a model folder.

    Raises:
        SourceError: If the folder holds none, or one of another vocabulary.
    """
    said = read_description(folder).get(NAME)
    if said is None:
        raise SourceError(f"{folder}: holds no sketch network; train one with artigen train")
    for name, words in (("categories", CATEGORIES), ("styles", STYLES)):
        if said.get(name) != list(words):
            raise SourceError(
                f"{folder}: a sketch network for {name} {said.get(name)}, expected {list(words)}"
            )
    sizes = said.get("sizes")
    if not isinstance(sizes, dict) or not sizes.keys() <= set(SketchNetworkConfig.__dataclass_fields__):
        raise SourceError(f"{folder}: sizes {sizes} of a sketch network, expected {SketchNetworkConfig()}")
    network = SketchNetwork(SketchNetworkConfig(**sizes))
    load_model(network, folder, NAME)
    return network


def draw_object(
    network: SketchNetwork, request: SketchRequest, seed: int, cfg: SketchConfig | None = None
) -> Drawn:
    """Draws an object that meets a request; the same arguments give the same object on one machine.

    The object grows part by part. Every part is drawn several times side by side, and the first that has no
    fault beside those before it stays; if all have some, even in several rounds, another object is begun.
    When all attempts are used up, the one with the fewest faults is returned with these.

    Args:
        network: trained.
        request: what is asked for.
        seed: of all chance.
        cfg: temperature and budget.

    Raises:
        SketchError: If the request is none that sketches can say, or no attempt could be read.
    """
    cfg = cfg or SketchConfig()
    start = begin_drafts(network, [ask(request)])[0]
    generator = torch.Generator().manual_seed(seed)
    seen: Counter[str] = Counter()
    begun = 0
    best: tuple[Shape, tuple[Fault, ...]] | None = None
    for _ in range(cfg.attempts):
        begun += 1
        table = _grow(network, start, generator, cfg, seen)
        if table is None:
            continue
        shape, faults = _judge(table, seed)
        seen.update(fault.id for fault in faults)
        if best is None or len(faults) < len(best[1]):
            best = (shape, faults)
        if not faults:
            break
    if best is None:
        raise SketchError(
            f"{cfg.attempts} objects of {request.category or 'any category'} were begun, none could be read"
        )
    why = ", ".join(f"{count} {name}" for name, count in seen.most_common())
    note = f"sketch: {begun} objects were begun" + (f"; left out on the way: {why}" if why else "")
    return Drawn(shape=best[0], faults=best[1], notes=(note,), seen=seen)


def draw_alike(
    network: SketchNetwork,
    request: SketchRequest,
    seed: int,
    like: Callable[[Shape], float],
    cfg: SketchConfig | None = None,
    *,
    objects: int = 4,
) -> Drawn:
    """Draws several objects and returns that without faults which ``like`` rates highest."""
    seeds = np.random.SeedSequence(seed).generate_state(objects).tolist()
    drawn = [draw_object(network, request, one, cfg) for one in seeds]
    return min(drawn, key=lambda one: (len(one.faults), -like(one.shape)))


def _grow(
    network: SketchNetwork, draft: Draft, generator: torch.Generator, cfg: SketchConfig, seen: Counter[str]
) -> np.ndarray | None:
    """Adds part after part; None where no faultless one was found. ``seen`` counts the faults of others."""
    while not draft.writer.delivered:
        parts = len(draft.writer.moving)
        for _ in range(cfg.rounds):
            grown = continue_drafts(
                network,
                [draft] * cfg.candidates,
                lambda writer: len(writer.moving) > parts,  # noqa: B023 - used before it changes
                generator,
                cfg.draw,
            )
            found = next((one for one in grown if one is not None and _is_sound(one, seen)), None)
            if found is not None:
                draft = found
                break
        else:
            return None
    return draft.writer.table


def _is_sound(draft: Draft, seen: Counter[str]) -> bool:
    """Whether an object that is not whole yet has no fault that it would keep."""
    try:
        _, faults = _judge(draft.writer.table, 0)
    except SketchError:
        seen["unreadable"] += 1
        return False
    lasting = {fault.id for fault in faults} - DEFERRED
    seen.update(lasting)
    return not lasting


def guess_extents(network: SketchNetwork, request: SketchRequest, seed: int) -> dict[str, float]:
    """Depth, width and height (m) that an object which meets the request may have."""
    start = begin_drafts(network, [ask(request)])
    header = continue_drafts(network, start, lambda _: True, torch.Generator().manual_seed(seed))[0]
    assert header is not None
    row = header.writer.rows[0]
    return {name: row[column("object", name)] * STEP for name in ("depth", "width", "height")}


def _judge(table: np.ndarray, seed: int) -> tuple[Shape, tuple[Fault, ...]]:
    """The shape of a table, and its faults."""
    shape = read_sketch(rows_to_sketch(table), seed)
    first = column("object", "depth")
    return shape, (*find_faults(shape), *find_extent_faults(shape, table[0, first : first + 3]))


def find_extent_faults(shape: Shape, announced: np.ndarray) -> tuple[Fault, ...]:
    """A fault for every extent (steps) that the object misses by more than `WITHIN`."""
    from artigen.shapes.solids import list_solids

    solids = list_solids(shape)
    found = solids.high.max(axis=0) - solids.low.min(axis=0)
    return tuple(
        Fault(id="extent", part=name, value=abs(have - steps * STEP), allowed=WITHIN * steps * STEP)
        for name, have, steps in zip(
            ("depth", "width", "height"), found.tolist(), announced.tolist(), strict=True
        )
        if abs(have - steps * STEP) > WITHIN * steps * STEP
    )
