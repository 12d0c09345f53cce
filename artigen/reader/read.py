"""`read_photo`: a photograph to a `Reading`."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import torch
from jaxtyping import Bool, Float, UInt8

from artigen.conditioning.image import open_picture
from artigen.errors import ArtigenError, SourceError
from artigen.kind import name_kind
from artigen.models.precision import native_autocast
from artigen.reader.choice import choose_fronts
from artigen.reader.decode import Found, average_maps, find_things, mirror_maps
from artigen.reader.edges import snap_boxes
from artigen.reader.hinges import average_shares, weigh_hinges
from artigen.reader.labels import DIAL, FRONT, HINGES, KINDS, MATERIALS, OBJECT, PULL, SHELF, STANDS, WHEEL
from artigen.reader.layout.frontal import FAR, LONG
from artigen.reader.looks import look_closer
from artigen.reader.model import Reader, load_reader
from artigen.reader.reading import Label, Reading, ReadPart
from artigen.weights import READER

if TYPE_CHECKING:
    from PIL import Image

EDGE = 384
"""Longest edge (pixels) at which photographs are read."""
KIND_EDGE, AROUND = 320, 1.2
"""Pixels at which kinds are read, and the edge of a crop over the longer side of its object."""
PAD = 255
"""Value around a photograph that is no square."""
AROUND_BOX = 0.1
"""Margin around the box of a requested object, as a share of its sides."""
LEAST_OBJECT, NOTHING = 0.2, 0.5
"""Score from which there is an object, and probability from which a picture shows nothing known."""
LEAST_FRONT = 0.3
"""Score from which there is a front, where the object that it belongs to is not known."""
LEAST = {PULL: 0.3, DIAL: 0.3, SHELF: 0.35, WHEEL: 0.35}
"""Score from which there is a part, by thing."""
REACH = 0.75
"""Largest distance of a front from the middle of its object, as a share of the object's width and height:
boxes of objects that fill a picture are read too small."""
MARGIN = 0.03
"""Margin around an object within which its other parts are, as a share of its longer side."""


@dataclass(frozen=True, kw_only=True)
class ReadSettings:
    """What is believed."""

    middle: float = 0.33
    """Score of a front that is as likely there as not."""
    usual: float = 0.4
    """Weight of how many fronts are usual for a kind."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sheet:
    """A photograph in a square, and where it lies there."""

    pixels: UInt8[np.ndarray, "S S 3"]
    origin: Float[np.ndarray, "2"]
    extent: Float[np.ndarray, "2"]

    def to_shares(self, points: Float[np.ndarray, "*N 2"]) -> Float[np.ndarray, "*N 2"]:
        """Pixels of the square as shares of the photograph."""
        return (points - self.origin) / self.extent

    def to_pixels(self, shares: Float[np.ndarray, "*N 2"]) -> Float[np.ndarray, "*N 2"]:
        """Inverts `to_shares`."""
        return shares * self.extent + self.origin


def read_photo(photo: Path, *, box: Sequence[float] | None = None, folder: Path = READER) -> Reading:
    """Reads the largest object of a photograph, or the one in a box, and looks closer at what was found.

    Args:
        photo: Any picture that `artigen.conditioning.image.open_picture` opens.
        box: Left, top, right and bottom of an object, as shares of width and height.
        folder: Folder of the reader's weights.

    Raises:
        SourceError: If the picture cannot be opened, or shows no object of a known kind.
        ArtigenError: If the box is none.
    """
    image = open_picture(photo)
    return look_closer(read_image(image, load_reader(folder), str(photo), box=box), image)


