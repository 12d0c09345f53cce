"""Packages on disk: bytes repeat, folders move, reading undoes writing, nothing half-written stays."""

import errno
import io
import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from box_cabinet import SCALE, as_package, box_geometry, scaled, with_screw

from artigen.datasets.packing import read_folder
from artigen.splats.surface import splat_surface
from artigen.types import Asset, SurfaceSamples
from sim_export.appearance.splats import attach_splats
from sim_export.errors import PackageError
from sim_export.files.glb import Y_UP, glb_bytes
from sim_export.files.obj import obj_text, parse_obj, read_mesh
from sim_export.files.read import read_package
from sim_export.files.write import manifest_problems, package_files, write_package
from sim_export.geometry.hulls import box_hull, clip_hull, hull_volume
from sim_export.geometry.normals import corner_normals
from sim_export.package import HandleAnnotation, Hull, Mesh, Requirement, SimPackage, SourceMesh


def textured(mesh: Mesh, seed: int, channels: int = 3) -> Mesh:
    rng = np.random.default_rng(seed)
    uv = rng.uniform(0, 1, size=(len(mesh.faces), 3, 2))
    return replace(mesh, uv=uv, texture=rng.integers(0, 256, size=(8, 16, channels), dtype=np.uint8))


@pytest.fixture(scope="module")
def package(cabinet) -> SimPackage:
    """Screw, textures, handles, requirements, records: a bit of everything."""
    geometry = box_geometry()
    slant = np.array([0.6, 0.0, 0.8])
    cut = clip_hull(geometry[2].hulls[0], slant, float((geometry[2].hulls[0].vertices @ slant).mean()))
    assert cut is not None
    geometry[2] = replace(
        geometry[2], visuals=(textured(geometry[2].visuals[0], 1),), hulls=(cut, *geometry[2].hulls)
    )
    geometry[3] = replace(geometry[3], visuals=(textured(geometry[3].visuals[0], 2, channels=4),))
    handle = HandleAnnotation(
        link="link_0",
        part="drawer_handle",
        corners=np.random.default_rng(0).normal(size=(8, 3)),
        normal=np.array([-1.0, 0.0, 0.0]),
        grasp_line=np.array([[-0.2, -0.1, 0.3], [-0.2, 0.1, 0.3]]),
        width=0.02,
        clearance=0.03,
        opening_direction=np.array([-1.0, 0.0, 0.0]),
        gapart="line_fixed_handle",
    )
    return replace(
        as_package(with_screw(scaled(cabinet)), geometry),
        handles=(handle,),
        requires_open=(Requirement(joint="joint_3", needs="joint_1", fraction=0.9),),
        materials=(("body", "wood_board"), ("drawer_handle", "steel")),
        provenance=(("source", "sample"), ("version", "0")),
        records=("part 'x' was mended",),
    )


@pytest.fixture(scope="module")
def folder(package, tmp_path_factory) -> Path:
    return write_package(package, tmp_path_factory.mktemp("out") / "cabinet")


def corners(hull: Hull) -> np.ndarray:
    """The vertices in an order of their own."""
    rounded = np.round(hull.vertices, 5) + 0.0
    return hull.vertices[np.lexsort(rounded.T)]


