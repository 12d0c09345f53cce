"""Laws of the PartNet-Mobility reader, on the sample cabinet's own folder and on real objects."""

import json
import re
import shutil
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from cabinet_files import assert_same_parts
from PIL import Image
from project import ROOT
from sample_cabinet import SAMPLE_PARTS
from sample_partnet import write_sample

from artigen.datasets.part_labels import LABEL_TABLE, label_nodes
from artigen.datasets.partnet_annotation import SourceNode, read_nodes
from artigen.datasets.partnet_joints import motion
from artigen.datasets.partnet_mobility import ReaderConfig, find_rest_poses, read_object
from artigen.datasets.sizes import FALLBACK, estimate_size
from artigen.errors import SourceError
from artigen.kind import find_category, list_categories
from artigen.kinematics import articulate_points, qlimits
from artigen.transforms import transform_points
from artigen.types import PART_LABELS

FAST = ReaderConfig(samples=20_000, size=1.0)
DOCS = ROOT / "docs" / "reference" / "partnet_mobility.md"


@pytest.fixture(scope="session")
def pristine(tmp_path_factory) -> Path:
    """The sample as a PartNet-Mobility folder; not to be changed."""
    folder = tmp_path_factory.mktemp("partnet") / "sample"
    write_sample(folder)
    return folder


@pytest.fixture
def folder(pristine, tmp_path) -> Path:
    """A copy of the sample's folder, to be damaged."""
    return Path(shutil.copytree(pristine, tmp_path / "sample"))


@pytest.fixture(scope="session")
def source(pristine):
    """The sample's folder as read."""
    return read_object(pristine, FAST)


def edit_json(path: Path, change) -> None:
    value = json.loads(path.read_text())
    changed = change(value)
    path.write_text(json.dumps(value if changed is None else changed))