@torch.no_grad()
def read_image(
    image: "Image.Image",
    reader: Reader,
    name: str,
    *,
    box: Sequence[float] | None = None,
    settings: ReadSettings | None = None,
) -> Reading:
    """What the networks say of an opened picture; as `read_photo` but for the closer look. ``name`` is for
    messages."""
    if box is not None:
        _check_box(box)
        frame = _frame_box(image, box)
        part = read_image(image.crop(frame), reader, name, settings=settings)
        return _place_back(part, frame, image.size)
    sheet, things = _find(image, reader)
    chosen = _choose_object(things[OBJECT])
    if chosen is None:
        raise SourceError(_say_nothing([], name))
    nothing, kinds = _name_kinds(things[OBJECT], chosen, image, sheet, reader)
    if nothing > NOTHING:
        raise SourceError(_say_nothing(kinds, name))
    return _assemble(things, chosen, kinds, sheet, image, reader, settings or ReadSettings())


@torch.no_grad()
def read_all(image: "Image.Image", reader: Reader) -> Reading:
    """All fronts, handles and dials of a picture, of whatever objects, as if they were of one cabinet."""
    sheet, things = _find(image, reader)
    fronts = things[FRONT]
    fronts = fronts.take(np.flatnonzero(fronts.score > LEAST_FRONT))
    fronts = fronts.move(snap_boxes(sheet.pixels, fronts.box))
    pulls, kind = things[PULL], name_kind("cabinet")
    hinges = weigh_hinges(
        fronts.attributes["hinge"], fronts.box, pulls.box, pulls.score, reader.left_shares.get(kind, 0.5)
    )
    doors = fronts.attributes["door"][:, 0] > 0
    parts = [
        _describe_front(fronts, index, door, sides, sheet)
        for index, (door, sides) in enumerate(zip(doors.tolist(), hinges, strict=True))
    ]
    for thing in (PULL, DIAL):
        found = things[thing]
        parts += [
            _describe_part(found, int(index), thing, sheet)
            for index in np.flatnonzero(found.score > LEAST[thing])
        ]
    whole = np.array([0.0, 0.0, *sheet.pixels.shape[:2]])
    return Reading(
        kind=kind,
        kinds=((kind, 1.0),),
        box=np.array([0.0, 0.0, 1.0, 1.0]),
        parts=(*sort_reading(parts[: len(fronts)]), *parts[len(fronts) :]),
        size=(1.0, 1.0, 1.0),
        view=(0.0, 0.0, FAR),
        stand="flat",
        color=_median_color(sheet.pixels, whole, fronts.box),
        extent=image.size,
    )


def _find(image: "Image.Image", reader: Reader) -> tuple[_Sheet, list[Found]]:
    """The picture in a square, and the things in it, averaged with those of its mirror image."""
    sheet = _place(image)
    pixels = torch.from_numpy(sheet.pixels).permute(2, 0, 1)[None]
    with native_autocast(pixels.device):
        both = reader.network(pixels), reader.network(pixels.flip(3))
    return sheet, find_things(average_maps(both[0], mirror_maps(both[1])))[0]


def _name_kinds(
    objects: Found, chosen: int, image: "Image.Image", sheet: _Sheet, reader: Reader
) -> tuple[float, list[tuple[str, float]]]:
    """Probability that nothing is shown, and kinds with theirs.

    Those of the whole picture and of the object by the trunk as it was pretrained, and those that the network
    found in place, are multiplied.
    """
    crop = _cut(image, sheet, objects.box[chosen])
    pixels = torch.from_numpy(np.stack([_resize(sheet.pixels), crop])).permute(0, 3, 1, 2)
    with native_autocast(pixels.device):
        logits = reader.kinds(pixels).float()
    whole, part = logits.log_softmax(dim=1).numpy()
    placed = objects.attributes["kind"][chosen]
    seen = (whole + part) / 2
    nothing = float(np.exp(seen[-1] - np.logaddexp.reduce(seen)))
    return nothing, _rank_kinds((whole + part)[:-1] + placed)


def _resize(pixels: UInt8[np.ndarray, "S S 3"]) -> UInt8[np.ndarray, "E E 3"]:
    from PIL import Image

    return np.array(Image.fromarray(pixels).resize((KIND_EDGE, KIND_EDGE), Image.Resampling.BILINEAR))


