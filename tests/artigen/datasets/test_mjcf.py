"""An MJCF is read as MuJoCo shows and moves it; what is no tree of hinges and slides is refused."""

# mujoco is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

from pathlib import Path

import mujoco
import numpy as np
import pytest
from PIL import Image

from artigen.datasets.mjcf import is_mjcf, read_mjcf
from artigen.datasets.sources import find_sources, list_objects, name_source, read_source
from artigen.errors import SourceError
from artigen.files.mtl import parse_mtl
from artigen.shapes.draw import draw_shape
from artigen.transforms import rotation_about, shift
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.reference import build_reference

MACHINE = """
<mujoco>
  <compiler angle="degree"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="object" pos="0.1 0.2 0.3" quat="0.8 0 0.6 0">
      <geom name="body" type="box" size="0.2 0.3 0.4" rgba="0.8 0.1 0.1 1"/>
      <geom name="felt" type="box" size="0.2 0.3 0.4" contype="1" conaffinity="1" group="3"/>
      <body name="door" pos="-0.2 0 0" euler="10 20 30">
        <joint name="hinge" type="hinge" axis="0 0 1" pos="0 -0.3 0.05" range="20 110" ref="20"/>
        <geom name="panel" type="box" size="0.01 0.3 0.4" pos="0 0 0.02"/>
        <body name="holder" pos="0 0.1 0">
          <body name="handle" pos="-0.04 0.1 0" euler="0 90 40">
            <geom name="bar" type="capsule" size="0.01 0.1"/>
            <joint name="slide" type="slide" axis="1 0 0" range="0 0.02"/>
            <joint name="twist" type="hinge" axis="0 1 0" pos="0.01 0.02 0"/>
          </body>
        </body>
      </body>
      <body name="lid" pos="0 0 0.4">
        <joint name="lid_hinge" type="hinge" axis="0 1 0" pos="0.2 0 0" range="-90 0"/>
        <geom name="cover" type="cylinder" size="0.2 0.01"/>
      </body>
    </body>
  </worldbody>
  <equality><joint joint1="lid_hinge" joint2="hinge" polycoef="0.1 -0.5 0 0 0"/></equality>
</mujoco>
"""


def write(tmp_path: Path, text: str, name: str = "machine.xml") -> Path:
    path = tmp_path / name
    path.write_text(text)
    return path


def place_shapes(found, q: dict[str, float]) -> dict[str, np.ndarray]:
    """Placements of all visuals at joint values."""
    moved: dict[str, np.ndarray] = {}
    for joint in found.joints:  # parents come first
        T = moved.get(joint.parent, np.eye(4))
        at, value = found.T_base_link[joint.child], q.get(joint.name, 0.0)
        step = np.eye(4)
        if joint.type == "prismatic":
            step[:3, 3] = value * np.array(joint.axis)
        elif joint.type != "fixed":
            step[:3, :3] = rotation_about(np.array(joint.axis), np.array([value]))[0]
        moved[joint.child] = T @ at @ step @ np.linalg.inv(at)
    return {s.name: moved.get(s.link, np.eye(4)) @ found.place(s) for s in found.visuals}


def test_a_mechanism_moves_as_mujoco_does(tmp_path):
    """Chains on one body, joints beside the body's frame, coordinates that begin elsewhere, bodies that are
    mere frames: at any joint values, everything is where MuJoCo has it."""
    path = write(tmp_path, MACHINE)
    found = read_mjcf(path)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    names = [model.joint(k).name for k in range(model.njnt)]
    assert {joint.name for joint in found.joints if joint.type != "fixed"} == set(names)
    for _ in range(5):
        q = rng.uniform(-0.5, 0.5, model.njnt)
        data.qpos[:] = model.qpos0 + q
        mujoco.mj_kinematics(model, data)
        values = dict(zip(names, q, strict=True))
        values["lid_hinge"] -= 0.1  # a follower is at 0 where its leader is
        placed = place_shapes(found, values)
        for geom in range(model.ngeom):
            name = model.geom(geom).name
            if name == "felt":
                assert name not in placed
                continue
            T = np.eye(4)
            T[:3, :3], T[:3, 3] = data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom]
            expected = shift(-model.body("object").pos) @ T  # upright as in the world
            np.testing.assert_allclose(placed[name], expected, atol=1e-6)