def replace_text(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def test_the_sample_comes_back_exactly(source, cabinet):
    assert_same_parts(source.asset.parts, cabinet.parts)
    assert source.asset.notes == ()
    assert source.asset.category == "StorageFurniture"
    assert source.asset.scale == 1.0


def test_the_sample_is_written_the_same_every_time(pristine, tmp_path):
    write_sample(tmp_path / "again")
    files = sorted(path.relative_to(pristine) for path in pristine.rglob("*") if path.is_file())
    assert len(files) >= 40
    assert files == sorted(
        path.relative_to(tmp_path / "again") for path in (tmp_path / "again").rglob("*") if path.is_file()
    )
    for name in files:
        assert (pristine / name).read_bytes() == (tmp_path / "again" / name).read_bytes()


def test_reading_is_repeatable_and_the_seed_matters(source, pristine):
    again, other = read_object(pristine, FAST), read_object(pristine, replace(FAST, seed=1))
    for name in ("points", "normals", "colors", "part_ids"):
        np.testing.assert_array_equal(getattr(again.asset.surface, name), getattr(source.asset.surface, name))
    assert not np.array_equal(other.asset.surface.points, source.asset.surface.points)


def test_pieces_are_found_by_visual_names_where_there_is_no_listing(folder, cabinet):
    (folder / "result.json").unlink()
    assert_same_parts(read_object(folder, FAST).asset.parts, cabinet.parts)


def test_meshes_are_found_by_link_where_names_say_nothing(folder, cabinet):
    (folder / "result.json").unlink()
    urdf = folder / "mobility.urdf"
    urdf.write_text(re.sub(r'<visual name="[^"]*">', "<visual>", urdf.read_text()))
    parts = read_object(folder, FAST).asset.parts
    assert [part.label for part in parts] == ["base", "drawer", "door", "knob", "tray"]
    door, handle = (cabinet.parts[index].box for index in (4, 5))
    whole = np.stack([door[0] - door[1] / 2, door[0] + door[1] / 2])
    low = np.minimum(whole[0], handle[0] - handle[1] / 2)
    np.testing.assert_allclose(parts[2].box[0] - parts[2].box[1] / 2, low, atol=1e-6)


def move_meshes(folder: Path, names: list[str], T: np.ndarray) -> None:
    """Moves mesh files rigidly, in their own frame."""
    for name in names:
        path = folder / "textured_objs" / f"{name}.obj"
        lines = path.read_text().splitlines()
        for number, line in enumerate(lines):
            if line.startswith("v "):
                point = transform_points(T, np.array([[float(word) for word in line.split()[1:]]]))[0]
                lines[number] = "v " + " ".join(f"{value:.12f}" for value in point)
        path.write_text("\n".join(lines) + "\n")


def draw_open(folder: Path, number: int, q: float, *, reverse: bool) -> None:
    """Redraws a node (and what it carries) at ``q`` and states its limits from there."""
    nodes = read_nodes(folder / "mobility_v2.json")
    T = motion(nodes[number], np.array(q))
    carried = [node.id for node in nodes if node.id == number or node.parent == number]
    pieces = [piece.id for node in nodes if node.id in carried for piece in node.pieces]
    move_meshes(folder, [f"original-{piece}" for piece in pieces], T)

    def change(value):
        for node in value:
            if node["parent"] == number:
                axis = node["jointData"]["axis"]
                axis["origin"] = transform_points(T, np.array([axis["origin"]]))[0].tolist()
                axis["direction"] = (T[:3, :3] @ axis["direction"]).tolist()
        data = value[number]["jointData"]
        data["limit"]["a"], data["limit"]["b"] = -q, data["limit"]["b"] - q
        if reverse:
            data["axis"]["direction"] = [-entry for entry in data["axis"]["direction"]]
            data["limit"]["a"], data["limit"]["b"] = q, -data["limit"]["b"]

    edit_json(folder / "mobility_v2.json", change)


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize(("number", "share"), [(0, 0.4), (0, 1.0), (1, 0.5), (1, 1.0), (3, 0.3), (1, -0.2)])
def test_the_drawn_pose_does_not_matter(folder, cabinet, number, share, reverse):
    reach = read_nodes(folder / "mobility_v2.json")[number].b
    draw_open(folder, number, share * reach, reverse=reverse)
    asset = read_object(folder, FAST).asset
    assert_same_parts(asset.parts, cabinet.parts)
    assert any("moved by" in note for note in asset.notes)


def test_limits_that_run_from_open_to_closed_are_turned_round(folder, cabinet):
    def change(value):
        limit = value[1]["jointData"]["limit"]
        limit["a"], limit["b"] = limit["b"], limit["a"]

    edit_json(folder / "mobility_v2.json", change)
    asset = read_object(folder, FAST).asset
    assert_same_parts(asset.parts, cabinet.parts)
    assert any("closed at the other end" in note for note in asset.notes)


def test_a_door_that_swings_both_ways_rests_shut(folder, cabinet):
    edit_json(folder / "mobility_v2.json", lambda v: v[1]["jointData"]["limit"].update(a=-60, b=90))
    asset = read_object(folder, FAST).asset
    assert_same_parts(asset.parts, cabinet.parts)
    assert any("closed inside the range, range cut" in note for note in asset.notes)


def test_a_window_drawn_ajar_that_swings_both_ways_rests_shut(folder):
    pane = "v 0.25 0.5 0.308\nv -0.25 0.5 0.308\nv 0 -0.5 0.308\nf 1 2 3\n"
    for name in ("original-7", "original-8", "original-9"):
        (folder / "textured_objs" / f"{name}.obj").write_text(pane)

    def change(value):
        value[1]["jointData"]["axis"]["origin"] = [0.0, 0.0, 0.308]
        value[1]["jointData"]["limit"].update(a=-80, b=90)

    edit_json(folder / "mobility_v2.json", change)
    draw_open(folder, 1, 35.0, reverse=False)
    door = read_object(folder, FAST).asset.parts[4]
    assert door.box[1][0] == pytest.approx(0.0, abs=0.01)  # flat in the front
    assert np.degrees(door.joint.upper) == pytest.approx(90, abs=4)


def test_a_slider_that_turns_is_a_screw_and_one_that_turns_freely_is_continuous(folder, cabinet):
    extra = {"rotates": True, "noRotationLimit": False, "rotationLimit": 180}
    edit_json(folder / "mobility_v2.json", lambda v: v[3]["jointData"]["limit"].update(extra))
    part, want = read_object(folder, FAST).asset.parts[7], cabinet.parts[7]
    assert part.joint.type == "screw"
    assert part.joint.upper == pytest.approx(np.pi)
    assert part.joint.pitch * part.joint.upper == pytest.approx(want.joint.upper)
    edit_json(folder / "mobility_v2.json", lambda v: v[3]["jointData"]["limit"].update(noRotationLimit=True))
    asset = read_object(folder, FAST).asset
    assert asset.parts[7].joint.type == "continuous"
    assert any("the slide was dropped" in note for note in asset.notes)


def test_the_annotation_wins_over_the_urdf(folder, cabinet):
    replace_text(folder / "mobility.urdf", 'type="prismatic"', 'type="fixed"')
    replace_text(folder / "mobility.urdf", 'type="revolute"', 'type="fixed"')
    asset = read_object(folder, FAST).asset
    assert_same_parts(asset.parts, cabinet.parts)
    said = next(note for note in asset.notes if "URDF differs" in note)
    assert "link_0 is fixed instead of prismatic" in said
    assert "link_1 is fixed instead of revolute" in said


def test_geometry_that_the_urdf_shifts_is_drawn_where_it_lies(folder, cabinet):
    text = (folder / "mobility.urdf").read_text()
    handle = re.search(r'<visual name="handle-6"><origin xyz="([^"]*)"', text)
    replace_text(
        folder / "mobility.urdf", f'handle-6"><origin xyz="{handle[1]}"', 'handle-6"><origin xyz="9 0 0"'
    )
    asset = read_object(folder, FAST).asset
    assert_same_parts(asset.parts, cabinet.parts)
    assert any("1 visuals are shifted by the URDF" in note for note in asset.notes)


def test_junk_and_what_hangs_on_it_is_left_out(folder, cabinet):
    def change(value):
        junk = {"id": 9, "parent": -1, "joint": "junk", "name": "outlier", "parts": [], "jointData": {}}
        value.append(junk)
        value[2]["parent"] = 9

    edit_json(folder / "mobility_v2.json", change)
    asset = read_object(folder, FAST).asset
    assert [part.label for part in asset.parts].count("knob") == 0
    assert len(asset.parts) == len(cabinet.parts) - 1
    assert sum("is junk" in note for note in asset.notes) == 2


@pytest.mark.parametrize(("gap", "count"), [(0.035, 1), (0.045, 2)])
def test_handles_of_one_name_are_one_where_they_are_near(folder, gap: float, count: int):
    """Gaps are shares of the longest edge."""
    whole = read_object(folder, FAST)
    assert add_handle(folder, gap / whole.visuals[0].scale) == ["handle"] * count


def test_separate_handles_of_one_name_become_parts(folder):
    assert add_handle(folder, 0.3) == ["handle", "handle"]


def add_handle(folder: Path, gap: float) -> list[str]:
    """Copies a handle to below itself, with a gap (m); returns the labels of the parts of its carrier."""
    edit_json(
        folder / "mobility_v2.json", lambda v: v[0]["parts"].__setitem__(5, v[0]["parts"][5] | {"id": 6})
    )
    path = folder / "textured_objs" / "original-6.obj"
    blocks = path.read_text()
    vertices = [line for line in blocks.splitlines() if line.startswith("v ")]
    low = np.array([[float(word) for word in line.split()[1:]] for line in vertices])
    down = np.ptp(low[:, 1]) + gap
    moved = [f"v {x:.9f} {y - down:.9f} {z:.9f}" for x, y, z in low]
    faces = [line for line in blocks.splitlines() if line.startswith("f ")]
    count = len(vertices)
    second = ["f " + " ".join(str(int(word) + count) for word in line.split()[1:]) for line in faces]
    path.write_text("\n".join([*vertices, *moved, *faces, *second]) + "\n")
    return [part.label for part in read_object(folder, FAST).asset.parts if part.parent == 2]


def test_a_part_never_loses_all_it_has_to_its_handle(folder):
    def change(value):
        value[1]["parts"] = [piece for piece in value[1]["parts"] if piece["name"] == "handle"]

    edit_json(folder / "mobility_v2.json", change)
    (folder / "result.json").unlink()
    urdf = folder / "mobility.urdf"
    text = re.sub(r'<visual name="cabinet_door_surface-7">.*?</visual>', "", urdf.read_text())
    urdf.write_text(text)
    parts = read_object(folder, FAST).asset.parts
    carried = [part for part in parts if part.joint.type == "revolute"]
    assert len(carried) == 1
    assert not [part for part in parts if part.parent == parts.index(carried[0]) and part.label == "handle"]


def test_samples_are_uniform_on_the_surface_and_carry_its_colours(source, cabinet):
    surface, mesh = source.asset.surface, source.triangles
    corners = mesh.vertices[mesh.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    share = np.bincount(mesh.part_ids, weights=area) / area.sum()
    np.testing.assert_allclose(np.bincount(surface.part_ids) / len(surface.points), share, atol=2e-3)
    for index, part in enumerate(source.asset.parts):
        own = surface.part_ids == index
        assert np.abs(surface.points[own] - part.box[0]).max(axis=0) == pytest.approx(
            part.box[1] / 2, abs=5e-3
        )
        allowed = {box.color for box in SAMPLE_PARTS[index].boxes}
        assert {tuple(color) for color in surface.colors[own].tolist()} == allowed
        x_face = np.abs(surface.normals[own][:, 0]) > 0.99
        assert x_face.any()
    # The front of the drawer is a plane at x = -0.25 metres, facing -x.
    front = surface.points[(surface.part_ids == 2) & (surface.normals[:, 0] < -0.99)]
    assert (
        np.abs(front[:, 0] - (source.asset.parts[2].box[0] - source.asset.parts[2].box[1] / 2)[0]).min()
        < 1e-6
    )


def test_visuals_lie_where_the_triangles_are(source):
    from artigen.files.wavefront import read_obj

    mesh = source.triangles
    found = []
    for visual in source.visuals:
        vertices = read_obj(visual.path, visual.path.parents[1]).vertices
        found.append(transform_points(visual.T_unit_file, visual.scale * vertices))
        assert source.asset.parts[visual.part].label in PART_LABELS
        assert re.fullmatch(r"[a-z_]+-\d+", visual.name)
    np.testing.assert_allclose(np.concatenate(found), mesh.vertices, atol=1e-12)
    used = mesh.vertices[np.unique(mesh.faces)]
    np.testing.assert_allclose(used.min(axis=0) + used.max(axis=0), 0.0, atol=1e-9)
    assert (used.max(axis=0) - used.min(axis=0)).max() == pytest.approx(1.0)


def test_colours_come_from_the_image_where_there_is_one(folder):
    (folder / "images").mkdir()
    texels = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 0]]], dtype=np.uint8)
    Image.fromarray(texels).save(folder / "images" / "texture_0.png")
    objs = folder / "textured_objs"
    (objs / "original-7.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd ../images/texture_0.png\n")
    quad = "v -0.3 -0.5 0.4\nv 0.3 -0.5 0.4\nv 0.3 0.3 0.4\nv -0.3 0.3 0.4\n"
    (objs / "original-7.obj").write_text(
        f"mtllib original-7.mtl\n{quad}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n"
    )
    asset = read_object(folder, FAST).asset
    door = asset.surface.part_ids == 4
    y, z = ((asset.surface.points[door] - asset.parts[4].box[0])[:, 1:] / asset.parts[4].box[1, 1:]).T
    right, top = y < 0, z > 0  # PartNet's +x is our -y
    expected = texels[np.where(top, 0, 1), np.where(right, 1, 0)]
    assert door.sum() > 100
    clear = (np.abs(y) > 0.01) & (np.abs(z) > 0.01)
    np.testing.assert_array_equal(asset.surface.colors[door][clear], expected[clear])
    (folder / "images" / "texture_0.png").unlink()
    asset = read_object(folder, FAST).asset
    assert any("1 images are missing" in note and "texture_0.png" in note for note in asset.notes)
    (folder / "images" / "texture_0.png").write_bytes(b"no image")
    with pytest.raises(SourceError, match=r"texture_0\.png: image cannot be decoded"):
        read_object(folder, FAST)


