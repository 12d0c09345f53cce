"""What holds thousands of numbers prints on a screen."""

import artigen
from artigen.shapes.draw import draw_shape
from sim_export.report import CheckResult, Report


def test_a_repr_fits_a_screen():
    oven = artigen.sample("Oven", seed=0)
    shape = draw_shape("Oven", 0)
    check = CheckResult(id="V001", level="L0", title="one tree", verdict="pass")
    report = Report(package="oven", checks=(check,) * 40)
    for value in (oven, oven.package, *oven.package.links, shape, *shape.parts, report):
        told = repr(value)
        assert len(told) < 1000, told
        assert len(told.splitlines()) <= 10, told
    assert "name='Oven_0'" in repr(oven.package)
    assert repr(report).startswith("PASS oven: 40 passed")
