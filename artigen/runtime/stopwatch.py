"""The seconds that stages take."""

import time


class Stopwatch:
    """Records the time of each stage."""

    def __init__(self) -> None:
        self.laps: list[tuple[str, float]] = []
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        """Ends the stage ``name``."""
        now = time.perf_counter()
        self.laps.append((name, now - self._last))
        self._last = now
