"""The sparse flow: a conditional velocity field over the normalised latents of given voxels.

The compact network predicts clean latents (`artigen.appearance.slat_patch_dit`). That of the paper, the
network of TRELLIS, predicts velocities (`artigen.appearance.slat_dit`, section 4.2). Both are exposed as
velocities here. Steps, guidance and times are those of the structure flow (`artigen.models.rectified_flow`).
"""

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn

from artigen.appearance.linear_prior import Expectation
from artigen.appearance.slat_dit import SlatDit, SlatDitConfig, SlatDitPlan
from artigen.appearance.slat_patch_dit import PatchPlan, SlatPatchDit, SlatPatchDitConfig
from artigen.latent.latent_dit import velocity_of
from artigen.models.conditions import ConditionBatch, ConditionConfig, ConditionEncoder
from artigen.models.rectified_flow import SamplerConfig, sample_flow

TRELLIS_MEAN = (
    -2.1687545776367188, -0.004347046371549368, -0.13352349400520325, -0.08418072760105133,
    -0.5271206498146057, 0.7238689064979553, -1.1414450407028198, 1.2039363384246826,
)  # fmt: skip
"""Mean of the latents of TRELLIS' encoder, per channel (its `pipeline.json`)."""
TRELLIS_STD = (
    2.377650737762451, 2.386378288269043, 2.124418020248413, 2.1748552322387695,
    2.663944721221924, 2.371192216873169, 2.6217446327209473, 2.684523105621338,
)  # fmt: skip
"""Standard deviation of the latents of TRELLIS' encoder, per channel."""


class SlatFlow(nn.Module):
    """Velocity of normalised latents under a condition.

    Mean and standard deviation per channel and the linear prior belong to the weights: latents are
    ``normalised * latent_std + latent_mean + expectation(attributes)``. The flow thus models only what does
    not follow from the paint.
    """

    latent_mean: Tensor
    latent_std: Tensor

    def __init__(self, cfg: SlatPatchDitConfig | SlatDitConfig, conditions: ConditionConfig) -> None:
        super().__init__()
        compact = isinstance(cfg, SlatPatchDitConfig)
        self.channels = cfg.channels if compact else cfg.in_channels
        self.attribute_channels = cfg.attribute_channels if compact else 0
        self.network = SlatPatchDit(cfg, conditions.width) if compact else SlatDit(cfg)
        self.conditions = ConditionEncoder(conditions)
        public = not compact and self.channels == len(TRELLIS_MEAN)
        mean = torch.tensor(TRELLIS_MEAN) if public else torch.zeros(self.channels)
        std = torch.tensor(TRELLIS_STD) if public else torch.ones(self.channels)
        self.register_buffer("latent_mean", mean)
        self.register_buffer("latent_std", std)
        self.expectation = Expectation(self.channels) if self.attribute_channels else None

    def velocity(
        self,
        x: Float[Tensor, "N C"],
        times: Float[Tensor, "B"],
        tokens: Float[Tensor, "B M K"],
        plan: SlatDitPlan | PatchPlan,
        attributes: Float[Tensor, "N A"] | None = None,
    ) -> Float[Tensor, "N C"]:
        """Velocity at times in [0, 1], under embedded conditions.

        Raises:
            ValueError: If attributes are missing, or given to a network that takes none.
        """
        given = 0 if attributes is None else attributes.shape[1]
        if given != self.attribute_channels:
            raise ValueError(f"{given} attributes per voxel, expected {self.attribute_channels}")
        if isinstance(self.network, SlatDit):
            assert isinstance(plan, SlatDitPlan)
            return self.network(x, 1000.0 * times, plan, tokens)
        assert isinstance(plan, PatchPlan)
        clean = self.network(x, times, plan, tokens, attributes)
        return velocity_of(x, clean, times[plan.samples])

    def forward(
        self,
        x: Float[Tensor, "N C"],
        times: Float[Tensor, "B"],
        asked: ConditionBatch,
        plan: SlatDitPlan | PatchPlan,
        attributes: Float[Tensor, "N A"] | None = None,
    ) -> Float[Tensor, "N C"]:
        """Velocity at times in [0, 1], under conditions."""
        return self.velocity(x, times, self.conditions(asked), plan, attributes)

    def normalise(
        self, z: Float[Tensor, "N C"], attributes: Float[Tensor, "N A"] | None = None
    ) -> Float[Tensor, "N C"]:
        """Latents scaled to zero mean and unit standard deviation per channel."""
        return (z - self.expect(attributes)) / self.latent_std

    def restore(
        self, x: Float[Tensor, "N C"], attributes: Float[Tensor, "N A"] | None = None
    ) -> Float[Tensor, "N C"]:
        """Inverse of `normalise`."""
        return x * self.latent_std + self.expect(attributes)

    def expect(self, attributes: Float[Tensor, "N A"] | None) -> Tensor:
        """Expected latents of voxels given their attributes alone."""
        if attributes is None or self.expectation is None:
            return self.latent_mean
        return self.latent_mean + self.expectation(attributes)


@torch.no_grad()
def sample_slats(
    flow: SlatFlow,
    coords: Int[Tensor, "N 4"],
    asked: ConditionBatch,
    nothing: ConditionBatch,
    noise: Float[Tensor, "N C"],
    cfg: SamplerConfig,
    *,
    attributes: Float[Tensor, "N A"] | None = None,
) -> Float[Tensor, "N C"]:
    """Samples the latents of given voxels; where guidance applies, both velocities come from one pass.

    Args:
        coords: Sample, x, y, z of each voxel, in any order.
        nothing: As many empty conditions.

    Raises:
        ValueError: If a sample is empty, a voxel occurs twice, or one lies outside the grid.
    """
    tokens = flow.conditions(asked)
    samples = len(tokens)
    both = torch.cat([tokens, flow.conditions(nothing)])
    plan = flow.network.plan(coords, samples)
    copied = coords + torch.tensor([samples, 0, 0, 0], dtype=coords.dtype, device=coords.device)
    twice = flow.network.plan(torch.cat([coords, copied]), 2 * samples)
    doubled = None if attributes is None else torch.cat([attributes, attributes])

    def pair(x: Tensor, times: Tensor) -> tuple[Tensor, Tensor]:
        velocities = flow.velocity(torch.cat([x, x]), torch.cat([times, times]), both, twice, doubled)
        return velocities[: len(x)], velocities[len(x) :]

    def conditional(x: Tensor, times: Tensor) -> Tensor:
        return flow.velocity(x, times, tokens, plan, attributes)

    return flow.restore(sample_flow(noise, conditional, pair, cfg, samples=samples), attributes)
