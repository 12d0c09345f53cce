"""Budgets count seconds of a core, and remember that they ended something."""

import time

from artigen.runtime.budget import Budget, core_seconds


def test_a_share_ends_before_the_whole_and_tells_it():
    now = [0.0]
    whole = Budget(10.0, lambda: now[0])
    half = whole.share(0.5)
    now[0] = 4.9
    assert not half.is_over()
    now[0] = 5.0
    assert half.is_over()
    assert (whole.left, whole.is_over()) == (5.0, False)
    assert half.cut_short
    assert whole.cut_short
    now[0] = 11.0
    assert (whole.left, whole.share(0.5, 3.0).left) == (0.0, 3.0)


def test_the_default_never_ends_and_waiting_takes_none_of_it():
    budget, before = Budget(), core_seconds()
    time.sleep(0.2)
    assert core_seconds() - before < 0.1
    assert not budget.share(0.1).is_over()
    assert not budget.cut_short
