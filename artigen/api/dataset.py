"""Builds, verifies, merges and unpacks data sets."""

import shutil
import sys
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from tqdm import tqdm

from artigen import __version__
from artigen.api.batch import Finished, Part, digest_settings, read_journal, run_with_progress
from artigen.api.dataset_objects import (
    SHARED,
    ObjectJob,
    load_object,
    make_and_pack,
    make_job,
    read_fingerprint,
)
from artigen.datasets.duplicates import Duplicate, Duplicates
from artigen.datasets.manifest import About, Failure
from artigen.datasets.merge import merge_datasets
from artigen.datasets.packing import PackingError
from artigen.datasets.publish import is_full, order_objects, write_dataset
from artigen.datasets.recipe import Entry, Recipe, RecipeError, digest_recipe, read_recipe
from artigen.datasets.shards import INDEX, Shards, open_shards
from artigen.datasets.verify import verify_dataset
from artigen.errors import ArtigenError
from artigen.runtime.runner import Runner
from artigen.weights import SHIPPED

WORK = "work"
"""Subfolder of a data set for unfinished work; it is removed at the end."""
SPARE = 10
"""Objects drawn beyond twice the requested number before an entry is given up."""


@dataclass(frozen=True, kw_only=True)
class _Pool:
    """Objects of an entry that are drawn in the same way."""

    entry: Entry
    by_model: bool
    count: int


@dataclass(frozen=True, kw_only=True)
class _Chosen:
    """Objects selected for the data set, and the number that each pool lacks."""

    ids: tuple[str, ...]
    full: frozenset[str]
    duplicates: tuple[Duplicate, ...]
    failures: tuple[Failure, ...]
    missing: tuple[int, ...]


def make_dataset(path: Path, out: Path, runner: Runner, part: Part | None = None) -> str:
    """Builds the data set of a recipe, or a part of its objects; returns what was done, in one line.

    Raises:
        ArtigenError: If the recipe cannot be read or met, or the folder holds something else.
    """
    recipe = read_recipe(path)
    text = path.read_text()
    if _is_complete(recipe, out):
        return f"{out} is complete: {len(open_shards(out)):,} objects of this recipe"
    _check_wishes(recipe, path)
    work = out / WORK
    work.mkdir(parents=True, exist_ok=True)
    pools = _pools(recipe)
    tries = [pool.count for pool in pools]
    results: dict[str, Finished] = {}
    while True:
        jobs = [_jobs(pool, tried, recipe, work) for pool, tried in zip(pools, tries, strict=True)]
        flat = [job for some in jobs for job in some if job.key not in results]
        results |= _failed_before(flat, work)
        waiting = [job for job in flat if job.key not in results]
        done = run_with_progress(make_and_pack, waiting, work, runner=runner, part=part)
        results |= {one.key: one for one in done}
        if part is not None:
            good = sum(one.good for one in results.values())
            return (
                f"part {part.number}/{part.total}: {good} of {len(results)} objects are made; run without "
                "--shard when all parts are"
            )
        chosen = _choose(pools, jobs, results, work, recipe.options.near)
        if not any(chosen.missing):
            break
        for number, lacking in enumerate(chosen.missing):
            tries[number] += lacking
            _give_up(pools[number], tries[number], chosen, path)
    _write(recipe, text, out, chosen)
    shutil.rmtree(work)
    shards = open_shards(out)
    total = sum(facts["bytes"] for facts in shards.index["files"].values())
    return (
        f"{len(shards):,} objects in {out}, {total / 1e6:,.1f} MB ({total / len(shards) / 1e3:.1f} kB each); "
        f"{len(chosen.failures)} failed and {len(chosen.duplicates)} duplicates were replaced"
    )


def _failed_before(jobs: list[ObjectJob], work: Path) -> dict[str, Finished]:
    """Jobs whose objects failed a check, which would fail again; errors are retried."""
    journal = read_journal(work)
    return {
        job.key: line
        for job in jobs
        if (line := journal.get(job.key)) is not None
        and line.passed is False
        and not line.stopped
        and line.settings == digest_settings(job.settings)
    }


