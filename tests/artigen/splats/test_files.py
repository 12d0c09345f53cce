"""Gaussians in files, in other frames, apart and together: PLY, rigid motion, parts."""

import struct
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from artigen.errors import SourceError
from artigen.splats.motion import scale_gaussians, transform_gaussians
from artigen.splats.parts import merge_gaussians, select_gaussians
from artigen.splats.ply import decode_ply, encode_ply, read_ply
from artigen.transforms import inverse, matrix_from_quat, rotation_about, screw_motion
from artigen.types import Gaussians

REFERENCE_FIELDS = [
    "x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
    "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3",
]  # fmt: skip
"""``construct_list_of_attributes`` of the 3D Gaussian Splatting code, for degree 0."""
TURN = screw_motion(np.array([0.6, 0.0, 0.8]), np.array([0.1, 0.2, 0.3]), np.array(1.2), np.array(0.4))


def make_gaussians(count: int = 500, parts: int = 3, seed: int = 0) -> Gaussians:
    rng = np.random.default_rng(seed)
    quats = rng.normal(size=(count, 4))
    return Gaussians(
        means=rng.uniform(-0.5, 0.5, (count, 3)),
        quats=quats / np.linalg.norm(quats, axis=1, keepdims=True),
        scales=np.exp(rng.uniform(-9, 0, (count, 3))),
        opacities=np.concatenate([[0.0, 1.0], rng.uniform(0, 1, count - 2)]),
        colors=rng.uniform(0, 1, (count, 3)),
        part_ids=rng.integers(0, parts, count),
    )


def assert_equal(got: Gaussians, want: Gaussians) -> None:
    for field in fields(Gaussians):
        np.testing.assert_array_equal(getattr(got, field.name), getattr(want, field.name), field.name)


def read_table(data: bytes) -> tuple[list[str], np.ndarray]:
    """Property names and values, by the letter of the format."""
    header, body = data.split(b"end_header\n", 1)
    lines = header.decode().splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    assert lines[2].startswith("element vertex ")
    assert all(line.startswith("property float ") for line in lines[3:])
    names = [line.split()[2] for line in lines[3:]]
    return names, np.frombuffer(body, "<f4").reshape(int(lines[2].split()[2]), len(names))


def test_files_have_the_layout_of_3d_gaussian_splatting():
    one = Gaussians(
        means=np.array([[1.0, 2.0, 3.0]]),
        quats=np.array([[0.5, -0.5, 0.5, 0.5]]),
        scales=np.array([[0.1, 0.2, 0.3]]),
        opacities=np.array([0.25]),
        colors=np.array([[0.0, 1.0, 0.21404114]]),
        part_ids=np.array([0]),
    )
    names, table = read_table(encode_ply(one))
    assert names == REFERENCE_FIELDS
    dc = [-0.5 / 0.28209479177387814, 0.5 / 0.28209479177387814, 0.0]
    want = [1, 2, 3, 0, 0, 0, *dc, -np.log(3.0), *np.log([0.1, 0.2, 0.3]), 0.5, -0.5, 0.5, 0.5]
    np.testing.assert_allclose(table, [want], atol=1e-6)


def test_files_come_back(tmp_path: Path):
    gaussians = replace(make_gaussians(), part_ids=np.full(500, 2))
    (tmp_path / "one.ply").write_bytes(encode_ply(gaussians))
    back = read_ply(tmp_path / "one.ply", part_id=2)
    np.testing.assert_array_equal(back.means, gaussians.means)
    np.testing.assert_array_equal(back.quats, gaussians.quats)
    np.testing.assert_array_equal(back.opacities[:2], [0.0, 1.0])
    # Logarithms and logits are float32 in the file; that is all that is lost.
    np.testing.assert_allclose(back.scales, gaussians.scales, rtol=1e-6)
    np.testing.assert_allclose(back.opacities, gaussians.opacities, rtol=1e-6, atol=1e-7)
    np.testing.assert_allclose(back.colors, gaussians.colors, rtol=1e-6, atol=1e-7)
    np.testing.assert_array_equal(back.part_ids, gaussians.part_ids)
    # Written again, the encoded numbers differ by no more than what a float32 opacity next to 1 can hold.
    names, first = read_table(encode_ply(gaussians))
    again = read_table(encode_ply(back))[1]
    exact = [k for k, name in enumerate(names) if name[:3] not in ("f_d", "opa")]
    np.testing.assert_allclose(again[:, exact], first[:, exact], rtol=0, atol=1e-9 + 2.0**-24 * 2)
    assert encode_ply(gaussians) == (tmp_path / "one.ply").read_bytes()


def test_empty_sets_are_files_too():
    empty = select_gaussians(make_gaussians(), np.zeros(500, dtype=bool))
    assert len(decode_ply(encode_ply(empty)).means) == 0


def foreign_file(names: list[str], rows: list[list[float]], kind: str = "double", code: str = "d") -> bytes:
    head = ["ply", "format binary_little_endian 1.0", "comment by somebody", f"element vertex {len(rows)}"]
    head += [*(f"property {kind} {name}" for name in names), "element face 0"]
    head += ["property list uchar int vertex_indices", "end_header", ""]
    return "\n".join(head).encode() + b"".join(struct.pack(f"<{len(row)}{code}", *row) for row in rows)


