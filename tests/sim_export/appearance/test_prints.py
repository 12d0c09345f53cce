"""Prints lie flat on faces of appliances, are read against them, and are nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.shapes.appliances.control_panel import DialDesign, build_display, make_button, make_dial
from artigen.shapes.draw import draw_shape
from artigen.shapes.fittings.hardware import rotate
from artigen.shapes.primitives import FRONT, UP, Vector, box
from artigen.shapes.shape import Shape, make_base
from artigen.shapes.surfaces.finishes import Finish
from sim_export.appearance.prints import DEEP, PROUD, STEPS, find_prints
from sim_export.geometry.rows import connect_rows
from sim_export.geometry.solids import make_manifold
from sim_export.reference import ReferenceConfig, build_reference

DIAL = DialDesign(kind="round", radius=0.02, length=0.02, finish="handle", mark="accent", upper=4.0)


def panel(brightness: float, *, out: Vector = FRONT, half: float = 0.1, upper: float | None = 4.0) -> Shape:
    """A board with a dial in its middle."""
    face = np.array(out, dtype=float) * 0.05
    low, high = np.full(3, -half), np.full(3, half)
    axis = int(np.abs(face).argmax())
    low[axis], high[axis] = -0.05, 0.05
    grey = (brightness,) * 3
    plain = Finish(kind="lacquer", color=grey, accent=grey)
    dial = make_dial(DIAL, tuple(face), name="dial", out=out)
    dial = type(dial)("dial", "knob", dial.primitives, rotate(out, tuple(face), upper))
    body = make_base([box(tuple(low), tuple(high), "body")])
    finishes = tuple((role, plain) for role in ("accent", "body", "handle", "panel"))
    return Shape(category="Oven", seed=0, style="plain", parts=(body, dial), finishes=finishes)


@pytest.mark.parametrize(("brightness", "finish"), [(0.9, "print_dark"), (0.1, "print_light")])
@pytest.mark.parametrize("out", [FRONT, UP])
def test_a_dial_has_a_scale_on_the_face_behind_it(out, brightness, finish):
    ((carrier, by_finish),) = find_prints(panel(brightness, out=out)).items()
    ((role, mesh),) = by_finish.items()
    assert (carrier, role) == ("body", finish)
    heights = mesh.vertices @ np.array(out)
    assert set(np.round(heights, 7)) == {round(0.05 + PROUD, 7), round(0.05 - DEEP, 7)}
    across = mesh.vertices - np.outer(heights, out)
    reach = np.linalg.norm(across, axis=1)
    assert reach.min() > 0.02
    assert reach.max() < 1.25 * 0.02 + 0.0005
    assert make_manifold(mesh.vertices, mesh.faces).volume() > 0
    assert int(connect_rows(mesh.faces[:, [0, 1, 1, 2]].reshape(-1, 2).T, len(mesh.vertices)).max()) == STEPS


@pytest.mark.parametrize(
    ("size", "rows"), [((0.0135, 0.08, 0.136), 6), ((0.0135, 0.08, 0.05), 0), ((0.0135, 0.3, 0.136), 0)]
)
def test_a_touch_pad_has_three_legends_in_a_row_within_its_face(size, rows):
    grey = Finish(kind="glass", color=(0.02,) * 3, accent=(0.02,) * 3)
    pad = box((0.0, 0.0, 0.0), size, "panel")
    shape = Shape(
        category="Microwave", seed=0, style="", parts=(make_base([pad]),), finishes=(("panel", grey),)
    )
    prints = {
        role: mesh
        for found in find_prints(shape).values()
        for role, mesh in found.items()
        if role != "digits"
    }
    assert sum(len(mesh.vertices) for mesh in prints.values()) == 8 * 2 * 3 * rows
    for mesh in prints.values():
        inside = (mesh.vertices[:, 1:] > 0.002) & (mesh.vertices[:, 1:] < np.array(size[1:]) - 0.002)
        assert inside.all()
        assert mesh.vertices[:, 0].min() == pytest.approx(-PROUD)


def test_a_dial_without_limits_has_twelve_marks_and_marks_beside_the_face_are_left_out():
    whole = find_prints(panel(0.9, upper=None))["body"]["print_dark"]
    assert len(whole.vertices) == 8 * 12
    assert find_prints(panel(0.9, half=0.015)) == {}


@pytest.mark.parametrize(
    ("width", "brightness", "finish"),
    [(0.03, 0.9, "print_dark"), (0.03, 0.1, "print_light"), (0.07, 0.9, None)],
)
def test_a_key_of_the_width_of_a_finger_has_a_legend_in_its_middle(width, brightness, finish):
    key = make_button((-0.05, 0.02, 0.6), (width, 0.02, 0.006), name="key", finish="body")
    base = panel(brightness)
    found = find_prints(replace(base, parts=(base.parts[0], key))).get("key", {})
    assert list(found) == ([] if finish is None else [finish])
    if finish is not None:
        low, high = found[finish].vertices.min(axis=0), found[finish].vertices.max(axis=0)
        front = key.bounds()[0, 0]
        assert (low[0], high[0]) == pytest.approx((front - PROUD, front + DEEP))
        assert ((low + high) / 2)[1:] == pytest.approx((0.02, 0.6))


def test_a_display_shows_the_time_in_its_middle():
    window = build_display(0.0, (-0.06, 0.06), (0.5, 0.532))
    for brightness, finish in ((0.05, "digits"), (0.8, "print_dark")):
        grey = (brightness,) * 3
        plain = Finish(kind="glass", color=grey, accent=grey)
        body = make_base([window])
        shape = Shape(category="Oven", seed=0, style="a", parts=(body,), finishes=(("panel", plain),))
        mesh = find_prints(shape)["body"][finish]
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        np.testing.assert_allclose((low + high)[1:] / 2, [0.0, 0.516], atol=0.004)
        assert high[2] - low[2] < 0.032
        assert low[0] == pytest.approx(-0.003 - PROUD)


def test_only_appliances_in_full_detail_have_prints():
    def printed(category: str, seed: int, **cfg: str) -> bool:
        package = build_reference(draw_shape(category, seed), ReferenceConfig(**cfg))
        return any(
            "print" in v.finish or v.finish == "digits" for link in package.links for v in link.visuals
        )

    assert printed("Dishwasher", 1)
    assert not printed("Dishwasher", 1, detail="low")
    assert not printed("Dresser", 0)
