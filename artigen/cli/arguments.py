"""Argument types that several subcommands share."""

from pathlib import Path
from typing import Annotated

import tyro

Out = Annotated[Path, tyro.conf.arg(aliases=["-o"])]
Count = Annotated[int, tyro.conf.arg(aliases=["-n"])]
Packages = tyro.conf.Positional[tuple[Path, ...]]
Workers = Annotated[int, tyro.conf.arg(help="processes side by side")]
