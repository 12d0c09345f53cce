"""Walls weigh, cavities do not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from artigen.kind import PLAIN, make
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.primitives import place_vertices
from artigen.types import FIXED, Asset, Part, VoxelGrid
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.meshing import mesh_parts, solid_parts
from sim_export.geometry.occupancy import part_occupancy
from sim_export.package import Inertial, Link
from sim_export.physics.inertia import check_inertial, combine
from sim_export.physics.makes import fill_base, find_make, wall_density
from sim_export.physics.masses import cells_inertial, hold_centers, subtract, weigh_part
from sim_export.physics.materials import MATERIALS, part_material
from sim_export.reference import build_reference, weigh_shape


def hollow_box(shape=(20, 24, 30), resolution=32) -> Asset:
    """A closed box of one-cell walls, 1 m wide in the grid."""
    solid = np.zeros((resolution,) * 3, dtype=bool)
    inside = solid.copy()
    solid[tuple(slice(1, 1 + n) for n in shape)] = True
    inside[tuple(slice(2, n) for n in shape)] = True
    coords = np.argwhere(solid & ~inside)
    center = (1 + np.array(shape) / 2) / resolution - 0.5
    part = Part(
        name="box", label="base", parent=-1, joint=FIXED, box=np.stack([center, np.array(shape) / resolution])
    )
    grid = VoxelGrid(resolution=resolution, coords=coords, part_ids=np.zeros(len(coords), dtype=np.int16))
    return Asset(name="hollow", category="StorageFurniture", scale=1.0, parts=(part,), voxels=grid)


def test_a_closed_shell_weighs_its_walls():
    asset = hollow_box()
    (mesh,) = mesh_parts(asset)
    walls = weigh_part(asset, 0, mesh, part_occupancy(asset.voxels, 0))
    size = np.array([20, 24, 30]) / 32
    volume = np.prod(size) - np.prod(size - 2 / 32)
    assert walls.mass == pytest.approx(MATERIALS["wood_board"].density * volume, rel=1e-6)
    check_inertial(walls, "shell")


def test_subtracting_undoes_adding():
    rng = np.random.default_rng(0)
    cells = rng.random((8, 8, 8)) < 0.3
    other = rng.random((8, 8, 8)) < 0.3
    a, b = cells_inertial(cells, 0.1, 500.0), cells_inertial(other, 0.1, 300.0)
    back = subtract(combine([a, b]), b)
    assert back.mass == pytest.approx(a.mass)
    np.testing.assert_allclose(back.com, a.com, atol=1e-12)
    np.testing.assert_allclose(back.inertia, a.inertia, atol=1e-9)


def test_cells_of_a_block_have_the_inertia_of_the_block():
    cells = np.zeros((8, 8, 8), dtype=bool)
    cells[2:6, 1:4, 3:5] = True
    block = cells_inertial(cells, 0.5, 2.0)
    x, y, z = 2.0, 1.5, 1.0
    assert block.mass == pytest.approx(2.0 * x * y * z)
    expected = block.mass / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y])
    np.testing.assert_allclose(block.inertia, expected, atol=1e-12)


def test_an_asset_without_voxels_cannot_be_weighed():
    asset = hollow_box()
    (mesh,) = mesh_parts(asset)
    with pytest.raises(ValueError, match="no voxels"):
        weigh_part(replace(asset, voxels=None), 0, mesh, part_occupancy(asset.voxels, 0))


@pytest.mark.parametrize(("label", "category"), [("handle", "Table"), ("tray", "Oven"), ("shelf", "Oven")])
def test_steel_weighs_what_a_hollow_bar_or_a_rack_does_however_thick_its_voxels_are(
    label: str, category: str
):
    cells = np.zeros((32, 32, 32), dtype=bool)
    cells[4:28, 4:28, 10:12] = True  # a plate of 0.75 m by 0.75 m, 6 cm thick
    coords = np.argwhere(cells)
    part = Part(
        name="plate", label=label, parent=-1, joint=FIXED,
        box=np.array([[0.0, 0.0, 11 / 32 - 0.5], [0.75, 0.75, 2 / 32]]),
    )  # fmt: skip
    grid = VoxelGrid(resolution=32, coords=coords, part_ids=np.zeros(len(coords), dtype=np.int16))
    asset = Asset(name="plate", category=category, scale=1.0, parts=(part,), voxels=grid)
    (mesh,) = mesh_parts(asset)
    steel = MATERIALS["steel"]
    area = 2 * 0.75**2 + 4 * 0.75 * 2 / 32
    weight = weigh_part(asset, 0, mesh, part_occupancy(grid, 0)).mass
    assert weight == pytest.approx(steel.bulk * steel.thickest * area / 2, rel=1e-6)


def test_a_body_with_known_walls_weighs_as_much_as_these_all_over():
    """A closed box of vitreous china: real walls of 11 mm instead of the solid between its faces."""
    asset = replace(hollow_box(), category="Toilet")
    (mesh,) = mesh_parts(asset)
    walls = weigh_part(asset, 0, mesh, part_occupancy(asset.voxels, 0))
    x, y, z = np.array([20, 24, 30]) / 32
    area = 2 * (x * y + y * z + z * x)
    assert part_material("base", "Toilet") == "stone"
    thickness = find_make("Toilet").wall["stone"]
    assert walls.mass == pytest.approx(MATERIALS["stone"].density * thickness * area / 2)
    np.testing.assert_allclose(walls.com, asset.parts[0].box[0], atol=1e-9)


@pytest.mark.parametrize("thickness", [0.0005, 0.00399, 0.004, 0.00401, 0.02])
def test_walls_drawn_too_thick_weigh_per_area_what_real_ones_do(thickness: float):
    made = make(density={"plastic": 900.0}, wall={"plastic": 0.004})
    per_area = wall_density(made, "plastic", thickness) * thickness
    assert per_area == pytest.approx(900.0 * min(thickness, 0.004))
    assert wall_density(made, "rubber", thickness) == MATERIALS["rubber"].density


def test_what_is_hidden_in_a_base_adds_its_mass_and_moves_no_centre():
    drawn = cells_inertial(np.ones((4, 6, 8), dtype=bool), 0.1, 50.0)
    box = np.array([[-0.2, -0.3, -0.4], [0.2, 0.3, 0.4]])
    full = fill_base(make(hidden=3.0, filled=20.0), drawn, box)
    assert full.mass == pytest.approx(drawn.mass + 3.0 + 20.0 * 0.4 * 0.6 * 0.8)
    np.testing.assert_array_equal(full.com, drawn.com)
    np.testing.assert_allclose(full.inertia / full.mass, drawn.inertia / drawn.mass)
    check_inertial(full, "base")


def test_a_style_has_its_own_make_or_that_of_its_kind():
    assert find_make("FilingCabinet", "pedestal").hidden > find_make("FilingCabinet", "vertical").hidden
    assert find_make("Toilet", "skirted") is find_make("Toilet")
    assert find_make("Spaceship") is PLAIN


def test_a_package_weighs_what_its_shape_does():
    for category in ("Box", "WashingMachine", "Toilet"):
        shape = draw_shape(category, 3)
        links = build_reference(shape).links
        mass = sum(link.inertial.mass for link in links if link.inertial is not None)
        assert mass == pytest.approx(weigh_shape(shape), rel=1e-3)  # packages make small parts heavier


@pytest.mark.parametrize("seed", range(3))
def test_the_wheel_of_a_wheelbarrow_is_as_heavy_as_one_with_air(seed: int):
    shape = draw_shape("Cart", seed, Wish(style="wheelbarrow"))
    by_part = {link.parts[0]: link.inertial.mass for link in build_reference(shape).links}
    assert 2.0 < by_part["wheel"] < 4.5  # 16 inches, on a steel rim
    make = find_make("Cart", "wheelbarrow")
    rubber, steel = make.density["rubber"], make.density["steel"]
    tyre, core = next(part for part in shape.parts if part.name == "wheel").primitives
    solids = [ConvexHull(place_vertices(piece)).volume for piece in (tyre, core)]
    assert rubber * solids[0] < by_part["wheel"] < rubber * solids[0] + steel * solids[1]


@pytest.mark.parametrize(("above", "moves"), [(-0.01, False), (0.0057, True), (0.0059, False)])
def test_a_centre_of_mass_just_outside_of_the_collision_is_moved_into_it(above: float, *, moves: bool):
    hull = box_hull(np.zeros(3), np.array([0.1, 0.1, 0.1]))
    inertial = Inertial(mass=1.0, com=np.array([0.05, 0.05, 0.1 + above]), inertia=np.eye(3))
    link = Link(name="link_0", label=None, parts=(), visuals=(), hulls=(hull,), inertial=inertial)
    (held,), records = hold_centers((link,))
    assert bool(records) == moves
    assert (held is not link) == moves
    if moves:
        assert held.inertial.com[2] == pytest.approx(0.0998)


@pytest.mark.parametrize("seed", [1000, 1001])
def test_the_foot_of_a_lamp_made_of_voxels_outweighs_its_other_parts(seed: int):
    shape = draw_shape("DeskLamp", seed)
    asset = shape_to_asset(shape)
    solids = solid_parts(asset)
    masses = [
        weigh_part(asset, index, mesh, solids[index]).mass
        for index, mesh in enumerate(mesh_parts(asset, solids))
    ]
    assert masses[asset.root] == max(masses)
    assert masses[asset.root] > weigh_shape(shape) / 3.0
