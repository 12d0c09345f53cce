"""What the checks measure with: grids, cavities, distances, rays, topology; and broken folders."""

import json
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from project import ROOT
from sample_packages import write_samples

from artigen.transforms import rotation_about
from sim_export.checks.config import CheckConfig
from sim_export.checks.files import distance_outside
from sim_export.checks.geometry import count_open_edges, euler_numbers
from sim_export.checks.opening import hit_hulls
from sim_export.checks.registry import CheckSpec, always, run_check
from sim_export.checks.subject import Subject
from sim_export.checks.suite import CHECKS, run_checks
from sim_export.checks.sweep import open_positions
from sim_export.geometry.contacts import HullSet
from sim_export.geometry.distances import surface_distances, triangle_distances
from sim_export.geometry.grid import fill_solid, find_cavity, make_grid, mark_surface, open_with_cube
from sim_export.geometry.hulls import box_hull, convex_hull, inside_hulls
from sim_export.geometry.overlap import volume_samples
from sim_export.geometry.sampling import sample_triangles

BOX = box_hull(np.array([-0.3, -0.2, -0.1]), np.array([0.3, 0.2, 0.1]))
TILT = rotation_about(np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0), np.array(0.7))


@pytest.fixture(scope="module")
def cabinet_package(tmp_path_factory) -> Path:
    return write_samples(tmp_path_factory.mktemp("checks"))["cabinet"]


def triangles_of(mesh: trimesh.Trimesh) -> np.ndarray:
    return np.asarray(mesh.triangles, dtype=np.float64)


def open_box(wall: float = 0.05) -> np.ndarray:
    """Triangles of a box of one metre without a lid."""
    slabs = [
        ([0, 0, 0], [1, 1, wall]),
        ([0, 0, 0], [wall, 1, 1]),
        ([1 - wall, 0, 0], [1, 1, 1]),
        ([0, 0, 0], [1, wall, 1]),
        ([0, 1 - wall, 0], [1, 1, 1]),
    ]
    hulls = [box_hull(np.array(low, float), np.array(high, float)) for low, high in slabs]
    return np.concatenate([hull.vertices[hull.faces] for hull in hulls])


@pytest.mark.parametrize("turned", [False, True])
def test_filled_volume_is_the_closed_form(turned):
    torus = trimesh.creation.torus(0.3, 0.1, major_sections=48, minor_sections=24)
    triangles = triangles_of(torus) @ (TILT.T if turned else np.eye(3))
    grid = make_grid(np.stack([triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))]), 96)
    volume = fill_solid(triangles, grid).sum() * grid.cell**3
    assert volume == pytest.approx(torus.volume, rel=0.01)


def test_overlapping_shells_fill_their_union_once():
    a, b = (
        triangles_of(trimesh.creation.box((0.4, 0.4, 0.4)).apply_translation([x, 0, 0])) for x in (0.0, 0.2)
    )
    grid = make_grid(np.array([[-0.2, -0.2, -0.2], [0.4, 0.2, 0.2]]), 60)
    both = fill_solid(np.concatenate([a, b]), grid)
    assert (both == (fill_solid(a, grid) | fill_solid(b, grid))).all()
    assert both.sum() * grid.cell**3 == pytest.approx(0.6 * 0.4 * 0.4, rel=0.01)


def test_marked_surface_lets_no_step_through():
    from scipy.ndimage import label

    triangles = triangles_of(trimesh.creation.icosphere(subdivisions=3, radius=0.4)) @ TILT.T
    grid = make_grid(np.array([[-0.5] * 3, [0.5] * 3]), 40)
    wall = mark_surface(triangles, grid)
    regions, count = label(~wall)
    assert count == 2
    center = tuple(grid.cells_of(np.zeros((1, 3)))[0])
    assert regions[center] != regions[0, 0, 0] != 0


def test_cavity_of_an_open_box_is_its_inside():
    triangles = open_box()
    grid = make_grid(np.array([[0.0] * 3, [1.0] * 3]), 60)
    for wall in (fill_solid(triangles, grid), mark_surface(triangles, grid)):
        volume = find_cavity(wall, 3).sum() * grid.cell**3
        assert volume == pytest.approx(0.9 * 0.9 * 0.95, rel=0.08)


