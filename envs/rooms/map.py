"""Map of the free cells of a room in which a robot can stand and drive."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from .room import ROBOT_HEIGHT, Room, along_wall
from .solids import Solid, fixture_solids, object_solids, standing_solids

Point = Sequence[float] | Float[np.ndarray, "2"]
STEP = 0.01
"""Height (m) of what a robot drives over, such as a rug."""
CELL = 0.05
"""Edge of a cell (m)."""


def free_map(room: Room, solids: Sequence[Solid]) -> Bool[np.ndarray, "X Y"]:
    """Cells (x, y) of ``CELL`` metres on whose centre a robot of the room's radius can stand."""
    shape = np.ceil(np.array(room.size[:2]) / CELL).astype(int)
    taken = np.zeros(shape + 2, dtype=bool)  # one ring of cells for the walls
    taken[[0, -1]], taken[:, [0, -1]] = True, True
    for low, high in np.concatenate([solid.boxes for solid in solids]):
        if low[2] < ROBOT_HEIGHT and high[2] > STEP:
            first = np.floor(low[:2] / CELL).astype(int) + 1
            last = np.ceil(high[:2] / CELL).astype(int) + 1
            (x0, y0), (x1, y1) = np.maximum(first, 0), np.maximum(last, 0)
            taken[x0:x1, y0:y1] = True
    distance = np.asarray(ndimage.distance_transform_edt(~taken)) * CELL
    return (distance - CELL / 2 > room.standing_radius)[1:-1, 1:-1]


def label_regions(free: Bool[np.ndarray, "X Y"]) -> Int[np.ndarray, "X Y"]:
    """Connected regions of free cells, over edges and corners, labelled from 1; 0 for occupied cells."""
    labels = np.zeros(free.shape, dtype=np.int32)
    ndimage.label(free, structure=np.ones((3, 3)), output=labels)
    return labels


def entrance_point(room: Room) -> Float[np.ndarray, "2"]:
    """The middle of the entrance, a robot's radius into the room."""
    middle = room.entrance.start + room.entrance.width / 2.0
    out = max(room.standing_radius, 0.3) + 2 * CELL
    box = along_wall(room.entrance.side, room.size, (middle, out, 0.0), (middle, out, 0.0))
    return box[0, :2]


def reachable_map(room: Room, solids: Sequence[Solid]) -> Bool[np.ndarray, "X Y"]:
    """Free cells connected with the one nearest to the entrance."""
    regions = label_regions(free_map(room, solids))
    free = np.argwhere(regions > 0)
    if not len(free):
        return np.zeros(regions.shape, dtype=bool)
    x, y = free[int(np.argmin(_distances(free, entrance_point(room))))]
    return regions == regions[x, y]


def way_to(reach: Bool[np.ndarray, "X Y"], point: Point) -> float:
    """Distance (m) from a point to the nearest reachable cell."""
    return float(_distances(np.argwhere(reach), point).min())


def find_path(reach: Bool[np.ndarray, "X Y"], start: Point, goal: Point) -> Float[np.ndarray, "N 2"]:
    """Middles of the cells on the shortest way over reachable cells, between those nearest to two points;
    steps beside cells that are not reachable count three times."""
    cells = np.argwhere(reach)
    number = np.full(np.add(reach.shape, 2), -1)
    number[1:-1, 1:-1][reach] = np.arange(len(cells))
    cost = np.where(ndimage.binary_erosion(reach, np.ones((3, 3))), 1.0, 3.0)[reach]
    rows, columns, weights = [], [], []
    for step in ((1, 0), (0, 1), (1, 1), (1, -1)):
        beside = number[cells[:, 0] + 1 + step[0], cells[:, 1] + 1 + step[1]]
        known = np.flatnonzero(beside >= 0)
        rows.append(known)
        columns.append(beside[known])
        weights.append(np.hypot(*step) * (cost[known] + cost[beside[known]]) / 2.0)
    edges = np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))
    graph = sparse.coo_matrix(edges, shape=(len(cells), len(cells)))
    first, last = (int(np.argmin(_distances(cells, point))) for point in (start, goal))
    _, before = csgraph.dijkstra(graph.tocsr(), directed=False, indices=last, return_predecessors=True)
    way = [first]
    while way[-1] != last and before[way[-1]] >= 0:
        way.append(int(before[way[-1]]))
    return (cells[way] + 0.5) * CELL


def _distances(cells: Int[np.ndarray, "N 2"], point: Point) -> Float[np.ndarray, "N"]:
    """Distances (m) of the centres of cells from a point."""
    return np.linalg.norm((cells + 0.5) * CELL - np.asarray(point), axis=1)


def drive_map(room: Room) -> Bool[np.ndarray, "X Y"]:
    """Cells that a robot reaches from the entrance with all joints as they are in the room."""
    return reachable_map(room, object_solids(room) + fixture_solids(room) + standing_solids(room))


def start_place(room: Room) -> tuple[float, float]:
    """Start of a robot: the reachable cell nearest to the entrance.

    Raises:
        ValueError: If there is none.
    """
    cells = np.argwhere(drive_map(room))
    if not len(cells):
        raise ValueError(f"no free place for a robot in the {room.kind}")
    x, y = cells[int(np.argmin(_distances(cells, entrance_point(room))))]
    return float((x + 0.5) * CELL), float((y + 0.5) * CELL)
