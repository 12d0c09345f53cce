"""What the networks found in a picture to a `Reading`."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float, UInt8

from artigen.reader.choice import choose_fronts
from artigen.reader.decode import Found
from artigen.reader.edges import snap_boxes
from artigen.reader.hinges import average_shares, weigh_hinges
from artigen.reader.labels import DIAL, FRONT, HINGES, MATERIALS, OBJECT, PULL, SHELF, STANDS, WHEEL
from artigen.reader.layout.frontal import LONG
from artigen.reader.model import Reader
from artigen.reader.reading import Label, Reading, ReadPart

if TYPE_CHECKING:
    from PIL import Image

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
class Sheet:
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


def assemble(
    things: Sequence[Found],
    chosen: int,
    kinds: list[tuple[str, float]],
    sheet: Sheet,
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
        parts.append(describe_front(fronts, index, door, sides, sheet))
        box = fronts.box[index]
        own = np.concatenate([np.minimum(own[:2], box[:2]), np.maximum(own[2:], box[2:])])
    for thing in (PULL, DIAL, SHELF, WHEEL):
        found = things[thing]
        kept = np.flatnonzero((found.score > LEAST[thing]) & _is_within(found.box, own))
        parts += [describe_part(found, int(index), thing, sheet) for index in kept]
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
        color=median_color(sheet.pixels, own, things[FRONT].box),
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


def describe_part(found: Found, index: int, thing: int, sheet: Sheet) -> ReadPart:
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
        color=median_color(sheet.pixels, box),
    )


def describe_front(
    found: Found,
    index: int,
    door: bool,  # noqa: FBT001
    sides: Float[np.ndarray, "4"],
    sheet: Sheet,
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
        color=median_color(sheet.pixels, found.box[index]),
    )


def _to_box(box: Float[np.ndarray, "4"], sheet: Sheet) -> Float[np.ndarray, "4"]:
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


def median_color(
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
