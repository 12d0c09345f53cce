"""The units of a kitchen's wall are found by heights that kitchens have, at any scale of the picture."""

import numpy as np
import pytest

from artigen.camera import Camera, look_at, project_points
from artigen.reader.layout.plane import fit_plane
from artigen.reader.reading import ReadPart
from artigen.reader.wall import columns
from artigen.reader.wall.columns import CHAINED, OVER, Column, make_stacks
from artigen.reader.wall.face import FOCAL, TURN, choose_wall, find_aspect, list_corners
from artigen.reader.wall.roles import HUNG, Metre, find_roles
from artigen.reader.wall.units import JOINED, UNEVEN, WIDEST, group_columns

WALL = (
    ("base cabinet", "StorageFurniture", (0.0, 0.8), (0.1, 0.84)),
    ("dishwasher", "Dishwasher", (0.8, 1.4), (0.1, 0.82)),
    ("base cabinet", "StorageFurniture", (1.4, 2.0), (0.1, 0.84)),
    ("fridge", "Refrigerator", (2.0, 2.7), (0.1, 1.7)),
    (HUNG, "StorageFurniture", (0.0, 0.8), (1.45, 2.15)),
    (HUNG, "StorageFurniture", (2.0, 2.7), (1.75, 2.15)),
)
"""What is along a wall: role, kind, from left to right and from the floor up (m)."""


def make_front(corners: np.ndarray, material: str = "lacquer") -> ReadPart:
    box = np.concatenate([corners.min(axis=0), corners.max(axis=0)])
    return ReadPart(label="door", score=1.0, box=box, corners=corners, material=material)


def make_column(kind: str, x: tuple, z: tuple, scale: float, shift: np.ndarray) -> Column:
    bounds = scale * np.array([x[0], -z[1], x[1], -z[0]]) + np.tile(shift, 2)
    front = make_front(bounds[[0, 1, 2, 1, 2, 3, 0, 3]].reshape(4, 2))
    return Column(parts=(front,), bounds=bounds, shares={name: float(name == kind) for name in KINDS})


KINDS = ("StorageFurniture", "Refrigerator", "Oven", "Dishwasher", "WashingMachine")


@pytest.mark.parametrize(("scale", "shift"), [(1.0, (0.0, 0.0)), (0.13, (0.4, 0.7)), (7.0, (-3.0, 2.0))])
def test_roles_and_metres_follow_from_heights_at_any_scale(scale: float, shift: tuple[float, float]):
    stacks = [[[make_column(kind, x, z, scale, np.array(shift))]] for _, kind, x, z in WALL]
    metre, columns, roles = find_roles(stacks, 1.0)
    order = sorted(range(len(WALL)), key=lambda index: WALL[index][2][0])
    assert roles == [WALL[index][0] for index in order]
    tops = [metre.height(float(column.bounds[1])) for column in columns]
    np.testing.assert_allclose(tops, [WALL[index][3][1] for index in order], atol=0.08)


def test_a_cabinet_over_a_refrigerator_is_cut_from_it():
    one, none = 1.0, np.zeros(2)
    upper, lower = (make_column(WALL[k][1], *WALL[k][2:], one, none) for k in (5, 3))
    whole = Column(
        parts=(*upper.parts, *lower.parts),
        bounds=np.concatenate([upper.bounds[:2], lower.bounds[2:]]),
        shares=lower.shares,
    )
    base = make_column(WALL[0][1], *WALL[0][2:], one, none)
    assert find_roles([[[base]], [[whole], [upper, lower]]], 1.0)[2] == ["base cabinet", HUNG, "fridge"]


def test_what_has_no_height_of_a_kitchen_is_nothing():
    odd = make_column("StorageFurniture", (3.0, 3.2), (0.9, 1.3), 1.0, np.zeros(2))
    stacks = [[[make_column(kind, x, z, 1.0, np.zeros(2))]] for _, kind, x, z in WALL]
    assert find_roles([*stacks, [[odd]]], 1.0)[2][-1] is None


def photograph(camera: Camera, rectangles: np.ndarray) -> tuple[ReadPart, ...]:
    """Fronts with corners from the upper left clockwise, seen by a camera."""
    return tuple(
        make_front(project_points(camera, corners)[:, :2] / (camera.width, camera.height))
        for corners in rectangles
    )


