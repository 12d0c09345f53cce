"""`read_photo`: a photograph to a `Reading`."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import torch
from jaxtyping import Float, UInt8

from artigen.conditioning.image import open_picture
from artigen.errors import ArtigenError, SourceError
from artigen.kind import name_kind
from artigen.models.precision import native_autocast
from artigen.reader.assemble import (
    LEAST,
    ReadSettings,
    Sheet,
    assemble,
    describe_front,
    describe_part,
    median_color,
    sort_reading,
)
from artigen.reader.decode import Found, average_maps, find_things, mirror_maps
from artigen.reader.edges import snap_boxes
from artigen.reader.hinges import weigh_hinges
from artigen.reader.labels import DIAL, FRONT, KINDS, OBJECT, PULL
from artigen.reader.layout.frontal import FAR
from artigen.reader.looks import look_closer
from artigen.reader.model import Reader, load_reader
from artigen.reader.reading import Reading
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
    return assemble(things, chosen, kinds, sheet, image, reader, settings or ReadSettings())


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
        describe_front(fronts, index, door, sides, sheet)
        for index, (door, sides) in enumerate(zip(doors.tolist(), hinges, strict=True))
    ]
    for thing in (PULL, DIAL):
        found = things[thing]
        parts += [
            describe_part(found, int(index), thing, sheet)
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
        color=median_color(sheet.pixels, whole, fronts.box),
        extent=image.size,
    )


def _find(image: "Image.Image", reader: Reader) -> tuple[Sheet, list[Found]]:
    """The picture in a square, and the things in it, averaged with those of its mirror image."""
    sheet = _place(image)
    pixels = torch.from_numpy(sheet.pixels).permute(2, 0, 1)[None]
    with native_autocast(pixels.device):
        both = reader.network(pixels), reader.network(pixels.flip(3))
    return sheet, find_things(average_maps(both[0], mirror_maps(both[1])))[0]


def _name_kinds(
    objects: Found, chosen: int, image: "Image.Image", sheet: Sheet, reader: Reader
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


def _cut(image: "Image.Image", sheet: Sheet, box: Float[np.ndarray, "4"]) -> UInt8[np.ndarray, "E E 3"]:
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


def _place(image: "Image.Image") -> Sheet:
    """The picture over white, scaled into a square."""
    from PIL import Image as PillowImage

    scale = EDGE / max(image.size)
    extent = (max(8, round(image.width * scale)), max(8, round(image.height * scale)))
    small = image.resize(extent, PillowImage.Resampling.BOX if scale < 1 else PillowImage.Resampling.BILINEAR)
    origin = ((EDGE - extent[0]) // 2, (EDGE - extent[1]) // 2)
    square = PillowImage.new("RGB", (EDGE, EDGE), (PAD, PAD, PAD))
    square.paste(small.convert("RGB"), origin, small.getchannel("A"))
    return Sheet(
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