@pytest.mark.parametrize("name", ["../../../secret.png", "/Users/someone/secret.png"])
def test_images_outside_of_the_folder_are_noted_and_not_read(folder, name):
    (folder.parent.parent / "secret.png").write_bytes(b"no image")  # an error if it were read
    with (folder / "textured_objs" / "original-9.mtl").open("a") as lines:
        lines.write(f"\nmap_Kd {name}\n")
    notes = read_object(folder, FAST).asset.notes
    assert any("1 images are missing" in note and name in note for note in notes)


def test_missing_meshes_are_noted_while_geometry_is_left(folder):
    (folder / "textured_objs" / "original-1.obj").unlink()
    asset = read_object(folder, FAST).asset
    assert "node 0 (drawer): 1 of 6 mesh files are missing or empty" in asset.notes
    lock = folder / "textured_objs" / "original-9.obj"
    lock.unlink()
    with pytest.raises(SourceError, match=r"node 2 \(knob\) has no geometry.*original-9\.obj"):
        read_object(folder, FAST)
    urdf = folder / "mobility.urdf"
    urdf.write_text(re.sub(r"<(visual|collision)[^>]*>[^\n]*original-9\.obj[^\n]*", "", urdf.read_text()))
    asset = read_object(folder, FAST).asset
    assert "node 2 (knob) was dropped: none of its mesh files exists" in asset.notes


