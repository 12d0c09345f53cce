"""The `artigen` command: subcommands from typed functions, imported only when they are called."""

import logging
import os
import sys
from collections.abc import Callable
from importlib import import_module

from artigen.errors import ArtigenError
from artigen.runtime.cores import thread_environment

COMMANDS = {
    "shape": "shape",
    "generate": "generate",
    "read": "read",
    "convert": "convert",
    "validate": "validate",
    "preview": "preview",
    "render": "render",
    "view": "view",
    "export": "export",
    "restyle": "restyle",
    "grasps": "grasps",
    "usd": "usd",
    "sets": "sets",
    "scene": "scene",
    "scenes": "scenes",
    "dataset": "dataset",
    "demos": "demos",
    "train": "train",
    "eval": "evaluate",
    "demo": "demo",
}
"""Module of `artigen.cli` for each subcommand; the function has the name of the module."""
DESCRIPTION = (
    "Articulated objects for robot simulation, as validated packages. `artigen COMMAND --help` lists options."
)
THREADED = ("train", "eval")
"""Subcommands that use all cores in this process; the others use worker processes."""


def main() -> None:
    """Runs the subcommand and exits with its code: 0 success, 1 failure, 2 wrong usage."""
    if not set(THREADED) & set(sys.argv[1:2]):
        os.environ.update(thread_environment(os.environ))  # before libraries read them

    import tyro

    logging.basicConfig(level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    asked = [name for name in sys.argv[1:2] if name in COMMANDS]
    commands = {name: load_command(name) for name in asked or COMMANDS}
    try:
        code = tyro.extras.subcommand_cli_from_dict(commands, prog="artigen", description=DESCRIPTION)
    except ArtigenError as error:
        sys.stderr.write(f"artigen: {error}\n")
        sys.exit(1)
    except KeyboardInterrupt:
        sys.stderr.write("artigen: interrupted; run the same command again to finish the rest\n")
        sys.exit(130)
    sys.exit(code)


def load_command(name: str) -> Callable[..., int]:
    """Imports the function of one subcommand; importing all of them is slow."""
    module = COMMANDS[name]
    return getattr(import_module(f"artigen.cli.{module}"), module)
