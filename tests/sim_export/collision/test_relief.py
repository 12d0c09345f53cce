"""Two hulls that overlap are parted by what takes least of them."""

import numpy as np
import pytest
from hull_link import box

from artigen.transforms import rotation_about
from artigen.types import Joint
from sim_export.collision.clearance import clear_joints
from sim_export.collision.relief import MARGIN, OverlappingPair, relieve_pair
from sim_export.geometry.hulls import box_bounds, box_hull, convex_hull, hull_volume
from sim_export.package import Hull, Link

BOARD = box_hull(np.zeros(3), np.array([1.0, 1.0, 0.02]))
TAB = box_hull(np.array([0.4, 0.4, 0.01]), np.array([0.45, 0.45, 0.03]))
STILL = np.eye(4)[None]


def pair_of(first: Hull, second: Hull, *, allowed=0.65, least=1.0, sliver=False, poses=STILL):
    """Hulls of an object 1 m long, of which only the first may be cut and only the second be dropped.

    Cuts may take ``allowed`` of it, deep ones ``least``. The second one is at ``poses``.
    """
    volumes = hull_volume(first), hull_volume(second)
    return OverlappingPair(
        hulls=(first, second),
        poses=(np.tile(np.eye(4), (len(poses), 1, 1)), poses),
        volumes=volumes,
        allowances=(allowed * volumes[0], 0.0),
        least=(least * volumes[0], 0.0),
        slivers=(False, sliver),
        room=(0, 0),
        size=1.0,
        axis=np.array([0.0, 0.0, 1.0]),
    )


def on_top(depth: float, thickness: float = 0.4, **given) -> OverlappingPair:
    """A block that stands ``depth`` (m) in a board as large as it is, and as thick as that."""
    board = box((0, 0, 0), (1, 1, thickness))
    return pair_of(board, box((0, 0, thickness - depth), (1, 1, thickness + 0.2)), **given)


def is_freed(pair: OverlappingPair) -> bool:
    return relieve_pair(pair, 1e-3).reason == ""


def overlap(*, sliver: bool, cuttable: bool) -> OverlappingPair:
    """A tab half way down in a board, which may be cut, and dropped as a sliver, or not."""
    volumes = hull_volume(BOARD), hull_volume(TAB)
    return OverlappingPair(
        hulls=(BOARD, TAB),
        poses=(np.eye(4)[None], np.eye(4)[None]),
        volumes=volumes,
        allowances=(0.65 * volumes[0], 0.65 * volumes[1] if cuttable else 0.0),
        least=(0.0, 0.0),
        slivers=(False, sliver),
        room=(0, 0),
        size=1.0,
        axis=np.array([0.0, 0.0, 1.0]),
    )


@pytest.mark.parametrize(
    ("sliver", "cuttable", "board_left", "tab_left"),
    [(True, True, 1.0, 0.375), (True, False, 1.0, 0.0), (False, False, 0.375, 1.0)],
)
def test_a_sliver_goes_where_cuts_would_take_more_of_the_other_hull(sliver, cuttable, board_left, tab_left):
    """A cut leaves a gap of 2.5 mm, so that it takes 12.5 of 20 mm."""
    done = relieve_pair(overlap(sliver=sliver, cuttable=cuttable), 1e-3)
    assert done.reason == ""
    shares = [
        sum(map(hull_volume, left)) / hull_volume(hull)
        for left, hull in zip(done.hulls, (BOARD, TAB), strict=True)
    ]
    np.testing.assert_allclose(shares, [board_left, tab_left], atol=1e-6)