def assert_same(first: SimPackage, second: SimPackage) -> None:
    """Equal up to the rounding of the text formats."""
    needs = [
        [(need.joint, need.needs, need.fraction) for need in one.requires_open] for one in (first, second)
    ]
    assert needs[0] == needs[1]
    for name in ("name", "category", "visual", "materials", "provenance", "records"):
        assert getattr(first, name) == getattr(second, name)
    for a, b in zip(first.links, second.links, strict=True):
        assert (a.name, a.label, a.parts) == (b.name, b.label, b.parts)
        assert (a.inertial is None) == (b.inertial is None)
        if a.inertial is not None and b.inertial is not None:
            assert a.inertial.mass == pytest.approx(b.inertial.mass, rel=1e-8)
            np.testing.assert_allclose(a.inertial.com, b.inertial.com, atol=1e-8)
            np.testing.assert_allclose(a.inertial.inertia, b.inertial.inertia, rtol=1e-7, atol=1e-12)
        for hull, other in zip(a.hulls, b.hulls, strict=True):
            np.testing.assert_allclose(corners(hull), corners(other), atol=1e-6)
            assert hull_volume(hull) == pytest.approx(hull_volume(other), rel=1e-3)
        for visual, other in zip(a.visuals, b.visuals, strict=True):
            assert (visual.name, visual.part, visual.label) == (other.name, other.part, other.label)
            assert isinstance(visual.mesh, Mesh)
            assert isinstance(other.mesh, Mesh)
            np.testing.assert_allclose(visual.mesh.vertices, other.mesh.vertices, atol=1e-6)
            np.testing.assert_array_equal(visual.mesh.faces, other.mesh.faces)
            if visual.mesh.uv is None:
                np.testing.assert_allclose(visual.mesh.color, other.mesh.color, atol=1e-6)
            else:
                np.testing.assert_allclose(visual.mesh.uv, other.mesh.uv, atol=1e-6)
                np.testing.assert_array_equal(visual.mesh.texture, other.mesh.texture)
    for a, b in zip(first.joints, second.joints, strict=True):
        for name in ("name", "type", "kind", "parent", "child", "follows"):
            assert getattr(a, name) == getattr(b, name)
        numbers = ("lower", "upper", "effort", "velocity", "friction", "damping", "ratio")
        for name in ("origin", "axis", *numbers):
            np.testing.assert_allclose(getattr(a, name), getattr(b, name), atol=1e-8)
    for a, b in zip(first.handles, second.handles, strict=True):
        assert (a.link, a.part, a.gapart) == (b.link, b.part, b.gapart)
        for name in ("corners", "normal", "grasp_line", "width", "clearance", "opening_direction"):
            np.testing.assert_allclose(getattr(a, name), getattr(b, name), atol=1e-8)


def test_reading_gives_back_what_was_written(package, folder):
    again = read_package(folder)
    assert_same(package, again)
    assert package_files(again) == read_folder(folder)


def test_without_appearance_everything_else_is_read(package, folder):
    bare = read_package(folder, appearance=False)
    assert sum(len(link.visuals) for link in package.links) > 0
    assert not any(link.visuals or link.splats for link in bare.links)
    assert_same(replace(package, links=tuple(replace(link, visuals=()) for link in package.links)), bare)


def test_bytes_repeat_and_folders_move(package, folder, tmp_path):
    other = write_package(package, tmp_path / "elsewhere" / "other name")
    assert read_folder(other) == read_folder(folder)
    moved = tmp_path / "moved"
    shutil.move(other, moved)
    assert_same(package, read_package(moved))
    assert manifest_problems(moved) == ()
    for path, content in read_folder(moved).items():
        assert str(tmp_path).encode() not in content, path


def test_every_file_is_used_and_every_name_is_there(folder):
    names = set(read_folder(folder))
    text = (folder / "mobility.urdf").read_text()
    text += "".join(file.read_text() for file in (folder / "visual").glob("*.mtl"))
    text += "".join(file.read_text() for file in (folder / "visual").glob("*.obj"))
    for name in names:
        if "/" in name:
            assert name in text or name.rsplit("/", 1)[1] in text, name
    assert {name for name in names if "/" not in name} == {
        *("mobility.urdf", "mobility_cvx.urdf", "mobility.mjcf.xml", "mobility.srdf", "semantics.txt"),
        *("mobility_v2.json", "meta.json", "bounding_box.json", "annotations.json", "physics.json"),
        *("provenance.json", "materials.json", "manifest.json"),
    }


def test_partnet_files_say_what_partnet_says(folder):
    assert (folder / "semantics.txt").read_text().splitlines() == [
        "link_0 slider drawer",
        "link_1 hinge rotation_door",
        "link_2 slider+ knob",
        "link_3 slider tray",
        "link_4 heavy furniture_body",
    ]
    parts = json.loads((folder / "mobility_v2.json").read_text())
    assert [part["parent"] for part in parts] == [4, 4, 1, 4, -1]
    assert parts[1]["jointData"]["limit"] == {"a": 0.0, "b": 90.0, "noLimit": False}
    assert parts[0]["jointData"]["limit"]["b"] == pytest.approx(0.36 * SCALE)
    assert json.loads((folder / "meta.json").read_text())["model_cat"] == "StorageFurniture"
    box = json.loads((folder / "bounding_box.json").read_text())
    assert box["max"][2] - box["min"][2] == pytest.approx(SCALE)


