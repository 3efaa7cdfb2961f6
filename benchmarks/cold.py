"""Cold caches: nothing of an earlier request may help the next one that is timed."""

from __future__ import annotations

import sys
from functools import _lru_cache_wrapper

KEEP = ("assur.scenes.units", "assur.scenes.catalogue", "assur.scenes.scenarios")
"""Modules whose caches hold nothing of a request: how keys are spelt, the shipped robots and scenarios."""
CACHING = ("assur.planner", "assur.scenes")


def forget() -> int:
    """Empties every `functools` cache of planner and scenes that may hold something of a request; how many.

    Beside this each problem is new to its process, so that a cache by content has nothing of its cell. Its robot it
    has seen, as a service has.
    """
    emptied = 0
    for name, module in list(sys.modules.items()):
        if name.startswith(CACHING):
            for value in list(vars(module).values()):
                # by where it is written: a module also holds what it imports
                if isinstance(value, _lru_cache_wrapper) and not value.__module__.startswith(KEEP):
                    value.cache_clear()
                    emptied += 1
    return emptied
