"""A written sentence says what is read out of it."""

import pytest

from artigen.conditioning.prompt import write_text
from artigen.conditioning.read import read_sentence
from artigen.kind import kinds
from artigen.shapes.draw import draw_shape


@pytest.mark.parametrize("category", kinds())
def test_a_written_sentence_says_what_is_read_out_of_it(category: str):
    for seed in range(4):
        counts = dict(draw_shape(category, seed).condition.counts)
        said = read_sentence(write_text(category, counts))
        named = {label: count for label, count in counts.items() if count and label != "base"}
        assert (said.kind, dict(said.counts), said.ignored) == (category, named, ())
