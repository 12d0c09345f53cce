"""Ranges of a coordinate (m): around a middle, between ends, divided and narrowed."""

from collections.abc import Sequence

import numpy as np

Range = tuple[float, float]


def between(a: float, b: float) -> Range:
    """The range between two coordinates in either order."""
    return min(a, b), max(a, b)


def around(middle: float, half: float) -> Range:
    """The range that extends by a length to both sides of a coordinate."""
    return middle - half, middle + half


def narrow(span: Range, by: float) -> Range:
    """A range shortened by a length at both ends, or extended if it is negative."""
    return span[0] + by, span[1] - by


def margins(span: Range, width: float) -> tuple[Range, Range]:
    """The two ranges of a width at the lower and at the upper end of a range."""
    return (span[0], span[0] + width), (span[1] - width, span[1])


def share_range(span: Range, shares: Sequence[float], gap: float = 0.0) -> list[Range]:
    """Intervals of a range proportional to ``shares``, from its lower end up, with ``gap`` between them."""
    free = span[1] - span[0] - gap * (len(shares) - 1)
    sizes = free * np.asarray(shares) / sum(shares)
    starts = span[0] + np.concatenate([[0.0], np.cumsum(sizes + gap)[:-1]])
    return [(float(start), float(start + size)) for start, size in zip(starts, sizes, strict=True)]


def share_down(span: Range, shares: Sequence[float], gap: float = 0.0) -> list[Range]:
    """As `share_range`, from the upper end down."""
    return share_range(span, shares[::-1], gap)[::-1]


def divide_range(span: Range, count: int, gap: float = 0.0) -> list[Range]:
    """Equal intervals of a range, from its lower end up, with ``gap`` between them."""
    return share_range(span, (1.0,) * count, gap)