def test_closed_boxes_tables_and_slots_have_no_cavity():
    grid = make_grid(np.array([[0.0] * 3, [1.0] * 3]), 40)
    closed = triangles_of(trimesh.creation.box((0.8, 0.8, 0.8)).apply_translation([0.5] * 3))
    assert not find_cavity(mark_surface(closed, grid), 3).any()
    legs = [
        box_hull(np.array([x, y, 0.0]), np.array([x + 0.05, y + 0.05, 0.9]))
        for x in (0, 0.95)
        for y in (0, 0.95)
    ]
    top = box_hull(np.array([0, 0, 0.9]), np.ones(3))
    table = np.concatenate([hull.vertices[hull.faces] for hull in (*legs, top)])
    # Only the strips between two legs are walled in along two axes.
    assert find_cavity(fill_solid(table, grid), 3).mean() < 0.01
    assert not find_cavity(fill_solid(open_box(wall=0.48), grid), 3).any()


def test_opening_keeps_whole_cubes_only():
    cells = np.zeros((12, 12, 12), dtype=bool)
    cells[1:6, 1:6, 1:6] = True
    cells[3, 3, 6:11] = True
    opened = open_with_cube(cells, 4)
    assert opened.sum() == 5**3
    assert not opened[3, 3, 6:].any()
    assert not open_with_cube(cells, 6).any()


def test_triangle_distances_in_all_regions():
    triangle = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]) @ TILT.T
    points = np.array([[0.2, 0.2, 0.5], [-0.3, -0.4, 0.0], [0.5, -0.2, 0.0], [1.0, 1.0, 0.0]]) @ TILT.T
    expected = [0.5, 0.5, 0.2, np.sqrt(0.5)]
    assert triangle_distances(points, np.tile(triangle, (4, 1, 1))) == pytest.approx(expected)


def test_surface_distances_of_parallel_boxes():
    inner, outer = (triangles_of(trimesh.creation.box((s, s, s))) for s in (1.0, 1.1))
    points, _ = sample_triangles(inner, 500)
    measured = surface_distances(points, outer, 5000)
    assert measured.min() >= 0.05 - 1e-9
    assert measured.max() == pytest.approx(0.05, abs=1e-9)


def test_samples_spread_by_area():
    triangles = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [3, 0, 1], [0, 1, 1]]])
    points, owner = sample_triangles(triangles, 400)
    assert np.bincount(owner) == pytest.approx([100, 300], abs=1)
    assert points[owner == 0].mean(axis=0) == pytest.approx([1 / 3, 1 / 3, 0], abs=0.03)


def test_points_inside_hulls_agree_with_the_box():
    points = np.random.default_rng(3).uniform(-0.4, 0.4, (2000, 3))
    expected = (np.abs(points) <= [0.3, 0.2, 0.1]).all(axis=1)
    tilted = convex_hull(BOX.vertices @ TILT.T)
    assert (inside_hulls(points, (BOX,)) == expected).all()
    assert (inside_hulls(points @ TILT.T, (tilted,)) == expected).all()


def test_paths_hit_hulls_only_from_outside_and_in_reach():
    origins = np.array([[-1.0, 0, 0], [-1.0, 0, 0], [0.0, 0, 0], [-1.0, 0.5, 0], [-0.3, 0.0, 0.0]])
    paths = np.array([[1.0, 0, 0], [0.5, 0, 0], [1.0, 0, 0], [2.0, 0, 0], [-1.0, 0, 0]])
    expected = [True, False, False, False, False]
    assert hit_hulls(origins, paths, (BOX,)).tolist() == expected
    tilted = convex_hull(BOX.vertices @ TILT.T)
    assert hit_hulls(origins @ TILT.T, paths @ TILT.T, (tilted,)).tolist() == expected


def test_volume_samples_fill_the_union_evenly():
    other = box_hull(np.array([0.3, -0.2, -0.1]), np.array([0.5, 0.2, 0.1]))
    points = volume_samples(HullSet(hulls=(BOX, other)), 2000)
    assert 1500 < len(points) < 6000
    assert np.mean(points[:, 0] > 0.3) == pytest.approx(0.25, abs=0.02)


@pytest.mark.parametrize(("mesh", "euler"), [
    (trimesh.creation.box(), 2),
    (trimesh.creation.icosphere(subdivisions=2), 2),
    (trimesh.creation.torus(1.0, 0.3), 0),
])  # fmt: skip
def test_topology_of_closed_surfaces(mesh, euler):
    faces = np.asarray(mesh.faces)
    assert count_open_edges(faces) == 0
    assert euler_numbers(faces).tolist() == [euler]
    assert count_open_edges(faces[1:]) == 3
    flipped = faces.copy()
    flipped[0] = flipped[0, ::-1]
    assert count_open_edges(flipped) == 3


