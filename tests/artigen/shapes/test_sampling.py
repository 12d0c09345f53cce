"""Surface of procedural objects: areas in closed form, points on the surface, cells that it crosses."""

from dataclasses import replace

import numpy as np
import pytest
from segment_score import score_segmentation

from artigen.kinematics import movable_parts
from artigen.shapes.asset import frame_shape, shape_to_asset
from artigen.shapes.fittings.hardware import rotate, slide
from artigen.shapes.primitives import (
    Primitive,
    box,
    contains,
    cylinder,
    move,
    place_vertices,
    prism,
    rounded_box,
)
from artigen.shapes.rasterize import rasterize_shape
from artigen.shapes.sampling import place_points, sample_shape
from artigen.shapes.shape import Shape, ShapePart, make_base
from artigen.shapes.surfaces.finishes import Finish
from artigen.voxels.fields import decode, encode
from artigen.voxels.segmentation.segment import segment
from artigen.voxels.voxelize import LEAST_SHARE, assign_cells, find_cells

WOOD = Finish(kind="wood", color=(0.7, 0.5, 0.3), accent=(0.5, 0.3, 0.2))
STEEL = Finish(kind="steel", color=(0.7, 0.7, 0.7), accent=(0.6, 0.6, 0.6))
TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def one_part(*primitives: Primitive) -> Shape:
    part = make_base(primitives)
    return Shape(category="Thing", seed=0, style="plain", parts=(part,), finishes=(("wood", WOOD),))


def boards(*ends: tuple) -> tuple[Primitive, ...]:
    return tuple(rounded_box(low, high, 0.002, "wood") for low, high in ends)


def small_cabinet() -> Shape:
    """A carcass, a drawer with a real box and a bar handle, a door with a handle."""
    body = make_base(
        boards(
            ((-0.25, -0.4, 0.0), (0.25, -0.38, 0.7)),
            ((-0.25, 0.38, 0.0), (0.25, 0.4, 0.7)),
            ((0.23, -0.38, 0.0), (0.25, 0.38, 0.7)),
            ((-0.25, -0.38, 0.68), (0.23, 0.38, 0.7)),
            ((-0.25, -0.38, 0.0), (0.23, 0.38, 0.05)),
            ((-0.25, -0.38, 0.42), (0.23, 0.38, 0.44)),
        )
    )
    drawer = ShapePart(
        "drawer",
        "drawer",
        boards(
            ((-0.272, -0.4, 0.432), (-0.252, 0.4, 0.7)),
            ((-0.252, -0.377, 0.46), (0.21, -0.362, 0.6)),
            ((-0.252, 0.362, 0.46), (0.21, 0.377, 0.6)),
            ((-0.252, -0.362, 0.445), (0.21, 0.362, 0.46)),
            ((0.195, -0.362, 0.46), (0.21, 0.362, 0.6)),
        ),
        slide(0.38),
    )
    door = ShapePart(
        "door",
        "door",
        boards(((-0.272, -0.4, 0.05), (-0.252, 0.4, 0.429))),
        rotate((0.0, 0.0, -1.0), (-0.272, 0.4, 0.0), 1.6),
    )
    bars = [("drawer", (0.0, 0.1, 0.0), 0.55), ("door", (0.0, 0.0, 0.1), 0.25)]
    handles = []
    for parent, half, z in bars:
        middle, reach = np.array([-0.31, -0.2, z]), np.array(half)
        rods = [cylinder(tuple(middle - reach), tuple(middle + reach), 0.012, "steel")]
        for end in (middle - 0.9 * reach, middle + 0.9 * reach):
            rods.append(cylinder(tuple(end), (-0.272, end[1], end[2]), 0.01, "steel"))
        handles.append(ShapePart(f"{parent}_handle", "handle", tuple(rods), parent=parent))
    return Shape(
        category="StorageFurniture",
        seed=0,
        style="plain",
        parts=(body, drawer, door, *handles),
        finishes=(("steel", STEEL), ("wood", WOOD)),
    )


