"""`artigen dataset`: builds, verifies, merges and unpacks data sets."""

import sys
from pathlib import Path
from typing import Annotated

import tyro

from artigen.api.batch import read_shard
from artigen.api.dataset import check_dataset, join_datasets, make_dataset, unpack_objects
from artigen.cli.arguments import RunnerChoice, Shard, Workers
from artigen.datasets.shards import open_shards
from artigen.errors import ArtigenError, check_option
from artigen.runtime.runner import choose_runner


def dataset(
    words: tyro.conf.Positional[tuple[str, ...]],
    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None,
    workers: Workers = None,
    runner: RunnerChoice = "local",
    shard: Shard = None,
    prove: int = 0,
) -> int:
    """Build a data set from a recipe: tar shards, manifest, card and metadata.

    Running the same command again resumes an interrupted run and retries failed objects.

    ``artigen dataset RECIPE.yaml -o OUT`` builds a data set;
    ``artigen dataset verify FOLDER`` checks every byte of it;
    ``artigen dataset merge FOLDER FOLDER ... -o OUT`` merges several and drops duplicates;
    ``artigen dataset unpack FOLDER ID ... -o OUT`` writes objects as package folders.

    Args:
        words: A recipe file; or ``verify``, ``merge`` or ``unpack`` with their arguments.
        out: Output folder: the data set, or the unpacked packages.
        shard: Make only the K-th of N equal parts, such as 3/64; a run without it packs all parts.
        prove: With ``verify``: run checks L0 to L3 again on this many objects.
    """
    if not words:
        raise ArtigenError("no words: expected a recipe file, or one of verify, merge and unpack; see --help")
    verb, *rest = words
    if rest:
        check_option("first of several words", verb, ("verify", "merge", "unpack"))
    if verb == "verify":
        return _verify(rest, prove)
    if out is None:
        raise ArtigenError(f"{verb}: -o FOLDER is missing")
    if verb == "merge":
        said = join_datasets([Path(one) for one in rest], out)
    elif verb == "unpack":
        said = "\n".join(map(str, unpack_objects(Path(rest[0]) if rest else Path(), rest[1:], out)))
    else:
        said = make_dataset(Path(verb), out, choose_runner(runner, workers), read_shard(shard))
    sys.stdout.write(said + "\n")
    return 0


def _verify(words: list[str], prove: int) -> int:
    if len(words) != 1 or prove < 0:
        raise ArtigenError("verify: expected one folder of a data set, and --prove of at least 0")
    problems = check_dataset(Path(words[0]), prove)
    for problem in problems:
        sys.stderr.write(f"{problem}\n")
    tried = f", {prove} tried again" if prove else ""
    verdict = "whole and as written" if not problems else f"{len(problems)} problems"
    count = len(open_shards(Path(words[0])))
    sys.stdout.write(f"{words[0]}: {count:,} objects{tried}: {verdict}\n")
    return 0 if not problems else 1
