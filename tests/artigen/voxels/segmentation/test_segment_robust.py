"""Where the robust recipe draws its lines: small fields of exact votes, just below and just above."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.errors import SegmentationError
from artigen.kind import paper_kinds
from artigen.types import JOINT_TYPES, PART_LABELS, JointType, PartLabel
from artigen.voxels.fields import VoxelFields
from artigen.voxels.segmentation.segment_robust import partition_robust

EDGE = 64
Span = tuple[int, int]


def block(x: Span, y: Span, z: Span) -> np.ndarray:
    """The cells of a box."""
    return np.argwhere(np.ones([high - low for low, high in (x, y, z)])) + np.array([x[0], y[0], z[0]])


def body(
    label: PartLabel,
    cells: np.ndarray,
    center: tuple[float, float, float],
    size: tuple[float, float, float],
    joint: JointType = "fixed",
) -> VoxelFields:
    """Cells that all vote for one box, given in cells, and for no motion."""
    count = len(cells)
    return VoxelFields(
        resolution=EDGE,
        coords=cells,
        label_probs=np.tile(np.eye(len(PART_LABELS))[PART_LABELS.index(label)], (count, 1)),
        joint_probs=np.tile(np.eye(len(JOINT_TYPES))[JOINT_TYPES.index(joint)], (count, 1)),
        axis=np.zeros((count, 3)),
        origin=np.zeros((count, 3)),
        ranges=np.zeros((count, 2)),
        box=np.tile([*(np.array(center) / EDGE - 0.5), *(np.array(size) / EDGE)], (count, 1)),
        category_probs=np.zeros((count, len(paper_kinds()))),
    )


def join(*bodies: VoxelFields) -> VoxelFields:
    names = [name for name in vars(bodies[0]) if name != "resolution"]
    return VoxelFields(
        resolution=EDGE, **{name: np.concatenate([getattr(one, name) for one in bodies]) for name in names}
    )


def add(fields: VoxelFields, name: str, column: int, values) -> VoxelFields:
    """The same votes with something added to one of them."""
    votes = getattr(fields, name).copy()
    votes[:, column] += values
    return replace(fields, **{name: votes})


BASE = body("base", block((4, 60), (4, 60), (0, 3)), (32, 32, 1.5), (56, 56, 3))


def halves(label: PartLabel, other: PartLabel, axis: float) -> VoxelFields:
    """Two ends of 64 cells of one handle, of which one votes for a slightly different axis."""
    box = (32, 32, 30), (4, 20, 4)
    one = body(label, block((30, 34), (22, 26), (28, 32)), *box)
    two = body(other, block((30, 34), (38, 42), (28, 32)), *box)
    return join(BASE, one, add(two, "axis", 0, axis))


@pytest.mark.parametrize(("axis", "parts"), [(0.053, 2), (0.055, 3)])
def test_pieces_are_one_part_up_to_an_evidence_of_eight_against_it(axis: float, parts: int):
    """Axes drift by 0.01 within a part: by 0.054 apart they are 29 squared deviations, of 14 votes."""
    assert len(partition_robust(halves("handle", "handle", axis)).labels) == parts


@pytest.mark.parametrize(("axis", "parts"), [(0.0505, 2), (0.0515, 3)])
def test_another_label_is_an_evidence_of_three(axis: float, parts: int):
    """Five is left of eight: axes are 0.051 apart, 25.8 squared deviations, of 14 votes."""
    assert len(partition_robust(halves("handle", "knob", axis)).labels) == parts


@pytest.mark.parametrize(("count", "parts"), [(23, 2), (24, 3)])
def test_from_24_voxels_on_a_part_stands_beside_one_that_explains_its_votes(count: int, parts: int):
    """It votes for the same box, and for another joint."""
    box = (32, 32, 30), (4, 20, 4)
    one = body("handle", block((30, 34), (22, 26), (28, 32)), *box)
    two = body("handle", block((30, 34), (36, 42), (29, 30))[:count], *box, "revolute")
    assert len(partition_robust(join(BASE, one, two)).labels) == parts


@pytest.mark.parametrize(("count", "label"), [(13, "handle"), (14, "knob")])
def test_three_hundredths_of_labels_are_wrong_so_that_one_sure_voxel_does_not_decide(count: int, label: str):
    """One voxel that is sure outweighs thirteen with odds of three to two, but not fourteen."""
    box = (32, 32, 30), (1, 15, 1)
    sure = body("handle", block((32, 33), (25, 26), (30, 31)), *box)
    others = body("knob", block((32, 33), (26, 26 + count), (30, 31)), *box)
    odds = np.zeros((count, len(PART_LABELS)))
    odds[:, PART_LABELS.index("knob")], odds[:, PART_LABELS.index("handle")] = 0.6, 0.4
    assert partition_robust(join(BASE, sure, replace(others, label_probs=odds))).labels == ("base", label)


def stray(beyond: float, neighbours: int) -> bool:
    """Whether a voxel on a plate is the plate's, though it votes for another one.

    That ends ``beyond`` voxels before the stray one, which touches ``neighbours`` voxels of its own plate.
    """
    plate = block((20, 28), (20, 28), (30, 31))
    touching = (np.abs(plate - [24, 24, 31]) <= 1).all(axis=1)
    plate = np.delete(plate, np.flatnonzero(touching)[: 9 - neighbours], axis=0)
    other = block((36, 44), (20, 28), (30, 31))
    box = (29 + beyond, 24, 31), (8, 8, 2)
    fields = join(
        BASE,
        body("shelf", plate, (24, 24, 30.5), (8, 8, 1)),
        body("shelf", other, *box),
        body("shelf", np.array([[24, 24, 31]]), *box),
    )
    found = partition_robust(fields).part_ids
    first, last = len(BASE.coords), len(fields.coords) - 1
    assert len(set(found[[0, first, last - 1]])) == 3
    assert found[last] in (found[first], found[last - 1])
    return bool(found[last] == found[first])


@pytest.mark.parametrize(("beyond", "moved"), [(4.40, False), (4.45, True)])
def test_seven_tenths_of_a_voxel_beyond_a_box_are_one_deviation(beyond: float, moved: object):
    """Against 24 for votes at odds with the plate, less a half for each of eight neighbours."""
    assert stray(beyond, 8) == moved


@pytest.mark.parametrize(("neighbours", "moved"), [(7, False), (8, True)])
def test_a_neighbour_is_worth_a_half(neighbours: int, moved: object):
    assert stray(4.45, neighbours) == moved


@pytest.mark.parametrize("count", [2500, 2501])
def test_votes_in_more_than_2500_groups_are_noise(count: int):
    """Voxels of other labels, each alone, that vote for the box of the base and are the base's."""
    box = (32, 32, 32), (64, 64, 64)
    base = body("base", block((0, 64), (0, 64), (0, 2)), *box)
    alone = body("handle", 2 * block((1, 31), (1, 31), (2, 30))[:count], *box)
    if count > 2500:
        with pytest.raises(SegmentationError, match="expected at most 2500"):
            partition_robust(join(base, alone))
    else:
        assert partition_robust(join(base, alone)).labels == ("base",)


