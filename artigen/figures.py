"""What is painted on a face is a figure: windows, trims and displays are rectangles, or discs on round doors.

A network that guesses voxel by voxel paints blobs, with frayed borders and islands. Every face is told anew
as its background and the figures that its voxels speak for most (`artigen.mending.boxes`): what is missing in
one is filled, and what lies in none goes.
"""

from functools import partial

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_fill_holes, find_objects, label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from artigen.facings import mark_voxels
from artigen.mending.boxes import Box, fill_boxes, find_boxes

LEAST, SHARE = 4.0, 0.02
"""Certain voxels in a figure that no other holds, and their share of the face: at least both."""
ROUNDS = 2
"""How often classes take turns: the first may take too much of what is another's."""
CENTRED, SMALL = 0.15, 0.05
"""Shares of a face: that a figure is off its middle across, at most; that one has which may be anywhere."""
WHOLE, STRIP = 0.5, 0.3
"""Shares of the edges of a face: that a strip is long, at least, and that it is wide, at most."""
MERGED = 0.5
"""Share of the evidence for two rectangles that meet which one around both must hold to replace them."""
ROUND = 8
"""Cells across a face, at least, for it to be round."""


def find_edges(
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    resolution: int,
) -> Int[np.ndarray, "E 2"]:
    """Pairs of voxels that share a face, a part, and the direction of their outer sides.

    Args:
        coords: Cells (x, y, z) of the grid, each at most once.
        part_ids: Part of each.
        facings: Directions of their outer sides (`artigen.facings`).
        resolution: Edge of the grid.
    """
    grid = np.pad(mark_voxels(coords, np.arange(len(coords)), resolution), (0, 1), constant_values=-1)
    pairs = []
    for axis in range(3):
        step = np.eye(3, dtype=np.int64)[axis]
        other = grid[tuple((coords.astype(np.int64) + step).T)]
        (one,) = np.nonzero(other >= 0)
        other = other[one]
        alike = (part_ids[one] == part_ids[other]) & (facings[one] == facings[other])
        pairs.append(np.stack([one[alike], other[alike]], axis=1))
    return np.concatenate(pairs)


def number_faces(count: int, edges: Int[np.ndarray, "E 2"]) -> Int[np.ndarray, "N"]:
    """The face of each voxel: what is connected by pairs of neighbours."""
    links = coo_array((np.ones(len(edges), dtype=bool), (edges[:, 0], edges[:, 1])), shape=(count, count))
    return connected_components(links, directed=False)[1]


