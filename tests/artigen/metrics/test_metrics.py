"""Measures of objects and of sets of objects: laws with closed forms, and what each protocol can see."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.conditioning.delivery import asset_size, has_counts, part_counts, size_error
from artigen.metrics.clouds import chamfer, sample_cells, sample_every_part
from artigen.metrics.compat import compat_distance, pair_with_leftovers
from artigen.metrics.instantiation import (
    InstantiationConfig,
    instantiation_distance,
    pairwise_distances,
    pose_object,
)
from artigen.metrics.score import coverage, minimum_matching_distance, nearest_neighbour_accuracy
from artigen.metrics.strict import PENALTY, strict_distance
from artigen.metrics.structure import part_deviations
from artigen.types import PART_LABELS, Asset, Joint, Part, VoxelGrid

POINTS = 4000


def part_of(label, parent: int, joint: Joint, low: tuple[int, int, int], high: tuple[int, int, int]) -> Part:
    """A part that fills cells of a 32^3 grid."""
    corners = np.array([low, high]) / 32 - 0.5
    box = np.stack([corners.mean(axis=0), corners[1] - corners[0]])
    return Part(name=f"{label}_{low[0]}_{low[2]}", label=label, parent=parent, joint=joint, box=box)


def fill(parts: tuple[Part, ...]) -> Asset:
    """An asset whose parts fill their boxes."""
    coords, owners = [], []
    for index, part in enumerate(parts):
        low, high = np.rint((part.box[0] + np.array([[-0.5], [0.5]]) * part.box[1] + 0.5) * 32).astype(int)
        cells = np.stack(np.meshgrid(*(np.arange(a, b) for a, b in zip(low, high, strict=True))), axis=-1)
        coords.append(cells.reshape(-1, 3))
        owners.append(np.full(len(coords[-1]), index))
    voxels = VoxelGrid(resolution=32, coords=np.concatenate(coords), part_ids=np.concatenate(owners))
    return Asset(name="made", category="Oven", scale=0.6, parts=parts, voxels=voxels)


STILL = Joint(type="fixed", axis=np.array([0.0, 0.0, 1.0]), origin=np.zeros(3))
HINGE = Joint(
    type="revolute", axis=np.array([0.0, 0.0, 1.0]), origin=np.array([-0.5, -0.5, 0.0]), upper=np.pi / 2
)


@pytest.fixture
def oven() -> Asset:
    """A body, a door on a vertical hinge, a handle on the door and a knob on the handle."""
    return fill(
        (
            part_of("base", -1, STILL, (4, 0, 0), (32, 32, 32)),
            part_of("door", 0, HINGE, (2, 0, 0), (4, 32, 24)),
            part_of("handle", 1, STILL, (0, 28, 4), (2, 30, 20)),
            part_of("knob", 2, STILL, (0, 30, 20), (2, 32, 22)),
        )
    )


def with_joint(asset: Asset, index: int, **changes) -> Asset:
    """The same asset with another joint."""
    part = asset.parts[index]
    parts = list(asset.parts)
    parts[index] = replace(part, joint=replace(part.joint, **changes))
    return replace(asset, parts=tuple(parts))


def moved(asset: Asset, cells: int) -> Asset:
    """The asset some cells further along z."""
    shift = np.array([0.0, 0.0, cells / 32])
    parts = tuple(
        replace(
            part,
            box=part.box + np.stack([shift, np.zeros(3)]),
            joint=replace(part.joint, origin=part.joint.origin + shift),
        )
        for part in asset.parts
    )
    assert asset.voxels is not None
    voxels = replace(asset.voxels, coords=asset.voxels.coords + np.array([0, 0, cells]))
    return replace(asset, parts=parts, voxels=voxels)


def test_the_distance_of_a_shifted_cloud_is_the_shift_squared_both_ways():
    points = np.stack(np.meshgrid(*[np.arange(5.0)] * 3), axis=-1).reshape(-1, 3)
    assert chamfer(points, points) == 0.0
    assert chamfer(points, points + np.array([0.3, 0.0, 0.0])) == pytest.approx(2 * 0.3**2)
    with pytest.raises(ValueError, match="clouds of 125 and 0 points"):
        chamfer(points, points[:0])


def test_points_lie_in_the_cells_of_their_parts_and_follow_from_the_seed(oven: Asset):
    assert oven.voxels is not None
    for cloud in (sample_cells(oven, POINTS), sample_every_part(oven, 50)):
        for index, part in enumerate(oven.parts):
            inside = np.abs(cloud.points[cloud.part_ids == index] - part.box[0]) <= part.box[1] / 2
            assert inside.all()
    assert np.array_equal(sample_cells(oven, POINTS).points, sample_cells(oven, POINTS).points)
    assert (np.bincount(sample_every_part(oven, 50).part_ids) == 50).all()
    shares = np.bincount(sample_cells(oven, 10 * len(oven.voxels.coords)).part_ids)
    assert np.array_equal(shares, 10 * np.bincount(oven.voxels.part_ids))


def test_an_object_is_at_no_distance_from_itself(oven: Asset):
    strict = strict_distance(oven, oven, points=POINTS)
    assert max(vars(strict).values()) == 0.0
    compat = compat_distance(oven, oven, per_part=200)
    assert max(vars(compat).values()) == pytest.approx(0.0, abs=1e-20)
    posed = pose_object(oven, InstantiationConfig(points=100))
    assert instantiation_distance(posed, posed) == 0.0


def test_a_wrong_axis_shows_when_articulated_and_not_at_rest(oven: Asset):
    wrong = with_joint(oven, 1, axis=np.array([0.0, 1.0, 0.0]))
    strict = strict_distance(wrong, oven, points=POINTS)
    assert (strict.rest, strict.whole_rest) == (0.0, 0.0)
    assert min(strict.articulated, strict.whole_articulated) > 1e-3  # door, handle and knob are few points
    compat = compat_distance(wrong, oven, per_part=200)
    assert compat.rest == pytest.approx(0.0, abs=1e-20)
    assert compat.articulated > 0.01


def test_only_strict_looks_at_limits(oven: Asset):
    stiff = with_joint(oven, 1, upper=0.5)
    assert compat_distance(stiff, oven, per_part=200).articulated == pytest.approx(0.0, abs=1e-20)
    assert strict_distance(stiff, oven, points=POINTS).articulated > 0.01


def test_compat_leaves_grandchildren_behind(oven: Asset):
    parts = (*oven.parts[:3], replace(oven.parts[3], parent=1))  # the knob hangs from the door itself
    flat = replace(oven, parts=parts)
    assert strict_distance(flat, oven, points=POINTS).articulated == 0.0
    assert compat_distance(flat, oven, per_part=200).articulated > 0.1


def test_only_strict_looks_at_places(oven: Asset):
    low = fill(tuple(part_of(p.label, p.parent, p.joint, (8, 8, 0), (9, 9, 9)) for p in oven.parts[:1]))
    high = moved(low, 6)
    assert compat_distance(high, low, per_part=200).rest == pytest.approx(0.0, abs=1e-20)
    assert strict_distance(high, low, points=POINTS).rest > 0.01


def test_a_missing_part_costs_the_diagonal_in_strict_and_nothing_in_compat(oven: Asset):
    assert oven.voxels is not None
    kept = oven.voxels.part_ids < 3
    voxels = replace(oven.voxels, coords=oven.voxels.coords[kept], part_ids=oven.voxels.part_ids[kept])
    short = replace(oven, parts=oven.parts[:3], voxels=voxels)
    strict = strict_distance(short, oven, points=5 * POINTS)
    # Of four true parts one is missing, of three found ones none: the mean of 1/4 and 0.
    assert strict.rest == pytest.approx(PENALTY / 8, abs=2e-3)
    assert strict.rest_matched < 2e-3
    assert compat_distance(short, oven, per_part=200).rest < PENALTY / 8


def test_leftover_parts_take_their_nearest_partner():
    source = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [5.0, 0.0, 0.0]])
    target = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]])
    assert pair_with_leftovers(source, target).tolist() == [0, 0, 1]
    assert pair_with_leftovers(target, source).tolist() == [0, 2]


def test_poses_tell_joints_apart(oven: Asset):
    cfg = InstantiationConfig(points=200)
    stiff = with_joint(oven, 1, upper=0.3)
    posed = [pose_object(asset, cfg) for asset in (oven, stiff, with_joint(oven, 1, upper=0.2))]
    distances = pairwise_distances(posed, posed)
    assert np.array_equal(distances, distances.T)
    assert np.array_equal(np.diag(distances), np.zeros(3))
    assert distances[1, 2] < distances[0, 1]


def spread_apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distances of points of the plane."""
    return np.linalg.norm(a[:, None] - b[None], axis=2)


