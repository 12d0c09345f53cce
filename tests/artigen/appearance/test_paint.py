"""Paint: both sides of voxels are read off samples, and a surface takes its paint from another one."""

from dataclasses import replace

import numpy as np
import pytest
from drawer_chest import COLOR, GLASS, INSIDE, make_chest

from artigen.appearance.paint import (
    PaintedSurface,
    VoxelPaint,
    gather_paint,
    lay_painted,
    paint_surface,
    repaint,
)
from artigen.errors import ArtigenError
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.shape import Shape
from artigen.types import Asset, SurfaceSamples
from artigen.voxels.frames import find_facings
from artigen.voxels.surface import SAMPLES


def paint(shape: Shape, resolution: int = 16) -> tuple[Asset, np.ndarray, VoxelPaint]:
    asset = shape_to_asset(shape, resolution)
    assert asset.voxels is not None
    facings = find_facings(asset.voxels.coords, asset.voxels.part_ids, resolution)
    surface = paint_surface(shape, asset, 1.0 / (SAMPLES * resolution))
    return asset, facings, gather_paint(surface, asset.voxels, facings)


def test_both_sides_of_a_board_have_their_own_colour():
    asset, facings, found = paint(make_chest(inside="inside"))
    assert asset.voxels is not None
    x, y, z = asset.voxels.coords.T
    lid = (z == 15) & (np.abs(y - 7.5) < 5) & (np.abs(x - 7.5) < 5)
    assert (facings[lid] == 5).all()
    assert (found.known[lid, 0] > 0).all()
    np.testing.assert_allclose(found.colors[lid, 0], np.tile(COLOR, (lid.sum(), 1)), atol=0.01)
    drawer = [part.name for part in asset.parts].index("drawer")
    bottom = (asset.voxels.part_ids == drawer) & (np.abs(x - 7.5) < 4) & (np.abs(y - 7.5) < 4) & (z < 4)
    for side in range(2):
        shown = bottom & (found.known[:, side] > 0)
        assert shown.any()
        np.testing.assert_allclose(
            found.colors[shown, side], np.tile(INSIDE.color, (shown.sum(), 1)), atol=0.01
        )


def test_a_side_without_surface_has_the_colour_of_the_other():
    asset, _, found = paint(make_chest(front="inside"))
    assert asset.voxels is not None
    front = (asset.voxels.coords[:, 0] == 0) & (asset.voxels.part_ids == 1)
    hidden = front & (found.known[:, 1] == 0) & (found.known[:, 0] > 0)
    assert hidden.any()
    np.testing.assert_array_equal(found.colors[hidden, 1], found.colors[hidden, 0])


def test_only_glass_is_clear():
    asset, _, found = paint(make_chest(front="glass"))
    assert asset.voxels is not None
    front = (asset.voxels.coords[:, 0] == 0) & (asset.voxels.part_ids == 1)
    inner = np.abs(asset.voxels.coords[:, 1:] - 7.5).max(axis=1) < 5
    np.testing.assert_allclose(found.clear[front & inner], 1.0 - GLASS.opacity, atol=1e-6)
    assert not found.clear[asset.voxels.part_ids == 0].any()
    packed = found.packed()
    np.testing.assert_allclose(packed[:, -1] / 255.0, found.clear, atol=0.5 / 255)
    np.testing.assert_allclose(packed[:, :3] / 255.0, found.colors[:, 0], atol=0.5 / 255)


def test_paint_needs_voxels():
    shape = make_chest()
    with pytest.raises(ValueError, match="no voxels"):
        lay_painted(shape, replace(shape_to_asset(shape, 16), voxels=None))


def pick(surface: PaintedSurface, rows: np.ndarray) -> PaintedSurface:
    """Some of the samples."""
    samples = {name: value[rows] for name, value in vars(surface.samples).items()}
    return PaintedSurface(samples=SurfaceSamples(**samples), clear=surface.clear[rows])


def blank(samples: SurfaceSamples, **changes: np.ndarray) -> SurfaceSamples:
    """The same samples without colours."""
    return replace(samples, colors=np.full_like(samples.colors, 255), **changes)


@pytest.fixture(scope="module")
def chest() -> tuple[Asset, PaintedSurface]:
    """A chest with a coloured inside and a pane."""
    shape = make_chest(front="glass", inside="inside")
    asset = shape_to_asset(shape, 16)
    return asset, paint_surface(shape, asset, 1 / 48)


def test_a_surface_in_the_paint_of_itself_is_as_it_was(chest: tuple[Asset, PaintedSurface]):
    asset, painted = chest
    again = repaint(blank(painted.samples), painted, [part.name for part in asset.parts])
    np.testing.assert_array_equal(again.samples.colors, painted.samples.colors)
    np.testing.assert_array_equal(again.samples.points, painted.samples.points)
    np.testing.assert_array_equal(again.clear, painted.clear)
    assert 0 < np.count_nonzero(again.clear) < len(again.clear)


def test_both_faces_of_a_board_keep_their_paint_where_a_surface_lies_a_little_off(
    chest: tuple[Asset, PaintedSurface],
):
    """Lifted off by more than the board is thick, outside and inside lie where the other one did."""
    asset, painted = chest
    board = np.abs(painted.samples.points[:, :2]).max(axis=1) < 0.3
    board &= (painted.samples.points[:, 2] > 0.4) & (painted.samples.part_ids == 0)
    board &= np.abs(painted.samples.normals[:, 2]) > 0.9
    lid = pick(painted, np.flatnonzero(board))
    assert len(np.unique(lid.samples.colors, axis=0)) == 2
    thick = np.ptp(lid.samples.points[:, 2])
    for lift in (-0.6 * thick, 0.6 * thick):
        moved = lid.samples.points + np.array([0.0, 0.0, lift], dtype=np.float32)
        again = repaint(blank(lid.samples, points=moved), painted, [part.name for part in asset.parts])
        np.testing.assert_array_equal(again.samples.colors, lid.samples.colors)


def test_a_part_takes_no_paint_from_another(chest: tuple[Asset, PaintedSurface]):
    asset, painted = chest
    samples = painted.samples
    of_parts = np.array([[200, 0, 0], [0, 0, 200]], dtype=np.uint8)[samples.part_ids]
    told = replace(painted, samples=replace(samples, colors=of_parts))
    swapped = blank(samples, points=samples.points[::-1].copy())  # anywhere, by chance in another part
    again = repaint(swapped, told, [part.name for part in asset.parts])
    np.testing.assert_array_equal(again.samples.colors, of_parts)


def test_a_part_without_painted_samples_is_named(chest: tuple[Asset, PaintedSurface]):
    asset, painted = chest
    body = pick(painted, np.flatnonzero(painted.samples.part_ids == 0))
    with pytest.raises(ArtigenError, match=r"drawer: none of \d+ painted samples of 2 parts"):
        repaint(painted.samples, body, [part.name for part in asset.parts])