@pytest.mark.parametrize(("shift", "parts"), [(2, 2), (3, 3)])
def test_parts_exceed_their_box_by_three_quarters_of_a_voxel_as_one_deviation(shift: int, parts: int):
    """Two parts beside each other, less apart than their votes are uncertain.

    Together they would exceed the box that they vote for by ``shift``: 2.7 deviations, or 4. The base votes
    for two places along y, six voxels apart, and so tells how uncertain they are.
    """
    base = add(BASE, "box", 1, np.where(BASE.coords[:, 1] < 32, -3.0, 3.0) / EDGE)
    one = np.concatenate([block((30, 38), (24, 32), (30, 31)), block((30, 31), (24, 25), (31, 38))])
    two = [67, 55 + shift, 67] - one
    size = (7.5, 7.5, 7.5)
    fields = join(
        base,
        body("shelf", one, (34, 28, 34), size),
        body("shelf", two, (34, 28 + shift, 34), size),
    )
    assert len(partition_robust(fields).labels) == parts


@pytest.mark.parametrize(("deviations", "parts"), [(5.7, 2), (5.9, 3)])
def test_a_part_is_split_where_votes_scatter_half_as_much_again_as_noise_may(deviations: float, parts: int):
    """One draw of 14 votes scatters by up to 22.5, so that 33.7, 5.8 squared, are too much.

    The base votes for two places along y, 0.2 voxels apart, each over so many voxels that a part has no more
    than one draw.
    """
    base = add(BASE, "box", 1, np.where(BASE.coords[:, 1] < 32, -0.1, 0.1) / EDGE)
    bar = body("handle", block((32, 34), (20, 44), (30, 32)), (33, 32, 31), (2, 24, 2))
    off = np.where(bar.coords[:, 0] % 2, deviations, -deviations) * 1.4826 * 0.1
    assert len(partition_robust(join(base, add(bar, "box", 1, off / EDGE))).labels) == parts


@pytest.mark.parametrize(("deviations", "parts"), [(9.6, 2), (10.1, 3)])
def test_halves_of_a_piece_are_one_part_though_the_split_has_put_a_variance_of_six_between_them(
    deviations: float, parts: int
):
    """So that origins 9.84 deviations apart are 15.8 squared ones, of six votes, an evidence of eight.

    Origins of the base change from voxel to voxel by 0.3, and half of a handle's have something added.
    """
    base = add(BASE, "origin", 0, np.where(BASE.coords[:, 0] % 2, -0.15, 0.15) / EDGE)
    bar = body("handle", block((32, 34), (20, 52), (30, 32)), (33, 36, 31), (2, 32, 2))
    noise = 1.4826 * 0.3 / np.sqrt(2.0)
    off = np.where(bar.coords[:, 1] % 2, deviations * noise, 0.0)
    assert len(partition_robust(join(base, add(bar, "origin", 0, off / EDGE))).labels) == parts


def test_voxels_follow_their_neighbours_twice():
    """Three in a row on a plate that vote for another one: each moves once the one before it has moved."""
    plate = block((20, 28), (20, 28), (30, 31))
    plate = plate[~(plate == [24, 25, 30]).all(axis=1)]
    box = (33.45, 24, 31), (8, 8, 2)
    fields = join(
        BASE,
        body("shelf", plate, (24, 24, 30.5), (8, 8, 1)),
        body("shelf", block((36, 44), (20, 28), (30, 31)), *box),
        body("shelf", block((24, 25), (22, 25), (31, 32)), *box),
    )
    found = partition_robust(fields).part_ids
    first, last = found[len(BASE.coords)], found[-4]
    assert first != last
    assert found[-3:].tolist() == [first, first, last]