def test_sets_of_one_distribution_cannot_be_told_apart_and_disjoint_ones_can():
    points = np.random.default_rng(0).normal(size=(600, 2))
    one, other, far = points[:300], points[300:], points[300:] + 100.0
    accuracy = nearest_neighbour_accuracy(
        spread_apart(one, other), spread_apart(one, one), spread_apart(other, other)
    )
    assert accuracy == pytest.approx(0.5, abs=0.06)
    accuracy = nearest_neighbour_accuracy(
        spread_apart(one, far), spread_apart(one, one), spread_apart(far, far)
    )
    assert accuracy == 1.0
    copied = spread_apart(one, one)
    assert nearest_neighbour_accuracy(copied, copied, copied) == 0.0
    with pytest.raises(ValueError, match="two in each"):
        nearest_neighbour_accuracy(copied[:1], copied[:1, :1], copied)


def test_coverage_and_matching_distance_have_their_extremes():
    points = np.random.default_rng(0).normal(size=(20, 2))
    same = spread_apart(points, points)
    assert (coverage(same), minimum_matching_distance(same)) == (1.0, 0.0)
    collapsed = spread_apart(np.repeat(points[:1], 20, axis=0), points)
    assert coverage(collapsed) == 1 / 20
    assert minimum_matching_distance(collapsed) == pytest.approx(collapsed[0].mean())


def test_deviations_are_those_within_a_part():
    values = np.array([[1.0, 7.0], [3.0, 7.0], [10.0, 2.0], [10.0, 2.0], [10.0, 2.0]])
    ids, deviations = part_deviations(values, np.array([4, 4, 9, 9, 9]))
    assert ids.tolist() == [4, 9]
    assert deviations == pytest.approx(np.array([[1.0, 0.0], [0.0, 0.0]]))


def test_counts_and_size_are_met_exactly_or_not(oven: Asset):
    assert part_counts(oven).tolist() == [1, 0, 1, 1, 1, 0, 0, 0]
    everything = tuple(zip(PART_LABELS, part_counts(oven).tolist(), strict=True))
    assert has_counts(oven, everything)
    assert has_counts(oven, (("door", 1),))
    assert not has_counts(oven, (("door", 1), ("drawer", 1)))
    assert asset_size(oven) == pytest.approx([0.6, 0.6, 0.6])
    assert size_error(oven, (0.6, 0.6, 0.5)) == pytest.approx(0.2)
