"""Phrases tell the parts of an object apart as people would, and never mean two of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sample_packages import SAMPLE_PARTS, build_package, double_door_parts

from sim_export.physics.phrases import name_parts, tell_apart

GAP = 0.004


def grid(rows: list[int]) -> np.ndarray:
    """Boxes of fronts: from the top, as many side by side as stated, from the left."""
    boxes = []
    for row, count in enumerate(rows):
        for column in range(count):
            y = 1.0 - (column + np.array([1.0, 0.0])) / count + np.array([GAP, -GAP])
            z = len(rows) - row + np.array([-1.0 + GAP, -GAP])
            boxes.append([[-0.02, y[0], z[0]], [0.0, y[1], z[1]]])
    return np.array(boxes)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([1], ["drawer"]),
        ([1, 1], ["top drawer", "bottom drawer"]),
        ([3], ["left drawer", "middle drawer", "right drawer"]),
        ([2, 1], ["top left drawer", "top right drawer", "bottom drawer"]),
        (
            [1, 1, 1, 1],
            ["top drawer", "second drawer from the top", "third drawer from the top", "bottom drawer"],
        ),
        (
            [1, 4],
            [
                "top drawer", "bottom left drawer", "second drawer from the left at the bottom",
                "third drawer from the left at the bottom", "bottom right drawer",
            ],
        ),
    ],
)  # fmt: skip
def test_fronts_in_rows_and_columns_are_called_as_one_would(rows: list[int], said: list[str]):
    assert tell_apart("drawer", grid(rows)) == said


def test_a_tall_door_beside_two_low_ones_is_left_of_them():
    tall, upper, lower = (
        [[0, 0.5, 0], [0.02, 1, 2]],
        [[0, 0, 1], [0.02, 0.49, 2]],
        [[0, 0, 0], [0.02, 0.49, 0.99]],
    )
    assert tell_apart("door", np.array([tall, upper, lower], float)) == [
        "left door", "top right door", "bottom right door",
    ]  # fmt: skip


spans = st.tuples(st.floats(0, 5), st.floats(0.01, 2)).map(lambda pair: (pair[0], pair[0] + pair[1]))


@given(st.lists(st.tuples(spans, spans, spans), min_size=1, max_size=9))
def test_no_two_parts_share_a_phrase_wherever_they_are(places: list):
    phrases = tell_apart("door", np.array(places).transpose(0, 2, 1))
    assert len(set(phrases)) == len(phrases)


def test_phrases_follow_the_parts_when_the_object_is_mirrored():
    boxes = grid([3, 2])
    mirrored = boxes * [1.0, -1.0, 1.0]
    mirrored[:, :, 1] = np.sort(mirrored[:, :, 1], axis=1)
    swapped = [phrase.replace("left", "L").replace("right", "left").replace("L", "right")
               for phrase in tell_apart("door", boxes)]  # fmt: skip
    assert tell_apart("door", mirrored) == swapped


def test_the_parts_of_a_package_are_named_with_their_object():
    named = {each.link: each.phrases for each in name_parts(build_package(double_door_parts()), "cabinet")}
    assert {phrases[0] for phrases in named.values()} >= {"left door", "right door"}
    for phrases in named.values():
        assert phrases[1] == f"{phrases[0]} of the cabinet"
    plain = {each.phrases[0] for each in name_parts(build_package(SAMPLE_PARTS))}
    assert {"door", "drawer"} <= plain
