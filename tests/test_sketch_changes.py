"""Changed training objects are objects: what remains is as before, and nothing refers to what is gone."""

import numpy as np
import pytest
from sketch_changes import REMOVABLE, change_shape, remove_parts

from artigen.examples.sketch import make_table
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.sketch.words import CATEGORIES


@pytest.fixture(scope="module")
def cabinet() -> Shape:
    """An object with doors or drawers that carry handles."""
    return draw_shape("StorageFurniture", 3)


def test_parts_go_with_what_they_carry(cabinet: Shape):
    handle = next(part for part in cabinet.parts if part.label == "handle")
    assert handle.parent is not None
    left = remove_parts(cabinet, {handle.parent})
    assert {handle.name, handle.parent}.isdisjoint(part.name for part in left.parts)
    names = {part.name for part in left.parts}
    kept = [(part.name, part.primitives, part.joint) for part in cabinet.parts if part.name in names]
    assert kept == [(part.name, part.primitives, part.joint) for part in left.parts]


def test_something_still_moves(cabinet: Shape):
    assert remove_parts(cabinet, {part.name for part in cabinet.parts[1:]}) is cabinet


def test_nothing_refers_to_removed_parts():
    """A pedal drives the lid of a bin; a shape with a reference to a missing part cannot be built."""
    drawn = [draw_shape("TrashCan", seed) for seed in range(20)]
    bin_ = next(one for one in drawn if any(part.joint and part.joint.follows for part in one.parts))
    leader = next(part.joint.follows for part in bin_.parts if part.joint and part.joint.follows)
    left = remove_parts(bin_, {str(leader)})
    assert all(part.name != leader for part in left.parts)


@pytest.mark.parametrize("category", CATEGORIES)
def test_changed_shapes_have_tables_and_keep_what_is_not_removable(category: str):
    shape = draw_shape(category, 11)
    for seed in range(12):
        changed = change_shape(shape, np.random.default_rng(seed))
        gone = {part.label for part in shape.parts} - {part.label for part in changed.parts}
        assert gone <= REMOVABLE
        assert changed.category == shape.category
        assert make_table(changed) is not None
