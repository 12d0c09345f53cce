"""Rectified flow: the path, its velocity, and Euler sampling with classifier-free guidance.

Time runs from 1 (noise) to 0 (data): ``x_t = (1 - t) x_0 + (s + (1 - s) t) noise`` with ``s = SIGMA_MIN``;
networks are given ``1000 t``. Guidance is TRELLIS': ``(1 + w) cond - w uncond``, only inside the interval.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

SIGMA_MIN = 1e-5
Velocity = Callable[[Tensor, Tensor], Tensor]
"""``velocity(x, t)`` with one time per sample, in [0, 1]."""
VelocityPair = Callable[[Tensor, Tensor], tuple[Tensor, Tensor]]
"""The same, with and without the condition: one pass of a network can give both."""


@dataclass(frozen=True, kw_only=True)
class SamplerConfig:
    """Sampler of latents. The paper: 50 steps, strength 3, no interval, no rescaling."""

    steps: int = 12
    """Euler steps."""
    strength: float = 3.0
    """Guidance w; 0 is the plain conditional velocity."""
    interval: tuple[float, float] = (0.5, 1.0)
    """Times, both ends included, at which guidance applies."""
    rescale: float = 3.0
    """Moves steps towards the noisy end: t becomes r t / (1 + (r - 1) t)."""

    def __post_init__(self) -> None:
        if self.steps < 1 or self.rescale <= 0 or not 0 <= self.interval[0] <= self.interval[1] <= 1:
            raise ValueError(
                f"{self.steps} steps, rescale {self.rescale}, interval {self.interval}: expected at least "
                "one step, a positive rescale and an interval inside [0, 1]"
            )


def plan_times(cfg: SamplerConfig) -> Float[np.ndarray, "S"]:
    """The ``steps + 1`` times from 1 to 0, in float64: one of them can fall exactly on the interval's end."""
    even = np.linspace(1.0, 0.0, cfg.steps + 1)
    return cfg.rescale * even / (1.0 + (cfg.rescale - 1.0) * even)


def is_guided(time: float, cfg: SamplerConfig) -> bool:
    """Whether guidance applies at a time."""
    return cfg.strength != 0.0 and cfg.interval[0] <= time <= cfg.interval[1]


def diffuse(x_0: Tensor, noise: Tensor, times: Float[Tensor, "B"]) -> Tensor:
    """The point of the path between data and noise."""
    t = times.reshape(-1, *[1] * (x_0.ndim - 1))
    return (1.0 - t) * x_0 + (SIGMA_MIN + (1.0 - SIGMA_MIN) * t) * noise


def target_velocity(x_0: Tensor, noise: Tensor) -> Tensor:
    """Target of the network anywhere on the path."""
    return (1.0 - SIGMA_MIN) * noise - x_0


def predict_data(x_t: Tensor, velocity: Tensor, times: Float[Tensor, "B"]) -> Tensor:
    """The end of the straight path that a velocity points along."""
    t = times.reshape(-1, *[1] * (x_t.ndim - 1))
    return (1.0 - SIGMA_MIN) * x_t - (SIGMA_MIN + (1.0 - SIGMA_MIN) * t) * velocity


def draw_times(count: int, generator: torch.Generator, mean: float = 1.0) -> Tensor:
    """Logit-normal training times, TRELLIS' schedule."""
    return torch.sigmoid(mean + torch.randn(count, generator=generator, device=generator.device))


def sample_flow(
    noise: Tensor,
    conditional: Velocity,
    pair: VelocityPair,
    cfg: SamplerConfig,
    *,
    samples: int | None = None,
) -> Tensor:
    """Integrates the flow from noise to data.

    Args:
        noise: Initial state; one sample per row, unless ``samples`` is given.
        pair: Velocities with and without the condition; called only where guidance applies.
        samples: Number of samples to which the rows of a sparse tensor belong.
    """
    x = noise
    for time, following in pairwise(plan_times(cfg)):
        at = torch.full((samples or len(x),), float(time), dtype=torch.float32, device=x.device)
        if is_guided(float(time), cfg):
            with_condition, without = pair(x, at)
            velocity = (1.0 + cfg.strength) * with_condition - cfg.strength * without
        else:
            velocity = conditional(x, at)
        x = x - float(time - following) * velocity
    return x
