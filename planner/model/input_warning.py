"""What of a request is possible, but probably not meant. No plan is refused for it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Odd(StrEnum):
    """The kind of a warning."""

    TOOL_IN_ARM = "TOOL_IN_ARM"
    """A body of the tool overlaps a link of the arm from which nobody keeps it apart."""
    PART_FLOATS = "PART_FLOATS"
    """A part rests on nothing, and something is a few millimetres below it."""


@dataclass(frozen=True, slots=True)
class InputWarning:
    """`bodies`: the tool's body and the arm's, or the part and what is below it; `amount_m`: how far the part is above
    it, or the overlap that a mount may have and that is exceeded (0: none)."""

    kind: Odd
    bodies: tuple[str, str]
    amount_m: float