def test_ranges_begin_at_the_reference_and_followers_are_mimics(tmp_path):
    found = read_mjcf(write(tmp_path, MACHINE))
    joints = {joint.name: joint for joint in found.joints}
    assert (joints["hinge"].lower, joints["hinge"].upper) == pytest.approx((0.0, np.pi / 2))
    assert (joints["slide"].lower, joints["slide"].upper) == pytest.approx((0.0, 0.02))
    assert joints["twist"].type == "continuous"
    assert (joints["lid_hinge"].mimic, joints["lid_hinge"].mimic_multiplier) == ("hinge", -0.5)


def chest(door: str, *, before: str = "", after: str = "", tray: str = 'range="0 0.2"') -> str:
    """A box with a door and a tray; ``door`` holds joints and geoms of the door."""
    return f"""<mujoco>{before}<compiler angle="radian"/><worldbody><body name="chest">
      <geom name="box" type="box" size="0.2 0.2 0.25"/>
      <body name="door" pos="-0.21 -0.2 0">{door}</body>
      <body name="tray" pos="0 0 0.3"><joint name="slide" type="slide" axis="-1 0 0" {tray}/>
        <geom name="board" type="box" size="0.1 0.1 0.01"/></body>
      </body></worldbody>{after}</mujoco>"""


HINGE = '<joint name="hinge" axis="0 0 1" range="0 1.5"/>'
PANEL = '<geom name="panel" type="box" size="0.01 0.2 0.25" pos="0 0.2 0"/>'


@pytest.mark.parametrize(("active", "followers"), [("true", 1), ("false", 0)])
def test_only_active_equalities_make_followers(tmp_path, active, followers):
    tied = f'<equality><joint joint1="slide" joint2="hinge" active="{active}"/></equality>'
    found = read_mjcf(write(tmp_path, chest(HINGE + PANEL, after=tied)))
    assert sum(joint.mimic is not None for joint in found.joints) == followers


def test_masses_do_not_decide_whether_a_file_is_read(tmp_path):
    """They are not used: a file whose bodies have none gives the same mechanism."""
    light = chest(HINGE + PANEL).replace("<compiler", '<compiler inertiagrouprange="4 4"')
    with pytest.raises(ValueError, match="mass and inertia"):
        mujoco.MjModel.from_xml_string(light)
    one, other = (read_mjcf(write(tmp_path, text)) for text in (light, chest(HINGE + PANEL)))
    assert one.links == other.links
    for got, want in zip(one.joints, other.joints, strict=True):
        assert (got.name, got.type, got.lower, got.upper) == (want.name, want.type, want.lower, want.upper)
        np.testing.assert_array_equal(got.T_parent_joint, want.T_parent_joint)


@pytest.mark.parametrize(
    ("box", "sticker", "shown"),
    [
        ("", 'contype="0" conaffinity="0"', {"box", "board", "panel", "sticker"}),
        ('group="1" contype="0" conaffinity="0"', 'group="0"', {"box", "board", "panel"}),
        ("", "", {"box", "board", "panel", "sticker"}),
    ],
)
def test_a_group_of_collision_shapes_is_hidden_where_another_group_is_drawn(tmp_path, box, sticker, shown):
    more = f'<geom name="sticker" type="box" size="0.001 0.03 0.03" pos="-0.011 0.2 0.1" {sticker}/>'
    before = f"<default><geom {box}/></default>"
    more = more if "contype" in sticker else more.replace("/>", ' contype="1" conaffinity="1"/>')
    found = read_mjcf(write(tmp_path, chest(HINGE + PANEL + more, before=before)))
    assert {shape.name for shape in found.visuals} == shown


