"""Surfaces to voxels to fields and back: ownership, channels, round trip."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.kind import paper_kinds
from artigen.types import (
    FIXED,
    FULL_TURN,
    JOINT_TYPES,
    PART_LABELS,
    Asset,
    Joint,
    Part,
    SurfaceSamples,
    VoxelGrid,
)
from artigen.voxels.fields import CHANNELS, FIELD, canonical_origin, joint_ranges, part_attributes
from artigen.voxels.voxelize import (
    FAIR_SHARE,
    LEAST_SHARE,
    assign_cells,
    decode,
    drop_unresolved,
    encode,
    voxelize,
    voxelize_again,
)


def make_surface(points, part_ids) -> SurfaceSamples:
    points = np.asarray(points, dtype=np.float64)
    return SurfaceSamples(
        points=points,
        normals=np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        colors=np.zeros((len(points), 3), dtype=np.uint8),
        part_ids=np.asarray(part_ids),
    )


def owner_of(grid: VoxelGrid, point) -> int:
    cell = np.floor((np.asarray(point) + 0.5) * grid.resolution).astype(int)
    (row,) = np.flatnonzero((grid.coords == cell).all(axis=1))
    return int(grid.part_ids[row])


def test_area_majority_owns_a_cell_whatever_the_order():
    points = np.concatenate([np.full((5, 3), 0.01), np.full((3, 3), 0.012), np.full((30, 3), 0.2)])
    ids = np.array([1] * 5 + [0] * 3 + [0] * 30)
    shuffled = np.random.default_rng(0).permutation(len(ids))
    for order in (np.arange(len(ids)), shuffled):
        grid = voxelize(make_surface(points[order], ids[order]))
        assert owner_of(grid, [0.01] * 3) == 1
        assert owner_of(grid, [0.2] * 3) == 0
        assert len(grid.coords) == 2


def test_ties_go_to_the_lower_part():
    # Both parts hold all of their area elsewhere in equal measure, so neither is starved.
    points = [[0.01] * 3] * 2 + [[0.1] * 3] * 9 + [[0.3] * 3] * 9
    grid = voxelize(make_surface(points, [1, 0] + [0] * 9 + [1] * 9))
    assert owner_of(grid, [0.01] * 3) == 0


@pytest.mark.parametrize(("noise", "stripes"), [(1e-9, False), (0.0004, False), (0.0011, True)])
def test_noise_does_not_part_a_layer_in_stripes(noise, stripes):
    """One part gets half of a layer that is all of two, in one piece unless areas truly differ."""
    cells = np.argwhere(np.ones((16, 16, 1), dtype=bool))
    areas = np.ones(2 * len(cells))
    areas[len(cells) :: 2] += noise
    grid = assign_cells(np.concatenate([cells, cells]), np.repeat([0, 1], len(cells)), areas, 16)
    assert (np.count_nonzero(np.diff(grid.part_ids)) > 1) == stripes
    if not stripes:
        assert (grid.part_ids == 1).mean() == pytest.approx(LEAST_SHARE, abs=1 / len(cells))


def test_far_faces_of_the_cube_belong_to_the_last_cell():
    grid = voxelize(make_surface([[0.5, 0.5, 0.5], [-0.5, -0.5, -0.5]], [0, 0]), resolution=8)
    assert sorted(map(tuple, grid.coords.tolist())) == [(0, 0, 0), (7, 7, 7)]


def test_a_button_smaller_than_a_cell_keeps_one():
    panel = np.random.default_rng(0).uniform([0.0, -0.4, -0.4], [0.004, 0.4, 0.4], size=(200_000, 3))
    button = np.random.default_rng(1).uniform([0.004, 0.101, 0.101], [0.006, 0.105, 0.105], size=(8, 3))
    surface = make_surface(np.concatenate([panel, button]), [0] * len(panel) + [1] * len(button))
    grid = voxelize(surface)
    assert (grid.part_ids == 1).sum() == 1
    assert owner_of(grid, button[0]) == 1


@pytest.mark.parametrize(
    ("share", "lost", "claimed"),
    [
        (FAIR_SHARE, 0.21, True),
        (FAIR_SHARE, 0.19, False),
        (LEAST_SHARE, 0.51, True),
        (LEAST_SHARE, 0.49, False),
    ],
)
def test_a_part_that_holds_less_than_its_share_claims_a_cell(share, lost, claimed):
    cells = np.array([[0, 0, 0], [0, 0, 0], [1, 0, 0]])
    grid = assign_cells(cells, np.array([0, 1, 1]), np.array([5.0, lost, 1.0 - lost]), 4, share)
    assert (owner_of(grid, np.array([-0.4, -0.4, -0.4])) == 1) == claimed


@pytest.mark.parametrize(
    ("lost", "area", "claimed"), [(0.4, 1.26, True), (0.4, 1.24, False), (0.51, 0.9, True)]
)
def test_up_to_half_is_claimed_from_any_part_and_more_from_larger_ones(lost, area, claimed):
    cells = np.array([[0, 0, 0], [0, 0, 0], [1, 0, 0], [2, 0, 0]])
    areas = np.array([0.6, lost, 1.0 - lost, area - 0.6])
    grid = assign_cells(cells, np.array([0, 1, 1, 0]), areas, 4)
    assert (owner_of(grid, np.array([-0.4, -0.4, -0.4])) == 1) == claimed


def test_every_sampled_part_holds_half_its_area(cabinet: Asset):
    assert cabinet.voxels is not None
    assert cabinet.surface is not None
    cells = np.floor((cabinet.surface.points.astype(np.float64) + 0.5) * 64).clip(0, 63).astype(int)
    owner = np.full((64,) * 3, -1)
    owner[tuple(cabinet.voxels.coords.T)] = cabinet.voxels.part_ids
    own = owner[tuple(cells.T)] == cabinet.surface.part_ids
    assert (owner[tuple(cells.T)] >= 0).all()
    for index, part in enumerate(cabinet.parts):
        assert own[cabinet.surface.part_ids == index].mean() >= 0.5, part.name


def test_unresolved_parts_are_merged_into_the_nearest_owner_and_noted(cabinet: Asset):
    assert cabinet.voxels is not None
    names = [part.name for part in cabinet.parts]
    door, handle = names.index("door"), names.index("door_handle")
    ids = cabinet.voxels.part_ids.copy()
    ids[ids == handle] = door
    lean = drop_unresolved(replace(cabinet, voxels=replace(cabinet.voxels, part_ids=ids)))
    assert [part.name for part in lean.parts] == [name for name in names if name != "door_handle"]
    assert len(lean.notes) == 1
    assert "door_handle" in lean.notes[0]
    assert lean.surface is not None
    assert cabinet.surface is not None
    mine = cabinet.surface.part_ids == handle
    assert (lean.surface.part_ids[mine] == [part.name for part in lean.parts].index("door")).all()
    for before, after in ((part.name, part.parent) for part in cabinet.parts if part.name != "door_handle"):
        found = next(part for part in lean.parts if part.name == before)
        assert (found.parent == -1) == (after == -1)
        if after != -1:
            assert lean.parts[found.parent].name == cabinet.parts[after].name


def test_children_of_an_unresolved_part_hang_from_its_parent(cabinet: Asset):
    assert cabinet.voxels is not None
    names = [part.name for part in cabinet.parts]
    ids = cabinet.voxels.part_ids.copy()
    ids[ids == names.index("door")] = names.index("body")
    lean = drop_unresolved(replace(cabinet, voxels=replace(cabinet.voxels, part_ids=ids)))
    lock = next(part for part in lean.parts if part.name == "lock")
    assert lean.parts[lock.parent].name == "body"


def test_nothing_to_drop_changes_nothing(cabinet: Asset):
    assert drop_unresolved(cabinet) is cabinet


def test_a_root_without_voxels_is_refused(cabinet: Asset):
    assert cabinet.voxels is not None
    ids = np.where(cabinet.voxels.part_ids == cabinet.root, 1, cabinet.voxels.part_ids)
    with pytest.raises(ValueError, match="root"):
        drop_unresolved(replace(cabinet, voxels=replace(cabinet.voxels, part_ids=ids)))


def test_voxels_are_where_the_surface_made_of_them_is():
    y, z = (values.ravel() / 32 - 0.5 for values in np.meshgrid(*[np.arange(32) + 0.5] * 2))
    sheet = make_surface(np.stack([np.full_like(y, 0.2), y, z], axis=1), np.zeros(len(y), dtype=int))
    cells = np.argwhere(np.ones((16, 16, 16), dtype=bool))
    thick = cells[(cells[:, 0] >= 9) & (cells[:, 0] < 12)]  # the sheet lies in the last of three layers
    drawn = VoxelGrid(resolution=16, coords=thick, part_ids=np.zeros(len(thick), dtype=int))
    again = voxelize_again(sheet, drawn)
    np.testing.assert_array_equal(again.coords, thick[thick[:, 0] == 11])
    same = voxelize(sheet, 16)
    np.testing.assert_array_equal(voxelize_again(sheet, same).coords, same.coords)


def test_of_two_walls_in_one_layer_of_cells_the_one_that_would_move_further_owns_it_all():
    rng, edge = np.random.default_rng(7), 16
    place = 4.0 + 8.0 * rng.random((8 * 8 * 64, 2))  # about 32 samples of each in every cell
    part_ids = rng.integers(0, 2, len(place))
    for low, high, owner in ((0.2, 0.8, 1), (0.8, 0.2, 0)):
        height = 5.0 + np.where(part_ids == 0, low, high)  # both face up: beneath, cells are free
        walls = np.column_stack([place, height])
        apart = np.column_stack([place, 10.5 + 2.0 * part_ids])  # what either has elsewhere
        surface = make_surface(np.concatenate([walls, apart]) / edge - 0.5, np.tile(part_ids, 2))
        again = voxelize_again(surface, voxelize(surface, edge))
        assert set(again.part_ids[again.coords[:, 2] == 5]) == {owner}


def test_what_has_no_cell_beneath_keeps_its_own():
    y, z = (4.0 + values.ravel() for values in np.meshgrid(*[np.arange(0.125, 8.0, 0.25)] * 2))
    # The first goes to the layer beneath, which is its part's; the last is more of its part elsewhere.
    walls = [(0, 5.7), (0, 4.3), (1, 5.5), (0, 9.5)]
    surface = SurfaceSamples(
        points=np.concatenate([np.column_stack([np.full(len(y), x), y, z]) for _, x in walls]) / 16 - 0.5,
        normals=np.tile([1.0, 0.0, 0.0], (len(walls) * len(y), 1)),
        colors=np.zeros((len(walls) * len(y), 3), dtype=np.uint8),
        part_ids=np.repeat([part for part, _ in walls], len(y)),
    )
    again = voxelize_again(surface, voxelize(surface, 16))
    assert set(again.part_ids[again.coords[:, 0] == 5]) == {1}
    assert set(again.part_ids[again.coords[:, 0] == 4]) == {0}


def test_a_part_that_would_lose_all_voxels_keeps_them():
    surface = make_surface([[0.0, 0.0, 0.0]] * 3, [0, 0, 0])
    drawn = VoxelGrid(
        resolution=8, coords=np.array([[4, 4, 4], [2, 2, 2], [6, 1, 1]]), part_ids=np.array([1, 0, 2])
    )
    again = voxelize_again(surface, drawn)
    assert {tuple(cell): part for cell, part in zip(again.coords.tolist(), again.part_ids, strict=True)} == {
        (4, 4, 4): 1,
        (6, 1, 1): 2,
    }


def test_fields_have_35_channels_in_the_stated_order():
    assert CHANNELS == 35
    assert [part.stop - part.start for part in FIELD] == [8, 5, 3, 3, 2, 6, 7]
    assert np.concatenate([np.arange(35)[part] for part in FIELD]).tolist() == list(range(1, 35))


def test_decode_recovers_every_attribute_of_every_voxel(cabinet: Asset):
    fields = decode(encode(cabinet))
    voxels = cabinet.voxels
    assert voxels is not None
    order = np.lexsort(voxels.coords.T[::-1])
    assert (fields.coords == voxels.coords[order]).all()
    for index, part in enumerate(cabinet.parts):
        mine = voxels.part_ids[order] == index
        assert mine.any()
        assert (fields.label_probs[mine].argmax(axis=1) == PART_LABELS.index(part.label)).all()
        assert (fields.joint_probs[mine].argmax(axis=1) == JOINT_TYPES.index(part.joint.type)).all()
        axis = np.zeros(3) if part.joint.type == "fixed" else part.joint.axis
        assert np.allclose(fields.axis[mine], axis, atol=1e-6)
        assert np.allclose(fields.origin[mine], canonical_origin(part), atol=1e-6)
        assert np.allclose(fields.ranges[mine], joint_ranges(part), atol=1e-6)
        assert np.allclose(fields.box[mine], part.box.ravel(), atol=1e-6)
    assert np.allclose(fields.label_probs.sum(axis=1), 1)
    category = paper_kinds().index("StorageFurniture")
    assert (fields.category_probs.argmax(axis=1) == category).all()


def test_empty_cells_are_zero_and_occupied_ones_are_one(cabinet: Asset):
    field = encode(cabinet)
    assert cabinet.voxels is not None
    assert field.dtype == np.float32
    assert set(np.unique(field[0])) == {0.0, 1.0}
    assert (field[0] > 0).sum() == len(cabinet.voxels.coords)
    assert not field[:, field[0] == 0].any()


def test_other_categories_have_zeros(cabinet: Asset):
    field = encode(replace(cabinet, category="Faucet"))
    assert not field[FIELD.category].any()
    assert (encode(cabinet)[: FIELD.category.start] == field[: FIELD.category.start]).all()


def make_part(joint: Joint) -> Part:
    return Part(
        name="p", label="door", parent=-1, joint=joint, box=np.array([[0.1, 0.2, 0.3], [0.1, 0.1, 0.2]])
    )


def test_the_gauge_of_origins_does_not_depend_on_the_point_given():
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    at = np.array([0.3, -0.2, 0.1])
    origins = [
        canonical_origin(make_part(Joint(type="revolute", axis=axis, origin=at + t * axis, upper=1.0)))
        for t in (-3.0, 0.0, 0.7)
    ]
    assert np.allclose(origins, origins[0])
    assert np.isclose((origins[0] - [0.1, 0.2, 0.3]) @ axis, 0)
    assert np.allclose(np.cross(origins[0] - at, axis), 0)
    slide = make_part(Joint(type="prismatic", axis=axis, origin=at, upper=1.0))
    assert np.allclose(canonical_origin(slide), slide.box[0])


def test_a_screw_states_turn_and_travel():
    screw = Joint(type="screw", axis=np.array([0.0, 0.0, 1.0]), origin=np.zeros(3), upper=3.0, pitch=-0.02)
    assert np.allclose(joint_ranges(make_part(screw)), [3.0, -0.06])
    row = part_attributes(make_part(screw), "Oven")
    assert np.allclose(row[FIELD.range], [3.0 / FULL_TURN, -0.06])


def test_a_rest_pose_inside_the_limits_is_refused():
    swing = Joint(type="revolute", axis=np.array([0.0, 0.0, 1.0]), origin=np.zeros(3), lower=-1.0, upper=1.0)
    with pytest.raises(ValueError, match="rest pose"):
        joint_ranges(make_part(swing))


def test_encoding_needs_voxels(cabinet: Asset):
    with pytest.raises(ValueError, match="no voxels"):
        encode(replace(cabinet, voxels=None))


def test_decoding_refuses_other_shapes():
    with pytest.raises(ValueError, match="35"):
        decode(np.zeros((34, 8, 8, 8), dtype=np.float32))
    with pytest.raises(ValueError, match="35"):
        decode(np.zeros((35, 8, 8, 4), dtype=np.float32))


def test_decoded_probabilities_are_normalised_and_never_undefined():
    field = np.zeros((35, 4, 4, 4), dtype=np.float32)
    field[0, 1, 2, 3] = 0.9
    field[1, 1, 2, 3] = 3.0
    field[2, 1, 2, 3] = -1.0
    fields = decode(field)
    assert fields.coords.tolist() == [[1, 2, 3]]
    assert fields.label_probs[0, 0] == 1.0
    assert np.allclose(fields.joint_probs[0], 1 / 5)


def test_a_fixed_handle_states_its_own_joint(cabinet: Asset):
    handle = next(part for part in cabinet.parts if part.name == "drawer_handle")
    row = part_attributes(handle, cabinet.category)
    assert handle.joint is FIXED or handle.joint.type == "fixed"
    assert not row[FIELD.axis].any()
    assert not row[FIELD.range].any()


@pytest.mark.real
def test_no_part_of_a_microwave_is_lost(real_objects):
    from artigen.datasets.partnet_mobility import read_object

    asset = read_object(real_objects / "partnet_mobility" / "7263").asset
    assert asset.surface is not None
    asset = drop_unresolved(replace(asset, voxels=voxelize(asset.surface)))
    assert sum(part.label == "knob" for part in asset.parts) == 18


@pytest.mark.parametrize(("samples", "owner"), [(4, 0), (5, 1)])
def test_surface_without_a_usable_cell_beneath_counts_as_two_voxels_lost(samples: int, owner: int):
    """In one cell, a level with ten samples, each of which would move by 0.95, and some of a wall."""
    rows = [
        *[((5.5, 5.5, 5.95), (0, 0, 1), 0)] * 10,
        *[((5.5, 5.5, 5.5), (1, 0, 0), 1)] * samples,
        ((4.5, 5.5, 5.5), (1, 0, 0), 2),  # beneath the wall
        *[((10.5, 10.5, 10.9), (0, 0, 1), 0)] * 40,  # what either has elsewhere
        *[((12.5, 12.5, 12.9), (0, 0, 1), 1)] * 40,
    ]
    points, normals, part_ids = (np.array(column) for column in zip(*rows, strict=True))
    surface = replace(make_surface(points / 16 - 0.5, part_ids), normals=normals.astype(np.float64))
    again = voxelize_again(surface, voxelize(surface, 16))
    assert owner_of(again, np.array([5.5, 5.5, 5.5]) / 16 - 0.5) == owner
