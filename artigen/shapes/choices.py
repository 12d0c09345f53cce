"""Random choices: one of several options, a number in a range."""

from collections.abc import Mapping, Sequence
from typing import TypeVar

import numpy as np

Word = TypeVar("Word", bound=str)
Option = TypeVar("Option")


def pick(rng: np.random.Generator, weights: Mapping[Word, float]) -> Word:
    """One of the words, as likely as its weight."""
    chances = np.array(list(weights.values()))
    return list(weights)[int(rng.choice(len(chances), p=chances / chances.sum()))]


def choose_one(rng: np.random.Generator, options: Sequence[Option]) -> Option:
    """One of the options, all equally likely."""
    return options[int(rng.integers(len(options)))]


def choose_style(rng: np.random.Generator, styles: Mapping[str, float], wished: str | None = None) -> str:
    """The wished style, or one drawn by weight; every call takes one number from ``rng``, wished or not."""
    drawn = pick(rng, styles)
    return drawn if wished is None else wished


def choose(rng: np.random.Generator, low: float, high: float, wished: float | None = None) -> float:
    """The wished value, or a uniform one; every call takes one number from ``rng``, wished or not."""
    drawn = float(rng.uniform(low, high))
    return drawn if wished is None else wished