def test_a_slide_without_range_is_named_as_in_the_file(tmp_path):
    path = write(tmp_path, chest(HINGE + PANEL, tray=""))
    with pytest.raises(SourceError, match=rf"^{path}: joint 'slide' slides without limits, expected a range"):
        read_mjcf(path)


SCENE = """<mujoco><worldbody><light pos="0 0 3"/><camera pos="1 0 1"/>
  <geom name="floor" type="plane" size="5 5 1"/><geom name="wall" type="box" size="0.1 3 3" pos="3 0 0"/>
  <body name="table" pos="0 0 -0.4"><geom type="box" size="1 1 0.4"/></body>
  <body name="mug" pos="0.5 0.5 0"><freejoint/><geom size="0.1"/></body>{}</worldbody></mujoco>"""
CHEST = chest(HINGE + PANEL).partition("<worldbody>")[2].partition("</worldbody>")[0]
OTHER = CHEST.replace('name="', 'name="other_')
FRAMELESS = '<geom name="case" type="box" size="0.2 0.2 0.25"/><body name="door" pos="-0.21 -0.2 0">{}</body>'


@pytest.mark.parametrize(
    ("bodies", "body", "shown"),
    [
        (CHEST, None, {"box", "panel", "board"}),
        (
            CHEST + OTHER,
            "other_chest",
            {"other_box", "other_panel", "other_board"},
        ),
        (CHEST, "door", {"panel"}),
        (FRAMELESS.format(HINGE + PANEL), None, {"case", "panel"}),
    ],
)
def test_an_object_is_told_from_the_scene_around_it(tmp_path, bodies, body, shown):
    """Wherever the hinge hangs, and said with what was left out."""
    found = read_mjcf(write(tmp_path, SCENE.format(bodies)), body)
    assert {shape.name for shape in found.visuals} == shown
    assert any("left out" in note and "table" in note and "mug" in note for note in found.notes)
    assert any("cameras (1)" in note and "lights (1)" in note for note in found.notes)


def test_a_file_of_several_objects_names_them(tmp_path):
    path = write(tmp_path, SCENE.format(CHEST + OTHER))
    assert list_objects(path) == ("chest", "other_chest")
    assert list_objects(write(tmp_path, SCENE.format(CHEST), "one.xml")) == ()
    for body, said in ((None, r"holds 2 objects \(chest, other_chest\)"), ("fridge", "no body 'fridge'")):
        with pytest.raises(SourceError, match=said):
            read_mjcf(path, body)


@pytest.mark.parametrize("turn", ["1 0 0", "0 1 0", "0.3 0.4 0.5"])
def test_an_object_stands_as_its_root_body_stands(tmp_path, turn):
    """Turning the root and counter-turning the world is nothing: a turned object has turned extents."""
    tilted = chest(HINGE + PANEL).replace('name="chest"', f'name="chest" euler="{turn}"')
    path = write(tmp_path, tilted)
    found = read_mjcf(path)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    for name, T in place_shapes(found, {}).items():
        np.testing.assert_allclose(T[:3, :3], data.geom(name).xmat.reshape(3, 3), atol=1e-6)


def test_a_texture_on_a_primitive_shows_as_its_mean_colour(tmp_path):
    pixels = np.zeros((4, 4, 3), dtype=np.uint8)
    pixels[:, :2, 0], pixels[:, 2:, 2] = 200, 100
    Image.fromarray(pixels).save(tmp_path / "two.png")
    look = (
        '<asset><texture name="t" type="2d" file="two.png"/>'
        '<material name="m" texture="t" rgba="1 1 0.5 1"/></asset>'
    )
    panel = PANEL.replace("/>", ' material="m"/>')
    source = read_source(write(tmp_path, chest(HINGE + panel, before=look)), tmp_path)
    colors = [m.color for v in source.visuals for m in parse_mtl(v.path.with_suffix(".mtl")).values()]
    assert min(colors, key=lambda color: color[1]) == pytest.approx((100 / 255, 0, 25 / 255), abs=2 / 255)


