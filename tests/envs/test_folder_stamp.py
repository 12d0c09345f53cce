"""What is read from a folder is kept exactly as long as its files are as they were."""

from pathlib import Path

import pytest

from envs.folder_stamp import folder_stamp, kept_until_written


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "a" / "collision").mkdir(parents=True)
    (tmp_path / "a" / "collision" / "hull.obj").write_text("one")
    (tmp_path / "a" / "robot.urdf").write_text("two")
    return tmp_path / "a"


def write(folder: Path) -> None:
    (folder / "collision" / "hull.obj").write_text("three")


def add(folder: Path) -> None:
    (folder / "collision" / "other.obj").write_text("")


def remove(folder: Path) -> None:
    (folder / "collision" / "hull.obj").unlink()


def replace_alike(folder: Path) -> None:
    """Another file of the same size and name, as a package that is written again has."""
    (folder / "new").write_text("six")
    (folder / "new").replace(folder / "robot.urdf")


@pytest.mark.parametrize("change", [write, add, remove, replace_alike])
def test_a_stamp_changes_with_any_file_at_any_depth(folder: Path, change):
    before = folder_stamp(folder)
    assert folder_stamp(folder) == before
    change(folder)
    assert folder_stamp(folder) != before


def test_a_result_is_kept_until_a_file_changes(folder: Path):
    calls = []

    @kept_until_written(4)
    def read(folder: Path, name: str) -> str:
        calls.append(name)
        return (folder / name).read_text()

    assert [read(folder, "robot.urdf"), read(folder, "robot.urdf")] == ["two", "two"]
    assert read(folder, "collision/hull.obj") == "one"
    assert calls == ["robot.urdf", "collision/hull.obj"]
    (folder / "robot.urdf").write_text("changed")
    assert read(folder, "robot.urdf") == "changed"
