"""What MuJoCo and yourdfpy load from a source is what is read: extents closed and open, joints, colours.

Generated files hold nested frames, mirrored and unequal scales, odd names, bodies without mass and joints of
any sort; the files of known faults and the objects at hand are read beside them where they are there.
"""

# mujoco is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
import trimesh
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from source_cases import CASES, REFUSED, judge
from source_oracles import compare_read, load_source

from artigen.datasets.mesh_size import MOST_FACES, check_size
from artigen.datasets.source_object import ReaderConfig
from artigen.datasets.sources import read_source
from artigen.errors import SourceError
from artigen.transforms import frame_along, matrix_from_rpy, quat_from_matrix

FAST = ReaderConfig(samples=2000)
NAMES = ("door", "a b", "Tür_1", "x-1", "link.2", "drawer<1>", "body_3", "part/4")
angle = st.floats(-3.0, 3.0)
place = st.tuples(*[st.floats(-0.3, 0.3)] * 3)


@dataclass(frozen=True, kw_only=True)
class Made:
    """A link: its parent by number, pose in it, box, joint, and scale of its mesh."""

    parent: int
    xyz: tuple[float, float, float]
    rpy: tuple[float, float, float]
    size: tuple[float, float, float]
    kind: str
    axis: tuple[float, float, float]
    limits: tuple[float, float]
    scale: tuple[float, float, float]
    color: tuple[float, float, float]


@st.composite
def chains(draw: st.DrawFn) -> list[Made]:
    """Two to four links, of which every later one hangs from an earlier one."""
    return [
        Made(
            parent=draw(st.integers(0, number)),
            xyz=draw(place),
            rpy=(draw(angle), draw(angle), draw(angle)),
            size=draw(st.tuples(*[st.floats(0.05, 0.4)] * 3)),
            kind=draw(st.sampled_from(("revolute", "prismatic", "continuous", "fixed"))),
            axis=draw(st.sampled_from(((1, 0, 0), (0, -2, 0), (0, 0, 1), (1, 1, 0), (-0.3, 0.4, 0.5)))),
            limits=draw(st.sampled_from(((0.0, 0.5), (-0.7, 0.0), (0.0, 1.2)))),
            scale=draw(st.sampled_from(((1, 1, 1), (-1, 1, 1), (1, 2, 0.5), (-1, -1, -1)))),
            color=draw(st.tuples(*[st.floats(0, 1)] * 3)),
        )
        for number in range(draw(st.integers(1, 3)))
    ]


def quote(name: str) -> str:
    return name.replace("<", "&lt;").replace(">", "&gt;")


def numbers(values: object) -> str:
    return " ".join(f"{value:.9g}" for value in np.ravel(np.asarray(values, dtype=float)))


def write_urdf(folder: Path, chain: list[Made]) -> Path:
    trimesh.creation.box((1, 1, 1)).export(folder / "cube.stl")
    rows = [
        '<robot name="made"><link name="base">'
        '<visual><geometry><box size="0.5 0.6 0.7"/></geometry></visual></link>'
    ]
    for number, one in enumerate(chain):
        axis = numbers(
            np.array(one.axis) / np.linalg.norm(one.axis)
        )  # yourdfpy takes its length for a factor
        name, above = quote(NAMES[number]), "base" if one.parent == 0 else quote(NAMES[one.parent - 1])
        rows.append(
            f'<joint name="j{number}" type="{one.kind}"><parent link="{above}"/><child link="{name}"/>'
            f'<origin xyz="{numbers(one.xyz)}" rpy="{numbers(one.rpy)}"/><axis xyz="{axis}"/>'
            f'<limit lower="{one.limits[0]}" upper="{one.limits[1]}" effort="1" velocity="1"/></joint>'
            f'<link name="{name}"><visual><origin xyz="0.1 0 0" rpy="0.3 0 0.2"/><geometry>'
            f'<mesh filename="cube.stl" scale="{numbers(np.multiply(one.scale, one.size))}"/></geometry>'
            f'<material name="m{number}"><color rgba="{numbers(one.color)} 1"/></material></visual></link>'
        )
    path = folder / "made.urdf"
    path.write_text("".join([*rows, "</robot>"]), encoding="utf-8")
    return path