@pytest.mark.parametrize(
    ("joints", "kept"),
    [
        ((("hinge", 1.5), ("slide", 0.1), ("hinge", 0.4)), 0),
        ((("hinge", 0.4), ("slide", 2.0), ("hinge", 1.5)), 2),
        ((("slide", 0.1), ("slide", 0.3), ("slide", 0.3), ("slide", 0.2)), 2),
        ((("hinge", 1.5), ("hinge", None), ("slide", 0.3)), 1),
    ],
)
def test_of_any_number_of_joints_of_one_body_the_furthest_turn_is_kept(tmp_path, joints, kept):
    ranges = ["" if upper is None else f'range="0 {upper}"' for _, upper in joints]
    rows = [
        f'<joint name="j{number}" type="{kind}" axis="0 {number} 1" {ranges[number]}/>'
        for number, (kind, _) in enumerate(joints)
    ]
    asset = read_source(write(tmp_path, chest("".join(rows) + PANEL)), tmp_path).asset
    assert sum(part.joint.type != "fixed" for part in asset.parts) == 2
    assert sum(f"'j{kept}'" in note and "is kept" in note for note in asset.notes) == 1
    assert any(f"'j{kept}' (" in note for note in asset.notes)


@pytest.mark.slow
@pytest.mark.parametrize("category", ["Microwave", "StorageFurniture", "TrashCan"])
def test_an_mjcf_of_ours_is_read_as_the_object_that_it_was_written_from(tmp_path, category):
    package = build_reference(draw_shape(category, 3))
    written = read_package(write_package(package, tmp_path / "package"))
    source = read_source(tmp_path / "package" / "mobility.mjcf.xml", tmp_path / "scratch")
    moving = [part for part in source.asset.parts if part.joint.type != "fixed"]
    driven = [joint for joint in written.joints if joint.type != "fixed"]
    assert len(moving) == len(driven)
    spans = sorted(
        part.joint.upper * (source.asset.scale if part.joint.type == "prismatic" else 1.0) for part in moving
    )
    assert spans == pytest.approx(sorted(joint.upper - joint.lower for joint in driven), abs=1e-4)
    shown = np.concatenate([v.mesh.vertices for link in written.links for v in link.visuals])
    corners = source.triangles.vertices * source.asset.scale
    np.testing.assert_allclose(np.ptp(corners, axis=0), np.ptp(shown, axis=0), atol=2e-4)
    assert not any("site" in note for note in source.asset.notes)  # which mark its handles


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<mujoco><worldbody><body><geom size='1'/><joint type='ball'/></bod", "not valid XML"),
        (
            "<mujoco><worldbody><geom size='1'/><body name='b'><geom size='1'/><joint type='ball'/></body>"
            "</worldbody></mujoco>",
            "body 'b' has a free or ball joint",
        ),
    ],
)
def test_what_is_no_tree_of_hinges_and_slides_is_refused(tmp_path, text, said):
    with pytest.raises(SourceError, match=said):
        read_mjcf(write(tmp_path, text))


def test_mjcf_is_told_by_its_root_element(tmp_path):
    assert is_mjcf(write(tmp_path, MACHINE, "a.xml"))
    assert not is_mjcf(write(tmp_path, "<robot name='r'/>", "b.xml"))
    assert not is_mjcf(write(tmp_path, "text", "c.xml"))
    for name in ("mug_tree", "oven"):
        (tmp_path / "all" / name).mkdir(parents=True)
        write(tmp_path / "all" / name, MACHINE, "model.xml")
    assert find_sources((tmp_path / "all",)) == [tmp_path / "all" / "mug_tree", tmp_path / "all" / "oven"]
    assert name_source(tmp_path / "all" / "oven" / "model.xml") == "oven"
