"""Vocabularies of sketches: complete, and weights go with the names of words."""

from copy import deepcopy
from pathlib import Path

import pytest
import torch

from artigen.kind import kinds
from artigen.sketch.model import draw_header, draw_object, load_sketch_network, save_sketch_network
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.sketch.picture import PictureConfig
from artigen.sketch.request import SketchRequest
from artigen.sketch.sketch import SketchError
from artigen.sketch.slots import slots
from artigen.sketch.vocabulary import (
    BY_SLOT,
    BY_SYMBOL,
    GUESSED,
    WORDS,
    VocabularyError,
    carry_weights,
    describe_vocabulary,
    find_new_symbols,
    name_slots,
    name_symbols,
)
from artigen.sketch.words import CATEGORIES, OTHER_STYLE, STYLES

PICTURE = PictureConfig(edge=32, widths=(8, 16, 24), blocks=(1, 1, 1), stem=8)
SIZES = SketchNetworkConfig(width=32, layers=2, heads=2, pointer=8, picture=PICTURE)


def _without(category: str = "Safe", style: str = "dial", role: str = "cavity") -> dict[str, object]:
    """A vocabulary from before three words and a field were added."""
    vocabulary = deepcopy(describe_vocabulary())
    for words, word in (("categories", category), ("styles", style), ("roles", role)):
        vocabulary[words].remove(word)
    rows = [row.replace(" holds:63", "").split() for row in vocabulary["rows"]]
    for fields in rows:
        for at, field in enumerate(fields[1:], start=1):
            name = field.split(":")[0]
            fields[at] = f"{name}:{len(vocabulary[WORDS[name]])}" if name in WORDS else field
    vocabulary["rows"] = [" ".join(fields) for fields in rows]
    return vocabulary


def test_every_category_of_the_grammar_and_its_styles_are_words():
    assert set(CATEGORIES) == set(kinds())
    stated = {style for kind in kinds().values() for style in kind.styles}
    assert stated <= set(STYLES) - {STYLES[OTHER_STYLE]}
    assert len(set(STYLES)) == len(STYLES)


def test_names_go_with_the_slots_and_symbols_of_the_network():
    vocabulary = describe_vocabulary()
    assert len(name_slots(vocabulary)) == len(set(name_slots(vocabulary))) == len(slots().base)
    names = name_symbols(vocabulary)
    assert len(names) == len(set(names)) == slots().total
    firsts = [names[base].split("=")[0] for base in slots().base if base >= 0]
    symbols = [name for name, size in zip(name_slots(vocabulary), slots().size, strict=True) if size]
    assert firsts == symbols


def test_weights_that_are_carried_into_a_larger_vocabulary_stay_with_their_words():
    before = _without()
    fresh = SketchNetwork(SIZES).state_dict()
    old = {name: value + 100.0 for name, value in fresh.items()}
    sizes = {
        **dict.fromkeys(BY_SYMBOL, len(name_symbols(before))),
        **dict.fromkeys(BY_SLOT, len(name_slots(before))),
    }
    old |= {name: old[name][:count] for name, count in sizes.items()}
    old |= {name: old[name][:-1] for name in GUESSED[:2]} | {GUESSED[2]: old[GUESSED[2]][:, :-1]}
    new = carry_weights(old, before, fresh)
    for table, names in ((BY_SYMBOL, name_symbols), (BY_SLOT, name_slots)):
        now = names(describe_vocabulary())
        for name in table:
            kept = [now.index(word) for word in names(before)]
            added = sorted(set(range(len(now))) - set(kept))
            assert torch.equal(new[name][kept], old[name])
            field = [at for at in added if now[at].startswith("joint.holds=")]
            words = sorted(set(added) - set(field))
            assert torch.equal(new[name][words], fresh[name][words])
            if name == "symbols.weight":  # rows read as before the field was added
                assert field
                assert not new[name][field].any()
            assert added
    at = CATEGORIES.index("Safe") - len(CATEGORIES)
    for name in GUESSED[:2]:
        assert torch.equal(torch.cat([new[name][:at], new[name][at + 1 :]]), old[name])
        assert torch.equal(new[name][at], fresh[name][at])
    assert {name: value.shape for name, value in new.items()} == {
        name: value.shape for name, value in fresh.items()
    }


def test_a_word_that_was_learned_cannot_be_taken_out():
    before = describe_vocabulary()
    before["styles"] = [*before["styles"], "baroque"]
    weights = SketchNetwork(SIZES).state_dict()
    with pytest.raises(VocabularyError, match=r"object.style=baroque"):
        carry_weights(weights, before, weights)


def test_a_network_draws_only_what_it_has_learned(tmp_path: Path):
    torch.manual_seed(0)
    network = SketchNetwork(SIZES)
    network.categories = ("Oven", "Cart")
    save_sketch_network(network, tmp_path, {"preset": "tiny"})
    loaded = load_sketch_network(tmp_path)
    assert loaded.categories == ("Oven", "Cart")
    drawn = {draw_header(loaded, SketchRequest(), seed).category for seed in range(20)}
    assert drawn <= {"Oven", "Cart"}
    with pytest.raises(SketchError, match="one of Oven, Cart"):
        draw_object(loaded, SketchRequest(category="Safe"), 0)


def test_new_words_and_categories_that_were_never_drawn_are_found():
    before = _without()
    names = name_symbols(describe_vocabulary())
    drawn = [name for name in CATEGORIES if name not in ("Safe", "Oven")]
    new = {names[index] for index in find_new_symbols(before, drawn)}
    assert {name for name in new if name.startswith("object.")} == {
        "object.category=Safe",
        "object.category=Oven",
        "object.style=dial",
    }
    assert {"finish.role=cavity", "box.finish=cavity", "box.lining=cavity"} <= new
    assert {name for name in new if name.startswith("joint.")} == {f"joint.holds={k}" for k in range(1, 63)}
    assert not find_new_symbols(describe_vocabulary(), CATEGORIES)
