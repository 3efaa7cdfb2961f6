"""Until which release a hazard of a library is known."""

from __future__ import annotations

import re
from importlib.metadata import version


def mended_since(library: str, last_seen: str) -> bool:
    """Whether the installed release is later than the last one in which the hazard was reproduced.

    A test of a hazard says: up to that release it is there, which is why the guard beside it is there. A later release
    may have mended it; the guard stays until somebody has looked.
    """
    return _numbers(version(library)) > _numbers(last_seen)


def _numbers(text: str) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", text))