def _is_complete(recipe: Recipe, out: Path) -> bool:
    """Whether the folder holds the data set of the recipe.

    Raises:
        ArtigenError: If it holds something else.
    """
    if not out.exists() or ((out / WORK).is_dir() and not (out / INDEX).is_file()):
        return False
    if not (out / INDEX).is_file():
        if any(out.iterdir()):
            raise ArtigenError(f"{out}: is not empty and holds no data set; choose another folder with -o")
        return False
    made = open_shards(out).index
    if made["recipe"] != digest_recipe(recipe):
        raise ArtigenError(
            f"{out}: holds the data set {made['name']!r} of another recipe; choose another folder with -o, "
            "and merge the two"
        )
    shutil.rmtree(out / WORK, ignore_errors=True)
    return True


def _check_wishes(recipe: Recipe, path: Path) -> None:
    """Rejects entries that cannot be drawn before any work starts.

    Raises:
        RecipeError: If an entry cannot be drawn; the message names its line.
    """
    from artigen.shapes.draw import draw_shape

    for entry in recipe.objects:
        try:
            if entry.drawn_by_model < entry.count:
                draw_shape(entry.category, entry.seed if entry.like is None else entry.like, entry.wish)
            if entry.drawn_by_model:
                from artigen.sketch.request import SketchRequest, check_category, encode_request, list_learned

                wish = entry.wish
                check_category(entry.category, list_learned(SHIPPED))
                encode_request(
                    SketchRequest(
                        category=entry.category, style=wish.style, counts=wish.counts, depth=wish.depth,
                        width=wish.width, height=wish.height,
                    )
                )  # fmt: skip
        except ArtigenError as error:
            raise RecipeError(f"{path} line {entry.line}: {entry.name}: {error}") from error


def _pools(recipe: Recipe) -> list[_Pool]:
    pools = []
    for entry in recipe.objects:
        drawn = entry.drawn_by_model
        if drawn < entry.count:
            pools.append(_Pool(entry=entry, by_model=False, count=entry.count - drawn))
        if drawn:
            pools.append(_Pool(entry=entry, by_model=True, count=drawn))
    return pools


def _jobs(pool: _Pool, tried: int, recipe: Recipe, work: Path) -> list[ObjectJob]:
    first = pool.entry.seed
    return [
        make_job(pool.entry, recipe.options, work, seed, by_model=pool.by_model)
        for seed in range(first, first + tried)
    ]


def _choose(
    pools: list[_Pool],
    jobs: list[list[ObjectJob]],
    results: dict[str, Finished],
    work: Path,
    near: float,
) -> _Chosen:
    """The first valid objects of every pool that are not duplicates."""
    kept = Duplicates(near)
    ids: list[str] = []
    full: set[str] = set()
    duplicates: list[Duplicate] = []
    failures: list[Failure] = []
    missing: list[int] = []
    for pool, some in zip(pools, jobs, strict=True):
        lacking = pool.count
        for job in some:
            finished = results[job.key]
            if lacking == 0:
                break
            if not finished.good:
                reason = finished.error or "; ".join(finished.failures)
                failures.append(Failure(id=job.key, reason=reason))
                continue
            sample, fingerprint = read_fingerprint(work, job.key)
            duplicate = kept.add(fingerprint)
            if duplicate is not None:
                duplicates.append(duplicate)
                continue
            ids.append(job.key)
            lacking -= 1
            if is_full(sample):
                full.add(job.key)
        missing.append(lacking)
    return _Chosen(
        ids=tuple(ids),
        full=frozenset(full),
        duplicates=tuple(duplicates),
        failures=tuple(failures),
        missing=tuple(missing),
    )


