"""Laws of USD: bodies, joints, masses and colliders are those of the package, and files repeat."""

import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from artigen.shapes.draw import draw_shape
from sim_export.collision.motion import link_displacements
from sim_export.files.urdf import link_origins
from sim_export.files.write import write_package
from sim_export.package import SimPackage
from sim_export.reference import build_reference

pxr = pytest.importorskip("pxr", reason="usd-core is not installed; the extra artigen[usd] has it")

from pxr import Usd, UsdGeom, UsdPhysics, UsdShade  # noqa: E402

from sim_export.usd.labels import SUBSTANCES  # noqa: E402
from sim_export.usd.write import asset_name, build_stage, write_usd  # noqa: E402

# pxr is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

DATE = "2026-01-31"


@pytest.fixture(scope="module")
def package() -> SimPackage:
    """A dishwasher: hinge, slide and knob, boxes, cylinders and other hulls, glass."""
    return build_reference(draw_shape("WashingMachine", 4))


@pytest.fixture(scope="module")
def stage(package) -> Usd.Stage:
    return build_stage(package, date=DATE, license="Apache-2.0")[0]


def body(stage: Usd.Stage, name: str) -> Usd.Prim:
    return stage.GetPrimAtPath(f"{stage.GetDefaultPrim().GetPath()}/{name}")


def frame(pos, quat) -> np.ndarray:
    """A pose as a matrix, from USD's position and quaternion."""
    from artigen.transforms import matrix_from_quat

    T = np.eye(4)
    T[:3, :3] = matrix_from_quat(np.array([quat.GetReal(), *quat.GetImaginary()], dtype=float))
    T[:3, 3] = pos
    return T


def moved_frames(stage: Usd.Stage, package: SimPackage, qpos: dict[str, float]) -> dict[str, np.ndarray]:
    """World poses of all bodies with joints at some coordinates, by what the joints of the stage say."""
    from scipy.spatial.transform import Rotation

    poses: dict[str, np.ndarray] = {}
    joints = [UsdPhysics.Joint(prim) for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint)]
    while len(poses) < len(joints):
        for joint in joints:
            (child,), parent = joint.GetBody1Rel().GetTargets(), joint.GetBody0Rel().GetTargets()
            if child.name in poses or (parent and parent[0].name not in poses):
                continue
            start = poses[parent[0].name] if parent else np.eye(4)
            at, turn = joint.GetLocalPos0Attr().Get(), joint.GetLocalRot0Attr().Get()
            motion = np.eye(4)
            q = qpos.get(joint.GetPrim().GetName(), 0.0)
            if joint.GetPrim().IsA(UsdPhysics.PrismaticJoint):
                motion[2, 3] = q
            else:
                motion[:3, :3] = Rotation.from_rotvec([0.0, 0.0, q]).as_matrix()
            back = frame(joint.GetLocalPos1Attr().Get(), joint.GetLocalRot1Attr().Get())
            poses[child.name] = start @ frame(at, turn) @ motion @ np.linalg.inv(back)
    return poses


@pytest.mark.parametrize("fraction", [0.0, 0.4, 1.0])
def test_joints_move_links_where_the_package_does(stage, package, fraction):
    qpos = {joint.name: joint.lower + fraction * (joint.upper - joint.lower) for joint in package.joints}
    expected = link_displacements(package.links, package.joints, qpos)
    found, origins = moved_frames(stage, package, qpos), link_origins(package)
    assert set(found) == {link.name for link in package.links}
    for link, displacement in zip(package.links, expected, strict=True):
        rest = np.eye(4)
        rest[:3, 3] = origins[link.name]
        np.testing.assert_allclose(found[link.name], displacement @ rest, atol=3e-6)


def test_bodies_stand_and_weigh_as_in_the_package(stage, package):
    for link in package.links:
        prim, origin = body(stage, link.name), link_origins(package)[link.name]
        world = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(0)).T
        np.testing.assert_allclose(world[:3, 3], origin, atol=1e-9)
        mass = UsdPhysics.MassAPI(prim)
        assert mass.GetMassAttr().Get() == pytest.approx(link.inertial.mass, rel=1e-6)
        np.testing.assert_allclose(mass.GetCenterOfMassAttr().Get(), link.inertial.com - origin, atol=1e-6)
        axes = frame(np.zeros(3), mass.GetPrincipalAxesAttr().Get())[:3, :3]
        inertia = axes @ np.diag(mass.GetDiagonalInertiaAttr().Get()) @ axes.T
        np.testing.assert_allclose(inertia, link.inertial.inertia, atol=1e-5 * np.trace(inertia))


def test_every_dialect_says_the_same_limits_friction_and_damping(stage, package):
    root = stage.GetDefaultPrim().GetPath()
    for joint in package.joints:
        prim = stage.GetPrimAtPath(f"{root}/joints/{joint.name}")
        turning = joint.type != "prismatic"
        per, axis = (180.0 / np.pi, "angular") if turning else (1.0, "linear")
        said = {
            name: float(prim.GetAttribute(name).Get())
            for name in (
                "newton:friction",
                "mjc:frictionloss",
                f"physxJointAxis:{axis}:staticFrictionEffort",
                f"physxJointAxis:{axis}:dynamicFrictionEffort",
            )
        }
        assert said == pytest.approx(dict.fromkeys(said, joint.friction), rel=1e-6)
        damping = [
            prim.GetAttribute("mjc:damping").Get(),
            per * prim.GetAttribute("newton:damping").Get(),
            per * prim.GetAttribute(f"physxJointAxis:{axis}:viscousFrictionCoefficient").Get(),
        ]
        assert damping == pytest.approx([joint.damping] * 3, rel=1e-6)
        if joint.type == "continuous":
            assert not prim.GetAttribute("physics:upperLimit").HasAuthoredValue()
        else:
            limits = [prim.GetAttribute(f"physics:{end}Limit").Get() for end in ("lower", "upper")]
            assert limits == pytest.approx([per * joint.lower, per * joint.upper], rel=1e-6, abs=1e-6)


