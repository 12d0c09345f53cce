"""The engine ``mujoco-again``: MuJoCo, run by a file of this package."""

from pathlib import Path

from envs.engines.witness import Witness

ENGINE = Witness(runner=str(Path(__file__).with_name("run_mujoco_again.py")), file="mjcf", install="mujoco")