def write_mjcf(folder: Path, chain: list[Made]) -> Path:
    trimesh.creation.box((1, 1, 1)).export(folder / "cube.stl")
    assets = "".join(
        f'<mesh name="m{number}" file="cube.stl" scale="{numbers(np.multiply(one.scale, one.size))}"/>'
        for number, one in enumerate(chain)
    )

    def body(number: int) -> str:
        one = chain[number]
        kind = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}.get(one.kind)
        limits = "" if one.kind == "continuous" else f'range="{one.limits[0]} {one.limits[1]}"'
        moved = (
            ""
            if kind is None
            else f'<joint name="j{number}" type="{kind}" axis="{numbers(one.axis)}" {limits}/>'
        )
        inner = "".join(body(other) for other, it in enumerate(chain) if it.parent == number + 1)
        return (
            f'<body name="{quote(NAMES[number])}" pos="{numbers(one.xyz)}" euler="{numbers(one.rpy)}">{moved}'
            f'<geom name="g{number}" type="mesh" mesh="m{number}" pos="0.1 0 0" euler="0.3 0 0.2" '
            f'rgba="{numbers(one.color)} 1"/>{inner}</body>'
        )

    inner = "".join(body(number) for number, it in enumerate(chain) if it.parent == 0)
    path = folder / "made.xml"
    path.write_text(
        f'<mujoco><compiler angle="radian" inertiagrouprange="5 5" boundmass="0.001" boundinertia="0.001"/>'
        f'<asset>{assets}</asset><worldbody><body name="base" pos="0.3 -0.2 0.1" euler="0.2 0.4 -0.3">'
        f'<geom type="box" size="0.25 0.3 0.35"/>{inner}</body></worldbody></mujoco>',
        encoding="utf-8",
    )
    return path


@settings(max_examples=15, deadline=None, phases=(Phase.explicit, Phase.generate))
@given(chain=chains())
def test_generated_mjcf_is_what_mujoco_has(chain: list[Made]):
    with TemporaryDirectory() as folder:
        path = write_mjcf(Path(folder), chain)
        assert compare_read(read_source(path, Path(folder) / "scratch", FAST), load_source(path, None)) == []


HINGED = Made(
    parent=0,
    xyz=(0.3, 0.1, 0.0),
    rpy=(0.0, 0.0, 0.5),
    size=(0.1, 0.2, 0.3),
    kind="revolute",
    axis=(0, 0, 1),
    limits=(0.0, 0.5),
    scale=(1, 1, 1),
    color=(1.0, 0.0, 0.0),
)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"axis": (0, 0, -1)}, "axis of"),
        ({"limits": (0.0, 0.6)}, "range of"),
        ({"xyz": (0.32, 0.1, 0.0)}, "closed extents"),
        ({"rpy": (0.0, 0.0, 0.6)}, "closed extents"),
        ({"color": (0.0, 1.0, 0.0)}, "mean colour"),
    ],
)
def test_oracles_notice_a_wrong_reading(tmp_path: Path, change: dict, said: str):
    found = read_source(write_mjcf(tmp_path, [HINGED]), tmp_path / "scratch", FAST)
    other = load_source(write_mjcf(tmp_path, [replace(HINGED, **change)]), None)
    assert any(sentence.startswith(said) for sentence in compare_read(found, other))


@settings(max_examples=15, deadline=None, phases=(Phase.explicit, Phase.generate))
@given(chain=chains())
def test_generated_urdf_is_what_yourdfpy_has(chain: list[Made]):
    with TemporaryDirectory() as folder:
        path = write_urdf(Path(folder), chain)
        found = read_source(path, Path(folder) / "scratch", FAST)
        assert compare_read(found, replace(load_source(path, None), color=np.full(3, np.nan))) == []


