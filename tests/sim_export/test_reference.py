"""Packages straight from procedural objects: exact volumes, masses, joints, needs, and static checks."""

from pathlib import Path

import numpy as np
import pytest

from artigen.shapes.draw import draw_shape
from artigen.shapes.fittings.hardware import rotate, slide
from artigen.shapes.primitives import box, cylinder, line, place_vertices, rounded_box
from artigen.shapes.shape import Need, Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.splats.faces import lay_gaussians
from sim_export.checks.suite import run_checks
from sim_export.files.write import package_files, write_package
from sim_export.geometry.primitives import find_primitive
from sim_export.geometry.triangles import find_slivers, triangle_normals
from sim_export.package import Mesh
from sim_export.physics.inertia import is_closed, mesh_inertial
from sim_export.physics.materials import MATERIALS, finish_material
from sim_export.reference import ReferenceConfig, build_reference

FINISHES = (
    ("rubber", Finish(kind="rubber", color=(0.1, 0.1, 0.1), accent=(0.1, 0.1, 0.1))),
    ("steel", Finish(kind="steel", color=(0.7, 0.7, 0.7), accent=(0.6, 0.6, 0.6))),
    ("white", Finish(kind="lacquer", color=(0.9, 0.9, 0.9), accent=(0.9, 0.9, 0.9))),
    ("wood", Finish(kind="wood", color=(0.6, 0.4, 0.2), accent=(0.4, 0.2, 0.1))),
)


def boards(*ends: tuple) -> tuple:
    return tuple(rounded_box(low, high, 0.002, "wood") for low, high in ends)


def cupboard() -> Shape:
    """A carcass with a door, and behind it a tray that needs the door open."""
    walls = boards(
        ((-0.2, -0.3, 0.0), (0.2, -0.28, 0.5)),
        ((-0.2, 0.28, 0.0), (0.2, 0.3, 0.5)),
        ((0.18, -0.28, 0.0), (0.2, 0.28, 0.5)),
        ((-0.2, -0.28, 0.48), (0.18, 0.28, 0.5)),
        ((-0.2, -0.28, 0.0), (0.18, 0.28, 0.02)),
    )
    body = ShapePart(
        name="body",
        label="base",
        parent=None,
        primitives=tuple(line(wall, "white", (-1, 0, 0)) for wall in walls),
    )
    door = ShapePart(
        name="door",
        label="door",
        parent="body",
        primitives=boards(((-0.222, -0.3, 0.0), (-0.202, 0.3, 0.5))),
        joint=rotate((0.0, 0.0, -1.0), (-0.222, 0.3, 0.0), 1.6),
    )
    grip = ShapePart(
        name="grip",
        label="handle",
        parent="door",
        primitives=(
            cylinder((-0.27, -0.25, 0.2), (-0.27, -0.25, 0.34), 0.008, "steel"),
            cylinder((-0.222, -0.25, 0.22), (-0.27, -0.25, 0.22), 0.006, "steel"),
            cylinder((-0.222, -0.25, 0.32), (-0.27, -0.25, 0.32), 0.006, "steel"),
        ),
    )
    tray = ShapePart(
        name="tray",
        label="tray",
        parent="body",
        primitives=boards(
            ((-0.18, -0.25, 0.022), (0.16, 0.25, 0.032)),
            ((-0.18, -0.25, 0.032), (-0.17, 0.25, 0.1)),
        ),
        joint=slide(0.25),
        needs=(Need(part="door"),),
    )
    return Shape(
        category="StorageFurniture",
        seed=3,
        style="plain",
        parts=(body, door, grip, tray),
        finishes=FINISHES,
    )


@pytest.fixture(scope="module")
def package():
    return build_reference(cupboard(), provenance={"generator": "test"})


def test_every_static_check_passes(package, tmp_path):
    write_package(package, tmp_path / "cupboard")
    results = run_checks(tmp_path / "cupboard")
    assert [f"{result.id}: {result.message}" for result in results if result.verdict == "fail"] == []
    assert sum(result.verdict == "pass" for result in results) > 15


