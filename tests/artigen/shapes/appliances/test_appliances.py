"""Laws of procedural appliances: they hang together, stand, and open without touching what they pass."""

from functools import cache

import numpy as np
import pytest
from shape_sweeps import find_overlaps, links_of, make_hulls

from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape
from sim_export.geometry.hulls import hull_length, hull_width

CATEGORIES = ("Refrigerator", "Dishwasher", "Oven", "WashingMachine", "Microwave")
SEEDS = range(10)
POSES = 5


@cache
def draw_some(category: str) -> list[Shape]:
    return [draw_shape(category, seed) for seed in SEEDS]


@pytest.fixture(scope="module", params=CATEGORIES)
def shapes(request: pytest.FixtureRequest) -> list[Shape]:
    return draw_some(request.param)


def test_every_joint_sweeps_its_range_without_touching_anything(shapes: list[Shape]) -> None:
    for shape in shapes:
        assert find_overlaps(shape, POSES) == [], shape.name
    assert sum(part.joint is not None for shape in shapes for part in shape.parts) > len(SEEDS)


def test_racks_of_a_dishwasher_slide_out_below_its_control_strip():
    """Also below a strip that is fixed to the housing, before the open front of the tub."""
    passed = 0
    for seed in range(60):
        shape = draw_shape("Dishwasher", seed)
        strips = [
            float(solid.center[2] - solid.size[2] / 2)
            for solid in shape.parts[0].primitives
            if solid.finish in ("panel", "front") and solid.size[1] > 0.3 and solid.center[2] > 0.3
        ]
        racks = [float(part.bounds()[1, 2]) for part in shape.parts if part.label == "tray"]
        assert all(rack < strip for rack in racks for strip in strips), seed
        passed += bool(racks) and bool(strips)
    assert passed > 10


def test_links_are_few_and_stout_enough_for_engines(shapes: list[Shape]) -> None:
    for shape in shapes:
        owners = links_of(shape)
        for link in set(owners):
            name = f"{shape.name}: {shape.parts[link].name}"
            hulls = make_hulls(shape, [part for part, owner in enumerate(owners) if owner == link]).hulls
            assert len(hulls) <= 32, name
            assert min(hull_width(hull)[0] for hull in hulls) >= 0.003 - 1e-9, name
            assert max(hull_length(hull)[0] / hull_width(hull)[0] for hull in hulls) < 60, name


def test_appliances_stand_on_the_floor_in_front_of_their_wall(shapes: list[Shape]) -> None:
    for shape in shapes:
        low, high = shape.bounds()
        points = np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])
        feet = points[np.abs(points[:, 2]) < 1e-6, :2]
        assert low[2] == pytest.approx(0.0, abs=1e-9)
        assert np.ptp(feet, axis=0).min() > 0.5 * (high - low)[:2].min(), f"{shape.name} stands unsafely"
        assert abs(low[1] + high[1]) < 0.02, f"{shape.name} is not centred"


def test_controls_and_handles_show_in_a_grid_of_64_cells(shapes: list[Shape]) -> None:
    for shape in shapes:
        edge = float(np.diff(shape.bounds(), axis=0).max())
        for part in shape.parts:
            if part.label in ("knob", "handle"):
                seen = np.sort(np.diff(part.bounds(), axis=0)[0])[1]
                assert seen >= 0.0149 * edge, f"{shape.name}: {part.name} is {seen} m, the edge {edge} m"


def test_a_tray_behind_a_door_says_that_the_door_must_be_open(shapes: list[Shape]) -> None:
    for shape in shapes:
        doors = {part.name for part in shape.parts if part.label == "door"}
        for part in shape.parts:
            slides = part.joint is not None and part.joint.type == "prismatic"
            if part.label == "tray" and slides:
                assert {need.part for need in part.needs} & doors, f"{shape.name}: {part.name} needs no door"


@pytest.mark.parametrize("category", CATEGORIES)
def test_wishes_are_met(category: str) -> None:
    for seed in range(4):
        shape = draw_shape(category, seed, Wish(width=0.6, style="white"))
        depth, width, height = np.diff(shape.bounds(), axis=0)[0]
        assert (shape.style, shape.condition.style) == ("white", "white")
        assert width == pytest.approx(0.6, abs=0.002)
        assert depth > 0.25
        assert height > 0.05


@pytest.mark.parametrize(
    ("category", "counts"),
    [
        ("Refrigerator", (("door", 2), ("handle", 2), ("shelf", 0))),
        ("Dishwasher", (("door", 1), ("tray", 2), ("handle", 1))),
        ("Dishwasher", (("drawer", 1), ("handle", 1))),
        ("Oven", (("door", 0), ("knob", 6))),
        ("Oven", (("door", 2), ("handle", 2))),
        ("WashingMachine", (("door", 1), ("knob", 7))),
        ("Microwave", (("knob", 2), ("tray", 1), ("handle", 0))),
    ],
)
def test_counts_that_real_objects_have_can_be_wished_for(category: str, counts: tuple) -> None:
    held = dict(draw_shape(category, 1, Wish(counts=counts)).condition.counts)
    assert {label: held.get(label, 0) for label, _ in counts} == dict(counts)


def test_joint_types_are_those_of_real_appliances() -> None:
    types = {
        category: {
            part.joint.type for shape in draw_some(category) for part in shape.parts if part.joint is not None
        }
        for category in CATEGORIES
    }
    assert types["Refrigerator"] == {"revolute", "prismatic"}
    assert types["Dishwasher"] >= {"revolute", "prismatic"}
    for category in ("Oven", "WashingMachine", "Microwave"):
        assert types[category] == {"revolute", "prismatic", "continuous"}


@pytest.mark.parametrize("category", ["Dishwasher", "Oven"])
def test_a_closed_base_reaches_the_floor_all_around_and_leaves_room_for_toes(category: str) -> None:
    based = 0
    for seed in range(24):
        body = draw_shape(category, seed).parts[0]
        low, high = body.bounds()
        boards = [solid for solid in body.primitives if place_vertices(solid)[:, 2].min() < low[2] + 1e-6]
        corners = np.concatenate([place_vertices(solid) for solid in boards])
        if len(boards) != 4 or any(solid.kind == "cylinder" for solid in boards):
            continue
        based += 1
        assert {solid.finish for solid in boards} == {"body"}
        assert np.abs(corners[:, 1]).max() == pytest.approx(high[1])
        assert corners[:, 0].max() == pytest.approx(high[0])
        assert corners[:, 0].min() > low[0] + 0.009
    assert 4 <= based <= 20


@pytest.mark.parametrize("seed", range(16))
def test_every_front_of_an_oven_has_a_handle_whether_bar_or_lip(seed: int):
    """What is seen and taken by hand is a part of its own, so that packages can annotate it."""
    shape = draw_shape("Oven", seed)
    fronts = {part.name for part in shape.parts if part.label in ("door", "drawer")}
    handles = [part for part in shape.parts if part.label == "handle"]
    assert {part.parent for part in handles} == fronts
    for part in handles:
        front = next(one for one in shape.parts if one.name == part.parent)
        assert part.bounds()[0][0] < front.bounds()[0][0] - 0.01  # it stands out
