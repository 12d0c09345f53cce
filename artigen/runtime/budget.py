"""Time that a search may take, in seconds of one core rather than of a clock on the wall."""

import os
from collections.abc import Callable


def core_seconds() -> float:
    """Seconds that this process and those that it waited for have computed."""
    return sum(os.times()[:4])


class Budget:
    """Seconds of one core from now on; the same work fits into them on an idle and on a busy machine.

    Work that leaves something out because a budget ended must ask `is_over`, which remembers that it said so:
    ``cut_short`` tells whether more time might have given another result.
    """

    def __init__(self, seconds: float = float("inf"), clock: Callable[[], float] = core_seconds) -> None:
        """
        Args:
            seconds: How much; by default as much as is needed.
            clock: What counts seconds.
        """
        self.seconds, self._clock = seconds, clock
        self._end = clock() + seconds
        self._whole: Budget | None = None
        self.cut_short = False

    @property
    def left(self) -> float:
        """Seconds that are left; not below 0."""
        return max(self._end - self._clock(), 0.0)

    def is_over(self) -> bool:
        """Whether no time is left; if so, this is remembered, also by the budgets that this is a share of."""
        over, at = self._clock() >= self._end, self
        while over and at is not None:
            at.cut_short, at = True, at._whole
        return over

    def share(self, part: float, least: float = 0.0) -> "Budget":
        """A budget that ends when this part of what is left has passed, but not before ``least`` seconds."""
        out = Budget(max(part * self.left, least), self._clock)
        out._whole = self
        return out
