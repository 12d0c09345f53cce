"""A wrapper that gives every object of a ManiSkill task another look at every reset."""

from typing import Any

import gymnasium as gym
import numpy as np

from artigen.shapes.restyle import draw_finishes
from sim_export.appearance.dress import find_looks

from ..sim.looks import wear_finishes

SEEDS = 2**31


class RandomLooks(gym.Wrapper):
    """Objects in the finishes of others of their kind, drawn anew for every scene at every reset.

    Geometry, joints and everything else stay, so that batches of one topology keep it. Takes the tasks of
    this package with a scene that renders. A reset with a seed draws looks from it.
    """

    def __init__(self, env: gym.Env, style: str | None = None) -> None:
        """
        Args:
            env: One of the ``ArtiGen-`` tasks on packages.
            style: A style of the kind, such as navy or steel; any if None.

        Raises:
            ValueError: If the scene cannot render, so that there are no looks.
        """
        super().__init__(env)
        if not self.env.unwrapped.scene.can_render():  # type: ignore[attr-defined]
            raise ValueError("the scene cannot render, so it has no looks; make it with a render_backend")
        self.style = style
        self.looks: list[int] = []
        """Seed of the look of every scene's object."""
        self._rng = np.random.default_rng()

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Resets the environment and draws looks; the observation shows them."""
        if seed is not None:
            self._rng = np.random.default_rng(seed)
        _, info = self.env.reset(seed=seed, options=options)
        task: Any = self.env.unwrapped
        self.looks = self._rng.integers(SEEDS, size=len(task.built)).tolist()
        for (entry, _), articulation, look in zip(task.drawn, task.built, self.looks, strict=True):
            looks = find_looks(draw_finishes(entry.package.category, look, self.style))
            wear_finishes(
                [link for engine in articulation._objs for link in engine.links], entry.folder, looks
            )
        return task.get_obs(info), info
