"""Both sides of the limits of readers and of data sets."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from cabinet_files import box_visual, joint, link, urdf

from artigen.camera import Camera
from artigen.datasets.duplicates import Duplicate, Duplicates, Fingerprint
from artigen.datasets.mechanism_joints import build_tree
from artigen.datasets.mechanism_object import find_mesh
from artigen.datasets.mesh_obj import write_obj
from artigen.datasets.mesh_raster import rasterize_mesh
from artigen.datasets.mjcf import read_mjcf
from artigen.datasets.packing import PackingError
from artigen.datasets.partnet_annotation import SourceNode, read_nodes
from artigen.datasets.partnet_joints import closed_pose
from artigen.datasets.samples import Sample, sample_from_json, sample_json
from artigen.datasets.shards import open_shards
from artigen.datasets.sizes import estimate_size
from artigen.datasets.urdf_file import read_urdf
from artigen.errors import SourceError
from artigen.files.mtl import parse_mtl
from artigen.types import PartLabel


def fingerprint(name: str, height: float, *shares: int) -> Fingerprint:
    """An object with its surface in some of two cells."""
    return Fingerprint(
        id=name, category="Safe", joints=(), extents=(0.5, 0.5, height), geometry=name,
        descriptor=np.array(shares, "<u2").tobytes(),
    )  # fmt: skip


@pytest.mark.parametrize(("height", "found"), [(0.5 / 0.9901, True), (0.5 / 0.9899, False)])
def test_boxes_of_near_duplicates_differ_by_one_per_cent_at_most(height, found):
    known = Duplicates(0.02)
    known.add(fingerprint("first", 0.5, 65535, 0))
    assert (known.add(fingerprint("second", height, 65535, 0)) is not None) == found


def test_objects_whose_surface_is_in_other_cells_are_at_a_distance_of_one():
    known = Duplicates(1.0)
    known.add(fingerprint("first", 0.5, 65535, 0))
    assert known.add(fingerprint("second", 0.5, 0, 65535)) == Duplicate(id="second", of="first", distance=1.0)


@pytest.mark.parametrize(("count", "kept"), [(64, 64), (65, 1)])
def test_a_mesh_keeps_64_plain_colours_and_more_are_averaged(tmp_path, count, kept):
    colors = np.array([[2 * k, 0, 0, 255] for k in range(count)], dtype=np.uint8)
    triangles = np.tile([0, 1, 2], (count, 1))
    mesh = trimesh.Trimesh(np.eye(3), triangles, face_colors=colors, process=False)
    write_obj([mesh], (0.0, 0.0, 0.0), tmp_path / "mesh.obj")
    assert len(parse_mtl(tmp_path / "mesh.mtl")) == kept


@pytest.mark.parametrize(("ahead", "seen"), [(0.9e-4, 0), (1.1e-4, 1)])
def test_a_back_is_seen_where_it_is_nearer_by_a_ten_thousandth(ahead, seen):
    """Of a front, and a back a bit before it."""
    front = np.array([[-1.0, -1.0, 1.0], [0.0, 2.0, 1.0], [2.0, -1.0, 1.0]])
    vertices = np.concatenate([front, (1.0 - ahead) * front])
    camera = Camera(position=np.zeros(3), axes=np.eye(3), pixel=0.1, width=1, height=1)
    assert rasterize_mesh(vertices, np.array([[0, 1, 2], [3, 5, 4]]), camera).face.tolist() == [seen]


@pytest.mark.parametrize(("group", "shown"), [(2, 1), (3, 0)])
def test_geoms_of_groups_0_to_2_are_shown(tmp_path, group, shown):
    path = tmp_path / "box.xml"
    path.write_text(
        '<mujoco><worldbody><geom type="box" size="1 1 1"/>'
        f'<geom name="extra" type="box" size="1 1 1" group="{group}"/></worldbody></mujoco>'
    )
    visuals = read_mjcf(path).visuals
    assert sum(visual.name == "extra" for visual in visuals) == shown


ROWS: dict[str, tuple[str, dict[str, object], float]] = {
    "an angle": ("hinge", {"a": 0.0}, 720.0),
    "a turn of a slider": ("slider", {"a": 0.0, "b": 1.0}, 720.0),
    "a travel": ("slider", {"a": 0.0}, 100.0),
}


@pytest.mark.parametrize("name", ROWS)
@pytest.mark.parametrize(("factor", "read"), [(0.99, True), (1.01, False)])
def test_annotations_hold_two_turns_and_100_lengths(tmp_path, name, factor, read):
    kind, limit, most = ROWS[name]
    key = "rotationLimit" if "b" in limit else "b"
    node = {
        "id": 0, "parent": 1, "joint": kind, "name": "part", "parts": [],
        "jointData": {
            "axis": {"origin": [0, 0, 0], "direction": [1, 0, 0]}, "limit": limit | {key: factor * most}
        },
    }  # fmt: skip
    root = {"id": 1, "parent": -1, "joint": "free", "name": "root", "parts": []}
    path = tmp_path / "mobility_v2.json"
    path.write_text(json.dumps([node, root]))
    if read:
        assert len(read_nodes(path)) == 2
    else:
        with pytest.raises(SourceError, match=f"allowed are -{most:g}..{most:g}"):
            read_nodes(path)


@pytest.mark.parametrize(("place", "read"), [(99.0, True), (101.0, False)])
def test_coordinates_of_an_axis_are_within_100_lengths(tmp_path, place, read):
    node = {
        "id": 0, "parent": 1, "joint": "hinge", "name": "part", "parts": [],
        "jointData": {"axis": {"origin": [0, place, 0], "direction": [1, 0, 0]}, "limit": {"a": 0, "b": 1}},
    }  # fmt: skip
    path = tmp_path / "mobility_v2.json"
    path.write_text(json.dumps([node, {"id": 1, "parent": -1, "joint": "free", "name": "root", "parts": []}]))
    if read:
        assert len(read_nodes(path)) == 2
    else:
        with pytest.raises(SourceError, match="wrong unit"):
            read_nodes(path)


BODY = np.array([[0.0, 0.0, 0.0], [4.0, 4.0, 2.0]])
"""Its diagonal is 6 long."""


def rest_of(joint: str, label: PartLabel, a: float, b: float, *points: tuple[float, float, float]) -> float:
    """Closed pose of a part that turns about, or slides along, the upright edge of the body."""
    node = SourceNode(
        id=0, parent=1, joint=joint, name="part", pieces=(), a=a, b=b, direction=(0.0, 0.0, 1.0)
    )
    return closed_pose(node, label, np.array(points), BODY).rest


@pytest.mark.parametrize(("share", "rest"), [(0.0095, 180.0), (0.0105, 0.0)])
def test_poses_of_a_hinge_are_equal_within_a_hundredth_of_the_diagonal(share, rest):
    """At 180 degrees, where it begins, the part is beside the body; at 0 it is within."""
    assert rest_of("hinge", "tray", 180.0, 0.0, (6.0 * share, 0.0, 1.0)) == rest


@pytest.mark.parametrize(("share", "rest"), [(0.075, 450.0), (0.085, 0.0)])
def test_poses_of_a_hinge_are_equal_within_eight_hundredths_of_the_largest_distance(share, rest):
    """At 450 degrees, where it begins, one of two points is outside; at 180, both are."""
    near = 3.0 * share
    assert rest_of("hinge", "tray", 450.0, 0.0, (3.0 - near, 0.0, 1.0), (0.0, near, 1.0)) == rest


@pytest.mark.parametrize(("share", "rest"), [(0.24, -24.0), (0.26, 0.0)])
def test_a_door_swings_both_ways_from_a_quarter_of_its_range(share, rest):
    """The modelled pose, as closed as all others, then comes first."""
    low, high = -100.0 * share, 100.0 * (1.0 - share)
    assert rest_of("hinge", "door", low, high, (0.0, 0.0, 1.0)) == rest
    assert rest_of("hinge", "door", high, low, (0.0, 0.0, 1.0)) == (high if rest else 0.0)


@pytest.mark.parametrize(("share", "rest"), [(0.095, 0.0), (0.105, 1.0)])
def test_poses_of_a_slider_are_equal_within_a_tenth_of_the_travel(share, rest):
    """Where it begins, at 0, it protrudes by a share of the travel; at 1 it is within."""
    assert rest_of("slider", "drawer", 0.0, 1.0, (1.0, 1.0, -share)) == rest


def small_sample() -> Sample:
    kinds = {"str": "", "int": 0, "float": 0.0, "bool | None": None, "bool": True, "Vector": (0.0, 0.0, 0.0)}
    return Sample(**{name: kinds.get(str(kind), ()) for name, kind in Sample.__annotations__.items()})


def read_index(folder: Path, version: int) -> None:
    (folder / "dataset.json").write_text(json.dumps({"format": "artigen-dataset", "version": version}))
    open_shards(folder)


def read_sample(_: Path, version: int) -> None:
    value = json.loads(sample_json(small_sample())) | {"version": version}
    sample_from_json(json.dumps(value).encode())


@pytest.mark.parametrize("read", [read_index, read_sample])
def test_data_sets_are_of_version_1(tmp_path, read: Callable[[Path, int], None]):
    read(tmp_path, 1)
    for version in (0, 2):
        with pytest.raises(PackingError, match=f"{version}, this reads .* 1"):
            read(tmp_path, version)


def test_no_object_is_longer_than_2_4_metres():
    """A coffee table is 45 centimetres high."""
    assert estimate_size("Table", np.array([1.0, 5.3, 1.0]))[0] == pytest.approx(0.45 * 5.3)
    assert estimate_size("Table", np.array([1.0, 5.4, 1.0]))[0] == pytest.approx(2.4)


@pytest.mark.parametrize(("more", "kind"), [(0.9e-3, False), (1.1e-3, True)])
def test_a_joint_that_exceeds_a_turn_by_a_thousandth_is_endless(tmp_path, more, kind):
    path = tmp_path / "wheel.urdf"
    wheel = joint("revolute", "body", "wheel", axis=(0, 1, 0), limits=(0.0, 2.0 * np.pi + more))
    shown = box_visual((0.1, 0.1, 0.1))
    path.write_text(urdf(link("body", shown), link("wheel", shown), wheel))
    assert build_tree(read_urdf(path), path).nodes[0].unlimited == kind


@pytest.mark.parametrize("up", [1, 4, 5])
def test_packages_are_looked_for_in_all_folders_above(tmp_path, up):
    folder = tmp_path / "a" / "b" / "c" / "d" / "e"
    folder.mkdir(parents=True)
    mesh = folder.parents[up - 1] / "meshes" / "box.obj"
    mesh.parent.mkdir()
    mesh.touch()
    assert find_mesh("package://meshes/box.obj", folder / "thing.urdf") == mesh
