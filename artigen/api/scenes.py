"""Furnishes many rooms and flats from one library of packages, and packs them into shards."""

import json
import re
import time
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from artigen.api.batch import Finished, Laps, Made, Part, make_supervised, run_with_progress
from artigen.api.scene import (
    Pictures,
    SceneFormat,
    SceneSettings,
    check_extras,
    check_settings,
    choose_family,
    draw_packages,
    furnish_from,
    read_places,
)
from artigen.datasets.packing import add_member, digest_file, open_tar, read_folder, tar_bytes
from artigen.errors import ArtigenError
from artigen.io import write_whole
from artigen.runtime.runner import Runner
from artigen.runtime.workers import Worker
from artigen.types import SceneKind

if TYPE_CHECKING:
    from envs.rooms.catalogue import Catalogue

LIBRARY, SCENES, SHARDS = "library", "scenes", "shards"
"""Subfolders for packages, for one folder per scene, and for tar files."""
INDEX, PAGE = "scenes.json", "README.md"
"""Files that list the shards, and what the scenes hold."""
FORMAT, VERSION = "artigen-scenes", 1
TIMEOUT = 900.0
"""Time limit (seconds) for one scene."""
NUMBERS = re.compile(r"\d+(\.\d+)?")
"""What failures of one kind may differ in."""
SEEDS = 1_000_000
"""Distance between the seeds of suites and those of scenes."""


@dataclass(frozen=True, kw_only=True)
class SceneJob:
    """Job to furnish one scene from the packages of a folder."""

    kind: SceneKind
    seed: int
    out: Path
    packages: Path
    cfg: SceneSettings
    formats: tuple[SceneFormat, ...]
    pictures: Pictures

    @property
    def key(self) -> str:
        """Name of the scene's folder."""
        return f"{self.kind}_{self.seed:06d}"

    @property
    def settings(self) -> str:
        """Everything that determines the scene, as text."""
        return f"{self.key} {self.packages.name} {self.cfg} {self.formats} {self.pictures}"


def make_scenes(
    kinds: Sequence[SceneKind],
    count: int,
    out: Path,
    *,
    runner: Runner,
    seed: int = 0,
    packages: Path | None = None,
    suites: int = 4,
    cfg: SceneSettings | None = None,
    formats: tuple[SceneFormat, ...] = ("mjcf",),
    pictures: Pictures = "plan",
    per_shard: int = 0,
    part: Part | None = None,
) -> str:
    """Furnishes scenes, the kinds in turn; finished ones are kept. Returns what was done, in one line.

    Args:
        kinds: Kinds of rooms, or flat.
        count: Number of scenes, with consecutive seeds.
        out: Folder of everything.
        runner: Where objects are sampled and scenes are furnished.
        seed: Seed of the first scene.
        packages: Folder of packages that passed validation, for all scenes; default: a library is sampled.
        suites: Number of looks in the sampled library; each scene has one.
        cfg: Properties of all scenes.
        formats: Files besides ``scene.json`` and ``goals.json``.
        pictures: Pictures of every scene.
        per_shard: Number of scenes in a tar file; 0 for none.
        part: Part of the scenes to furnish, without shards; None for all.

    Raises:
        ArtigenError: If a number is out of range, or settings contradict each other.
    """
    if count < 1 or suites < 1 or per_shard < 0 or seed < 0 or not kinds:
        raise ArtigenError(
            f"{count} scenes of {len(kinds)} kinds with seed {seed} in {suites} suites, {per_shard} a shard:"
            " expected at least one scene, kind and suite, and a seed and a number per shard from 0"
        )
    check_extras(formats, pictures)
    cfg = cfg or SceneSettings()
    cfg = replace(cfg, place=read_places(cfg.place))
    wanted = dict.fromkeys(each for kind in kinds for each in check_settings(kind, seed, cfg))
    if packages is None:
        folders = []
        for suite in range(suites):
            folder = out / LIBRARY / f"suite_{suite:03d}"
            family = cfg.family or choose_family(kinds[0], seed + suite)
            draw_packages(list(wanted), SEEDS + seed + suite, family, folder, runner)
            folders.append(folder)
    else:
        folders = [packages]
    jobs = [
        SceneJob(
            kind=kinds[index % len(kinds)], seed=seed + index, out=out / SCENES,
            packages=folders[(seed + index) % len(folders)], cfg=cfg, formats=formats, pictures=pictures,
        )
        for index in range(count)
    ]  # fmt: skip
    done = run_with_progress(furnish_and_report, jobs, out / SCENES, runner=runner, part=part)
    good = [finished.key for finished in done if finished.good]
    write_whole(out / PAGE, _page(out, done))
    if per_shard and part is None:
        _write_shards(out, good, per_shard)
    spent = sum(seconds for finished in done for _, seconds in finished.seconds)
    mean = spent / max(len(good), 1)
    return f"{len(good)} of {len(done)} scenes in {out / SCENES}, {mean:.1f} s of one core each; {out / PAGE}"


