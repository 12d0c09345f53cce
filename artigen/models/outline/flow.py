"""The outline flow: a transformer over the parts of an object that draws their joints and boxes.

How many parts of each label there are is a condition; what of it is left open is drawn first, label by
label, from the network's own guess. Attention over a few parts costs a small share of attention over a
latent, so this network sees many more objects in the time that both are given.
"""

from dataclasses import dataclass, replace

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor, nn
from torch.nn import functional

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy
from artigen.models.attention import plain_norm
from artigen.models.conditions import MAX_COUNT, ConditionBatch, ConditionConfig, ConditionEncoder
from artigen.models.embeddings import TimestepEmbedder
from artigen.models.latent_dit import velocity_of
from artigen.models.outline.batch import OutlineBatch, measure_extents, part_labels
from artigen.models.structure_dit import ModulatedBlock, StructureDitConfig, run_blocks
from artigen.sampling import SamplerConfig, sample_flow
from artigen.types import PART_LABELS


@dataclass(frozen=True, kw_only=True)
class OutlineFlowConfig:
    """Sizes of the outline flow."""

    width: int = 256
    """Width of a token, also of a condition token."""
    blocks: int = 5
    """Transformer blocks."""
    heads: int = 4
    """Attention heads."""
    layout: FieldLayout = DEFAULT_LAYOUT
    """Channels of the field whose parts are drawn."""

    @property
    def drawn(self) -> slice:
        """What is drawn of a row: joint type, axis, origin, range, box."""
        return after_occupancy(slice(self.layout.joint_type.start, self.layout.box.stop))


