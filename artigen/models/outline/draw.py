"""An outline under a condition: drawn, regularised, judged, and drawn again while it has a fault."""

from dataclasses import dataclass, field, replace

import numpy as np
import torch
from jaxtyping import Float

from artigen.models.conditions import ConditionBatch
from artigen.models.outline.faults import Fault, OutlineFaultsConfig, find_faults
from artigen.models.outline.flow import OutlineFlow, sample_outlines
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
) -> DrawnOutline:
    """The first outline without a fault, or that with the least of all.

    Args:
        flow: the trained flow.
        asked: one condition, with category and counts.
        nothing: one condition with everything open.
        generator: of the noise, on the CPU.
        cfg: how it is drawn.
        extents: edges of the object that is asked for, up to a factor.
    """
    drawn: list[DrawnOutline] = []
    while len(drawn) < cfg.draws and not (drawn and not drawn[-1].faults):
        outline = sample_outlines(flow, asked, nothing, generator, cfg.sampler).rows[0].cpu().numpy()
        rows, notes = regularise_outline(outline, cfg.regularise, extents=extents)
        drawn.append(DrawnOutline(rows=rows, faults=find_faults(rows, cfg.faults), notes=notes))
    best = min(drawn, key=lambda one: sum(fault.cells for fault in one.faults))
    notes = best.notes
    if len(drawn) > 1:
        notes = (*notes, f"outline: {len(drawn)} were drawn, of the first {_worst(drawn[0].faults)}")
    if best.faults:
        notes = (*notes, f"outline: {len(best.faults)} faults are left, {_worst(best.faults)}")
    return replace(best, notes=notes)


def _worst(faults: tuple[Fault, ...]) -> str:
    return max(faults, key=lambda fault: fault.cells).what
