"""Requests that were shown to end the workers that are given them: they are refused for a time.

A death of a worker shows nothing by itself: the machine may be out of memory, or somebody has killed it. Only a request
that ends two fresh workers, one after the other and each with nothing else before it, is shown to be the cause.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from assur.api.problems import Problem

MOST = 1000
"""So many requests are kept, the one that is to be freed first is forgotten first."""


def quarantined(left_s: float, why: str = "") -> Problem:
    """The problem of a request in quarantine for `left_s` more, s. `why`: a sentence, with a blank behind it."""
    again = max(1, math.ceil(left_s))
    return Problem(
        "quarantined",
        f"{why}Change it before you send it again. It will be tried again as it is in {again} s.",
        again_s=again,
    )


class Quarantine:
    """Keys of requests, each until a time. A key is the digest of a body, or of what it means."""

    def __init__(self, kept_s: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._kept_s = kept_s
        self._clock = clock
        self._until: dict[str, float] = {}

    def __len__(self) -> int:
        return len(self.left_s())

    def left_s(self) -> dict[str, float]:
        """For how long each key is still kept, s."""
        if not self._until:
            return {}
        now = self._clock()
        self._until = {key: until for key, until in self._until.items() if until > now}
        return {key: until - now for key, until in self._until.items()}

    def add(self, *keys: str, why: str = "") -> Problem:
        """Keeps these keys from now on, and gives the problem that says so, and why."""
        for key in keys:
            self._until.pop(key, None)
            self._until[key] = self._clock() + self._kept_s
        while len(self._until) > MOST:
            self._until.pop(next(iter(self._until)))
        return quarantined(self._kept_s, why)

    def refuse(self, key: str) -> None:
        """Raises the `Problem` of a request that is kept under this key."""
        left = self.left_s().get(key)
        if left is not None:
            raise quarantined(left)