BOMB = '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]>'


def set_node(number: int, **changes):
    return lambda folder: edit_json(folder / "mobility_v2.json", lambda v: v[number].update(changes))


def set_limit(number: int, **changes):
    return lambda folder: edit_json(
        folder / "mobility_v2.json", lambda v: v[number]["jointData"]["limit"].update(changes)
    )


def set_axis(number: int, **changes):
    return lambda folder: edit_json(
        folder / "mobility_v2.json", lambda v: v[number]["jointData"]["axis"].update(changes)
    )


def in_urdf(old: str, new: str):
    return lambda folder: replace_text(folder / "mobility.urdf", old, new)


def in_mesh(old: str, new: str):
    return lambda folder: replace_text(folder / "textured_objs" / "original-9.obj", old, new)


def write(name: str, text: str):
    return lambda folder: (folder / name).write_text(text)


def drop(name: str):
    return lambda folder: (folder / name).unlink()


BREAKS = {
    "no annotation": (drop("mobility_v2.json"), r"mobility_v2\.json: file is missing"),
    "no urdf": (drop("mobility.urdf"), r"mobility\.urdf: cannot be read"),
    "no category": (write("meta.json", "{}"), r"meta\.json: 'model_cat' holds None"),
    "broken json": (write("mobility_v2.json", '[{"id": 0,'), r"mobility_v2\.json: not valid JSON"),
    "deep json": (write("result.json", "[" * 100_000), r"result\.json: not valid JSON"),
    "nan in json": (write("mobility_v2.json", "[NaN]"), "NaN, which is not a number"),
    "other json": (write("mobility_v2.json", "[]"), "expected a list of at least one node"),
    "cycle": (set_node(1, parent=2), r"node 1: its parents \[1, 2\] form a cycle"),
    "own parent": (set_node(0, parent=0), r"node 0: its parents \[0\] form a cycle"),
    "unknown parent": (set_node(0, parent=77), "node 0: parent 77 is not a node"),
    "two ids": (set_node(0, id=1), r"node ids occur twice: \[1\]"),
    "two roots": (set_node(0, parent=-1, joint="heavy"), r"2 root nodes that are not junk \(0 \(drawer\), 4"),
    "no root": (set_node(4, joint="junk"), "0 root nodes that are not junk"),
    "unknown joint": (set_node(0, joint="spring"), "node 0: joint 'spring' is not one of static"),
    "text id": (set_node(0, id="0"), "node 0: 'id' holds '0', expected int"),
    "radians of a million": (set_limit(1, b=1e6), r"node 1: 'b' is 1e\+06 degrees.*wrong unit"),
    "millimetres": (set_limit(0, b=360.0), r"node 0: 'b' is 360 PartNet lengths.*wrong unit"),
    "null limit": (set_limit(0, b=None), "node 0: 'b' holds None, expected a number"),
    "no axis": (set_axis(0, direction=[0, 0, 0]), r"node 0: axis direction \[0.0, 0.0, 0.0\] has no length"),
    "flat axis": (set_axis(1, origin=[0, 0]), r"node 1: 'origin' holds \[0, 0\], expected three numbers"),
    "broken xml": (in_urdf("</robot>", ""), r"mobility\.urdf: not valid XML"),
    "entity bomb": (in_urdf("<robot", BOMB + "<robot"), "declares a DTD or entities, which are refused"),
    "urdf cycle": (
        in_urdf(
            '<child link="link_0"/><parent link="link_4"/>', '<child link="link_0"/><parent link="link_0"/>'
        ),
        "link 'link_0' is its own ancestor",
    ),
    "urdf roots": (
        in_urdf('<link name="base"/>', '<link name="base"/><link name="b2"/>'),
        r"2 root links \(b2, base\)",
    ),
    "urdf joint": (
        in_urdf('type="prismatic"', 'type="spring"'),
        "joint 'joint_0': type 'spring' is not one of",
    ),
    "urdf link": (
        in_urdf('<parent link="link_4"/>', '<parent link="nowhere"/>'),
        "parent 'nowhere', which is no link",
    ),
    "urdf nan": (
        in_urdf('<axis xyz="', '<limit lower="nan"/><axis xyz="'),
        r"limits \[nan, .*\], expected numbers",
    ),
    "urdf scale": (in_urdf("<mesh ", '<mesh scale="2 2 2" '), "mesh scale '2 2 2', expected 1 1 1"),
    "escaping mesh": (
        in_urdf("textured_objs/original-1.obj", "../../etc/passwd"),
        r"names file '\.\./\.\./etc/passwd', which lies outside",
    ),
    "absolute mesh": (
        in_urdf("textured_objs/original-1.obj", "/etc/passwd"),
        "'/etc/passwd', which lies outside",
    ),
    "escaping listing": (
        lambda folder: replace_text(folder / "result.json", "original-3", "../../../x"),
        r"result\.json: names file '\.\./\.\./\.\./x\.obj', which lies outside",
    ),
    "bad colour": (
        write("textured_objs/original-9.mtl", "newmtl a\nKd 1 x 0\n"),
        "material 'a' has Kd '1 x 0'",
    ),
    "nan vertex": (
        in_mesh("v ", "v nan 0 0\nv "),
        r"original-9\.obj: 'v' line 1 is 'nan 0 0', expected 3 finite numbers",
    ),
    "text vertex": (in_mesh("v ", "v one 0 0\nv "), "a 'v' line holds something that is not a number"),
    "short vertex": (in_mesh("v ", "v 0 0\nv "), "'v' line 1 is '0 0', expected 3 numbers"),
    "far face": (in_mesh("f 1 2 4", "f 1 2 400"), r"'1 2 400' names a vertex .* allowed are 1\.\.8"),
    "face from zero": (in_mesh("f 1 2 4", "f 0 2 4"), r"'0 2 4' names a vertex .* allowed are 1\.\.8"),
    "two corners": (in_mesh("f 1 2 4", "f 1 2"), "face '1 2' is malformed"),
    "text face": (in_mesh("f 1 2 4", "f 1 2 x"), "a face holds something that is not an index"),
    "empty mesh": (write("textured_objs/original-9.obj", "v 0 0 0\n"), r"node 2 \(knob\) has no geometry"),
    "no base": (
        lambda folder: [(folder / "textured_objs" / f"original-{n}.obj").unlink() for n in range(11, 20)],
        r"node 4 \(cabinet_frame\) has no geometry",
    ),
}


