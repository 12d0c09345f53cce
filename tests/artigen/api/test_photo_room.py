"""A rendered kitchen's wall becomes a room with the same units in the same order."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from artigen.api.photo_room import furnish_photographed
from artigen.api.scene import PACKAGES
from artigen.camera import look_at
from artigen.errors import ArtigenError
from artigen.examples.reader_rooms import join_shapes
from artigen.reader.comparison import render_over
from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.furniture.layouts import Layout
from artigen.shapes.furniture.splits import Cell, Node, Split
from artigen.shapes.primitives import box, move
from artigen.shapes.render.shading import EVEN_LIGHT
from artigen.shapes.shape import Shape, ShapePart

pytestmark = pytest.mark.slow

DRAWERS = Split(along="rows", shares=(0.2, 0.26, 0.26), children=(Cell(fill="drawer"),) * 3)
DOORS = Split(
    along="columns",
    shares=(0.4, 0.4),
    children=(Cell(fill="door", edge="left"), Cell(fill="door", edge="right")),
)
UNITS: tuple[tuple[Node, float, dict[str, int]], ...] = (
    (DRAWERS, 0.6, {"slider": 3, "hinge": 0}),
    (DOORS, 0.8, {"slider": 0, "hinge": 2}),
)
"""Base cabinets from left to right: front, width (m), joints."""
APART = 0.4
"""Wall (m) that is left free between them."""


def draw_wall() -> Shape:
    """The cabinets before a wall, on a floor; left in a picture is +y."""
    left, cabinets = 0.0, []
    for node, width, _ in UNITS:
        layout = Layout(
            node=node, stands=("plinth",), stand_height=0.1, worktop=0.03, doors="flat", drawers="flat"
        )
        wish = Wish(width=width, depth=0.58, height=0.86, handles=("bar",), layout=layout)
        shape = draw_shape("StorageFurniture", 3, wish)
        low, high = shape.bounds()
        offset = (-float(high[0]), left - float(high[1]), -float(low[2]))
        parts = [
            replace(part, primitives=tuple(move(solid, offset) for solid in part.primitives))
            for part in shape.parts
        ]
        cabinets.append(replace(shape, parts=tuple(parts)))
        left -= float(high[1] - low[1]) + APART
    joined, _ = join_shapes(cabinets)
    around = [
        box((0.0, left - 4.0, 0.0), (0.1, 4.0, 3.0), "0.none"),
        box((-5.0, left - 4.0, -0.1), (0.1, 4.0, -0.001), "0.none"),
    ]
    return replace(joined, parts=(*joined.parts, ShapePart("room", "base", around, parent="world")))


def photograph(shape: Shape, path: Path) -> None:
    middle = np.array([-0.3, -(sum(width for _, width, _ in UNITS) + APART) / 2, 0.5])
    camera = look_at(middle + np.array([-2.2, 0.1, 0.5]), middle, fov=50.0, width=640, height=480)
    seen = render_over(camera, shape, EVEN_LIGHT)
    Image.fromarray((255 * np.clip(seen.rgb, 0.0, 1.0)).astype(np.uint8)).save(path)


def test_a_rendered_kitchen_becomes_its_room(tmp_path: Path):
    photograph(draw_wall(), tmp_path / "kitchen.png")
    made = furnish_photographed(tmp_path / "kitchen.png", tmp_path, pictures="none")
    assert made.notes == ()
    placed = json.loads((tmp_path / "scene.json").read_text())["placements"]
    stands = {Path(one["package"]).name: one for one in placed}
    assert sorted(stands) == [f"{number:02d}_base_cabinet" for number in range(len(UNITS))]
    for name, (_, width, moving) in zip(sorted(stands), UNITS, strict=True):
        folder = tmp_path / PACKAGES / name
        assert json.loads((folder / "validation.json").read_text())["passed"]
        labels = [line.split()[1] for line in (folder / "semantics.txt").read_text().splitlines()]
        assert {label: labels.count(label) for label in moving} == moving
        assert stands[name]["size"][1] == pytest.approx(width, rel=0.2)
    left, right = (np.array(stands[name]["position"]) for name in sorted(stands))
    widths = [width for _, width, _ in UNITS]
    assert np.linalg.norm(right - left) == pytest.approx(sum(widths) / 2 + APART, rel=0.2)


def test_a_picture_without_fronts_is_refused(tmp_path: Path):
    Image.new("RGB", (320, 240), (200, 190, 180)).save(tmp_path / "wall.png")
    with pytest.raises(ArtigenError, match="shows no front"):
        furnish_photographed(tmp_path / "wall.png", tmp_path)