UNIONS = {
    "box": (one_part(box((0, 0, 0), (1, 2, 3), "wood")), 22.0),
    "touching": (one_part(box((0, 0, 0), (1, 1, 1), "wood"), box((1, 0, 0), (2, 1, 1), "wood")), 10.0),
    "overlapping": (
        one_part(box((0, 0, 0), (1, 1, 1), "wood"), box((0.5, 0.5, 0.5), (1.5, 1.5, 1.5), "wood")),
        10.5,
    ),
    "twice the same": (one_part(box((0, 0, 0), (1, 1, 1), "wood"), box((0, 0, 0), (1, 1, 1), "wood")), 6.0),
    "peg on a board": (
        one_part(
            box((0, 0, 0), (1, 1, 0.1), "wood"), cylinder((0.5, 0.5, 0.1), (0.5, 0.5, 0.6), 0.2, "wood")
        ),
        2.4 + 2 * np.pi * 0.2 * 0.5,
    ),
    "rod aslant": (one_part(cylinder((0, 0, 0), (1, 1, 1), 0.5, "wood")), np.pi * (0.5 + 3**0.5)),
    "wedge": (one_part(prism(TRIANGLE, (0, 0, 0), (0, 0, 2), "wood")), 1.0 + 2.0 * (2.0 + 2**0.5)),
    "turned box": (one_part(move(box((0, 0, 0), (1, 2, 3), "wood"), turn=0.5, about=(1.0, 2.0, 3.0))), 22.0),
}


@pytest.mark.parametrize("name", UNIONS)
def test_samples_and_cells_hold_the_area_of_the_union(name: str):
    shape, area = UNIONS[name]
    spacing = 0.02
    assert len(place_points(shape, spacing).points) * spacing**2 == pytest.approx(area, rel=5e-3)
    cell = frame_shape(shape)[1] / 64
    assert rasterize_shape(shape, 64).areas.sum() * cell**2 == pytest.approx(area, rel=4e-3)


@pytest.mark.parametrize("name", UNIONS)
def test_points_lie_on_their_primitive_and_inside_of_none(name: str):
    shape, _ = UNIONS[name]
    found = place_points(shape, 0.03)
    primitives = shape.parts[0].primitives
    for index, primitive in enumerate(primitives):
        own = found.owners == index
        outward = found.points[own] + 1e-9 * found.normals[own]
        assert contains(primitive, found.points[own] - 1e-9 * found.normals[own]).all()
        assert not contains(primitive, outward, margin=1e-12).any()
        assert not contains(primitive, found.points[~own], margin=1e-9).any()
    assert np.allclose(np.linalg.norm(found.normals, axis=1), 1.0)


def test_parts_hide_nothing_of_each_other():
    halves = [
        ShapePart(name, label, (box((x, 0, 0), (x + 1, 1, 1), "wood"),), parent=parent)
        for name, label, parent, x in (("body", "base", None, 0.0), ("shelf", "shelf", "body", 1.0))
    ]
    shape = replace(one_part(*halves[0].primitives), parts=tuple(halves))
    assert len(place_points(shape, 0.02).points) * 0.02**2 == pytest.approx(12.0, rel=5e-3)


def test_points_are_spread_evenly_and_always_the_same():
    shape, _ = UNIONS["overlapping"]
    first, second = place_points(shape, 0.02), place_points(shape, 0.02)
    assert np.array_equal(first.points, second.points)
    top = first.points[(first.normals[:, 2] > 0.9) & (first.owners == 1)]
    counts = np.histogram2d(top[:, 0], top[:, 1], bins=5)[0] * 0.02**2
    assert counts == pytest.approx(np.full((5, 5), 0.04), rel=0.15)
    with pytest.raises(ValueError, match="spacing of 0"):
        place_points(shape, 0.0)


