"""Laws of ``import artigen``: light, one value for every way to an object, and the commands' sentences."""

# Wrong words are given on purpose.
# pyright: reportArgumentType=false, reportCallIssue=false

import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from project import ROOT
from sample_partnet import write_sample
from test_architecture import HEAVY

import artigen
from artigen.api.object import Object
from artigen.camera import look_at
from artigen.datasets.packing import read_folder
from artigen.errors import ArtigenError
from artigen.kind import spell_kind
from artigen.shapes.asset import frame_shape
from artigen.shapes.poses import pose_parts
from artigen.transforms import shift
from sim_export.errors import PackageError
from sim_export.picture.viewpoint import Viewpoint

MOST_SECONDS = 0.15
MOVERS = ("StorageFurniture", "TrashCan", "Faucet", "Pot", "Suitcase", "Microwave")
"""Kinds with drawers, followers, turning levers, lids and latches."""


def run(code: str, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@cache
def drawn(kind: str, seed: int = 0) -> Object:
    return artigen.sample(kind, seed)


def numbers(obj: Object) -> dict[str, tuple[str, np.ndarray]]:
    """Joints of an object, without classes."""
    return {
        name: (joint.type, np.array([*joint.axis, *joint.origin, joint.lower, joint.upper, joint.pitch]))
        for name, joint in obj.joints.items()
    }


def assert_same_joints(one: Object, other: Object):
    first, second = numbers(one), numbers(other)
    assert first.keys() == second.keys()
    for name, (kind, values) in first.items():
        assert second[name][0] == kind
        np.testing.assert_allclose(second[name][1], values, atol=2e-6)


def test_importing_takes_no_time_and_loads_nothing():
    code = (
        "import sys, time; start = time.process_time(); import artigen; "
        "print(time.process_time() - start, *sys.modules)"
    )
    seconds, *modules = run(code).split()
    assert float(seconds) < MOST_SECONDS
    assert not {*HEAVY, "numpy", "scipy", "PIL", "tyro"} & set(modules)


def test_completion_offers_what_there_is():
    assert set(dir(artigen)) == {*artigen.__all__, "__version__"}


def test_every_listed_name_is_there_and_kinds_are_listed_before_and_after_they_are_loaded():
    assert set(artigen.__all__) <= set(dir(artigen)) | {
        name for name in artigen.__all__ if getattr(artigen, name)
    }
    said = run("import artigen; print(*artigen.kinds()); artigen.sample('Box'); print(*artigen.kinds())")
    assert said.splitlines()[0] == said.splitlines()[1] == " ".join(artigen.kinds())
    with pytest.raises(AttributeError, match=r"no attribute 'draw'; it has .*sample"):
        artigen.draw  # type: ignore[attr-defined]  # noqa: B018


@pytest.mark.sim
@pytest.mark.slow
def test_three_lines_make_an_exported_and_validated_cabinet(tmp_path: Path):
    script = (
        "import artigen\n"
        "cabinet = artigen.sample('StorageFurniture', counts={'drawer': 2}).export('cabinet')\n"
        "assert cabinet.validate().passed"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(ROOT)!r})\n{script}"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    made = artigen.load(tmp_path / "cabinet")
    assert made.report is not None
    assert made.report.passed
    assert made.counts["drawer"] == 2


@pytest.mark.slow
@pytest.mark.parametrize("kind", MOVERS)
def test_an_object_says_the_same_as_drawn_as_built_and_as_loaded(kind: str, tmp_path: Path):
    obj = drawn(kind)
    built = Object(name=obj.name, kind=obj.kind, build=lambda: obj.package)
    loaded = artigen.load(obj.export(tmp_path / "package").folder or "")
    for other in (built, loaded):
        assert_same_joints(obj, other)
        assert {*other.parts} == {*obj.parts}
        assert other.size == pytest.approx(obj.size, abs=2e-3)  # rounds have more sides than their solids
        assert other.counts == obj.counts
        assert other.mass == pytest.approx(obj.mass, rel=1e-5)
        assert other.notes == obj.notes
    assert repr(loaded) == repr(built)
    assert len(repr(obj).splitlines()) == 1
    assert f"{obj.size[0]:.2f} m wide" in repr(obj)


@pytest.mark.parametrize("kind", MOVERS)
def test_a_joint_moves_its_part_along_or_about_its_axis_and_nothing_at_rest(kind: str):
    obj = drawn(kind)
    assert all(np.allclose(T, np.eye(4)) for T in obj.at(0.0).values())
    owner = {part.joint: part.name for part in obj.parts if part.joint is not None}
    assert owner.keys() == obj.joints.keys()
    for name, joint in obj.joints.items():
        q = 0.5 * joint.upper
        T = obj.at({name: q})[owner[name]]
        if joint.type == "prismatic":
            np.testing.assert_allclose(T[:3, 3], q * joint.axis, atol=1e-9)
            continue
        np.testing.assert_allclose(T[:3, :3] @ joint.axis, joint.axis, atol=1e-9)
        moved = T[:3, :3] @ joint.origin + T[:3, 3] - joint.origin
        np.testing.assert_allclose(moved, joint.pitch * q * joint.axis, atol=1e-9)
        assert (np.trace(T[:3, :3]) - 1) / 2 == pytest.approx(np.cos(q))