def write_sdf(folder: Path, chain: list[Made]) -> Path:
    """The same as `write_urdf`, with poses relative to parents, frames and the model."""
    rows = [
        "<link name='base'><visual name='v'><geometry><box><size>0.5 0.6 0.7</size></box></geometry></visual>"
        "</link>"
    ]
    poses = [np.eye(4)]
    for number, one in enumerate(chain):
        name, above = quote(NAMES[number]), "base" if one.parent == 0 else quote(NAMES[one.parent - 1])
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = matrix_from_rpy(np.array(one.rpy)), one.xyz
        poses.append(poses[one.parent] @ T)
        pose = f"<pose relative_to='{above}'>{numbers([*one.xyz, *one.rpy])}</pose>"
        axis = f"<xyz>{numbers(one.axis)}</xyz>"
        if number == 1:
            pose = f"<pose relative_to='near'>{numbers([0, 0, 0, *one.rpy])}</pose>"
            rows.append(
                f"<frame name='near' attached_to='{above}'>"
                f"<pose>{numbers([*one.xyz, 0, 0, 0])}</pose></frame>"
            )
        elif number == 2:
            w, x, y, z = quat_from_matrix(poses[-1][None, :3, :3])[0]
            pose = f"<pose rotation_format='quat_xyzw'>{numbers([*poses[-1][:3, 3], x, y, z, w])}</pose>"
            axis = f"<xyz expressed_in='__model__'>{numbers(poses[-1][:3, :3] @ one.axis)}</xyz>"
        rows.append(
            f"<link name='{name}'>{pose}<visual name='v'><pose degrees='true'>"
            f"{numbers([0.1, 0, 0, np.degrees(0.3), 0, np.degrees(0.2)])}</pose>"
            "<geometry><mesh><uri>cube.stl</uri>"
            f"<scale>{numbers(np.multiply(one.scale, one.size))}</scale></mesh></geometry>"
            f"<material><diffuse>{numbers(one.color)} 1</diffuse></material></visual></link>"
            f"<joint name='j{number}' type='{one.kind}'><parent>{above}</parent><child>{name}</child>"
            f"<axis>{axis}"
            f"<limit><lower>{one.limits[0]}</lower><upper>{one.limits[1]}</upper></limit></axis></joint>"
        )
    path = folder / "made.sdf"
    path.write_text(f"<sdf version='1.9'><model name='made'>{''.join(rows)}</model></sdf>", encoding="utf-8")
    return path


@settings(max_examples=15, deadline=None, phases=(Phase.explicit, Phase.generate))
@given(chain=chains())
def test_generated_sdf_is_the_urdf_of_the_same_chain(chain: list[Made]):
    with TemporaryDirectory() as folder:
        one = read_source(write_urdf(Path(folder), chain), Path(folder) / "scratch", FAST)
        other = read_source(write_sdf(Path(folder), chain), Path(folder) / "scratch", FAST)
        for part, twin in zip(other.asset.parts, one.asset.parts, strict=True):
            assert (part.label, part.parent, part.joint.type) == (twin.label, twin.parent, twin.joint.type)
            np.testing.assert_allclose(part.box, twin.box, atol=1e-6)
            np.testing.assert_allclose(part.joint.axis, twin.joint.axis, atol=1e-6)
            np.testing.assert_allclose(part.joint.origin, twin.joint.origin, atol=1e-6)
            assert part.joint.upper == pytest.approx(twin.joint.upper, abs=1e-6)
        colors = [found.asset.surface.colors.mean(axis=0) for found in (one, other)]
        np.testing.assert_allclose(colors[0], colors[1], atol=1)


