"""How finely V203 looks where a drawer goes, and which doors are a pair for V205."""

from pathlib import Path

import numpy as np
import pytest
from cabinet_files import box_visual, joint, link, urdf

from artigen.transforms import thin_direction
from sim_export.checks.config import CheckConfig
from sim_export.checks.opening import check_opening, has_pairs
from sim_export.checks.subject import Subject


def felt(size: object, xyz: object) -> str:
    """A box that is felt, about a place."""
    return box_visual(size, xyz).replace("visual", "collision")


def write_drawer(folder: Path, share: float) -> Subject:
    """Two boards and, before a block of the body, a cube with this share of the drawer's surface."""
    board = 2.0 * (1.0 + 0.02 + 0.02)
    edge = np.sqrt(2.0 * board * share / (1.0 - share) / 6.0)
    boards = [felt((0.02, 1.0, 1.0), (0.0, y, 0.0)) for y in (-1.0, 1.0)]
    drawer = link("drawer", boards[0], felt((edge, edge, edge), (0.0, 0.0, 0.0)), boards[1])
    body = link("body", felt((0.1, 0.6, 0.6), (-0.5, 0.0, 0.0)))
    slide = joint("prismatic", "body", "drawer", axis=(-1, 0, 0), limits=(0.0, 0.7))
    (folder / "mobility.urdf").write_text(urdf(body, drawer, slide))
    (folder / "semantics.txt").write_text("body static body\ndrawer slider drawer\n")
    return Subject(folder)


@pytest.mark.parametrize(("lines", "passed"), [(8.6, True), (9.4, False)])
def test_eight_of_400_sight_lines_may_be_blocked_and_ten_may_not(tmp_path, lines, passed):
    """They spread evenly over the surface; four begin in each half of the cube, or five."""
    assert check_opening(write_drawer(tmp_path, lines / 400), CheckConfig()).passed is passed


def write_pair(
    folder: Path, gap: float = 0.0, rise: float = 0.0, inset: float = 0.0, lean: float = 0.0
) -> Subject:
    """Two doors 0.5 m wide: the gap between them, how much higher the second is and how far its hinge is from
    its edge (m); and how far both hinges lean towards the other door (degrees)."""
    axis = np.array([0.0, np.sin(np.radians(lean)), np.cos(np.radians(lean))])
    rows = [link("body")]
    doors = (("left", -0.25, 0.0, -0.5, 1.0), ("right", 0.25 + gap, rise, 0.5 + gap - inset, -1.0))
    for name, middle, height, hinge, sign in doors:
        about = (0.0, hinge, height)
        rows.append(link(name, felt((0.02, 0.5, 1.0), (0.0, middle - hinge, 0.0))))
        rows.append(joint("revolute", "body", name, xyz=about, axis=sign * axis, limits=(0.0, 1.0)))
    (folder / "mobility.urdf").write_text(urdf(*rows))
    (folder / "semantics.txt").write_text("left hinge door\nright hinge door\n")
    return Subject(folder)


@pytest.mark.parametrize(("given", "within", "beyond"), [
    ("gap", 0.0495, 0.0505),  # a tenth of a width
    ("rise", 0.0707, 0.0717),  # the line between their middles is 8.1 degrees off
    ("inset", 0.0904, 0.0914),  # a tenth of what is then between the hinges
    ("lean", 4.95, 5.05),
])  # fmt: skip
def test_doors_are_a_pair_if_they_are_side_by_side_and_mirrored(tmp_path, given, within, beyond):
    assert not has_pairs(write_pair(tmp_path, **{given: within}))
    assert has_pairs(write_pair(tmp_path, **{given: beyond}))


@pytest.mark.parametrize(("depth", "slanted"), [(0.49, False), (0.51, True)])
def test_a_plate_that_is_half_as_deep_as_wide_faces_where_its_slant_does(depth, slanted):
    """And a flatter one along the axis, so that a bevel does not turn a door's front."""
    slope = depth - 0.02
    corners = [(slope * y + x, y, z) for x in (-0.01, 0.01) for y in (-0.5, 0.5) for z in (-1.0, 1.0)]
    normal = thin_direction(np.array(corners))
    expected = np.array([1.0, -slope * slanted, 0.0])
    assert abs(normal @ expected) / np.linalg.norm(expected) == pytest.approx(1.0, abs=1e-3)
