"""The structure flow: a conditional velocity field over normalised structure latents.

The compact network predicts clean latents (`artigen.latent.latent_dit`). That of the paper, the network of
TRELLIS, predicts velocities (`artigen.latent.structure_dit`, section 4.3). Both are exposed as velocities
here.
"""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from artigen.latent.latent_dit import LatentDit, LatentDitConfig, velocity_of, weigh_times
from artigen.latent.outline import OutlineBatch, draw_hint, find_candidates
from artigen.latent.structure_dit import StructureDit, StructureDitConfig
from artigen.models.conditions import ConditionBatch, ConditionConfig, ConditionEncoder
from artigen.models.rectified_flow import SamplerConfig, sample_flow


class StructureFlow(nn.Module):
    """Velocity of normalised latents under a condition.

    ``latent_mean`` and ``latent_std`` per channel belong to the weights: latents are
    ``normalised * std + mean``.
    """

    latent_mean: Tensor
    latent_std: Tensor

    def __init__(self, cfg: LatentDitConfig | StructureDitConfig, conditions: ConditionConfig) -> None:
        super().__init__()
        compact = isinstance(cfg, LatentDitConfig)
        self.channels = cfg.channels if compact else cfg.in_channels
        self.edge = cfg.edge if compact else cfg.resolution
        self.network = LatentDit(cfg) if compact else StructureDit(cfg)
        self.conditions = ConditionEncoder(conditions)
        self.register_buffer("latent_mean", torch.zeros(self.channels))
        self.register_buffer("latent_std", torch.ones(self.channels))

    @property
    def takes_outlines(self) -> bool:
        """Whether the network takes outlines."""
        return isinstance(self.network, LatentDit) and self.network.hint_layer is not None

    def velocity(
        self,
        x: Float[Tensor, "B C X Y Z"],
        times: Float[Tensor, "B"],
        tokens: Float[Tensor, "B M K"],
        hint: Float[Tensor, "B H X Y Z"] | None = None,
    ) -> Float[Tensor, "B C X Y Z"]:
        """Velocity at times in [0, 1], under embedded conditions and an outline on the latent's grid."""
        if isinstance(self.network, LatentDit):
            return velocity_of(x, self.network(x, times, tokens, hint), times)
        return self.network(x, 1000.0 * times, tokens)

    def forward(
        self,
        x: Float[Tensor, "B C X Y Z"],
        times: Float[Tensor, "B"],
        asked: ConditionBatch,
        outlines: OutlineBatch | None = None,
    ) -> Float[Tensor, "B C X Y Z"]:
        """Velocity at times in [0, 1], under conditions and, where known, outlines."""
        return self.velocity(x, times, self.conditions(asked), self.hint(outlines))

    def weights(self, times: Float[Tensor, "B"]) -> Float[Tensor, "B"]:
        """Training weight of a squared error of the velocity at each time; 1 in the paper."""
        return weigh_times(times) if isinstance(self.network, LatentDit) else torch.ones_like(times)

    def hint(self, outlines: OutlineBatch | None) -> Float[Tensor, "B H X Y Z"] | None:
        """Hints of outlines on the latent's grid; None without outlines."""
        if outlines is None:
            return None
        return draw_hint(outlines, find_candidates(outlines, self.edge), self.edge)

    def normalise(self, z: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B C X Y Z"]:
        """Latents scaled to zero mean and unit standard deviation per channel."""
        return (z - self.latent_mean[:, None, None, None]) / self.latent_std[:, None, None, None]

    def restore(self, x: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B C X Y Z"]:
        """Inverse of `normalise`."""
        return x * self.latent_std[:, None, None, None] + self.latent_mean[:, None, None, None]


@torch.no_grad()
def sample_latents(
    flow: StructureFlow,
    asked: ConditionBatch,
    nothing: ConditionBatch,
    noise: Float[Tensor, "B C X Y Z"],
    cfg: SamplerConfig,
    outlines: OutlineBatch | None = None,
) -> Float[Tensor, "B C X Y Z"]:
    """Samples one latent per condition; where guidance applies, both velocities come from one pass.

    Guidance does not concern outlines: both velocities take them.
    """
    tokens = flow.conditions(asked)
    both = torch.cat([tokens, flow.conditions(nothing)])
    hint = flow.hint(outlines)
    hints = None if hint is None else torch.cat([hint, hint])

    def pair(x: Tensor, times: Tensor) -> tuple[Tensor, Tensor]:
        velocities = flow.velocity(torch.cat([x, x]), torch.cat([times, times]), both, hints)
        return velocities[: len(x)], velocities[len(x) :]

    drawn = sample_flow(noise, lambda x, times: flow.velocity(x, times, tokens, hint), pair, cfg)
    return flow.restore(drawn)
