"""The command line: arguments in, one call of the API, text out."""

from artigen.cli.main import main

__all__ = ["main"]
