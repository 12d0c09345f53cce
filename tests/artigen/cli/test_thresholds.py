"""How often something is drawn for a data set."""

from pathlib import Path

import pytest

from artigen.api.dataset import _Chosen, _give_up, _Pool
from artigen.datasets.recipe import Entry, RecipeError

OUT = Path("out")


def test_an_entry_is_given_up_after_ten_more_than_twice_its_objects():
    entry = Entry(name="safes", category="Safe", count=5)
    pool = _Pool(entry=entry, by_model=False, count=5)
    chosen = _Chosen(ids=(), full=frozenset(), duplicates=(), failures=(), missing=(5,))
    _give_up(pool, 20, chosen, OUT)
    with pytest.raises(RecipeError, match="request fewer"):
        _give_up(pool, 21, chosen, OUT)