def settle_figures(
    evidence: Float[np.ndarray, "N K"],
    coords: Int[np.ndarray, "N 3"],
    facings: Int[np.ndarray, "N"],
    faces: Int[np.ndarray, "N"],
    centred: Bool[np.ndarray, "N"],
) -> Int[np.ndarray, "N"]:
    """The class of every voxel, by which faces are painted in figures.

    Args:
        evidence: What each voxel says for every class, such as its chance.
        coords: Cells (x, y, z) of the grid.
        facings: Directions of their outer sides (`artigen.facings`).
        faces: Which face each belongs to (`number_faces`); it is looked at along the axis that it faces.
        centred: Whether figures of its face lie in the middle, but for small ones and strips.
    """
    order = np.argsort(faces, kind="stable")
    out = np.empty(len(coords), dtype=np.int64)
    for rows in np.split(order, np.flatnonzero(np.diff(faces[order])) + 1):
        across = np.delete(coords[rows].astype(np.int64), facings[rows[0]] // 2, axis=1)
        across -= across.min(axis=0)
        height, width = across.max(axis=0) + 1
        place = across @ [width, 1]
        number = np.bincount(place, minlength=height * width)
        total = [np.bincount(place, weights=one, minlength=height * width) for one in evidence[rows].T]
        mean = (np.stack(total) / np.maximum(number, 1)).reshape(-1, height, width)
        drawn = draw_figures(mean, (number > 0).reshape(height, width), centred=bool(centred[rows[0]]))
        out[rows] = drawn[tuple(across.T)]
    return out


def draw_figures(
    evidence: Float[np.ndarray, "K H W"], face: Bool[np.ndarray, "H W"], *, centred: bool = False
) -> Int[np.ndarray, "H W"]:
    """Classes of the cells of a face: one is the background, the others come in figures.

    Args:
        evidence: For every class, anything beside the face.
        face: The cells that are there.
        centred: Whether rectangles lie in the middle, but for small ones and strips.
    """
    mass = np.where(face, evidence, 0.0).sum(axis=(1, 2))
    drawn = np.full(face.shape, mass.argmax())
    least = max(LEAST, SHARE * int(face.sum()))
    if (mass >= least).sum() < 2:
        return drawn
    find = _find_discs if is_round(face) else partial(find_rectangles, centred=centred)
    for _ in range(ROUNDS):
        for number in np.argsort(-mass, kind="stable"):
            if mass[number] < least:
                break
            rival = np.take_along_axis(evidence, drawn[None], axis=0)[0]
            drawn[find(np.where(face, evidence[number] - rival, 0.0), least)] = number
    return drawn


def is_round(face: Bool[np.ndarray, "H W"]) -> bool:
    """Whether an ellipse says more of the outline of a face than a rectangle does."""
    whole, disc = np.asarray(binary_fill_holes(face)), draw_ellipse(*face.shape)
    alike = (whole & disc).sum() / (whole | disc).sum()
    return min(face.shape) >= ROUND and alike > whole.mean()


def draw_ellipse(height: int, width: int) -> Bool[np.ndarray, "H W"]:
    """The cells of a rectangle whose middles lie in its ellipse."""
    y, z = (np.linspace(-1, 1, 2 * count + 1)[1::2] for count in (height, width))
    return y[:, None] ** 2 + z[None] ** 2 <= 1.0


def find_rectangles(
    evidence: Float[np.ndarray, "H W"], least: float, *, centred: bool = False
) -> Bool[np.ndarray, "H W"]:
    """The cells of the rectangles that hold enough evidence, only of those that may lie there if `centred`.

    Args:
        evidence: Above 0 for cells that belong to a rectangle, below 0 for others.
        least: Sum over a rectangle for it to be one.
        centred: Whether rectangles lie in the middle, but for small ones and strips.
    """
    boxes = find_boxes(evidence[..., None], least)
    if centred:
        boxes = [box for box in _merge_boxes(boxes, evidence) if _is_meant(box, evidence.shape)]
    return fill_boxes((*evidence.shape, 1), boxes)[..., 0]


def _merge_boxes(boxes: list[Box], evidence: Float[np.ndarray, "H W"]) -> list[Box]:
    """One box around each that meets those before it, wherever it holds most of what they do: figures whose
    corners were bitten off."""
    merged: list[Box] = []
    for box in boxes:
        for number, other in enumerate(merged):
            sides = list(zip(box, other, strict=True))
            if any(max(a.start, b.start) > min(a.stop, b.stop) for a, b in sides):
                continue
            x, y, z = (slice(min(a.start, b.start), max(a.stop, b.stop)) for a, b in sides)
            both = fill_boxes((*evidence.shape, 1), [box, other])[..., 0]
            if evidence[x, y].sum() >= MERGED * evidence[both].sum():
                merged[number] = x, y, z
                break
        else:
            merged.append(box)
    return merged


def _is_meant(box: Box, face: tuple[int, ...]) -> bool:
    """Whether a rectangle lies in the middle across a face, is a strip, or is small."""
    across, up, _ = box
    sizes = np.array([across.stop - across.start, up.stop - up.start]) / face
    off = abs(across.start + across.stop - face[0]) / (2.0 * face[0])
    strip = (sizes[::-1] >= WHOLE) & (sizes <= STRIP)
    return bool(off <= CENTRED or sizes.prod() <= SMALL or strip.any())


def _find_discs(evidence: Float[np.ndarray, "H W"], least: float) -> Bool[np.ndarray, "H W"]:
    """The ellipses within the extents of connected cells that speak for a class, and hold enough evidence."""
    pieces: Int[np.ndarray, "H W"] = np.zeros(evidence.shape, dtype=np.int64)
    label(evidence > 0, output=pieces)
    out = np.zeros(evidence.shape, dtype=bool)
    for place in find_objects(pieces):
        disc = draw_ellipse(*(side.stop - side.start for side in place))
        if evidence[place][disc].sum() >= least:
            out[place] |= disc
    return out
