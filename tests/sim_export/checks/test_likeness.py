"""How finely V103 looks at two surfaces, and which links it blames.

The packages are plates of 1 m and sheets that are seen; the diagonal is 1.4 m or a little more.
"""

from pathlib import Path

import numpy as np
import pytest
from cabinet_files import box_visual, join, joint, link, urdf

from sim_export.checks.config import CheckConfig
from sim_export.checks.likeness import check_likeness
from sim_export.checks.registry import Finding
from sim_export.checks.subject import Subject

HOVER = 0.08
"""Height (m) above a plate: 5 % of the diagonal and more."""


def felt(size: object, xyz: object) -> str:
    """A box that is felt, about a place."""
    return box_visual(size, xyz).replace("visual", "collision")


def plate(name: str, size: float, *others: str, about: tuple[float, float] = (0.0, 0.0)) -> str:
    """A link: a square of this edge, a fiftieth as thick, that is felt; seen is a file of the same name."""
    xyz = (*about, 0.0)
    mesh = f'<visual><origin xyz="{join(xyz)}"/><geometry><mesh filename="{name}.obj"/></geometry></visual>'
    return link(name, mesh, felt((size, size, 0.02 * size), xyz), *others)


def sheets(size: float, hovering: float) -> str:
    """An OBJ: a plate's lower side, a triangle of this area (m2) above its middle, and its upper side."""
    half, leg = size / 2.0, np.sqrt(2.0 * hovering)
    square = np.array([[-half, -half], [half, -half], [half, half], [-half, half]])
    flat = [square, [[0.0, 0.0], [leg, 0.0], [0.0, leg]], square]
    heights = (-0.01 * size, HOVER, 0.01 * size)
    rows = [f"v {join((*xy, z))}" for corners, z in zip(flat, heights, strict=True) for xy in corners]
    return "\n".join([*rows, "f 1 3 2", "f 1 4 3", "f 5 6 7", "f 8 9 10", "f 8 10 11"]) + "\n"


def judge(folder: Path, *elements: str, **meshes: str) -> Finding:
    """V103 of a package of these links, whose visuals are a source's."""
    (folder / "mobility.urdf").write_text(urdf(*elements))
    for name, text in meshes.items():
        (folder / f"{name}.obj").write_text(text)
    return check_likeness(Subject(folder), CheckConfig())


def covering(points: float, count: int, size: float) -> float:
    """Area (m2) that, beside both sides of a plate, takes so many of a number of evenly spread points."""
    return 2.0 * size**2 / (count / points - 1.0)


@pytest.mark.parametrize(("points", "passed"), [(0.98, True), (1.02, False)])
def test_what_takes_a_point_of_8000_is_met(tmp_path, points, passed):
    """A plate alone has all 8,000, and the 64 that every link has in any case."""
    seen = sheets(1.0, covering(points, 8064, 1.0))
    assert judge(tmp_path, plate("board", 1.0), board=seen).passed is passed


@pytest.mark.parametrize(("points", "passed"), [(0.98, True), (1.02, False)])
def test_the_smallest_link_has_64_points_of_its_own(tmp_path, points, passed):
    """The button has 1.5 of 8,000 parts of all surface: two points, rounded up, and 64."""
    edge = np.sqrt(1.5 / 8000)
    button = sheets(edge, covering(points, 66, edge))
    found = judge(
        tmp_path,
        plate("board", 1.0),
        plate("button", edge, about=(0.6, 0.0)),
        joint("fixed", "board", "button"),
        board=sheets(1.0, 0.0),
        button=button,
    )
    assert found.passed is passed


@pytest.mark.parametrize(("points", "passed"), [(1.02, True), (0.98, False)])
def test_what_is_felt_finds_what_takes_a_point_of_32000(tmp_path, points, passed):
    """The surface that distances are measured to has four times as many points."""
    knob = felt((0.02, 0.02, 0.02), (0.0, 0.0, HOVER))
    seen = sheets(1.0, covering(points, 4 * 8064, 1.0))
    assert judge(tmp_path, plate("board", 1.0, knob), board=seen).passed is passed


@pytest.mark.parametrize(("share", "named"), [(0.21, "board, lid"), (0.19, "board")])
def test_who_has_a_fifth_of_what_is_far_off_is_named(tmp_path, share, named):
    found = judge(
        tmp_path,
        plate("board", 1.0),
        plate("lid", 1.0, about=(1.2, 0.0)),
        joint("fixed", "board", "lid"),
        board=sheets(1.0, 0.1 * (1.0 - share)),
        lid=sheets(1.0, 0.1 * share),
    )
    assert not found.passed
    assert found.where == named