@pytest.mark.parametrize("name", BREAKS)
def test_a_bad_source_is_one_clear_error(folder, name):
    damage, message = BREAKS[name]
    damage(folder)
    with pytest.raises(SourceError, match=message) as caught:
        read_object(folder, FAST)
    assert "\n" not in str(caught.value)


def test_links_out_of_the_folder_are_refused(folder, tmp_path):
    secret = tmp_path / "secret.obj"
    secret.write_text("v 0 0 0\n")
    mesh = folder / "textured_objs" / "original-9.obj"
    mesh.unlink()
    mesh.symlink_to(secret)
    with pytest.raises(SourceError, match="lies outside"):
        read_object(folder, FAST)


@pytest.mark.parametrize("wrong", [{"samples": 0}, {"size": -1.0}, {"size": float("nan")}])
def test_a_senseless_config_is_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        ReaderConfig(**wrong)


def label_table_markdown() -> str:
    """The table of names as Markdown, for the documentation."""
    rows = [
        "| names, in order of precedence | on a hinge | on a slider | for instance |",
        "|---|---|---|---|",
    ]
    for rule in LABEL_TABLE:
        names = ", ".join(f"`{name}`" for name in rule.names)
        rows.append(f"| {names} | {rule.hinge or ''} | {rule.slider or ''} | {rule.example} |")
    return "\n".join(rows) + "\n"


