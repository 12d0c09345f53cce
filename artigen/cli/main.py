"""`artigen`: subcommands built from typed functions; each imports what it needs when it runs."""

import logging
import os
import sys

from artigen.cli.convert import convert
from artigen.cli.dataset import dataset
from artigen.cli.demo import demo
from artigen.cli.evaluate import evaluate
from artigen.cli.export import export
from artigen.cli.generate import generate
from artigen.cli.preview import preview
from artigen.cli.scene import scene
from artigen.cli.sets import sets
from artigen.cli.shape import shape
from artigen.cli.train import train
from artigen.cli.usd import usd
from artigen.cli.validate import validate
from artigen.cli.view import view
from artigen.cores import thread_environment
from artigen.errors import ArtigenError

THREADED = ("train", "eval")
"""Subcommands that use all cores in this process; the others use them by worker processes."""


def main() -> None:
    """Runs the subcommand and exits with its code: 0 done, 1 something failed, 2 wrong usage."""
    if not set(THREADED) & set(sys.argv[1:2]):
        os.environ.update(thread_environment(os.environ))  # before anything loads a library that reads it

    import tyro

    logging.basicConfig(level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    commands = {
        "convert": convert,
        "shape": shape,
        "generate": generate,
        "dataset": dataset,
        "train": train,
        "eval": evaluate,
        "export": export,
        "usd": usd,
        "validate": validate,
        "preview": preview,
        "view": view,
        "sets": sets,
        "scene": scene,
        "demo": demo,
    }
    try:
        code = tyro.extras.subcommand_cli_from_dict(commands, prog="artigen", description=__doc__)
    except ArtigenError as error:
        sys.stderr.write(f"artigen: {error}\n")
        sys.exit(1)
    except KeyboardInterrupt:
        sys.stderr.write("artigen: interrupted; run the same command again to finish the rest\n")
        sys.exit(130)
    sys.exit(code)
