"""The command line: the one place that knows all three packages."""

from artigen.cli.main import main

__all__ = ["main"]