def test_manifest_notices_every_change(folder, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    (copy / "validation.json").write_text("{}")
    assert manifest_problems(copy) == ()
    with (copy / "mobility.urdf").open("a") as stream:
        stream.write(" ")
    (copy / "collision" / "link_0_0.obj").unlink()
    (copy / "stray.txt").write_text("")
    problems = " ".join(manifest_problems(copy))
    assert problems.count("mobility.urdf") == 1
    assert "collision/link_0_0.obj is missing" in problems
    assert "stray.txt is not" in problems


def test_existing_folders_are_safe(package, tmp_path):
    target = write_package(package, tmp_path / "cabinet")
    before = read_folder(target)
    with pytest.raises(PackageError, match="exists already"):
        write_package(package, target)
    renamed = replace(package, name="renamed")
    write_package(renamed, target, "replace")
    assert read_package(target).name == "renamed"
    write_package(package, target, "replace")
    assert read_folder(target) == before
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "thesis.txt").write_text("words")
    with pytest.raises(PackageError, match="is no package"):
        write_package(package, precious, "replace")
    assert (precious / "thesis.txt").read_text() == "words"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cabinet", "precious"]


@pytest.mark.parametrize("old", [False, True])
def test_a_full_disk_leaves_nothing_half_written(package, tmp_path, monkeypatch, old):
    target = tmp_path / "cabinet"
    if old:
        write_package(replace(package, name="old"), target)
    written = []

    def fail(path: Path, content: bytes) -> int:
        written.append(path)
        if len(written) > 10:
            raise OSError(errno.ENOSPC, "No space left on device")
        with path.open("wb") as stream:
            return stream.write(content)

    monkeypatch.setattr(Path, "write_bytes", fail)
    with pytest.raises(PackageError, match="No space left"):
        write_package(package, target, "replace")
    monkeypatch.undo()
    assert len(written) == 11
    assert [path.name for path in tmp_path.iterdir()] == (["cabinet"] if old else [])
    if old:
        assert read_package(target).name == "old"


