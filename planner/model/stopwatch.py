"""Where the time of a request went, by stage. It is told to operators, and decides nothing."""

from __future__ import annotations

import time


class Stopwatch:
    """Seconds by stage, of a monotonic clock. It runs from when it is made."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        """Time of each stage so far, s, in the order in which the stages first ended."""
        self._last = time.perf_counter()

    def lap(self, stage: str) -> None:
        """Adds the time since the last call, or since it was made, to `stage`."""
        now = time.perf_counter()
        self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self._last
        self._last = now
