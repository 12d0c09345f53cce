"""Neighbours agree: the sure ones stay, the unsure ones follow, and nothing else has a say."""

import numpy as np
import pytest

from artigen.agreement import find_edges, spread_sureness

EDGE = 8


def make_line(count: int) -> np.ndarray:
    return np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)


def test_edges_join_what_touches_and_is_alike():
    coords = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [3, 0, 0], [7, 7, 7], [7, 7, 6]])
    alike = np.zeros(6, dtype=int)
    assert find_edges(coords, alike, alike, EDGE).tolist() == [[0, 1], [1, 2], [5, 4]]
    assert find_edges(coords, np.array([0, 0, 1, 0, 0, 0]), alike, EDGE).tolist() == [[0, 1], [5, 4]]
    assert find_edges(coords, alike, np.array([0, 1, 1, 0, 0, 5]), EDGE).tolist() == [[1, 2]]


def test_the_unsure_follow_the_sure_around_them():
    logits = np.zeros((9, 3))
    logits[0], logits[8] = [8.0, 0.0, 0.0], [0.0, 0.0, 8.0]
    logits[1:8, 1] = 0.05  # what each would choose alone
    found = spread_sureness(logits, make_line(9)).argmax(axis=1)
    assert found[:4].tolist() == [0] * 4
    assert found[5:].tolist() == [2] * 4


def test_one_who_is_sure_is_not_outvoted():
    logits = np.tile([12.0, 0.0], (11, 1))
    logits[5] = [0.0, 12.0]
    agreed = spread_sureness(logits, make_line(11)).argmax(axis=1)
    assert agreed.tolist() == [0] * 5 + [1] + [0] * 5


def test_alone_each_keeps_what_it_says():
    logits = np.random.default_rng(0).normal(size=(7, 3))
    found = spread_sureness(logits, np.zeros((0, 2), dtype=int))
    np.testing.assert_allclose(found, logits - logits.mean(axis=1, keepdims=True), atol=1e-9)
    same = np.tile(logits[:1], (7, 1))
    np.testing.assert_allclose(
        spread_sureness(same, make_line(7)), same - same.mean(axis=1, keepdims=True), atol=1e-9
    )


@pytest.mark.parametrize("classes", [2, 3])
def test_neither_the_order_of_voxels_nor_that_of_classes_matters(classes: int):
    rng = np.random.default_rng(1)
    logits, edges = rng.normal(size=(20, classes)), make_line(20)
    found = spread_sureness(logits, edges)
    order, turn = rng.permutation(20), rng.permutation(classes)
    place = np.argsort(order)
    np.testing.assert_allclose(spread_sureness(logits[order], place[edges]), found[order], atol=1e-9)
    np.testing.assert_allclose(spread_sureness(logits[:, turn], edges[:, ::-1]), found[:, turn], atol=1e-9)
