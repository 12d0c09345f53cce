"""Laws of wheels: round about their axle, down to the floor, with room around them."""

import numpy as np
import pytest

from artigen.types import Asset, Joint, Part
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.solids import as_solid
from sim_export.geometry.wheels import fit_width, is_open, round_wheels
from sim_export.package import Mesh

BODY = ((-0.4, -0.4, -0.2), (0.4, 0.4, 0.5))


def box_mesh(low, high) -> Mesh:
    hull = box_hull(np.array(low, dtype=float), np.array(high, dtype=float))
    return Mesh(vertices=hull.vertices, faces=hull.faces)


def cart(label: str = "wheel", half: float = 0.09, steep: float = 0.0):
    """A body on one wheel of 0.1 m whose mesh is a block of this half width; 2 metres per unit.

    ``steep`` is the vertical component of its axle.
    """
    box = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    axis = np.array([0.0, np.sqrt(1.0 - steep**2), steep])
    axle = Joint(type="continuous", axis=axis, origin=np.array([0.0, 0.0, -0.1]), upper=6.28318)
    fixed = Joint(type="fixed", axis=np.array([0.0, 0.0, 1.0]), origin=np.zeros(3))
    parts = (
        Part(name="base", label="base", parent=-1, box=box, joint=fixed),
        Part(name="wheel_0", label=label, parent=0, box=box, joint=axle),
    )
    asset = Asset(name="cart", category="Cart", scale=2.0, parts=parts)
    wheel = box_mesh((-half, -0.05, -0.3), (half, 0.05, -0.1))
    turn = np.array([[1.0, 0.0, 0.0], [0.0, axis[1], -steep], [0.0, steep, axis[1]]])
    turned = (wheel.vertices - [0.0, 0.0, -0.2]) @ turn.T + [0.0, 0.0, -0.2]
    return asset, (box_mesh(*BODY), Mesh(vertices=turned, faces=wheel.faces))


def test_a_block_becomes_a_cylinder_that_stands_on_the_floor():
    asset, meshes = cart()
    (body, wheel), records = round_wheels(asset, meshes)
    middle = wheel.vertices - [0.0, 0.0, -0.2]
    np.testing.assert_allclose(np.linalg.norm(middle[:, [0, 2]], axis=1), 0.1, atol=1e-9)
    assert wheel.vertices[:, 2].min() == pytest.approx(-0.3)
    assert np.ptp(wheel.vertices[:, 1]) == pytest.approx(0.1)
    assert (as_solid(body) ^ as_solid(wheel)).volume() == 0.0
    assert as_solid(body).volume() < as_solid(meshes[0]).volume()
    assert "wheel_0: became a cylinder of 200.0 mm about its axle" in records
    assert "base: makes room for wheel_0" in records


def test_a_wheel_has_twenty_four_sides():
    asset, meshes = cart()
    (_, wheel), _ = round_wheels(asset, meshes)
    assert len(wheel.vertices) == 2 * 24


@pytest.mark.parametrize(("steep", "wheel"), [(0.49, True), (0.51, False)])
def test_a_wheel_on_an_axle_steeper_than_thirty_degrees_is_a_swivel(*, steep: float, wheel: bool):
    asset, meshes = cart(steep=steep)
    rounded, _ = round_wheels(asset, meshes)
    assert (rounded[1] is not meshes[1]) == wheel


def test_other_parts_keep_their_meshes():
    asset, meshes = cart(label="knob")
    rounded, records = round_wheels(asset, meshes)
    assert rounded[1] is meshes[1]
    assert records == ()


@pytest.mark.parametrize(
    ("half", "diameter"),
    [(0.048, 200.0), (0.045, None), (0.106, 200.0), (0.109, 295.8)],
    ids=["much of a wheel", "too little", "near the floor", "too large for it"],
)
def test_a_block_becomes_a_wheel_if_it_holds_three_fifths_of_one(half: float, diameter: float | None):
    """Of the radius to the floor, if that is a voxel and a half from its own."""
    asset, meshes = cart(half=half)
    rounded, records = round_wheels(asset, meshes)
    assert (rounded[1] is meshes[1]) == (diameter is None)
    made = [record for record in records if record.startswith("wheel_0")]
    assert made == (
        [] if diameter is None else [f"wheel_0: became a cylinder of {diameter} mm about its axle"]
    )


def test_a_body_makes_three_millimetres_of_room():
    """The upper half of a prism of 24 sides around the axle, which lies in the body's lower face."""
    asset, meshes = cart()
    (body, _), _ = round_wheels(asset, meshes)
    well = 0.106 * 6 * np.sin(np.pi / 12) * 0.103**2
    assert as_solid(meshes[0]).volume() - as_solid(body).volume() == pytest.approx(well, rel=1e-3)


def ring(outer: float, inner: float, width: float, sides: int = 96) -> np.ndarray:
    """Triangles of a rim about y."""
    angles = 2.0 * np.pi * np.arange(sides + 1) / sides
    turn = np.column_stack([np.cos(angles), np.zeros_like(angles), np.sin(angles)])
    loop = [
        (outer, -width / 2),
        (outer, width / 2),
        (inner, width / 2),
        (inner, -width / 2),
        (outer, -width / 2),
    ]
    grid = np.stack([radius * turn + [0.0, y, 0.0] for radius, y in loop])
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    return np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)


@pytest.mark.parametrize(("slack", "opened"), [(0.9, True), (1.1, False)])
def test_a_wheel_is_open_where_its_cylinder_is_farther_from_it_than_v103_allows(slack, opened):
    """The middle of a cylinder is the hole's radius from its rim; 99 % of its faces are nearly there."""
    inner, axle = (
        0.06,
        Joint(type="continuous", axis=np.array([0.0, 1.0, 0.0]), origin=np.zeros(3), upper=6.28),
    )
    rim = ring(0.1, inner, 0.02)
    cylinder = fit_width(box_mesh((-0.07, -0.05, -0.07), (0.07, 0.05, 0.07)), axle, 2.0, rim)
    np.testing.assert_allclose(cylinder.vertices[:, 1].min(), -0.01)  # as wide as the rim, not as the cells
    np.testing.assert_allclose(cylinder.vertices[:, 1].max(), 0.01)
    sides = np.pi * 0.2 * 0.02
    farther = 0.01 * (sides + 2.0 * np.pi * 0.1**2) / (2.0 * np.pi)  # one hundredth lies nearer to the axle
    farthest = inner - np.sqrt(farther)
    assert is_open(rim, cylinder, slack * farthest / 0.015) == opened
