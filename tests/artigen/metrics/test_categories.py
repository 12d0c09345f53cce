"""Categories that PartNet-Mobility files under one name count as one."""

from artigen.kind import kinds
from artigen.metrics.reading import is_same_category


def test_being_the_same_category_is_an_equivalence_of_what_partnet_mobility_files_under_one_name():
    names = [*kinds(), None]
    classes = {frozenset(b for b in names if is_same_category(a, b)) for a in names}
    assert sum(len(one) for one in classes) == len(names)
    assert {len(one) for one in classes} == {1, 4}
    assert is_same_category("Dresser", "StorageFurniture")
    assert is_same_category("Pot", "KitchenPot")
