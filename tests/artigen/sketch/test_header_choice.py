"""The header of a picture is chosen by two estimates: the encoder's, and how often the network says it."""

import numpy as np

from artigen.sketch.model import choose_header

ONE, OTHER = (0, (1, 0)), (0, (2, 0))


def test_the_encoder_decides_among_headers_that_are_said_equally_often():
    assert choose_header([ONE, OTHER], [-3.0, -2.0]) == 1


def test_the_majority_decides_where_the_encoder_has_no_opinion():
    assert choose_header([ONE, OTHER, OTHER], [-2.0, -2.0, -2.0]) == 1


def test_both_weigh_alike():
    """Three times as often makes up for a third of the probability, and not for less."""
    said = [ONE, OTHER, OTHER, OTHER]
    assert choose_header(said, [-np.log(2.9), *[-2 * np.log(2.9)] * 3]) == 1
    assert choose_header(said, [-np.log(3.1), *[-2 * np.log(3.1)] * 3]) == 0