def furnish_and_report(worker: Worker, job: SceneJob) -> Finished:
    """Furnishes one scene in a supervised process."""
    return make_supervised(worker, job, _furnish, TIMEOUT)


def _furnish(job: SceneJob) -> Made:
    laps, started = Laps(), time.process_time()
    made = furnish_from(
        job.kind, job.out / job.key, job.seed, _read_library(job.packages), job.cfg, formats=job.formats,
        pictures=job.pictures,
    )  # fmt: skip
    laps.end("scene", ("scene", time.process_time() - started))
    return laps.made((made.describe(),))


@cache
def _read_library(folder: Path) -> "Catalogue":
    """The packages of a library, read once in every process."""
    from envs.rooms.catalogue import read_catalogue

    return read_catalogue(folder)


def _page(out: Path, done: Sequence[Finished]) -> str:
    """What the scenes hold and cost, as Markdown."""
    rows: dict[str, list[dict[str, float]]] = defaultdict(list)
    families: Counter[str] = Counter()
    packages: set[str] = set()
    for finished in done:
        if not finished.good:
            continue
        folder = out / SCENES / finished.key
        scene = json.loads((folder / "scene.json").read_text())
        goals = json.loads((folder / "goals.json").read_text())["goals"]
        families.update(goal["family"] for goal in goals)
        packages |= {str((folder / each["package"]).resolve()) for each in scene["placements"]}
        rows[scene["kind"]].append(
            {
                "floor (m^2)": scene["size"][0] * scene["size"][1],
                "objects": len(scene["placements"]),
                "standing places": sum(len(each["standing"]) for each in scene["placements"]),
                "loose things": len(scene.get("contents", ())),
                "goals": len(goals),
                "seconds": sum(seconds for _, seconds in finished.seconds),
            }
        )
    failed = [finished for finished in done if not finished.good]
    lines = ["# Scenes", "", f"{sum(map(len, rows.values()))} scenes of {len(packages)} packages."]
    if rows:
        columns = list(next(iter(rows.values()))[0])
        lines += ["", f"Means; seconds are those of one core.\n\n| kind | scenes | {' | '.join(columns)} |"]
        lines.append("|---" * (len(columns) + 2) + "|")
        for kind, values in sorted(rows.items()):
            means = [f"{np.mean([row[column] for row in values]):.1f}" for column in columns]
            lines.append(f"| {kind} | {len(values)} | {' | '.join(means)} |")
        lines += [
            "",
            "Goals: " + ", ".join(f"{count} {name}" for name, count in sorted(families.items())) + ".",
        ]
    if failed:
        lines += ["", f"{len(failed)} were not furnished:", ""]
        kinds: dict[str, list[Finished]] = defaultdict(list)
        for finished in failed:
            kinds[NUMBERS.sub("N", finished.error or "")].append(finished)
        for each in sorted(kinds.values(), key=len, reverse=True):
            keys = ", ".join(finished.key for finished in each)
            lines.append(f"- {len(each)}, such as {each[0].key}: {each[0].error} ({keys})")
    return "\n".join(lines) + "\n"


def _write_shards(out: Path, keys: Sequence[str], per_shard: int) -> None:
    """Tar files of scenes, and the index with their hashes. Members of a sample are, behind its id, ``json``
    (scene.json), ``goals.json``, and ``tar`` with all files of its folder."""
    folder = out / SHARDS
    folder.mkdir(parents=True, exist_ok=True)
    files: dict[str, dict[str, object]] = {}
    for number, start in enumerate(range(0, len(keys), per_shard)):
        path = folder / f"scenes-{number:05d}.tar"
        with open_tar(path) as tar:
            for key in keys[start : start + per_shard]:
                held = read_folder(out / SCENES / key)
                add_member(tar, f"{key}.json", held["scene.json"])
                add_member(tar, f"{key}.goals.json", held["goals.json"])
                add_member(tar, f"{key}.tar", tar_bytes(held))
        files[f"{SHARDS}/{path.name}"] = {"bytes": path.stat().st_size, "sha256": digest_file(path)}
    head = {"format": FORMAT, "version": VERSION, "count": len(keys), "files": files}
    write_whole(out / INDEX, json.dumps(head, indent=1) + "\n")
