"""The weights that come with artigen: whole, small enough, and able to draw what is asked for."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.appearance.draw import draw_splats, load_appearance_model
from artigen.conditioning.delivery import has_counts, size_error
from artigen.kind import kinds
from artigen.latent.draw import generate_structure, load_structure_model
from artigen.models.conditions import StructureCondition
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import Wish, draw_shape
from artigen.sketch.model import draw_object, load_sketch_network
from artigen.sketch.request import SketchRequest, list_learned
from artigen.voxels.fields import tabulate_parts
from artigen.voxels.frames import facing_frames
from artigen.voxels.layout import Canvas, lay_out
from artigen.voxels.surface import measure_places
from artigen.weights import SHIPPED
from sim_export.geometry.surface import sample_surface


def test_they_are_small_enough_to_ship():
    sizes = {path.name: path.stat().st_size for path in SHIPPED.iterdir()}
    appearance = sum(size for name, size in sizes.items() if name.startswith("appearance-"))
    assert 0 < appearance < 9e6
    assert sum(sizes.values()) - appearance < 55e6


def test_every_category_of_the_grammar_is_drawn_by_the_sketch_network():
    network = load_sketch_network(SHIPPED)
    assert set(list_learned(SHIPPED)) == set(network.categories) == set(kinds())
    drawn = draw_object(network, SketchRequest(category="BreadBox"), 0)
    assert drawn.shape.category == "BreadBox"
    assert not drawn.faults


@pytest.mark.slow
def test_a_microwave_has_the_parts_that_are_asked_for():
    model = load_structure_model(SHIPPED)
    shape = draw_shape("Microwave", 3, Wish(counts=(("door", 1), ("handle", 1), ("knob", 2))))
    asset = generate_structure(model, StructureCondition(), 3, boxes=shape)
    said = shape.condition
    assert has_counts(asset, said.counts)
    assert size_error(asset, (said.depth, said.width, said.height)) < 0.01
    exact = shape_to_asset(shape, 64)
    assert exact.voxels is not None
    assert asset.voxels is not None
    assert len(np.unique(asset.voxels.part_ids)) == len(exact.parts)
    drawn, true = asset.voxels.occupied(), exact.voxels.occupied()
    assert (drawn & true).sum() > 0.3 * (drawn | true).sum()
    moving = {part.label: part.joint.type for part in asset.parts}
    assert moving["door"] == "revolute"


@pytest.fixture(scope="module")
def table() -> Canvas:
    asset = shape_to_asset(draw_shape("Table", 3), 64)
    assert asset.voxels is not None
    surface = sample_surface(asset)
    voxels, facings = lay_out(surface, asset.voxels)
    return Canvas(
        coords=voxels.coords,
        part_ids=voxels.part_ids,
        facings=facings,
        table=tabulate_parts(asset),
        places=measure_places(surface, voxels, facings),
    )


def paint_all(count: int, color: tuple[float, float, float]) -> np.ndarray:
    """One colour on both sides of every voxel."""
    return np.tile([*color, *color, 0.0], (count, 1)).astype(np.float32)


def test_told_colours_are_what_is_drawn(table: Canvas):
    model, asked = load_appearance_model(SHIPPED), StructureCondition(category="Table")
    for color in ((0.6, 0.2, 0.2), (0.2, 0.3, 0.6)):
        paint = paint_all(len(table.coords), color)
        splats = draw_splats(model, table, asked, 0, paint=paint)
        drawn = (splats.colors * splats.opacities[:, None]).sum(dim=0) / splats.opacities.sum()
        np.testing.assert_allclose(drawn.numpy(), color, atol=0.1)


def test_paint_and_places_must_be_told(table: Canvas):
    model, asked = load_appearance_model(SHIPPED), StructureCondition(category="Table")
    paint = paint_all(len(table.coords), (0.5, 0.5, 0.5))
    with pytest.raises(ValueError, match="voxels without paint"):
        draw_splats(model, table, asked, 0)
    with pytest.raises(ValueError, match="voxels without places"):
        draw_splats(model, replace(table, places=None), asked, 0, paint=paint)


def test_gaussians_lie_where_the_surface_is_told_to(table: Canvas):
    """Surface that is lifted takes its Gaussians along, a little further the higher it is already."""
    model, lift = load_appearance_model(SHIPPED), 0.2
    assert table.places is not None
    lifted = replace(table, places=replace(table.places, heights=table.places.heights + lift))
    paint, asked = paint_all(len(table.coords), (0.5, 0.5, 0.5)), StructureCondition(category="Table")
    at = [draw_splats(model, canvas, asked, 0, paint=paint).means.numpy() for canvas in (table, lifted)]
    moved = 64 * (at[1] - at[0]).reshape(len(table.coords), -1, 3)
    outwards = np.einsum("nki,ni->n", moved, facing_frames()[table.facings][:, :, 0]) / moved.shape[1]
    assert 0.75 * lift < outwards.mean() < 2.0 * lift
