"""A picture with marks, and the maps of a network that knows them."""

import numpy as np
import torch

from artigen.reader.labels import FRONT, HINGES, OBJECT, PULL, THINGS
from artigen.reader.network import ATTRIBUTES, STRIDE, Maps
from artigen.reader.targets import MARK, Picture, ReaderBatch, make_mark

SIZE = 128


def make_picture(marks: list[np.ndarray]) -> Picture:
    edge = SIZE // STRIDE
    return Picture(
        pixels=np.zeros((SIZE, SIZE, 3), np.uint8),
        marks=np.array(marks, MARK).reshape(-1),
        weight=np.ones((len(THINGS), edge, edge), np.float32),
    )


def kitchen() -> Picture:
    """Two doors, a drawer above, their pulls, and the cabinet."""
    left = make_mark(FRONT, np.array([20, 50, 60, 110]), door=1, hinge=HINGES.index("left"), open=0, pane=1)
    left["corners"] = [[20, 52], [60, 50], [58, 110], [22, 108]]
    right = make_mark(
        FRONT, np.array([62, 50, 102, 110]), door=1, hinge=HINGES.index("right"), open=1, pane=0
    )
    drawer = make_mark(FRONT, np.array([20, 30, 102, 48]), door=0)
    pulls = [make_mark(PULL, np.array(box)) for box in ([52, 70, 56, 90], [66, 70, 70, 90], [55, 37, 70, 41])]
    body = make_mark(
        OBJECT, np.array([16, 24, 106, 116]), kind=7, stand=1, view=(0.3, 0.1, 0.4), size=(1, 0.5, 0.9)
    )
    return make_picture([left, right, drawer, *pulls, body])


def to_maps(batch: ReaderBatch) -> Maps:
    """The maps of a network that knows the targets."""
    edge = SIZE // STRIDE
    said = {name: torch.zeros(1, channels, edge, edge) for name, channels in ATTRIBUTES.items()}
    _, thing, row, column = batch.place.unbind(1)
    for index in range(len(thing)):
        y, x = row[index], column[index]
        said["box"].unflatten(1, (len(THINGS), 4))[0, thing[index], :, y, x] = (
            batch.box[index].clamp(min=0.5).log()
        )
        if thing[index] == FRONT:
            if torch.isfinite(batch.corners[index]).all():
                said["corners"][0, :, y, x] = batch.corners[index]
            for name in ("door", "open", "pane"):
                said[name][0, 0, y, x] = 8.0 * (2 * getattr(batch, name)[index].clamp(min=0) - 1)
            if batch.hinge[index] >= 0:
                said["hinge"][0, batch.hinge[index], y, x] = 8.0
        if thing[index] == OBJECT:
            said["kind"][0, batch.kind[index], y, x] = 8.0
            said["view"][0, :, y, x] = batch.view[index]
    heat = torch.where(batch.heat == 1, 6.0, -9.0)
    return Maps(heat=heat, attributes=said)