def _give_up(pool: _Pool, tries: int, chosen: _Chosen, path: Path) -> None:
    """Raises `RecipeError` if far more objects were drawn than requested."""
    entry = pool.entry
    if tries <= 2 * pool.count + SPARE:
        return
    prefix = f"{entry.name}-g" if pool.by_model else f"{entry.name}-"
    failed = [one for one in chosen.failures if one.id.startswith(prefix)]
    same = [one for one in chosen.duplicates if one.id.startswith(prefix)]
    why = f"; {failed[-1].id}: {failed[-1].reason}" if failed else ""
    raise RecipeError(
        f"{path} line {entry.line}: {entry.name}: of the objects drawn for {pool.count}, {len(failed)} "
        f"failed and {len(same)} were duplicates{why}; request fewer, or lower options.near"
    )


def _write(recipe: Recipe, text: str, out: Path, chosen: _Chosen) -> None:
    about = About(
        name=recipe.name,
        title=recipe.title,
        description=recipe.description,
        license=recipe.license,
        creator=recipe.creator,
        url=recipe.url,
        date=recipe.date,
        generator=f"artigen {__version__}",
        recipes=((f"{recipe.name}.yaml", text),),
        digest=digest_recipe(recipe),
        duplicates=chosen.duplicates,
        failures=chosen.failures,
        near=recipe.options.near,
    )
    work = out / WORK
    ids = order_objects(chosen.ids, chosen.full.__contains__)
    write_dataset(
        out,
        ids,
        partial(load_object, work),
        lambda sha256: (work / SHARED / sha256).read_bytes(),
        about,
        per_shard=recipe.options.objects_per_shard,
    )


def check_dataset(folder: Path, prove: int = 0) -> list[str]:
    """Problems of a data set, one sentence each: bytes that differ, and failed checks of ``prove`` objects.

    Raises:
        ArtigenError: If the folder holds no data set, or ``prove`` is below 0.
    """
    if prove < 0:
        raise ArtigenError(f"{prove} objects to validate again: expected at least 0")
    shards = open_shards(folder)
    return [*verify_dataset(shards), *_prove(shards, prove)]


def _prove(shards: Shards, count: int) -> list[str]:
    """Validates objects again, evenly spread over the data set."""
    if count == 0:
        return []
    from artigen.runtime.workers import Worker
    from envs.config import ValidateConfig
    from envs.validate import validate

    problems = []
    worker = Worker()
    step = max(1, len(shards) // count)
    with tempfile.TemporaryDirectory() as scratch:
        for name in tqdm(shards.ids[::step][:count], desc="proven", disable=not sys.stderr.isatty()):
            folder = shards[name].unpack(Path(scratch) / name)
            report = validate(folder, ValidateConfig(), worker)
            problems += [f"{name}: {check.id} {check.where}: {check.message}" for check in report.failures]
            shutil.rmtree(folder)
    worker.close()
    return problems


def join_datasets(folders: list[Path], out: Path) -> str:
    """Merges data sets into one without duplicates; returns what was done, in one line.

    Raises:
        ArtigenError: If there are less than two, or the output folder holds something else.
    """
    if len(folders) < 2:
        raise ArtigenError("merge: expected at least two folders of data sets")
    if out.exists() and any(out.iterdir()) and not (out / WORK).is_dir():
        raise ArtigenError(f"{out}: is not empty; choose another folder with -o")
    (out / WORK).mkdir(parents=True, exist_ok=True)
    sources = [open_shards(folder) for folder in folders]
    merge_datasets(sources, out, f"artigen {__version__}")
    shutil.rmtree(out / WORK)
    merged = open_shards(out)
    total = sum(len(one) for one in sources)
    return f"{len(merged):,} of {total:,} objects in {out}, the others are duplicates"


def unpack_objects(folder: Path, ids: list[str], out: Path) -> list[Path]:
    """Writes objects of a data set as package folders; returns these.

    Raises:
        ArtigenError: If no object is asked for.
        PackingError: If the data set does not have an object.
    """
    if not ids:
        raise ArtigenError("unpack: expected the folder of a data set and at least one id")
    shards = open_shards(folder)
    unknown = [name for name in ids if name not in shards]
    if unknown:
        raise PackingError(f"{folder}: no objects {', '.join(unknown)}; manifest.parquet lists all ids")
    return [shards[name].unpack(out / name) for name in ids]
