"""Answers a plan of checks L5; it may run in another environment, so it imports its neighbours only."""

import runpy
from pathlib import Path

import harness

runpy.run_path(str(Path(harness.__file__).with_name("run_mujoco.py")), run_name="__main__")
