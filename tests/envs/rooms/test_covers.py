"""Patterns are in metres and repeat without a seam; fixtures carry them on over their neighbours."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bare_room import ROOM

from envs.rooms.covers import fixture_mesh, write_cover, write_cover_obj
from envs.rooms.patterns import BOARDS, PERIODS, PIXELS, TILE_EDGES, paint_pattern
from envs.rooms.room import Fixture
from sim_export.files.obj import parse_obj, read_image
from sim_export.geometry.triangles import triangle_areas

WHITE = (1.0, 1.0, 1.0)
SLAB = Fixture(
    name="slab", low=(0.2, 0.3, 0.9), high=(1.7, 0.9, 0.93), color=(0.8, 0.7, 0.6), pattern="tiles"
)


@pytest.mark.parametrize("pattern", [*BOARDS, *TILE_EDGES])
def test_patterns_have_their_joints_at_multiples_of_their_pitch(pattern):
    image = paint_pattern(pattern, WHITE).astype(float).mean(axis=(1, 2))[::-1]
    pitch = {**BOARDS, **TILE_EDGES}[pattern][1]
    dark = np.flatnonzero(image < 0.95 * np.median(image)) / PIXELS
    rows = round(PERIODS[pattern][1] / pitch)
    assert {round(place / pitch) % rows for place in dark} == set(range(rows))
    assert np.abs(dark / pitch - np.round(dark / pitch)).max() * pitch < 1.5 / PIXELS


@pytest.mark.parametrize("pattern", ["planks", "wood", "tiles", "small_tiles", "stone", "cloth"])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_pattern_repeats_without_a_seam(pattern, axis):
    """From its last row to its first it changes as it does inside."""
    image = np.moveaxis(paint_pattern(pattern, WHITE).astype(float), axis, 0)
    steps = np.abs(np.diff(image, axis=0)).mean(axis=(1, 2))
    seam = np.abs(image[0] - image[-1]).mean()
    pitch = {**BOARDS, **TILE_EDGES}.get(pattern, (1.0, 1.0))[1 - axis]
    places = (np.arange(len(steps)) + 1) / PIXELS / pitch
    joints = np.abs(places - np.round(places)) * pitch < 1.5 / PIXELS
    alike = steps[joints] if joints.any() and pattern not in ("stone", "cloth") else steps
    assert seam <= alike.max() + 1e-9


@pytest.mark.parametrize("shape", ["box", "cylinder"])
def test_texture_coordinates_are_metres_in_periods(shape):
    """Faces along the axes cover as many periods of the image as square metres of the room."""
    mesh = fixture_mesh(replace(SLAB, high=(1.7, 1.8, 0.93), shape=shape))
    assert mesh.uv is not None
    corners = mesh.vertices[mesh.faces]
    level = np.ptp(corners[..., 2], axis=1) < 1e-9
    laid = triangle_areas(np.pad(mesh.uv[level], ((0, 0), (0, 0), (0, 1))))
    period = float(np.prod(PERIODS["tiles"]))
    np.testing.assert_allclose(laid * period, triangle_areas(corners[level]), rtol=1e-9)


def test_neighbours_continue_the_pattern():
    beside = replace(SLAB, low=(1.7, 0.3, 0.9), high=(2.4, 0.9, 0.93))
    found = []
    for fixture in (SLAB, beside):
        mesh = fixture_mesh(fixture)
        assert mesh.uv is not None
        corners = mesh.vertices[mesh.faces]
        on_top = (corners[..., 2] > 0.92).all(axis=1)[:, None] & np.isclose(corners[..., 0], 1.7)
        found.append({tuple(row) for row in np.round(mesh.uv[on_top], 9).tolist()})
    assert found[0] == found[1]
    assert len(found[0]) == 2


def test_files_hold_the_mesh_and_the_image(tmp_path: Path):
    mesh, path = fixture_mesh(SLAB), write_cover_obj(SLAB, tmp_path)
    data = parse_obj(path)
    np.testing.assert_allclose(data.vertices[:, 2].max(), 0.93, atol=1e-6)
    np.testing.assert_array_equal(read_image(write_cover(SLAB, tmp_path))[..., :3], mesh.texture)
    assert len({write_cover(each, tmp_path) for each in ROOM.fixtures if each.pattern != "plain"}) <= 1