def write_stage(folder: Path, chain: list[Made], metres: float, up: str) -> Path:
    """The same as `write_urdf` as a stage: bodies in a frame that turns and scales, axes along z."""
    from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdPhysics

    path = folder / "made.usda"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, metres)
    UsdGeom.SetStageUpAxis(stage, up)
    to_stage = np.diag([1 / metres, 1 / metres, 1 / metres, 1.0])
    if up == "Y":
        to_stage = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]]) @ to_stage
    frame = np.diag([2.0, 2.0, 2.0, 1.0])
    frame[:3, :3] = matrix_from_rpy(np.array([0.1, 0.2, 0.3])) @ frame[:3, :3]
    frame[:3, 3] = (3.0, -1.0, 0.5)

    def place(prim: object, T: np.ndarray) -> None:
        UsdGeom.Xformable(prim).AddTransformOp().Set(Gf.Matrix4d(*T.T.ravel().tolist()))

    place(UsdGeom.Xform.Define(stage, "/object"), frame)
    poses, paths = [np.eye(4)], ["/object/base"]
    for one in chain:
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = matrix_from_rpy(np.array(one.rpy)), one.xyz
        poses.append(poses[one.parent] @ T)
    for number, T in enumerate(poses):
        one = chain[number - 1] if number else None
        paths[number:] = [paths[0] if one is None else "/object/" + Tf.MakeValidIdentifier(NAMES[number - 1])]
        body = UsdGeom.Xform.Define(stage, paths[number])
        place(body, np.linalg.inv(frame) @ to_stage @ T)
        UsdPhysics.RigidBodyAPI.Apply(body.GetPrim())
        cube = UsdGeom.Cube.Define(stage, paths[number] + "/cube")
        cube.GetSizeAttr().Set(1.0)
        own = np.diag([0.5, 0.6, 0.7, 1.0])
        if one is not None:
            own = np.eye(4)
            own[:3, :3] = matrix_from_rpy(np.array([0.3, 0.0, 0.2])) @ np.diag(
                np.multiply(one.scale, one.size)
            )
            own[0, 3] = 0.1
            linear = ((np.array(one.color) + 0.055) / 1.055) ** 2.4
            cube.GetDisplayColorAttr().Set([tuple(np.where(linear < 0.0031308, 0.0, linear).tolist())])
        place(cube, own)
    for number, one in enumerate(chain):
        kinds = {"fixed": "Fixed", "prismatic": "Prismatic"}
        joint = getattr(UsdPhysics, f"{kinds.get(one.kind, 'Revolute')}Joint").Define(
            stage, f"/object/j{number}"
        )
        joint.GetBody0Rel().SetTargets([Sdf.Path(paths[one.parent])])
        joint.GetBody1Rel().SetTargets([Sdf.Path(paths[number + 1])])
        turn = np.eye(4)
        turn[:3, :3] = frame_along(np.array(one.axis) / np.linalg.norm(one.axis)).T
        local = np.linalg.inv(poses[one.parent]) @ poses[number + 1] @ turn
        for side, T in ((0, local), (1, turn)):
            w, x, y, z = quat_from_matrix(T[None, :3, :3])[0].tolist()
            getattr(joint, f"GetLocalPos{side}Attr")().Set(Gf.Vec3f(*T[:3, 3].tolist()))
            getattr(joint, f"GetLocalRot{side}Attr")().Set(Gf.Quatf(w, x, y, z))
        if one.kind != "fixed":
            joint.GetAxisAttr().Set("Z")
            unit = 1 / metres if one.kind == "prismatic" else 180 / np.pi
            if one.kind != "continuous":
                joint.GetLowerLimitAttr().Set(unit * one.limits[0])
                joint.GetUpperLimitAttr().Set(unit * one.limits[1])
    stage.Save()
    return path


@settings(max_examples=15, deadline=None, phases=(Phase.explicit, Phase.generate))
@given(chain=chains(), metres=st.sampled_from((1.0, 0.01, 0.0254)), up=st.sampled_from(("Y", "Z")))
def test_a_generated_stage_is_what_yourdfpy_has_of_the_same_chain(chain: list[Made], metres: float, up: str):
    pytest.importorskip("pxr")
    with TemporaryDirectory() as folder:
        stage = write_stage(Path(folder), chain, metres, up)
        found = read_source(stage, Path(folder) / "scratch", FAST)
        twin = replace(load_source(write_urdf(Path(folder), chain), None), color=np.full(3, np.nan))
        assert compare_read(found, twin) == []