def test_colliders_are_the_hulls_and_are_bound_to_a_friction(stage, package):
    cache = UsdGeom.BBoxCache(0, [UsdGeom.Tokens.guide])
    kinds = set()
    for link in package.links:
        for index, hull in enumerate(link.hulls):
            prim = stage.GetPrimAtPath(f"{body(stage, link.name).GetPath()}/collision_{index}")
            assert prim.HasAPI(UsdPhysics.CollisionAPI)
            kinds.add(prim.GetTypeName())
            box = cache.ComputeWorldBound(prim).ComputeAlignedRange()
            round_off = 0.02 * np.ptp(hull.vertices, axis=0).max() if prim.IsA(UsdGeom.Cylinder) else 2e-6
            np.testing.assert_allclose(box.GetMin(), hull.vertices.min(axis=0), atol=round_off)
            np.testing.assert_allclose(box.GetMax(), hull.vertices.max(axis=0), atol=round_off)
            bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0]
            assert bound.GetPrim().HasAPI(UsdPhysics.MaterialAPI)
    assert kinds == {"Cube", "Cylinder", "Mesh"}


def test_one_anchor_holds_the_body_and_the_root_is_an_articulation(stage, package):
    root = stage.GetDefaultPrim()
    assert root.HasAPI(UsdPhysics.ArticulationRootAPI)
    anchors = [
        joint
        for prim in stage.Traverse()
        if prim.IsA(UsdPhysics.Joint) and not (joint := UsdPhysics.Joint(prim)).GetBody0Rel().GetTargets()
    ]
    assert [joint.GetBody1Rel().GetTargets()[0].name for joint in anchors] == [package.links[-1].name]
    assert all(joint.GetPrim().IsA(UsdPhysics.FixedJoint) for joint in anchors)


def test_what_shows_has_true_materials(stage, package):
    materials = dict(package.materials)
    for link in package.links:
        for visual in link.visuals:
            prim = stage.GetPrimAtPath(f"{body(stage, link.name).GetPath()}/{visual.name}")
            bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0].GetPrim()
            said = list(bound.GetAttribute("semantics:labels:material").Get())
            assert said == [SUBSTANCES[materials[visual.part]].label]


def test_files_repeat_refer_to_each_other_and_name_no_place(package, tmp_path):
    first = write_usd(package, tmp_path / "a", date=DATE)
    second = write_usd(package, tmp_path / "b", date=DATE)
    name = asset_name(package)
    assert first == tmp_path / "a" / name / "simready" / f"{name}.usda"
    contents = [
        {
            path.relative_to(file.parent).as_posix(): path.read_bytes()
            for path in file.parent.rglob("*.*")
            if path.is_file()
        }
        for file in (first, second)
    ]
    assert contents[0] == contents[1]
    text = contents[0][f"{name}.usda"].decode()
    assert str(tmp_path) not in text
    for path in contents[0]:
        assert path.startswith(".thumbs/256x256/") or path == f"{name}.usda" or f"@./{path}@" in text
    write_usd(package, tmp_path / "a", date=DATE)  # in the place of the old one
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == [name]


@pytest.mark.parametrize(
    ("name", "expected"), [("45261", "object_45261"), ("Safe_0", "safe_0"), ("a b-c", "a_b_c")]
)
def test_names_are_what_prims_and_files_may_be_called(package, name, expected):
    assert asset_name(replace(package, name=name)) == expected


def test_the_command_writes_folders_and_names_what_is_wrong(package, tmp_path, monkeypatch, capsys):
    from artigen.cli.main import main

    for place in ("a", "b"):
        write_package(package, tmp_path / place / "one")

    def run(*words: str) -> int:
        monkeypatch.setattr("sys.argv", ["artigen", "usd", *words, "-o", str(tmp_path / "usd")])
        with pytest.raises(SystemExit) as done:
            main()
        return int(done.value.code or 0)

    assert run(str(tmp_path / "a")) == 0
    assert len(list((tmp_path / "usd").rglob("*.usda"))) == 1
    for words, said in (
        ((str(tmp_path),), "all would be written to"),
        ((str(tmp_path / "a"), "--date", "tomorrow"), "expected YYYY-MM-DD"),
    ):
        assert run(*words) == 1
        assert said in capsys.readouterr().err
    monkeypatch.setattr("artigen.cli.usd.find_spec", lambda name: None)
    assert run(str(tmp_path / "a")) == 1
    assert 'pip install "artigen[usd]"' in capsys.readouterr().err


def test_the_public_validator_passes_it(package, tmp_path):
    validator = os.environ.get("SIMREADY_VALIDATE") or shutil.which("simready-validate")
    if validator is None:
        pytest.skip(
            "no simready-validate: pip install simready-validate simready-foundation-tier-core into an "
            "environment of its own and name its program in SIMREADY_VALIDATE"
        )
    file = write_usd(package, tmp_path, date=DATE)
    done = subprocess.run(
        [validator, str(file), "--profile", "Robotics-Prop", "--output", str(tmp_path / "result.json")],
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert "blocking_failure" in Path(tmp_path / "result.json").read_text(), done.stdout + done.stderr
    assert '"blocking_failure": true' not in Path(tmp_path / "result.json").read_text()
