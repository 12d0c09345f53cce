"""Reads small files of known faults and compares each value with the right one.

python benchmarks/source_cases.py ../shared/data/cases
"""

import argparse
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from artigen.datasets.source_object import ReaderConfig, SourceObject
from artigen.datasets.sources import list_objects, read_source
from artigen.errors import SourceError
from artigen.files.mtl import parse_mtl

CABINET = (0.42, 0.40, 0.50)
Row = tuple[str, object, object]


def extents(found: SourceObject) -> Row:
    size = np.ptp(found.triangles.vertices, axis=0) * found.asset.scale
    return "extents (m)", CABINET, tuple((np.round(size / 0.005) * 0.005).round(3).tolist())


def joints(found: SourceObject, *want: tuple[str, tuple[int, ...], float]) -> Row:
    said = [
        (p.joint.type, tuple(np.round(p.joint.axis).astype(int).tolist()), round(p.joint.upper, 3))
        for p in found.asset.parts
        if p.joint.type != "fixed"
    ]
    return "joints (type, axis, upper)", list(want), said


def materials(found: SourceObject, part: str = "door_0") -> list[tuple[tuple[float, ...], float, str]]:
    """Colour, opacity and image of the materials of a part."""
    number = [p.name for p in found.asset.parts].index(part)
    visuals = [visual for visual in found.visuals if visual.part == number]
    return [
        (tuple(round(c, 2) for c in m.color), round(m.opacity, 2), m.image)
        for visual in visuals
        for m in parse_mtl(visual.path.with_suffix(".mtl")).values()
    ]


def mean_color(found: SourceObject, part: str = "door_0") -> tuple[float, ...]:
    surface = found.asset.surface
    assert surface is not None
    number = [p.name for p in found.asset.parts].index(part)
    mean = surface.colors[surface.part_ids == number].mean(axis=0) / 255
    return tuple(np.round(mean, 1).tolist())


DOOR = ("revolute", (0, 0, 1), 1.57)
CASES: dict[str, Callable[[SourceObject], list[Row]]] = {
    "alpha": lambda s: [("opacity of the door", 0.3, materials(s)[0][1]), joints(s, DOOR)],
    "hf_cache": lambda s: [extents(s), joints(s, DOOR)],
    "mj_box_texture": lambda s: [("mean colour", (0.5, 0.0, 0.5), mean_color(s)), joints(s, DOOR)],
    "mj_decal": lambda s: [
        extents(s),
        joints(s, DOOR),
        ("colours of the door", 2, len({color for color, _, _ in materials(s)})),
    ],
    "mj_eq_inactive": lambda s: [
        ("followers", (), s.follows),
        joints(s, DOOR, ("revolute", (0, 0, -1), 1.57)),
    ],
    "mj_massless": lambda s: [extents(s), joints(s, DOOR)],
    "mj_root_rot": lambda s: [extents(s), joints(s, ("revolute", (0, 0, 1), 1.571))],
    "mj_three_joints": lambda s: [
        joints(s, DOOR),
        ("said", True, any("'hinge' (revolute) is kept" in note for note in s.asset.notes)),
    ],
    "obj_neg_index": lambda s: [extents(s), ("colour", (0.8, 0.2, 0.2), materials(s)[0][0])],
    "obj_uv_color": lambda s: [extents(s), ("colour, image", ((0.8, 0.1, 0.1), 1.0, ""), materials(s)[0])],
    "overclose_0.1": lambda s: [extents(s), joints(s, DOOR)],
    "tex_backslash": lambda s: [("image", True, bool(materials(s)[0][2])), joints(s, DOOR)],
}
REFUSED = {"mj_slide_nolimit": r"mj_slide_nolimit\.xml: joint 'tr' slides without limits"}


def judge(folder: Path) -> Iterator[Row]:
    """Rows of a case: what, the right value, and the value read."""
    with tempfile.TemporaryDirectory() as copy:
        shutil.copytree(folder, Path(copy) / folder.name, symlinks=True)
        restore_links(Path(copy) / folder.name)
        yield from judge_copy(Path(copy) / folder.name)


def restore_links(folder: Path) -> None:
    """Makes links of files that hold nothing but the relative path of another file, as git stores links."""
    for file in [file for file in folder.rglob("*") if file.is_file() and file.stat().st_size < 256]:
        text = file.read_text(errors="replace")
        if "\n" not in text and "/" in text and (file.parent / text).is_file():
            file.unlink()
            file.symlink_to(text)


def judge_copy(folder: Path) -> Iterator[Row]:
    files = sorted(file for kind in ("*.urdf", "*.xml", "**/*.urdf") for file in folder.glob(kind))
    with tempfile.TemporaryDirectory() as scratch:
        try:
            assert not list_objects(files[0])
            found = read_source(files[0], Path(scratch), ReaderConfig(samples=20_000))
            yield from [] if folder.name in REFUSED else CASES[folder.name](found)
            if folder.name in REFUSED:
                yield "refused", True, False
        except SourceError as err:
            right = re.search(REFUSED.get(folder.name, "$^"), str(err)) is not None
            yield "refused", folder.name in REFUSED, right or str(err)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    right = 0
    names = sorted((*CASES, *REFUSED))
    for name in names:
        rows = list(judge(parser.parse_args().folder / name))
        wrong = [row for row in rows if row[1] != row[2]]
        right += not wrong
        print(f"{name}: {'right' if not wrong else 'WRONG'} ({len(rows)} values)")
        for what, want, got in wrong:
            print(f"    {what}: {got}, expected {want}")
    print(f"{right} of {len(names)} right")


if __name__ == "__main__":
    main()
