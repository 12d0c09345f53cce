"""Laws of OBJ and MTL files: what lines, indices and materials say, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from artigen.errors import SourceError
from artigen.files.mtl import MtlMaterial, parse_mtl
from artigen.files.wavefront import parse_obj


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


def write_obj(folder: Path, *lines: str) -> Path:
    (folder / "a.obj").write_text("\n".join(lines) + "\n")
    return folder / "a.obj"


SPELLINGS = ("{} {} {}", "{} {} {} 0.5 0.25 0.125", "{} {} {} 1", "  {}   {} {} ")


@pytest.mark.parametrize("seed", range(5))
def test_positions_do_not_depend_on_what_lines_append(tmp_path: Path, seed: int):
    """Colours, weights and spaces, on all lines, some or none."""
    rng = np.random.default_rng(seed)
    expected = rng.integers(-9, 9, (12, 3)).astype(float)
    rows = [f"v {SPELLINGS[rng.integers(4)].format(*row)}" for row in expected.tolist()]
    np.testing.assert_array_equal(parse_obj(write_obj(tmp_path, *rows)).vertices, expected)


@pytest.mark.parametrize("form", ["{v}", "{v}/{t}", "{v}//{v}", "{v}/{t}/{v}"])
def test_relative_indices_name_the_last_lines_above_the_face(tmp_path: Path, form: str):
    """A file is the same with each index counted from its start or back from its face."""
    counted: dict[bool, list[str]] = {True: [], False: []}
    for block in range(3):
        for rows in counted.values():
            rows += [f"v {block} {k} 0" for k in range(4)]
            rows += [f"vn 0 0 {k + 1}" for k in range(4)] + [f"vt {k} {block}" for k in range(5)]
        vertices, coords = 4 * (block + 1), 5 * (block + 1)
        for corners in ((1, 2, 3), (2, 3, 4, 1)):
            for back, rows in counted.items():
                words = [
                    form.format(
                        v=4 * block + k - (vertices + 1 if back else 0),
                        t=5 * block + k - (coords + 1 if back else 0),
                    )
                    for k in corners
                ]
                rows.append("f " + " ".join(words))
    found, expected = (parse_obj(write_obj(tmp_path, *counted[back])) for back in (True, False))
    np.testing.assert_array_equal(found.faces, expected.faces)
    np.testing.assert_array_equal(found.uv_faces, expected.uv_faces)


@pytest.mark.parametrize("face", ["0 1 2", "1 2 4", "-4 1 2", "1/1 2/2 3/4", "1/1 2/2 3/-4"])
def test_an_index_beyond_the_lines_above_is_refused(tmp_path: Path, face: str):
    rows = [f"v {k} 0 0" for k in range(3)] + [f"vt {k} 0" for k in range(3)]
    with pytest.raises(SourceError, match=f"face '{face}' names a .* that is not there, allowed are 1..3"):
        parse_obj(write_obj(tmp_path, *rows, f"f {face}"))