def wall_fronts(along: np.ndarray, origin: np.ndarray, count: int = 4) -> np.ndarray:
    """Fronts of 0.5 x 0.7 m side by side along a direction."""
    up = np.array([0.0, 0.0, 0.7])
    starts = [origin + 0.52 * k * along for k in range(count)]
    return np.stack([[s + up, s + 0.5 * along + up, s + 0.5 * along, s] for s in starts])


@pytest.mark.parametrize("turn", [-0.3, 0.0, 0.4])
def test_fronts_of_another_wall_are_left_out_and_the_aspect_is_true(turn: float):
    fov = float(np.degrees(2 * np.arctan(0.5 * 480 / (FOCAL * 640))))
    eye = np.array([-2.6 * np.cos(turn), 2.6 * np.sin(turn), 1.2])
    camera = look_at(eye, np.array([0.0, 0.0, 0.7]), fov=fov, width=640, height=480)
    front = photograph(camera, wall_fronts(np.array([0.0, -1.0, 0.0]), np.array([0.0, 1.04, 0.1])))
    side = photograph(camera, wall_fronts(np.array([1.0, 0.0, 0.0]), np.array([-1.1, 1.1, 0.1]), 2))
    extent = np.array([640.0, 480.0])
    kept, others = choose_wall((*front, *side), extent)
    assert [id(part) for part in kept] == [id(part) for part in front]
    assert others == len(side)
    plane = fit_plane(list_corners(kept) * extent, extent)
    sizes = np.median(np.diff(plane.bound(list_corners(kept)).reshape(-1, 2, 2), axis=1)[:, 0], axis=0)
    assert find_aspect(plane, extent) * sizes[0] / sizes[1] == pytest.approx(0.5 / 0.7, rel=0.1)


@pytest.mark.parametrize(("more", "kept"), [(0.95, 4), (1.05, 3)])
def test_boundary_of_another_wall(more: float, kept: int):
    """A front that is higher at its right end, beside larger ones that are not."""
    tall = 0.1 * np.exp(more * TURN * 0.2)
    quads = [np.array([(x, 0.2), (x + 0.2, 0.2), (x + 0.2, 0.6), (x, 0.6)]) for x in (0.0, 0.22, 0.44)]
    quads.append(np.array([(0.7, 0.4), (0.9, 0.4), (0.9, 0.4 + tall), (0.7, 0.5)]))
    assert len(choose_wall([make_front(quad) for quad in quads], np.array([500.0, 500.0]))[0]) == kept


@pytest.mark.parametrize(
    ("gap", "aside", "stacks"),
    [
        (0.95 * CHAINED, 0.0, 1),
        (1.05 * CHAINED, 0.0, 2),
        (0.1, 0.95 * (1 - OVER), 1),
        (0.1, 1.05 * (1 - OVER), 2),
    ],
)
def test_fronts_above_each_other_are_one_stack(
    monkeypatch: pytest.MonkeyPatch, gap: float, aside: float, stacks: int
):
    """Gap and shift in heights and widths of the fronts."""
    monkeypatch.setattr(columns, "_name_kinds", lambda image, box, reader: {})
    starts = np.array([(0.3, 0.1), (0.3 + 0.2 * aside, 0.1 + 0.2 * (1 + gap))])
    quads = [start + 0.2 * np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) for start in starts]
    fronts = [make_front(quad) for quad in quads]
    extent = np.array([500.0, 500.0])
    plane = fit_plane(list_corners(fronts) * extent, extent)
    assert len(make_stacks(fronts, plane, None, None)) == stacks  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize("more", [0.95, 1.05])
@pytest.mark.parametrize(
    ("role", "gap", "width", "lift"),
    [
        ("base cabinet", JOINED, 0.0, 0.0),
        ("base cabinet", 0.0, WIDEST, 0.0),
        (HUNG, 0.0, 0.0, UNEVEN),
        ("dishwasher", 0.0, 0.0, 0.0),
    ],
)
def test_neighbouring_cabinets_are_one_unit(role: str, gap: float, width: float, lift: float, more: float):
    """Up to a gap, a common width and, where they hang, an unevenness; appliances never are."""
    wide = more * width / 2 or 0.4
    second = wide + more * gap
    lifted = more * lift
    pair = [
        make_column("StorageFurniture", x, z, 1.0, np.zeros(2))
        for x, z in (((0.0, wide), (0.1, 0.8)), ((second, second + wide), (0.1 + lifted, 0.8 + lifted)))
    ]
    units = group_columns(pair, [role, role], Metre(across=1.0, along=1.0, floor=0.0))
    assert len(units) == (2 if more > 1 or role == "dishwasher" else 1)
