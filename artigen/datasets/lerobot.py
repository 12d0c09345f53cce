"""Demonstrations as a LeRobot data set of format v3.0: parquet files that `LeRobotDataset` loads offline.

Written without the `lerobot` package, whose requirements exclude recent versions of torch. The layout is that
of https://huggingface.co/docs/lerobot/lerobot-dataset-v3: one row per frame in ``data/``, one row per episode
in ``meta/episodes/``, tasks in words, statistics for normalisation, and ``meta/info.json``. Pictures are PNG
in the rows.
"""

import io
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from artigen.datasets.packing import need
from artigen.errors import ArtigenError
from artigen.io import whole_folder, write_whole

VERSION = "v3.0"
INFO = "meta/info.json"
FILE_MIB, CHUNK_FILES = 100, 1000
"""Size (MiB) from which a file of frames is followed by another, and files in a folder."""
FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}"
QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}
PICTURES = 100
"""Frames of an episode whose pictures are in its statistics, at most."""
Statistics = dict[str, dict[str, np.ndarray]]


@dataclass(frozen=True, kw_only=True, eq=False)
class Episode:
    """An episode of T steps: what was seen before each action, the action, and what came of it.

    ``arrays`` are (T, n) or (T,) by feature, such as ``observation.state`` and ``action``; ``pictures`` are
    (T, H, W, 3) uint8 by camera; ``about`` are further columns of ``meta/episodes``.
    """

    task: str
    arrays: Mapping[str, np.ndarray]
    pictures: Mapping[str, np.ndarray]
    about: Mapping[str, str | int | bool]


def write_lerobot(
    episodes: Iterable[Episode],
    out: Path,
    *,
    fps: int,
    robot: str,
    names: Mapping[str, Sequence[str]],
    files: Mapping[str, str] | None = None,
) -> int:
    """Writes episodes in order, replacing ``out`` when all are written; returns the number of frames.

    Args:
        episodes: Equal in the names, widths and types of their arrays and pictures.
        out: Folder of the data set, for ``LeRobotDataset(repo_id, root=out)``.
        fps: Control steps per second.
        robot: ``robot_type`` of the data set.
        names: Names of the columns of arrays, by feature.
        files: Further text files, by path.

    Raises:
        ArtigenError: If there is no episode, or one differs from the first; or pandas or pyarrow is missing.
    """
    pandas, pa, parquet = (need(name, "lerobot") for name in ("pandas", "pyarrow", "pyarrow.parquet"))
    features: dict[str, dict[str, Any]] = {}
    rows: list[dict[str, Any]] = []
    tasks: dict[str, int] = {}
    total, number, writer = 0, 0, None
    with whole_folder(out) as scratch:
        for index, episode in enumerate(episodes):
            own = _describe(episode, names)
            if not features:
                features = own
            elif own != features:
                raise ArtigenError(
                    f"episode {index} has {_spell(own)}, the first one has {_spell(features)}: all episodes "
                    "of a data set need the same features; write the others to a data set of their own"
                )
            length = len(episode.arrays["action"])
            columns = {
                **episode.arrays,
                "timestamp": (np.arange(length) / fps).astype(np.float32),
                "frame_index": np.arange(length),
                "episode_index": np.full(length, index),
                "index": total + np.arange(length),
                "task_index": np.full(length, tasks.setdefault(episode.task, len(tasks))),
            }
            table = pa.table(
                {key: _column(pa, values) for key, values in columns.items()}
                | {key: _encode(pa, values) for key, values in episode.pictures.items()}
            )
            path = scratch / "data" / f"{_place(number)}.parquet"
            if writer is not None and path.stat().st_size > FILE_MIB * 2**20:
                writer.close()
                writer, number = None, number + 1
                path = scratch / "data" / f"{_place(number)}.parquet"
            if writer is None:
                path.parent.mkdir(parents=True, exist_ok=True)
                writer = parquet.ParquetWriter(path, table.schema)
            writer.write_table(table)
            rows.append(
                {
                    "episode_index": index,
                    "tasks": [episode.task],
                    "length": length,
                    "data/chunk_index": number // CHUNK_FILES,
                    "data/file_index": number % CHUNK_FILES,
                    "dataset_from_index": total,
                    "dataset_to_index": total + length,
                    "meta/episodes/chunk_index": 0,
                    "meta/episodes/file_index": 0,
                    **episode.about,
                    "stats": _measure(columns, episode.pictures),
                }
            )
            total += length
        if writer is None:
            raise ArtigenError(f"{out}: no episode to write; record some first")
        writer.close()
        counts = {"total_episodes": len(rows), "total_frames": total, "total_tasks": len(tasks)}
        _write_meta(scratch, rows, features, {"robot_type": robot, "fps": fps, **counts}, pa, parquet)
        frame = pandas.DataFrame({"task_index": list(tasks.values())}, index=list(tasks))
        frame.to_parquet(scratch / "meta" / "tasks.parquet")
        for name, text in (files or {}).items():
            write_whole(scratch / name, text)
    return total


