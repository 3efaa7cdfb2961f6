"""Jobs that tell how far they have come, for workers of the tests to import."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

from assur.api.workers.worker_process import CalledOffError, Line

kept: list[bytes] = []
"""What `all_but_the_last` does not free."""


def all_but_the_last(mib: int) -> int:
    """Takes so much memory in blocks of 1 KiB and frees all but the last of them, so that the C library keeps what lies
    below it. Returns its process's number."""
    kept[:] = [os.urandom(1024) for _ in range(mib << 10)][-1:]
    return os.getpid()


def until_called_off(line: Line) -> None:
    """Tells its process's number, and then goes on until it is called off."""
    line.tell(os.getpid())
    while True:
        time.sleep(0.01)
        line.tell(None)


def leaving(file: str, line: Line) -> str:
    """Is at a step until a file is there, and listens only then; it leaves an answer where it is called off."""
    line.tell(os.getpid())
    while not Path(file).exists():
        time.sleep(0.01)
    try:
        line.tell(None)
    except CalledOffError:
        line.tell("what there is")
        raise
    return "not called off"


def deaf(line: Line) -> None:
    """Tells its process's number, and then listens no more."""
    line.tell(os.getpid())
    time.sleep(600.0)


def counting(most: int, line: Line) -> int:
    """Tells all numbers below one, and returns it."""
    for number in range(most):
        line.tell(number)
    return most


def recalled_once(file: str, line: Line) -> str:
    """Notes that it has begun; goes on until it is called off, the first time, and returns the next."""
    begun = Path(file)
    again = begun.exists()
    begun.touch()
    while not again:
        time.sleep(0.01)
        line.tell(None)
    return "at last"


def dies_unless(folder: str, line: Line) -> str:
    """Says what it means, ends its process as often as the first line of a file says, and then returns."""
    line.means(lambda: "what it means")
    counter = Path(folder) / "deaths"
    left = int(counter.read_text(encoding="utf-8"))
    if left:
        counter.write_text(str(left - 1), encoding="utf-8")
        signal.raise_signal(signal.SIGKILL)
    return "planned"
