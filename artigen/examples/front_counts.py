"""How many doors and drawers objects of each kind show, from rendered views and marked photographs."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from artigen.examples.marked_photos import APPLIANCES, MarkedPhoto
from artigen.examples.reader_pictures import LEAST_FRONT
from artigen.examples.view_shards import read_views
from artigen.kind import name_kind
from artigen.reader.choice import Counts, CountShares
from artigen.reader.labels import FRONT, KINDS

FEW, MOSTLY = 4, 0.9
"""A kind's counts say something if this share of its objects has at most so many fronts; cabinets have any
number."""
ENOUGH = 10
"""Least number of objects in photographs for them to weigh as much as the views."""


def share_counts(shards: Sequence[Path], photos: Sequence[MarkedPhoto]) -> CountShares:
    """Shares of doors and drawers by kind; kinds that have any number of fronts are left out."""
    seen: dict[str, Counter[Counts]] = {}
    for shard in shards:
        for packed in read_views(shard):
            view = packed.unpack()
            pixels = np.bincount(view.ids[view.ids < len(view.parts)], minlength=len(view.parts))
            own = view.parts["object"] == 0
            front = own & (view.parts["thing"] == FRONT) & (pixels > LEAST_FRONT * pixels[own].sum())
            doors = int((view.parts["door"][front] == 1).sum())
            seen.setdefault(KINDS[view.bodies["kind"][0]], Counter())[doors, int(front.sum()) - doors] += 1
    real = count_photos(photos)
    out = {}
    for kind, counted in seen.items():
        if sum(count for key, count in counted.items() if sum(key) <= FEW) < MOSTLY * counted.total():
            continue
        share = _normalise(counted)
        if sum(real.get(kind, {}).values()) >= ENOUGH:
            other = _normalise(real[kind])
            share = {key: (share.get(key, 0.0) + other.get(key, 0.0)) / 2 for key in {*share, *other}}
        out[kind] = share
    return out


def count_photos(photos: Sequence[MarkedPhoto]) -> dict[str, Counter[Counts]]:
    """Doors and drawers of the appliances in completely marked photographs, by kind."""
    out: dict[str, Counter[Counts]] = {}
    for photo in photos:
        if not photo.complete:
            continue
        for kind, box, _ in photo.objects:
            words = {noun for noun in APPLIANCES if name_kind(noun) == kind}
            inside = [
                front["label"]
                for front in photo.fronts
                if front.get("kind") in words and _holds(box, np.array(front["box"]))
            ]
            if words and inside and set(inside) <= {"door", "drawer"}:
                out.setdefault(kind, Counter())[inside.count("door"), inside.count("drawer")] += 1
    return out


def share_left_hinges(photos: Sequence[MarkedPhoto]) -> dict[str, float]:
    """Share of the doors with hinges at the left, of those without another front beside them, by kind of
    appliance."""
    counted: dict[str, Counter[str]] = {}
    for photo in photos:
        for noun in APPLIANCES:
            fronts = [front for front in photo.fronts if front.get("kind") == noun]
            boxes = np.array([front["box"] for front in fronts]).reshape(-1, 4)
            for front, box in zip(fronts, boxes, strict=True):
                level = np.minimum(boxes[:, 3], box[3]) - np.maximum(boxes[:, 1], box[1])
                alone = (level > 0.5 * (box[3] - box[1])).sum() == 1
                if alone and front["label"] == "door" and front.get("hinge") in ("left", "right"):
                    counted.setdefault(name_kind(noun), Counter())[front["hinge"]] += 1
    return {
        kind: round((sides["left"] + 1) / (sides.total() + 2), 3)
        for kind, sides in counted.items()
        if sides.total() >= ENOUGH
    }


def _holds(outer: np.ndarray, inner: np.ndarray) -> bool:
    middle = (inner[:2] + inner[2:]) / 2
    return bool((middle > outer[:2]).all() and (middle < outer[2:]).all())


def _normalise(counted: Counter[Counts]) -> dict[Counts, float]:
    return {key: count / counted.total() for key, count in counted.items()}