@pytest.mark.parametrize("kind", MOVERS)
def test_a_package_moves_as_its_solids_do_followers_included(kind: str):
    obj = drawn(kind)
    shape = obj.shape
    assert shape is not None
    shares = np.random.default_rng(0).uniform(0.1, 0.9, len(obj.joints))
    q = {name: float(share) * obj.joints[name].upper for name, share in zip(obj.joints, shares, strict=True)}
    own = {part.name: q[part.joint] for part in obj.parts if part.joint is not None}
    qpos = np.array([own.get(part.name, 0.0) for part in shape.parts])
    center, _ = frame_shape(shape)
    moved = obj.at(q)
    for part, T in zip(shape.parts, pose_parts(shape, qpos), strict=True):
        np.testing.assert_allclose(moved[part.name], shift(-center) @ T @ shift(center), atol=1e-9)


@pytest.mark.slow
def test_a_picture_shows_the_pose_and_the_camera_decides_its_size():
    obj = drawn("Microwave")
    assert (obj.render() == obj.render(Viewpoint())).all()
    camera = look_at(np.array([-3.0, 0.5, 0.5]), np.zeros(3), width=40, height=30)
    closed, opened, hulls = (
        obj.render(camera, *rest).astype(int) for rest in ((0.0,), (0.9,), (0.0, "collision"))
    )
    assert closed.shape == (30, 40, 3)
    assert abs(closed - opened).max() > 30
    assert abs(closed - hulls).max() > 30
    with pytest.raises(PackageError, match="no gaussians to render"):
        obj.render(layer="gaussians")
    with pytest.raises(PackageError, match="no joint lid to pose; it has joint_0"):
        obj.render(q={"lid": 1.0})


def test_exporting_what_was_exported_gives_the_same_files_and_keeps_the_report(tmp_path: Path):
    first = drawn("Switch").export(tmp_path / "first")
    assert first.report is None
    (tmp_path / "first" / "validation.json").write_text("{}")
    again = artigen.load(tmp_path / "first").export(tmp_path / "again", ("package", "glb"))
    assert again.folder == tmp_path / "again"
    assert read_folder(tmp_path / "first") == read_folder(tmp_path / "again")
    assert (tmp_path / "again.glb").read_bytes()[:4] == b"glTF"
    with pytest.raises(ArtigenError, match=r"again\.glb: exists already"):
        again.export(tmp_path / "again", "glb")
    with pytest.raises(PackageError, match="exists already"):
        again.export(tmp_path / "again")


