"""Numbers as text, for both readers: a number that not every reader takes for the same one is refused."""

from __future__ import annotations

import math

from assur.scenes.bounds import MAX_INTEGER

LONGEST_NUMBER = 64
"""Characters of a number: a double needs 25."""
LONGEST_SHOWN = 20
"""Number of characters of a refused number that a message repeats."""


class Refused:
    """In place of a refused value in a parsed document, until its path is known."""

    def __init__(self, shown: object, allowed: str) -> None:
        self.shown, self.allowed = shown, allowed


def whole(text: str) -> int | Refused:
    """The whole number that `text` spells in decimal digits."""
    if len(text) > LONGEST_NUMBER or abs(int(text)) > MAX_INTEGER:
        shown = text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}... ({len(text)} characters)"
        return Refused(shown, "a whole number up to 2**53")
    return int(text)


def real(text: str) -> float | Refused:
    """The number that `text` spells."""
    if len(text) > LONGEST_NUMBER:
        return Refused(text[:LONGEST_SHOWN] + "...", f"a number of up to {LONGEST_NUMBER} characters")
    value = float(text)
    return value if math.isfinite(value) else Refused(text[:LONGEST_SHOWN], "a finite number")
