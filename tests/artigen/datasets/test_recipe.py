"""Recipes: what is read is what was written, and what cannot be is one sentence with line and key."""

from dataclasses import replace

import pytest

from artigen.datasets.recipe import (
    Entry,
    Options,
    Recipe,
    RecipeError,
    digest_recipe,
    parse_recipe,
    read_recipe,
)
from artigen.shapes.draw import Wish

WHOLE = """
name: kitchen-1
title: A kitchen
license: cc0-1.0
date: 2026-11-25
objects:
  - category: StorageFurniture
    count: 1_000
    seed: 7
    generated: 0.031
    wish: {width: 0.6, style: shaker, counts: {drawer: 3, door: 0}}
  - {category: Oven, count: 2, name: built-in, like: 3}
options: {gaussians: true, validation: none, objects_per_shard: 10, near: 0}
"""


def test_a_recipe_is_read_as_it_says():
    recipe = parse_recipe(WHOLE)
    cabinets, ovens = recipe.objects
    assert (recipe.name, recipe.title, recipe.license, recipe.date) == (
        "kitchen-1", "A kitchen", "cc0-1.0", "2026-11-25",
    )  # fmt: skip
    assert cabinets == Entry(
        name="StorageFurniture",
        category="StorageFurniture",
        count=1000,
        seed=7,
        generated=0.031,
        wish=Wish(width=0.6, style="shaker", counts=(("door", 0), ("drawer", 3))),
        line=7,
    )
    assert cabinets.drawn_by_model == 31
    assert (ovens.name, ovens.like, ovens.line) == ("built-in", 3, 12)
    assert recipe.options == Options(gaussians=True, validation="none", objects_per_shard=10, near=0.0)
    assert recipe.count == 1002


def test_what_is_not_said_is_the_default():
    recipe = parse_recipe("name: a\nobjects: [{category: Safe, count: 1}]")
    line = Entry(name="Safe", category="Safe", count=1, line=2)
    assert recipe == Recipe(name="a", objects=(line,), options=Options())


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("count: 1_000", "cuont: 1", 8, ["cuont", "did you mean count?"]),
        ("count: 1_000", "count: ten", 8, ["objects[0].count", "'ten'", "whole number from 1"]),
        ("count: 1_000", "count: 0", 8, ["objects[0].count", "found 0"]),
        ("count: 1_000", "count: 2.5", 8, ["objects[0].count", "2.5"]),
        ("count: 1_000", "count: yes", 8, ["objects[0].count"]),
        ("seed: 7", "count: 8", 9, ["objects[0].count", "twice"]),
        ("seed: 7", "seed: -1", 9, ["found -1"]),
        ("generated: 0.031", "generated: 31", 10, ["from 0 to 1"]),
        ("width: 0.6", "width: 60", 11, ["objects[0].wish.width", "0.02 to 10"]),
        ("width: 0.6", "width: .nan", 11, ["objects[0].wish.width"]),
        ("drawer: 3", "drawers: 3", 11, ["objects[0].wish.counts.drawers", "base, drawer, door"]),
        ("StorageFurniture", "Storagefurniture", 7, ["did you mean StorageFurniture?"]),
        ("name: built-in", "name: built.in", 12, ["objects[1].name", "letters"]),
        ("name: built-in", "name: StorageFurniture", 12, ["line 7", "another name"]),
        ("count: 2, ", "", 12, ["objects[1]", "count missing"]),
        ("like: 3", "like: 3, generated: 0.5", 12, ["like and generated"]),
        ("gaussians: true", "gaussians: 1", 13, ["options.gaussians", "true or false"]),
        ("2026-11-25", "yesterday", 5, ["date", "YYYY-MM-DD"]),
        ("name: kitchen-1", "", 3, ["name missing"]),
        ("name: kitchen-1", "name: [a]", 2, ["name", "a list"]),
        ("near: 0", "near: [", 13, ["not YAML"]),
    ],
)
def test_an_error_names_line_key_and_what_is_allowed(old: str, new: str, line: int, said: list[str]):
    assert old in WHOLE
    with pytest.raises(RecipeError) as error:
        parse_recipe(WHOLE.replace(old, new, 1), "recipe.yaml")
    assert str(error.value).startswith(f"recipe.yaml line {line}:")
    for text in said:
        assert text in str(error.value)


@pytest.mark.parametrize("text", ["", "# nothing", "[]", "a: b: c", "name: a\nobjects: []", "\t"])
def test_what_is_no_recipe_is_refused(text: str):
    with pytest.raises(RecipeError):
        parse_recipe(text)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(RecipeError, match=r"nothing\.yaml"):
        read_recipe(tmp_path / "nothing.yaml")


def test_the_digest_changes_with_what_is_made_and_not_with_layout():
    recipe = parse_recipe(WHOLE)
    assert digest_recipe(parse_recipe("\n\n" + WHOLE)) == digest_recipe(recipe)
    others = [
        replace(recipe, license="mit"),
        replace(recipe, options=replace(recipe.options, near=0.01)),
        replace(recipe, objects=recipe.objects[:1]),
    ]
    assert len({digest_recipe(one) for one in [recipe, *others]}) == 4
