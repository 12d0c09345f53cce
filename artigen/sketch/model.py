"""The sketch network with its weights, and objects drawn from it until one has no fault."""

from collections import Counter
from collections.abc import Callable, Iterator
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
    rounds: int = 2
    """Batches of continuations without a sound one after which the part before is drawn again."""
    batches: int = 80
    """Batches in all."""

    def __post_init__(self) -> None:
        if min(self.candidates, self.rounds, self.batches) < 1:
            raise ValueError(
                f"{self.candidates} candidates in {self.rounds} rounds of {self.batches} batches, expected "
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
    batches: int = 1
    """Batches that were drawn."""


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
    fault beside those before it stays. Where all have some, the part before is drawn again, at each further
    dead end of as many parts one more. When the budget is used up, the object is finished with the fewest
    faults that a batch has, and these are returned with it.

    Args:
        network: trained.
        request: what is asked for.
        seed: of all chance.
        cfg: temperature and budget.

    Raises:
        SketchError: If the request is none that sketches can say, or no object could be read.
    """
    cfg = cfg or SketchConfig()
    hand = _Hand(network=network, generator=torch.Generator().manual_seed(seed), cfg=cfg)
    grown = begin_drafts(network, [ask(request)])
    dead_ends: Counter[int] = Counter()
    best: tuple[Shape, tuple[Fault, ...]] | None = None
    misses = 0
    while hand.batches < cfg.batches:
        found = hand.grow(grown[-1])
        if found is not None:
            grown.append(found)
            misses = 0
            if not found.writer.delivered:
                continue
            shape, faults = _judge(found.writer.table, seed)
            if best is None or len(faults) < len(best[1]):
                best = (shape, faults)
            if not faults:
                break
            hand.seen.update(fault.id for fault in faults)
            del grown[1:]
        elif misses + 1 < cfg.rounds:
            misses += 1
        else:
            misses = 0
            dead_ends[len(grown)] += 1
            del grown[max(1, len(grown) - dead_ends[len(grown)]) :]
    if best is None:
        best = _judge(hand.finish(grown[-1]).writer.table, seed)
    why = ", ".join(f"{count} {name}" for name, count in hand.seen.most_common())
    note = f"sketch: {hand.batches} batches were drawn" + (f"; left out on the way: {why}" if why else "")
    return Drawn(shape=best[0], faults=best[1], notes=(note,), seen=hand.seen, batches=hand.batches)


def draw_alike(
    network: SketchNetwork,
    request: SketchRequest,
    seed: int,
    like: Callable[[Shape], float],
    cfg: SketchConfig | None = None,
    *,
    objects: int = 4,
) -> Drawn:
    """Draws several objects and returns that without faults which ``like`` rates highest.

    No further one is begun when the budget of one object is used up.
    """
    cfg = cfg or SketchConfig()
    drawn: list[Drawn] = []
    for one in np.random.SeedSequence(seed).generate_state(objects).tolist():
        drawn.append(draw_object(network, request, one, cfg))
        if sum(found.batches for found in drawn) >= cfg.batches:
            break
    return min(drawn, key=lambda one: (len(one.faults), -like(one.shape)))


@dataclass(kw_only=True, eq=False)
class _Hand:
    """Adds parts to drafts, and counts the faults of what it leaves out."""

    network: SketchNetwork
    generator: torch.Generator
    cfg: SketchConfig
    seen: Counter[str] = field(default_factory=Counter)
    batches: int = 0

    def grow(self, draft: Draft) -> Draft | None:
        """The first of a batch of continuations by one part that is sound, if any is."""
        return next((one for one, faults in self._batch(draft) if not faults), None)

    def finish(self, draft: Draft) -> Draft:
        """Adds the parts that are missing, of every batch the one with the fewest faults.

        Raises:
            SketchError: If no continuation could be read.
        """
        while not draft.writer.delivered:
            batch = [(one, faults) for one, faults in self._batch(draft) if "unreadable" not in faults]
            if not batch:
                raise SketchError(
                    f"none of {self.cfg.candidates} continuations of an object could be read; the last had "
                    f"{len(draft.writer.moving)} parts"
                )
            draft = min(batch, key=lambda drawn: len(drawn[1]))[0]
        return draft

    def _batch(self, draft: Draft) -> Iterator[tuple[Draft, set[str]]]:
        """Continuations by one part, and the faults that each would keep."""
        self.batches += 1
        parts = len(draft.writer.moving)
        drawn = continue_drafts(
            self.network,
            [draft] * self.cfg.candidates,
            lambda writer: len(writer.moving) > parts,
            self.generator,
            self.cfg.draw,
        )
        for one in drawn:
            if one is not None:
                faults = _find_lasting(one)
                self.seen.update(faults)
                yield one, faults


def _find_lasting(draft: Draft) -> set[str]:
    """Faults of an object that is not whole yet which it would keep."""
    try:
        _, faults = _judge(draft.writer.table, 0)
    except SketchError:
        return {"unreadable"}
    return {fault.id for fault in faults} - DEFERRED


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
