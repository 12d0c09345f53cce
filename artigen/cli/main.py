"""The `artigen` command: subcommands from typed functions, imported only when they are called."""

import logging
import os
import re
import sys
from collections.abc import Callable
from functools import wraps
from importlib import import_module

from artigen import __version__
from artigen.errors import ArtigenError
from artigen.runtime.cores import thread_environment

NAMES = (
    "shape generate read convert validate preview render view export restyle grasps usd sets scene scenes "
    "dataset demos train eval demo"
)
COMMANDS = {name: "evaluate" if name == "eval" else name for name in NAMES.split()}
"""Module of `artigen.cli` for each subcommand; the function has the name of the module."""
DESCRIPTION = (
    "Articulated objects for robot simulation, as validated packages. `artigen COMMAND --help` lists options."
)
THREADED = ("train", "eval")
"""Subcommands that use all cores in this process; the others use worker processes."""


def main() -> None:
    """Runs the subcommand and exits with its code: 0 success, 1 failure, 2 wrong usage."""
    if sys.argv[1:] == ["--version"]:
        sys.stdout.write(f"artigen {__version__}\n")
        sys.exit(0)
    if not set(THREADED) & set(sys.argv[1:2]):
        os.environ.update(thread_environment(os.environ))  # before libraries read them

    import tyro

    logging.basicConfig(level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    asked = [name for name in sys.argv[1:2] if name in COMMANDS]
    commands = {name: load_command(name) for name in asked}
    commands = commands or {name: _shorten(load_command(name)) for name in COMMANDS}
    try:
        code = tyro.extras.subcommand_cli_from_dict(commands, prog="artigen", description=DESCRIPTION)
    except ArtigenError as error:
        sys.stderr.write(f"artigen: {error}\n")
        sys.exit(1)
    except OSError as error:  # of the user's disk, or of a path that is not what it should be
        sys.stderr.write(
            f"artigen: {error.filename2 or error.filename or 'file'}: {error.strerror or error}\n"
        )
        sys.exit(1)
    except KeyboardInterrupt:
        sys.stderr.write(
            "artigen: interrupted; what was finished is kept, and commands that resume go on when run again\n"
        )
        sys.exit(130)
    sys.exit(code)


def load_command(name: str) -> Callable[..., int]:
    """Imports the function of one subcommand; importing all of them is slow."""
    module = COMMANDS[name]
    return getattr(import_module(f"artigen.cli.{module}"), module)


def _shorten(command: Callable[..., int]) -> Callable[..., int]:
    """A command that says of itself only its first sentence, as the list of all commands shows it."""

    @wraps(command)
    def shown(*args: object, **options: object) -> int:
        return command(*args, **options)

    shown.__doc__ = re.sub(r"\n\n.*?(?=\n\n    Args:)", "", str(command.__doc__), flags=re.DOTALL)
    return shown
