"""What MuJoCo and yourdfpy load from a source is what is read: extents closed and open, joints, colours.

Generated files hold nested frames, mirrored and unequal scales, odd names, bodies without mass and joints of
any sort; the files of known faults and the objects at hand are read beside them where they are there.
"""

# mujoco is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco
import numpy as np
import pytest
import trimesh
import yourdfpy
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from source_cases import CASES, REFUSED, judge

from artigen.datasets.mesh_files import MOST_FACES, check_size
from artigen.datasets.mjcf import read_mjcf
from artigen.datasets.source_object import ReaderConfig, SourceObject
from artigen.datasets.sources import read_source
from artigen.datasets.urdf_file import read_urdf
from artigen.errors import SourceError
from artigen.kinematics import displacements, movable_parts
from artigen.transforms import matrix_from_rpy, quat_from_matrix, transform_points

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


def extents_at(found: SourceObject, part: int | None) -> np.ndarray:
    """Extents (m) with one part at its open end and its followers nowhere but closed; None: all closed."""
    asset = found.asset
    q = [asset.parts[k].joint.upper if k == part else 0.0 for k in movable_parts(asset)]
    corners = found.triangles.vertices[found.triangles.faces]
    moved = [
        transform_points(T, corners[found.triangles.part_ids == k].reshape(-1, 3))
        for k, T in enumerate(displacements(asset, np.array(q)))
    ]
    return np.ptp(np.concatenate(moved), axis=0) * asset.scale


def mujoco_extents(path: Path, joint: int | None) -> np.ndarray:
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    if joint is not None:
        limited = bool(model.jnt_limited[joint])
        data.qpos[joint] = max(model.jnt_range[joint], key=abs) if limited else 0.0
    mujoco.mj_kinematics(model, data)
    points = []
    for geom in range(model.ngeom):
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = int(model.geom_dataid[geom])
            start, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
            own = model.mesh_vert[start : start + count]
        else:
            own = trimesh.creation.box(2 * model.geom_size[geom]).vertices
        points.append(own @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])
    return np.ptp(np.concatenate(points), axis=0)


def yourdfpy_extents(path: Path, joint: str | None, value: float) -> np.ndarray:
    robot = yourdfpy.URDF.load(str(path))
    robot.update_cfg({} if joint is None else {joint: value})
    return robot.scene.extents


@settings(max_examples=15, deadline=None, phases=(Phase.explicit, Phase.generate))
@given(chain=chains())
def test_generated_mjcf_is_where_mujoco_has_it(chain: list[Made]):
    with TemporaryDirectory() as folder:
        path = write_mjcf(Path(folder), chain)
        found = read_source(path, Path(folder) / "scratch", FAST)
        model = mujoco.MjModel.from_xml_path(str(path))
        assert len(movable_parts(found.asset)) == model.njnt
        np.testing.assert_allclose(extents_at(found, None), mujoco_extents(path, None), atol=1e-5)
        order = [joint.name for joint in read_mjcf(path).joints if joint.type != "fixed"]
        for part, name in zip(movable_parts(found.asset), order, strict=True):
            if found.asset.parts[part].joint.type != "continuous":
                want = mujoco_extents(path, model.joint(name).id)
                np.testing.assert_allclose(extents_at(found, part), want, atol=1e-5)


@settings(max_examples=15, deadline=None, phases=(Phase.explicit, Phase.generate))
@given(chain=chains())
def test_generated_urdf_is_where_yourdfpy_has_it(chain: list[Made]):
    with TemporaryDirectory() as folder:
        path = write_urdf(Path(folder), chain)
        found = read_source(path, Path(folder) / "scratch", FAST)
        joints = [joint for joint in read_urdf(path).joints if joint.type != "fixed"]
        assert len(movable_parts(found.asset)) == len(joints)
        np.testing.assert_allclose(extents_at(found, None), yourdfpy_extents(path, None, 0.0), atol=1e-5)
        for part, joint in zip(movable_parts(found.asset), joints, strict=True):
            if joint.type != "continuous":
                ends = (joint.lower or 0.0, joint.upper or 0.0)
                want = yourdfpy_extents(path, joint.name, max(ends, key=abs))
                np.testing.assert_allclose(extents_at(found, part), want, atol=1e-5)


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