def test_samples_are_coloured_and_fill_the_unit_cube():
    surface = sample_shape(small_cabinet(), 0.01)
    reach = np.abs(surface.points).max(axis=0)
    assert reach.max() == pytest.approx(0.5, abs=2e-3)
    assert set(np.unique(surface.part_ids)) == set(range(5))
    bar = surface.colors[surface.part_ids == 3].astype(float)
    panel = surface.colors[surface.part_ids == 2].astype(float)
    assert np.ptp(bar.mean(axis=0)) < 10 < np.ptp(panel.mean(axis=0))


@pytest.mark.parametrize("name", UNIONS)
def test_every_cell_with_a_sample_is_found_and_no_cell_far_from_any(name: str):
    shape, _ = UNIONS[name]
    center, scale = frame_shape(shape)
    cells = np.zeros((16, 16, 16), dtype=bool)
    cells[tuple(rasterize_shape(shape, 16).cells.T)] = True
    found = place_points(shape, scale / 16 / 20)
    inner = (found.points - 1e-6 * scale * found.normals - center) / scale + 0.5
    sampled = np.zeros_like(cells)
    sampled[tuple(np.clip(np.floor(16 * inner), 0, 15).astype(int).T)] = True
    assert (sampled & ~cells).sum() <= 0.01 * cells.sum()  # prisms stand for cylinders, edges
    assert (cells & ~sampled).sum() <= 0.03 * cells.sum()  # corners of cells that samples miss


def test_exact_cells_agree_with_samples_part_by_part():
    shape, resolution = small_cabinet(), 29  # no board lies between two cells
    exact, samples = rasterize_shape(shape, resolution), sample_shape(shape, 0.005)
    cells, ones = find_cells(samples, resolution), np.ones(len(samples.points))
    both = (
        assign_cells(exact.cells, exact.part_ids, exact.areas, resolution, LEAST_SHARE),
        assign_cells(cells, samples.part_ids, ones, resolution, LEAST_SHARE),
    )
    grids = [np.full((resolution,) * 3, -1) for _ in range(2)]
    for grid, voxels in zip(grids, both, strict=True):
        grid[tuple(voxels.coords.T)] = voxels.part_ids
    for part in range(len(shape.parts)):
        a, b = (grid == part for grid in grids)
        assert (a & b).sum() > 0.9 * (a | b).sum()


def test_asset_states_joints_and_boxes_in_unit_lengths():
    shape = small_cabinet()
    center, scale = frame_shape(shape)
    asset = shape_to_asset(shape)
    drawer, door = asset.parts[1], asset.parts[2]
    assert asset.scale == scale == pytest.approx(0.8)
    assert drawer.joint.upper == pytest.approx(0.38 / scale)
    assert door.joint.upper == 1.6
    assert np.allclose(door.joint.origin, (np.array([-0.272, 0.4, 0.0]) - center) / scale)
    points = np.concatenate([place_vertices(p) for p in shape.parts[1].primitives])
    assert np.allclose(drawer.box[1], np.ptp(points, axis=0) / scale)
    assert movable_parts(asset) == [1, 2]


def test_a_part_below_the_resolution_joins_its_parent_and_a_note_says_so():
    shape = small_cabinet()
    dot = ShapePart("dot", "knob", (box((0.0, 0.39, 0.3), (1e-4, 0.39005, 0.3001), "wood"),))
    hidden = replace(dot, name="twin")
    asset = shape_to_asset(replace(shape, parts=(*shape.parts, dot, hidden)))
    assert len(asset.parts) == 6
    assert any("below the voxel resolution" in note for note in asset.notes)


def test_the_parts_are_found_again_in_the_field():
    asset = shape_to_asset(small_cabinet())
    found = segment(decode(encode(asset)), name="again", scale=asset.scale)
    assert score_segmentation(asset, found).complete