@pytest.mark.sim
def test_validating_in_memory_leaves_no_file_and_in_a_folder_its_report(tmp_path: Path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    report = drawn("Switch").validate()
    assert not list(tmp_path.iterdir())
    lying = drawn("Switch").export(tmp_path / "switch")
    assert lying.validate().passed == report.passed
    assert lying.report is not None
    assert [check.verdict for check in lying.report.checks] == [check.verdict for check in report.checks]


def test_many_objects_are_made_one_by_one_when_they_are_asked_for():
    many = artigen.sample("Switch", 5, count=1000)
    assert len(many) == 1000
    assert repr(many) == "<1000 objects: Switch_5, Switch_6, Switch_7, ...>"
    assert [obj.name for obj in artigen.sample("Switch", [3, 1])] == ["Switch_3", "Switch_1"]
    assert many[1:3][0].size == artigen.sample("Switch", 6).size == many[1].size


def test_a_kind_is_called_by_its_name_or_any_of_its_nouns():
    for name, kind in artigen.kinds().items():
        assert {spell_kind(word) for noun in kind.nouns for word in (noun, noun.title(), name)} == {name}
    assert artigen.sample("washing  machine").size == artigen.sample("WashingMachine").size
    assert {job.category for job in artigen.generate(kind="fridges", count=2).jobs} == {"Refrigerator"}


def test_the_structure_decides_what_is_made_and_is_one_of_two():
    exact, latent = (artigen.generate("a fridge", structure=s, count=2).jobs for s in ("sketch", "latent"))
    assert {job.cfg.structure for job in latent} == {"latent"}
    assert exact[0].settings != latent[0].settings


@pytest.mark.slow
def test_processes_make_the_same_objects_in_the_same_order(tmp_path: Path):
    own, others = (artigen.sample("Switch", 2, count=2, workers=workers) for workers in (0, 1))
    done = own.export(tmp_path)
    assert [one.key for one in done if one.good] == ["Switch_2", "Switch_3"]
    assert [one.seconds for one in own.export(tmp_path)] == [one.seconds for one in done]  # kept
    for name, there in zip(("Switch_2", "Switch_3"), others, strict=True):
        assert there.folder is not None
        files = read_folder(tmp_path / name)
        assert there.report is None
        assert read_folder(there.folder) == {path: files[path] for path in files if path != "validation.json"}


@pytest.mark.slow
def test_a_source_becomes_an_object_and_several_a_sequence(tmp_path: Path):
    write_sample(tmp_path / "sources" / "one")
    made = artigen.convert(tmp_path / "sources" / "one", kind="StorageFurniture")
    assert made.report is not None
    assert made.export(tmp_path / "out").report == made.report
    shutil.copytree(tmp_path / "sources" / "one", tmp_path / "sources" / "two")
    with pytest.raises(ArtigenError, match=r"sources: 2 objects, expected one; for all of them give a list"):
        artigen.convert(tmp_path / "sources")
    assert [job.key for job in artigen.convert([tmp_path / "sources"]).jobs] == ["one", "two"]


@pytest.mark.slow
@pytest.mark.sim
def test_words_become_an_object_that_passed_as_it_was_drawn_or_drawn_again():
    made = artigen.generate("a white toaster", gaussians=False)
    assert made.kind == "Toaster"
    assert made.report is not None
    assert made.report.passed
    assert "draws" in dict(made.package.provenance)


WRONG = {
    "kind": (lambda: artigen.sample("Spoon"), ["shape", "Spoon", "-o", "out"]),
    "length": (lambda: artigen.sample("Oven", width=90.0), ["shape", "Oven", "--width", "90", "-o", "out"]),
    "count": (
        lambda: artigen.sample("Box", counts={"drawer": 40}),
        ["shape", "Box", "--counts", "drawer=40", "-o", "out"],
    ),
    "words": (
        lambda: artigen.generate("a fridge 5 cm wide"),
        ["generate", "--text", "a fridge 5 cm wide", "-o", "out"],
    ),
    "source": (lambda: artigen.convert("nowhere.urdf"), ["convert", "nowhere.urdf", "-o", "out"]),
    "package": (lambda: artigen.load("nowhere"), ["preview", "nowhere", "-o", "out.png"]),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_one_sentence_the_same_as_the_command_s(name: str, tmp_path: Path):
    call, command = WRONG[name]
    with pytest.raises(ArtigenError) as said:
        call()
    assert "\n" not in str(said.value)
    done = subprocess.run(
        [sys.executable, "-m", "artigen", *command],
        cwd=tmp_path, env={"PYTHONPATH": str(ROOT), "PATH": ""}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 1
    assert str(said.value) in done.stderr


OTHER = {
    "pose": (lambda obj, _: obj.at(1.5), "pose 1.5, expected a share from 0 to 1"),
    "no pose": (lambda obj, _: obj.at(float("nan")), "pose nan"),
    "layer": (lambda obj, _: obj.render(layer="hull"), "layer 'hull': expected one of visual, collision"),
    "light": (lambda obj, _: obj.render(light="sun"), "light 'sun'"),
    "existing": (
        lambda obj, out: obj.export(out, existing="overwrite"),
        "existing 'overwrite': expected one of",
    ),
    "format": (lambda obj, out: obj.export(out, "gbl"), "format 'gbl': expected package, glb"),
    "axis": (lambda *_: artigen.convert(ROOT, front="left"), "front 'left': expected one of x, -x"),
    "hulls": (lambda *_: artigen.convert(ROOT, collision="coacd2"), "did you mean coacd"),
    "meshes": (lambda *_: artigen.convert(ROOT, visual="voxel"), "did you mean voxels"),
    "look": (lambda obj, _: artigen.restyle(obj, seed=-1), "seed -1 of a look"),
    "structure": (lambda *_: artigen.generate("a fridge", structure="sktch"), "did you mean sketch"),
}


@pytest.mark.parametrize("name", OTHER)
def test_a_word_or_pose_that_is_none_of_those_allowed_is_refused(name: str, tmp_path: Path):
    call, said = OTHER[name]
    with pytest.raises(ArtigenError, match=said):
        call(drawn("Safe"), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_report_that_is_none_names_its_file(tmp_path: Path):
    made = drawn("Safe").export(tmp_path / "safe")
    for text in ("{", "{}"):
        (tmp_path / "safe" / "validation.json").write_text(text)
        with pytest.raises(
            PackageError, match=r"validation.json: is no report .*; validate the object again"
        ):
            made.report  # noqa: B018


def test_what_a_notebook_shows_of_an_object_and_of_a_kind_is_a_line():
    shown = [drawn("Safe"), *artigen.kinds().values(), artigen.sample("Safe", count=9)]
    assert all("\n" not in repr(one) and 10 < len(repr(one)) < 150 for one in shown)


def test_seeds_are_whole_numbers_of_any_kind():
    assert artigen.sample("Safe", np.int64(3)).name == drawn("Safe", 3).name == "Safe_3"
