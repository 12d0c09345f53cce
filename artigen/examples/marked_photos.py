"""Photographs of rooms whose doors, drawers and pulls are marked, as training pictures of the reader.

The folder holds ``labels.json`` and ``images``: for each photograph its fronts with label, box (shares of
width and height), hinge side and whether it is open, the boxes of pulls, and those of doors of rooms. Labels
``pair`` and ``none`` are ignored, and so is the empty ground of photographs that are not marked completely.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from artigen.errors import SourceError
from artigen.examples.photometry import vary_photometry
from artigen.kind import name_kind
from artigen.reader.labels import DIAL, FRONT, HINGES, KINDS, OBJECT, PULL, THINGS, UNKNOWN
from artigen.reader.network import STRIDE
from artigen.reader.targets import MARK, Picture, make_mark

UNCHECKED = 0.2
"""Weight of empty ground where marks may be missing."""
APPLIANCES = ("refrigerator", "oven", "dishwasher", "microwave", "washer")
FRAMELESS = ("refrigerator", "dishwasher")
"""Appliances whose fronts show where they end."""
FURNITURE = ("dresser", "wardrobe", "desk", "cabinet")
"""Nouns of the photographs for a front's appliance and for the main object."""
TOUCHING, SPACED = 0.1, 0.35
"""Largest gap between fronts of one appliance, and of one piece of furniture, as a share of the larger
front."""
FRAME = 0.04
"""Width of the frame around a piece of furniture's fronts, as a share of their extent."""
LEAST_FRONT, LEAST_PULL = 7.0, 3.0
"""Least extents (pixels) of what is worth finding: of both sides of a front, of the longer side of a pull."""
SEEN = 0.5
"""Share of a box that must be inside the picture; with less, the thing counts neither as there nor as
missing."""
LARGEST_GAIN = 2.2
"""Largest enlargement of a photograph."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MarkedPhoto:
    """A photograph with its marks; boxes are shares of width and height, y down."""

    path: Path
    fronts: tuple[dict, ...]
    pulls: Float[np.ndarray, "N 4"]
    room_doors: Float[np.ndarray, "N 4"]
    complete: bool
    objects: tuple[tuple[str, Float[np.ndarray, "4"], bool], ...] = field(default=())
    """Kind and box of recognised objects, and whether the box is that of the whole object."""


def read_marked_photos(folder: Path) -> list[MarkedPhoto]:
    """All photographs of a folder that exist and have a front or are marked completely.

    Raises:
        SourceError: If the folder has no ``labels.json`` or an image is missing.
    """
    table = folder / "labels.json"
    if not table.is_file():
        raise SourceError(f"{folder}: holds no labels.json; expected a folder of marked photographs")
    out = []
    for name, entry in sorted(json.loads(table.read_text()).items()):
        found = sorted((folder / "images").glob(f"{name}.*"))
        if not found:
            raise SourceError(f"{folder}: labels.json names {name}, but images holds no such file")
        fronts = tuple(entry["fronts"])
        room_doors = np.array(entry["room_doors"], np.float32).reshape(-1, 4)
        out.append(
            MarkedPhoto(
                path=found[0],
                fronts=fronts,
                pulls=np.array(entry["pulls"], np.float32).reshape(-1, 4),
                room_doors=room_doors,
                complete=entry["complete"] is True,
                objects=tuple(
                    _find_objects(fronts, room_doors, entry["object"], complete=entry["complete"] is True)
                ),
            )
        )
    return out


def _find_objects(
    fronts: Sequence[dict],
    room_doors: Float[np.ndarray, "N 4"],
    main: str | None,
    *,
    complete: bool,
) -> list[tuple[str, Float[np.ndarray, "4"], bool]]:
    """Objects whose kind is known, from groups of fronts that touch."""
    out = []
    for noun in APPLIANCES:
        boxes = [np.array(f["box"]) for f in fronts if f.get("kind") == noun]
        out += [(name_kind(noun), box, noun in FRAMELESS) for box in _join_boxes(boxes, TOUCHING)]
    if main in FURNITURE:
        own = [np.array(f["box"]) for f in fronts if f.get("kind") in (None, "cabinet", "other")]
        groups = _join_boxes(own, SPACED)
        if groups:
            largest = max(groups, key=lambda box: float((box[2] - box[0]) * (box[3] - box[1])))
            edge = FRAME * (largest[2:] - largest[:2])
            whole = np.clip(np.concatenate([largest[:2] - edge, largest[2:] + edge]), 0, 1).astype(np.float32)
            out.append((name_kind(main), whole, complete and main != "desk"))
    out += [(name_kind("door"), box, True) for box in room_doors]
    return out


def _join_boxes(boxes: Sequence[np.ndarray], reach: float) -> list[np.ndarray]:
    """Hulls of boxes whose gaps are below a share of the larger one."""
    groups: list[list[np.ndarray]] = []
    for box in boxes:
        near = [
            group
            for group in groups
            if any(_gap(box, other) < reach * _extent(box, other) for other in group)
        ]
        groups = [group for group in groups if not any(group is one for one in near)]
        groups.append([box, *(other for group in near for other in group)])
    return [
        np.concatenate([np.min(group, axis=0)[:2], np.max(group, axis=0)[2:]]).astype(np.float32)
        for group in groups
    ]


def _gap(a: np.ndarray, b: np.ndarray) -> float:
    return float(max(a[0] - b[2], b[0] - a[2], a[1] - b[3], b[1] - a[3]))


def _extent(a: np.ndarray, b: np.ndarray) -> float:
    return float(max(a[2] - a[0], a[3] - a[1], b[2] - b[0], b[3] - b[1]))


def read_pixels(path: Path) -> UInt8[np.ndarray, "H W 3"]:
    """RGB pixels of a photograph."""
    image = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if image is None:
        raise SourceError(f"{path}: cannot be decoded as an image")
    return np.ascontiguousarray(image[:, :, ::-1])


def sampling_weights(photos: Sequence[MarkedPhoto]) -> Float[np.ndarray, "N"]:
    """How often each photograph is used: those that are marked completely most."""
    weights = np.array([3.0 if p.complete and p.fronts else 1.0 if p.fronts else 0.35 for p in photos])
    return weights / weights.sum()


def crop_photo(photo: MarkedPhoto, size: int, rng: np.random.Generator) -> Picture:
    """A random part of a photograph, mostly a group of neighbouring fronts, changed in place and light."""
    image = read_pixels(photo.path)
    height, width = image.shape[:2]
    scale = np.array([width, height, width, height], np.float32)
    x, y, side = _choose_frame(photo, width, height, rng)
    matrix, flipped = _choose_warp(x, y, side, size, rng)
    shrink = float(np.sqrt(abs(np.linalg.det(matrix[:, :2]))))
    if shrink < 0.6:
        image = cv2.GaussianBlur(image, (0, 0), 0.35 / shrink)
    pad = float(rng.choice([0, 128, 255], p=[0.15, 0.25, 0.6]))
    pixels = cv2.warpAffine(image, matrix, (size, size), flags=cv2.INTER_LINEAR, borderValue=(pad, pad, pad))
    marks, ignored = [], []

    def add(thing: int, box: np.ndarray, least: float, **known: int) -> None:
        whole = _warp_box(np.asarray(box, np.float32) * scale, matrix)
        seen = np.clip(whole, 0, size)
        area = float(np.prod(seen[2:] - seen[:2]))
        if min(seen[2:] - seen[:2]) <= 0:
            return
        sides = seen[2:] - seen[:2]
        small = (sides.max() if thing in (PULL, DIAL) else sides.min()) < least
        if small or area < SEEN * float(np.prod(whole[2:] - whole[:2])):
            ignored.append((thing, seen))
        else:
            marks.append(make_mark(thing, seen, **known))

    for front in photo.fronts:
        label = front["label"]
        if label in ("pair", "none"):
            ignored.append(
                (FRONT, np.clip(_warp_box(np.array(front["box"], np.float32) * scale, matrix), 0, size))
            )
            continue
        add(
            FRONT,
            front["box"],
            LEAST_FRONT,
            door=UNKNOWN if label is None else int(label == "door"),
            hinge=_mirror_hinge(front.get("hinge"), flipped),
            open=UNKNOWN if front.get("open") is None else int(front["open"]),
        )
    for box in photo.room_doors:
        add(FRONT, box, LEAST_FRONT, door=1)
    for box in photo.pulls:
        add(PULL, box, LEAST_PULL)
    weight = _weigh(photo, marks, ignored, size)
    for kind, box, whole in photo.objects:
        _add_object(marks, kind, _warp_box(box * scale, matrix), size, whole)
    return Picture(
        pixels=vary_photometry(pixels, rng),
        marks=np.array(marks, MARK).reshape(-1),
        weight=weight,
    )


def _add_object(marks: list[np.ndarray], kind: str, box: np.ndarray, size: int, whole: bool) -> None:  # noqa: FBT001
    seen = np.clip(box, 0, size)
    if min(seen[2:] - seen[:2]) < 0.1 * size or np.prod(seen[2:] - seen[:2]) < 0.7 * np.prod(
        box[2:] - box[:2]
    ):
        return
    marks.append(make_mark(OBJECT, seen, kind=KINDS.index(kind), sized=int(whole)))


def _weigh(
    photo: MarkedPhoto, marks: Sequence[np.ndarray], ignored: Sequence[tuple[int, np.ndarray]], size: int
) -> Float[np.ndarray, "T h w"]:
    """Weight of cells without a peak, by thing."""
    edge = size // STRIDE
    weight = np.zeros((len(THINGS), edge, edge), np.float32)
    weight[FRONT] = weight[PULL] = 1.0 if photo.complete else UNCHECKED
    # Dials and shelves are not marked; appliances have them, so only pictures without one show where
    # none are.
    if photo.complete and not any(f.get("kind") in APPLIANCES for f in photo.fronts):
        weight[DIAL] = UNCHECKED

    def cells(box: np.ndarray, margin: float) -> tuple[slice, slice]:
        low, high = np.floor((box[:2] - margin) / STRIDE), np.ceil((box[2:] + margin) / STRIDE)
        return slice(max(0, int(low[1])), int(high[1])), slice(max(0, int(low[0])), int(high[0]))

    fronts = [mark for mark in marks if mark["thing"] == FRONT]
    has_pulls = any(mark["thing"] == PULL for mark in marks)
    for mark in fronts:
        weight[FRONT][cells(mark["box"], 6)] = 1.0
        weight[PULL][cells(mark["box"], 0)] = 1.0 if has_pulls else UNCHECKED
    for thing, box in ignored:
        weight[thing][cells(box, 3 if thing == PULL else 0)] = 0.0
        if thing == FRONT:
            weight[PULL][cells(box, 0)] = 0.0
    return weight


def _mirror_hinge(side: str | None, flipped: bool) -> int:  # noqa: FBT001
    if side is None:
        return UNKNOWN
    if flipped and side in ("left", "right"):
        side = "right" if side == "left" else "left"
    return HINGES.index(side)


def _choose_frame(
    photo: MarkedPhoto, width: int, height: int, rng: np.random.Generator
) -> tuple[float, float, float]:
    """Left, top and edge (pixels) of a square: a group of neighbouring fronts, or any part of the
    photograph."""
    scale = np.array([width, height, width, height])
    boxes = (
        np.array([f["box"] for f in photo.fronts if f["label"] not in ("pair", "none")]).reshape(-1, 4)
        * scale
    )
    if not len(boxes) or rng.random() < 0.12:
        side = max(width, height) * rng.uniform(0.45, 1.05)
        return (
            rng.uniform(min(0, width - side), max(0, width - side)),
            rng.uniform(min(0, height - side), max(0, height - side)),
            side,
        )
    reach = rng.choice([0.03, 0.1, 0.35, 2.0], p=[0.25, 0.25, 0.25, 0.25])
    group = [boxes[rng.integers(len(boxes))]]
    rest = [box for box in boxes if box is not group[0]]
    while near := [b for b in rest if any(_gap(b, g) < reach * _extent(b, g) for g in group)]:
        group += near
        rest = [b for b in rest if not any(b is n for n in near)]
        if len(rest) == 0:
            break
    low, high = np.min(group, axis=0)[:2], np.max(group, axis=0)[2:]
    extent = float(max(*(high - low), 40))
    side = extent * np.exp(rng.uniform(np.log(1.02), np.log(2.2)))
    slack = 0.45 * (side - float(max(high - low)))
    middle = (low + high) / 2 + rng.uniform(-slack, slack, 2)
    return middle[0] - side / 2, middle[1] - side / 2, side


def _choose_warp(
    x: float, y: float, side: float, size: int, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "2 3"], bool]:
    """Affine map from the photograph to the picture, and whether it mirrors."""
    stretch = np.exp(rng.normal(0, 0.07))
    gain = min(size / side, LARGEST_GAIN)
    kx, ky = gain * stretch, gain / stretch
    flipped = bool(rng.random() < 0.5)
    turn = np.deg2rad(rng.normal(0, 1.2))
    skew = rng.normal(0, 0.015)
    linear = np.array([[np.cos(turn), -np.sin(turn) + skew], [np.sin(turn), np.cos(turn)]]) @ np.diag(
        [-kx if flipped else kx, ky]
    )
    middle = np.array([x + side / 2, y + side / 2])
    return np.column_stack([linear, size / 2 - linear @ middle]).astype(np.float32), flipped


def _warp_box(box: np.ndarray, matrix: Float[np.ndarray, "2 3"]) -> Float[np.ndarray, "4"]:
    """The upright box of a warped upright box; a slight turn does not make it larger."""
    middle = (box[:2] + box[2:]) / 2 @ matrix[:, :2].T + matrix[:, 2]
    half = (box[2:] - box[:2]) / 2 * np.abs(np.diag(matrix[:, :2]))
    return np.concatenate([middle - half, middle + half]).astype(np.float32)
