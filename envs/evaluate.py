"""Plays a policy on every object of an environment once, or as often as asked."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np


@dataclass(frozen=True, kw_only=True)
class Trial:
    """An episode: its object by name, its seed, whether it ended in success, its return and its steps."""

    object: str
    seed: int
    success: bool
    reward: float
    steps: int


def evaluate(
    env: gym.Env,
    policy: Callable[[Any], Any],
    *,
    seed: int = 0,
    repeats: int = 1,
    start: Callable[[], object] = lambda: None,
) -> tuple[Trial, ...]:
    """One episode for every object and repeat, in the order of the objects.

    Args:
        env: An ``ArtiGen`` environment of one scene, wrapped or not, with a time limit.
        policy: An action from an observation.
        seed: Seed of the first repeat; the next ones follow.
        repeats: Episodes of each object.
        start: Called before every episode, such as ``policy.reset`` of one with a memory.
    """
    names: tuple[str, ...] = env.unwrapped.object_names  # type: ignore[attr-defined]
    trials = []
    for name in names:
        for repeat in range(repeats):
            start()
            trials.append(_play(env, policy, name, seed + repeat))
    return tuple(trials)


def _play(env: gym.Env, policy: Callable[[Any], Any], name: str, seed: int) -> Trial:
    observation, _ = env.reset(seed=seed, options={"object": name})
    total, steps, over, success = 0.0, 0, False, False
    while not over:
        observation, reward, terminated, truncated, info = env.step(policy(observation))
        total, steps = total + float(reward), steps + 1
        over, success = bool(terminated) or bool(truncated), bool(np.ravel(info["success"])[0])
    return Trial(object=name, seed=seed, success=success, reward=total, steps=steps)
