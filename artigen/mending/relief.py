"""Faces are flat but for rectangles: a stage of its own for steps and stains of a cell or two.

Seen from outside, the front of a door or the side of a body lies at one depth, with frames, recesses and
trims that are rectangles or round. A network also draws stairs and stains: a piece of the face a cell deeper
or higher, of any outline. Such pieces come to the depth of the face. Tops carry burners and grates, which
stay. What lies deeper still in the top, the sides or the back of a body, and is no figure, is a hole, and
is closed.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_dilation, binary_fill_holes, find_objects, label

from artigen.fields import DEFAULT_LAYOUT, FieldLayout, name_rows
from artigen.mending.fronts import draw_ellipse
from artigen.mending.rows import Owners

FACES = {
    "door": ((0, 1),),
    "drawer": ((0, 1),),
    "base": ((1, 1), (1, -1), (0, -1)),
}
"""Axes along which parts are looked at, and from which end: fronts face -x, a body shows its sides and its
back."""
CLOSED = ((2, -1), *FACES["base"])
"""How those sides of a body are looked at that hold no parts: the top, the sides and the back."""
MAIN = 0.4
"""Share of a face that lies at one depth, at least, for it to be flat there."""
STEP = 2
"""Cells that a piece of a face lies deeper or higher, at most."""
SHEET = 2
"""Cells that a closed hole is thick."""
REGULAR = 0.85
"""Share of its rectangle, or intersection over union with its ellipse, from which a piece is meant, with its
holes."""
OPEN = 0.9
"""The same of a hole in a body."""
ENCLOSED = 0.45
"""Share of the cells around a hole that are face: beside a round table, one sees its feet."""


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
        for axis, end in CLOSED if name == "base" else ():
            _close(np.moveaxis(owners, axis, 0)[::end], number)
    changed = int((owners != before).sum())
    if not changed:
        return before, ()
    return owners, (f"{changed} cells of steps and stains on faces were evened out",)


def _flatten(face: Owners, number: int) -> None:
    """Evens out a face in place, seen along the first axis."""
    mine = face == number
    seen, depths, main = _measure_depths(mine)
    if main is None:
        return
    for step in (*range(-STEP, 0), *range(1, STEP + 1)):
        for piece in _find_pieces(seen & (depths == main + step), REGULAR):
            x, y = np.nonzero(piece)
            if step > 0:
                layers = slice(main, main + step)
                free = face[layers, x, y] < 0
                face[layers, x, y] = np.where(free, number, face[layers, x, y])
            else:
                above = mine[main + step : main, x, y]
                face[main + step : main, x, y] = np.where(above, -1, face[main + step : main, x, y])


def _close(face: Owners, number: int) -> None:
    """Closes the holes of a face in place, seen along the first axis."""
    seen, depths, main = _measure_depths(face == number)
    if main is None:
        return
    for piece in _find_pieces((seen & (depths > main)) | (binary_fill_holes(seen) & ~seen), OPEN):
        around = binary_dilation(piece) & ~piece
        if (around & seen & (depths == main)).sum() < ENCLOSED * around.sum():
            continue
        x, y = np.nonzero(piece)
        layers = slice(main, main + SHEET)
        face[layers, x, y] = np.where(face[layers, x, y] < 0, number, face[layers, x, y])


def _measure_depths(
    mine: Bool[np.ndarray, "D H W"],
) -> tuple[Bool[np.ndarray, "H W"], Int[np.ndarray, "H W"], int | None]:
    """Where a part is seen along the first axis, how deep it lies there, and most of it, if any."""
    seen = np.asarray(mine.any(axis=0))
    depths = np.where(seen, mine.argmax(axis=0), -1)
    main = int(np.bincount(depths[seen]).argmax()) if seen.any() else None
    if main is not None and (depths[seen] == main).mean() < MAIN:
        main = None
    return seen, depths, main


def _find_pieces(cells: Bool[np.ndarray, "H W"], regular: float) -> Iterator[Bool[np.ndarray, "H W"]]:
    """The connected pieces that are neither rectangles nor ellipses."""
    pieces: Int[np.ndarray, "H W"] = np.zeros(cells.shape, dtype=np.int64)
    label(cells, output=pieces)
    for index, place in enumerate(find_objects(pieces), start=1):
        inside = np.asarray(binary_fill_holes(pieces[place] == index))
        disc = draw_ellipse(*inside.shape)
        if inside.mean() < regular and (inside & disc).sum() < regular * (inside | disc).sum():
            yield pieces == index