def test_requirements_open_what_they_name(cabinet_package):
    subject = Subject(cabinet_package)
    assert [(need.joint, need.needs) for need in subject.requires_open] == [("joint_3", "joint_1")]
    tray = next(joint for joint in subject.driven if joint.name == "joint_3")
    need = subject.requires_open[0]
    assert open_positions(subject, tray) == {"joint_1": pytest.approx(need.fraction * np.pi / 2, abs=1e-6)}


def test_crashing_check_fails_and_names_the_error(cabinet_package):
    def crash(subject, cfg):
        raise ZeroDivisionError("by nothing")

    spec = CheckSpec(id="V999", level="L0", title="crash", applies=always, function=crash)
    result = run_check(spec, Subject(cabinet_package), CheckConfig())
    assert (result.verdict, result.value) == ("fail", None)
    assert "ZeroDivisionError: by nothing" in result.message


def test_levels_select_checks(cabinet_package):
    assert {result.level for result in run_checks(cabinet_package, ("L0",))} == {"L0"}


@pytest.mark.parametrize(
    "content", [None, b"", b"\x00\xff\x00", b"<robot", b"<html/>", b"<robot name='empty'/>"]
)
def test_folders_without_a_usable_urdf_get_verdicts(tmp_path, content):
    if content is not None:
        (tmp_path / "mobility.urdf").write_bytes(content)
    results = run_checks(tmp_path)
    assert [result.id for result in results] == [spec.id for spec in CHECKS]
    assert next(result for result in results if result.id == "V001").verdict == "fail"
    assert not [result for result in results if "crashed" in result.message]


def test_garbled_urdfs_never_crash_a_check(cabinet_package, tmp_path):
    """Numbers, names and elements of the URDF replaced at random; every check still gives a verdict."""
    folder = tmp_path / "package"
    shutil.copytree(cabinet_package, folder)
    words = (cabinet_package / "mobility.urdf").read_text().split('"')
    rng = np.random.default_rng(5)
    failed = 0
    for _ in range(12):
        garbled = list(words)
        for at in rng.choice(np.arange(1, len(words), 2), size=3, replace=False):
            garbled[at] = str(rng.choice(["", "nan", "-1", "1e9", "link_1", "0 0", "../x", "0 0 0"]))
        (folder / "mobility.urdf").write_text('"'.join(garbled))
        results = run_checks(folder)
        assert not [result.message for result in results if "crashed" in result.message]
        assert all(result.value is None or np.isfinite(result.value) for result in results)
        failed += any(result.verdict == "fail" for result in results)
    assert failed == 12


def test_broken_sidecars_are_named(cabinet_package, tmp_path):
    folder = tmp_path / "package"
    shutil.copytree(cabinet_package, folder)
    (folder / "annotations.json").write_text("{")
    results = {result.id: result for result in run_checks(folder, ("L2",))}
    assert results["V201"].verdict == "fail"
    assert "annotations.json" in results["V201"].message
    (folder / "annotations.json").write_text(json.dumps({"requires_open": [{"joint": 3}]}))
    assert "requires_open" in run_checks(folder, ("L2",))[0].message


@pytest.mark.real
@pytest.mark.parametrize("name", ["20453", "100129"])
def test_original_folders_get_verdicts(real_objects, name):
    results = {result.id: result for result in run_checks(real_objects / "partnet_mobility" / name)}
    assert not [result for result in results.values() if "crashed" in result.message]
    for check in ("V010", "V101", "V106"):
        assert results[check].verdict == "not_applicable"
    for check in ("V007", "V008", "V102"):
        assert results[check].verdict == "fail"
    assert results["V001"].verdict == "pass"


def test_documentation_lists_every_check_once():
    text = (ROOT / "docs" / "reference" / "checks.md").read_text()
    rows = [line.split("|")[1].strip() for line in text.splitlines() if line.startswith("| V")]
    assert [row for row in rows if row < "V300"] == [spec.id for spec in CHECKS]


def test_points_are_as_far_outside_a_link_as_they_are_from_its_faces():
    flat = box_hull(np.zeros(3), np.ones(3))
    flat = type(flat)(vertices=flat.vertices * (1.0, 1.0, 0.0), faces=flat.faces)
    subject = SimpleNamespace(
        hull_sets={"link": HullSet(hulls=(BOX,)), "flat": HullSet(hulls=(flat,)), "bare": HullSet(hulls=())},
        points=lambda link: np.zeros((0, 3)),
    )
    assert distance_outside(subject, "link", np.array([0.29, 0.0, 0.0])) == 0.0
    assert distance_outside(subject, "link", np.array([0.0, 0.0, 0.17])) == pytest.approx(0.07)
    assert distance_outside(subject, "flat", np.zeros(3)) == np.inf
    assert distance_outside(subject, "bare", np.zeros(3)) == np.inf