def _cut(image: "Image.Image", sheet: _Sheet, box: Float[np.ndarray, "4"]) -> UInt8[np.ndarray, "E E 3"]:
    """A square around a box, from the picture itself."""
    middle, side = (box[:2] + box[2:]) / 2, AROUND * float(max(box[2:] - box[:2]))
    low, high = sheet.to_shares(middle - side / 2), sheet.to_shares(middle + side / 2)
    extent = np.array(image.size)
    x0, y0, x1, y1 = np.round(np.concatenate([low * extent, high * extent])).astype(int).tolist()
    from PIL import Image

    part = image.crop((x0, y0, max(x1, x0 + 1), max(y1, y0 + 1))).resize((KIND_EDGE, KIND_EDGE))
    square = Image.new("RGB", part.size, (PAD, PAD, PAD))
    square.paste(part.convert("RGB"), (0, 0), part.getchannel("A"))
    return np.array(square)


def _check_box(box: Sequence[float]) -> None:
    if len(box) != 4 or not (0 <= box[0] < box[2] <= 1 and 0 <= box[1] < box[3] <= 1):
        raise ArtigenError(
            f"box {', '.join(f'{value:g}' for value in box)}: expected left, top, right and bottom as shares "
            "of width and height, from 0 to 1, such as 0.1 0.2 0.6 0.9"
        )


