"""Laws of `artigen shape`: exact objects are made once; finer voxels keep parts as thick as drawn."""

from pathlib import Path

import numpy as np
import pytest

from artigen.api import grids
from artigen.api.batch import Finished
from artigen.api.grids import GRIDS
from artigen.api.sample import ShapeJob, export_and_validate, make_package
from artigen.runtime.workers import Worker
from artigen.shapes.draw import draw_shape


def test_exact_objects_are_made_once(monkeypatch):
    failed = Finished(key="Cart_0", settings="", passed=False)
    monkeypatch.setattr(grids, "make_and_validate", lambda *_, **__: failed)
    assert export_and_validate(Worker(), ShapeJob(category="Cart", seed=0, out=Path("out"))) is failed


@pytest.mark.slow
def test_a_thin_part_is_as_thick_as_drawn_within_half_a_cell():
    """The screen of a laptop is thinner than two cells of the coarsest grid."""
    drawn = draw_shape("Laptop", 0)
    low, high = next(part for part in drawn.parts if part.name == "screen").bounds()
    edge = max(np.ptp([part.bounds() for part in drawn.parts], axis=(0, 1)))
    found = []
    for grid in (GRIDS[0], GRIDS[-1]):
        package = make_package(drawn, "voxels", grid=grid)
        assert dict(package.provenance)["grid"] == str(grid)
        lid = next(link for link in package.links if "screen" in link.parts)
        points = np.concatenate([visual.mesh.vertices for visual in lid.visuals])
        found.append(np.ptp(points, axis=0))
        np.testing.assert_allclose(found[-1], high - low, atol=0.5 * edge / grid)
    assert np.abs(found[1] - found[0]).max() > 1e-5  # the grid matters
