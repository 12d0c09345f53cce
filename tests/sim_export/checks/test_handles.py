"""How finely V204 looks at a handle."""

from pathlib import Path

import numpy as np
import pytest
from cabinet_files import box_visual, join, joint, link, urdf

from sim_export.checks.config import CheckConfig
from sim_export.checks.handles import check_handles
from sim_export.checks.subject import Subject
from sim_export.geometry.hulls import box_hull


def write_front(folder: Path, *boxes: tuple[tuple[float, ...], tuple[float, ...]]) -> Subject:
    """A drawer's front with its face at x = 0, and a handle of boxes, given by two corners each (m)."""
    bars = [box_hull(np.array(low), np.array(high)) for low, high in boxes]
    vertices = [join(corner) for hull in bars for corner in hull.vertices]
    faces = [join(face + 1 + 8 * index) for index, hull in enumerate(bars) for face in hull.faces]
    text = "\n".join([*(f"v {row}" for row in vertices), *(f"f {row}" for row in faces)]) + "\n"
    front = box_visual((0.02, 0.5, 0.5), (0.01, 0.0, 0.0), "front")
    handle = '<visual name="handle"><geometry><mesh filename="handle.obj"/></geometry></visual>'
    drawer = link("drawer", front, front.replace("visual", "collision"), handle)
    slide = joint("prismatic", "body", "drawer", axis=(-1, 0, 0), limits=(0.0, 0.3))
    (folder / "handle.obj").write_text(text)
    (folder / "mobility.urdf").write_text(urdf(link("body"), drawer, slide))
    (folder / "semantics.txt").write_text("body static body\ndrawer slider drawer\n")
    return Subject(folder)


@pytest.mark.parametrize(("thickness", "passed"), [(1.01, True), (0.99, False)])
def test_a_bar_is_met_if_it_is_half_as_thick_as_48_lines_are_apart(tmp_path, thickness, passed):
    """The lines begin half of that inside the edges of the handle, a square frame of 10 cm."""
    half, bar = 0.05, thickness * 0.1 / 96
    inner = half - bar
    frame = [
        ((-0.05 - bar, *low), (-0.05, *high))
        for low, high in (
            ((-half, -half), (half, -inner)),
            ((-half, inner), (half, half)),
            ((-half, -inner), (-inner, inner)),
            ((inner, -inner), (half, inner)),
        )
    ]
    assert check_handles(write_front(tmp_path, *frame), CheckConfig()).passed is passed


@pytest.mark.parametrize(("share", "passed"), [(0.3, True), (0.2, False)])
def test_fingers_need_a_quarter_of_a_handle_free(tmp_path, share, passed):
    """Half of its middle half: behind the rest of a bar of 20 cm are posts. It is too high to be pinched."""
    half = 0.1 * share
    bar = ((-0.06, -0.1, -0.05), (-0.04, 0.1, 0.05))
    posts = [((-0.04, low, -0.05), (0.0, high, 0.05)) for low, high in ((-0.1, -half), (half, 0.1))]
    assert check_handles(write_front(tmp_path, bar, *posts), CheckConfig()).passed is passed