def test_files_of_others_are_read():
    names = [*reversed(REFERENCE_FIELDS[6:]), "f_rest_0", "confidence", "z", "y", "x"]
    values = {
        "rot_0": 2.0,
        "opacity": 0.0,
        "scale_1": np.log(0.5),
        "f_rest_0": 0.0,
        "x": 7.0,
        "confidence": 3.0,
    }
    read = decode_ply(foreign_file(names, [[values.get(name, 0.0) for name in names]]), part_id=4)
    np.testing.assert_allclose(read.means, [[7.0, 0.0, 0.0]])
    np.testing.assert_allclose(read.quats, [[1.0, 0.0, 0.0, 0.0]])
    np.testing.assert_allclose(read.scales, [[1.0, 0.5, 1.0]])
    np.testing.assert_allclose(read.opacities, [0.5])
    np.testing.assert_allclose(read.colors, [[0.21404114] * 3], atol=1e-7)
    assert read.part_ids.tolist() == [4]


def test_files_that_are_not_so_are_refused_by_name(tmp_path: Path):
    good, path = encode_ply(make_gaussians(3)), tmp_path / "bad.ply"
    nothing = [0.0] * len(REFERENCE_FIELDS)
    cases = {
        "no header": b"plywood",
        "format is 'ascii 1.0'": good.replace(b"binary_little_endian", b"ascii"),
        "first element is not": good.replace(b"element vertex 3", b"element vertex"),
        "expected 'property TYPE NAME'": good.replace(b"float nx", b"half nx"),
        "bytes after the header, expected 204": good[:-1],
        "opacity are missing": good.replace(b"float opacity", b"float opaqueness"),
        "colours depend on the viewing direction": foreign_file(
            [*REFERENCE_FIELDS, "f_rest_0"], [[*nothing, 0.1]]
        ),
        "expected quaternions": foreign_file(REFERENCE_FIELDS, [nothing]),
        "NaN or infinite": foreign_file(REFERENCE_FIELDS, [[np.nan, *nothing[1:-1], 1.0]]),
    }
    for message, data in cases.items():
        path.write_bytes(data)
        with pytest.raises(SourceError, match=message) as caught:
            read_ply(path)
        assert str(path) in str(caught.value)
    with pytest.raises(SourceError, match="cannot be read"):
        read_ply(tmp_path / "absent.ply")


def test_what_has_no_encoding_is_not_written():
    gaussians = make_gaussians(4)
    with pytest.raises(ValueError, match="the least is 0"):
        encode_ply(replace(gaussians, scales=gaussians.scales * [1.0, 0.0, 1.0]))
    with pytest.raises(ValueError, match=r"span .*1\.5, allowed is 0 to 1"):
        encode_ply(replace(gaussians, opacities=np.full(4, 1.5)))


def covariances(gaussians: Gaussians) -> np.ndarray:
    axes = matrix_from_quat(gaussians.quats) * gaussians.scales[:, None, :]
    return axes @ axes.transpose(0, 2, 1)


def test_rigid_motion_turns_ellipsoids():
    gaussians = make_gaussians()
    moved, R = transform_gaussians(gaussians, TURN), TURN[:3, :3]
    np.testing.assert_allclose(moved.means, gaussians.means @ R.T + TURN[:3, 3], atol=1e-6)
    np.testing.assert_allclose(covariances(moved), R @ covariances(gaussians) @ R.T, atol=1e-6)
    assert moved.colors is not gaussians.colors
    np.testing.assert_array_equal(moved.colors, gaussians.colors)
    back = transform_gaussians(moved, inverse(TURN))
    np.testing.assert_allclose(back.means, gaussians.means, atol=1e-6)
    np.testing.assert_allclose(covariances(back), covariances(gaussians), atol=1e-6)
    grown = scale_gaussians(gaussians, 2.0)
    np.testing.assert_allclose(covariances(grown), 4.0 * covariances(gaussians), rtol=1e-5)
    np.testing.assert_array_equal(grown.means, 2.0 * gaussians.means)


@pytest.mark.parametrize("T", [np.diag([1.0, 1.0, -1.0, 1.0]), np.diag([2.0, 2.0, 2.0, 1.0])])
def test_only_rigid_motions_are_taken(T: np.ndarray):
    with pytest.raises(ValueError, match="expected a rigid motion"):
        transform_gaussians(make_gaussians(3), T)
    with pytest.raises(ValueError, match="above 0"):
        scale_gaussians(make_gaussians(3), 0.0)


def test_parts_are_taken_apart_and_put_together():
    gaussians = make_gaussians()
    pieces = [select_gaussians(gaussians, gaussians.part_ids == part) for part in range(4)]
    order = np.argsort(gaussians.part_ids, kind="stable")
    assert_equal(merge_gaussians(pieces), select_gaussians(gaussians, order))
    with pytest.raises(ValueError, match="no sets"):
        merge_gaussians([])


def test_rotations_compose_in_order():
    turn = np.eye(4)
    turn[:3, :3] = rotation_about(np.array([0.0, 0.0, 1.0]), np.array(0.5))
    twice = transform_gaussians(transform_gaussians(make_gaussians(), TURN), turn)
    at_once = transform_gaussians(make_gaussians(), turn @ TURN)
    np.testing.assert_allclose(covariances(twice), covariances(at_once), atol=1e-6)