def test_a_file_in_the_way_is_named(package, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(PackageError, match="file"):
        write_package(package, tmp_path / "file" / "cabinet")


@pytest.mark.parametrize(
    ("file", "old", "new", "what"),
    [
        ("mobility.urdf", "</robot>", "", "XML"),
        ("mobility.urdf", 'type="revolute"', 'type="screw"', "screw"),
        ("mobility.urdf", 'upper="0.252"', 'upper="nan"', "joint_0"),
        ("mobility.urdf", 'lower="0"', 'lower="one"', "lower"),
        ("mobility.urdf", 'axis xyz="-1 0 0"', 'axis xyz="0 0 0"', "axis"),
        ("mobility.urdf", "collision/link_0_0.obj", "collision/gone.obj", "gone.obj"),
        ("mobility.urdf", "collision/link_0_0.obj", "../../../etc/passwd", "outside"),
        ("mobility.urdf", "collision/link_0_0.obj", "/etc/passwd", "relative"),
        ("mobility.urdf", "collision/link_0_0.obj", "package://x/y.obj", "relative"),
        ("mobility.urdf", '<parent link="link_4"', '<parent link="link_9"', "link_9"),
        ("mobility.urdf", '<parent link="link_4"', '<parent link="link_0"', "root"),
        ("mobility.urdf", '<link name="link_4">', '<link name="link_4" /><link name="link_4">', "link_4"),
        ("mobility.urdf", '<mass value="', '<mass value="nan" old="', "NaN"),
        ("collision/link_0_0.obj", "f 1", "f 999", "link_0_0.obj"),
        ("collision/link_0_0.obj", "v ", "v x", "link_0_0.obj"),
        ("collision/link_0_0.obj", "v ", "v nan ", "link_0_0.obj"),
        ("meta.json", "{", "[", "meta.json"),
        ("meta.json", '"version": 1', '"version": 99', "99"),
        ("meta.json", '"label": "drawer"', '"lebal": "drawer"', "label"),
        ("physics.json", '"kind"', '"sort"', "kind"),
        ("annotations.json", '"normal"', '"abnormal"', "normal"),
    ],
)
def test_broken_packages_are_named(folder, tmp_path, file, old, new, what):
    copy = tmp_path / "copy"
    shutil.copytree(folder, copy)
    text = (copy / file).read_text()
    assert old in text
    (copy / file).write_text(text.replace(old, new, 1))
    with pytest.raises(PackageError, match=what):
        read_package(copy)


def test_missing_files_and_entity_bombs_are_refused(folder, tmp_path):
    with pytest.raises(PackageError, match=r"mobility\.urdf"):
        read_package(tmp_path)
    for name in ("annotations.json", "physics.json", "provenance.json", "visual/drawer_link_0_0.png"):
        copy = tmp_path / name.replace("/", "_")
        shutil.copytree(folder, copy)
        (copy / name).unlink()
        with pytest.raises(PackageError, match=name.rsplit("/", 1)[-1]):
            read_package(copy)
    bomb = '<!DOCTYPE r [<!ENTITY a "aa"><!ENTITY b "&a;&a;">]><robot name="&b;"><link name="base"/></robot>'
    (tmp_path / "mobility.urdf").write_text(bomb)
    with pytest.raises(PackageError, match="entities"):
        read_package(tmp_path)


FOREIGN = """<?xml version="1.0"?>
<robot name="x"><link name="base"/>
<link name="link_1">
<visual name="body-1"><geometry><mesh filename="textured_objs/a.obj"/></geometry></visual>
<collision><origin xyz="0 0 0"/><geometry><mesh filename="textured_objs/a.obj"/></geometry></collision>
</link>
<joint name="joint_1" type="fixed">
<origin rpy="1.570796326794897 0 -1.570796326794897" xyz="0 0 0"/>
<child link="link_1"/><parent link="base"/>
</joint>
<link name="link_0">
<visual name="handle-3"><origin xyz="-0.2 0 -0.1"/><geometry><mesh filename="textured_objs/a.obj"/></geometry>
</visual>
<collision><origin xyz="-0.2 0 -0.1"/><geometry><mesh filename="textured_objs/flat.obj"/></geometry>
</collision>
<collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>
</link>
<joint name="joint_0" type="revolute">
<origin xyz="0.2 0 0.1"/><axis xyz="0 -2 0"/><limit lower="0" upper="1.5"/>
<child link="link_0"/><parent link="link_1"/>
</joint>
</robot>"""


@pytest.fixture
def foreign(tmp_path) -> Path:
    """A folder in PartNet-Mobility's layout: y up, no mass, a quad and a flat collision mesh."""
    folder = tmp_path / "123"
    (folder / "textured_objs").mkdir(parents=True)
    (folder / "images").mkdir()
    (folder / "mobility.urdf").write_text(FOREIGN)
    (folder / "semantics.txt").write_text("link_0 hinge rotation_door\nlink_1 heavy furniture_body\n")
    corners = [(x, y, z) for x in (0.0, 0.2) for y in (0.0, 0.4) for z in (0.0, 0.8)]
    lines = ["mtllib a.mtl", *(f"v {x} {y} {z}" for x, y, z in corners), "vt 0 0", "vt 1 1"]
    quads = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    lines += ["usemtl wood", *("f " + " ".join(f"{k}/1" for k in quad) for quad in quads)]
    (folder / "textured_objs" / "a.obj").write_text("\n".join(lines) + "\n")
    (folder / "textured_objs" / "a.mtl").write_text("newmtl wood\nKd 1 0.5 0\nmap_Kd ../images/w.png\n")
    (folder / "textured_objs" / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    from PIL import Image

    Image.fromarray(np.full((2, 2, 3), 90, dtype=np.uint8)).save(folder / "images" / "w.png")
    return folder


def test_foreign_folders_come_out_in_the_object_frame(foreign):
    package = read_package(foreign)
    assert (package.name, package.visual) == ("123", "source")
    body, door = (next(link for link in package.links if link.name == name) for name in ("link_1", "link_0"))
    assert (body.label, door.label, body.inertial) == ("base", "door", None)
    # (x, y, z) of the file is (-z, -x, y) here: y up becomes z up, front +z becomes front -x.
    np.testing.assert_allclose(body.hulls[0].vertices.min(axis=0), [-0.8, -0.2, 0.0], atol=1e-12)
    np.testing.assert_allclose(body.hulls[0].vertices.max(axis=0), [0.0, 0.0, 0.4], atol=1e-12)
    joint = next(joint for joint in package.joints if joint.name == "joint_0")
    np.testing.assert_allclose(joint.origin, [-0.1, -0.2, 0.0], atol=1e-12)
    np.testing.assert_allclose(joint.axis, [0.0, 0.0, -1.0], atol=1e-12)
    assert (joint.effort, joint.friction) == (100.0, 0.0)
    plate, box = door.hulls
    np.testing.assert_allclose(np.sort(np.ptp(plate.vertices, axis=0)), [0.001, 1.0, 1.0], atol=1e-9)
    np.testing.assert_allclose(np.ptp(box.vertices, axis=0), [0.3, 0.1, 0.2], atol=1e-12)
    assert len(package.records) == 1
    assert "flat.obj" in package.records[0]
    bare = read_package(foreign, appearance=False)
    assert not any(link.visuals for link in bare.links)
    assert [link.parts for link in bare.links] == [link.parts for link in package.links]
    visual = door.visuals[0]
    assert visual.label == "handle"
    assert isinstance(visual.mesh, SourceMesh)
    np.testing.assert_allclose(visual.mesh.T_object_file[:3, 3], [0.0, 0.0, 0.0], atol=1e-12)


@pytest.fixture
def sourced(package, foreign) -> SimPackage:
    """The cabinet's drawer drawn with somebody's files, half as large and turned."""
    T = np.eye(4)
    T[:3, :3] = [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    T[:3, 3] = [0.1, 0.2, 0.3]
    mesh = SourceMesh(path=foreign / "textured_objs" / "a.obj", T_object_file=T, scale=0.5)
    link = package.links[0]
    visuals = tuple(replace(visual, mesh=mesh) for visual in link.visuals)
    links = (replace(link, visuals=visuals), *package.links[1:])
    return replace(package, links=links, visual="source")


def test_source_visuals_travel_with_their_images(sourced, tmp_path):
    import mujoco
    import yourdfpy

    folder = write_package(sourced, tmp_path / "out" / "cabinet")
    again = read_package(folder)
    visual = again.links[0].visuals[0]
    assert isinstance(visual.mesh, SourceMesh)
    assert visual.mesh.scale == pytest.approx(0.5)
    before = sourced.links[0].visuals[0].mesh
    assert isinstance(before, SourceMesh)
    np.testing.assert_allclose(visual.mesh.T_object_file, before.T_object_file, atol=1e-9)
    mesh = read_mesh(visual.mesh.path)
    assert mesh.texture is not None
    assert mesh.texture.shape == (2, 2, 3)
    assert len(list((folder / "visual").glob("texture_*.png"))) == 1
    assert package_files(again) == read_folder(folder)
    model = mujoco.MjModel.from_xml_path(str(folder / "mobility.mjcf.xml"))
    assert model.geom("drawer_link_0_0").rgba[0] == pytest.approx(90 / 255, abs=1e-3)
    mujoco.MjModel.from_xml_path(str(folder / "mobility.urdf"))
    robot = yourdfpy.URDF.load(str(folder / "mobility.urdf"))
    assert robot.validate()
    placed = {name: geometry for name, geometry in robot.scene.geometry.items() if "drawer_link_0_0" in name}
    T, name = robot.scene.graph[
        "drawer_link_0_0.obj" if "drawer_link_0_0.obj" in placed else next(iter(placed))
    ]
    corners = placed[name].vertices @ T[:3, :3].T + T[:3, 3]
    expected = (
        parse_obj(before.path).vertices * 0.5 @ before.T_object_file[:3, :3].T + before.T_object_file[:3, 3]
    )
    np.testing.assert_allclose(corners.min(axis=0), expected.min(axis=0), atol=1e-6)
    np.testing.assert_allclose(corners.max(axis=0), expected.max(axis=0), atol=1e-6)


@pytest.mark.parametrize("image", ["../../secret.png", "/etc/hostname", "../images/gone.png"])
def test_source_files_cannot_pull_in_others(sourced, foreign, tmp_path, image):
    (tmp_path / "secret.png").write_bytes(b"secret")
    (foreign / "textured_objs" / "a.mtl").write_text(f"newmtl wood\nmap_Kd {image}\n")
    with pytest.raises(PackageError, match=r"outside|cannot be read"):
        write_package(sourced, tmp_path / "out" / "cabinet")
    assert not (tmp_path / "out" / "cabinet").exists()


def test_normals_are_sharp_on_boxes_and_smooth_on_balls():
    import trimesh

    box = box_hull(np.zeros(3), np.ones(3))
    normals = corner_normals(box.vertices[box.faces])
    np.testing.assert_allclose(np.abs(normals).max(axis=2), 1.0)
    ball = trimesh.creation.icosphere(subdivisions=3)
    normals = corner_normals(ball.vertices[ball.faces])
    np.testing.assert_allclose(normals, np.array(ball.vertices)[ball.faces], atol=0.02)
    lines = obj_text(Mesh(vertices=box.vertices, faces=box.faces), "box").splitlines()
    assert sum(line.startswith("vn ") for line in lines) == 6
    assert sum(line.startswith("f ") for line in lines) == 12


@pytest.mark.real
def test_real_folders_can_all_be_read(real_objects):
    folders = sorted((real_objects / "partnet_mobility").iterdir())[::12]
    assert len(folders) > 10
    for folder in folders:
        package = read_package(folder)
        assert len(package.links) == len(package.joints) + 1
        assert any(link.hulls for link in package.links)
        assert any(link.label is not None for link in package.links)


def test_a_glb_has_a_node_per_link_and_the_meshes_where_they_are(cabinet: Asset):
    package = as_package(scaled(cabinet), box_geometry())
    data = glb_bytes(package)
    assert data == glb_bytes(package)
    scene = trimesh.load(io.BytesIO(data), file_type="glb")
    assert {link.name for link in package.links} <= set(scene.graph.nodes)
    moved = scene.copy()
    moved.apply_transform(np.linalg.inv(Y_UP))
    corners = np.concatenate([v.mesh.vertices for link in package.links for v in link.visuals])
    np.testing.assert_allclose(moved.bounds, [corners.min(axis=0), corners.max(axis=0)], atol=1e-5)
    # Up is y and the front faces +z, as glTF says.
    assert Y_UP[:3, :3] @ [0, 0, 1] == pytest.approx([0, 1, 0])
    assert Y_UP[:3, :3] @ [-1, 0, 0] == pytest.approx([0, 0, 1])


def test_gaussians_of_links_come_back(cabinet: Asset, tmp_path: Path):
    asset = replace(scaled(cabinet), gaussians=splat_surface(few_samples(cabinet)))
    plain = as_package(asset, box_geometry())
    package = replace(plain, links=attach_splats(plain.links, asset))
    write_package(package, tmp_path / "one")
    back = read_package(tmp_path / "one")
    shown = [link.name for link in package.links if link.splats is not None]
    assert sorted(path.stem for path in (tmp_path / "one" / "splats").iterdir()) == sorted(shown)
    assert sum(len(link.splats.means) for link in package.links if link.splats) == len(asset.gaussians.means)
    for index, (one, two) in enumerate(zip(package.links, back.links, strict=True)):
        assert (one.splats is None) == (two.splats is None)
        if one.splats is not None:
            np.testing.assert_allclose(two.splats.means, one.splats.means, atol=1e-6)
            np.testing.assert_allclose(two.splats.scales, one.splats.scales, rtol=1e-5)
            np.testing.assert_array_equal(two.splats.part_ids, index)
    assert manifest_problems(tmp_path / "one") == ()
    (tmp_path / "one" / "splats" / f"{shown[0]}.ply").write_bytes(b"ply\n")
    with pytest.raises(PackageError, match="PLY"):
        read_package(tmp_path / "one")


def few_samples(asset: Asset) -> SurfaceSamples:
    assert asset.surface is not None
    return SurfaceSamples(**{name: value[::40] for name, value in vars(asset.surface).items()})


@pytest.mark.parametrize("wrong", [3, None, ["a"]])
def test_a_provenance_that_is_no_text_is_named_by_its_key(package, tmp_path, wrong):
    """Both when a package is written and when it is read."""
    with pytest.raises(PackageError, match=r"provenance 'seed' is .*, expected a text"):
        write_package(replace(package, provenance=(("seed", wrong),)), tmp_path / "a")
    folder = write_package(package, tmp_path / "b")
    (folder / "provenance.json").write_text(json.dumps({"source": "x", "seed": wrong}))
    with pytest.raises(PackageError, match=r"provenance\.json: 'seed' is .*, expected a text"):
        read_package(folder)
