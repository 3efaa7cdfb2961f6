"""Jobs that tell how far they have come, for workers of the tests to import."""

from __future__ import annotations

import os
import time

from assur.api.workers.worker_process import Tell


def until_called_off(tell: Tell) -> None:
    """Tells its process's number, and then goes on until it is called off."""
    tell(os.getpid())
    while True:
        time.sleep(0.01)
        tell(None)


def deaf(tell: Tell) -> None:
    """Tells its process's number, and then listens no more."""
    tell(os.getpid())
    time.sleep(600.0)


def counting(most: int, tell: Tell) -> int:
    """Tells all numbers below one, and returns it."""
    for number in range(most):
        tell(number)
    return most
