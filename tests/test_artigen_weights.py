"""The weights that come with artigen: whole, small enough, and able to draw what is asked for."""

from artigen.ask import Request, read_request
from artigen.generate import generate_structure, load_structure_model
from artigen.metrics.delivery import has_counts, size_error
from artigen.shapes.draw import Wish
from artigen.weights import SHIPPED


def test_they_are_small_enough_to_ship():
    assert sum(path.stat().st_size for path in SHIPPED.iterdir()) < 40e6


def test_a_microwave_has_the_parts_that_are_asked_for():
    model = load_structure_model(SHIPPED)
    request = Request(category="Microwave", wish=Wish(counts=(("door", 1), ("handle", 1), ("knob", 2))))
    asked = read_request(request, 3, 0).condition
    asset = generate_structure(model, asked, 3)
    assert has_counts(asset, asked.counts)
    assert asked.size is not None
    assert size_error(asset, asked.size) < 0.1
    moving = {part.label: part.joint.type for part in asset.parts}
    assert moving["door"] == "revolute"
