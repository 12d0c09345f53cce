"""Candidate hulls of a part: boxes from coarse to fine, convex pieces and their unions."""

import numpy as np
from jaxtyping import Bool

from sim_export.collision.convex_pieces import Solid, cut_pieces, join_steps
from sim_export.collision.cuboids import CuboidFit, largest_cuboids
from sim_export.collision.hull_limits import MAX_ASPECT, comply_hull, thicken_hull, tile_hull
from sim_export.collision.hull_offers import Ground, PooledHull
from sim_export.collision.hulls import box_hull, hull_length
from sim_export.errors import DegeneratePart
from sim_export.geometry.solids import as_solid, measure_fit, solid_hull, unite_hulls
from sim_export.package import Hull

DETAILS = (1e-2, 3e-3, 1e-3, 2e-4)
"""Least share of the surface that a plane must hold to bound boxes."""
EXACT = 0.01
"""Volume error below which finer boxes are not looked for."""
MOST_BOXES = 96
"""Largest boxes of each detail."""
MOST_JOINED = 64
"""Largest boxes that joining starts from."""
MOST_REST = 32
"""Largest boxes of what no other hull holds."""
MOST_ADDED = 0.1
"""Share of the solid's volume that joining two hulls may add."""
MANY_TILES = 8
"""Hulls that an oblong one may count as, to be offered as thin as it is."""
TILES = (1, 2, 4)
"""Oblong hulls are also offered thicker, so that they count as so many hulls."""


def box_offers(solid: Solid, cuboids: CuboidFit) -> list[PooledHull]:
    """Boxes between the planes of a solid, and what they join to; none where it is not axis-aligned."""
    hulls: list[Hull] = []
    boxes: list[Hull] = []
    before = np.zeros((0, 2, 3))
    for detail in DETAILS:
        found = cuboids.take(MOST_BOXES, detail)
        if found is None or np.array_equal(found, before):
            continue
        before = found
        boxes = [box_hull(low, high) for low, high in found]
        hulls += boxes
        if detail != DETAILS[-1] and measure_fit(unite_hulls(boxes), solid).volume_error < EXACT:
            break
    solids = [as_solid(box) for box in boxes[:MOST_JOINED]]
    volumes = [box.volume() for box in solids]
    hulls += _hulls(join_steps(solids, volumes, MOST_ADDED * solid.volume(), overlap=True))
    return _offer(hulls)


def piece_offers(solid: Solid, max_pieces: int) -> list[PooledHull]:
    """Convex pieces of a solid, what they join to, and one hull of all."""
    leaves = cut_pieces(solid, max_pieces)
    pieces = [leaf.hull() for leaf in leaves]
    volumes = [leaf.volume() for leaf in leaves]
    joined = join_steps(pieces, volumes, MOST_ADDED * solid.volume(), overlap=False)
    return _offer(_hulls([*pieces, *joined, solid.hull()]))


def rest_offers(ground: Ground, rest: Bool[np.ndarray, "X Y Z"], volume: float) -> list[PooledHull]:
    """Boxes of those cells of a ground that no other hull holds, and what they join to."""
    found = largest_cuboids(rest, MOST_REST, ground.edges)
    boxes = [
        box_hull(*(np.array([ground.edges[axis][box[end, axis]] for axis in range(3)]) for end in range(2)))
        for box in found
    ]
    solids = [as_solid(box) for box in boxes]
    joined = join_steps(solids, [box.volume() for box in solids], MOST_ADDED * volume, overlap=False)
    return _offer([*boxes, *_hulls(joined)])


def _hulls(solids: list[Solid]) -> list[Hull]:
    out = []
    for solid in solids:
        try:
            out.append(solid_hull(solid))
        except DegeneratePart:
            continue
    return out


def _offer(hulls: list[Hull]) -> list[PooledHull]:
    """The hulls made to comply, each once, and oblong ones in several thicknesses."""
    seen: set[bytes] = set()
    out = []
    for hull in hulls:
        key = np.round(np.sort(hull.vertices, axis=0), 5).tobytes()
        if key in seen:
            continue
        seen.add(key)
        proper = comply_hull(hull)
        tiles = tile_hull(proper, MANY_TILES)
        choices = [(proper, tiles)]
        for fewer in TILES:
            if not tiles or fewer < len(tiles):
                width = 1.001 * hull_length(proper)[0] / (MAX_ASPECT * fewer)
                thick = comply_hull(thicken_hull(proper, width))
                choices.append((thick, tile_hull(thick, MANY_TILES)))
        out += [PooledHull(hull=whole, tiles=tiles) for whole, tiles in choices if tiles]
    return out
