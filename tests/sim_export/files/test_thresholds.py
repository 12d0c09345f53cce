"""Both sides of the limits of the formats: digits, colours, creases, versions, pairs and meshes."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from box_cabinet import as_package, box_geometry, scaled
from PIL import Image

from sim_export.errors import PackageError
from sim_export.files.foreign import thicken
from sim_export.files.mjcf import mjcf_text, srdf_text
from sim_export.files.obj import hull_obj_text, obj_text, parse_obj, png_bytes
from sim_export.files.read import read_package
from sim_export.files.urdf import format_number
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull, convex_hull, hull_volume
from sim_export.geometry.normals import corner_normals
from sim_export.motion.ignored_pairs import ignored_pairs
from sim_export.package import Hull, Link, Mesh, SimPackage, SourceMesh, Visual


def test_coordinates_are_written_in_micrometres_and_joints_in_nanometres():
    hull = box_hull(np.zeros(3), np.array([1.23456749, 1.0, 1.0]))
    assert "v 1.234567 " in obj_text(Mesh(vertices=hull.vertices, faces=hull.faces), "a")
    assert format_number(1.2345678901) == "1.23456789"
    assert format_number(1.2345678949) == "1.234567895"


@pytest.mark.parametrize("seed", range(8))
def test_rounding_does_not_dent_hulls_of_millimetres(tmp_path: Path, seed):
    """A flat dome of 3 mm: its facets lean so little that rounded corners turn some edges inwards."""
    rng = np.random.default_rng(seed)
    turn, radius = rng.uniform(0, 2 * np.pi, 14), 1.5e-3 * np.sqrt(rng.random(14))
    top = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), 1.5e-3 - radius**2])
    (tmp_path / "dome.obj").write_text(
        hull_obj_text(convex_hull(np.concatenate([top, top * [1, 1, 0]])), "a")
    )
    data = parse_obj(tmp_path / "dome.obj")
    written = Hull(vertices=data.vertices, faces=data.faces)
    assert hull_volume(written) == pytest.approx(hull_volume(convex_hull(data.vertices)), rel=1e-7, abs=0)


@pytest.mark.parametrize(("fold", "smooth"), [(49.9, True), (50.1, False)])
def test_surfaces_look_smooth_where_they_fold_by_up_to_50_degrees(fold, smooth):
    turn = np.radians(fold)
    vertices = np.array([[0, 0, 0], [0, 1, 0], [1, 0.5, 0], [-np.cos(turn), 0.5, np.sin(turn)]])
    normals = corner_normals(vertices[[[0, 2, 1], [0, 1, 3]]])
    assert (normals[0, 0] @ normals[1, 0] > 1.0 - 1e-9) == smooth


@pytest.mark.parametrize(("colors", "mode"), [(256, "P"), (257, "RGB")])
def test_pictures_of_few_colours_have_a_palette_and_lose_none(colors, mode):
    texture = np.zeros((1, colors, 3), dtype=np.uint8)
    texture[0, :, 0], texture[0, :, 1] = np.arange(colors) % 256, np.arange(colors) // 256
    image = Image.open(io.BytesIO(png_bytes(texture)))
    assert image.mode == mode
    np.testing.assert_array_equal(np.asarray(image.convert("RGB")), texture)


@pytest.mark.parametrize(("version", "readable"), [(0, False), (1, True), (2, False)])
def test_packages_of_version_one_are_read_and_no_others(cabinet, tmp_path, version, readable):
    folder = write_package(as_package(scaled(cabinet), box_geometry()), tmp_path / "cabinet")
    meta = json.loads((folder / "meta.json").read_text())
    (folder / "meta.json").write_text(json.dumps({**meta, "version": version}))
    if readable:
        assert read_package(folder).name == "sample_cabinet"
    else:
        with pytest.raises(PackageError, match=f"version {version}"):
            read_package(folder)


def link_of(name: str, *hulls: Hull, visuals: tuple[Visual, ...] = ()) -> Link:
    return Link(name=name, label=None, parts=(), visuals=visuals, hulls=hulls, inertial=None)


def package_of(*links: Link) -> SimPackage:
    return SimPackage(name="a", category="Table", visual="source", links=links, joints=())


@pytest.mark.parametrize(
    ("gap", "touch"), [(0.9e-4, True), (1.1e-4, False), (-0.9e-3, True), (-1.1e-3, False)]
)
def test_links_touch_within_a_tenth_of_a_millimetre_and_at_most_a_millimetre_deep(gap, touch):
    one = box_hull(np.zeros(3), np.ones(3))
    other = box_hull(np.array([1.0 + gap, 0.0, 0.0]), np.array([2.0, 1.0, 1.0]))
    assert bool(ignored_pairs(package_of(link_of("a", one), link_of("b", other)))) == touch


@pytest.mark.parametrize("count", [31, 32, 33])
def test_no_more_pairs_are_listed_as_default_than_sapien_reads(count):
    row = [box_hull(np.array([k, 0.0, 0.0]), np.array([k + 1.0, 1.0, 1.0])) for k in range(count + 1)]
    links = [link_of(f"link_{k}", hull) for k, hull in enumerate(row)]
    text = srdf_text("a", ignored_pairs(package_of(*links)))
    assert (text.count('"Default"'), text.count('"Never"')) == (min(count, 31), max(count - 31, 0))


@pytest.mark.parametrize(("corners", "written"), [(3, False), (4, True)])
def test_visuals_with_fewer_corners_than_mujoco_takes_are_left_out(tmp_path: Path, corners, written):
    places = ["v 0 0 0", "v 1 0 0", "v 0 1 0", "v 0 0 1"][:corners]
    (tmp_path / "a.obj").write_text("\n".join([*places, "f 1 2 3"]) + "\n")
    mesh = SourceMesh(path=tmp_path / "a.obj", T_object_file=np.eye(4), scale=1.0)
    visual = Visual(name="seen", part="a", label="base", mesh=mesh)
    text = mjcf_text(package_of(link_of("link_0", box_hull(np.zeros(3), np.ones(3)), visuals=(visual,))))
    assert ('name="seen"' in text) == written


def test_flat_collision_becomes_a_plate_of_a_millimetre():
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    assert np.ptp(thicken(flat), axis=0) == pytest.approx([1.0, 1.0, 0.001])