def size_table_markdown() -> str:
    """The table as Markdown, for the documentation."""
    rows = [
        "| category | extent | metres | for height / footprint up to | depth at most |",
        "|---|---|---|---|---|",
    ]
    known = {category.name: (category.size, category.deepest) for category in list_categories()}
    for category, (rules, deepest) in {**known, "any other": (FALLBACK, np.inf)}.items():
        for rule in rules:
            bound = "" if np.isinf(rule.up_to) else f"{rule.up_to:g}"
            note = f" ({rule.note})" if rule.note else ""
            depth = "" if np.isinf(deepest) else f"{deepest:g}"
            rows.append(f"| {category}{note} | {rule.extent} | {rule.metres:g} | {bound} | {depth} |")
    return "\n".join(rows) + "\n"


def test_the_documented_tables_are_the_ones_in_force():
    text = DOCS.read_text()
    assert label_table_markdown() in text
    assert size_table_markdown() in text
    names = [name for rule in LABEL_TABLE for name in rule.names]
    assert len(names) == len(set(names))


@pytest.mark.parametrize(
    ("parent", "joint", "axis", "length", "label"),
    [
        (1, "hinge", (1.0, 0.0, 0.0), 0.5, "knob"),  # a lever
        (1, "hinge", (0.7, 0.6, 0.0), 0.5, "knob"),
        (1, "hinge", (0.6, 0.7, 0.0), 0.5, "handle"),  # a bail
        (1, "hinge", (1.0, 0.0, 0.0), 0.51, "handle"),
        (1, "slider", (1.0, 0.0, 0.0), 0.5, "handle"),
        (0, "hinge", (1.0, 0.0, 0.0), 0.5, "handle"),
    ],
)
def test_a_handle_is_a_knob_if_it_turns_about_an_axis_through_its_door(parent, joint, axis, length, label):
    def corners(x, y, z):
        return np.array(list(product(x, y, z)), dtype=float)

    nodes = (
        SourceNode(id=0, parent=-1, joint="heavy", name="body", pieces=()),
        SourceNode(id=1, parent=0, joint="hinge", name="door", pieces=(), direction=(0.0, 0.0, 1.0)),
        SourceNode(id=2, parent=parent, joint=joint, name="handle", pieces=(), direction=axis),
    )
    boxes = {
        0: corners((0.0, 1.0), (0.0, 1.0), (0.0, 2.0)),
        1: corners((-0.05, 0.0), (0.0, 1.0), (0.0, 1.0)),
        2: corners((-0.1, -0.05), (0.1, 0.1 + length), (0.5, 0.55)),
    }
    assert label_nodes(nodes, boxes, np.eye(4))[0] == {0: "base", 1: "door", 2: label}


