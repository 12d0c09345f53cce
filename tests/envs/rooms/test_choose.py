"""Which units a wall gets: what a missing metre, an odd size or a copy costs decides."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from envs.rooms.catalogue import Entry
from envs.rooms.choose import Offer, Wall, choose_units, order_units
from envs.rooms.recipes import BASE, Share


class Chance:
    """Draws the first of all, and the given numbers."""

    def __init__(self, *numbers: float) -> None:
        self.numbers = np.array(numbers)

    def integers(self, *_: int) -> int:
        return 0

    def random(self, *_: int) -> np.ndarray:
        return self.numbers


def offer(width: float, depth: float = 0.6, height: float = 0.88) -> Offer:
    """A unit that takes so much of a wall, the gap beside it included."""
    size = (depth, width - 0.003, height)
    entry = Entry(folder=Path("x"), name="x", category="StorageFurniture", size=size, kinds=(), provenance=())
    return Offer(share=0, entry=entry)


def choose(
    *offers: Offer, length: float, wanted: int = 0, least: int = 0, enclosed: bool = False, chance: Any = None
) -> list[Offer]:
    share = Share(role=BASE, least=least, wanted=wanted, most=10)
    chance = chance or Chance(*[0.0] * len(offers))
    (units,) = choose_units(offers, [share], [Wall(length=length, enclosed=enclosed)], chance) or [[]]
    return units


@pytest.mark.parametrize(("width", "count"), [(0.355, 0), (0.365, 1)])
def test_36_centimetres_of_wall_are_worth_a_unit_too_many(width: float, count: int):
    """A metre costs 2.5 and a unit too many 0.9."""
    assert len(choose(offer(width), length=width + 0.01)) == count


@pytest.mark.parametrize(("width", "count"), [(0.379, 1), (0.381, 2)])
def test_a_copy_costs_as_much_as_two_centimetres_of_wall(width: float, count: int):
    assert len(choose(offer(width), length=2 * width + 0.01)) == count


def test_a_wall_has_at_most_four_copies_of_a_unit():
    assert len(choose(offer(0.6), length=9.0, wanted=10)) == 4


@pytest.mark.parametrize(("deeper", "chosen"), [(0.16, 1), (0.175, 0)])
def test_a_centimetre_in_depth_outweighs_twelve_millimetres_of_wall(deeper: float, chosen: int):
    """The wider unit fills ten centimetres more, and is deeper by half of ``deeper`` than is usual."""
    offers = offer(0.5), offer(0.6, depth=0.6 + deeper)
    assert choose(*offers, length=0.61, wanted=1, least=1) == [offers[chosen]]


@pytest.mark.parametrize(("higher", "chosen"), [(0.19, 1), (0.21, 0)])
def test_a_centimetre_in_height_outweighs_one_of_wall(higher: float, chosen: int):
    offers = offer(0.5, height=0.75), offer(0.6, height=0.75 + higher)
    assert choose(*offers, length=0.61, wanted=1, least=1) == [offers[chosen]]


@pytest.mark.parametrize(("width", "count"), [(0.22, 0), (0.26, 1)])
def test_a_tall_unit_between_two_corners_costs_as_much_as_sixty_centimetres_of_wall(width: float, count: int):
    """Less what it costs to miss it, 36 cm."""
    tall = offer(width, height=1.9)
    assert len(choose(tall, length=width + 0.01, wanted=1, enclosed=True)) == count


@pytest.mark.parametrize(("narrower", "chosen"), [(0.09, 1), (0.11, 0)])
def test_taste_is_worth_up_to_ten_centimetres_of_wall(narrower: float, chosen: int):
    offers = offer(0.6), offer(0.6 - narrower)
    assert choose(*offers, length=0.61, wanted=1, least=1, chance=Chance(1.0, 0.0)) == [offers[chosen]]


@pytest.mark.parametrize(("height", "cornered"), [(1.26, True), (1.28, False)])
def test_what_is_higher_than_a_metre_and_a_quarter_is_not_put_in_a_corner(height: float, cornered: object):
    unit, low = offer(0.6, height=height), offer(0.6)
    orders = [order_units([unit, low, low], np.random.default_rng(seed), [0]) for seed in range(60)]
    assert any(order[0] is unit for order in orders) == cornered