def test_hulls_are_the_boxes_of_bevelled_boards_and_the_record_says_so(package):
    shape = cupboard()
    low, high = shape.bounds()
    for link in package.links:
        parts = [part for name in link.parts for part in shape.parts if part.name == name]
        expected = [place_vertices(p) - (low + high) / 2 for part in parts for p in part.primitives]
        assert len(link.hulls) == len(expected)
        for hull, vertices in zip(link.hulls, expected, strict=True):
            assert find_primitive(hull) is not None
            for measure in (np.min, np.max):
                assert np.abs(measure(hull.vertices, axis=0) - measure(vertices, axis=0)).max() < 1e-12
    assert any(record.startswith("body: 5 of 5 hulls are boxes or cylinders") for record in package.records)


def test_joints_are_in_metres_and_the_tray_needs_the_door(package):
    joints = {joint.child: joint for joint in package.joints}
    by_part = {link.parts[0]: joints[link.name] for link in package.links if link.name in joints}
    assert by_part["tray"].upper == pytest.approx(0.25)
    assert by_part["door"].upper == pytest.approx(1.6)
    assert by_part["tray"].friction > 0.0
    (need,) = package.requires_open
    assert (need.joint, need.needs, need.fraction) == (by_part["tray"].name, by_part["door"].name, 0.95)
    (handle,) = package.handles
    assert handle.part == "grip"
    assert handle.clearance == pytest.approx(0.04, abs=0.005)


def two_pieces(first: str, second: str) -> Shape:
    """A cube of 20 cm and one beside it that overlaps it by a half."""
    body = ShapePart(
        name="body",
        label="base",
        parent=None,
        primitives=(
            box((0.0, 0.0, 0.0), (0.2, 0.2, 0.2), first),
            box((0.1, 0.0, 0.0), (0.3, 0.2, 0.2), second),
        ),
    )
    return Shape(category="Thing", seed=0, style="plain", parts=(body,), finishes=FINISHES)


def test_mass_is_that_of_the_union():
    link = build_reference(two_pieces("wood", "wood")).links[-1]
    assert link.inertial is not None
    assert link.inertial.mass == pytest.approx(MATERIALS["wood_board"].density * 0.3 * 0.04)
    assert np.allclose(link.inertial.com, 0.0)


def test_two_materials_share_the_volume_and_nothing_twice():
    link = build_reference(two_pieces("wood", "rubber")).links[-1]
    rubber, wood = MATERIALS["rubber"].density * 0.2 * 0.04, MATERIALS["wood_board"].density * 0.1 * 0.04
    assert link.inertial is not None
    assert link.inertial.mass == pytest.approx(rubber + wood)
    assert link.inertial.com[0] == pytest.approx((0.05 * rubber - 0.1 * wood) / (rubber + wood))


def test_plates_weigh_what_sheet_and_panes_do():
    sheet, bar = (0.5, 0.6, 0.011), (0.5, 0.011, 0.011)
    for turned in (sheet, sheet[::-1]):
        assert finish_material("steel", "tray", "Oven", turned) == "steel_sheet"
        assert finish_material("rubber", "tray", "Oven", turned) == "steel_sheet"
        assert finish_material("glass", "door", "Oven", turned) == "glass"
    assert finish_material("steel", "tray", "Oven", bar) == "steel"
    assert finish_material("lacquer", "drawer", "Cart", bar) == "steel_sheet"
    assert finish_material("lacquer", "base", "Cart", bar) == "steel"
    assert finish_material("glass", "door", "Refrigerator", (0.031, 0.5, 1.7)) == "insulating_glass"
    # Two panes of four millimetres weigh 20 kg a square metre.
    assert 15.0 < MATERIALS["insulating_glass"].bulk * 0.031 < 30.0


