"""Training of the reader's kinds: one linear layer on features of a frozen trunk."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import cv2
import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor
from torch.nn import functional

from artigen.examples.blank_pictures import draw_blank
from artigen.examples.marked_photos import MarkedPhoto, crop_photo
from artigen.examples.picture_stock import Stock
from artigen.examples.reader_pictures import make_picture
from artigen.examples.view_shards import read_views
from artigen.reader.kind_network import DROPPED, KindNetwork
from artigen.reader.labels import KINDS, OBJECT
from artigen.reader.targets import Picture

EDGE, SOURCE = 288, 384
"""Pixels of a crop's edge, and of the picture that it is cut from."""
WIDEST = 1.5
"""Largest edge of a crop over the longer side of its object."""
SMALLEST = 90
"""Least edge (pixels of the picture) of a crop."""
PHOTOS_PER_SHARD, BLANKS_PER_SHARD = 12, 5
"""Photographs, and pictures that show nothing known, beside the views of a shard."""
NOTHING = len(KINDS)
"""Number of pictures that show nothing known."""
STEPS, ROWS, RATE, DECAY = 600, 512, 3e-3, 0.3
"""Steps, crops per step, learning rate and weight decay."""
RARE = 20
"""Crops of a kind below which each counts little more than those of a kind with so many."""
REAL = 2.0
"""Weight of a crop of a photograph over one of a rendered view."""


def cut_objects(
    picture: Picture, rng: np.random.Generator
) -> Iterator[tuple[UInt8[np.ndarray, "E E 3"], int]]:
    """Square crops around the objects of a picture, with their kinds."""
    for mark in picture.marks[(picture.marks["thing"] == OBJECT) & (picture.marks["kind"] >= 0)]:
        low, high = mark["box"][:2], mark["box"][2:]
        side = float(max(high - low)) * rng.uniform(1.02, WIDEST)
        if side < SMALLEST:
            continue
        middle = (low + high) / 2 + rng.normal(0, 0.04, 2) * side
        scale = EDGE / side
        matrix = np.array(
            [[scale, 0, EDGE / 2 - middle[0] * scale], [0, scale, EDGE / 2 - middle[1] * scale]]
        )
        how = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
        yield (
            cv2.warpAffine(picture.pixels, matrix, (EDGE, EDGE), flags=how, borderValue=(255, 255, 255)),
            int(mark["kind"]),
        )


def gather_features(
    network: KindNetwork, shards: Sequence[Path], photos: Sequence[MarkedPhoto], stock: Stock
) -> tuple[Float[Tensor, "N 1280"], Int[Tensor, "N"], Float[Tensor, "N"]]:
    """Features, kinds and weights of crops of rendered views and of photographs."""
    rng = np.random.default_rng([0, 2])
    shown = [photo for photo in photos if photo.objects]
    features, kinds, weights = [], [], []
    for shard in shards:
        crops: list[tuple[np.ndarray, int]] = []
        for packed in read_views(shard):
            crops += cut_objects(make_picture(packed.unpack(), stock, SOURCE, rng), rng)
        weights += [1.0] * len(crops)
        for index in rng.integers(len(shown), size=PHOTOS_PER_SHARD) if shown else ():
            found = list(cut_objects(crop_photo(shown[int(index)], SOURCE, rng), rng))
            crops += found
            weights += [REAL] * len(found)
        blanks = [draw_blank(stock, EDGE, rng) for _ in range(BLANKS_PER_SHARD)]
        crops += [(blank, NOTHING) for blank in blanks]
        weights += [1.0] * len(blanks)
        if crops:
            pixels = torch.from_numpy(np.stack([pixels for pixels, _ in crops])).permute(0, 3, 1, 2)
            features.append(network.extract(pixels))
            kinds += [kind for _, kind in crops]
    return torch.cat(features), torch.tensor(kinds), torch.tensor(weights)


def fit_kinds(
    network: KindNetwork,
    features: Float[Tensor, "N 1280"],
    kinds: Int[Tensor, "N"],
    weights: Float[Tensor, "N"],
) -> None:
    """Fits the linear layer by logistic regression; rare kinds weigh more."""
    counted = torch.bincount(kinds, minlength=NOTHING + 1).float()
    weights = weights / (counted[kinds] + RARE)
    weights = weights / weights.mean()
    generator = torch.Generator().manual_seed(0)
    optimizer = torch.optim.AdamW(network.kinds.parameters(), lr=RATE, weight_decay=DECAY)
    for _ in range(STEPS):
        rows = torch.randperm(len(kinds), generator=generator)[:ROWS]
        kept = torch.rand(len(rows), features.shape[1], generator=generator) > DROPPED
        logits = network.kinds(features[rows] * kept / (1 - DROPPED))
        loss = functional.cross_entropy(logits, kinds[rows], reduction="none")
        optimizer.zero_grad()
        (loss * weights[rows]).mean().backward()
        optimizer.step()
