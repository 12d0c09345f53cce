"""Laws of reading object.json (SINGAPO, ACD), on the sample cabinet in that layout."""

import json

import numpy as np
import pytest
from cabinet_files import assert_same_parts, cabinet_acd

from artigen.datasets.source_object import ReaderConfig
from artigen.datasets.sources import find_layout, read_source
from artigen.errors import SourceError

FAST = ReaderConfig(samples=5000, size=1.0)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scratch").mkdir()
    (tmp_path / "oid").mkdir()
    cabinet_acd(tmp_path / "oid")
    return tmp_path / "oid"


def edit(folder, change):
    path = folder / "object.json"
    value = json.loads(path.read_text())
    change(value["diffuse_tree"])
    path.write_text(json.dumps(value))


def test_the_cabinet_comes_back(folder, cabinet):
    assert find_layout(folder) == "object.json"
    for source in (folder, folder / "object.json"):
        found = read_source(source, folder.parent / "scratch", FAST).asset
        assert_same_parts(found.parts, cabinet.parts)
        assert (found.name, found.category) == ("oid", "Wardrobe")


def test_sizes_come_from_the_category_as_lengths_are_normalised(folder):
    found = read_source(folder, folder.parent / "scratch", ReaderConfig(samples=100)).asset
    assert found.scale == pytest.approx(0.8, rel=0.3)


def test_a_range_that_begins_elsewhere_is_moved_to_its_beginning(folder, cabinet):
    def shift(tree):
        for item in tree:
            if item["name"] == "drawer":
                item["joint"]["range"] = [0.1, 0.46]

    edit(folder, shift)
    found = read_source(folder, folder.parent / "scratch", FAST).asset
    drawer = next(part for part in found.parts if part.label == "drawer")
    want = next(part for part in cabinet.parts if part.label == "drawer")
    assert drawer.joint.upper * found.scale == pytest.approx(want.joint.upper, rel=0.12)


def test_boxes_stand_for_parts_without_meshes(folder, cabinet):
    def forget(tree):
        for item in tree:
            item["plys"] = []

    edit(folder, forget)
    found = read_source(folder, folder.parent / "scratch", FAST).asset
    assert len(found.parts) == len(cabinet.parts)
    for part, want in zip(found.parts, cabinet.parts, strict=True):
        np.testing.assert_allclose(part.box, want.box, atol=1e-6)
    assert sum("its box stands for it" in note for note in found.notes) == len(cabinet.parts)


def set_part(index, **values):
    return lambda tree: tree[index].update(values)


BAD = {
    "an unknown joint": (
        lambda t: t[2]["joint"].update(type="hinge"),
        "part 2: joint type 'hinge' is not one of",
    ),
    "no axis": (lambda t: t[2]["joint"].pop("axis"), "part 2: 'axis' holds None, expected dict"),
    "a flat axis": (
        lambda t: t[4]["joint"]["axis"].update(direction=[0, 0, 0]),
        "part 4: axis direction .* no length",
    ),
    "a range of one": (
        lambda t: t[4]["joint"].update(range=[3]),
        r"part 4: 'range' holds \[3\], expected two",
    ),
    "radians of a million": (
        lambda t: t[4]["joint"].update(range=[0, 1e6]),
        "part 4: 'range' is 1e.06 degrees",
    ),
    "an unknown parent": (set_part(4, parent=77), "part 4: parent 77 is not a part"),
    "a cycle": (set_part(4, parent=6), "its parents .* form a cycle"),
    "two bases": (set_part(4, parent=-1), r"bases \[0, 4\], expected one"),
    "two ids": (set_part(4, id=2), "part ids occur twice"),
    "text": (set_part(4, id="4"), "'id' holds '4', expected int"),
    "a mesh elsewhere": (
        set_part(4, plys=["../../secret.ply"]),
        "names file '../../secret.ply', which lies outside",
    ),
    "nothing to see": (lambda t: (t[4].pop("aabb"), t[4].update(plys=[])), "has neither meshes nor 'aabb'"),
    "no tree": (lambda t: t.clear(), r"bases \[\], expected one"),
}


@pytest.mark.parametrize("case", list(BAD))
def test_bad_files_are_refused_in_one_sentence(folder, case):
    change, message = BAD[case]
    edit(folder, change)
    with pytest.raises(SourceError, match=message) as error:
        read_source(folder, folder.parent / "scratch", FAST)
    assert "object.json" in str(error.value)


def test_missing_meshes_are_noted(folder):
    edit(folder, set_part(0, objs=["objs/gone.obj"]))
    found = read_source(folder, folder.parent / "scratch", FAST).asset
    assert any("objs are missing or empty: objs/gone.obj" in note for note in found.notes)
