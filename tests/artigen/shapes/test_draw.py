"""Drawing procedural objects: a pure function of category, seed and wish; every category obeys the rules."""

import numpy as np
import pytest

from artigen.kind import kinds, paper_kinds
from artigen.shapes.choices import choose, choose_style
from artigen.shapes.draw import ShapeError, Wish, draw_shape
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape
from artigen.types import PART_LABELS

NAMES = sorted(kinds())


def geometry(shape: Shape) -> np.ndarray:
    return np.concatenate([place_vertices(p) for part in shape.parts for p in part.primitives])


def test_all_categories_of_the_paper_and_two_more_are_there():
    assert set(paper_kinds()) | {"Cart"} <= set(NAMES)
    assert set(NAMES) - set(paper_kinds()) - {"Cart"}


@pytest.mark.parametrize("name", NAMES)
def test_the_same_seed_draws_the_same_object_and_another_seed_another(name: str):
    first, again, other = draw_shape(name, 5), draw_shape(name, 5), draw_shape(name, 6)
    assert np.array_equal(geometry(first), geometry(again))
    assert first.condition == again.condition
    assert first.finishes == again.finishes
    assert geometry(first).shape != geometry(other).shape or not np.allclose(geometry(first), geometry(other))


@pytest.mark.parametrize("name", NAMES)
def test_objects_stand_on_the_floor_and_state_what_they_are(name: str):
    for seed in range(3):
        shape = draw_shape(name, seed)
        assert shape.name == f"{name}_{seed}"
        assert shape.bounds()[0, 2] == pytest.approx(0.0, abs=1e-4)
        counts = dict(shape.condition.counts)
        assert sum(counts.values()) == len(shape.parts)
        assert list(counts) == [label for label in PART_LABELS if label in counts]
        assert shape.condition.height == pytest.approx(np.ptp(shape.bounds()[:, 2]))


def test_wishes_for_size_and_counts_are_met():
    plain = draw_shape("StorageFurniture", 3)
    width = plain.condition.width + 0.05
    wished = draw_shape("StorageFurniture", 3, Wish(width=width))
    assert wished.condition.width == pytest.approx(width, abs=0.02)
    counted = draw_shape("StorageFurniture", 3, Wish(counts=(("drawer", 2), ("wheel", 0))))
    assert dict(counted.condition.counts)["drawer"] == 2
    assert "wheel" not in dict(counted.condition.counts)


def test_what_cannot_be_drawn_is_said(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("artigen.shapes.draw.MAX_DRAWS", 20)
    with pytest.raises(ShapeError, match=r"Spaceship.*expected one of.*Table"):
        draw_shape("Spaceship", 0)
    with pytest.raises(ShapeError, match=r"no draw of 20 has 77 wheel; most frequent were"):
        draw_shape("Safe", 0, Wish(counts=(("wheel", 77),)))


def test_counts_out_of_all_proportion_are_given_up_early():
    with pytest.raises(ShapeError, match=r"no draw of 100 has 99 handle"):
        draw_shape("Microwave", 0, Wish(counts=(("handle", 99),)))
    with pytest.raises(ShapeError, match=r"no draw of 100 has 2 drawer"):
        draw_shape("Box", 0, Wish(counts=(("drawer", 2),)))  # none has one


@pytest.mark.slow
def test_lengths_that_hold_no_layout_are_drawn_again_unless_they_are_wished_for():
    drawn = draw_shape("StorageFurniture", 10106)  # the first lengths of this seed hold none
    assert len(drawn.parts) > 1
    with pytest.raises(ShapeError, match="request a smaller one"):
        draw_shape("StorageFurniture", 10106, Wish(width=6.0, depth=0.6, height=6.0))


def test_a_wished_value_takes_its_number_from_the_stream_too():
    free, wished = np.random.default_rng(0), np.random.default_rng(0)
    assert 1.0 <= choose(free, 1.0, 2.0) <= 2.0
    assert choose(wished, 1.0, 2.0, 1.7) == 1.7
    assert free.random() == wished.random()


def test_a_style_is_the_one_wished_for_and_takes_its_number_from_the_stream_too():
    free, wished = np.random.default_rng(0), np.random.default_rng(0)
    styles = {"plain": 3.0, "fancy": 1.0}
    assert choose_style(free, styles) in styles
    assert choose_style(wished, styles, "fancy") == "fancy"
    assert free.random() == wished.random()