def test_visuals_close_hold_the_volume_and_show_every_finish(package):
    shape = cupboard()
    parts: dict[str, list[Mesh]] = {}
    for visual in (visual for link in package.links for visual in link.visuals):
        parts.setdefault(visual.part, []).append(visual.mesh)
    for meshes in parts.values():
        triangles = np.concatenate([mesh.vertices[mesh.faces] for mesh in meshes])
        _, faces = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
        assert is_closed(faces.reshape(-1, 3))
        slivers = find_slivers(triangles, 1e-4)
        assert np.count_nonzero(slivers) <= np.ceil(0.01 * len(slivers))
    volume = 2 * 0.4 * 0.02 * 0.5 + 0.02 * 0.56 * 0.5 + 2 * 0.38 * 0.56 * 0.02
    triangles = np.concatenate([mesh.vertices[mesh.faces] for mesh in parts["body"]])
    corners, faces = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    body = Mesh(vertices=corners, faces=faces.reshape(-1, 3))
    assert mesh_inertial(body, 1.0).mass == pytest.approx(volume, rel=2e-3)  # edges are bevelled
    shown = {visual.finish for link in package.links for visual in link.visuals if visual.part == "body"}
    assert "white" in shown, "one side is lined in white, the others are wood"
    assert len(shown) == 2
    assert shape.parts[0].primitives[0].lining == "white"


@pytest.mark.parametrize("is_round", [False, True])
def test_an_oblong_rod_is_cut_and_a_record_says_so_but_a_box_is_not(is_round):
    """Engines cook cylinders like any hull; a box of any length is exact in all of them."""
    solid = box((0, 0, 0), (0.004, 0.004, 0.5), "steel")
    if is_round:
        solid = cylinder((0, 0, 0), (0, 0, 0.5), 0.002, "steel")
    rod = ShapePart(name="rod", label="base", parent=None, primitives=(solid,))
    package = build_reference(Shape(category="Thing", seed=0, style="plain", parts=(rod,), finishes=FINISHES))
    hulls = package.links[-1].hulls
    assert len(hulls) == (3 if is_round else 1)
    assert all(find_primitive(hull) is not None for hull in hulls)
    heights = [np.ptp(hull.vertices[:, 2]) for hull in hulls]
    assert sum(heights) == pytest.approx(0.5)
    assert any("oblong" in record for record in package.records) == is_round


def test_broken_edges_of_a_banded_board_have_the_finish_of_the_band():
    """A white board with a wooden band on its front edge, and a wooden one that is white on one face."""
    banded = line(box((0.0, 0.0, 0.0), (0.4, 0.02, 0.3), "white"), "wood", (-1, 0, 0))
    faced = line(box((0.0, 0.5, 0.0), (0.4, 0.52, 0.3), "wood"), "white", (0, -1, 0))
    shape = Shape(
        category="Wardrobe",
        style="",
        seed=0,
        parts=(ShapePart("body", "base", (banded, faced), parent=None),),
        finishes=FINISHES,
    )
    for visual in build_reference(shape).links[0].visuals:
        corners = visual.mesh.vertices[visual.mesh.faces]
        first = corners.mean(axis=1)[:, 1] < 0.0
        normals = triangle_normals(corners)
        if visual.mesh.material.name.startswith("lacquer"):
            assert normals[first, 0].min() > -1e-3
            np.testing.assert_allclose(
                normals[~first], np.tile([0.0, -1.0, 0.0], ((~first).sum(), 1)), atol=1e-6
            )
        else:
            assert normals[first, 0].max() < -0.2


@pytest.mark.slow
def test_gaussians_add_a_file_per_link_and_change_no_mesh():
    shape = draw_shape("Oven", 0)
    plain, shown = (build_reference(shape, ReferenceConfig(gaussians=wanted)) for wanted in (False, True))
    files, known = package_files(shown), package_files(plain)
    assert {Path(name).suffix for name in set(files) - set(known)} == {".ply"}
    changed = {name for name in known if files[name] != known[name]}
    assert not {name for name in changed if name.endswith((".obj", ".png", ".mtl"))}
    held = [0 if link.splats is None else len(link.splats.means) for link in shown.links]
    assert sum(held) == len(lay_gaussians(shape).means)
    assert all(count for count, link in zip(held, shown.links, strict=True) if link.parts)
