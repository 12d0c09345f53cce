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
from artigen.sketch.draw import DrawConfig, draw_tables
from artigen.sketch.faults import Fault, find_faults
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.request import SketchRequest, ask
from artigen.sketch.rows import CATEGORIES, STYLES, column, rows_to_sketch
from artigen.sketch.sketch import STEP, SketchError, read_sketch

NAME = "sketch"
"""Of the network in a model folder."""
WITHIN = 0.01
"""Share by which an extent may differ from what was asked or announced."""


@dataclass(frozen=True, kw_only=True)
class SketchConfig:
    """How an object is drawn."""

    draw: DrawConfig = field(default_factory=DrawConfig)
    """Temperature."""
    candidates: int = 8
    """Objects drawn side by side."""
    rounds: int = 8
    """Batches at most; the object with the fewest faults stays when the last is drawn."""

    def __post_init__(self) -> None:
        if self.candidates < 1 or self.rounds < 1:
            raise ValueError(f"{self.candidates} candidates in {self.rounds} rounds, expected at least one")


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawn:
    """An object, what is wrong with it, and how it came about."""

    shape: Shape
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]
    tried: int
    """Candidates that were drawn."""


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
    network: SketchNetwork,
    request: SketchRequest,
    seed: int,
    cfg: SketchConfig | None = None,
    *,
    like: Callable[[Shape], float] | None = None,
) -> Drawn:
    """Draws an object that meets a request; the same arguments give the same object on one machine.

    Candidates are drawn in batches until one has no fault; of several without, the first stays, or that
    which ``like`` rates highest.

    Args:
        network: trained.
        request: what is asked for.
        seed: of all chance.
        cfg: temperature and budget.
        like: rates candidates without faults, such as by their likeness to a picture.

    Raises:
        SketchError: If the request is none that sketches can say, or no candidate could be read.
    """
    cfg = cfg or SketchConfig()
    asked = ask(request)
    generator = torch.Generator().manual_seed(seed)
    best: tuple[tuple[int, float], Shape, tuple[Fault, ...]] | None = None
    seen: Counter[str] = Counter()
    tried = 0
    for _ in range(cfg.rounds):
        tables = draw_tables(network, [asked] * cfg.candidates, generator, cfg.draw)
        for table in tables:
            tried += 1
            try:
                shape, faults = _judge(table, seed)
            except SketchError as error:
                seen["unreadable: " + str(error).split(":")[0]] += 1
                continue
            seen.update({fault.id for fault in faults})
            rated = -like(shape) if like is not None and not faults else 0.0
            if best is None or (len(faults), rated) < best[0]:
                best = ((len(faults), rated), shape, faults)
            if best[0][0] == 0 and like is None:
                break
        if best is not None and best[0][0] == 0:
            break
    if best is None:
        raise SketchError(f"{tried} candidates of {request.category or 'any category'}: none could be read")
    why = ", ".join(f"{count} {name}" for name, count in seen.most_common())
    note = f"sketch: candidate {tried} was taken" + (f"; faults of others: {why}" if why else "")
    return Drawn(shape=best[1], faults=best[2], notes=(note,), tried=tried)


@torch.no_grad()
def guess_extents(network: SketchNetwork, request: SketchRequest, seed: int) -> dict[str, float]:
    """Depth, width and height (m) that an object which meets the request may have."""
    table = draw_tables(network, [ask(request)], torch.Generator().manual_seed(seed), rows=1)[0]
    assert table is not None
    return {name: float(table[0, column("object", name)]) * STEP for name in ("depth", "width", "height")}


def _judge(table: np.ndarray | None, seed: int) -> tuple[Shape, tuple[Fault, ...]]:
    """The shape of a table, and its faults."""
    if table is None:
        raise SketchError("a table that did not end")
    sketch = rows_to_sketch(table)
    shape = read_sketch(sketch, seed)
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