def _place(image: "Image.Image") -> _Sheet:
    """The picture over white, scaled into a square."""
    from PIL import Image as PillowImage

    scale = EDGE / max(image.size)
    extent = (max(8, round(image.width * scale)), max(8, round(image.height * scale)))
    small = image.resize(extent, PillowImage.Resampling.BOX if scale < 1 else PillowImage.Resampling.BILINEAR)
    origin = ((EDGE - extent[0]) // 2, (EDGE - extent[1]) // 2)
    square = PillowImage.new("RGB", (EDGE, EDGE), (PAD, PAD, PAD))
    square.paste(small.convert("RGB"), origin, small.getchannel("A"))
    return _Sheet(
        pixels=np.array(square), origin=np.array(origin, np.float64), extent=np.array(extent, np.float64)
    )


def _choose_object(objects: Found) -> int | None:
    """Index of the largest object, weighted by its score."""
    if not len(objects) or objects.score.max() < LEAST_OBJECT:
        return None
    sides = np.sqrt(np.prod(objects.box[:, 2:] - objects.box[:, :2], axis=1))
    return int(np.argmax(sides * objects.score * (objects.score >= LEAST_OBJECT)))


def _say_nothing(kinds: Sequence[tuple[str, float]], name: str) -> str:
    """Why nothing was read."""
    said = f"{name}: no object of a known kind was found"
    if kinds:
        likely = ", ".join(f"{kind} ({share:.0%})" for kind, share in kinds[:3])
        said += f"; if it shows one, the likeliest kinds are {likely}"
    return said + "; show one piece of furniture or appliance as a whole, from near its front"


def _frame_box(image: "Image.Image", box: Sequence[float]) -> tuple[int, int, int, int]:
    """A part of the picture around a box (pixels)."""
    low, high = np.array(box[:2]), np.array(box[2:])
    edge = AROUND_BOX * (high - low)
    extent = np.array(image.size)
    x0, y0 = np.floor(np.maximum(low - edge, 0) * extent).astype(int).tolist()
    x1, y1 = np.ceil(np.minimum(high + edge, 1) * extent).astype(int).tolist()
    return x0, y0, x1, y1


def _place_back(reading: Reading, frame: tuple[int, int, int, int], extent: tuple[int, int]) -> Reading:
    """The reading of a part of a picture, in shares of the whole."""
    size, origin = np.array(extent), np.array(frame[:2])
    scale = (np.array(frame[2:]) - origin) / size

    def move(points: Float[np.ndarray, "*N 2"]) -> Float[np.ndarray, "*N 2"]:
        return points * scale + origin / size

    parts = tuple(
        replace(
            part,
            box=move(part.box.reshape(2, 2)).ravel(),
            corners=None if part.corners is None else move(part.corners),
        )
        for part in reading.parts
    )
    return replace(reading, box=move(reading.box.reshape(2, 2)).ravel(), parts=parts, extent=extent)


def _rank_kinds(logits: Float[np.ndarray, "K"]) -> list[tuple[str, float]]:
    shares = np.exp(logits - logits.max())
    shares /= shares.sum()
    return [(KINDS[index], float(shares[index])) for index in np.argsort(-shares)]


def _assemble(
    things: Sequence[Found],
    chosen: int,
    kinds: list[tuple[str, float]],
    sheet: _Sheet,
    image: "Image.Image",
    reader: Reader,
    settings: ReadSettings,
) -> Reading:
    """The reading of one object."""
    objects = things[OBJECT]
    own = objects.box[chosen]
    said = {name: values[chosen] for name, values in objects.attributes.items()}
    parts: list[ReadPart] = []
    fronts = things[FRONT]
    considered = np.flatnonzero(_is_near(fronts.box, own))
    doors = 1.0 / (1.0 + np.exp(-fronts.attributes["door"][considered, 0].astype(np.float64)))
    believed, labels = choose_fronts(
        fronts.score[considered].astype(np.float64),
        doors,
        kinds,
        reader.counts,
        middle=settings.middle,
        strength=settings.usual,
    )
    fronts = fronts.take(considered[believed])
    fronts = fronts.move(snap_boxes(sheet.pixels, fronts.box))
    hinges = weigh_hinges(
        fronts.attributes["hinge"],
        fronts.box,
        things[PULL].box,
        things[PULL].score,
        average_shares(kinds, reader.left_shares),
    )
    for index, (door, sides) in enumerate(zip(labels, hinges, strict=True)):
        parts.append(_describe_front(fronts, index, door, sides, sheet))
        box = fronts.box[index]
        own = np.concatenate([np.minimum(own[:2], box[:2]), np.maximum(own[2:], box[2:])])
    for thing in (PULL, DIAL, SHELF, WHEEL):
        found = things[thing]
        kept = np.flatnonzero((found.score > LEAST[thing]) & _is_within(found.box, own))
        parts += [_describe_part(found, int(index), thing, sheet) for index in kept]
    sorted_fronts = sort_reading([part for part in parts if part.label in ("door", "drawer")])
    others = [part for part in parts if part.label not in ("door", "drawer")]
    width, depth, height = (float(value) for value in np.exp(said["size"]))
    yaw, pitch, near = (float(value) for value in said["view"])
    return Reading(
        kind=kinds[0][0],
        kinds=tuple(kinds),
        box=np.clip(sheet.to_shares(own.reshape(2, 2)), 0, 1).ravel(),
        parts=(*sorted_fronts, *others),
        size=(width, depth, height),
        view=(yaw, pitch, near),
        stand=STANDS[int(said["stand"].argmax())],  # type: ignore[arg-type]
        color=_median_color(sheet.pixels, own, things[FRONT].box),
        extent=image.size,
    )


def _is_near(boxes: Float[np.ndarray, "N 4"], own: Float[np.ndarray, "4"]) -> Bool[np.ndarray, "N"]:
    """Whether the middles of boxes lie in the reach of an object."""
    away = (boxes[:, :2] + boxes[:, 2:] - own[:2] - own[2:]) / 2
    return np.asarray((np.abs(away) < REACH * (own[2:] - own[:2])).all(axis=1))


def _is_within(boxes: Float[np.ndarray, "N 4"], own: Float[np.ndarray, "4"]) -> Bool[np.ndarray, "N"]:
    """Whether the middles of boxes lie within an object."""
    middle, margin = (boxes[:, :2] + boxes[:, 2:]) / 2, MARGIN * float(max(own[2:] - own[:2]))
    return np.asarray(((middle > own[:2] - margin) & (middle < own[2:] + margin)).all(axis=1))


def _describe_part(found: Found, index: int, thing: int, sheet: _Sheet) -> ReadPart:
    labels: dict[int, Label] = {PULL: "handle", DIAL: "knob", SHELF: "shelf", WHEEL: "wheel"}
    box = found.box[index]
    wide, high = box[2:] - box[:2]
    form = None
    if thing == PULL:
        form = "bar" if max(wide, high) > LONG * min(wide, high) else "knob"
    return ReadPart(
        label=labels[thing],
        score=float(found.score[index]),
        box=_to_box(box, sheet),
        form=form,
        color=_median_color(sheet.pixels, box),
    )


def _describe_front(
    found: Found,
    index: int,
    door: bool,  # noqa: FBT001
    sides: Float[np.ndarray, "4"],
    sheet: _Sheet,
) -> ReadPart:
    said = {name: values[index] for name, values in found.attributes.items()}
    pane = bool(said["pane"][0] > 0)
    solid = [material for material in MATERIALS if pane or material != "glass"]
    return ReadPart(
        label="door" if door else "drawer",
        score=float(found.score[index]),
        box=_to_box(found.box[index], sheet),
        corners=sheet.to_shares(found.corners[index]),
        hinge=HINGES[int(sides.argmax())] if door else None,  # type: ignore[arg-type]
        open=bool(said["open"][0] > 0),
        pane=pane,
        material=max(solid, key=lambda material: float(said["material"][MATERIALS.index(material)])),
        color=_median_color(sheet.pixels, found.box[index]),
    )


def _to_box(box: Float[np.ndarray, "4"], sheet: _Sheet) -> Float[np.ndarray, "4"]:
    return np.clip(sheet.to_shares(box.reshape(2, 2)), 0, 1).ravel()


def sort_reading(fronts: Sequence[ReadPart]) -> list[ReadPart]:
    """Fronts from top to bottom, and from left to right where they overlap in height by half."""
    rest = sorted(fronts, key=lambda part: float(part.box[1]))
    out: list[ReadPart] = []
    while rest:
        first = rest[0]
        row = [part for part in rest if _share_height(part, first) > 0.5]
        out += sorted(row, key=lambda part: float(part.box[0]))
        rest = [part for part in rest if part not in row]
    return out


def _share_height(part: ReadPart, other: ReadPart) -> float:
    shared = min(part.box[3], other.box[3]) - max(part.box[1], other.box[1])
    return float(shared / max(min(part.box[3] - part.box[1], other.box[3] - other.box[1]), 1e-6))


def _median_color(
    pixels: UInt8[np.ndarray, "S S 3"],
    box: Float[np.ndarray, "4"],
    without: Float[np.ndarray, "N 4"] | None = None,
) -> tuple[int, int, int]:
    """Median colour within a box, apart from other boxes where something else is left."""
    low = np.clip(np.floor(box[:2] + 0.15 * (box[2:] - box[:2])), 0, len(pixels) - 1).astype(int)
    high = np.maximum(
        low + 1, np.clip(np.ceil(box[2:] - 0.15 * (box[2:] - box[:2])), 0, len(pixels)).astype(int)
    )
    inside = np.zeros(pixels.shape[:2], bool)
    inside[low[1] : high[1], low[0] : high[0]] = True
    if without is not None:
        free = inside.copy()
        for x0, y0, x1, y1 in np.clip(without, 0, len(pixels)).astype(int):
            free[y0:y1, x0:x1] = False
        inside = free if free.any() else inside
    red, green, blue = np.median(pixels[inside], axis=0)
    return int(red), int(green), int(blue)
