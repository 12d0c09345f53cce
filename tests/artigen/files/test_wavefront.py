"""Laws of MTL files: what a material says of colour, image and opacity, and what is refused."""

from pathlib import Path

import pytest

from artigen.errors import SourceError
from artigen.files.wavefront import MtlMaterial, parse_mtl


def parse(folder: Path, *lines: str) -> MtlMaterial:
    (folder / "a.mtl").write_text("\n".join(["newmtl other", "d 0.9", "newmtl pane", *lines]) + "\n")
    found = parse_mtl(folder / "a.mtl")
    assert found["other"] == MtlMaterial(opacity=0.9)
    return found["pane"]


def test_a_material_that_says_nothing_is_grey_and_opaque(tmp_path: Path):
    assert parse(tmp_path) == MtlMaterial(color=(0.7, 0.7, 0.7), image="", opacity=1.0)


@pytest.mark.parametrize(
    ("lines", "opacity"),
    [
        (["d 0.25"], 0.25),
        (["d -halo 0.25"], 0.25),
        (["Tr 0.25"], 0.75),
        (["d 0.25", "Kd 1 0 0"], 0.25),
        (["d 1", "Tr 1"], 1.0),
        (["Tr 1", "d 1"], 1.0),
        (["d 1.5"], 1.0),
        (["d -1"], 0.0),
    ],
)
def test_opacity_is_d_or_what_tr_leaves(tmp_path: Path, lines: list[str], opacity: float):
    assert parse(tmp_path, *lines).opacity == pytest.approx(opacity)


def test_colour_image_and_opacity_come_in_any_order(tmp_path: Path):
    said = ["map_Kd -s 1 1 1 glass.png", "d 0.5", "Kd 0.1 0.2 2.0"]
    expected = MtlMaterial(color=(0.1, 0.2, 1.0), image="glass.png", opacity=0.5)
    assert parse(tmp_path, *said) == parse(tmp_path, *reversed(said)) == expected


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("d clear", "'pane' has d 'clear', expected a number"),
        ("d", "'pane' has d '', expected a number"),
        ("Tr nan", "'pane' has Tr 'nan', expected finite numbers"),
        ("Kd 1 0", "'pane' has Kd '1 0', expected three numbers"),
    ],
)
def test_numbers_that_are_none_are_refused(tmp_path: Path, line: str, message: str):
    with pytest.raises(SourceError, match=message):
        parse(tmp_path, line)
