"""A cupboard with a folding door: a leaf that hangs on a leaf."""

from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.furniture.layouts import Layout
from artigen.shapes.furniture.splits import Cell
from artigen.shapes.shape import Shape


def draw_folding() -> Shape:
    """A cupboard of 100 x 50 x 200 cm whose whole front folds to the left."""
    layout = Layout(node=Cell(fill="fold", edge="left"))
    return draw_shape("StorageFurniture", 0, Wish(width=1.0, depth=0.5, height=2.0, layout=layout))
