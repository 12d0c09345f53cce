"""Rendered views of the reader in files."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch

from artigen.examples.reader_views import BODY, PART, View, take_views
from artigen.examples.shards import ShardConfig, ShardJob, load_shard, make_shards, save_shard, split_rows

VIEWS = 16
"""Views of a shard."""
TIMEOUT = 900.0
"""Seconds after which a shard counts as failed."""


@dataclass(frozen=True, kw_only=True)
class ViewShardConfig(ShardConfig):
    """As `ShardConfig`, with the device that renders."""

    device: str = "cpu"


def make_view_shards(
    folder: Path, count: int, *, first: int, workers: int, device: str = "cpu"
) -> list[Path]:
    """Renders the shards of views that are missing, and returns the paths of all.

    Args:
        first: Seed of the first shard.
        device: Name of the torch device that renders; all workers share it.

    Raises:
        SourceError: If a shard could not be made.
    """
    cfg = ViewShardConfig(first_seed=first, objects=VIEWS, timeout=TIMEOUT, device=device)
    return make_shards(folder, count, cfg, _make_view_shard, workers=workers)


def _make_view_shard(job: ShardJob[ViewShardConfig]) -> Path:
    torch.set_num_threads(1)  # there is one process per core
    views = take_views(job.cfg.first_seed + job.number, job.cfg.objects, job.cfg.device)
    save_shard(job.path, pack_views(views), packed=False)
    return job.path


def pack_views(views: Sequence[View]) -> dict[str, np.ndarray]:
    """Views as arrays; pictures and numbers of parts as PNG."""
    from PIL import Image

    def encode(image: np.ndarray) -> np.ndarray:
        out = io.BytesIO()
        Image.fromarray(image).save(out, format="PNG", compress_level=1)
        return np.frombuffer(out.getvalue(), dtype=np.uint8)

    pictures = [encode(view.rgba) for view in views]
    numbers = [encode(view.ids) for view in views]
    return {
        "pictures": np.concatenate(pictures),
        "picture_bytes": np.array([len(one) for one in pictures]),
        "ids": np.concatenate(numbers),
        "id_bytes": np.array([len(one) for one in numbers]),
        "parts": np.concatenate([view.parts for view in views]),
        "part_counts": np.array([len(view.parts) for view in views]),
        "bodies": np.concatenate([view.bodies for view in views]),
        "body_counts": np.array([len(view.bodies) for view in views]),
    }


@dataclass(frozen=True, kw_only=True, eq=False)
class PackedView:
    """A view whose pictures are still compressed."""

    rgba: bytes
    ids: bytes
    parts: np.ndarray
    bodies: np.ndarray

    def unpack(self) -> View:
        """The view."""
        from PIL import Image

        rgba, ids = (np.asarray(Image.open(io.BytesIO(data))) for data in (self.rgba, self.ids))
        return View(rgba=rgba, ids=ids.astype(np.uint16), parts=self.parts, bodies=self.bodies)


def read_views(path: Path) -> list[PackedView]:
    """Views of a file written by `artigen.examples.reader_views.pack_views`."""
    packed = load_shard(
        path, ("pictures", "picture_bytes", "ids", "id_bytes", "parts", "part_counts", "bodies")
    )
    return [
        PackedView(
            rgba=rgba.tobytes(), ids=ids.tobytes(), parts=parts.astype(PART), bodies=bodies.astype(BODY)
        )
        for rgba, ids, parts, bodies in zip(
            split_rows(packed["pictures"], packed["picture_bytes"]),
            split_rows(packed["ids"], packed["id_bytes"]),
            split_rows(packed["parts"], packed["part_counts"]),
            split_rows(packed["bodies"], packed["body_counts"]),
            strict=True,
        )
    ]