class OutlineFlow(nn.Module):
    """Velocity of outlines under a condition, and what a condition says of open counts, category and extents.

    Rows are drawn in shares of the object's extents, so that a door over half the width says so in wide and
    narrow objects alike; origins are counted from the centre of the part's box. ``mean`` and ``std`` per
    channel belong to the weights: rows are ``drawn * std + mean``.
    """

    mean: Tensor
    std: Tensor

    def __init__(self, cfg: OutlineFlowConfig, conditions: ConditionConfig) -> None:
        super().__init__()
        self.cfg = cfg
        channels = cfg.drawn.stop - cfg.drawn.start
        inner = StructureDitConfig(
            model_channels=cfg.width, cond_channels=cfg.width, num_heads=cfg.heads, share_mod=True
        )
        self.conditions = ConditionEncoder(conditions)
        self.t_embedder = TimestepEmbedder(cfg.width)
        self.modulation = nn.Sequential(nn.SiLU(), nn.Linear(cfg.width, 6 * cfg.width))
        self.table = nn.Parameter(torch.zeros(cfg.blocks, 6 * cfg.width))
        self.pooled = nn.Linear(cfg.width, cfg.width)
        self.shape = nn.Linear(3, cfg.width)
        self.names = nn.Embedding(len(PART_LABELS) * (MAX_COUNT + 1), cfg.width)
        self.input_layer = nn.Linear(channels, cfg.width)
        self.blocks = nn.ModuleList(ModulatedBlock(inner) for _ in range(cfg.blocks))
        self.out_layer = nn.Linear(cfg.width, channels)
        self.guess = nn.Sequential(
            nn.LayerNorm(cfg.width),
            nn.Linear(cfg.width, cfg.width),
            nn.SiLU(),
            nn.Linear(cfg.width, len(PART_LABELS) * (MAX_COUNT + 1) + len(conditions.categories) + 3),
        )
        self.register_buffer("mean", torch.zeros(channels))
        self.register_buffer("std", torch.ones(channels))
        for name, parameter in self.named_parameters():
            if name.startswith(("modulation", "out_layer", "pooled")):
                nn.init.zeros_(parameter)

    def velocity(
        self,
        x: Float[Tensor, "B N C"],
        times: Float[Tensor, "B"],
        tokens: Float[Tensor, "B M K"],
        frame: "OutlineFrame",
    ) -> Float[Tensor, "B N C"]:
        """Velocity of normalised rows at times in [0, 1]."""
        labels, given = frame.labels, frame.given
        ordinal = (functional.one_hot(labels, len(PART_LABELS)) * given[..., None]).cumsum(dim=1)
        number = ordinal.gather(2, labels[..., None])[..., 0].clamp(1, MAX_COUNT + 1) - 1
        h = self.input_layer(x) + self.names(labels * (MAX_COUNT + 1) + number)
        known = self.pooled(tokens.mean(dim=1)) + self.shape(frame.extents.log())
        mod = self.modulation(self.t_embedder(1000.0 * times) + known)
        h = run_blocks(self.blocks, self.table, h, mod, tokens, given[:, None, None, :])
        return velocity_of(x, self.out_layer(plain_norm(h, eps=1e-5)).float(), times)

    def guess_open(self, tokens: Float[Tensor, "B M K"]) -> "OutlineGuess":
        """What embedded conditions let one expect of what they leave open."""
        said = self.guess(tokens.mean(dim=1)).float()
        counts, rest = said.tensor_split((len(PART_LABELS) * (MAX_COUNT + 1),), dim=1)
        ratios = rest[:, -3:]
        return OutlineGuess(
            counts=counts.unflatten(1, (len(PART_LABELS), -1)),
            category=rest[:, :-3],
            log_extents=ratios - ratios.amax(dim=1, keepdim=True),
        )

    def normalise(
        self, rows: Float[Tensor, "B N C"], extents: Float[Tensor, "B 3"]
    ) -> Float[Tensor, "B N D"]:
        """The drawn channels of rows as the flow sees them."""
        shares = self._shift_origins(self._scale(rows, 1.0 / extents), -1.0)
        return (shares[..., self.cfg.drawn] - self.mean) / self.std

    def restore(self, x: Float[Tensor, "B N D"], frame: "OutlineFrame") -> OutlineBatch:
        """Inverse of `normalise`, with labels; joint types become whole, the category is not said."""
        layout, drawn = self.cfg.layout, self.cfg.drawn
        rows = x.new_zeros(*x.shape[:2], layout.channels - 1)
        rows[..., drawn] = x * self.std + self.mean
        rows[..., : drawn.start] = functional.one_hot(frame.labels, len(layout.labels)).to(rows.dtype)
        kinds = after_occupancy(layout.joint_type)
        rows[..., kinds] = functional.one_hot(rows[..., kinds].argmax(dim=-1), len(layout.joint_types)).to(
            rows.dtype
        )
        rows = self._scale(self._shift_origins(rows, 1.0), frame.extents)
        return OutlineBatch(rows=rows * frame.given[..., None], given=frame.given)

    def _shift_origins(self, rows: Float[Tensor, "B N C"], sign: float) -> Float[Tensor, "B N C"]:
        """Origins counted from the box centre (-1), or back (+1)."""
        layout = self.cfg.layout
        out = rows.clone()
        center = rows[..., layout.box.start - 1 : layout.box.start + 2]
        out[..., after_occupancy(layout.origin)] += sign * center
        return out

    def _scale(self, rows: Float[Tensor, "B N C"], factors: Float[Tensor, "B 3"]) -> Float[Tensor, "B N C"]:
        """Places, sizes and travels along each axis times a factor; travels go by the factor of the depth."""
        layout, out = self.cfg.layout, rows.clone()
        for start in (layout.origin.start, layout.box.start, layout.box.start + 3):
            out[..., start - 1 : start + 2] *= factors[:, None]
        out[..., layout.range.stop - 2] *= factors[:, None, 0]
        return out


