"""Hinges of fronts."""

import numpy as np
import pytest

from artigen.shapes.fittings.hardware import Panel, hinge, stay_above
from artigen.shapes.primitives import block


@pytest.mark.parametrize("height", [0.02, 0.03, 0.2])
def test_a_door_opens_to_where_its_handle_comes_to_the_floor(height: float):
    panel = Panel(x=0.0, thickness=0.03, y=(0.0, 0.6), z=(height, height + 0.5))
    along, out = 0.45, 0.04  # of the handle, from the axis
    bar = block((-out, 0.0), (0.1, 0.5), (height + along - 0.01, height + along), "handle")
    upper = stay_above(hinge(panel, "bottom", np.pi / 2), [panel.fill("front"), bar], 0.002).upper
    lowest = height + (along - 0.01) * np.cos(upper) - out * np.sin(upper)
    assert lowest >= 0.002
    assert upper == np.pi / 2 or lowest < 0.002 + 0.01 * 0.5
