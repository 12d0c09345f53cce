"""Laws of reading any URDF: the object comes back, whatever the frame, the format and the spelling."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
import trimesh
from cabinet_files import assert_same_parts, box_visual, cabinet_urdf, joint, link, mesh_visual, urdf

from artigen.api.convert import ConvertJob, ConvertSettings, convert_object
from artigen.datasets.categories import guess_category
from artigen.datasets.mechanism_object import turn_upright
from artigen.datasets.part_labels import JOINT_TABLE, MovingPart, find_word, label_by_joint
from artigen.datasets.source_object import ReaderConfig
from artigen.datasets.sources import find_layout, find_sources, name_source, read_source
from artigen.datasets.urdf_file import read_urdf
from artigen.errors import SourceError
from artigen.files.urdf import UrdfJoint, parse_urdf
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.transforms import rotation_about
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.reference import build_reference

FAST = ReaderConfig(samples=5000)
BODY = link("body", box_visual((0.4, 0.6, 0.8)))
FLAP = link("flap", box_visual((0.02, 0.6, 0.3), (0, 0, 0.15)))


def read(folder: Path, *elements: str, cfg: ReaderConfig = FAST, name: str = "thing"):
    """Writes a URDF and reads it."""
    path = folder / f"{name}.urdf"
    path.write_text(urdf(*elements, name=name))
    (folder / "scratch").mkdir(exist_ok=True)
    return read_source(path, folder / "scratch", cfg)


def flap(*, limits=(0.0, 1.2), axis=(0, -1, 0), kind="revolute", extra=""):
    """A flap before the body, hinged at its lower edge."""
    return joint(kind, "body", "flap", xyz=(-0.21, 0, -0.4), axis=axis, limits=limits, extra=extra)


@pytest.mark.parametrize("form", ["box", "obj", "stl", "ply", "dae", "glb"])
def test_the_cabinet_comes_back_from_any_format_with_its_colours(cabinet, tmp_path, form):
    path = cabinet_urdf(tmp_path, form)
    (tmp_path / "scratch").mkdir()
    found = read_source(path, tmp_path / "scratch", FAST).asset
    assert_same_parts(found.parts, cabinet.parts, atol=1e-5)
    assert found.scale == pytest.approx(cabinet.scale)
    assert found.category == "StorageFurniture"
    if form != "dae":  # its writer says black
        for index in range(len(found.parts)):
            colors = [
                set(map(tuple, np.unique(a.surface.colors[a.surface.part_ids == index], axis=0)))
                for a in (found, cabinet)
            ]
            assert colors[0] <= colors[1]


SIDES = ("x", "-x", "y", "-y", "z", "-z")


@pytest.mark.parametrize(
    ("up", "front"), [(up, front) for up, front in product(SIDES, SIDES) if up[-1] != front[-1]]
)
def test_up_and_front_turn_the_object_to_our_frame(cabinet, tmp_path, up, front):
    R = turn_upright(up, front)[:3, :3]
    assert np.linalg.det(R) == pytest.approx(1.0)
    path = cabinet_urdf(tmp_path, R=R.T)
    cfg = ReaderConfig(samples=100, up=up, front=front)
    assert_same_parts(read_source(path, tmp_path, cfg).asset.parts, cabinet.parts)


def test_a_package_comes_back_with_its_joints_followers_and_size(tmp_path):
    for category, seed in (("TrashCan", 1), ("Printer", 0), ("Suitcase", 0)):
        shape = draw_shape(category, seed)
        package = build_reference(shape)
        folder = write_package(package, tmp_path / category)
        assert find_layout(folder) == "URDF"
        (tmp_path / f"scratch_{category}").mkdir()
        found = read_source(folder, tmp_path / f"scratch_{category}", FAST)
        asset = shape_to_asset(shape, resolution=None)
        assert found.asset.category == category
        assert found.asset.scale == pytest.approx(asset.scale, rel=1e-3)  # rounds are rounder than prisms
        assert len(found.asset.parts) == len(asset.parts)
        want = sorted((p.joint.type, p.joint.upper * asset.scale) for p in asset.parts)
        have = sorted((p.joint.type, p.joint.upper * found.asset.scale) for p in found.asset.parts)
        assert [kind for kind, _ in have] == [kind for kind, _ in want]
        assert [upper for _, upper in have] == pytest.approx([upper for _, upper in want], rel=1e-3)
        followers = sum(part.joint is not None and part.joint.follows is not None for part in shape.parts)
        assert len(found.follows) == followers == (1 if category == "TrashCan" else 0)


def test_a_screw_comes_back_as_one_joint(tmp_path):
    carrier = joint("revolute", "body", "carrier", xyz=(0, 0, 0.4), axis=(0, 0, 1), limits=(0, 6))
    travel = joint(
        "prismatic",
        "carrier",
        "cap",
        axis=(0, 0, 1),
        limits=(0, 0.03),
        extra='<mimic joint="to_carrier" multiplier="0.005"/>',
    )
    cap = link("cap", box_visual((0.05, 0.05, 0.02), (0, 0, 0.01)))
    found = read(tmp_path, BODY, link("carrier"), cap, carrier, travel).asset
    screw = found.parts[1].joint
    assert (screw.type, screw.upper) == ("screw", pytest.approx(6.0))
    assert screw.pitch * found.scale == pytest.approx(0.005)
    left = travel.replace("0.005", "-0.005")
    with pytest.raises(SourceError, match="'to_cap' follows 'to_carrier' as a left-handed screw"):
        read(tmp_path, BODY, link("carrier"), cap, carrier, left)


@pytest.mark.parametrize(("limits", "axis"), [((0, 1.2), (0, -1, 0)), ((-1.2, 0), (0, 1, 0))])
def test_the_limit_at_zero_is_closed_and_opening_is_positive(tmp_path, limits, axis):
    part = read(tmp_path, BODY, FLAP, flap(limits=limits, axis=axis)).asset.parts[1]
    assert (part.joint.lower, part.joint.upper) == (0.0, pytest.approx(1.2))
    np.testing.assert_allclose(part.joint.axis, (0, -1, 0), atol=1e-12)


@pytest.mark.parametrize(("ajar", "rest"), [(0.0, 0.0), (0.25, -0.25)])
def test_travel_below_zero_closes_a_part_only_if_it_was_drawn_ajar(tmp_path, ajar, rest):
    """A flap that is flush at 0 leans into the body below it; one that is drawn open closes there."""
    at = joint("revolute", "body", "flap", xyz=(-0.21, 0, -0.4), axis=(0, -1, 0), limits=(-0.25, 1.2))
    leaf = link("flap", box_visual((0.02, 0.6, 0.6), (0, 0, 0.3)))
    tilted = at.replace("<origin", f'<origin rpy="0 {-ajar} 0"')
    found = read(tmp_path, BODY, leaf, tilted)
    assert found.asset.parts[1].joint.upper == pytest.approx(1.2 - rest)
    box = found.asset.parts[1].box[1] * found.asset.scale
    assert box[0] == pytest.approx(0.02, abs=0.01)  # upright


@pytest.mark.parametrize(("share", "at_zero"), [(0.0199, True), (0.0201, False)])
def test_an_end_is_at_zero_within_two_hundredths_of_the_range(tmp_path, share, at_zero):
    """Then it is the closed one; beyond that a knob rests at its lower limit."""
    knob = link("knob", box_visual((0.04, 0.04, 0.04)))
    turned = joint("revolute", "body", "knob", xyz=(-0.22, 0, 0), limits=(share - 1.0, share))
    notes = read(tmp_path, BODY, knob, turned).asset.notes
    assert any("closed at the other end" in note for note in notes) == at_zero


def test_followers_close_and_open_with_their_leader(tmp_path):
    leaf = link("leaf", box_visual((0.02, 0.3, 0.3), (0, 0, 0.15)))
    mimic = '<mimic joint="to_flap" multiplier="-0.5" offset="0.1"/>'
    follower = joint("continuous", "body", "leaf", xyz=(-0.21, 0, 0), axis=(0, 1, 0), extra=mimic)
    found = read(tmp_path, BODY, FLAP, leaf, flap(limits=(0, 1.2)), follower)
    assert found.follows == (("door_1", "door_0"),)
    leaf_part = next(part for part in found.asset.parts if part.name == "door_1")
    assert (leaf_part.joint.type, leaf_part.joint.upper) == ("revolute", pytest.approx(0.6))
    np.testing.assert_allclose(leaf_part.joint.axis, (0, -1, 0), atol=1e-12)
    chained = joint(
        "prismatic",
        "body",
        "bolt",
        xyz=(-0.21, 0.2, 0.3),
        axis=(0, 1, 0),
        extra='<mimic joint="to_leaf" multiplier="0.2"/>',
    )
    bolt = link("bolt", box_visual((0.02, 0.05, 0.02)))
    found = read(tmp_path, BODY, FLAP, leaf, bolt, flap(limits=(0, 1.2)), follower, chained)
    assert [leader for _, leader in found.follows] == ["door_0", "door_0"]
    last = found.asset.parts[3].joint
    assert last.upper * found.asset.scale == pytest.approx(0.2 * 0.6)


def place_links(joints: list[UrdfJoint], leader: float) -> dict[str, np.ndarray]:
    """Poses of links that hang from the body, at a coordinate of ``to_flap``."""
    by_name = {one.name: one for one in joints}

    def value(one: UrdfJoint) -> float:
        at = by_name.get(one.mimic or "")
        return leader if at is None else one.mimic_multiplier * value(at) + one.mimic_offset

    return {one.child: one.T_parent_joint @ _step(one, value(one)) for one in joints}


def _step(one: UrdfJoint, value: float) -> np.ndarray:
    T = np.eye(4)
    if one.type == "prismatic":
        T[:3, 3] = value * one.axis
    else:
        T[:3, :3] = rotation_about(one.axis, np.array([value]))[0]
    return T


@pytest.mark.parametrize("offset", [0.0, 0.1, -0.7])
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_offsets_of_mimics_move_origins_and_nothing_else(tmp_path, kind, offset):
    """At every coordinate of the leader, followers of followers included, all links are where they were."""
    rows = (
        flap(limits=(0, 1.2)),
        joint(kind, "body", "leaf", xyz=(0.1, 0.2, 0.3), axis=(0, 0.6, 0.8), limits=(-1, 2),
              extra=f'<mimic joint="to_flap" multiplier="-0.5" offset="{offset}"/>'),
        joint("prismatic", "body", "bolt", axis=(1, 0, 0), limits=(-1, 1),
              extra='<mimic joint="to_leaf" multiplier="0.2" offset="0.05"/>'),
    )  # fmt: skip
    small = [link(name, box_visual((0.02, 0.05, 0.02))) for name in ("leaf", "bolt")]
    path = tmp_path / "thing.urdf"
    path.write_text(urdf(BODY, FLAP, *small, *rows))
    written, folded = parse_urdf(path).joints, read_urdf(path).joints
    assert all(one.mimic_offset == 0.0 for one in folded)
    for q in (0.0, 0.4, 1.2):
        before, after = place_links(list(written), q), place_links(list(folded), q)
        for name, T in before.items():
            np.testing.assert_allclose(after[name], T, atol=1e-12)
    assert len(read(tmp_path, BODY, FLAP, *small, *rows).follows) == 2


@pytest.mark.parametrize(("axis", "multiplier"), [((0, 0, 1), 0.005), ((0, 0, -1), -0.005)])
@pytest.mark.parametrize("offset", [0.0, 0.02])
def test_a_screw_climbs_the_same_way_however_it_is_written(tmp_path, axis, multiplier, offset):
    carrier = joint("revolute", "body", "carrier", xyz=(0, 0, 0.4), axis=(0, 0, 1), limits=(0, 6))
    said = f'<mimic joint="to_carrier" multiplier="{multiplier}" offset="{np.sign(multiplier) * offset}"/>'
    travel = joint("prismatic", "carrier", "cap", axis=axis, limits=(-0.1, 0.1), extra=said)
    cap = link("cap", box_visual((0.05, 0.05, 0.02), (0, 0, 0.01)))
    asset = read(tmp_path, BODY, link("carrier"), cap, carrier, travel).asset
    screw = asset.parts[1]
    np.testing.assert_allclose(screw.joint.axis, (0, 0, 1), atol=1e-9)
    assert screw.joint.upper == pytest.approx(6.0)
    rise = (screw.box[0][2] - asset.parts[0].box[0][2]) * asset.scale
    assert rise == pytest.approx(0.41 + offset, abs=1e-5)


def test_meshes_beside_a_linked_urdf_may_be_links_into_its_store(tmp_path):
    """As in the cache of Hugging Face; a link that leads elsewhere is refused as before."""
    store, shown = tmp_path / "cache" / "blobs", tmp_path / "cache" / "snapshots" / "abc"
    (shown / "meshes").mkdir(parents=True)
    store.mkdir()
    trimesh.creation.box((0.02, 0.6, 0.3)).export(store / "2222", file_type="stl")
    flap_link = link("flap", mesh_visual("meshes/flap.stl"))
    (store / "1111").write_text(urdf(BODY, flap_link, flap()))
    (shown / "cabinet.urdf").symlink_to(Path("../../blobs/1111"))
    (shown / "meshes" / "flap.stl").symlink_to(Path("../../../blobs/2222"))
    found = read_source(shown / "cabinet.urdf", tmp_path, FAST).asset
    assert [part.joint.type for part in found.parts] == ["fixed", "revolute"]
    (shown / "meshes" / "flap.stl").unlink()
    (store / "2222").rename(tmp_path / "2222")
    (shown / "meshes" / "flap.stl").symlink_to(tmp_path / "2222")
    with pytest.raises(SourceError, match="expected a path inside of"):
        read_source(shown / "cabinet.urdf", tmp_path, FAST)


def test_scaled_meshes_of_a_package_are_found_and_fit(tmp_path):
    (tmp_path / "kit" / "meshes").mkdir(parents=True)
    (tmp_path / "kit" / "urdf").mkdir()
    trimesh.creation.box((20, 600, 300)).export(tmp_path / "kit" / "meshes" / "flap.stl")
    want = read(tmp_path, BODY, link("flap", box_visual((0.02, 0.6, 0.3))), flap()).asset
    for file in ("package://kit/meshes/flap.stl", "../meshes/flap.stl", "model://kit/meshes/flap.stl"):
        shown = mesh_visual(file, "0.001 0.001 0.001")
        found = read(tmp_path / "kit" / "urdf", BODY, link("flap", shown), flap())
        assert_same_parts(found.asset.parts, want.parts)
    uneven = mesh_visual("package://kit/meshes/flap.stl", "0.001 0.0005 -0.001")
    found = read(tmp_path / "kit" / "urdf", BODY, link("flap", uneven), flap()).asset
    np.testing.assert_allclose(found.parts[1].box[1] * found.scale, (0.02, 0.3, 0.3), atol=1e-6)


def test_links_show_collision_where_they_have_no_visual_and_empty_leaves_are_left_out(tmp_path):
    touched = box_visual((0.02, 0.6, 0.3), (0, 0, 0.15)).replace("visual", "collision")
    found = read(
        tmp_path, BODY, link("flap", touched), link("sensor"), flap(), joint("continuous", "flap", "sensor")
    )
    assert len(found.asset.parts) == 2
    notes = " ".join(found.asset.notes)
    assert "show their collision shapes: flap" in notes
    assert "link 'sensor' has no geometry and is left out" in notes


def test_a_missing_mesh_is_noted_where_the_link_has_others(tmp_path):
    shown = link("flap", box_visual((0.02, 0.6, 0.3)), mesh_visual("gone.stl"))
    found = read(tmp_path, BODY, shown, flap())
    assert any("mesh 'gone.stl' is missing" in note for note in found.asset.notes)


@pytest.mark.parametrize("kind", ["floating", "planar", "prismatic"])
def test_an_object_without_joints_and_one_that_moves_as_a_whole_are_bodies(tmp_path, kind):
    assert len(read(tmp_path, BODY).asset.parts) == 1
    found = read(tmp_path, link("world"), BODY, joint(kind, "world", "body", limits=(0, 1)))
    assert len(found.asset.parts) == 1
    assert any("moves the whole object" in note for note in found.asset.notes)


@pytest.mark.parametrize(
    ("first", "second", "kept"),
    [
        ("prismatic", "continuous", "continuous"),
        ("revolute", "prismatic", "revolute"),
        ("prismatic", "prismatic", "prismatic"),
    ],
)
def test_of_two_joints_through_an_empty_link_one_is_kept_and_noted(tmp_path, first, second, kept):
    cap = link("cap", box_visual((0.1, 0.1, 0.1)))
    chain = (
        joint(first, "body", "helper", xyz=(0, 0, 0.4), axis=(0, 0, 1), limits=(0, 0.5)),
        joint(second, "helper", "cap", xyz=(0, 0, 0.05), axis=(0, 0, 1), limits=(0, 0.25)),
    )
    found = read(tmp_path, BODY, link("helper"), cap, *chain).asset
    assert [part.joint.type for part in found.parts] == ["fixed", kept]
    assert any("'to_helper' and 'to_cap' move one part" in note for note in found.notes)
    if first == "revolute":
        assert found.parts[1].joint.upper == pytest.approx(0.5)


def test_a_turn_of_more_than_once_is_endless_and_none_is_fixed(tmp_path):
    ends = dict.fromkeys(((0, 2 * np.pi), (0, 6.3), (0, float("inf")), (0.3, 0.3)))
    for limits in ends:
        ends[limits] = read(tmp_path, BODY, FLAP, flap(limits=limits)).asset.parts[-1].joint.type
    assert list(ends.values()) == ["revolute", "continuous", "continuous", "fixed"]


BAD = {
    "a planar joint": (
        (BODY, FLAP, flap(kind="planar")),
        r"'to_flap': type 'planar' cannot be kept, allowed",
    ),
    "a floating part": ((BODY, FLAP, flap(kind="floating")), "type 'floating' cannot be kept"),
    "an unknown joint": ((BODY, FLAP, flap(kind="hinge")), "'hinge' is not one of fixed"),
    "no limits": ((BODY, FLAP, flap(limits=None)), r"limits \[None, None\], expected <limit"),
    "limits backwards": ((BODY, FLAP, flap(limits=(1, 0))), "lower 1 is above upper 0"),
    "a limit that is no number": (
        (BODY, FLAP, flap(limits=(0, float("nan")))),
        r"joint 'to_flap': limits \[0.0, nan\], expected numbers",
    ),
    "a limit of words": (
        (BODY, FLAP, flap().replace('upper="1.2"', 'upper="wide"')),
        "<limit upper> is 'wide', expected 1 number",
    ),
    "an endless slider": (
        (BODY, FLAP, flap(kind="prismatic", limits=(0, float("inf")))),
        r"limits \[0, inf\] of a slider, expected finite",
    ),
    "no axis": ((BODY, FLAP, flap(axis=(0, 0, 0))), r"axis \[0.0, 0.0, 0.0\] has no length"),
    "a cycle": (
        (BODY, link("a"), link("b"), joint("fixed", "a", "b"), joint("fixed", "b", "a")),
        "link 'a' is its own ancestor",
    ),
    "two roots": ((BODY, FLAP), r"2 root links \(body, flap\), expected one"),
    "two parents": (
        (BODY, FLAP, flap(), flap().replace("to_flap", "again")),
        "link 'flap' is the child of 2 joints",
    ),
    "two names": ((BODY, FLAP, BODY, flap()), "link name 'body' occurs 2 times"),
    "an unknown link": ((BODY, flap()), "has child 'flap', which is no link"),
    "a missing mesh": (
        (BODY, link("flap", mesh_visual("gone.stl")), flap()),
        "link 'flap': mesh 'gone.stl' is missing, looked for at .*, and node 'flap' has no other geometry",
    ),
    "a mesh elsewhere": (
        (BODY, link("flap", mesh_visual("/etc/passwd")), flap()),
        "expected a path inside of",
    ),
    "a mesh from afar": (
        (BODY, link("flap", mesh_visual("http://a/b.stl")), flap()),
        "'http://a/b.stl', expected",
    ),
    "an empty body": (
        (link("body"), FLAP, link("b", box_visual((1, 1, 1))), flap(), joint("continuous", "body", "b")),
        "'body' is the body and has no geometry, but carries flap, b",
    ),
    "an empty link that branches": (
        (
            *(
                BODY,
                link("flap"),
                link("a", box_visual((0.1, 0.1, 0.1))),
                link("b", box_visual((0.1, 0.1, 0.1))),
            ),
            *(flap(), joint("continuous", "flap", "a"), joint("continuous", "flap", "b")),
        ),
        "'flap' is a link between two joints and has no geometry, but carries a, b",
    ),
    "an unknown shape": (
        (BODY.replace("<box", "<torus"),),
        "link 'body': shape <torus>, expected mesh, box",
    ),
    "a flat box": ((link("body", box_visual((0, 1, 1))),), "has no extent, expected lengths above 0"),
    "an endless leader": (
        (
            BODY,
            FLAP,
            link("b"),
            flap(kind="continuous", limits=None),
            joint("continuous", "body", "b", extra='<mimic joint="to_flap"/>'),
        ),
        "'to_b' mimics 'to_flap', which is continuous; a part can follow only|can only follow",
    ),
    "a leader that is not there": (
        (BODY, FLAP, flap(extra='<mimic joint="x"/>')),
        "mimics joint 'x', which does not",
    ),
    "followers in a circle": (
        (
            BODY,
            FLAP,
            link("b"),
            flap(extra='<mimic joint="to_b"/>'),
            joint("revolute", "body", "b", limits=(0, 1), extra='<mimic joint="to_flap"/>'),
        ),
        "form a cycle",
    ),
}


@pytest.mark.parametrize("case", list(BAD))
def test_bad_urdfs_are_refused_in_one_sentence(tmp_path, case):
    elements, message = BAD[case]
    with pytest.raises(SourceError, match=message) as error:
        read(tmp_path, *elements)
    assert "\n" not in str(error.value)
    assert "thing.urdf" in str(error.value)


@pytest.mark.parametrize("content", [b"not a mesh", b"", b"solid x\nfacet"])
@pytest.mark.parametrize("suffix", ["stl", "obj", "glb", "dae", "step"])
def test_a_broken_mesh_is_one_sentence_that_names_it(tmp_path, suffix, content):
    (tmp_path / f"broken.{suffix}").write_bytes(content)
    with pytest.raises(SourceError, match=rf"broken\.{suffix}"):
        read(tmp_path, BODY, link("flap", mesh_visual(f"broken.{suffix}")), flap())


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("leftDoorHandle_01", "handle"),
        ("top-drawer-2", "drawer"),
        ("DrawerFront", "drawer_front"),
        ("knobs", "knob"),
        ("handle_door", "door"),
        ("link_3", None),
        ("indoors_plan", None),
        ("keyboard", None),
    ],
)
def test_the_last_known_word_of_a_name_counts(name, word):
    assert find_word(name) == word


def test_the_joint_table_decides_at_its_bounds():
    cases = (
        ("hinge", {"size": 0.25}, "knob"),
        ("hinge", {"size": 0.251}, "door"),
        ("hinge", {"size": 0.4, "parent": "door", "parent_size": 0.8}, "handle"),
        ("hinge", {"size": 0.41, "parent": "door", "parent_size": 0.8}, "door"),
        ("hinge", {"size": 0.4, "parent": "door", "parent_size": 0.8, "through_parent": True}, "knob"),
        ("hinge", {"size": 0.41, "parent": "door", "parent_size": 0.8, "through_parent": True}, "door"),
        ("hinge", {"size": 0.4, "parent": "drawer", "parent_size": 0.8, "through_parent": True}, "handle"),
        ("free hinge", {"size": 0.2, "height": 0.25}, "wheel"),
        ("free hinge", {"size": 0.2, "height": 0.26}, "knob"),
        ("free hinge", {"size": 0.5, "upright": True}, "tray"),
        ("free hinge", {"size": 0.49, "upright": True}, "knob"),
        ("slider", {"size": 0.5, "travel": 0.05}, "knob"),
        ("slider", {"size": 0.5, "travel": 0.051}, "drawer"),
        ("slider", {"size": 0.15, "travel": 0.5}, "knob"),
        ("slider", {"size": 0.151, "travel": 0.5}, "drawer"),
        ("slider", {"size": 0.5, "travel": 0.5, "upright": True}, "door"),
    )
    for word, values, label in cases:
        assert label_by_joint(word, MovingPart(**values))[0] == label, (word, values)


def test_names_say_the_category():
    for name, category in (
        ("kitchen_base_cabinet_03", "StorageFurniture"),
        ("MicrowaveOven", "Microwave"),
        ("my-desk-lamp", "DeskLamp"),
        ("chest_of_drawers", "Dresser"),
        ("KitchenPot_lid_pot", "Pot"),
        ("floor_lamp", "Lamp"),
        ("two-knives", "Knife"),
        ("SpaceShip", "SpaceShip"),
        ("model_12", "Object"),
        ("partnet_c75ebd7c34064", "Object"),
    ):
        assert guess_category([name])[0] == category


def test_sources_are_found_in_folders_and_called_by_what_tells_them_apart(tmp_path):
    for name in ("a/model.urdf", "b/urdf/b.urdf", "c/object.json", "one.urdf", "two.urdf"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    found = find_sources((tmp_path,))
    assert [name_source(path) for path in found] == ["a", "b", "c", "one", "two"]
    assert name_source(tmp_path / "a" / "model.urdf") == "a"
    with pytest.raises(SourceError, match="is no object: expected a URDF"):
        read_source(tmp_path, tmp_path)


@pytest.mark.parametrize("inner", ["", "urdf/", "robot/urdf/"])
@pytest.mark.parametrize("file", ["robot.urdf", "model.urdf", "mobility.urdf"])
def test_generic_names_of_files_and_folders_tell_no_objects_apart(tmp_path, inner, file):
    for name in ("chest", "lamp"):
        path = tmp_path / name / f"{inner}{file}"
        path.parent.mkdir(parents=True)
        path.write_text("")
        assert name_source(path) == name
        if inner:
            assert name_source(path.parent) == name


@pytest.mark.slow
@pytest.mark.parametrize("visual", ["voxels", "source"])
def test_a_urdf_becomes_a_package_with_the_same_joints(tmp_path, visual):
    """A coffee machine: a lid on a lever, a button and a tray; what moves it keeps its tree in voxels too."""
    elements = (
        link(
            "frame",
            box_visual((0.3, 0.25, 0.03), (0, 0, 0.015)),
            box_visual((0.14, 0.25, 0.34), (0.08, 0, 0.18)),
        ),
        link("lever", box_visual((0.025, 0.02, 0.12), (0, 0, 0.06))),
        link("lid", box_visual((0.06, 0.05, 0.015), (-0.03, 0, 0.0075))),
        link("x", box_visual((0.01, 0.03, 0.03), (-0.005, 0, 0))),
        link("drip_tray", box_visual((0.13, 0.22, 0.02))),
        joint("revolute", "frame", "lever", xyz=(0.08, 0.137, 0.3), axis=(0, -1, 0), limits=(0, 0.8)),
        joint("revolute", "lever", "lid", xyz=(0.03, 0, 0.12), axis=(0, 1, 0), limits=(0, 1)),
        joint("prismatic", "frame", "x", xyz=(0.01, 0, 0.3), limits=(0, 0.004)),
        joint("prismatic", "frame", "drip_tray", xyz=(-0.07, 0, 0.041), axis=(-1, 0, 0), limits=(0, 0.08)),
    )
    source = read(tmp_path, *elements, name="coffee_machine")
    assert [part.label for part in source.asset.parts] == ["base", "knob", "door", "knob", "tray"]
    cfg = ConvertSettings(visual=visual, validation="none")
    convert_object(ConvertJob(source=tmp_path / "coffee_machine.urdf", out=tmp_path / "out", cfg=cfg))
    package = read_package(tmp_path / "out" / "coffee_machine")
    parents = {joint.child: joint.parent for joint in package.joints}
    labels = {link.name: link.label for link in package.links}
    hangs = sorted((labels[child], labels[parent]) for child, parent in parents.items())
    assert hangs == [("door", "knob"), ("knob", "base"), ("knob", "base"), ("tray", "base")]
    uppers = sorted(joint.upper for joint in package.joints)
    assert uppers == pytest.approx(
        sorted(
            part.joint.upper * (source.asset.scale if part.joint.type == "prismatic" else 1)
            for part in source.asset.parts[1:]
        ),
        rel=0.02,
    )


def joint_table_markdown() -> str:
    """The table of joints as Markdown, for the documentation."""
    rows = ["| joint | label | when, in order of precedence |", "|---|---|---|"]
    rows += [f"| {rule.joint} | {rule.label} | {rule.when} |" for rule in JOINT_TABLE]
    return "\n".join(rows) + "\n"


def test_the_documented_joint_table_is_the_one_in_force():
    docs = Path(__file__).resolve().parents[3] / "docs" / "how-to" / "convert.md"
    assert joint_table_markdown() in docs.read_text()


@pytest.mark.parametrize("between", ["", "fixed"])
def test_fixed_joints_and_empty_branches_do_not_break_a_row_of_joints(tmp_path, between):
    """Two joints through empty links are one joint, and a frame without shapes hangs from one of them."""
    lift = joint("prismatic", "body", "lift", xyz=(-0.21, 0, -0.4), axis=(0, 0, 1), limits=(0, 0.05))
    extra = [link("mount"), joint("fixed", "lift", "mount"), link("frame"), joint("fixed", "mount", "frame")]
    at = "mount" if between else "lift"
    turn = joint("revolute", at, "flap", axis=(0, -1, 0), limits=(0, 1.2))
    elements = (BODY, link("lift"), *(extra if between else ()), FLAP, lift, turn)
    found = read(tmp_path, *elements).asset
    assert [part.joint.type for part in found.parts] == ["fixed", "revolute"]
    assert any("'to_flap' (revolute) is kept" in note for note in found.notes)


def test_joints_that_move_all_that_is_drawn_are_fixed(tmp_path):
    stand = joint("floating", "world", "slide")
    rail = joint("prismatic", "slide", "body", limits=(-1.0, 1.0))
    found = read(tmp_path, link("world"), link("slide"), BODY, FLAP, stand, rail, flap()).asset
    assert [part.joint.type for part in found.parts] == ["fixed", "revolute"]
    assert sum("moves the whole object" in note for note in found.notes) == 2


@pytest.mark.parametrize("inside", [True, False])
def test_a_material_is_known_by_name_wherever_it_is_defined(tmp_path, inside):
    """In the robot, or in a link that comes later."""
    named = BODY.replace('<color rgba="0.7 0.7 0.7 1"/>', "").replace('name=""/>', 'name="teal"/>')
    named = named.replace('<material name=""></material>', '<material name="teal"/>')
    material = '<material name="teal"><color rgba="0 0.5 0.5 0.25"/></material>'
    leaf = FLAP.replace(
        '<material name=""><color rgba="0.7 0.7 0.7 1"/></material>', material if inside else ""
    )
    (tmp_path / "thing.urdf").write_text(urdf(named, leaf, *(() if inside else (material,)), flap()))
    (shape,) = next(one for one in parse_urdf(tmp_path / "thing.urdf").links if one.name == "body").visuals
    assert (shape.color, shape.opacity) == ((0.0, 0.5, 0.5), 0.25)


@pytest.mark.parametrize("joints", [1000.0, 1.0])
def test_millimetres_are_guessed_and_said(tmp_path, joints):
    """Of the whole file, or of meshes whose joints are in metres."""
    for name, size, at in (("body", (400, 600, 800), (0, 0, 0)), ("leaf", (20, 600, 300), (0, 0, 150))):
        mesh = trimesh.creation.box(size)
        mesh.apply_translation(at)
        mesh.export(tmp_path / f"{name}.stl")
    at = joint(
        "revolute", "body", "flap", xyz=joints * np.array([-0.21, 0, -0.4]), axis=(0, -1, 0), limits=(0, 1.2)
    )
    found = read(
        tmp_path, link("body", mesh_visual("body.stl")), link("flap", mesh_visual("leaf.stl")), at
    ).asset
    assert found.scale == pytest.approx(0.8)
    np.testing.assert_allclose(found.parts[1].box[1] * found.scale, (0.02, 0.6, 0.3), atol=1e-6)
    low = (found.parts[1].box[0][0] - found.parts[0].box[0][0]) * found.scale
    assert low == pytest.approx(-0.21, abs=1e-6)
    assert any(
        "read as millimetres: in metres, the object would be 800 m long" in note for note in found.notes
    )


@pytest.mark.parametrize("name", ["../../secret.stl", "package://thing/../../../secret.stl", "/etc/hostname"])
def test_no_name_leads_out_of_the_package(tmp_path, name):
    folder = tmp_path / "a" / "thing" / "robots"
    folder.mkdir(parents=True)
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "secret.stl")
    with pytest.raises(SourceError, match=r"inside of|is missing"):
        read(folder, BODY, link("flap", mesh_visual(name)), flap())
