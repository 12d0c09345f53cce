"""The command line: the only package that imports artigen, sim_export and envs together."""

from artigen.cli.main import main

__all__ = ["main"]
