"""An outline under a condition: drawn, regularised, judged, and drawn again while it has a fault."""

from dataclasses import dataclass, field

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
    draws: int = 8
    """Outlines drawn at most."""

    def __post_init__(self) -> None:
        if self.draws < 1:
            raise ValueError(f"{self.draws} outlines to draw, expected at least one")


def draw_outline(
    flow: OutlineFlow,
    asked: ConditionBatch,
    nothing: ConditionBatch,
    generator: torch.Generator,
    cfg: OutlineConfig,
    *,
    extents: Float[np.ndarray, "3"] | None = None,
) -> tuple[Float[np.ndarray, "N C"], tuple[str, ...]]:
    """The first outline without a fault, or that with the least of all, and notes of what was done.

    Args:
        flow: the trained flow.
        asked: one condition, with category and counts.
        nothing: one condition with everything open.
        generator: of the noise, on the CPU.
        cfg: how it is drawn.
        extents: edges of the object that is asked for, up to a factor.
    """
    drawn: list[tuple[tuple[Fault, ...], np.ndarray, tuple[str, ...]]] = []
    while len(drawn) < cfg.draws and not (drawn and not drawn[-1][0]):
        outline = sample_outlines(flow, asked, nothing, generator, cfg.sampler).rows[0].cpu().numpy()
        rows, notes = regularise_outline(outline, cfg.regularise, extents=extents)
        drawn.append((find_faults(rows, cfg.faults), rows, notes))
    faults, rows, notes = min(drawn, key=lambda one: sum(fault.cells for fault in one[0]))
    if len(drawn) > 1:
        worst = max(drawn[0][0], key=lambda fault: fault.cells)
        notes = (*notes, f"outline: {len(drawn)} were drawn, of the first {worst.what}")
    if faults:
        worst = max(faults, key=lambda fault: fault.cells)
        notes = (*notes, f"outline: {len(faults)} faults are left, {worst.what}")
    return rows, notes
