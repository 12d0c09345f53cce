"""A package as a gymnasium environment: pull a drawer open by its handle.

You will see the open fraction grow until the episode ends in success.
"""

import tempfile
from pathlib import Path

import gymnasium as gym
import numpy as np

from artigen.shapes.draw import Wish, draw_shape
from sim_export.files.write import write_package
from sim_export.reference import build_reference


def main(folder: Path) -> None:
    """Writes a drawn cabinet into ``folder`` and opens its drawer."""
    from envs.actuate import ActuateConfig

    wish = Wish(counts=(("drawer", 1), ("door", 1)))
    package = write_package(build_reference(draw_shape("StorageFurniture", 0, wish)), folder / "cabinet")
    env = gym.make("envs:ArtiGen/Actuate-v0", package=package, cfg=ActuateConfig(joint="joint_0"))
    observation, _ = env.reset(seed=0)
    done, total, info = False, 0.0, {}
    while not done:
        observation, reward, terminated, truncated, info = env.step(np.ones(1, dtype=np.float32))
        done = terminated or truncated
        total += float(reward)
        print(f"open {observation['open_fraction'][0]:.2f}")
    print(f"return {total:.2f}, success {info['success']}")
    assert info["success"]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