@pytest.mark.parametrize(
    ("carrier", "low", "rest"), [("door", -45.0, 0.0), ("base", -45.0, -45.0), ("door", -10.0, -10.0)]
)
def test_a_lever_that_turns_both_ways_rests_in_the_middle_and_a_dial_at_its_end(carrier, low, rest):
    """The lever lies level in the middle of its face, whichever way it turns."""
    turning = SourceNode(
        id=1, parent=0, joint="hinge", name="lever", pieces=(), direction=(1.0, 0.0, 0.0), a=low, b=45.0
    )
    nodes = (SourceNode(id=0, parent=-1, joint="heavy", name="body", pieces=()), turning)
    face, lever = ((0.0, 0.1), (-0.5, 0.5), (-0.5, 0.5)), ((-0.05, 0.0), (-0.1, 0.1), (-0.01, 0.01))
    corners = {k: np.array(list(product(*box)), dtype=float) for k, box in enumerate((face, lever))}
    labels = {0: carrier, 1: "knob"}
    assert find_rest_poses(nodes, labels, corners)[1].rest == rest


@pytest.mark.parametrize("category", [*(category.name for category in list_categories()), "SpaceShip"])
def test_sizes_depend_on_proportions_alone(category):
    rng = np.random.default_rng(0)
    for extents in rng.uniform(0.2, 1.0, (20, 3)):
        size, known = estimate_size(category, extents)
        assert known == (find_category(category) is not None)
        assert 0.01 < size <= 2.4
        assert estimate_size(category, 7.0 * extents)[0] == pytest.approx(size)
        depth = size * extents[0] / extents.max()
        assert depth <= getattr(find_category(category), "deepest", np.inf) + 1e-9