@pytest.mark.parametrize(
    ("cut_before", "least", "freed"), [(0.3, 0.004, True), (0.3, 0.003, False), (0.65, 0.004, False)]
)
def test_a_deep_cut_takes_little_whatever_other_cuts_have_taken(cut_before, least, freed):
    """A shaft through a board leaves a slot; that and the cuts before may take 0.65 of the board."""
    shaft = box_hull(np.array([0.4, 0.4, -0.5]), np.array([0.45, 0.45, 0.5]))
    board = box_hull(np.zeros(3), np.array([1.0, 1.0, 0.4]))
    before = hull_volume(board) / (1.0 - cut_before)
    pair = OverlappingPair(
        hulls=(board, shaft),
        poses=(np.eye(4)[None], np.eye(4)[None]),
        volumes=(before, hull_volume(shaft)),
        allowances=(0.65 * before, 0.0),
        least=(least * hull_volume(board), 0.0),
        slivers=(False, False),
        room=(8, 0),
        size=10.0,
        axis=np.array([0.0, 0.0, 1.0]),
    )
    assert (relieve_pair(pair, 1e-3).reason == "") is freed


@pytest.mark.parametrize(("depth", "freed"), [(0.031, True), (0.033, False)])
def test_cuts_deeper_than_three_hundredths_of_the_object_take_slivers_only(depth, freed):
    assert is_freed(on_top(depth, least=0.0)) is freed
    assert is_freed(on_top(depth, least=0.2))


@pytest.mark.parametrize(("depth", "freed"), [(0.098, True), (0.102, False)])
def test_no_cut_is_deeper_than_a_tenth_of_the_object(depth, freed):
    assert is_freed(on_top(depth)) is freed


@pytest.mark.parametrize(("left", "freed"), [(0.0009, False), (0.0011, True)])
def test_a_cut_leaves_a_millimetre_of_a_hull(left, freed):
    """A cut takes 2.5 mm more than the hulls overlap."""
    pair = on_top(0.02, 0.0225 + left, allowed=1.0)
    assert is_freed(pair) is freed


@pytest.mark.parametrize(("share", "dropped"), [(0.09, False), (0.11, True)])
def test_a_sliver_stays_where_a_cut_takes_less_than_a_tenth_of_the_other_hull(share, dropped):
    board = box((0, 0, 0), (1, 1, 0.0225 / share))
    done = relieve_pair(pair_of(board, box((0.4, 0.4, -0.1), (0.6, 0.6, 0.02)), sliver=True), 1e-3)
    assert done.reason == ""
    assert (done.hulls[1] == ()) is dropped


@pytest.mark.parametrize(("more", "level"), [(0.8e-5, True), (1.2e-5, False)])
def test_a_cut_runs_along_a_face_if_that_takes_a_hundredth_of_a_millimetre_more_at_most(more, level):
    """The lower edge of a roof crosses that of a board, beyond which it goes down by ``more`` (m)."""
    board, slope = box((0, 0, 0), (1, 1, 0.4)), more / 0.01
    ends = [(x, slope * x + 0.4 - 0.031) for x in (-0.01, 0.5)]
    roof = convex_hull(
        np.array([corner for x, z in ends for corner in ((x, 0.5, z), (x, 0.2, z + 0.3), (x, 0.8, z + 0.3))])
    )
    done = relieve_pair(pair_of(board, roof, least=0.0), 1e-3)
    assert done.reason == ""
    assert (box_bounds(done.hulls[0][0]) is not None) is level


@pytest.mark.parametrize(("places", "freed"), [(11, True), (12, False)])
def test_two_hulls_are_cut_at_eleven_places_at_most(places, freed):
    """A bar is pushed into a disc from all sides; the last of twelve rounds only finds that it is free."""
    turns = 2.0 * np.pi * np.arange(120) / 120
    disc = convex_hull(
        np.array([[0.3 * np.cos(turn), 0.3 * np.sin(turn), z] for turn in turns for z in (0.0, 0.01)])
    )
    bar = box((0.295, -0.01, -0.1), (0.5, 0.01, 0.1))
    poses = np.tile(np.eye(4), (places, 1, 1))
    poses[:, :3, :3] = rotation_about(np.array([0.0, 0.0, 1.0]), 2.0 * np.pi * np.arange(places) / 12)
    assert is_freed(pair_of(disc, bar, poses=poses)) is freed


