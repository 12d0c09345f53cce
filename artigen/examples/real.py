"""Real objects as examples: a PartNet-Mobility folder with ``splits.json``.

The data is licensed for non-commercial research; weights trained with it must state this.
"""

import json
import logging
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from tqdm import tqdm

from artigen.errors import SourceError
from artigen.examples.photographs import photograph_mesh
from artigen.examples.structure import StructureExample, example_of_asset, read_shard, write_shard
from artigen.kind import paper_kinds
from artigen.runtime.runner import LocalRunner
from artigen.runtime.workers import Outcome, Worker
from artigen.types import Asset
from artigen.voxels.voxelize import drop_unresolved, voxelize

logger = logging.getLogger(__name__)

SPLITS = "splits.json"
OBJECTS = "partnet_mobility"
TIMEOUT = 300.0
"""Seconds after which an object counts as unreadable."""
Split = Literal["train", "val"]


@dataclass(frozen=True, kw_only=True)
class RealJob:
    """One object to read; ``image_size`` 0 skips the picture."""

    folder: Path
    resolution: int
    image_size: int = 0


def list_split(folder: Path, split: Split) -> list[Path]:
    """Folders of the objects of a split, in order.

    Raises:
        SourceError: If the folder has no readable ``splits.json``, or the split is empty.
    """
    path = folder / SPLITS
    try:
        splits = json.loads(path.read_text())
    except OSError as error:
        raise SourceError(
            f"{path}: cannot be read ({error.strerror}); expected a folder with {SPLITS} and {OBJECTS}/"
        ) from error
    except json.JSONDecodeError as error:
        raise SourceError(f"{path}: is no JSON ({error})") from error
    names = splits.get(split) if isinstance(splits, dict) else None
    if not isinstance(names, list) or not names:
        raise SourceError(f"{path}: split {split!r} holds {names!r}, expected a list of object ids")
    return [folder / OBJECTS / name for name in sorted(map(str, names))]


def read_real(job: RealJob) -> tuple[Asset, StructureExample]:
    """An object with voxels, and its example, its picture taken as those of procedural ones are.

    Raises:
        SourceError: If the folder cannot be read, or the object is of no category that has a channel.
    """
    from artigen.datasets.partnet_mobility import read_object

    source = read_object(job.folder)
    asset = source.asset
    if asset.category not in paper_kinds():
        raise SourceError(f"{job.folder}: category {asset.category!r}, expected one of {paper_kinds()}")
    assert asset.surface is not None
    voxels = voxelize(asset.surface, job.resolution)
    asset = drop_unresolved(replace(asset, voxels=voxels, surface=None))
    if not job.image_size:
        return asset, example_of_asset(asset)
    seed = zlib.crc32(asset.name.encode())
    return asset, example_of_asset(asset, photograph_mesh(source.tables, asset.scale, seed, job.image_size))


def read_reals(
    folder: Path, split: Split, resolution: int, *, image_size: int = 0, workers: int
) -> tuple[list[tuple[Asset, StructureExample]], dict[str, str]]:
    """All readable objects of a split in order, and the reasons why others are left out, by id.

    Raises:
        SourceError: If there is no such split, or none of its objects can be read.
    """
    jobs = [
        RealJob(folder=path, resolution=resolution, image_size=image_size)
        for path in list_split(folder, split)
    ]
    done = LocalRunner(workers=workers).run(_run_job, jobs)
    outcomes = {job.folder: one for job, one in tqdm(done, "real objects", len(jobs), disable=None)}
    ordered = [(job.folder.name, outcomes[job.folder]) for job in jobs]
    found = [outcome.value for _, outcome in ordered if outcome.value is not None]
    left_out = {name: outcome.error for name, outcome in ordered if outcome.error is not None}
    for name, reason in left_out.items():
        logger.warning("%s is left out: %s", name, reason)
    if not found:
        raise SourceError(f"{folder}: none of {len(jobs)} objects of split {split!r} can be read: {left_out}")
    return found, left_out


def real_examples(
    folder: Path, kept: Path, resolution: int, *, image_size: int, workers: int
) -> list[StructureExample]:
    """The examples of the training split, read once and stored as a shard.

    Args:
        folder: Folder with ``splits.json`` and ``partnet_mobility/``; not read if the shard exists.
        kept: Folder for ``real.npz`` and ``left_out.json``.
        image_size: Edge of the pictures in pixels; 0 for none.
    """
    shard = kept / "real.npz"
    if not shard.is_file():
        found, left_out = read_reals(folder, "train", resolution, image_size=image_size, workers=workers)
        kept.mkdir(parents=True, exist_ok=True)
        (kept / "left_out.json").write_text(json.dumps(left_out, indent=1) + "\n")
        write_shard(shard, [example for _, example in found])
    return list(read_shard(shard))


def _run_job(worker: Worker, job: RealJob) -> tuple[RealJob, Outcome[tuple[Asset, StructureExample]]]:
    return job, worker.call(read_real, job, TIMEOUT)
