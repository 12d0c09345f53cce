"""Sentences and what they ask for."""

import pytest

from artigen.conditioning.prompt import (
    CATEGORY_WORDS,
    COLORS,
    NUMBERS,
    PART_WORDS,
    ParsedText,
    TextError,
    parse_text,
    write_text,
)
from artigen.kind import kinds, paper_kinds
from artigen.shapes.draw import draw_shape
from artigen.types import PART_LABELS


def test_a_sentence_says_category_counts_and_size():
    said = parse_text("A tall white cabinet with three drawers and two doors, 80 cm wide and 1.9 m in height")
    assert said.category == "StorageFurniture"
    assert said.counts == (("door", 2), ("drawer", 3))
    assert (said.width, said.depth, said.height) == (0.8, None, 1.9)
    assert said.stretch == (("height", 1.35),)
    assert said.colors == (("base", "white"),)
    assert said.unused == ("a", "with", "and", "and")


def test_colours_belong_to_the_noun_that_follows():
    said = parse_text("a white and narrow fridge with two large black handles and blue doors")
    assert said.colors == (("base", "white"), ("door", "blue"), ("handle", "black"))
    assert said.counts == (("handle", 2),)
    assert parse_text("an oven, something white").colors == ()
    assert all(0 <= level <= 1 for color in COLORS.values() for level in color)
    with pytest.raises(TextError, match="white and blue are asked for, both of the object"):
        parse_text("a white oven or a blue oven")


@pytest.mark.parametrize("noun", sorted(CATEGORY_WORDS))
def test_every_noun_is_understood_in_both_numbers(noun: str):
    for word in (noun, noun + "s" if not noun.endswith("f") else noun):
        if noun != "chest of drawers":
            assert parse_text(f"one {word}").category == CATEGORY_WORDS[noun]
    assert CATEGORY_WORDS[noun] in kinds()


@pytest.mark.parametrize("part", sorted(PART_WORDS))
@pytest.mark.parametrize("number", ["no", "two", "7"])
def test_every_part_can_be_counted(part: str, number: str):
    plural = "shelves" if part == "shelf" else part + "s"
    expected = NUMBERS.get(number, 7)
    assert parse_text(f"{number} small oak {plural}").counts == ((PART_WORDS[part], expected),)
    assert PART_WORDS[part] in PART_LABELS


def test_the_order_of_clauses_does_not_matter():
    one = parse_text("an oven with 4 knobs and one door, 60 cm wide")
    two = parse_text("60 cm wide oven, one door, 4 knobs")
    assert (one.category, one.counts, one.width) == (two.category, two.counts, two.width)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("a green sofa", "no word names a category"),
        ("", "no word names a category"),
        ("a fridge and an oven", "Refrigerator and Oven"),
        ("two doors and three doors", "2 and 3 parts called door"),
        ("a cabinet 80 cm wide and 90 cm wide", "width is 0.8 m and 0.9 m"),
        ("a low tall cabinet", "contradicts"),
        ("a cabinet 0 cm wide", "expected more than 0"),
    ],
)
def test_what_cannot_be_meant_is_refused(text: str, match: str):
    with pytest.raises(TextError, match=match):
        parse_text(text)


def test_nothing_is_invented():
    assert parse_text("microwave") == ParsedText(category="Microwave")


@pytest.mark.parametrize("category", paper_kinds())
def test_a_written_sentence_says_what_is_read_out_of_it(category: str):
    for seed in range(20):
        counts = dict(draw_shape(category, seed).condition.counts)
        said = parse_text(write_text(category, counts))
        named = {label: count for label, count in counts.items() if count and label != "base"}
        assert (said.category, dict(said.counts)) == (category, named)
        assert not set(said.unused) - {"a", "an", "with", "and"}


def test_every_category_has_a_noun_and_parts_of_others_are_none():
    assert set(CATEGORY_WORDS.values()) | {"Dresser", "Wardrobe"} == set(kinds())
    assert parse_text("an oven with a window and a door").category == "Oven"
