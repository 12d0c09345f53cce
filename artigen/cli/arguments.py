"""Argument types that several subcommands share."""

from pathlib import Path
from typing import Annotated

import tyro

from artigen.runtime.runner import RunnerName

Out = Annotated[Path, tyro.conf.arg(aliases=["-o"])]
Count = Annotated[int, tyro.conf.arg(aliases=["-n"])]
Packages = tyro.conf.Positional[tuple[Path, ...]]
Workers = Annotated[
    int | None,
    tyro.conf.arg(
        metavar="INT",
        help="Processes side by side, of one thread each; left out, one per core that may be used.",
    ),
]
RunnerChoice = Annotated[
    RunnerName,
    tyro.conf.arg(help="``local`` processes, or tasks of a ``ray`` cluster (docs/scale.md)."),
]
Shard = Annotated[
    str | None,
    tyro.conf.arg(metavar="K/N", help="Do the K-th of N equal parts of the run only, such as 3/64."),
]