def is_cleared(
    hulls: tuple[Hull, ...], wheel: Hull, *, sheets: bool = False, axis=(1.0, 0.0, 0.0), upper: float = 0.004
) -> bool:
    """Whether a drawer of some hulls is cut free of a wheel, which stays as it is; 1 m are the longest."""
    links = [
        Link(name=name, label=name, parts=(name,), visuals=(), hulls=own, inertial=None)
        for name, own in (("drawer", hulls), ("wheel", (wheel,)))
    ]
    joint = Joint(
        name="slide", type="prismatic", parent="wheel", child="drawer",
        origin=np.zeros(3), axis=np.array(axis), lower=0.0, upper=upper,
    )  # fmt: skip
    return clear_joints(links, [joint], sheets=sheets).residuals == ()


@pytest.mark.parametrize(
    ("share", "hidden", "cleared"),
    [(0.64, 0.0, True), (0.66, 0.0, False), (0.66, 0.1, True), (0.7, 0.1, False)],
)
def test_cuts_take_up_to_0_65_of_a_hull_and_what_is_hidden_at_rest(share, hidden, cleared):
    """A board of 40 mm that rises into a wheel; a cut leaves a gap of `MARGIN`."""
    depth, sunk = share * 0.04 - MARGIN, hidden * 0.04
    wheel = box((0, 0, 0.04 - sunk), (1, 1, 0.2))
    board = (box((0, 0, 0), (1, 1, 0.04)),)
    assert is_cleared(board, wheel, axis=(0.0, 0.0, 1.0), upper=depth - sunk) is cleared


def beside_a_box(volume: float, length: float = 0.2) -> tuple[Hull, Hull]:
    """A large box with a small one, of a share of the volume of both, that is deep in a wheel (`WHEEL`)."""
    width = np.sqrt(volume / (1.0 - volume) * 0.3 / length)
    return box((0, 0, -0.5), (1, 1, -0.2)), box((0.3, 0.3, 0.2), (0.3 + length, 0.3 + width, 0.2 + width))


WHEEL = box((0, 0, 0), (1, 1, 0.5))


@pytest.mark.parametrize(("share", "cleared"), [(0.019, True), (0.021, False)])
def test_a_hull_is_dropped_if_it_is_a_fiftieth_of_its_link(share, cleared):
    assert is_cleared(beside_a_box(share), WHEEL) is cleared


@pytest.mark.parametrize(("length", "cleared"), [(0.118, True), (0.122, False)])
def test_no_sheet_is_dropped_that_is_longer_than_0_12_of_the_object(length, cleared):
    assert is_cleared(beside_a_box(0.001, length), WHEEL, sheets=True) is cleared
    assert is_cleared(beside_a_box(0.001, length), WHEEL)


def post_above_a_wheel(share: float, slenderness: float = 8.0) -> tuple[tuple[Hull, ...], Hull]:
    """A post 0.4 m high, an end of which, with the gap that a cut leaves, is in a wheel below it."""
    width, depth = 0.4 / slenderness, share * 0.4 - MARGIN
    return (box((0.3, 0.3, 0), (0.3 + width, 0.3 + width, 0.4)),), box((0, 0, -0.2), (1, 1, depth))


@pytest.mark.parametrize(("share", "cleared"), [(0.117, True), (0.123, False)])
def test_deep_cuts_take_0_12_of_a_post(share, cleared):
    assert is_cleared(*post_above_a_wheel(share)) is cleared


@pytest.mark.parametrize(("slenderness", "cleared"), [(4.1, True), (3.9, False)])
def test_a_post_is_four_times_as_long_as_wide(slenderness, cleared):
    assert is_cleared(*post_above_a_wheel(0.1, slenderness)) is cleared
