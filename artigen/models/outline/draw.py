"""An outline under a condition: drawn, regularised, judged, and drawn again while it has a fault."""

from dataclasses import dataclass, field, replace

import numpy as np
import torch
from jaxtyping import Float

from artigen.models.conditions import ConditionBatch
from artigen.models.outline.faults import Fault, OutlineFaultsConfig, find_faults
from artigen.models.outline.flow import OutlineFlow, sample_outlines
from artigen.models.outline.likeness import LikenessConfig, measure_likeness
from artigen.models.outline.regularise import OutlineRegulariseConfig, regularise_outline
from artigen.sampling import SamplerConfig


@dataclass(frozen=True, kw_only=True)
class OutlineConfig:
    """How an outline is drawn."""

    sampler: SamplerConfig = field(default_factory=lambda: SamplerConfig(steps=12, strength=1.0))
    """Steps and guidance."""
    regularise: OutlineRegulariseConfig = field(default_factory=OutlineRegulariseConfig)
    """What hardly differs from what is meant."""
    faults: OutlineFaultsConfig = field(default_factory=OutlineFaultsConfig)
    """What cannot be."""
    draws: int = 16
    """Outlines drawn at most."""
    likened: int = 8
    """Outlines without a fault among which the likeliest is chosen, where a picture says which that is."""
    likeness: LikenessConfig = field(default_factory=LikenessConfig)
    """How outlines are compared with a picture."""

    def __post_init__(self) -> None:
        if self.draws < 1:
            raise ValueError(f"{self.draws} outlines to draw, expected at least one")


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnOutline:
    """An outline, what is still wrong with it, and what was done to it."""

    rows: Float[np.ndarray, "N C"]
    """The channels after occupancy, one row per part."""
    faults: tuple[Fault, ...]
    notes: tuple[str, ...]


def draw_outline(
    flow: OutlineFlow,
    asked: ConditionBatch,
    nothing: ConditionBatch,
    generator: torch.Generator,
    cfg: OutlineConfig,
    *,
    extents: Float[np.ndarray, "3"] | None = None,
    density: Float[np.ndarray, "L h w"] | None = None,
) -> DrawnOutline:
    """The first outline without a fault, or that with the least of all; of several, the one like a picture.

    Args:
        flow: the trained flow.
        asked: one condition, with category and counts.
        nothing: one condition with everything open.
        generator: of the noise, on the CPU.
        cfg: how it is drawn.
        extents: edges of the object that is asked for, up to a factor.
        density: parts of each label per cell of a picture (`artigen.models.picture_reader`), if there is one.
    """
    drawn: list[DrawnOutline] = []
    wanted = 1 if density is None else cfg.likened
    while len(drawn) < cfg.draws and sum(not one.faults for one in drawn) < wanted:
        outline = sample_outlines(flow, asked, nothing, generator, cfg.sampler).rows[0].cpu().numpy()
        rows, notes = regularise_outline(outline, cfg.regularise, extents=extents)
        drawn.append(DrawnOutline(rows=rows, faults=find_faults(rows, cfg.faults), notes=notes))
    least = min(sum(fault.cells for fault in one.faults) for one in drawn)
    found = [one for one in drawn if sum(fault.cells for fault in one.faults) == least]
    best = found[0]
    notes: tuple[str, ...] = ()
    if density is not None and len(found) > 1:
        likeness = [measure_likeness(one.rows, density, cfg.likeness) for one in found]
        best = found[int(np.argmax(likeness))]
        notes = (f"outline: the most like the picture of {len(found)}",)
    notes = (*best.notes, *notes)
    if drawn[0].faults and len(drawn) > 1:
        notes = (*notes, f"outline: {len(drawn)} were drawn, of the first {_worst(drawn[0].faults)}")
    if best.faults:
        notes = (*notes, f"outline: {len(best.faults)} faults are left, {_worst(best.faults)}")
    return replace(best, notes=notes)


def _worst(faults: tuple[Fault, ...]) -> str:
    return max(faults, key=lambda fault: fault.cells).what