def test_sizes_of_sources_are_those_of_catalogues():
    assert estimate_size("Refrigerator", np.array([0.6, 0.6, 1.5]))[0] == pytest.approx(1.75)
    assert estimate_size("Table", np.array([0.8, 1.6, 0.75]))[0] == pytest.approx(1.6)


REAL = (
    "7265",
    "10905",
    "12085",
    "12428",
    "20279",
    "28164",
    "45332",
    "46481",
    "7201",
    "103508",
    "24152",
    "3517",
)


@pytest.mark.real
@pytest.mark.parametrize("name", REAL)
def test_real_objects_rest_closed_and_open_outward(real_objects, name):
    asset = read_object(real_objects / "partnet_mobility" / name, replace(FAST, size=None)).asset
    surface, limits = asset.surface, qlimits(asset)
    assert (limits[:, 0] == 0).all()
    assert (limits[:, 1] > 0).all()

    def volume(share: float) -> float:
        points = articulate_points(asset, share * limits[:, 1], surface.points, surface.part_ids)
        return float(np.prod(points.max(axis=0) - points.min(axis=0)))

    opens = any(part.label in ("door", "drawer", "tray") for part in asset.parts)
    if opens:
        assert volume(0.0) < volume(0.5)
        assert volume(0.0) == pytest.approx(min(volume(share) for share in (0.0, 0.25, 0.5, 1.0)))
    assert (np.bincount(surface.part_ids, minlength=len(asset.parts)) > 0).all()


@pytest.mark.real
def test_frozen_joints_are_read_from_the_annotation(real_objects):
    defects = json.loads((real_objects / "known_defects.json").read_text())
    frozen = [name for name in sorted(defects) if "joints_frozen_in_urdf" in defects[name]]
    assert len(frozen) >= 5
    for name in frozen:
        asset = read_object(real_objects / "partnet_mobility" / name, replace(FAST, samples=2000)).asset
        assert any("URDF differs" in note and "is fixed instead of" in note for note in asset.notes), name


@pytest.mark.real
def test_objects_with_lost_meshes_are_read_or_refused_in_one_sentence(real_objects):
    defects = json.loads((real_objects / "known_defects.json").read_text())
    lost = [name for name in sorted(defects) if "geometry_missing" in defects[name]]
    assert len(lost) >= 5
    for name in lost:
        asset = read_object(real_objects / "partnet_mobility" / name, replace(FAST, samples=2000)).asset
        assert any("missing or empty" in note for note in asset.notes), name
    with pytest.raises(SourceError, match="100021"):
        read_object(real_objects / "partnet_mobility" / "100021", FAST)