@pytest.mark.real
@pytest.mark.parametrize("number", ["100671", "101909", "102060", "11178"])
def test_the_urdf_of_a_real_object_is_what_yourdfpy_has(real_objects: Path, tmp_path: Path, number: str):
    path = real_objects / "partnet_mobility" / number / "mobility.urdf"
    assert compare_read(read_source(path, tmp_path, FAST), load_source(path, None)) == []


@pytest.mark.real
@pytest.mark.parametrize("case", sorted((*CASES, *REFUSED)))
def test_files_of_known_faults_have_their_right_values(real_objects: Path, case: str):
    folder = real_objects / "cases" / case
    if not folder.is_dir():
        pytest.skip(f"no case under {folder}")
    rows = list(judge(folder))
    assert [(what, got) for what, _, got in rows] == [(what, want) for what, want, _ in rows]


def robot(links: int, kind: str) -> str:
    """A row of boxes, each on the one before."""
    box = '<visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'
    rows = [f'<link name="l{k}">{box}</link>' for k in range(links)]
    rows += [
        f'<joint name="j{k}" type="{kind}"><parent link="l{k - 1}"/><child link="l{k}"/>'
        f'<limit lower="0" upper="1"/></joint>'
        for k in range(1, links)
    ]
    return f"<robot name='row'>{''.join(rows)}</robot>"


def sdf(links: int, ends: tuple[str, ...]) -> str:
    """Boxes, of which joints lead from each of some to the next."""
    box = "<visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual>"
    rows = [f"<link name='l{k}'><pose>0 0 0 0 0 0</pose>{box}</link>" for k in range(links)]
    rows += [
        f"<joint name='j{child}' type='fixed'><parent>{parent}</parent><child>{child}</child></joint>"
        for parent, child in pairwise(ends)
    ]
    return f"<sdf version='1.9'><model name='row'>{''.join(rows)}</model></sdf>"


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("row.urdf", robot(302, "revolute"), "holds 301 moving joints and 302 visuals, at most 300"),
        ("row.urdf", robot(5001, "fixed"), "holds 0 moving joints and 5,001 visuals"),
        ("row.urdf", robot(2, "fixed").replace("0.1 0.1", "${w} 0.1"), "xacro (needs|cannot)"),
        ("row.urdf", robot(2, "fixed").replace("box size", "mesh filename"), "is missing, looked for at"),
        ("row.urdf", robot(2, "fixed").replace('"l0"/>', '"l1"/>'), "is its own ancestor"),
        (
            "row.urdf",
            robot(1, "").replace('size="0.1 0.1 0.1"', 'size="1e-200 1e-200 1e-200"'),
            "has an area",
        ),
        ("row.sdf", "<sdf/>", "holds no <model>"),
        ("row.sdf", sdf(3, ("l1", "l2", "l1")), "form a circle"),
        ("row.sdf", sdf(2, ("l0", "gone")), "names link 'gone', expected one of l0, l1"),
        ("row.sdf", sdf(2, ("l0", "l1")).replace("0 0 0 0 0 0", "0 nan 0 0 0 0"), "<pose> is '0 nan"),
        ("row.sdf", sdf(2, ("l0", "l1")).replace("<box>", '<box a="&x;">'), "not valid XML"),
        (
            "row.sdf",
            sdf(2, ("l0", "l1")).replace("<pose>", '<pose relative_to="l1">'),
            r"the pose of 'l[01]' depends on itself",
        ),
        ("row.xml", "<mujoco>" + "<worldbody>" * 2000, "not valid XML"),
    ],
)
def test_what_cannot_be_kept_is_refused_in_one_sentence(tmp_path: Path, name: str, text: str, said: str):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(SourceError, match=said) as error:
        read_source(path, tmp_path / "scratch", FAST)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)
    assert {file.name for file in tmp_path.iterdir()} <= {name, "scratch"}


@pytest.mark.parametrize(("faces", "read"), [(MOST_FACES, True), (MOST_FACES + 1, False)])
def test_a_mesh_holds_half_a_million_triangles(tmp_path: Path, faces: int, *, read: bool):
    if read:
        check_size(tmp_path, faces)
    else:
        with pytest.raises(SourceError, match="holds 500,001 triangles"):
            check_size(tmp_path, faces)
