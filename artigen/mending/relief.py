"""Faces are flat but for rectangles: a stage of its own for steps and stains of a cell or two.

Seen from outside, the front of a door or the side of a body lies at one depth, with frames, recesses and
trims that are rectangles or round. A network also draws stairs and stains: a piece of the face a cell deeper
or higher, of any outline. Such pieces come to the depth of the face.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_fill_holes, find_objects, label

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, name_rows
from artigen.mending.fronts import draw_ellipse
from artigen.mending.rows import Owners

FACES = {
    "door": ((0, 1),),
    "drawer": ((0, 1),),
    "base": ((1, 1), (1, -1), (0, -1)),
}
"""Axes along which parts are looked at, and from which end: fronts face -x, a body shows its sides and its
back. Its top carries burners and grates."""
MAIN = 0.4
"""Share of a face that lies at one depth, at least, for it to be flat there."""
STEP = 2
"""Cells that a piece of a face lies deeper or higher, at most."""
REGULAR = 0.85
"""Share of its rectangle, or intersection over union with its ellipse, from which a piece is meant, with its
holes."""


def flatten_faces(
    owners: Owners, rows: Float[np.ndarray, "N C"], layout: FieldLayout = DEFAULT_LAYOUT
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which faces have no steps and stains, and a note of how many cells changed.

    Args:
        owners: a row per cell, -1 where nothing is.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    before, owners = owners, owners.copy()
    for number, name in enumerate(name_rows(rows, layout)):
        for axis, end in FACES.get(name, ()):
            face = np.moveaxis(owners, axis, 0)[::end]  # a view: the first layer is the nearest
            _flatten(face, number)
    changed = int((owners != before).sum())
    if not changed:
        return before, ()
    return owners, (f"{changed} cells of steps and stains on faces were evened out",)


def _flatten(face: Owners, number: int) -> None:
    """Evens out a face in place, seen along the first axis."""
    mine = face == number
    seen = mine.any(axis=0)
    if not seen.any():
        return
    depths = np.where(seen, mine.argmax(axis=0), -1)
    main = int(np.bincount(depths[seen]).argmax())
    if (depths[seen] == main).mean() < MAIN:
        return
    for step in (*range(-STEP, 0), *range(1, STEP + 1)):
        for piece in _find_pieces(seen & (depths == main + step)):
            x, y = np.nonzero(piece)
            if step > 0:
                layers = slice(main, main + step)
                free = face[layers, x, y] < 0
                face[layers, x, y] = np.where(free, number, face[layers, x, y])
            else:
                above = mine[main + step : main, x, y]
                face[main + step : main, x, y] = np.where(above, -1, face[main + step : main, x, y])


def _find_pieces(cells: Bool[np.ndarray, "H W"]) -> Iterator[Bool[np.ndarray, "H W"]]:
    """The connected pieces that are no rectangles."""
    pieces: Int[np.ndarray, "H W"] = np.zeros(cells.shape, dtype=np.int64)
    label(cells, output=pieces)
    for index, place in enumerate(find_objects(pieces), start=1):
        inside = np.asarray(binary_fill_holes(pieces[place] == index))
        disc = draw_ellipse(*inside.shape)
        if inside.mean() < REGULAR and (inside & disc).sum() < REGULAR * (inside | disc).sum():
            yield pieces == index
