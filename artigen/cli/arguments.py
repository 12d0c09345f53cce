"""Argument types that several subcommands share."""

from pathlib import Path
from typing import Annotated

import tyro

from artigen.runtime.runner import RunnerName

Out = Annotated[Path, tyro.conf.arg(aliases=["-o"])]
Count = Annotated[int, tyro.conf.arg(aliases=["-n"])]
MaybeCount = Annotated[int | None, tyro.conf.arg(aliases=["-n"])]
Packages = tyro.conf.Positional[tuple[Path, ...]]
Workers = Annotated[
    int | None,
    tyro.conf.arg(
        metavar="INT",
        help="Single-threaded worker processes; 0 to run in this process, where errors have their "
        "traceback; default: one per available core.",
    ),
]
RunnerChoice = Annotated[
    RunnerName,
    tyro.conf.arg(help="``local`` processes or the tasks of a ``ray`` cluster."),
]
Shard = Annotated[
    str | None,
    tyro.conf.arg(metavar="K/N", help="Run only the K-th of N equal parts, such as 3/64."),
]