def _place(number: int) -> str:
    return FILE.format(chunk_index=number // CHUNK_FILES, file_index=number % CHUNK_FILES)


def _describe(episode: Episode, names: Mapping[str, Sequence[str]]) -> dict[str, dict[str, Any]]:
    """The features of an episode, as ``info.json`` lists them."""
    features: dict[str, dict[str, Any]] = {}
    for key, values in episode.arrays.items():
        called = list(names[key]) if key in names else None
        features[key] = {"dtype": values.dtype.name, "shape": [*values.shape[1:]] or [1], "names": called}
    for key, values in episode.pictures.items():
        shape = list(values.shape[1:])
        features[key] = {"dtype": "image", "shape": shape, "names": ["height", "width", "channels"]}
    features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    for key in ("frame_index", "episode_index", "index", "task_index"):
        features[key] = {"dtype": "int64", "shape": [1], "names": None}
    return features


def _spell(features: Mapping[str, Mapping[str, Any]]) -> str:
    return ", ".join(f"{key} {each['dtype']}{each['shape']}" for key, each in features.items())


def _column(pa: Any, values: np.ndarray) -> Any:
    flat = pa.array(np.ravel(values))
    return flat if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, values.shape[1])


def _encode(pa: Any, pictures: np.ndarray) -> Any:
    """Pictures as Hugging Face's `datasets` stores them."""
    kept = []
    for picture in pictures:
        buffer = io.BytesIO()
        Image.fromarray(picture).save(buffer, format="PNG")
        kept.append({"bytes": buffer.getvalue(), "path": None})
    return pa.array(kept, pa.struct([("bytes", pa.binary()), ("path", pa.string())]))


def _measure(columns: Mapping[str, np.ndarray], pictures: Mapping[str, np.ndarray]) -> Statistics:
    """Statistics of one episode by feature: (n,) for arrays, (3, 1, 1) in [0, 1] for pictures."""
    found = {key: _summarize(values.reshape(len(values), -1)) for key, values in columns.items()}
    for key, frames in pictures.items():
        some = frames[np.linspace(0, len(frames) - 1, min(PICTURES, len(frames))).round().astype(int)]
        summary = _summarize(some.reshape(-1, 3) / 255.0)
        found[key] = {name: value.reshape(3, 1, 1) for name, value in summary.items() if name != "count"}
        found[key]["count"] = np.array([len(some)])
    return found


def _summarize(values: np.ndarray) -> dict[str, np.ndarray]:
    values = values.astype(np.float64)
    return {
        "min": values.min(axis=0),
        "max": values.max(axis=0),
        "mean": values.mean(axis=0),
        "std": values.std(axis=0),
        "count": np.array([len(values)]),
        **dict(zip(QUANTILES, np.quantile(values, list(QUANTILES.values()), axis=0), strict=True)),
    }


def _merge(parts: Sequence[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """Statistics of all episodes together; quantiles are means over the episodes, as LeRobot defines them."""
    counts = np.array([part["count"][0] for part in parts], dtype=np.float64)
    stacked = {name: np.stack([part[name] for part in parts]) for name in parts[0]}

    def mean(values: np.ndarray) -> np.ndarray:
        return np.tensordot(counts, values, axes=1) / counts.sum()

    average = mean(stacked["mean"])
    variance = mean(stacked["std"] ** 2 + (stacked["mean"] - average) ** 2)
    return {
        "min": stacked["min"].min(axis=0),
        "max": stacked["max"].max(axis=0),
        "mean": average,
        "std": np.sqrt(variance),
        "count": stacked["count"].sum(axis=0),
        **{name: mean(stacked[name]) for name in QUANTILES},
    }


def _write_meta(
    scratch: Path, rows: list[dict[str, Any]], features: dict, said: dict[str, Any], pa: Any, parquet: Any
) -> None:
    """The tables and files in ``meta/``, except the tasks."""
    own: list[Statistics] = [row.pop("stats") for row in rows]
    for row, found in zip(rows, own, strict=True):
        row |= {f"stats/{key}/{name}": v.tolist() for key, each in found.items() for name, v in each.items()}
    path = scratch / "meta" / "episodes" / f"{_place(0)}.parquet"
    path.parent.mkdir(parents=True)
    parquet.write_table(pa.Table.from_pylist(rows), path)
    merged = {key: _merge([found[key] for found in own]) for key in own[0]}
    stats = {key: {name: v.tolist() for name, v in each.items()} for key, each in merged.items()}
    write_whole(scratch / "meta" / "stats.json", json.dumps(stats, indent=1))
    info = {
        "codebase_version": VERSION,
        **said,
        "chunks_size": CHUNK_FILES,
        "data_files_size_in_mb": FILE_MIB,
        "video_files_size_in_mb": 200,
        "splits": {"train": f"0:{len(rows)}"},
        "data_path": f"data/{FILE}.parquet",
        "video_path": None,
        "features": features,
    }
    write_whole(scratch / INFO, json.dumps(info, indent=1))
