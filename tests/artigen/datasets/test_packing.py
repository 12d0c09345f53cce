"""Packing: what is taken apart is put together byte for byte, and damage is found."""

import io
import tarfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("zstandard")

from artigen.datasets.packing import (
    LISTING,
    PackingError,
    add_member,
    iterate_samples,
    list_files,
    open_tar,
    pack_files,
    read_folder,
    read_members,
    tar_bytes,
    unpack_files,
)
from artigen.datasets.shards import write_folder

PATHS = st.from_regex(r"\A[a-z]{1,8}(/[a-z]{1,8}){0,2}\.(urdf|obj|png|json)\Z")
FOLDERS = st.dictionaries(PATHS, st.binary(max_size=2000), max_size=6)


@given(files=FOLDERS, with_listing=st.booleans())
def test_unpacking_gives_the_files_that_were_packed(*, files: dict[str, bytes], with_listing: bool):
    if with_listing:
        files = files | {LISTING: list_files(files)}
    packed = pack_files(files)
    assert packed.listed == with_listing
    assert {one.path for one in packed.shared} == {path for path in files if path.endswith(".png")}
    together = unpack_files(packed.archive, packed.shared, packed.contents.__getitem__, listed=packed.listed)
    assert together == files


def test_a_listing_that_does_not_follow_is_kept():
    files = {"a.obj": b"v 0 0 0", LISTING: b"{}\n"}
    packed = pack_files(files)
    assert not packed.listed
    assert unpack_files(packed.archive, (), {}.__getitem__, listed=False) == files


def test_the_order_of_files_does_not_matter():
    files = {"b.obj": b"2", "a.obj": b"1", "c.png": b"3"}
    assert pack_files(files).archive == pack_files(dict(reversed(files.items()))).archive


def test_a_folder_survives_writing_and_reading(tmp_path: Path):
    files = {"a/b.obj": b"1", "c.png": bytes(range(256))}
    write_folder({"old.obj": b"0"}, tmp_path / "folder")
    assert read_folder(write_folder(files, tmp_path / "folder")) == files


@pytest.mark.parametrize("path", ["../evil.obj", "/evil.obj", "a/../../evil.obj"])
def test_a_path_out_of_the_folder_is_refused(path: str):
    packed = pack_files({path: b"1"})
    with pytest.raises(PackingError, match=r"out of its folder"):
        unpack_files(packed.archive, (), {}.__getitem__, listed=False)


def test_a_damaged_archive_is_refused():
    packed = pack_files({"a.obj": b"v 0 0 0"})
    with pytest.raises(PackingError, match="damaged"):
        unpack_files(packed.archive[:-5], (), {}.__getitem__, listed=False)


def test_tars_have_neither_times_nor_owners():
    with tarfile.open(fileobj=io.BytesIO(tar_bytes({"b": b"2", "a": b"1"}))) as tar:
        members = tar.getmembers()
    assert [one.name for one in members] == ["a", "b"]
    assert {(one.mtime, one.uid, one.gid, one.uname, one.gname, one.mode) for one in members} == {
        (0, 0, 0, "", "", 0o644)
    }


def test_what_a_tar_writer_writes_is_read_by_tarfile_by_samples_and_by_offset(tmp_path: Path):
    path = tmp_path / "shard.tar"
    places, content = (
        {},
        {"one.json": b"{}", "one.tar.zst": b"x" * 513, "two.json": b"[]", "two.tar.zst": b""},
    )
    with open_tar(path) as tar:
        starts = {}
        for name, data in content.items():
            starts.setdefault(name.partition(".")[0], tar.offset)
            places[name] = add_member(tar, name, data)
        end = tar.offset
    data = path.read_bytes()
    with tarfile.open(path) as tar:
        assert {one.name: tar.extractfile(one).read() for one in tar} == content
    assert all(data[at : at + len(content[name])] == content[name] for name, at in places.items())
    assert dict(iterate_samples(path)) == {
        "one": {"json": b"{}", "tar.zst": b"x" * 513},
        "two": {"json": b"[]", "tar.zst": b""},
    }
    piece = read_members(data[starts["two"] : end], "two")
    assert piece == {"two.json": b"[]", "two.tar.zst": b""}


def test_a_shard_that_is_cut_short_is_refused(tmp_path: Path):
    path = tmp_path / "shard.tar"
    with open_tar(path) as tar:
        add_member(tar, "one.json", b"x" * 2000)
    path.write_bytes(path.read_bytes()[:1500])
    with pytest.raises(PackingError, match=r"shard\.tar"):
        list(iterate_samples(path))
