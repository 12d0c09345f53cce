"""Laws of asset folders: round trip, equal bytes, all or nothing, strict reading."""

import json
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from artigen import io
from artigen.errors import SourceError
from artigen.io import read_asset, whole_folder, write_arrays, write_asset, write_whole
from artigen.types import Asset, Gaussians


@pytest.fixture(scope="module")
def asset(cabinet) -> Asset:
    """The cabinet with everything an asset can hold."""
    rng = np.random.default_rng(0)
    quats = rng.normal(size=(50, 4))
    gaussians = Gaussians(
        means=rng.uniform(-0.5, 0.5, (50, 3)),
        quats=quats / np.linalg.norm(quats, axis=1, keepdims=True),
        scales=rng.uniform(0.001, 0.1, (50, 3)),
        opacities=rng.uniform(size=50),
        colors=rng.uniform(size=(50, 3)),
        part_ids=rng.integers(0, len(cabinet.parts), 50),
    )
    return replace(cabinet, gaussians=gaussians, notes=("one thing — was moved", "another"))


def assert_equal(a, b) -> None:
    """Equal values, field by field, arrays bit by bit."""
    assert type(a) is type(b)
    if isinstance(a, np.ndarray):
        assert a.dtype == b.dtype
        np.testing.assert_array_equal(a, b)
    elif isinstance(a, tuple):
        assert len(a) == len(b)
        for left, right in zip(a, b, strict=True):
            assert_equal(left, right)
    elif hasattr(a, "__dataclass_fields__"):
        for field in fields(a):
            assert_equal(getattr(a, field.name), getattr(b, field.name))
    else:
        assert a == b


def test_round_trip_is_the_identity(asset, tmp_path):
    write_asset(asset, tmp_path / "asset")
    assert_equal(read_asset(tmp_path / "asset"), asset)


def test_an_asset_without_arrays_stays_without(asset, tmp_path):
    bare = replace(asset, voxels=None, surface=None, gaussians=None)
    write_asset(bare, tmp_path / "bare")
    assert_equal(read_asset(tmp_path / "bare"), bare)


def test_equal_assets_give_equal_bytes(asset, tmp_path):
    write_asset(asset, tmp_path / "a")
    write_asset(read_asset(tmp_path / "a"), tmp_path / "b")
    names = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert names == ["asset.json", "asset.npz"]
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_an_older_folder_is_replaced_whole(asset, tmp_path):
    target = tmp_path / "asset"
    target.mkdir()
    (target / "stale.txt").write_text("old")
    write_asset(asset, target)
    assert sorted(path.name for path in target.iterdir()) == ["asset.json", "asset.npz"]
    assert [path.name for path in tmp_path.iterdir()] == ["asset"]


def test_a_failed_write_leaves_what_was_there(asset, tmp_path, monkeypatch):
    target = tmp_path / "asset"
    write_asset(asset, target)
    before = (target / "asset.json").read_bytes()

    def full_disk(arrays, path):
        path.write_bytes(b"half")
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(io, "write_arrays", full_disk)
    with pytest.raises(OSError, match="No space left"):
        write_asset(replace(asset, name="other"), target)
    with pytest.raises(OSError, match="No space left"):
        write_asset(asset, tmp_path / "new")
    assert [path.name for path in tmp_path.iterdir()] == ["asset"]
    assert (target / "asset.json").read_bytes() == before


@pytest.mark.parametrize("content", ["text — so", b"bytes\x00"])
def test_a_file_is_written_whole_or_leaves_nothing(tmp_path, content):
    path = write_whole(tmp_path / "new" / "file", content)
    assert (path.read_bytes() if isinstance(content, bytes) else path.read_text("utf-8")) == content
    with pytest.raises(IsADirectoryError):
        write_whole(path.parent, content)
    assert [one.relative_to(tmp_path) for one in tmp_path.rglob("*")] == [Path("new"), Path("new/file")]


def test_a_file_in_the_way_is_refused(tmp_path):
    (tmp_path / "asset").write_text("a file")
    with pytest.raises(FileExistsError, match="is a file"), whole_folder(tmp_path / "asset"):
        pass
    assert (tmp_path / "asset").read_text() == "a file"


BREAKS = {
    "unknown key": (lambda v: v | {"colour": 1}, "unknown keys colour"),
    "missing key": (lambda v: {k: x for k, x in v.items() if k != "scale"}, "missing keys scale"),
    "other format": (lambda v: v | {"format": "artigen-asset-0"}, "'format' is 'artigen-asset-0'"),
    "text for a number": (lambda v: v | {"scale": "1"}, "'scale' holds '1'"),
    "no scale": (lambda v: v | {"scale": 0.0}, "scale 0.0 metres"),
    "unknown label": (lambda v: edit_part(v, label="lid"), "'label' is 'lid', expected one of base"),
    "unknown key in a part": (lambda v: edit_part(v, mass=3.0), "part 1: unknown keys mass"),
    "ragged box": (lambda v: edit_part(v, box=[[0, 0, 0], [1]]), "inhomogeneous|setting an array"),
    "own parent": (lambda v: edit_part(v, parent=1), "its own ancestor"),
    "two roots": (lambda v: edit_part(v, parent=-1), "2 roots"),
    "long axis": (lambda v: edit_joint(v, axis=[2.0, 0.0, 0.0]), "has length 2"),
    "unknown joint": (lambda v: edit_joint(v, type="hinge"), "'type' is 'hinge'"),
    "null limit": (lambda v: edit_joint(v, upper=None), "'upper' holds None"),
}


def edit_part(value, **changes):
    parts = [dict(part) for part in value["parts"]]
    parts[1] |= changes
    return value | {"parts": parts}


def edit_joint(value, **changes):
    return edit_part(value, joint=value["parts"][1]["joint"] | changes)


@pytest.mark.parametrize("name", BREAKS)
def test_a_damaged_description_is_one_clear_error(asset, tmp_path, name):
    change, message = BREAKS[name]
    folder = tmp_path / "asset"
    write_asset(replace(asset, surface=None, voxels=None, gaussians=None), folder)
    path = folder / "asset.json"
    path.write_text(json.dumps(change(json.loads(path.read_text()))))
    with pytest.raises(SourceError, match=message) as caught:
        read_asset(folder)
    assert str(path) in str(caught.value)


def test_damaged_arrays_are_one_clear_error(asset, tmp_path):
    folder = tmp_path / "asset"
    write_asset(asset, folder)
    path = folder / "asset.npz"
    whole = path.read_bytes()
    arrays = io.read_arrays(path)
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(SourceError, match=r"asset\.npz: arrays cannot be read"):
        read_asset(folder)
    write_arrays(arrays | {"surface.weights": np.zeros(3)}, path)
    with pytest.raises(SourceError, match=r"unknown arrays surface\.weights"):
        read_asset(folder)
    write_arrays({name: array for name, array in arrays.items() if name != "surface.normals"}, path)
    with pytest.raises(SourceError, match="surface lacks normals"):
        read_asset(folder)
    write_arrays(arrays | {"surface.points": np.full_like(arrays["surface.points"], np.nan)}, path)
    with pytest.raises(SourceError, match="surface points: holds NaN"):
        read_asset(folder)
    np.savez(path, **{"voxels.coords": np.array([{"a": 1}], dtype=object)})
    with pytest.raises(SourceError, match="pickle"):
        read_asset(folder)
    path.unlink()
    with pytest.raises(SourceError, match=r"asset\.npz"):
        read_asset(folder)
