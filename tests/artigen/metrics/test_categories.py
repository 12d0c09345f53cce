"""Categories that PartNet-Mobility files under one name count as one."""

from artigen.metrics.reading import NAMES, is_same_category
from artigen.shapes.draw import categories
from artigen.types import PAPER_CATEGORIES


def test_names_lead_from_kinds_of_the_grammar_to_categories_of_the_paper():
    assert set(NAMES) <= set(categories()) - set(PAPER_CATEGORIES)
    assert set(NAMES.values()) <= set(PAPER_CATEGORIES)


def test_being_the_same_category_is_an_equivalence_that_no_other_kind_enters():
    kinds = [*categories(), None]
    classes = {frozenset(b for b in kinds if is_same_category(a, b)) for a in kinds}
    assert sum(len(one) for one in classes) == len(kinds)
    assert {len(one) for one in classes} == {1, 1 + len(NAMES)}