@dataclass(frozen=True, kw_only=True, eq=False)
class OutlineFrame:
    """What is known of outlines before they are drawn: labels of the parts, which are given, and extents."""

    labels: Int[Tensor, "B N"]
    given: Bool[Tensor, "B N"]
    extents: Float[Tensor, "B 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class OutlineGuess:
    """Logits of the counts of every label and of the category, and logarithms of the extents."""

    counts: Float[Tensor, "B L K"]
    category: Float[Tensor, "B G"]
    log_extents: Float[Tensor, "B 3"]


def frame_outlines(outlines: OutlineBatch) -> OutlineFrame:
    """The frame of outlines that are known."""
    labels = part_labels(outlines.rows) * outlines.given
    return OutlineFrame(labels=labels, given=outlines.given, extents=measure_extents(outlines))


@torch.no_grad()
def complete_conditions(
    flow: OutlineFlow, asked: ConditionBatch, generator: torch.Generator
) -> ConditionBatch:
    """Conditions with category and counts: what is open is drawn from the guesses, one after another."""
    if (asked.category < 0).any():
        drawn = _draw(flow.guess_open(flow.conditions(asked)).category, generator)
        asked = replace(asked, category=torch.where(asked.category < 0, drawn, asked.category))
    for label in range(len(PART_LABELS)):
        is_open = asked.counts[:, label] < 0
        if is_open.any():
            said = flow.guess_open(flow.conditions(asked)).counts[:, label]
            counts = asked.counts.clone()
            counts[is_open, label] = _draw(said, generator)[is_open]
            asked = replace(asked, counts=counts)
    return asked


@torch.no_grad()
def sample_outlines(
    flow: OutlineFlow,
    asked: ConditionBatch,
    nothing: ConditionBatch,
    generator: torch.Generator,
    cfg: SamplerConfig,
) -> OutlineBatch:
    """Draws one outline per condition, whose category and counts must be known (`complete_conditions`).

    Args:
        flow: the trained flow.
        asked: conditions with counts.
        nothing: as many conditions with everything open.
        generator: of the noise, on the CPU.
        cfg: steps and guidance.
    """
    tokens = flow.conditions(asked)
    frame = _frame_of(asked, flow.guess_open(tokens))
    channels = flow.cfg.drawn.stop - flow.cfg.drawn.start
    noise = torch.randn((*frame.labels.shape, channels), generator=generator).to(tokens.device)
    both = torch.cat([tokens, flow.conditions(nothing)])
    twice = OutlineFrame(**{name: torch.cat([value, value]) for name, value in vars(frame).items()})

    def pair(x: Tensor, times: Tensor) -> tuple[Tensor, Tensor]:
        said = flow.velocity(torch.cat([x, x]), torch.cat([times, times]), both, twice)
        return said[: len(x)], said[len(x) :]

    drawn = sample_flow(noise, lambda x, times: flow.velocity(x, times, tokens, frame), pair, cfg)
    outlines = flow.restore(drawn, frame)
    start = flow.cfg.layout.category.start - 1
    kinds = functional.one_hot(asked.category, len(flow.cfg.layout.categories)).to(outlines.rows.dtype)
    outlines.rows[..., start : start + kinds.shape[1]] = kinds[:, None] * frame.given[..., None]
    return outlines


def _frame_of(asked: ConditionBatch, guess: OutlineGuess) -> OutlineFrame:
    """Labels from counts; extents from the size that is asked for, or as the conditions let one expect."""
    labels, given = _name_parts(asked.counts)
    wanted = asked.size / asked.size.amax(dim=1, keepdim=True)
    extents = torch.where(asked.has_size[:, None], wanted, guess.log_extents.exp())
    return OutlineFrame(labels=labels, given=given, extents=extents)


def _name_parts(counts: Int[Tensor, "B L"]) -> tuple[Int[Tensor, "B N"], Bool[Tensor, "B N"]]:
    """Labels of the parts that counts ask for, label by label; padded to the most."""
    rows = [torch.arange(len(PART_LABELS), device=counts.device).repeat_interleave(row) for row in counts]
    longest = max(1, *(len(row) for row in rows))
    labels = torch.stack([functional.pad(row, (0, longest - len(row))) for row in rows])
    given = torch.stack([torch.arange(longest, device=counts.device) < len(row) for row in rows])
    return labels, given


def _draw(logits: Float[Tensor, "B K"], generator: torch.Generator) -> Int[Tensor, "B"]:
    """One of the classes by their chances."""
    chances = logits.softmax(dim=1).cpu()
    return torch.multinomial(chances, 1, generator=generator)[:, 0].to(logits.device)
