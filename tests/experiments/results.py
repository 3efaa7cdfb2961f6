"""Experiments run once for all tests of a process."""

from __future__ import annotations

from functools import cache

from assur.experiments.experiment import Result
from assur.experiments.reproduce import ENTRIES


@cache
def result(name: str) -> Result:
    """The result of the experiment `name`."""
    return next(entry for entry in ENTRIES if entry.name == name).run()
